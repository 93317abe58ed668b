//! States of a plan: reading waypoints, and what lies between two of them.

use darrt_primitives::kinematics::limit::wrap_to_pi;
use nalgebra::{Isometry3, Rotation2, UnitQuaternion, Vector2, Vector3};

use super::options::VerifyOptions;
use super::robot::{Robot, Role};
use super::world::World;
use crate::plan_file::{Pose, Waypoint};

/// Where everything stands, by index.
#[derive(Debug, Clone)]
pub(super) struct State {
    pub(super) base: [f64; 3],
    /// By variable of the robot's tree.
    pub(super) joints: Vec<f64>,
    /// By movable object.
    pub(super) objects: Vec<Isometry3<f64>>,
}

/// How far a quaternion's length may be from one.
const UNIT: f64 = 1e-6;

/// Largest coordinate of anything, metres (and radians of a base's yaw).
const FARTHEST: f64 = 1e4;

impl State {
    /// The state that a waypoint describes, or what is wrong with it.
    pub(super) fn read(waypoint: &Waypoint, robot: &Robot, world: &World<'_>) -> Result<Self, String> {
        for (name, value) in ["x", "y", "yaw"].into_iter().zip(waypoint.base) {
            in_range(value, || format!("the base's {name}"))?;
        }
        let joints = robot.table.variables(&waypoint.joints).map_err(|flaw| flaw.to_string())?;
        if let Some(name) = waypoint.objects.keys().find(|name| world.object(name).is_none()) {
            return Err(format!("there is no object `{name}` in the problem"));
        }
        let mut objects = Vec::with_capacity(world.movables.len());
        for movable in &world.movables {
            let name = &movable.spec.name;
            let pose = waypoint.objects.get(name.as_str()).ok_or_else(|| format!("the pose of `{name}` is missing"))?;
            objects.push(sound(name, *pose)?);
        }
        Ok(Self { base: waypoint.base, joints, objects })
    }
}

fn in_range(value: f64, what: impl FnOnce() -> String) -> Result<(), String> {
    if value.abs() <= FARTHEST {
        return Ok(());
    }
    Err(format!("{} is {value}, it must lie in [-{FARTHEST}, {FARTHEST}]", what()))
}

/// The pose, if its numbers are fit.
pub(super) fn sound(name: &str, pose: Pose) -> Result<Isometry3<f64>, String> {
    for value in pose.position {
        in_range(value, || format!("a coordinate of `{name}`"))?;
    }
    let norm = pose.quaternion.iter().map(|q| q * q).sum::<f64>().sqrt();
    if (norm - 1.0).abs() <= UNIT {
        return Ok(pose.into());
    }
    Err(format!("the quaternion of `{name}` has the norm {norm}, it must be 1 within {UNIT}"))
}

/// The straight way between two states.
#[derive(Debug)]
pub(super) struct Segment<'a> {
    pub(super) from: &'a State,
    pub(super) to: &'a State,
    /// The way of x, y and yaw.
    pub(super) base: [f64; 3],
    /// The way of each variable.
    pub(super) joints: Vec<f64>,
}

/// What differs between the ends of a segment, by who may change it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Changes {
    pub(super) base: bool,
    pub(super) arm: bool,
    /// By how much the hand opens, metres, as if the gap grew evenly over the range of its joint.
    pub(super) finger: f64,
    /// A joint that nothing may move.
    pub(super) parked: Option<usize>,
}

/// A pushed object that goes less than this in a segment stands still, metres.
const STANDS_M: f64 = 1e-9;

/// Turns that are smaller are what rounding does to a quaternion, radians.
const TURN_ROUNDING: f64 = 1e-9;

/// The way of a pushed object in a segment: along an arc of a circle, with which it turns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slide {
    /// From its place at the beginning to that at the end.
    chord: Vector2<f64>,
    /// How far it turns about the vertical, counter-clockwise, radians.
    pub(super) turn: f64,
    /// The way of its centre, metres.
    pub(super) length_m: f64,
}

impl Slide {
    /// The direction in which its centre goes when `s` of the segment is done.
    pub(super) fn heading(&self, s: f64) -> Vector2<f64> {
        (Rotation2::new(self.turn * (s - 0.5)) * self.chord).normalize()
    }

    /// Turn per metre of its way, 1/m, at least 0; infinite if it turns where it stands.
    pub(super) fn curvature(&self) -> f64 {
        if self.turn == 0.0 { 0.0 } else { self.turn.abs() / self.length_m }
    }
}

/// How far the second pose is turned about the vertical against the first, radians in `[-pi, pi]`.
pub(super) fn turn_between(from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
    let ahead = from.rotation.inverse() * (to.rotation * Vector3::x());
    let sideways = from.rotation.inverse() * (to.rotation * Vector3::y());
    // The mean of both axes, so that a little lean does not count as a turn.
    let turn = (ahead.y - sideways.x).atan2(ahead.x + sideways.y);
    if turn.abs() < TURN_ROUNDING { 0.0 } else { turn }
}

