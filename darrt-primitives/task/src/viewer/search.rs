//! A recorded search as a layer of the page.

use serde::{Deserialize, Serialize};

use crate::recording::{Attempt, Recording};

/// Most nodes and blocked extensions in a page, so that it stays one that a browser opens at once.
const MOST: usize = 20_000;

/// How the search went.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchData {
    /// Names of the primitives.
    pub primitives: Vec<String>,
    /// Names of what blocked.
    pub bodies: Vec<String>,
    /// Number of the attempt that found the plan.
    pub solved: Option<u64>,
    /// Nodes and blocked extensions that the page does not have.
    pub left_out: u64,
    /// The attempts, as in recordings.
    pub attempts: Vec<Attempt>,
}

impl SearchData {
    /// Of a recording: the last attempts, of which the last one is what there was to see, and of those as much as fits.
    pub fn of(recording: &Recording) -> Self {
        let size = |attempt: &Attempt| attempt.nodes.len() + attempt.blocked.len();
        let (mut room, mut left_out, mut attempts) = (MOST, recording.left_out, Vec::new());
        for attempt in recording.attempts.iter().rev() {
            let kept = if size(attempt) <= room { attempt.clone() } else { beginning(attempt, room) };
            left_out += (size(attempt) - size(&kept)) as u64;
            room -= size(&kept);
            if !kept.nodes.is_empty() {
                attempts.push(kept);
            }
        }
        attempts.reverse();
        Self {
            primitives: recording.primitives.clone(),
            bodies: recording.bodies.clone(),
            solved: recording.solved,
            left_out,
            attempts,
        }
    }
}

/// As many of the first iterations of an attempt as have room.
fn beginning(attempt: &Attempt, room: usize) -> Attempt {
    let mut marks: Vec<u64> = attempt.nodes.iter().map(|node| node.1).collect();
    marks.extend(attempt.blocked.iter().map(|blocked| blocked.0));
    marks.sort_unstable();
    // The iteration in which the first one too many came.
    let full = marks.get(room).copied().unwrap_or(u64::MAX);
    match full.checked_sub(1) {
        Some(last) => attempt.until(last),
        None => Attempt { nodes: Vec::new(), removed: Vec::new(), blocked: Vec::new(), ..attempt.clone() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Blocked, Node};

    #[test]
    fn a_beginning_fits_and_is_whole_iterations() {
        let nodes = (0..100_u32).map(|n| Node(n.checked_sub(1), u64::from(n.div_ceil(3)), None, [0.0; 3], Vec::new()));
        let attempt = Attempt {
            attempt: 3,
            iterations: 33,
            nodes: nodes.collect(),
            removed: vec![(5, 20)],
            blocked: (1..33).map(|i| Blocked(i, 0, 0, 0)).collect(),
        };
        let part = beginning(&attempt, 50);
        assert_eq!((part.nodes.len(), part.blocked.len(), part.iterations), (37, 12, 12));
        assert!(part.removed.is_empty());
        assert_eq!(beginning(&attempt, 200), attempt);
        assert!(beginning(&attempt, 0).nodes.is_empty());
    }
}
