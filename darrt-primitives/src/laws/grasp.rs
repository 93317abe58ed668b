//! Laws of [`GraspFamily`].

use darrt_core::laws::watch::{entering, watched};
use darrt_core::laws::{Broken, at_most, ensure, equal};
use darrt_core::random::{Purpose, stream};
use darrt_geom::body::{Body, Part};
use darrt_geom::oracle::{PosedBody, nearest};
use darrt_geom::shape::Shape;
use nalgebra::{Isometry3, Point3, UnitQuaternion};

use crate::grasp::{Grasp, GraspFamily, GraspKind};
use crate::manipulator::Hand;

mod covers;
mod kind;
mod pads;
mod patches;

/// The grid.
pub const GRID: &str = "grasp.grid: the grid is not empty, and the same on every call";
/// Gaps.
pub const GAPS: &str =
    "grasp.gaps: the fingers close from one positive gap to a smaller one, and open no wider than they can";
/// Poses.
pub const POSE: &str = "grasp.pose: the pose of a grasp is finite and rigid, and its approach has a positive length";
/// Reach.
pub const REACH: &str = "grasp.reach: the tool is at most tool_reach_m away from the middle of the object";
/// Approach.
pub const APPROACH: &str =
    "grasp.approach: on the straight approach the tool comes nearer to the object, by a quarter of its length at least";
/// Between the fingers.
pub const BETWEEN: &str = "grasp.between: something of the object is between the fingers or before their tips";
/// What is held.
pub const CONTACT: &str = "grasp.contact: when the hand is closed both pads are at the object, within 5 mm";
/// Not inside.
pub const OPEN: &str = "grasp.open: when the hand is open no pad is in the object, but for one within a wall";
/// The angles.
pub const KIND: &str = "grasp.kind: the angles that a grasp tells of itself are those of its pose";
/// Overhang.
pub const OVERHANG: &str = "grasp.overhang: a family needs an overhang exactly if all its grasps are of the rim";
/// Seeded.
pub const SEEDED: &str = "grasp.seeded: the same generator gives the same grasp";
/// Variety.
pub const VARIED: &str = "grasp.varied: a family with several grasps in its grid does not always draw the same";

/// Flush.
pub const FLUSH: &str =
    "grasp.flush: pads are as flush with what they close on as the family says, within three degrees";
/// Depth.
pub const DEPTH: &str = "grasp.depth: from above, the tips stay above the bottom of the object";
/// Covers.
pub const COVERS: &str = "grasp.covers: what is drawn is near one of the grid, and each of the grid near one that is drawn, within 60 degrees";
/// Pads.
pub const PADS: &str =
    "grasp.pads: what a family tells of the pads is finite, fits the pads of the hand, and does not change";

/// The laws of this file.
pub const LAWS: &[&str] = &[
    GRID, GAPS, POSE, REACH, APPROACH, BETWEEN, CONTACT, OPEN, KIND, OVERHANG, SEEDED, VARIED, FLUSH, DEPTH, COVERS,
    PADS,
];

/// How many grasps are drawn: a fault in one of a hundred is missed once in a hundred checks.
const DRAWS: u64 = 512;
/// By what share of its length an approach comes nearer at least.
const NEARER: f64 = 0.25;
/// Radius of the probe between the fingers, metres.
const PROBE_M: f64 = 1e-3;
/// How far the object may be from the middle between the pads besides the tips' own reach, metres.
const NEAR_M: f64 = 0.02;

