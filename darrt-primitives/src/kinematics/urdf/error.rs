//! What can be wrong with a robot description.

use std::path::PathBuf;

use darrt_geom::FileError;

/// Why a robot description was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// The file was not read.
    #[error(transparent)]
    File(FileError),
    /// The file was read, and its text refused.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong with its text.
        source: Box<UrdfError>,
    },
    /// The text or a tag is too long.
    #[error("{what} of {bytes} bytes is longer than the {bound} bytes accepted")]
    TooLarge {
        /// What is too long.
        what: &'static str,
        /// Its length; for a tag, the length up to where reading stopped.
        bytes: usize,
        /// The bound.
        bound: usize,
    },
    /// Elements nest too deeply.
    #[error("elements nest {depth} deep at byte {offset}; at most {bound} are accepted")]
    TooDeep {
        /// The depth reached.
        depth: usize,
        /// The bound.
        bound: usize,
        /// Byte offset of the element.
        offset: usize,
    },
    /// Too many of something.
    #[error("{count} {what}; at most {bound} are accepted")]
    TooMany {
        /// What is counted.
        what: &'static str,
        /// The count reached.
        count: usize,
        /// The bound.
        bound: usize,
    },
    /// The text has a document type declaration (or another `<!` construct).
    #[error("document type declaration at byte {offset}; none is accepted")]
    DocumentType {
        /// Byte offset.
        offset: usize,
    },
    /// The text is not well-formed XML.
    #[error("not well-formed at byte {offset}: {what}")]
    Malformed {
        /// What is wrong.
        what: &'static str,
        /// Byte offset.
        offset: usize,
    },
    /// The text is XML but not a URDF.
    #[error("not a robot description: {message}")]
    Syntax {
        /// What the URDF reader said.
        message: String,
    },
    /// A name that means nothing and is nearly one that does.
    #[error("line {line}: there is no {kind} `{name}` here, did you mean `{nearest}`?")]
    UnknownWord {
        /// `element` or `attribute`.
        kind: &'static str,
        /// The name.
        name: String,
        /// The nearest known one.
        nearest: &'static str,
        /// Line of the text, from 1.
        line: u32,
    },
    /// Something that planning needs is not there.
    #[error("line {line}: {element} has no {missing}")]
    Lacks {
        /// The element.
        element: String,
        /// What is missing.
        missing: &'static str,
        /// Line of the text, from 1.
        line: u32,
    },
    /// A text that xacro has not been run on.
    #[error("line {line}: {found} is left over from xacro; run xacro on the file first")]
    Xacro {
        /// What is left over.
        found: String,
        /// Line of the text, from 1.
        line: u32,
    },
    /// A link that is seen and cannot be touched.
    #[error(
        "link {link:?} has a visual and no collision, so planning would not see it; give it a collision, or list it in \
         `robot.shapeless`"
    )]
    VisualOnly {
        /// The link.
        link: String,
    },
    /// A link that is not there.
    #[error("there is no link {name:?}")]
    NoSuchLink {
        /// Its name.
        name: String,
    },
    /// A number is not finite.
    #[error("{element}: {quantity} is {value}, not a finite number")]
    NotFinite {
        /// The link or joint.
        element: String,
        /// What the number says.
        quantity: &'static str,
        /// The number.
        value: f64,
    },
    /// A number that must be positive (or not negative) is not.
    #[error("{element}: {quantity} is {value}; it must be {bound}")]
    OutOfBounds {
        /// The link or joint.
        element: String,
        /// What the number says.
        quantity: &'static str,
        /// The number.
        value: f64,
        /// What it must be.
        bound: &'static str,
    },
    /// A joint's lower limit exceeds its upper one.
    #[error("joint {joint}: {which} limits [{lower}, {upper}] are in the wrong order")]
    LimitOrder {
        /// The joint.
        joint: String,
        /// `hard` or `soft`.
        which: &'static str,
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// A joint's axis has no direction.
    #[error("joint {joint}: axis ({x}, {y}, {z}) has no direction")]
    ZeroAxis {
        /// The joint.
        joint: String,
        /// First component.
        x: f64,
        /// Second component.
        y: f64,
        /// Third component.
        z: f64,
    },
    /// Two elements of one kind share a name.
    #[error("two {kind}s are named {name:?}")]
    DuplicateName {
        /// `link` or `joint`.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// A name does not resolve.
    #[error("joint {joint}: {role} {name:?} does not exist")]
    Dangling {
        /// The joint that names it.
        joint: String,
        /// `parent link`, `child link` or `mimicked joint`.
        role: &'static str,
        /// The name.
        name: String,
    },
    /// A link hangs on two joints.
    #[error("link {link:?} is the child of both {first:?} and {second:?}")]
    TwoParents {
        /// The link.
        link: String,
        /// First joint.
        first: String,
        /// Second joint.
        second: String,
    },
    /// There is no link.
    #[error("the robot has no link; at least one is needed")]
    NoLink,
    /// Two links have no parent.
    #[error("links {first:?} and {second:?} are both roots; exactly one is needed")]
    SeveralRoots {
        /// First root.
        first: String,
        /// Second root.
        second: String,
    },
    /// Links form a loop.
    #[error("link {link:?} is part of, or hangs on, a loop of joints")]
    Cycle {
        /// A link that cannot be reached from a root.
        link: String,
    },
    /// Joints mimic one another in a circle.
    #[error("joint {joint:?} mimics itself, directly or through others")]
    MimicCycle {
        /// A joint in (or behind) the circle.
        joint: String,
    },
    /// A joint type this library does not move.
    #[error("joint {joint:?} is {kind}; fixed, revolute, continuous and prismatic joints are supported")]
    UnsupportedJoint {
        /// The joint.
        joint: String,
        /// Its type.
        kind: &'static str,
    },
    /// A mesh of the description could not be found or read.
    #[error("link {link:?}: mesh {filename:?}: {reason}")]
    Mesh {
        /// The link.
        link: String,
        /// The name as written in the description.
        filename: String,
        /// Why not.
        reason: String,
    },
    /// A shape was refused by the geometry library.
    #[error("link {link:?}: collision geometry {index}: {reason}")]
    Shape {
        /// The link.
        link: String,
        /// Index among the link's collision elements.
        index: usize,
        /// Why not.
        reason: String,
    },
}
