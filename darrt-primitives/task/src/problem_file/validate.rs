//! The rules of the format that types cannot express.
//!
//! In this order, first flaw wins: numbers are finite, names are unique and refer to something, values are in range
//! and consistent, everything stands where it may. Collisions and reach of the start are checked when the problem is
//! built, not here.

mod goals;
mod names;
mod numbers;
mod objects;
mod placement;
mod settings;
mod world;

use super::error::{Flaw, Located};
use super::suggest::shown;
use super::{ProblemFile, ProblemFileError, VERSION};

impl ProblemFile {
    /// Checks every rule of the format except those that need the robot's kinematics or a mesh file.
    ///
    /// Reading does this by itself; call it for a value that was edited, or that came from JSON. `source_name` is how
    /// the error calls the problem.
    ///
    /// # Errors
    /// [`ProblemFileError::Invalid`] for the first broken rule, with the path of the key, the value and the bound.
    pub fn validate(&self, source_name: &str) -> Result<(), ProblemFileError> {
        self.check().map_err(|(key, flaw)| ProblemFileError::Invalid {
            file: source_name.to_owned(),
            key: shown(&key),
            flaw: Box::new(flaw),
        })
    }

    fn check(&self) -> Result<(), Located> {
        if self.version == 0 || self.version > VERSION {
            let value = f64::from(self.version);
            let bound = format!("{VERSION}, the version this program reads");
            return Err(Flaw::OutOfRange { value, bound }.at("version"));
        }
        numbers::check_all_finite(self)?;
        names::check_unique(self)?;
        world::check(self)?;
        objects::check(self)?;
        goals::check(self)?;
        settings::check(self)?;
        placement::check(self)
    }
}

#[cfg(test)]
mod tests;
