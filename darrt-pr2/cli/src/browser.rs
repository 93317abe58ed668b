//! Opens a page in the browser that the user has.

use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::exit::{Exit, Failure};

/// Whoever still runs after so long has found a browser: some end only with it.
const PATIENCE: Duration = Duration::from_secs(2);
/// Between two looks.
const PAUSE: Duration = Duration::from_millis(20);

/// Opens the page.
///
/// # Errors
/// [`Exit::CannotWrite`] with the page when no program of this system opens it.
pub(crate) fn open(page: &Path) -> Result<(), Failure> {
    let mut tried = Vec::new();
    // Browsers do not know from where they are called.
    let whole = page.canonicalize().unwrap_or_else(|_| page.to_path_buf());
    for mut command in open::commands(&whole) {
        let name = command.get_program().to_string_lossy().into_owned();
        match command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn() {
            Ok(mut child) => {
                let begun = Instant::now();
                let status = loop {
                    match child.try_wait() {
                        Ok(None) if begun.elapsed() < PATIENCE => std::thread::sleep(PAUSE),
                        other => break other,
                    }
                };
                match status {
                    Ok(Some(status)) if !status.success() => tried.push(format!("{name} ended with {status}")),
                    Err(error) => tried.push(format!("{name}: {error}")),
                    Ok(_) => return Ok(()),
                }
            }
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => tried.push(format!("no {name}")),
            Err(error) => tried.push(format!("{name}: {error}")),
        }
    }
    let text = format!("{}: is written, but no browser was found to open it ({})", page.display(), tried.join(", "));
    Err(Failure::new(Exit::CannotWrite, text))
}
