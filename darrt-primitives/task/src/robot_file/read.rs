//! Reading a robot file: guards first, then TOML, then numbers.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use darrt_primitives::kinematics::MeshPlaces;

use super::error::Fault;
use super::{ArmTables, RobotFile, RobotFileError, VERSION};
use crate::file_kind::FileKind;
use crate::problem_file::arrays::check_lengths;
use crate::problem_file::error::Flaw;
use crate::problem_file::nesting::check_nesting;
use crate::problem_file::suggest::shown;
use crate::problem_file::toml_path::line_of;
use crate::text_file;
use crate::toml_error::TomlError;

/// Largest accepted robot file in bytes (1 MiB).
pub const MAX_BYTES: u64 = 1024 * 1024;

/// A robot file with the text that it was read from, so that what is found later can say its line.
#[derive(Debug, Clone)]
pub struct Source {
    /// What it says.
    pub file: RobotFile,
    /// How errors call it.
    pub name: String,
    /// Where relative paths start; `None` for a text that is no file.
    pub folder: Option<PathBuf>,
    text: String,
}

impl Source {
    /// Reads the robot file at `path`.
    ///
    /// # Errors
    /// [`RobotFileError`] with the file, the line and the reason.
    pub fn read(path: &Path) -> Result<Self, RobotFileError> {
        let name = path.display().to_string();
        let text = text_file::read(path, MAX_BYTES)?;
        let folder = path.parent().map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
        Self::parse(&text, &name, folder.map(Path::to_path_buf))
    }

    /// Reads a robot file from its text; `name` is how errors call it.
    ///
    /// # Errors
    /// As [`Source::read`].
    pub fn from_text(text: &str, name: &str) -> Result<Self, RobotFileError> {
        Self::parse(text, name, None)
    }

    fn parse(text: &str, name: &str, folder: Option<PathBuf>) -> Result<Self, RobotFileError> {
        if FileKind::of_text(text) == Some(FileKind::Description) {
            let why = FileKind::Description.instead_of_problem(name).unwrap_or_default();
            return Err(RobotFileError::OtherKind { file: name.to_owned(), why });
        }
        text_file::check(text, name, MAX_BYTES, check_nesting)?;
        let raw = toml::from_str::<toml::Value>(text).ok();
        let version = raw.as_ref().and_then(|raw| raw.get("version")?.as_integer());
        let newer = version.filter(|version| *version > i64::from(VERSION));
        if let Some(version) = newer {
            let why = format!("is {version}, must be {VERSION}: the file is newer than what this program reads");
            return Err(located(text, name, Fault::new("version", why)));
        }
        let file: RobotFile = toml::from_str(text).map_err(|error| TomlError::of(&error, text, name))?;
        if let Some(raw) = &raw {
            let is_wrong = |(key, flaw): (String, Flaw)| located(text, name, Fault::new(key, flaw.to_string()));
            check_lengths(raw, &file).map_err(is_wrong)?;
        }
        let source = Self { file, name: name.to_owned(), folder, text: text.to_owned() };
        source.check_numbers().map_err(|fault| source.located(fault))?;
        Ok(source)
    }

    /// The error for what is wrong with a key of this file, with its line.
    pub fn located(&self, fault: Fault) -> RobotFileError {
        located(&self.text, &self.name, fault)
    }

    /// The line of a key, from 1.
    pub fn line(&self, key: &str) -> usize {
        line(&self.text, key)
    }

    /// A path of this file from the working folder.
    pub fn path(&self, path: &Path) -> PathBuf {
        self.folder.as_ref().map_or_else(|| path.to_path_buf(), |folder| folder.join(path))
    }

    /// The path of the description from the working folder.
    pub fn urdf(&self) -> PathBuf {
        self.path(&self.file.urdf)
    }

    /// Where the meshes of the description are looked for.
    pub fn meshes(&self) -> MeshPlaces {
        let mut places = MeshPlaces::around(&self.urdf());
        for (name, folder) in &self.file.packages {
            places.add_package(name, self.path(folder));
        }
        places
    }

