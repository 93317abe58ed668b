//! Does the hand hold what it has closed on, and does it go on holding it however the object leans?
//!
//! The pads are felt out point by point against the shape of the problem; what they can bear follows from the friction and
//! the mass of the problem and the gripper's force. `docs/plan-format.md` states the rules.

use nalgebra::{Isometry3, Point3, Vector3};

use super::refusal::{Refusal, RefusalKind, Site};
use super::robot::Robot;
use super::stage::Stage;
use super::surface::{distance, enters};
use crate::problem_file::{Object, ShapeSpec};

/// Weights of the object that a hold must bear.
const SAFETY: f64 = 1.5;
/// How much more of its strength a hold may use: what feeling out the pads point by point may miss.
const SLACK: f64 = 1.02;
/// How far pads may be from flush, radians, and what rounding may do to it.
const FLUSH_RAD: f64 = std::f64::consts::PI / 180.0;
const FLUSH_ROUNDING_RAD: f64 = 1e-5;
/// How far a pad gives and how far it may be off over its length, metres: what is so near to it is in contact.
const GIVE_M: f64 = 1e-3;
/// Points of a pad along and across the fingers.
const POINTS: [usize; 2] = [72, 36];
/// Normals at neighbouring points that differ more do not belong to one smooth surface, radians.
const SMOOTH_RAD: f64 = 0.26;
/// Standard gravity, m/s^2.
const GRAVITY: f64 = 9.81;

/// How the closed hand holds an object.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hold {
    /// From the middle of the contact to the object's centre, tool axes, metres.
    lever: Vector3<f64>,
    /// How far the pressure can shift along the fingers and across them, metres.
    shift_m: [f64; 2],
    /// Mean distance of the contact from its middle, metres.
    spin_m: f64,
    weight_n: f64,
    friction: f64,
    /// Of each finger.
    grip_force_n: f64,
}

/// Which strength of a hold is used most.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Use {
    share: f64,
    yields: &'static str,
}

/// One pad, felt out.
#[derive(Debug, Default)]
struct Felt {
    /// Where it touches: along the fingers and across them, metres, from the middle of the tip's end.
    points: Vec<[f64; 2]>,
    /// By point of the pad: the part of the normal in the plane of the pad.
    leans: Vec<Option<[f64; 2]>>,
}

/// The pads of the closed hand in the world, and what they lie on.
struct Pads<'a> {
    shape: &'a ShapeSpec,
    object_from_world: Isometry3<f64>,
    /// Middle between the tips' ends; axes as the tool's: x forward, y from the right pad to the left.
    world_from_tips: Isometry3<f64>,
    half_gap_m: f64,
    half_width_m: f64,
    length_m: f64,
    /// Of each finger.
    grip_force_n: f64,
}

/// Judges the closed hand around an upright object, given by its index and as in the file.
///
/// # Errors
/// [`RefusalKind::Hold`] with what fails.
pub(super) fn check_hold(
    site: Site<'_>,
    time: f64,
    robot: &Robot,
    stage: &Stage,
    (index, object): (usize, &Object),
    world_from_tool: &Isometry3<f64>,
) -> Result<Hold, Refusal> {
    let name = &object.name;
    let refuse = |text: String| site.refusal(time, RefusalKind::Hold, format!("the hand cannot hold {name}: {text}"));
    let (_, pose) = stage.object(index);
    let (mass, friction) = (object.mass_kg, object.friction.fingers);
    let payload_kg = robot.strength.payload_kg;
    if mass > payload_kg {
        return Err(refuse(format!("it weighs {mass} kg, the arm carries {payload_kg}")));
    }
    if friction <= 0.0 {
        return Err(refuse("its fingers have no friction with it".to_owned()));
    }
    let pads = pads(robot, stage, &object.shape, pose)
        .ok_or_else(|| refuse("its gripper has no tips to hold with".to_owned()))?;
    let felt = [1.0, -1.0].map(|side| pads.feel(side));
    if felt.iter().any(|felt| felt.points.is_empty()) {
        return Err(refuse(format!("a pad does not lie on the {}", object.shape.kind())));
    }
    let most = FLUSH_RAD.min(friction.atan()) + FLUSH_ROUNDING_RAD;
    let askew = felt.iter().map(Felt::askew_rad).fold(0.0, f64::max);
    if askew > most {
        let [askew, most] = [askew, most].map(f64::to_degrees);
        return Err(refuse(format!("its pads are {askew:.1} degrees from flush with it, at most {most:.1} hold")));
    }
    let hold = Hold::new(&felt, &pads, world_from_tool, pose, mass * GRAVITY, friction);
    let down = world_from_tool.rotation.inverse() * -Vector3::z();
    let Use { share, yields } = hold.shaken().max(hold.strained(&down));
    if share > SLACK {
        let (needs, has) = (share * hold.grip_force_n, hold.grip_force_n);
        return Err(refuse(format!("it {yields} with less than {needs:.1} N of grip, the gripper has {has}")));
    }
    Ok(hold)
}

