//! The one motion of this domain: base and arm through given configurations, straight in joint space between them,
//! while an object is carried rigidly, pushed along a line or an arc, or left alone.

use std::borrow::Cow;
use std::fmt;

use darrt_core::domain::Domain;
use darrt_core::motion::Motion;
use darrt_core::space::ComponentSpace;
use darrt_core::state::ObjectId;
use nalgebra::Isometry3;

use crate::configurations::Configurations;
use crate::heading_drive;
use crate::manipulator::{Configuration, Manipulator};
use crate::mode::{Held, Mode};
use crate::push::slide::Slide;
use crate::tabletop::{Tabletop, TabletopState};

/// What moves along with the hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Carried {
    /// Nothing.
    Nothing,
    /// An object, rigid to the tool.
    Held(Held),
    /// An object that slides from its start pose to this one: in a straight line, or along an arc if it is turned about the
    /// vertical ([`Slide`]).
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
///
/// Nearly every node of a tree has a motion of its own, so it keeps no more of the state that it starts from than it must.
pub struct ArmMotion<M: Manipulator> {
    way: Configurations<M::Joints>,
    /// Where the objects are at the start.
    objects: Box<[Isometry3<f64>]>,
    /// `None`: those of a single segment.
    knots: Option<Box<[f64]>>,
    load: Load,
    before: Mode,
    during: Mode,
    after: Mode,
    length_m: f64,
}

/// The knots of a motion of a single segment.
const SINGLE_SEGMENT: [f64; 2] = [0.0, 1.0];

/// What moves along, as it is kept.
enum Load {
    Nothing,
    /// What the mode on the way says that the hand holds: nearly always that is what is carried.
    AsHeld,
    Held(Box<Held>),
    Pushed(Box<Pushed>),
}

/// An object that slides.
struct Pushed {
    object: ObjectId,
    slide: Slide,
    /// How much of its way is done at every waypoint, the start first.
    shares: Box<[f64]>,
}

impl Load {
    fn new<J>(carried: Carried, objects: &[Isometry3<f64>], waypoints: &[Waypoint<J>], during: &Mode) -> Self {
        match carried {
            Carried::Nothing => Self::Nothing,
            Carried::Held(held) if during.held() == Some(&held) => Self::AsHeld,
            Carried::Held(held) => Self::Held(Box::new(held)),
            Carried::Pushed(object, to) => {
                let shares = std::iter::once(0.0).chain(waypoints.iter().map(|w| w.pushed)).collect();
                let slide = Slide::new(objects.get(object.index()).copied().unwrap_or(to), to);
                Self::Pushed(Box::new(Pushed { object, slide, shares }))
            }
        }
    }
}

impl<M: Manipulator> ArmMotion<M> {
    /// From `start` through `waypoints` (the start itself not among them), with corners between them where the base drives along
    /// its heading only. The mode is `during` on the open interval
    /// and `after` at its end.
    pub fn new(
        m: &Tabletop<M>,
        start: &TabletopState<M>,
        waypoints: &[Waypoint<M::Joints>],
        carried: Carried,
        during: Mode,
        after: Mode,
    ) -> Self {
        let waypoints = &*with_corners(m, &start.robot, waypoints);
        let load = Load::new(carried, &start.objects, waypoints, &during);
        let reach_m = match &load {
            Load::Pushed(pushed) => pushed.reach_m(m, start),
            _ => m.held_reach_m(&during),
        };
        let mut knots = Vec::with_capacity(waypoints.len() + 1);
        let mut length_m = 0.0;
        let mut here = &start.robot;
        knots.push(0.0);
        for Waypoint { robot: next, .. } in waypoints {
            length_m += m.manipulator().travel_m(here, next, reach_m);
            knots.push(length_m);
            here = next;
        }
        for knot in &mut knots {
            *knot = if length_m > 0.0 { *knot / length_m } else { 0.0 };
        }
        Self {
            way: Configurations::new(start.robot, waypoints.iter().map(|w| w.robot)),
            objects: start.objects.as_slice().into(),
            knots: (knots != SINGLE_SEGMENT).then(|| knots.into_boxed_slice()),
            load,
            before: start.mode.clone(),
            during,
            after,
            length_m,
        }
    }

    /// What it passes through, the start first.
    pub fn waypoints(&self) -> impl Iterator<Item = Waypoint<M::Joints>> {
        let pushed = |index| match &self.load {
            Load::Pushed(pushed) => pushed.shares.get(index).copied(),
            _ => None,
        };
        let robots = (0..).map_while(|index| Some((index, self.way.get(index)?)));
        robots.map(move |(index, robot)| Waypoint { robot, pushed: pushed(index).unwrap_or(0.0) })
    }

