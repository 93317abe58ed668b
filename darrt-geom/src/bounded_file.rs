//! Files that others wrote, read without trusting their size or kind.
//!
//! A pipe that nobody writes to, a device without end and a file larger than the memory are refused by what the file
//! system says about them, before a byte is read.

use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Why a file was not read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The file cannot be opened or read.
    #[error("{path}: cannot be read: {reason}")]
    Unreadable {
        /// The file.
        path: String,
        /// The kind of error.
        kind: std::io::ErrorKind,
        /// The operating system's words.
        reason: String,
    },
    /// The path leads to a folder, a pipe, a device or the like.
    #[error("{path}: is not a regular file")]
    NotAFile {
        /// The path.
        path: String,
    },
    /// The file is larger than allowed.
    #[error("{path}: has {bytes} bytes, at most {limit} are read")]
    TooLarge {
        /// The file.
        path: String,
        /// Its size.
        bytes: u64,
        /// The largest size read.
        limit: u64,
    },
    /// The file is not UTF-8 text.
    #[error("{path}: is not UTF-8 text, the byte at offset {offset} is not valid")]
    NotUtf8 {
        /// The file.
        path: String,
        /// Offset of the first bad byte.
        offset: usize,
    },
}

/// The content of the regular file at `path` (links are followed), at most `limit` bytes of it.
///
/// # Errors
/// [`FileError`] with the path when it leads to anything but a regular file, the file is larger than `limit`, or it
/// cannot be read.
pub fn read_bytes(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let shown = || path.display().to_string();
    let unreadable =
        |error: std::io::Error| FileError::Unreadable { path: shown(), kind: error.kind(), reason: error.to_string() };
    // Asked of the path, not of the open file: opening a pipe would already wait for its writer.
    let told = std::fs::metadata(path).map_err(unreadable)?;
    if !told.is_file() {
        return Err(FileError::NotAFile { path: shown() });
    }
    check_length(told.len(), &shown(), limit)?;
    // The size told can be wrong (growing files, those of the kernel), so the reading is bounded as well.
    bounded(File::open(path).map_err(unreadable)?, &shown(), limit)
}

/// What is left of `source`, at most `limit` bytes of it.
fn bounded(source: impl Read, name: &str, limit: u64) -> Result<Vec<u8>, FileError> {
    let mut bytes = Vec::new();
    source.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(|error| FileError::Unreadable {
        path: name.to_owned(),
        kind: error.kind(),
        reason: error.to_string(),
    })?;
    check_length(bytes.len() as u64, name, limit)?;
    Ok(bytes)
}

fn utf8(bytes: Vec<u8>, name: &str) -> Result<String, FileError> {
    String::from_utf8(bytes)
        .map_err(|error| FileError::NotUtf8 { path: name.to_owned(), offset: error.utf8_error().valid_up_to() })
}

/// What is left of `source`, as UTF-8 text, at most `limit` bytes of it; `name` is what messages call it.
///
/// # Errors
/// [`FileError`] with the name when it is longer, cannot be read, or is no text.
pub fn read_stream(source: impl Read, name: &str, limit: u64) -> Result<String, FileError> {
    utf8(bounded(source, name, limit)?, name)
}

/// As [`read_bytes`], for UTF-8 text.
///
/// # Errors
/// As [`read_bytes`], and [`FileError::NotUtf8`].
pub fn read_text(path: &Path, limit: u64) -> Result<String, FileError> {
    utf8(read_bytes(path, limit)?, &path.display().to_string())
}

/// Refuses a content of more than `limit` bytes; `name` is what the message calls it.
///
/// # Errors
/// [`FileError::TooLarge`].
pub fn check_length(bytes: u64, name: &str, limit: u64) -> Result<(), FileError> {
    if bytes > limit { Err(FileError::TooLarge { path: name.to_owned(), bytes, limit }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_read_up_to_the_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text");
        std::fs::write(&path, "abcé").unwrap();
        assert_eq!(read_text(&path, 5).unwrap(), "abcé");
        assert!(matches!(read_text(&path, 4), Err(FileError::TooLarge { bytes: 5, limit: 4, .. })));
        std::fs::write(&path, b"abc\xff").unwrap();
        assert!(matches!(read_text(&path, 5), Err(FileError::NotUtf8 { offset: 3, .. })));
        assert_eq!(read_bytes(&path, 5).unwrap(), b"abc\xff");
        assert_eq!(read_bytes(&path, u64::MAX).unwrap(), b"abc\xff");
    }

    #[test]
    fn streams_are_read_up_to_the_limit() {
        assert_eq!(read_stream("abc".as_bytes(), "s", 3).unwrap(), "abc");
        assert!(matches!(read_stream("abcd".as_bytes(), "s", 3), Err(FileError::TooLarge { bytes: 4, .. })));
        assert!(matches!(read_stream(&b"a\xff"[..], "s", 3), Err(FileError::NotUtf8 { offset: 1, .. })));
    }

    #[test]
    fn missing_and_large_files_and_folders_are_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large");
        let missing = read_bytes(&path, 10).unwrap_err();
        assert!(matches!(missing, FileError::Unreadable { kind: std::io::ErrorKind::NotFound, .. }));
        assert!(missing.to_string().contains("large: cannot be read: "), "{missing}");
        // A sparse file: a terabyte that is never written.
        File::create(&path).unwrap().set_len(1 << 40).unwrap();
        let large = read_bytes(&path, 10).unwrap_err().to_string();
        assert!(large.ends_with("large: has 1099511627776 bytes, at most 10 are read"), "{large}");
        assert!(matches!(read_bytes(folder.path(), 10), Err(FileError::NotAFile { .. })));
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_refused_without_waiting() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let link = folder.path().join("link");
        std::os::unix::fs::symlink(&pipe, &link).unwrap();
        for path in [pipe.as_path(), link.as_path(), Path::new("/dev/zero")] {
            assert!(matches!(read_bytes(path, 10), Err(FileError::NotAFile { .. })), "{}", path.display());
        }
    }
}