/// Where the pads are: the inner faces of the tips, the last [`Pads::length_m`] of them.
fn pads<'a>(robot: &Robot, stage: &Stage, shape: &'a ShapeSpec, pose: &Isometry3<f64>) -> Option<Pads<'a>> {
    let [left, right] = robot.tips;
    let tip = |link| robot.solids_of(link).next().map(|index| stage.link_solid(index));
    let ((left, left_pose), (right, right_pose)) = (tip(left)?, tip(right)?);
    let [(low, high), (_, other)] = [left.shape()?.local_aabb(), right.shape()?.local_aabb()];
    // The tips of a gripper stay parallel; the left one is the one on the side of y.
    let from = left_pose * Point3::new(high.x, low.y, f64::midpoint(low.z, high.z));
    let to = right_pose * Point3::new(other.x, other.y, f64::midpoint(low.z, high.z));
    let across = left_pose.rotation.inverse() * (from - to);
    Some(Pads {
        shape,
        object_from_world: pose.inverse(),
        world_from_tips: Isometry3::from_parts(nalgebra::center(&from, &to).into(), left_pose.rotation),
        half_gap_m: across.y / 2.0,
        half_width_m: (high.z - low.z) / 2.0,
        length_m: robot.strength.pad_length_m,
        grip_force_n: robot.strength.grip_force_n,
    })
}

impl Pads<'_> {
    /// Where the pad on one side (1: left, -1: right) touches.
    fn feel(&self, side: f64) -> Felt {
        let object_from_tips = self.object_from_world * self.world_from_tips;
        let inward = object_from_tips.rotation * (-side * Vector3::y());
        let mut felt = Felt::default();
        for (i, k) in (0..POINTS[0]).flat_map(|i| (0..POINTS[1]).map(move |k| (i, k))) {
            let part = |at: usize, of: usize| (at as f64 + 0.5) / of as f64;
            let along = -self.length_m * part(i, POINTS[0]);
            let across = self.half_width_m * (2.0 * part(k, POINTS[1]) - 1.0);
            let start = object_from_tips * Point3::new(along, side * (self.half_gap_m + GIVE_M), across);
            // A pad does not press deeper into anything than it gives.
            let is_beside = distance(self.shape, &start).is_some_and(|gap_m| gap_m >= -GIVE_M);
            let met = enters(self.shape, &start, &inward, 2.0 * GIVE_M).filter(|_| is_beside);
            felt.leans.push(met.map(|(_, normal)| {
                let local = object_from_tips.rotation.inverse() * normal;
                [local.x, local.z]
            }));
            if met.is_some() {
                felt.points.push([along, across]);
            }
        }
        felt
    }
}

impl Felt {
    /// How far the pad is from flush: the least angle between its normal and that of a smooth piece of the surface.
    fn askew_rad(&self) -> f64 {
        let at = |i: usize, k: usize| self.leans.get(i * POINTS[1] + k).copied().flatten().filter(|_| k < POINTS[1]);
        let mut least = f64::INFINITY;
        for (i, k) in (0..POINTS[0]).flat_map(|i| (0..POINTS[1]).map(move |k| (i, k))) {
            let Some(here) = at(i, k) else { continue };
            least = least.min(here[0].hypot(here[1]));
            for next in [at(i + 1, k), at(i, k + 1)].into_iter().flatten() {
                least = least.min(to_segment(here, next).unwrap_or(f64::INFINITY));
            }
        }
        least.min(1.0).asin()
    }

