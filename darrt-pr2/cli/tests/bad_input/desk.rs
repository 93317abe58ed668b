//! A folder with files, and the program run in it.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use darrt_pr2::problems::builtin_text;

/// After this long a run counts as hanging; every run here is over in a moment.
const PATIENCE: Duration = Duration::from_secs(120);

/// What the files say that must survive a failure.
pub(crate) const KEPT: &str = "from an earlier run";

/// A folder of its own with the results of an earlier run, `kept.json` and `kept.html`.
pub(crate) struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    pub(crate) fn new() -> Self {
        let desk = Self { folder: tempfile::tempdir().unwrap() };
        desk.write("kept.json", KEPT);
        desk.write("kept.html", KEPT);
        desk
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    /// Plate1 with edits, each a text that is there and what takes its place.
    pub(crate) fn problem(&self, name: &str, edits: &[(&str, &str)]) {
        let mut text = builtin_text("plate1").unwrap().to_owned();
        for (old, new) in edits {
            assert!(text.contains(old), "the test replaces `{old}`, which is not there");
            text = text.replacen(old, new, 1);
        }
        self.write(name, text);
    }

    /// A file of this size that takes no room.
    pub(crate) fn sparse(&self, name: &str, bytes: u64) {
        std::fs::File::create(self.path(name)).unwrap().set_len(bytes).unwrap();
    }

    /// A pipe that nobody writes to or reads from.
    #[cfg(unix)]
    pub(crate) fn pipe(&self, name: &str) {
        assert!(Command::new("mkfifo").arg(self.path(name)).status().unwrap().success());
    }

    /// Runs, and ends what does not end by itself.
    pub(crate) fn run(&self, arguments: &[&str]) -> Output {
        let mut child = Command::new(env!("CARGO_BIN_EXE_darrt"))
            .current_dir(self.folder.path())
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while child.try_wait().unwrap().is_none() {
            if start.elapsed() > PATIENCE {
                child.kill().unwrap();
                panic!("{arguments:?} hangs");
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        child.wait_with_output().unwrap()
    }

    /// Runs and expects this exit code, one line of complaint with all `parts`, nothing else printed, and no file made
    /// or changed.
    pub(crate) fn refused(&self, arguments: &[&str], exit: i32, parts: &[&str]) {
        let before = self.files();
        let output = self.run(arguments);
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(exit), "{arguments:?}: {complaint}");
        assert!(output.stdout.is_empty(), "{arguments:?}: results only on the standard output");
        assert!(complaint.starts_with("error: ") && !complaint.contains("panicked"), "{arguments:?}: {complaint}");
        assert_eq!(complaint.lines().count(), 1, "{arguments:?}: {complaint}");
        assert!(complaint.len() < 1200, "{arguments:?}: {} bytes: {complaint}", complaint.len());
        for part in parts {
            assert!(complaint.contains(part), "{arguments:?}: `{part}` is missing from: {complaint}");
        }
        assert_eq!(self.files(), before, "{arguments:?}: files were made or changed");
    }

    /// Plans `problem`, with results where there are some already, and expects to be refused as bad input.
    pub(crate) fn plan_refused(&self, problem: &str, parts: &[&str]) {
        let arguments = ["plan", problem, "--iterations", "1", "-o", "kept.json", "--picture", "kept.html"];
        let parts: Vec<&str> = [problem].iter().chain(parts).copied().collect();
        self.refused(&arguments, 2, &parts);
    }

    /// Plans `problem` and expects to be told and shown why there is no plan, with this exit code; what was there before is
    /// left as it was.
    pub(crate) fn plan_hopeless(&self, problem: &str, exit: i32, parts: &[&str]) {
        let before = self.files();
        let output = self.run(&["plan", problem, "--iterations", "1", "-o", "kept.json", "--picture", "kept.html"]);
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(exit), "{complaint}");
        for part in parts {
            assert!(complaint.contains(part), "`{part}` is missing from: {complaint}");
        }
        let mut after = self.files();
        assert!(after.remove("kept.why.html").is_some(), "{complaint}");
        assert_eq!(after, before, "files were made or changed");
        std::fs::remove_file(self.folder.path().join("kept.why.html")).unwrap();
    }

    /// Names and sizes of all files, and the content of those that must not change.
    fn files(&self) -> BTreeMap<String, (u64, Option<String>)> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap().map(|entry| {
            let entry = entry.unwrap();
            let name = entry.file_name().into_string().unwrap();
            let content = name.starts_with("kept").then(|| std::fs::read_to_string(entry.path()).unwrap());
            (name, (entry.metadata().unwrap().len(), content))
        });
        entries.collect()
    }
}
