//! What can be wrong with a problem before the search begins. Expected failures inside the search are
//! not errors: see [`Infeasible`](crate::primitive::Infeasible) and [`Stop`](crate::budget::Stop).

use crate::validity::Blame;

/// A malformed problem or option. Every variant names the thing, its value and the bound it breaks.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number lies outside its documented range.
    #[error("{name} is {value}, but must be {bound}")]
    Parameter {
        /// Which option or field.
        name: String,
        /// The value found.
        value: f64,
        /// The range it must lie in, in words.
        bound: &'static str,
    },
    /// A state or target has the wrong number of objects.
    #[error("{what} has {found} objects, but the domain has {expected}")]
    ObjectCount {
        /// Which state or target.
        what: &'static str,
        /// How many it has.
        found: usize,
        /// How many the domain has.
        expected: usize,
    },
    /// More objects than a [`ComponentSet`](crate::state::ComponentSet) can name.
    #[error("the domain has {found} objects, but at most {bound} are supported")]
    TooManyObjects {
        /// How many the domain has.
        found: usize,
        /// The largest supported number.
        bound: usize,
    },
    /// A component of the start lies outside its space.
    #[error("the start of {component} lies outside its space: {config}")]
    StartOutside {
        /// Name of the component.
        component: String,
        /// Its configuration, printed.
        config: String,
    },
    /// The start breaks a validity rule.
    #[error("the start is not valid: {0}")]
    StartInvalid(Blame),
    /// No primitive was given.
    #[error("the problem has no primitives, but needs at least one")]
    NoPrimitives,
    /// Two primitives carry one name, so a person could not tell their counts apart.
    #[error("the primitive name {0:?} is used twice, but must be unique")]
    DuplicatePrimitive(&'static str),
    /// A sample of the goal lies outside the space of a component.
    #[error("the goal asks {component} to be at {config}, outside its space")]
    GoalOutside {
        /// Name of the component.
        component: String,
        /// The configuration asked for, printed.
        config: String,
    },
}

/// Checks that `value` is finite and lies in `[lower, upper]`.
///
/// # Errors
/// [`Error::Parameter`] with the name, the value and the bound in words.
pub fn in_range(name: &str, value: f64, lower: f64, upper: f64, bound: &'static str) -> Result<f64, Error> {
    if value.is_finite() && value >= lower && value <= upper {
        Ok(value)
    } else {
        Err(Error::Parameter { name: name.to_owned(), value, bound })
    }
}
