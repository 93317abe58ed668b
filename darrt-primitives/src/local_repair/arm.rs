//! A way around for the arm: a small bidirectional search between the ends of a blocked motion.
//!
//! # Source
//! Kuffner and `LaValle`, RRT-Connect: an efficient approach to single-query path planning, ICRA 2000.

use darrt_core::domain::Domain;
use darrt_core::space::ComponentSpace;
use darrt_geom::body_set::BodySet;
use rand::{Rng, RngExt};

use crate::collision_scene::{Strict, Worker};
use crate::manipulator::{Configuration, JointVector as _, Manipulator};
use crate::mode::Contacts;
use crate::tabletop::{Tabletop, TabletopState};

/// How hard the search tries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmRepair {
    /// States that are checked before it gives up.
    pub states: usize,
    /// Travel bound between two states that are checked, metres. The search looks at samples only: the way that it
    /// returns is judged like every other motion.
    pub spacing_m: f64,
    /// Longest straight motion, metres of travel bound.
    pub step_m: f64,
    /// Shortcuts that are tried on the way found.
    pub shortcuts: usize,
}

impl Default for ArmRepair {
    fn default() -> Self {
        Self { states: 1500, spacing_m: 0.12, step_m: 3.0, shortcuts: 6 }
    }
}

/// What stops short of its end is kept only if it got at least this far, as a share of the way.
const WORTH: f64 = 0.1;

/// One of the two trees: configurations and the index of their parents.
#[derive(Debug)]
struct Grove<J> {
    nodes: Vec<(Configuration<J>, usize)>,
}

/// The search between two ends.
struct Search<'a, M: Manipulator> {
    m: &'a Tabletop<M>,
    worker: &'a mut Worker,
    /// What moves, and what it may meet.
    pairs: (BodySet, BodySet),
    /// The state looked at last.
    state: TabletopState<M>,
    states_left: usize,
    spacing_m: f64,
    step_m: f64,
}

impl ArmRepair {
    /// Configurations from that of `from` to that of `end`, both among them; only the arm moves. Objects and mode are as in
    /// `inside`, with which the motion begins. With this [care](darrt_core::validity::Validity::most_care). `None` if no way is found.
    pub(super) fn find<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        care: usize,
        inside: &TabletopState<M>,
        from: &TabletopState<M>,
        end: &TabletopState<M>,
        rng: &mut dyn Rng,
    ) -> Option<Vec<Configuration<M::Joints>>> {
        let around = m.collision_scene();
        around.with_worker(|worker| {
            around.pose_all(m.manipulator(), inside, worker);
            around.set_rules(inside, &Contacts::default(), Strict::with(care), worker);
            let pairs = (around.moved(inside, end), BodySet::ALL);
            let (spacing_m, step_m) = (self.spacing_m, self.step_m);
            let mut search =
                Search { m, worker, pairs, state: inside.clone(), states_left: self.states, spacing_m, step_m };
            let mut way = search.connect(&from.robot, &end.robot, rng)?;
            search.shorten(&mut way, self.shortcuts, rng);
            Some(way)
        })
    }
}

