//! A recorded search: every node of its trees, when it came, when it was taken back, and what blocked which extension.
//!
//! | question | file |
//! |---|---|
//! | how is it recorded? | `tape` |
//! | how does it become a file, and a file it? | `file` |
//! | as a graph for other programs? | [`graph`] |
//! | as a layer of the page? | [`viewer::search`](crate::viewer::search) |

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::problem_file::ProblemFile;
use crate::viewer::data::PoseData;

mod file;
pub mod graph;
mod tape;

pub use file::RecordingError;
pub(crate) use tape::Tape;

/// Most nodes that are kept; a node takes about a hundred bytes.
pub const MOST_NODES: usize = 1_000_000;
/// The only accepted version.
pub const VERSION: u32 = 1;

/// The only accepted value of the key `format`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum RecordingFormat {
    /// `"format": "darrt-recording"`.
    #[serde(rename = "darrt-recording")]
    DarrtRecording,
}

/// A recorded search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recording {
    /// Says what kind of file this is.
    pub format: RecordingFormat,
    /// Always [`VERSION`].
    pub version: u32,
    /// The problem.
    pub problem: ProblemFile,
    /// Seed of the search.
    pub seed: u64,
    /// Number of the attempt that found the plan; `null` if none did.
    pub solved: Option<u64>,
    /// Names of the primitives, to which nodes refer by index from 0.
    pub primitives: Vec<String>,
    /// Names of what blocked, to which blocked extensions refer by index from 0.
    pub bodies: Vec<String>,
    /// Nodes and blocked extensions that were not kept, because there were too many.
    pub left_out: u64,
    /// The attempts that decided the outcome, by number.
    pub attempts: Vec<Attempt>,
}

/// One attempt: a tree that grew from the start. What was left out of it is counted in [`Recording::left_out`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Attempt {
    /// Its number.
    pub attempt: u64,
    /// Iterations that it did.
    pub iterations: u64,
    /// The nodes in the order in which they came, the root first.
    pub nodes: Vec<Node>,
    /// Nodes that were taken back, because a motion to them is blocked: index, and the iteration.
    pub removed: Vec<(u32, u64)>,
    /// Extensions that were blocked.
    pub blocked: Vec<Blocked>,
}

/// One node: its parent (none for the root), the iteration in which it came, the primitive by index (none for the root), x, y and
/// yaw of the base, and the pose of each object that stands elsewhere than at the parent (at the root: of every one), by its index in
/// the problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Node(pub Option<u32>, pub u64, pub Option<u16>, pub [f64; 3], pub Vec<(u16, PoseData)>);

/// One blocked extension: the iteration, the node at which it ended, and the two bodies by index: what was moved, and what was in
/// its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Blocked(pub u64, pub u32, pub u32, pub u32);

impl Attempt {
    /// How the attempt was behind this iteration.
    #[must_use]
    pub fn until(&self, iteration: u64) -> Self {
        // Nodes come in order, so their indices stay.
        let nodes: Vec<_> = self.nodes.iter().take_while(|node| node.1 <= iteration).cloned().collect();
        Self {
            attempt: self.attempt,
            iterations: self.iterations.min(iteration),
            nodes,
            removed: self.removed.iter().copied().filter(|(_, at)| *at <= iteration).collect(),
            blocked: self.blocked.iter().copied().filter(|blocked| blocked.0 <= iteration).collect(),
        }
    }

    /// By node: is it still there?
    fn alive(&self) -> Vec<bool> {
        let mut alive = vec![true; self.nodes.len()];
        for (node, _) in &self.removed {
            if let Some(is) = alive.get_mut(*node as usize) {
                *is = false;
            }
        }
        alive
    }
}

impl Recording {
    /// The attempt with this number, or all; each as it was behind an iteration, if one is given.
    #[must_use]
    pub fn at(mut self, attempt: Option<u64>, iteration: Option<u64>) -> Self {
        self.attempts.retain(|own| attempt.is_none_or(|number| own.attempt == number));
        if let Some(at) = iteration {
            for own in &mut self.attempts {
                *own = own.until(at);
            }
        }
        self
    }
}
