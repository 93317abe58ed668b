//! Plans of runs that are kept: each as a file and as a page.

use std::fmt::Write as _;
use std::path::{Component, Path, PathBuf};

use darrt_task::picture::{Extent, Format, Story};
use darrt_task::planning::PlanResult;
use darrt_task::program::Program;

use super::error::BenchError;
use super::record::Key;
use crate::{drawing, output};

/// Writes the plan of a run and its page into `folder`; the name of the page, if there is a plan.
///
/// # Errors
/// [`BenchError::Kept`] with the file.
pub(crate) fn keep(
    program: &dyn Program,
    folder: &Path,
    (key, digest): (&Key, &str),
    result: &PlanResult,
) -> Result<Option<String>, BenchError> {
    let Some(plan) = &result.plan else { return Ok(None) };
    let whole = format!("{}-{}-{}", key.problem, key.variant, key.seed);
    let stem = output::file_stem(&whole);
    // Two names that become one as a file are told apart.
    let stem = if stem == whole { stem } else { format!("{stem}-{digest}") };
    let file = |ending: &str| folder.join(format!("{stem}.{ending}"));
    let failed = |path: PathBuf, reason: String| BenchError::Kept { file: path, reason };
    let (path, page) = (file("plan.json"), file("html"));
    plan.write(&path).map_err(|error| failed(path.clone(), error.to_string()))?;
    let drawn = || {
        let robot = program.facts(&plan.problem).map_err(|error| error.to_string())?;
        let story = Story::of_plan(plan, &robot).map_err(|error| error.to_string())?;
        let bytes = drawing::file(&story, Some(plan), &robot, Format::Html, Extent::Whole);
        output::write_file(&page, bytes.map_err(|failure| failure.message)?).map_err(|failure| failure.message)
    };
    drawn().map_err(|reason| failed(page.clone(), reason))?;
    Ok(Some(format!("{stem}.html")))
}

/// Where the pages of kept plans are.
pub struct Kept<'a> {
    /// As a link that ends in a slash or is empty.
    pub link: String,
    /// Is a page of this name there?
    pub is_there: &'a dyn Fn(&str) -> bool,
}

impl std::fmt::Debug for Kept<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Kept").field("link", &self.link).finish_non_exhaustive()
    }
}

/// The way from the folder of `page` to `folder`, as a link; `None` if they share no root.
pub(crate) fn link_to(folder: &Path, page: &Path) -> Option<String> {
    let beside = page.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (from, to) = (beside.canonicalize().ok()?, folder.canonicalize().ok()?);
    let (from, to): (Vec<_>, Vec<_>) = (from.components().collect(), to.components().collect());
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return None;
    }
    let up = from.iter().skip(shared).map(|_| "..".to_owned());
    let down = to.iter().skip(shared).filter_map(|part| match part {
        Component::Normal(name) => Some(encoded(&name.to_string_lossy())),
        _ => None,
    });
    Some(up.chain(down).map(|part| part + "/").collect())
}

/// A name as part of a link.
pub(crate) fn encoded(name: &str) -> String {
    let mut out = String::new();
    for byte in name.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' => out.push(char::from(byte)),
            // Writing to a string cannot fail.
            _ => drop(write!(out, "%{byte:02X}")),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_lead_from_the_report_to_the_pages() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["out", "out/my plans", "pages"] {
            std::fs::create_dir(folder.path().join(name)).unwrap();
        }
        let link = |to: &str, page: &str| link_to(&folder.path().join(to), &folder.path().join(page)).unwrap();
        assert_eq!(link("out", "out/report.html"), "");
        assert_eq!(link("out/my plans", "out/report.html"), "my%20plans/");
        assert_eq!(link("pages", "out/report.html"), "../pages/");
        assert_eq!(encoded("ä\"<"), "%C3%A4%22%3C");
    }
}
