//! What can be wrong with a problem file.

use darrt_geom::GeomError;
use thiserror::Error;

use super::suggest::{hint, listed, shown};
use crate::text_file::TextFileError;
use crate::toml_error::TomlError;

/// A problem file that cannot be used, with the place and the reason.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ProblemFileError {
    /// The file or text is none that is given to the parser.
    #[error(transparent)]
    Text(#[from] TextFileError),
    /// The file is something else, and says so.
    #[error("{file}: {what}")]
    OtherKind {
        /// The file.
        file: String,
        /// What it is, and which command takes it.
        what: String,
    },
    /// The text is not TOML, or a key or value is not part of the format.
    #[error(transparent)]
    Syntax(#[from] TomlError),
    /// A key holds a value that breaks a rule of the format.
    #[error("{file}: `{key}` {flaw}")]
    Invalid {
        /// The file.
        file: String,
        /// Path of the key, such as `obstacle[3].shape.box.size[1]`; indices count from 0.
        key: String,
        /// The broken rule.
        flaw: Box<Flaw>,
    },
    /// There is no embedded problem and no file of this name.
    #[error(
        "there is no problem file or built-in problem `{name}`{}; built-in problems: {}",
        hint(nearest.as_deref()),
        listed(available)
    )]
    UnknownProblem {
        /// What was asked for.
        name: String,
        /// The nearest built-in name.
        nearest: Option<String>,
        /// All built-in names.
        available: Vec<String>,
    },
}

/// A broken rule, worded to follow the path of the key.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Flaw {
    /// A number is outside its bound.
    #[error("is {value}, must be {bound}")]
    OutOfRange {
        /// The number.
        value: f64,
        /// The bound in words.
        bound: String,
    },
    /// A name holds characters that do something to a terminal.
    #[error("is \"{}\", a name must not have control characters", shown(name))]
    Unprintable {
        /// The name.
        name: String,
    },
    /// A count or length is outside its bound.
    #[error("has {found} {}, must have {bound}", if *found == 1 { "entry" } else { "entries" })]
    WrongLength {
        /// How many there are.
        found: usize,
        /// The bound in words.
        bound: String,
    },
    /// A range ends before it starts.
    #[error("is the range [{low}, {high}], its lower end must not exceed its upper end")]
    Inverted {
        /// Lower end as written.
        low: f64,
        /// Upper end as written.
        high: f64,
    },
    /// A quaternion is not of unit length.
    #[error("has the norm {norm}, a unit quaternion [x, y, z, w] must have 1 within {tolerance}")]
    NotUnit {
        /// The norm.
        norm: f64,
        /// The tolerance.
        tolerance: f64,
    },
    /// A name refers to nothing.
    #[error(
        "names the {kind} `{value}`, which does not exist{}; there are: {}",
        hint(nearest.as_deref()),
        listed(available)
    )]
    UnknownName {
        /// Kind of thing.
        kind: &'static str,
        /// The name.
        value: String,
        /// The nearest valid name.
        nearest: Option<String>,
        /// The valid names.
        available: Vec<String>,
    },
    /// Two things have the same name.
    #[error("is `{name}`, a name already taken by `{taken_by}`")]
    Duplicate {
        /// The name.
        name: String,
        /// Path of the key that has it.
        taken_by: String,
    },
    /// An object or goal is not on its surface.
    #[error(
        "puts `{name}` at [{}, {}], {} m outside the surface `{surface}`; its centre must be inside",
        at[0], at[1], metres(*outside)
    )]
    OffSurface {
        /// What is placed.
        name: String,
        /// World x, y.
        at: [f64; 2],
        /// How far outside (m).
        outside: f64,
        /// The surface.
        surface: String,
    },
    /// A surface is above or inside its body.
    #[error(
        "puts the surface `{surface}` at the height {height}, but the top of its body `{body}` is at {}; they may differ \
         by {tolerance} m",
        metres(*top)
    )]
    NotOnTop {
        /// The surface.
        surface: String,
        /// Its height (m).
        height: f64,
        /// Its body.
        body: String,
        /// The height of the body (m).
        top: f64,
        /// The largest difference (m).
        tolerance: f64,
    },
    /// A corner of a surface is not on its body.
    #[error(
        "is the corner [{}, {}] of the surface `{surface}`, {} m beside its body `{body}`; at most {tolerance} m is on it",
        corner[0], corner[1], metres(*outside)
    )]
    BesideBody {
        /// The surface.
        surface: String,
        /// World x, y.
        corner: [f64; 2],
        /// How far from the body (m).
        outside: f64,
        /// The body.
        body: String,
        /// How far is near enough (m).
        tolerance: f64,
    },
    /// A mesh has no upper face where a surface is.
    #[error(
        "puts the surface `{surface}` at the height {height}, but at [{}, {}] its body `{body}` has {}; a face that looks \
         up must be within {tolerance} m",
        metres(at[0]), metres(at[1]),
        nearest.map_or_else(|| "nothing".to_owned(), |z| format!("its nearest face at {}", metres(z)))
    )]
    NoFace {
        /// The surface.
        surface: String,
        /// Its height (m).
        height: f64,
        /// Its body, a mesh.
        body: String,
        /// World x, y.
        at: [f64; 2],
        /// Height of the nearest face there, which may be an underside (m).
        nearest: Option<f64>,
        /// The largest difference (m).
        tolerance: f64,
    },
    /// A shape, mesh or polygon that cannot be built.
    #[error("cannot be built: {0}")]
    Geometry(#[from] GeomError),
    /// Keys contradict each other, one is missing, or a value makes no sense with another.
    #[error("{0}")]
    Inconsistent(String),
}

/// Metres, to a tenth of a millimetre but never to 0.
fn metres(length: f64) -> f64 {
    if length.abs() < 1e-4 { length } else { (length * 1e4).round() / 1e4 }
}

/// A flaw and the path of the key that has it.
pub(crate) type Located = (String, Flaw);

impl Flaw {
    /// The flaw at `key`.
    pub(crate) fn at(self, key: impl Into<String>) -> Located {
        (key.into(), self)
    }
}