    fn check_numbers(&self) -> Result<(), Fault> {
        let file = &self.file;
        let is_version = file.version == VERSION;
        let wrong = |key: &str, value: f64, bound: &str| Fault::new(key, format!("is {value}, must be {bound}"));
        if !is_version {
            return Err(wrong("version", f64::from(file.version), "1"));
        }
        let is_name = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
        if file.name.is_empty() || !file.name.chars().all(is_name) {
            let why = format!("is \"{}\", must be lower-case letters, digits, `-` and `_`", shown(&file.name));
            return Err(Fault::new("name", why));
        }
        let speeds = [("base.speed", file.base.speed), ("base.loaded_speed", file.base.loaded_speed)];
        let speeds = speeds.into_iter().flat_map(|(key, both)| both.map(|value| (key.to_owned(), value, 1e2)));
        let positive = file.arms().flat_map(|tables| arm_numbers(&tables));
        for (key, value, most) in positive.chain(speeds) {
            if !(value > 0.0 && value <= most) {
                return Err(wrong(&key, value, &format!("above 0 and at most {most}")));
            }
        }
        let poses = [
            ("base.xyz", file.base.xyz),
            ("base.rpy", file.base.rpy),
            ("tool.xyz", file.tool.xyz),
            ("tool.rpy", file.tool.rpy),
            ("base.rail_axis", file.base.rail_axis.unwrap_or_default()),
            ("hand.xyz", file.hand.as_ref().map(|hand| hand.xyz).unwrap_or_default()),
            ("hand.rpy", file.hand.as_ref().map(|hand| hand.rpy).unwrap_or_default()),
        ];
        let second = file.second.iter().map(|second| &second.tool);
        let second = second.flat_map(|tool| [("second.tool.xyz", tool.xyz), ("second.tool.rpy", tool.rpy)]);
        for (key, values) in poses.into_iter().chain(second) {
            if let Some(value) = values.into_iter().find(|value| value.abs() > 1e2 || value.is_nan()) {
                return Err(wrong(key, value, "in [-100, 100]"));
            }
            if let Some(value) = values.into_iter().find(|value| key.ends_with("rpy") && value.abs() > TAU) {
                return Err(wrong(key, value, "in radians, at most a full turn of 6.283"));
            }
        }
        Ok(())
    }
}

/// The numbers of an arm that must be positive, each with the most that it may be.
fn arm_numbers(tables: &ArmTables<'_>) -> Vec<(String, f64, f64)> {
    let ArmTables { arm, gripper, .. } = tables;
    let positive = [
        ("arm.payload_kg", arm.payload_kg, 1e4),
        ("arm.push_force_n", arm.push_force_n, 1e5),
        ("gripper.pad_length_m", gripper.pad_length_m, 1.0),
        ("gripper.grip_force_n", gripper.grip_force_n, 1e5),
    ];
    let gap = gripper.max_gap_m.map(|value| ("gripper.max_gap_m", value, 1.0));
    let lists = [("arm.speeds", &arm.speeds), ("arm.accelerations", &arm.accelerations)];
    let lists = lists.into_iter().flat_map(|(key, list)| list.iter().flatten().map(move |value| (key, *value, 1e4)));
    let all = positive.into_iter().chain(gap).chain(lists);
    all.map(|(key, value, most)| (tables.key(key), value, most)).collect()
}

fn line(text: &str, key: &str) -> usize {
    line_of(text, key).map_or(1, |offset| text_file::line_and_column(text, offset).0)
}

fn located(text: &str, name: &str, fault: Fault) -> RobotFileError {
    let line = line(text, &fault.key);
    RobotFileError::Invalid { file: name.to_owned(), line, key: shown(&fault.key), why: fault.why }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file_robot::shipped;

    fn message(text: &str) -> String {
        Source::from_text(text, "my.toml").unwrap_err().to_string()
    }

    #[test]
    fn what_is_wrong_has_its_line_and_the_nearest_name() {
        let text = shipped::all()[0].text;
        assert!(Source::from_text(text, "my.toml").is_ok());
        let line = |part: &str| text.lines().position(|line| line.contains(part)).unwrap() + 1;
        let misspelt = message(&text.replace("payload_kg", "paylod_kg"));
        assert!(misspelt.starts_with(&format!("my.toml:{}:", line("payload_kg"))), "{misspelt}");
        assert!(misspelt.contains("did you mean `payload_kg`?"), "{misspelt}");
        let newer = message(&text.replace("version = 1", "version = 2"));
        assert!(newer.contains(&format!("my.toml:{}: `version` is 2", line("version"))), "{newer}");
        let negative = text.lines().find(|line| line.starts_with("payload_kg")).unwrap();
        let negative = message(&text.replace(negative, "payload_kg = -1"));
        assert!(negative.contains(&format!("my.toml:{}: `arm.payload_kg` is -1", line("payload_kg"))), "{negative}");
        assert!(message("format = = 1").starts_with("my.toml:1:"));
        let turned = text.lines().find(|line| line.starts_with("rpy")).unwrap();
        let degrees = message(&text.replace(turned, "rpy = [0, -90, 0]"));
        assert!(degrees.contains("rpy` is -90, must be in radians"), "{degrees}");
    }

    #[test]
    fn an_array_with_an_entry_too_many_is_refused() {
        let text = shipped::all()[0].text;
        let pose = text.lines().find(|line| line.starts_with("xyz = [")).unwrap();
        let longer = message(&text.replace(pose, "xyz = [0, 0, 0.1, 5]"));
        assert!(longer.contains(".xyz` has 4 entries, must have 3"), "{longer}");
    }
}
