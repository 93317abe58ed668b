//! What can be wrong with a shape, a scene or a mesh file.

use crate::bounded_file::FileError;

/// Why a geometric input was refused.
///
/// Every variant names the offending input, the value it had and the bound it broke, so that the message can be shown
/// to whoever wrote the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeomError {
    /// A number is NaN or infinite.
    #[error("{name} is {value}, but must be finite")]
    NotFinite {
        /// The input.
        name: String,
        /// Its value.
        value: f64,
    },
    /// A number lies outside its range.
    #[error("{name} is {value}, but must lie in [{minimum}, {maximum}]")]
    OutOfRange {
        /// The input.
        name: String,
        /// Its value.
        value: f64,
        /// Smallest admissible value.
        minimum: f64,
        /// Largest admissible value.
        maximum: f64,
    },
    /// A list is too short or too long.
    #[error(
        "{name} has {count} {}, but must have between {minimum} and {maximum}",
        if *count == 1 { "entry" } else { "entries" }
    )]
    Count {
        /// The list.
        name: String,
        /// Its length.
        count: usize,
        /// Smallest admissible length.
        minimum: usize,
        /// Largest admissible length.
        maximum: usize,
    },
    /// A shape has no extent where it needs some.
    #[error("{name}: {measure} is {value}, but must be at least {minimum}")]
    Degenerate {
        /// The shape.
        name: String,
        /// Which measure of it vanished (an area, a thickness, an edge length).
        measure: &'static str,
        /// Its value.
        value: f64,
        /// Smallest admissible value.
        minimum: f64,
    },
    /// Rounding kept the convex hull of some points from holding them all.
    #[error("the convex hull of {name} misses a point by {outlier} of its size, but at most {maximum} is allowed")]
    UnsoundHull {
        /// The hull.
        name: String,
        /// How far the worst point lies outside, over the size of the hull; 1 when no hull could be built at all.
        outlier: f64,
        /// Largest admissible value.
        maximum: f64,
    },
    /// Two edges of a polygon meet where they must not.
    #[error("{name}: edges {first} and {second} touch or cross, but the polygon must be simple")]
    SelfIntersecting {
        /// The polygon.
        name: String,
        /// Index of the first edge.
        first: usize,
        /// Index of the second edge.
        second: usize,
    },
    /// A name is empty.
    #[error("the name of a {what} is empty")]
    EmptyName {
        /// What kind of thing has no name.
        what: &'static str,
    },
    /// Two things of a kind bear the same name.
    #[error("two {what} are called `{name}`")]
    DuplicateName {
        /// What kind of thing (plural).
        what: &'static str,
        /// The name both bear.
        name: String,
    },
    /// A body without bound (a half space) was registered as moving.
    #[error("`{name}` is unbounded, so it must be fixed")]
    UnboundedMoving {
        /// The body.
        name: String,
    },
    /// An index names nothing.
    #[error("{name} is {index}, but only {count} exist")]
    UnknownIndex {
        /// Which index.
        name: String,
        /// Its value.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A triangle of a mesh names a vertex that does not exist.
    #[error("{name}: triangle {triangle} names vertex {vertex}, but only {count} exist")]
    UnknownVertex {
        /// The mesh.
        name: String,
        /// Index of the triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: usize,
        /// Number of vertices.
        count: usize,
    },
    /// A file was not read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A file is not what its ending promises.
    #[error("{path} is not a valid {format} file: {reason}")]
    Malformed {
        /// The file.
        path: String,
        /// The format expected.
        format: &'static str,
        /// What was wrong.
        reason: String,
    },
    /// A mesh file has an ending no reader answers to.
    #[error("{path} has the ending `{ending}`, but only `stl`, `obj`, `dae` and `glb` are read")]
    UnknownFormat {
        /// The file.
        path: String,
        /// Its ending, without the dot.
        ending: String,
    },
}