    /// What moves along.
    pub fn carried(&self) -> Carried {
        match &self.load {
            Load::Nothing => Carried::Nothing,
            Load::AsHeld => self.during.held().map_or(Carried::Nothing, |held| Carried::Held(*held)),
            Load::Held(held) => Carried::Held(**held),
            Load::Pushed(pushed) => Carried::Pushed(pushed.object, *pushed.slide.to()),
        }
    }

    /// The segment that `t` lies on and how much of it is done; `None` at the end.
    fn segment_at(&self, t: f64) -> Option<(usize, f64)> {
        if t >= 1.0 {
            return None;
        }
        let knots = self.knots();
        let end = knots.partition_point(|k| *k <= t);
        let begin = end.checked_sub(1)?;
        let (from, to) = (knots.get(begin)?, knots.get(end)?);
        Some((begin, (t - from) / (to - from)))
    }

    fn robot_at(&self, m: &Tabletop<M>, segment: Option<(usize, f64)>) -> Configuration<M::Joints> {
        let ends = segment.and_then(|(segment, s)| Some((self.way.get(segment)?, self.way.get(segment + 1)?, s)));
        ends.map_or_else(|| self.way.last(), |(a, b, s)| m.robot().interpolate(&a, &b, s))
    }
}

/// The waypoints, and between them the corners of a base that drives along its heading only.
fn with_corners<'a, M: Manipulator>(
    m: &Tabletop<M>,
    start: &Configuration<M::Joints>,
    waypoints: &'a [Waypoint<M::Joints>],
) -> Cow<'a, [Waypoint<M::Joints>]> {
    let drives = |waypoint: &Waypoint<M::Joints>| waypoint.robot.base != start.base;
    if !m.manipulator().drives_along_heading() || !waypoints.iter().any(drives) {
        return Cow::Borrowed(waypoints);
    }
    let mut all = Vec::with_capacity(3 * waypoints.len());
    let mut here = Waypoint { robot: *start, pushed: 0.0 };
    for next in waypoints {
        let corners = heading_drive::corners(&here.robot.base, &next.robot.base);
        all.extend(corners.into_iter().map(|base| Waypoint { robot: Configuration { base, ..here.robot }, ..here }));
        all.push(*next);
        here = *next;
    }
    Cow::Owned(all)
}

impl Pushed {
    /// How far what turns with the hand reaches beyond the tool frame, metres: what goes straight goes as far as the hand.
    fn reach_m<M: Manipulator>(&self, m: &Tabletop<M>, start: &TabletopState<M>) -> f64 {
        if self.slide.turn() == 0.0 {
            return 0.0;
        }
        let tool = m.manipulator().world_from_tool(&start.robot).translation.vector;
        let gap_m = (self.slide.from().translation.vector - tool).norm();
        gap_m + m.movable(self.object).map_or(0.0, |movable| movable.reach_m)
    }

    fn share_at(&self, segment: Option<(usize, f64)>) -> f64 {
        let ends = segment.and_then(|(segment, s)| Some((self.shares.get(segment)?, self.shares.get(segment + 1)?, s)));
        ends.map_or_else(|| self.shares.last().copied().unwrap_or(0.0), |(a, b, s)| a + (b - a) * s)
    }
}

impl<M: Manipulator> Motion<Tabletop<M>> for ArmMotion<M> {
    fn length(&self) -> f64 {
        self.length_m
    }

    fn knots(&self) -> &[f64] {
        self.knots.as_deref().unwrap_or(&SINGLE_SEGMENT)
    }

    fn at_into(&self, m: &Tabletop<M>, t: f64, out: &mut TabletopState<M>) {
        let t = t.clamp(0.0, 1.0);
        out.objects.clear();
        out.objects.extend_from_slice(&self.objects);
        if t <= 0.0 {
            out.robot = *self.way.start();
            out.mode.clone_from(&self.before);
            return;
        }
        let segment = self.segment_at(t);
        out.robot = self.robot_at(m, segment);
        let held = match &self.load {
            Load::Nothing => None,
            Load::AsHeld => self.during.held(),
            Load::Held(held) => Some(&**held),
            Load::Pushed(pushed) => {
                if let Some(pose) = out.objects.get_mut(pushed.object.index()) {
                    *pose = pushed.slide.at(pushed.share_at(segment));
                }
                None
            }
        };
        if let Some(held) = held
            && let Some(pose) = out.objects.get_mut(held.object.index())
        {
            *pose = m.manipulator().world_from_tool(&out.robot) * held.tool_from_object;
        }
        out.mode.clone_from(if t >= 1.0 { &self.after } else { &self.during });
    }
}

impl<M: Manipulator> fmt::Debug for ArmMotion<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ArmMotion")
            .field("waypoints", &self.waypoints().collect::<Vec<_>>())
            .field("carried", &self.carried())
            .field("during", &self.during)
            .field("after", &self.after)
            .finish_non_exhaustive()
    }
}
