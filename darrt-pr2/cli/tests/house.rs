//! The house holds its rule: no file outside `darrt-pr2` names the PR2 (tests, examples and docs aside), no crate names one
//! above it, and no decision is a comparison of names.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says what is wrong by panicking")]

use std::path::{Path, PathBuf};

/// The crates from the lowest to the highest: folder, name in code.
const CRATES: [(&str, &str); 7] = [
    ("darrt-core", "darrt_core"),
    ("darrt-geom", "darrt_geom"),
    ("darrt-primitives", "darrt_primitives"),
    ("darrt-primitives/task", "darrt_task"),
    ("darrt-primitives/execute", "darrt_execute"),
    ("darrt-pr2", "darrt_pr2"),
    ("darrt-pr2/cli", "darrt_cli"),
];

/// The sources of a crate, without those of tests, each with its text up to its unit tests.
fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    let mut folders = vec![root.join(folder).join("src")];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") && !path.ends_with("tests.rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                let code = text.split("\n#[cfg(").next().unwrap_or_default().to_owned();
                found.push((path, code));
            }
        }
    }
    assert!(found.len() > 10, "{folder}: the sources are there");
    // Written for unit tests only.
    found.retain(|(path, _)| !path.ends_with("task/src/testing.rs"));
    found
}

#[test]
fn nobody_but_the_pr2_names_the_pr2() {
    for (folder, _) in &CRATES[..5] {
        for (path, code) in sources(folder) {
            for (number, line) in (1..).zip(code.lines()) {
                assert!(!line.to_lowercase().contains("pr2"), "{}:{number}: {line}", path.display());
            }
        }
    }
}

#[test]
fn no_crate_names_one_above_it() {
    for (place, (folder, _)) in CRATES.iter().enumerate() {
        for (path, code) in sources(folder) {
            for (_, above) in &CRATES[place + 1..] {
                // Examples in the documentation may.
                let code = code.lines().filter(|line| !line.trim_start().starts_with("//"));
                let named = code.clone().find(|line| line.contains(&format!("{above}::")));
                assert!(named.is_none(), "{}: {}", path.display(), named.unwrap());
            }
        }
    }
}

#[test]
fn no_decision_compares_the_name_of_a_primitive() {
    for (folder, _) in CRATES {
        for (path, code) in sources(folder) {
            for (number, line) in (1..).zip(code.lines()) {
                let is_name = line.contains("primitive.name()") || line.contains("primitive.as_str()");
                let decides = line.contains("==") || line.contains("!=") || line.contains("match ");
                // Examples in the documentation may: they ask for what they want.
                let decides = decides && !line.trim_start().starts_with("//");
                assert!(!(is_name && decides), "{}:{number}: {line}", path.display());
            }
        }
    }
}

/// A package whose tests are one program runs only those that its `tests/main.rs` names.
#[test]
fn no_file_of_tests_is_forgotten() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    let mut asked = 0;
    for (folder, _) in CRATES {
        let tests = root.join(folder).join("tests");
        let Ok(main) = std::fs::read_to_string(tests.join("main.rs")) else { continue };
        let manifest = std::fs::read_to_string(root.join(folder).join("Cargo.toml")).unwrap();
        for entry in std::fs::read_dir(&tests).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            if path.extension().is_none_or(|ending| ending != "rs") || name == "main" {
                continue;
            }
            let is_named = main.contains(&format!("mod {name};")) || manifest.contains(&format!("tests/{name}.rs"));
            assert!(is_named, "{} is in no program of tests", path.display());
            asked += 1;
        }
    }
    assert!(asked > 30, "the tests are there: {asked}");
}
