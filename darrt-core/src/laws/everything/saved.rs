//! Cases that once failed, in a text file: one line each, the subject and the number of the case.

use std::fs;
use std::io::Write as _;
use std::path::Path;

const HEAD: &str = "# Cases that failed once, subject and number; they come first in every run. Keep this file under version control.\n";

/// The numbers that the file holds for a subject; none without a file.
pub(super) fn read(file: Option<&Path>, subject: &str) -> Vec<u64> {
    let text = file.and_then(|path| fs::read_to_string(path).ok()).unwrap_or_default();
    let lines = text.lines().filter_map(|line| line.rsplit_once('\t'));
    lines.filter(|(name, _)| *name == subject).filter_map(|(_, case)| case.trim().parse().ok()).collect()
}

/// Adds a case, unless it is known. What cannot be written is told.
pub(super) fn add(file: Option<&Path>, subject: &str, case: u64) -> Result<(), String> {
    let Some(path) = file else { return Ok(()) };
    if read(Some(path), subject).contains(&case) {
        return Ok(());
    }
    let write = || {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        let is_new = !path.exists();
        let mut out = fs::OpenOptions::new().create(true).append(true).open(path)?;
        if is_new {
            out.write_all(HEAD.as_bytes())?;
        }
        out.write_all(format!("{subject}\t{case}\n").as_bytes())
    };
    write().map_err(|error: std::io::Error| format!("{} cannot be written: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_added_is_read_once() {
        let folder = std::env::temp_dir().join(format!("laws-saved-{}", std::process::id()));
        let file = folder.join("cases.txt");
        assert_eq!(read(Some(&file), "robot"), Vec::<u64>::new());
        for case in [7, 9, 7] {
            add(Some(&file), "robot", case).unwrap_or_else(|why| unreachable!("{why}"));
        }
        add(Some(&file), "cart 1", 5).unwrap_or_else(|why| unreachable!("{why}"));
        assert_eq!((read(Some(&file), "robot"), read(Some(&file), "cart 1")), (vec![7, 9], vec![5]));
        assert!(add(Some(Path::new("/dev/null/cases")), "robot", 1).is_err());
        let _ = fs::remove_dir_all(folder);
    }
}
