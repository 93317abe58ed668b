//! Writing a plan file, all of it or nothing.

use std::fmt::Display;
use std::path::Path;

use serde::Serialize as _;
use serde_json::Serializer;

use super::layout::Lines;
use super::{PlanFile, PlanFileError, Pose, Waypoint};
use crate::problem_file::paths::folder_of;
use crate::text_file;

impl PlanFile {
    /// The file's text: JSON with one waypoint per line and a final newline.
    ///
    /// # Laws
    /// A function of the plan alone; [`PlanFile::from_json`] gives back the same plan, every number bit for bit.
    ///
    /// # Errors
    /// [`PlanFileError::NotFinite`] for a number that JSON cannot express.
    pub fn to_json(&self) -> Result<String, PlanFileError> {
        self.check_finite()?;
        let mut bytes = Vec::new();
        let mut serializer = Serializer::with_formatter(&mut bytes, Lines::default());
        self.serialize(&mut serializer).map_err(PlanFileError::Json)?;
        bytes.push(b'\n');
        // The serializer writes nothing but UTF-8.
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// Writes the plan to `path`. The text first goes to a new file in the same folder, which then takes the place of
    /// `path`: whoever looks sees the old file, the whole new one, or none.
    ///
    /// Paths of meshes and of a robot description are written relative to the folder of `path`, so that the plan can be
    /// read from anywhere, and moved together with them; those that share no folder with it are written absolute.
    ///
    /// # Errors
    /// [`PlanFileError::Write`] with the path when the folder does not exist or cannot be written, and as
    /// [`PlanFile::to_json`].
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), PlanFileError> {
        let path = path.as_ref();
        text_file::replace(path, self.to_json_in(folder_of(path))?)
            .map_err(|source| PlanFileError::Write { file: path.display().to_string(), source })
    }

    /// [`PlanFile::to_json`] for a file in `folder`, with paths relative to it as [`PlanFile::write`] says.
    ///
    /// # Errors
    /// As [`PlanFile::to_json`].
    pub fn to_json_in(&self, folder: &Path) -> Result<String, PlanFileError> {
        if !self.problem.names_files() {
            return self.to_json();
        }
        let mut moved = self.clone();
        moved.problem.make_paths_start_at(folder);
        moved.to_json()
    }

    fn check_finite(&self) -> Result<(), PlanFileError> {
        waypoint(&self.start, "start")?;
        for (index, step) in self.steps.iter().enumerate() {
            if let Some(hold) = &step.holds {
                pose(&hold.tool_from_object, format_args!("steps[{index}].holds.tool_from_object"))?;
            }
            for (place, at) in step.waypoints.iter().enumerate() {
                waypoint(at, format_args!("steps[{index}].waypoints[{place}]"))?;
            }
        }
        let phases = self.timing.iter().flat_map(|timing| timing.steps.iter().enumerate());
        for (index, step) in phases {
            for (number, phase) in step.phases.iter().enumerate() {
                let key = || format!("timing.steps[{index}].phases[{number}]");
                let pieces = phase.profile.iter().flatten().chain(&phase.lengths).chain(&phase.blends);
                pieces.chain([&phase.wait_s, &phase.rest_s]).try_for_each(|value| numbers(&[*value], key()))?;
            }
        }
        self.timing.as_ref().map_or(Ok(()), |timing| numbers(&[timing.duration_s], "timing.duration_s"))
    }
}

fn waypoint(at: &Waypoint, key: impl Display) -> Result<(), PlanFileError> {
    numbers(&at.base, format_args!("{key}.base"))?;
    for (name, value) in &at.joints {
        numbers(&[*value], format_args!("{key}.joints.{name}"))?;
    }
    at.objects.iter().try_for_each(|(name, object)| pose(object, format_args!("{key}.objects.{name}")))
}

fn pose(pose: &Pose, key: impl Display) -> Result<(), PlanFileError> {
    numbers(&pose.position, format_args!("{key}.position"))?;
    numbers(&pose.quaternion, format_args!("{key}.quaternion"))
}

fn numbers(values: &[f64], key: impl Display) -> Result<(), PlanFileError> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(&value) => Err(PlanFileError::NotFinite { key: key.to_string(), value }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan_file::read::tests::sample;

    #[test]
    fn the_text_is_one_line_per_waypoint_and_reads_back_bit_for_bit() {
        let mut plan = sample();
        let awkward = [0.1 + 0.2, 1.0 / 3.0, 5e-324, -0.0, 1.797_693_134_862_315_7e308, 0.150_000_000_000_000_02];
        for (value, slot) in awkward.iter().zip(plan.start.joints.values_mut()) {
            *slot = *value;
        }
        let text = plan.to_json().unwrap();
        assert_eq!(text, plan.to_json().unwrap());
        assert_eq!(text.matches("\"base\": [-0.8, 0.0, 0.0]").count(), 2, "{text}");
        assert!(text.lines().any(|line| line.trim_start().starts_with("{\"base\"") && line.contains("\"objects\"")));
        let back = PlanFile::from_json(&text, "text").unwrap();
        assert_eq!(back, plan);
        let bits = |plan: &PlanFile| plan.start.joints.values().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back), bits(&plan));
        assert_eq!(back.to_json().unwrap(), text);
    }

    #[test]
    fn random_numbers_survive() {
        use rand::{RngExt as _, SeedableRng as _};
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(3);
        let mut plan = sample();
        for _ in 0..50 {
            for slot in plan.start.joints.values_mut() {
                *slot = rng.random_range(-3.2..3.2);
            }
            assert_eq!(PlanFile::from_json(&plan.to_json().unwrap(), "text").unwrap(), plan);
        }
    }

    #[test]
    fn numbers_that_are_none_are_refused_by_key() {
        let mut plan = sample();
        plan.steps[0].waypoints[1].base[2] = f64::NAN;
        let message = plan.to_json().unwrap_err().to_string();
        assert!(message.contains("steps[0].waypoints[1].base") && message.contains("NaN"), "{message}");
    }

    #[test]
    fn an_existing_file_is_replaced_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.json");
        let mut plan = sample();
        plan.write(&path).unwrap();
        plan.seed += 1;
        plan.write(&path).unwrap();
        assert_eq!(PlanFile::read(&path).unwrap(), plan);
        let before = std::fs::read_to_string(&path).unwrap();
        plan.start.base[0] = f64::INFINITY;
        assert!(plan.write(&path).is_err());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), before);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no part is left behind");
    }

    #[test]
    fn a_path_that_cannot_be_written_is_named() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path().join("no/such/folder/plan.json"), folder.path().to_path_buf()] {
            let error = sample().write(&path).unwrap_err();
            assert!(matches!(error, PlanFileError::Write { .. }));
            assert!(error.to_string().contains(&path.display().to_string()), "{error}");
        }
    }
}
