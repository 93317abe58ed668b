//! How near to an edge an object may be left.

use nalgebra::{Isometry3, Point2, Vector2};

use super::options::VerifyOptions;
use super::world::World;
use crate::problem_file::{GoalTarget, ObjectGoal, ProblemFile};

/// Steps along each side of a region that is asked for its best place.
const STEPS: u32 = 4;
/// In so many directions it is looked how far surfaces reach that lie flush: less than 0.1 % more than to the nearest edge.
const DIRECTIONS: u32 = 72;
/// Steps of that, metres, and how wide a joint may be on either side.
const STEP_M: f64 = 1e-3;

/// Why the object may not be left standing at `pose` on this surface; `None` if it may: its centre is as far inside the edge
/// as `[safety] edge_margin_m` says, or one of its goals holds there and has no place that is.
pub(super) fn flaw(
    problem: &ProblemFile,
    world: &World<'_>,
    object: usize,
    surface: usize,
    pose: &Isometry3<f64>,
    options: &VerifyOptions,
) -> Option<String> {
    let (margin_m, plane) = (problem.safety.edge_margin_m, world.surface(surface)?);
    let centre = Point2::from(pose.translation.vector.xy());
    let inside_m = inside_m(world, object, surface, &centre, margin_m, options)?;
    if inside_m >= margin_m - options.support_m {
        return None;
    }
    let name = world.object_name(object);
    let goals = problem.goal.objects.iter().filter(|goal| goal.object == name);
    let forced = |goal: &ObjectGoal| {
        let [min, max] = region_on(goal, world, plane.height(), options)?;
        let nearest = centre.coords.sup(&Vector2::from(min)).inf(&Vector2::from(max));
        let is_there = (centre.coords - nearest).norm() <= goal.tolerance_m;
        let share = |i: u32, low: f64, high: f64| low + (high - low) * f64::from(i) / f64::from(STEPS);
        let ([x, y], [u, v]) = (min, max);
        let mut places =
            (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| Point2::new(share(i, x, u), share(j, y, v))));
        let is_near =
            |place| self::inside_m(world, object, surface, &place, margin_m, options).is_none_or(|m| m < margin_m);
        Some(is_there && places.all(is_near))
    };
    if goals.filter_map(forced).any(|is_forced| is_forced) {
        return None;
    }
    Some(format!(
        "{name} is left {inside_m:.4} m inside the edge of `{}`, at least {margin_m} m are safe and no goal asks for less",
        plane.name()
    ))
}

/// How far inside the edge a place is, metres; negative beside it. Up to `enough_m` the surfaces count as one that lie flush
/// with this one and on which the object may stand too.
pub(super) fn inside_m(
    world: &World<'_>,
    object: usize,
    surface: usize,
    place: &Point2<f64>,
    enough_m: f64,
    options: &VerifyOptions,
) -> Option<f64> {
    let plane = world.surface(surface)?;
    let alone_m = plane.depth(place);
    let level: Vec<_> = world
        .movables
        .get(object)?
        .surfaces
        .iter()
        .filter_map(|&index| world.surface(index))
        .filter(|other| (other.height() - plane.height()).abs() <= options.support_m)
        .collect();
    if alone_m >= enough_m || level.len() < 2 {
        return Some(alone_m);
    }
    let is_over = |place: &Point2<f64>| level.iter().any(|other| other.depth(place) >= -STEP_M);
    let mut least_m = enough_m;
    for i in 0..DIRECTIONS {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(DIRECTIONS)).sin_cos();
        let mut gone_m = 0.0;
        while gone_m < least_m && is_over(&(place + Vector2::new(cos, sin) * gone_m)) {
            gone_m += STEP_M;
        }
        least_m = least_m.min(gone_m);
    }
    Some(alone_m.max(least_m))
}

/// The smallest and the largest x and y that a goal allows on a surface of this height.
fn region_on(goal: &ObjectGoal, world: &World<'_>, height_m: f64, options: &VerifyOptions) -> Option<[[f64; 2]; 2]> {
    let is_here = |name: &str| {
        let mut surfaces = (0..).map_while(|index| world.surface(index));
        surfaces.any(|s| s.name() == name && (s.height() - height_m).abs() <= options.support_m)
    };
    match goal.target()? {
        GoalTarget::On { surface, at } => is_here(surface).then_some([at; 2]),
        GoalTarget::Within { surface, region } => is_here(surface).then_some([region.min, region.max]),
        GoalTarget::At { position: [x, y, _] } => Some([[x, y]; 2]),
    }
}