    /// From where to where it touches along one axis.
    fn range(&self, axis: usize) -> [f64; 2] {
        let values = self.points.iter().map(|point| point[axis]);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
    }
}

/// Distance of the origin from the segment between two leans; `None` if they do not belong to one smooth surface.
fn to_segment(a: [f64; 2], b: [f64; 2]) -> Option<f64> {
    let along = [b[0] - a[0], b[1] - a[1]];
    let length = along[0].hypot(along[1]);
    if length > SMOOTH_RAD {
        return None;
    }
    let part = if length > 0.0 { -(a[0] * along[0] + a[1] * along[1]) / (length * length) } else { 0.0 };
    let part = part.clamp(0.0, 1.0);
    Some((a[0] + part * along[0]).hypot(a[1] + part * along[1]))
}

impl Use {
    fn max(self, other: Self) -> Self {
        if other.share > self.share { other } else { self }
    }
}

impl Hold {
    fn new(
        felt: &[Felt; 2],
        pads: &Pads<'_>,
        world_from_tool: &Isometry3<f64>,
        pose: &Isometry3<f64>,
        weight_n: f64,
        friction: f64,
    ) -> Self {
        let all = || felt.iter().flat_map(|felt| &felt.points);
        let count = all().count().max(1) as f64;
        let middle = [0, 1].map(|axis| all().map(|point| point[axis]).sum::<f64>() / count);
        let spin_m = all().map(|point| (point[0] - middle[0]).hypot(point[1] - middle[1])).sum::<f64>() / count;
        let cell = [pads.length_m / POINTS[0] as f64, 2.0 * pads.half_width_m / POINTS[1] as f64];
        let shift_m = [0, 1].map(|axis| {
            let [a, b] = [0, 1].map(|side| felt[side].range(axis)).map(|[low, high]| high - low + cell[axis]);
            f64::midpoint(a, b)
        });
        let contact = pads.world_from_tips * Point3::new(middle[0], 0.0, middle[1]);
        let lever = world_from_tool.rotation.inverse() * (pose.translation.vector - contact.coords);
        Self { lever, shift_m, spin_m, weight_n, friction, grip_force_n: pads.grip_force_n }
    }

    /// What its weight would do along the pads, whichever way the hand were turned.
    fn shaken(&self) -> Use {
        Use { share: SAFETY * self.weight_n / (2.0 * self.friction * self.grip_force_n), yields: "slips out" }
    }

    /// What gravity along `down`, a vector in tool axes, does.
    fn strained(&self, down: &Vector3<f64>) -> Use {
        let force = down * SAFETY * self.weight_n;
        let moment = self.lever.cross(&force);
        let grip = 2.0 * self.grip_force_n;
        let slip = force.x.hypot(force.z).hypot(moment.y / self.spin_m) / (grip * self.friction);
        let tip = (moment.z.abs() / self.shift_m[0] + moment.x.abs() / self.shift_m[1]) / (grip / 4.0);
        let lift = force.y.abs() / grip;
        Use { share: slip, yields: "turns between the pads" }
            .max(Use { share: tip.max(lift), yields: "tips out of the pads" })
    }

    /// Does it bear an object when gravity is along `down`, a unit vector in tool axes?
    pub(super) fn check(&self, down: &Vector3<f64>) -> Result<(), String> {
        let Use { share, yields } = self.strained(down);
        if share <= SLACK {
            return Ok(());
        }
        let (needs, has) = (share * self.grip_force_n, self.grip_force_n);
        Err(format!("{yields} as it leans with less than {needs:.1} N of grip, the gripper has {has}"))
    }

    /// How far gravity may turn from `down` before [`Hold::check`] could fail, radians.
    pub(super) fn turn_left(&self, down: &Vector3<f64>) -> f64 {
        let along = |axis: Vector3<f64>| self.strained(&axis).share;
        let steepest = along(Vector3::x()).hypot(along(Vector3::y())).hypot(along(Vector3::z()));
        (SLACK - self.strained(down).share).max(0.0) / steepest
    }
}
