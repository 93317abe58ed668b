//! Balanced counts: every extension puts every primitive into exactly one bucket.

use std::collections::BTreeMap;

use crate::primitive::Infeasible;
use crate::validity::{Blame, BlockKind};

/// Where one primitive ended in one extension. Later variants got further.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(usize)]
pub enum Bucket {
    /// Never useful on the way.
    NotUseful,
    /// Useful, but another primitive was drawn.
    NotChosen,
    /// The budget ended before the extension did.
    Budget,
    /// Tried; the object has no fitting grasp.
    NoGrasp,
    /// Tried; no fitting grasp would hold the object.
    NoHold,
    /// Tried; no contact moves the object the right way.
    NoContact,
    /// Tried; the object would not stay at the contacts, or is too heavy.
    UnstablePush,
    /// Tried; no robot configuration reaches.
    Unreachable,
    /// Tried, or run; outside limits.
    Limits,
    /// Tried, or run; the object would leave its support.
    OffSupport,
    /// Tried; ended where the path had been.
    NoProgress,
    /// Propagated behind a step that was already blocked.
    Behind,
    /// Blocked, on the way or already where the primitive looked for a way: robot against obstacle.
    RobotFixed,
    /// Blocked: robot against itself.
    RobotItself,
    /// Blocked: robot against object.
    RobotObject,
    /// Blocked: object against obstacle.
    ObjectFixed,
    /// Blocked: object against object.
    ObjectObject,
    /// Blocked by another rule.
    Other,
    /// The last primitive of a path that reached the depth bound.
    Depth,
    /// Free from end to end.
    Accepted,
}

impl Bucket {
    /// All buckets, in order.
    pub const ALL: [Self; 20] = [
        Self::NotUseful,
        Self::NotChosen,
        Self::Budget,
        Self::NoGrasp,
        Self::NoHold,
        Self::NoContact,
        Self::UnstablePush,
        Self::Unreachable,
        Self::Limits,
        Self::OffSupport,
        Self::NoProgress,
        Self::Behind,
        Self::RobotFixed,
        Self::RobotItself,
        Self::RobotObject,
        Self::ObjectFixed,
        Self::ObjectObject,
        Self::Other,
        Self::Depth,
        Self::Accepted,
    ];

    /// A short heading for tables.
    pub fn heading(self) -> &'static str {
        match self {
            Self::NotUseful => "not useful",
            Self::NotChosen => "not chosen",
            Self::Budget => "budget",
            Self::NoGrasp => "no grasp",
            Self::NoHold => "no hold",
            Self::NoContact => "no contact",
            Self::UnstablePush => "unstable push",
            Self::Unreachable => "unreachable",
            Self::Limits => "limits",
            Self::OffSupport => "off support",
            Self::NoProgress => "no progress",
            Self::Behind => "behind a block",
            Self::RobotFixed => "robot-obstacle",
            Self::RobotItself => "robot-itself",
            Self::RobotObject => "robot-object",
            Self::ObjectFixed => "object-obstacle",
            Self::ObjectObject => "object-object",
            Self::Other => "other rule",
            Self::Depth => "depth",
            Self::Accepted => "accepted",
        }
    }
}

impl From<&Infeasible> for Bucket {
    fn from(why: &Infeasible) -> Self {
        match why {
            Infeasible::NoGrasp => Self::NoGrasp,
            Infeasible::NoHold => Self::NoHold,
            Infeasible::NoContact => Self::NoContact,
            Infeasible::UnstablePush => Self::UnstablePush,
            Infeasible::Unreachable => Self::Unreachable,
            Infeasible::Limits => Self::Limits,
            Infeasible::OffSupport => Self::OffSupport,
            Infeasible::NoProgress => Self::NoProgress,
            Infeasible::Blocked(blame) => Self::from(blame.kind),
        }
    }
}

