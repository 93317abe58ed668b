//! The one motion of this domain: base and arm through given configurations, straight in joint space between them,
//! while an object is carried rigidly, pushed along a line, or left alone.

use std::fmt;

use darrt_core::motion::Motion;
use darrt_core::space::ComponentSpace;
use darrt_core::state::ObjectId;
use nalgebra::Isometry3;

use crate::manipulator::{Configuration, Manipulator};
use crate::mode::{Held, Mode};
use crate::tabletop::{Tabletop, TabletopState};

/// What moves along with the hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Carried {
    /// Nothing.
    Nothing,
    /// An object, rigid to the tool.
    Held(Held),
    /// An object that slides from its start pose to this one, in a straight line without turning.
    Pushed(ObjectId, Isometry3<f64>),
}

/// One configuration on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint<J> {
    /// Base and arm.
    pub robot: Configuration<J>,
    /// How much of the pushed object's way is done here, in `[0, 1]`; ignored unless an object is pushed.
    pub pushed: f64,
}

/// A motion through waypoints. Its parameter is proportional to the bound on the travel.
pub struct ArmMotion<M: Manipulator> {
    start: TabletopState<M>,
    waypoints: Vec<Waypoint<M::Joints>>,
    knots: Vec<f64>,
    carried: Carried,
    during: Mode,
    after: Mode,
    length_m: f64,
}

impl<M: Manipulator> ArmMotion<M> {
    /// From `start` through `waypoints` (the start itself not among them). The mode is `during` on the open interval
    /// and `after` at its end.
    pub fn new(
        m: &Tabletop<M>,
        start: &TabletopState<M>,
        waypoints: &[Waypoint<M::Joints>],
        carried: Carried,
        during: Mode,
        after: Mode,
    ) -> Self {
        let reach_m = m.held_reach_m(&during);
        let mut all = Vec::with_capacity(waypoints.len() + 1);
        all.push(Waypoint { robot: start.robot, pushed: 0.0 });
        all.extend_from_slice(waypoints);
        let mut travelled = Vec::with_capacity(all.len());
        let mut length_m = 0.0;
        travelled.push(0.0);
        for pair in all.windows(2) {
            if let [a, b] = pair {
                length_m += m.manipulator().travel_m(&a.robot, &b.robot, reach_m);
                travelled.push(length_m);
            }
        }
        let knots = travelled.iter().map(|s| if length_m > 0.0 { s / length_m } else { 0.0 }).collect();
        Self { start: start.clone(), waypoints: all, knots, carried, during, after, length_m }
    }

    /// The configurations that it passes through, the start first.
    pub fn waypoints(&self) -> &[Waypoint<M::Joints>] {
        &self.waypoints
    }

    /// What moves along.
    pub fn carried(&self) -> &Carried {
        &self.carried
    }

    fn waypoint_at(&self, m: &Tabletop<M>, t: f64) -> Waypoint<M::Joints> {
        use darrt_core::domain::Domain;
        let first = Waypoint { robot: self.start.robot, pushed: 0.0 };
        let last = self.waypoints.last().copied().unwrap_or(first);
        if t >= 1.0 {
            return last;
        }
        let leg = self.knots.partition_point(|k| *k <= t);
        let (Some(a), Some(b)) = (self.waypoints.get(leg.wrapping_sub(1)), self.waypoints.get(leg)) else {
            return last;
        };
        let (Some(from), Some(to)) = (self.knots.get(leg.wrapping_sub(1)), self.knots.get(leg)) else { return last };
        let s = (t - from) / (to - from);
        Waypoint { robot: m.robot().interpolate(&a.robot, &b.robot, s), pushed: a.pushed + (b.pushed - a.pushed) * s }
    }
}

impl<M: Manipulator> Motion<Tabletop<M>> for ArmMotion<M> {
    fn length(&self) -> f64 {
        self.length_m
    }

    fn knots(&self) -> &[f64] {
        &self.knots
    }

    fn at_into(&self, m: &Tabletop<M>, t: f64, out: &mut TabletopState<M>) {
        let t = t.clamp(0.0, 1.0);
        out.clone_from(&self.start);
        if t <= 0.0 {
            return;
        }
        let here = self.waypoint_at(m, t);
        out.robot = here.robot;
        match self.carried {
            Carried::Nothing => {}
            Carried::Held(held) => {
                if let Some(pose) = out.objects.get_mut(held.object.index()) {
                    *pose = m.manipulator().world_from_tool(&here.robot) * held.tool_from_object;
                }
            }
            Carried::Pushed(object, to) => {
                if let Some(pose) = out.objects.get_mut(object.index()) {
                    let from = pose.translation.vector;
                    pose.translation.vector = from + (to.translation.vector - from) * here.pushed;
                }
            }
        }
        out.mode.clone_from(if t >= 1.0 { &self.after } else { &self.during });
    }
}

impl<M: Manipulator> fmt::Debug for ArmMotion<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ArmMotion")
            .field("waypoints", &self.waypoints)
            .field("carried", &self.carried)
            .field("during", &self.during)
            .field("after", &self.after)
            .finish_non_exhaustive()
    }
}