/// Where the axis stands about which an object turns by `turn` on its way; `None` if it goes straight.
fn axis_of(from: &Isometry3<f64>, to: &Isometry3<f64>, turn: f64) -> Option<Vector2<f64>> {
    if turn == 0.0 {
        return None;
    }
    let (a, b) = (from.translation.vector.xy(), to.translation.vector.xy());
    let left = Vector2::new(a.y - b.y, b.x - a.x);
    Some((a + b) / 2.0 + left / (2.0 * (turn / 2.0).tan()))
}

/// Length of an arc over a chord, metres.
fn arc_m(chord_m: f64, turn: f64) -> f64 {
    let half = (turn / 2.0).abs();
    if half == 0.0 { chord_m } else { chord_m * half / half.sin() }
}

impl<'a> Segment<'a> {
    pub(super) fn new(from: &'a State, to: &'a State, robot: &Robot) -> Self {
        let [x, y, yaw] = [0, 1, 2].map(|i| to.base[i] - from.base[i]);
        let joints = from.joints.iter().zip(&to.joints).enumerate();
        let joints = joints.map(|(i, (a, b))| if robot.is_continuous(i) { wrap_to_pi(b - a) } else { b - a });
        Self { from, to, base: [x, y, wrap_to_pi(yaw)], joints: joints.collect() }
    }

    /// A turning joint, or the yaw, that would go half a turn: then neither way is the shorter one.
    pub(super) fn half_turn(&self, robot: &Robot) -> Option<String> {
        let is_half = |angle: f64| angle.abs() > std::f64::consts::PI - 1e-9;
        if is_half(self.base[2]) {
            return Some("the base's yaw".to_owned());
        }
        let joint = (0..self.joints.len()).find(|&i| robot.is_continuous(i) && is_half(self.joints[i]))?;
        Some(format!("`{}`", robot.joint_name(joint)))
    }

    pub(super) fn changes(&self, robot: &Robot) -> Changes {
        let moved = |role: Role| {
            let mut both = self.from.joints.iter().zip(&self.to.joints).zip(&robot.roles);
            both.position(|((a, b), r)| *r == role && a != b)
        };
        Changes {
            base: self.from.base != self.to.base,
            arm: moved(Role::Arm).is_some(),
            finger: self.joints.get(robot.finger_joint).copied().unwrap_or(0.0) * robot.gap_rate,
            parked: moved(Role::Parked),
        }
    }

    /// In how many equal parts to look at it, and how far anything travels in one of them at most, metres. `rates`: see
    /// [`Robot::travel_rates`].
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a range that fits any usize"
    )]
    pub(super) fn parts(&self, rates: &[f64], options: &VerifyOptions) -> (usize, f64) {
        let [x, y, yaw] = self.base;
        let slides = (0..self.from.objects.len()).filter_map(|object| self.slide(object));
        let (pushed, turned) =
            slides.fold((0.0_f64, 0.0_f64), |(way, turn), slide| (way.max(slide.length_m), turn.max(slide.turn.abs())));
        let turns = self.joints.iter().chain([&yaw]);
        let travel: f64 = turns.clone().zip(rates).map(|(turn, rate)| turn.abs() * rate).sum();
        let travel = (travel + x.hypot(y)).max(pushed);
        let by_turn = turns.map(|turn| turn.abs()).fold(turned, f64::max) / options.joint_rad;
        // Both are finite: coordinates are bounded and turns are wrapped or within limits.
        let count = (travel / options.travel_m).max(by_turn).ceil().clamp(1.0, 1e9);
        (count as usize, travel / count)
    }

    /// Writes base and joints at `s` in `[0, 1]`; exactly the ends at the ends.
    pub(super) fn robot_at(&self, s: f64, out: &mut State) {
        if s >= 1.0 {
            out.base = self.to.base;
            out.joints.clone_from(&self.to.joints);
            return;
        }
        for ((slot, from), way) in out.base.iter_mut().zip(self.from.base).zip(self.base) {
            *slot = from + s * way;
        }
        for ((slot, from), way) in out.joints.iter_mut().zip(&self.from.joints).zip(&self.joints) {
            *slot = from + s * way;
        }
    }

    /// The pose of an object that slides from one end to the other: in a straight line, or about the one vertical axis about
    /// which it turns so far.
    pub(super) fn slid(&self, object: usize, s: f64) -> Option<Isometry3<f64>> {
        let (from, to) = (self.from.objects.get(object)?, self.to.objects.get(object)?);
        let mut pose = *to;
        if s >= 1.0 {
            return Some(pose);
        }
        pose.translation.vector = from.translation.vector.lerp(&to.translation.vector, s);
        let turn = turn_between(from, to);
        if let Some(axis) = axis_of(from, to, turn) {
            let part = Rotation2::new(turn * s);
            let at = axis + part * (from.translation.vector.xy() - axis);
            (pose.translation.x, pose.translation.y) = (at.x, at.y);
            pose.rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn * s) * from.rotation;
        }
        Some(pose)
    }

    /// The way of an object that slides from one end to the other; `None` while it stands.
    pub(super) fn slide(&self, object: usize) -> Option<Slide> {
        let (from, to) = (self.from.objects.get(object)?, self.to.objects.get(object)?);
        let chord = to.translation.vector.xy() - from.translation.vector.xy();
        let turn = turn_between(from, to);
        let length_m = arc_m(chord.norm(), turn);
        (length_m > STANDS_M || turn != 0.0).then_some(Slide { chord, turn, length_m })
    }
}
