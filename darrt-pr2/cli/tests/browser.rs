//! A browser without a screen, where there is one.
#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "a test stops at the first surprise, and says what it skips"
)]

use std::path::Path;
use std::process::{Command, Output};

/// Opens the page with these options, cut off from every network; what the page complains about fails the test. `None`, and
/// said, where this machine has no browser.
pub(crate) fn open(page: &str, options: &[&str]) -> Option<Output> {
    let is_there =
        |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    let Some(browser) = ["chromium", "chromium-browser", "google-chrome"].into_iter().find(is_there) else {
        eprintln!("skipped: this machine has no Chromium");
        return None;
    };
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(browser)
        .args(["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"])
        .args(["--host-resolver-rules=MAP * ~NOTFOUND", "--enable-logging=stderr"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(options)
        .arg(page)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    let complaints: Vec<&str> = said.lines().filter(|line| line.contains("CONSOLE")).collect();
    assert!(complaints.is_empty(), "{complaints:?}");
    Some(output)
}

/// The page as it is once its scripts have run.
pub(crate) fn dom(page: &Path) -> Option<String> {
    let options = ["--dump-dom", "--virtual-time-budget=3000"];
    open(&format!("file://{}", page.display()), &options)
        .map(|output| String::from_utf8_lossy(&output.stdout).into_owned())
}
