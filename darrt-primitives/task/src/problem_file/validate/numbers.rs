//! Checks of single numbers, and the walk over all of them.

use std::f64::consts::TAU;

use toml::Value;

use crate::problem_file::error::{Flaw, Located};
use crate::problem_file::{LengthRange, ProblemFile};

/// Longest straight motion and deepest insertion of a grasp (m).
pub(super) const LONGEST_MOTION: f64 = 1.0;

/// Largest accepted magnitude of any number in a problem file.
const LARGEST: f64 = 1e6;

/// Smallest accepted size of a body (m): a micrometre.
const SMALLEST_SIZE: f64 = 1e-6;

/// Every number of the problem is finite and of a sane magnitude.
pub(super) fn check_all_finite(problem: &ProblemFile) -> Result<(), Located> {
    let value = Value::try_from(problem).map_err(|error| Flaw::Inconsistent(error.to_string()).at("problem"))?;
    walk(&value, "")
}

fn walk(value: &Value, key: &str) -> Result<(), Located> {
    match value {
        Value::Float(number) if number.is_nan() || number.abs() > LARGEST => {
            Err(Flaw::OutOfRange { value: *number, bound: format!("finite and at most {LARGEST} in magnitude") }
                .at(key))
        }
        Value::Array(values) => {
            values.iter().enumerate().try_for_each(|(index, value)| walk(value, &format!("{key}[{index}]")))
        }
        Value::Table(table) => table.iter().try_for_each(|(name, value)| {
            let separator = if key.is_empty() { "" } else { "." };
            walk(value, &format!("{key}{separator}{name}"))
        }),
        _ => Ok(()),
    }
}

/// `value` is in the closed range.
pub(super) fn within(key: &str, value: f64, low: f64, high: f64) -> Result<(), Located> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    let bound = format!("in [{low}, {high}]");
    Err(Flaw::OutOfRange { value, bound }.at(key))
}

/// `value` is an angle: what is more than a turn was meant in degrees.
pub(super) fn angle(key: &str, value: f64) -> Result<(), Located> {
    if value.abs() <= TAU {
        return Ok(());
    }
    let bound = "in radians, at most a full turn of 6.283".to_owned();
    Err(Flaw::OutOfRange { value, bound }.at(key))
}

/// `value` is greater than 0.
pub(super) fn positive(key: &str, value: f64) -> Result<(), Located> {
    if value > 0.0 {
        return Ok(());
    }
    let bound = "greater than 0".to_owned();
    Err(Flaw::OutOfRange { value, bound }.at(key))
}

/// `value` is a usable length of a body.
pub(super) fn size(key: &str, value: f64) -> Result<(), Located> {
    if value >= SMALLEST_SIZE {
        return Ok(());
    }
    let bound = format!("positive (at least {SMALLEST_SIZE})");
    Err(Flaw::OutOfRange { value, bound }.at(key))
}

/// A range does not end before it starts.
pub(super) fn ordered(key: &str, [low, high]: [f64; 2]) -> Result<(), Located> {
    if low <= high {
        return Ok(());
    }
    Err(Flaw::Inverted { low, high }.at(key))
}

/// The lengths of a straight motion are in order, and none is longer than [`LONGEST_MOTION`].
pub(super) fn motion(key: &str, range: LengthRange) -> Result<(), Located> {
    within(key, range.wanted_m, 0.0, LONGEST_MOTION)?;
    ordered(key, range.into())?;
    within(&format!("{key}[0]"), range.least_m, 0.0, LONGEST_MOTION)
}

/// A list has between `least` and `most` entries.
pub(super) fn length(key: &str, found: usize, least: usize, most: usize) -> Result<(), Located> {
    if (least..=most).contains(&found) {
        return Ok(());
    }
    let bound = if least == most { least.to_string() } else { format!("{least} to {most}") };
    Err(Flaw::WrongLength { found, bound }.at(key))
}
