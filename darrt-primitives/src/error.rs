//! What can be wrong with the inputs of this crate.
//!
//! Every variant carries the offending name, its value and the bound it broke. Expected failures of
//! the search (no reachable contact, no room at an edge) are not errors: the functions concerned
//! answer with `Option` or a small `Copy` enum of their own.

use darrt_geom::GeomError;

/// A malformed input: a number out of range, an unknown name, an unreadable description.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PrimitiveError {
    /// A number is NaN or infinite.
    #[error("{name} must be finite, found {value}")]
    NotFinite {
        /// Which input.
        name: &'static str,
        /// What was found.
        value: f64,
    },
    /// A number that must be above zero is not.
    #[error("{name} must be above 0, found {value}")]
    NotPositive {
        /// Which input.
        name: &'static str,
        /// What was found.
        value: f64,
    },
    /// A number lies outside its closed range.
    #[error("{name} must lie in [{low}, {high}], found {value}")]
    OutOfRange {
        /// Which input.
        name: &'static str,
        /// What was found.
        value: f64,
        /// Smallest permitted value.
        low: f64,
        /// Largest permitted value.
        high: f64,
    },
    /// A number that must stay strictly below a bound does not.
    #[error("{name} must be below {bound}, found {value}")]
    NotBelow {
        /// Which input.
        name: &'static str,
        /// What was found.
        value: f64,
        /// The bound it must stay below.
        bound: f64,
    },
    /// A list has the wrong number of entries.
    #[error("{name} must have {expected} entries, found {found}")]
    WrongCount {
        /// Which list.
        name: &'static str,
        /// How many entries it has.
        found: usize,
        /// How many it must have.
        expected: usize,
    },
    /// A list that needs at least one entry is empty.
    #[error("{name} must not be empty")]
    Empty {
        /// Which list.
        name: &'static str,
    },
    /// A name that nothing answers to.
    #[error("there is no {what} named \"{name}\"")]
    Unknown {
        /// The kind of thing looked for: joint, link, frame.
        what: &'static str,
        /// The name looked for.
        name: String,
    },
    /// Two things of one kind share a name.
    #[error("two {what}s are named \"{name}\"")]
    Duplicate {
        /// The kind of thing.
        what: &'static str,
        /// The shared name.
        name: String,
    },
    /// A description (a robot file, a record) that cannot be read.
    #[error("{what} cannot be used: {detail}")]
    Malformed {
        /// What was being read.
        what: &'static str,
        /// Where and why it failed, with the offending value.
        detail: String,
    },
    /// A shape or surface was refused by the geometry crate.
    #[error(transparent)]
    Geometry(#[from] GeomError),
}

/// `value` when it is finite.
pub(crate) fn finite(name: &'static str, value: f64) -> Result<f64, PrimitiveError> {
    if value.is_finite() { Ok(value) } else { Err(PrimitiveError::NotFinite { name, value }) }
}

/// `value` when it is finite and above zero.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, PrimitiveError> {
    if finite(name, value)? > 0.0 { Ok(value) } else { Err(PrimitiveError::NotPositive { name, value }) }
}

/// `value` when it is finite and inside the closed range `[low, high]`.
pub(crate) fn within(name: &'static str, value: f64, low: f64, high: f64) -> Result<f64, PrimitiveError> {
    if (low..=high).contains(&finite(name, value)?) {
        Ok(value)
    } else {
        Err(PrimitiveError::OutOfRange { name, value, low, high })
    }
}

/// `value` when it is finite, above zero and strictly below `bound`.
pub(crate) fn positive_below(name: &'static str, value: f64, bound: f64) -> Result<f64, PrimitiveError> {
    if positive(name, value)? < bound { Ok(value) } else { Err(PrimitiveError::NotBelow { name, value, bound }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checks_name_the_value_and_the_bound() {
        assert_eq!(positive("mass", 0.5), Ok(0.5));
        assert_eq!(positive("mass", 0.0), Err(PrimitiveError::NotPositive { name: "mass", value: 0.0 }));
        let nan = finite("mass", f64::NAN);
        assert!(matches!(nan, Err(PrimitiveError::NotFinite { .. })));
        assert_eq!(within("tilt", 2.0, -1.0, 1.0).unwrap_err().to_string(), "tilt must lie in [-1, 1], found 2");
        assert_eq!(positive_below("gap", 0.3, 0.28).unwrap_err().to_string(), "gap must be below 0.28, found 0.3");
    }
}