/// All laws of a family of grasps of an object of this shape, by this hand.
///
/// # Errors
/// The first law that is [`Broken`], with the grasp.
pub fn check_grasps(family: &dyn GraspFamily, body: &Body, hand: &dyn Hand, seed: u64) -> Result<(), Broken> {
    let about = || format!("check_grasps(&family, &{:?}, &hand, {seed})", body.name);
    let draw = |i| {
        entering("sample");
        family.sample(&mut stream(seed, 0, i, Purpose::Extend))
    };
    let check = || {
        entering("grid");
        let grid = family.grid();
        ensure(GRID, !grid.is_empty(), || "an empty grid".to_owned(), "at least one grasp")?;
        ensure(GRID, same(&family.grid(), &grid), || "another grid".to_owned(), "the grid of the call before")?;
        let drawn: Vec<Grasp> = (0..DRAWS).map(draw).collect();
        for grasp in grid.iter().chain(&drawn) {
            one(family, body, hand, grasp).map_err(|broken| broken.of(format_args!("{:?}", grasp.kind)))?;
        }
        for (i, was) in (0..).zip(&drawn).step_by(7).take(4) {
            let again = draw(i);
            ensure(SEEDED, same(&[again], &[*was]), || format!("{again:?}"), "the grasp drawn before")?;
        }
        let differs = drawn.iter().any(|grasp| drawn.first() != Some(grasp));
        ensure(VARIED, differs || grid.len() < 2, || format!("{DRAWS} equal grasps"), "different ones")?;
        covers::check(&grid, &drawn)?;
        let of_rim = grid.iter().chain(&drawn).all(|grasp| matches!(grasp.kind, GraspKind::Rim { .. }));
        equal(OVERHANG, &family.needs_overhang(), &of_rim)
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

/// Equal, also where both have NaN.
fn same(a: &[Grasp], b: &[Grasp]) -> bool {
    format!("{a:?}") == format!("{b:?}")
}

fn one(family: &dyn GraspFamily, body: &Body, hand: &dyn Hand, grasp: &Grasp) -> Result<(), Broken> {
    let pose = &grasp.object_from_tool;
    let is_rigid = pose.translation.vector.iter().all(|x| x.is_finite())
        && (pose.rotation.quaternion().norm() - 1.0).abs() <= 1e-9
        && grasp.approach_m.wanted_m() > 0.0;
    ensure(POSE, is_rigid, || format!("{grasp:?}"), "finite, with an approach")?;
    let (open, closed) = (grasp.open_gap_m, grasp.closed_gap_m);
    let fits = closed > 0.0 && closed < open && open <= hand.max_gap_m() + 1e-9;
    let text = || format!("from {open:?} to {closed:?} m, of at most {:?}", hand.max_gap_m());
    ensure(GAPS, fits, text, "0 < closed < open <= widest")?;
    at_most(REACH, pose.translation.vector.norm(), family.tool_reach_m(), 1e-9)?;
    let start = grasp.object_from_pregrasp();
    let distances = [&start, pose].map(|tool| distance(body, tool));
    let [Some(before), Some(after)] = distances else {
        return Err(Broken::new(BETWEEN, "a shape that cannot be measured", "a shape"));
    };
    at_most(APPROACH, after + NEARER * grasp.approach_m.wanted_m(), before, 1e-9)?;
    let tips = hand.tip_beyond_tool_m(closed).abs();
    at_most(BETWEEN, after, tips + NEAR_M, 0.0).map_err(|broken| broken.of("gap to the object, m"))?;
    pads::check(body, hand, grasp)?;
    kind::check(grasp)?;
    patches::depth(body, hand, grasp)?;
    patches::told(family, hand, grasp)?;
    patches::flush(family, body, hand, grasp)
}

/// Metres from the tool's origin to the object.
fn distance(body: &Body, object_from_tool: &Isometry3<f64>) -> Option<f64> {
    distance_of(body, &object_from_tool.translation.vector.into())
}

/// Metres from a point in the object's frame to the object.
fn distance_of(body: &Body, point: &Point3<f64>) -> Option<f64> {
    let probe = Body::new("probe", vec![Part::centred(Shape::sphere(PROBE_M).ok()?)]).ok()?;
    let object = PosedBody { body, world_from_body: Isometry3::identity() };
    let probe = PosedBody {
        body: &probe,
        world_from_body: Isometry3::from_parts(point.coords.into(), UnitQuaternion::identity()),
    };
    nearest(&[object, probe], &|_, _| false).ok()?.map(|found| found.distance)
}