impl<M: Manipulator> Search<'_, M> {
    /// Is nothing in the way with the robot at `q`, what it holds in its hand?
    fn is_free(&mut self, q: &Configuration<M::Joints>) -> bool {
        self.states_left = self.states_left.saturating_sub(1);
        let robot = self.m.manipulator();
        self.state.robot = *q;
        if let Some(held) = self.state.mode.held()
            && let Some(pose) = self.state.objects.get_mut(held.object.index())
        {
            *pose = robot.world_from_tool(q) * held.tool_from_object;
            // The bounds of an object are no matter of touching.
            if self.m.objects().get(held.object.index()).is_some_and(|space| !space.contains(pose)) {
                return false;
            }
            if self.m.tilt_left_rad(&self.state).is_some_and(|left| left < 0.0) {
                return false;
            }
        }
        let (moved, against) = &self.pairs;
        let around = self.m.collision_scene();
        around.pose(robot, &self.state, moved, self.worker);
        around.is_clear(self.worker, moved, against)
    }

    /// How far the straight way from `a`, which is free, to `b` seems to be free, in `[0, 1]`.
    fn free_share(&mut self, a: &Configuration<M::Joints>, b: &Configuration<M::Joints>) -> f64 {
        let length_m = self.m.manipulator().travel_m(a, b, self.m.held_reach_m(&self.state.mode));
        let steps = (length_m / self.spacing_m).ceil().clamp(1.0, 1000.0);
        let mut i = 1.0;
        while i <= steps {
            if !self.is_free(&self.m.robot().interpolate(a, b, i / steps)) {
                return (i - 1.0) / steps;
            }
            i += 1.0;
        }
        1.0
    }

    /// A random configuration of the arm: a posture now and then, else anywhere.
    fn sample(
        &self,
        a: &Configuration<M::Joints>,
        b: &Configuration<M::Joints>,
        rng: &mut dyn Rng,
    ) -> Configuration<M::Joints> {
        let mut q = self.m.robot().sample(rng);
        let postures = &self.m.settings().postures;
        q.base = a.base;
        if !postures.is_empty() && rng.random_bool(0.15) {
            if let Some(posture) = postures.get(rng.random_range(0..postures.len())) {
                q.arm = *posture;
            }
        } else if rng.random_bool(0.5) {
            // Around the straight way: most obstacles are passed by a small excursion.
            let s = rng.random_range(0.0..1.0);
            let on_line = self.m.robot().interpolate(a, b, s);
            q = self.m.robot().interpolate(&on_line, &q, 0.35);
        }
        q.arm = q.arm.with_hand_at_work(b.arm.hand_at_work());
        q
    }

    fn connect(
        &mut self,
        from: &Configuration<M::Joints>,
        to: &Configuration<M::Joints>,
        rng: &mut dyn Rng,
    ) -> Option<Vec<Configuration<M::Joints>>> {
        let mut near = Grove { nodes: vec![(*from, 0)] };
        let mut far = Grove { nodes: vec![(*to, 0)] };
        let mut swapped = false;
        while self.states_left > 0 {
            let q = self.sample(from, to, rng);
            let (active, other) = if swapped { (&mut far, &mut near) } else { (&mut near, &mut far) };
            if let Some(grown) = self.grow(active, &q) {
                let target = active.nodes.get(grown)?.0;
                let met = self.reach(other, &target);
                if let Some(met) = met {
                    let (a, b) = if swapped { (met, grown) } else { (grown, met) };
                    let mut way = near.back_from(a);
                    way.reverse();
                    way.extend(far.back_from(b).into_iter().skip(1));
                    return Some(way);
                }
            }
            swapped = !swapped;
        }
        None
    }

    /// One straight motion from the nearest node of `grove` towards `q`, at most a step long. The index of the new node.
    fn grow(&mut self, grove: &mut Grove<M::Joints>, q: &Configuration<M::Joints>) -> Option<usize> {
        let parent = grove.nearest(self.m, q)?;
        let at = grove.nodes.get(parent)?.0;
        let held_reach_m = self.m.held_reach_m(&self.state.mode);
        let length = self.m.manipulator().travel_m(&at, q, held_reach_m);
        let target = if length > self.step_m { self.m.robot().interpolate(&at, q, self.step_m / length) } else { *q };
        let share = self.free_share(&at, &target);
        if share < WORTH {
            return None;
        }
        let reached = if share >= 1.0 { target } else { self.m.robot().interpolate(&at, &target, share) };
        grove.nodes.push((reached, parent));
        Some(grove.nodes.len() - 1)
    }

    /// Grows `grove` to `q` as far as it goes; the index of the node at `q` if it gets there.
    fn reach(&mut self, grove: &mut Grove<M::Joints>, q: &Configuration<M::Joints>) -> Option<usize> {
        while self.states_left > 0 {
            let grown = self.grow(grove, q)?;
            let here = grove.nodes.get(grown)?.0;
            if here == *q {
                return Some(grown);
            }
            let from = grove.nodes.get(grove.nodes.get(grown)?.1)?.0;
            // Blocked before the end of its step: the way is not free.
            let held_reach_m = self.m.held_reach_m(&self.state.mode);
            if self.m.manipulator().travel_m(&from, &here, held_reach_m) < 0.99 * self.step_m {
                return None;
            }
        }
        None
    }

    /// Drops waypoints between which the straight way is free.
    fn shorten(&mut self, way: &mut Vec<Configuration<M::Joints>>, tries: usize, rng: &mut dyn Rng) {
        for _ in 0..tries {
            if way.len() < 3 {
                return;
            }
            let i = rng.random_range(0..way.len() - 2);
            let j = rng.random_range(i + 2..way.len());
            let (Some(a), Some(b)) = (way.get(i).copied(), way.get(j).copied()) else { return };
            if self.free_share(&a, &b) >= 1.0 {
                way.drain(i + 1..j);
            }
        }
    }
}

impl<J: Copy> Grove<J> {
    fn nearest<M: Manipulator<Joints = J>>(&self, m: &Tabletop<M>, q: &Configuration<J>) -> Option<usize>
    where
        J: crate::manipulator::JointVector,
    {
        let distances = self.nodes.iter().map(|(node, _)| m.robot().distance(node, q));
        distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0))).map(|(i, _)| i)
    }

    /// The configurations from node `index` back to the root.
    fn back_from(&self, mut index: usize) -> Vec<Configuration<J>> {
        let mut way = Vec::new();
        while let Some((q, parent)) = self.nodes.get(index) {
            way.push(*q);
            if *parent == index {
                break;
            }
            index = *parent;
        }
        way
    }
}
