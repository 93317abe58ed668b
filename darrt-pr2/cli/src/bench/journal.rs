//! The file of results: one line per finished run, taken up again after a kill.
//!
//! A line is written whole and synchronised before the next run counts as done. A kill in the middle of a line leaves a
//! torn last line, which has no line feed: it is cut off, and that run is done again.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use darrt_geom::bounded_file;

use super::error::BenchError;
use super::record::Record;
use darrt_task::text_file::{self, TextFileError};

/// Largest accepted file of results in bytes (1 GiB).
const MAX_BYTES: u64 = 1 << 30;

/// The results that a file holds.
#[derive(Debug, Default)]
pub struct Contents {
    /// Every whole line, in order.
    pub records: Vec<Record>,
    /// Bytes of the whole lines.
    pub whole_bytes: u64,
    /// Is there a torn line behind them?
    pub is_torn: bool,
}

/// Reads a file of results.
///
/// # Errors
/// [`BenchError::Unreadable`] when it is not a regular file of bounded size; [`BenchError::Line`] for the first whole line
/// that is not the record of a run.
pub fn read(path: &Path) -> Result<Contents, BenchError> {
    let bytes = bounded_file::read_bytes(path, MAX_BYTES).map_err(TextFileError::from)?;
    parse(&bytes, &path.display().to_string())
}

fn parse(bytes: &[u8], file: &str) -> Result<Contents, BenchError> {
    let end = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
    let whole = bytes.get(..end).unwrap_or_default();
    let mut records = Vec::new();
    for (index, line) in whole.split(|byte| *byte == b'\n').enumerate().filter(|(_, line)| !line.is_empty()) {
        let record = serde_json::from_slice(line).map_err(|error| BenchError::Line {
            file: file.to_owned(),
            line: index + 1,
            message: text_file::one_line(&error.to_string()),
        })?;
        records.push(record);
    }
    Ok(Contents { records, whole_bytes: whole.len() as u64, is_torn: whole.len() < bytes.len() })
}

/// A file of results that this process alone writes.
#[derive(Debug)]
pub struct Journal {
    file: File,
    path: PathBuf,
}

impl Journal {
    /// Opens or makes the file, locks it, reads what it holds and cuts off a torn line.
    ///
    /// # Errors
    /// [`BenchError::Unwritable`], [`BenchError::Locked`] when another process writes to it, else as [`read`].
    pub fn open(path: &Path) -> Result<(Self, Contents), BenchError> {
        let refuse = |source| BenchError::Unwritable { file: path.to_path_buf(), source };
        let file = OpenOptions::new().append(true).create(true).open(path).map_err(refuse)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(BenchError::Locked { file: path.to_path_buf() }),
            Err(TryLockError::Error(source)) => return Err(refuse(source)),
        }
        let contents = read(path)?;
        if contents.is_torn {
            file.set_len(contents.whole_bytes).map_err(refuse)?;
        }
        Ok((Self { file, path: path.to_path_buf() }, contents))
    }

    /// Adds one record; when this returns it is on the disk.
    ///
    /// # Errors
    /// [`BenchError::Unwritable`].
    pub fn add(&mut self, record: &Record) -> Result<(), BenchError> {
        let mut write = || {
            let mut line = serde_json::to_vec(record).map_err(std::io::Error::other)?;
            line.push(b'\n');
            self.file.write_all(&line)?;
            self.file.sync_data()
        };
        write().map_err(|source| BenchError::Unwritable { file: self.path.clone(), source })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::record::tests::sample;

    #[test]
    fn a_torn_line_is_cut_off_wherever_the_kill_came() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.jsonl");
        let records: Vec<_> = (0..3).map(|seed| sample("caf\u{e9}", "default", seed, 0.5, true)).collect();
        let (mut journal, contents) = Journal::open(&path).unwrap();
        assert!(contents.records.is_empty() && !contents.is_torn);
        for record in &records {
            journal.add(record).unwrap();
        }
        drop(journal);
        let whole = std::fs::read(&path).unwrap();
        let second_ends = whole.len() - serde_json::to_vec(&records[2]).unwrap().len() - 1;
        for length in second_ends..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            let (mut journal, contents) = Journal::open(&path).unwrap();
            assert_eq!(contents.records, records[..2]);
            assert_eq!(contents.is_torn, length > second_ends);
            journal.add(&records[2]).unwrap();
            assert_eq!(std::fs::read(&path).unwrap(), whole);
        }
    }

    #[test]
    fn a_bad_line_in_the_middle_is_an_error_with_its_number() {
        let line = serde_json::to_string(&sample("bowl", "default", 0, 0.5, true)).unwrap();
        let message = parse(format!("{line}\n\n{{]\n{line}\n").as_bytes(), "r.jsonl").unwrap_err().to_string();
        assert!(message.starts_with("r.jsonl:3: is not the record of a run: "), "{message}");
    }

    #[test]
    fn two_benchmarks_do_not_write_to_one_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.jsonl");
        let _first = Journal::open(&path).unwrap();
        let second = Journal::open(&path).unwrap_err();
        assert!(second.to_string().contains("another benchmark is writing"), "{second}");
    }
}
