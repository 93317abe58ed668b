//! Keeps what the planner tells of its trees.

use std::collections::BTreeMap;

use darrt_core::record::{Growth, Recorder};
use darrt_core::validity::Blame;
use darrt_primitives::tabletop::{Tabletop, TabletopState};

use super::{Attempt, Blocked, MOST_NODES, Node, Recording, RecordingFormat, VERSION};
use crate::problem_file::ProblemFile;
use crate::robot::TaskRobot;
use crate::viewer::data::{PoseData, pose, rounded};

/// What has been told so far.
#[derive(Debug, Default)]
pub(crate) struct Tape {
    reels: BTreeMap<u64, Reel>,
    bodies: Vec<String>,
    indices: BTreeMap<String, u32>,
    /// Nodes and blocked extensions that are kept, and those that are not.
    count: usize,
    left_out: u64,
}

/// One attempt.
#[derive(Debug)]
struct Reel {
    kept: Attempt,
    /// The numbers of the nodes that are there, and of each the index under which it is kept.
    alive: Vec<(u32, Option<u32>)>,
}

impl Tape {
    /// The recording of the attempts up to `last`.
    pub(crate) fn wound_up(
        self,
        problem: &ProblemFile,
        seed: u64,
        primitives: Vec<String>,
        (last, solved): (u64, Option<u64>),
    ) -> Recording {
        let reels = self.reels.into_values().map(|reel| reel.kept);
        let mut attempts: Vec<_> = reels.filter(|kept| kept.attempt <= last).collect();
        let bodies = renumbered(&self.bodies, &mut attempts);
        Recording {
            format: RecordingFormat::DarrtRecording,
            version: VERSION,
            problem: problem.clone(),
            seed,
            solved,
            primitives,
            bodies,
            left_out: self.left_out,
            attempts,
        }
    }

    fn body(&mut self, name: &str) -> u32 {
        if let Some(index) = self.indices.get(name) {
            return *index;
        }
        let index = u32::try_from(self.bodies.len()).unwrap_or(u32::MAX);
        self.bodies.push(name.to_owned());
        self.indices.insert(name.to_owned(), index);
        index
    }

    /// Counts one more; whether there is room for it.
    fn has_room(&mut self) -> bool {
        let has_room = self.count < MOST_NODES;
        if has_room {
            self.count += 1;
        } else {
            self.left_out += 1;
        }
        has_room
    }
}

/// Numbers the bodies in the order in which the attempts, one after the other, name them: which thread named one first does not
/// matter then.
fn renumbered(names: &[String], attempts: &mut [Attempt]) -> Vec<String> {
    let mut new = BTreeMap::<u32, u32>::new();
    let mut order = Vec::new();
    for Blocked(_, _, first, second) in attempts.iter_mut().flat_map(|attempt| &mut attempt.blocked) {
        for body in [first, second] {
            let next = u32::try_from(order.len()).unwrap_or(u32::MAX);
            let index = *new.entry(*body).or_insert(next);
            if index == next {
                order.push(names.get(*body as usize).cloned().unwrap_or_default());
            }
            *body = index;
        }
    }
    order
}

impl Reel {
    /// Notes the nodes that are no longer there.
    fn forget(&mut self, births: &[u32], iteration: u64) {
        // The order stays, so the first ones are as they were if the last of them is.
        let last = self.alive.last().map(|(birth, _)| birth);
        if self.alive.len().checked_sub(1).and_then(|at| births.get(at)) == last {
            return;
        }
        let is_there = |birth: u32| births.binary_search(&birth).is_ok();
        let (here, gone): (Vec<_>, Vec<_>) = self.alive.drain(..).partition(|(birth, _)| is_there(*birth));
        self.alive = here;
        self.kept.removed.extend(gone.into_iter().filter_map(|(_, index)| Some((index?, iteration))));
    }

    fn index_of(&self, birth: u32) -> Option<u32> {
        let at = self.alive.binary_search_by_key(&birth, |(birth, _)| *birth).ok()?;
        self.alive.get(at)?.1
    }
}

/// The objects that stand elsewhere than in `before`.
fn moved<M: TaskRobot>(state: &TabletopState<M>, before: Option<&TabletopState<M>>) -> Vec<(u16, PoseData)> {
    let stands = |index: usize| before.and_then(|before| before.objects.get(index));
    let moved = state.objects.iter().enumerate().filter(|(index, at)| stands(*index) != Some(*at));
    moved.filter_map(|(index, at)| Some((u16::try_from(index).ok()?, pose(at)))).collect()
}

impl<M: TaskRobot> Recorder<Tabletop<M>> for Tape {
    fn on_growth(&mut self, attempt: u64, iteration: u64, growth: &Growth<'_, Tabletop<M>>, blame: Option<&Blame>) {
        let (tree, births) = (growth.tree, growth.tree.births());
        let mut reel = self.reels.remove(&attempt).unwrap_or_else(|| Reel {
            kept: Attempt { attempt, iterations: 0, nodes: Vec::new(), removed: Vec::new(), blocked: Vec::new() },
            alive: Vec::new(),
        });
        reel.kept.iterations = iteration;
        let extended = growth.extended.and_then(|birth| reel.index_of(birth));
        reel.forget(births, iteration);
        let (known, before) = (reel.alive.len(), reel.kept.nodes.len());
        for (node, birth) in tree.since(known).zip(births.iter().skip(known)) {
            let edge = node.edge.as_ref();
            let parent = edge.and_then(|edge| reel.index_of(*births.get(edge.parent.index())?));
            // What hangs on a node that was left out is left out.
            let is_kept = (edge.is_none() || parent.is_some()) && self.has_room();
            let index = u32::try_from(reel.kept.nodes.len()).ok().filter(|_| is_kept);
            if index.is_some() {
                let from = edge.and_then(|edge| tree.node(edge.parent)).map(|parent| &parent.state);
                let base = node.state.robot.base.map(rounded);
                let objects = moved::<M>(&node.state, from);
                reel.kept.nodes.push(Node(parent, iteration, edge.map(|edge| edge.primitive), base, objects));
            }
            reel.alive.push((*birth, index));
        }
        let last = reel.kept.nodes.len().checked_sub(1).filter(|last| *last >= before && iteration > 0);
        let end = last.and_then(|last| u32::try_from(last).ok()).or(extended);
        if let (Some(blame), Some(end)) = (blame, end)
            && self.has_room()
        {
            let [first, second] = [&blame.first, &blame.second].map(|name| self.body(name));
            reel.kept.blocked.push(Blocked(iteration, end, first, second));
        }
        self.reels.insert(attempt, reel);
    }
}