impl From<BlockKind> for Bucket {
    fn from(kind: BlockKind) -> Self {
        match kind {
            BlockKind::RobotFixed => Self::RobotFixed,
            BlockKind::RobotItself => Self::RobotItself,
            BlockKind::RobotObject => Self::RobotObject,
            BlockKind::ObjectFixed => Self::ObjectFixed,
            BlockKind::ObjectObject => Self::ObjectObject,
            BlockKind::Limits => Self::Limits,
            BlockKind::OffSupport => Self::OffSupport,
            BlockKind::Other => Self::Other,
        }
    }
}

/// Counts of one or several attempts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Accounts {
    names: Vec<&'static str>,
    counts: Vec<[u64; Bucket::ALL.len()]>,
    /// Extensions counted.
    pub extensions: u64,
    /// Extensions that met their target.
    pub met: u64,
    /// Extensions that added no state at all.
    pub empty: u64,
    /// States added to trees.
    pub added: u64,
    /// Plans that the verifier refused.
    pub refused: u64,
    /// Plans that were given up because a motion that had been taken as free is not.
    pub withdrawn: u64,
    /// How often which pair of bodies blocked an extension.
    pub blocks: BTreeMap<(String, String), u64>,
}

impl Accounts {
    /// Empty counts for primitives of these names.
    pub fn new(names: Vec<&'static str>) -> Self {
        let counts = vec![[0; Bucket::ALL.len()]; names.len()];
        Self { names, counts, ..Self::default() }
    }

    /// Counts one extension: exactly one bucket per primitive.
    pub fn count(&mut self, buckets: &[Bucket], added: usize, is_met: bool, blame: Option<&Blame>) {
        self.extensions += 1;
        self.met += u64::from(is_met);
        self.empty += u64::from(added == 0);
        self.added += added as u64;
        for (row, bucket) in self.counts.iter_mut().zip(buckets) {
            if let Some(cell) = row.get_mut(*bucket as usize) {
                *cell += 1;
            }
        }
        if let Some(blame) = blame {
            self.note(blame);
        }
    }

    /// Counts a plan that was given up with `removed` states, because of this.
    pub fn withdraw(&mut self, removed: usize, blame: &Blame) {
        self.withdrawn += 1;
        self.added = self.added.saturating_sub(removed as u64);
        self.note(blame);
    }

    fn note(&mut self, blame: &Blame) {
        *self.blocks.entry((blame.first.to_string(), blame.second.to_string())).or_default() += 1;
    }

    /// Adds the counts of another attempt at the same problem.
    pub fn merge(&mut self, other: &Self) {
        if self.names.is_empty() {
            *self = other.clone();
            return;
        }
        for (mine, theirs) in self.counts.iter_mut().zip(&other.counts) {
            mine.iter_mut().zip(theirs).for_each(|(a, b)| *a += b);
        }
        self.extensions += other.extensions;
        self.met += other.met;
        self.empty += other.empty;
        self.added += other.added;
        self.refused += other.refused;
        self.withdrawn += other.withdrawn;
        for (pair, n) in &other.blocks {
            *self.blocks.entry(pair.clone()).or_default() += n;
        }
    }

    /// One row per primitive: its name and how often it ended in each bucket.
    pub fn rows(&self) -> impl Iterator<Item = (&'static str, &[u64; Bucket::ALL.len()])> {
        self.names.iter().copied().zip(&self.counts)
    }

    /// Does every row sum to the number of extensions?
    pub fn are_balanced(&self) -> bool {
        self.counts.iter().all(|row| row.iter().sum::<u64>() == self.extensions)
    }

    /// The pairs of bodies that blocked most often, most first; ties by name.
    pub fn worst_blocks(&self, most: usize) -> Vec<(&(String, String), u64)> {
        let mut all: Vec<_> = self.blocks.iter().map(|(pair, n)| (pair, *n)).collect();
        all.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(b.0)));
        all.truncate(most);
        all
    }
}
