//! Where the limbs that are not planned with rest: out of the way of the arm.

use darrt_core::random::{Purpose, Stream, stream};
use darrt_geom::{Body, clearance};
use darrt_primitives::kinematics::tree::{KinematicTree, LinkMotion};
use darrt_primitives::kinematics::{JointLimit, RobotDescription};
use nalgebra::Isometry3;
use rand::RngExt as _;

use super::super::semantic::{Disabled, Semantic};
use super::super::travel::corners;
use super::hand::{is_rigid, variable_of};
use super::posture::Footprint;

/// So many turning joints in a row are another arm or a leg; of more only the first are tucked, for the last are fingers.
const LEAST_JOINTS: usize = 5;
const MOST_JOINTS: usize = 7;
/// Postures that are tried.
const DRAWS: usize = 300;
/// Small changes of the best of them that are tried, and how large, radians.
const STEPS: usize = 200;
const STEP_RAD: f64 = 0.3;
/// A pair of links that touches in so large a share of them stands in each other's shapes.
const JOINED: f64 = 0.9;
/// Values stay so far within the limits, rad.
const ROUNDED: f64 = 1e-5;
/// How far the limb keeps from the rest of the robot, metres.
const APART_M: f64 = 0.01;

/// Where the joints of a limb rest.
#[derive(Debug, Clone)]
pub(super) struct Limb {
    /// With their values, rad.
    pub(super) joints: Vec<(String, f64)>,
    /// The state of the SRDF that it is.
    pub(super) state: Option<String>,
}

/// The limbs that none of the joints `mine` belongs to, each in that of the postures tried in which it is least in the way, and
/// touches nothing; joints of `lifts` stand at their values. A limb that touches something in all of them is left out.
pub(super) fn limbs(
    (description, tree): (&RobotDescription, &KinematicTree),
    bodies: &[Option<Body>],
    mine: &[String],
    lifts: &[(String, f64)],
    semantic: Option<&Semantic>,
) -> Vec<Limb> {
    let mut rng = stream(0, 5, 0, Purpose::Extend);
    let is_mine =
        |variable: usize| tree.variables().get(variable).is_some_and(|v| mine.iter().any(|name| *v.name == **name));
    let mut rows: Vec<Vec<usize>> = Vec::new();
    for leaf in 0..tree.link_count() {
        let row = row(tree, leaf, &is_mine);
        // Of those that begin alike the longest.
        match rows.iter_mut().find(|known| known.first() == row.first()) {
            Some(known) if known.len() < row.len() => *known = row,
            None if row.len() >= LEAST_JOINTS => rows.push(row),
            Some(_) | None => {}
        }
    }
    let mut values = tree.neutral();
    for (name, value) in lifts {
        if let Some(slot) = tree.variable_index(name).and_then(|variable| values.get_mut(variable)) {
            *slot = *value;
        }
    }
    let footprint = footprint(tree, bodies, &values);
    let mut found = Vec::new();
    for mut row in rows {
        row.truncate(MOST_JOINTS);
        let names: Vec<String> =
            row.iter().filter_map(|variable| Some(tree.variables().get(*variable)?.name.to_string())).collect();
        let states = semantic.iter().flat_map(|semantic| semantic.states(description, &names));
        let states: Vec<_> = states.map(|(name, values)| (name.to_owned(), values)).collect();
        let disabled = semantic.map_or(&[][..], |semantic| &semantic.disabled);
        let limb = Row { tree, bodies, variables: &row, disabled, footprint };
        let Some((chosen, state)) = limb.tucked(&values, &states, &mut rng) else { continue };
        for (variable, value) in row.iter().zip(&chosen) {
            if let Some(slot) = values.get_mut(*variable) {
                *slot = *value;
            }
        }
        found.push(Limb { joints: names.into_iter().zip(chosen).collect(), state });
    }
    found
}

/// The turning joints from `leaf` inwards up to what one of mine stands on, the innermost first.
fn row(tree: &KinematicTree, leaf: usize, is_mine: &dyn Fn(usize) -> bool) -> Vec<usize> {
    let carries_mine = |link: usize| {
        let mut mine = (0..tree.link_count()).filter(|below| variable_of(tree, *below).is_some_and(is_mine));
        mine.any(|below| is_below(tree, below, link))
    };
    let mut row = Vec::new();
    let mut at = Some(leaf);
    while let Some(link) = at.filter(|link| !carries_mine(*link)) {
        if let Some(LinkMotion::Turning { drive, .. }) = tree.motion(link) {
            if is_mine(drive.variable) {
                return Vec::new();
            }
            row.push(drive.variable);
        }
        at = tree.parent(link);
    }
    row.reverse();
    row.dedup();
    row
}

fn is_below(tree: &KinematicTree, mut link: usize, top: usize) -> bool {
    loop {
        if link == top {
            return true;
        }
        match tree.parent(link) {
            Some(parent) => link = parent,
            None => return false,
        }
    }
}

/// The joints of a limb.
struct Row<'a> {
    tree: &'a KinematicTree,
    bodies: &'a [Option<Body>],
    variables: &'a [usize],
    /// Pairs that the SRDF does not check.
    disabled: &'a [Disabled],
    /// Of what no joint moves but wheels.
    footprint: Footprint,
}

/// What the robot stands on, in the frame of its root: all that is rigid to it, and the floor under the lowest point of all.
fn footprint(tree: &KinematicTree, bodies: &[Option<Body>], values: &[f64]) -> Footprint {
    let mut poses = vec![Isometry3::identity(); tree.link_count()];
    // The values are the tree's own, so there are as many as it wants.
    let _ = tree.forward(values, &Isometry3::identity(), &mut poses);
    let points = |is_of: &dyn Fn(usize) -> bool| -> Vec<_> {
        let placed = bodies.iter().zip(&poses).enumerate().filter(|(link, _)| is_of(*link));
        placed
            .filter_map(|(_, (body, pose))| Some((body.as_ref()?, pose)))
            .flat_map(|(body, pose)| corners(body).into_iter().map(move |corner| pose * corner))
            .collect()
    };
    let floor_m = points(&|_| true).iter().map(|at| at.z).fold(0.0, f64::min);
    Footprint::of(points(&|link| is_rigid(tree, link)).into_iter(), floor_m)
}

impl Row<'_> {
    /// The values with which it is least in the way, and which state of the SRDF they are. All else stands as in `rest`.
    fn tucked(
        &self,
        rest: &[f64],
        states: &[(String, Vec<f64>)],
        rng: &mut Stream,
    ) -> Option<(Vec<f64>, Option<String>)> {
        let first = self.variables.first().and_then(|variable| self.tree.variables().get(*variable))?.link;
        let has_shape = |link: &usize| self.bodies.get(*link).is_some_and(Option::is_some);
        let (mine, others): (Vec<usize>, Vec<usize>) =
            (0..self.tree.link_count()).filter(has_shape).partition(|link| is_below(self.tree, *link, first));
        let limits: Option<Vec<JointLimit>> =
            self.variables.iter().map(|variable| Some(self.tree.variables().get(*variable)?.soft_limit)).collect();
        // What is written is rounded.
        let inside = |limit: JointLimit| {
            let is_wide = limit.lower.is_finite() && limit.upper - limit.lower > 4.0 * ROUNDED;
            if is_wide { JointLimit::new(limit.lower + ROUNDED, limit.upper - ROUNDED) } else { limit }
        };
        let limits: Vec<JointLimit> = limits?.into_iter().map(inside).collect();
        let given = states.iter().map(|(name, values)| (values.clone(), Some(name.clone())));
        let given = given.filter(|(values, _)| values.iter().zip(&limits).all(|(value, limit)| limit.contains(*value)));
        let drawn = |_| (limits.iter().map(|limit| draw(limit, rng)).collect(), None);
        let tried: Vec<(Vec<f64>, Option<String>)> = given.chain((0..DRAWS).map(drawn)).collect();
        let seen: Vec<_> = tried.iter().filter_map(|(values, _)| self.seen(rest, values, &mine, &others)).collect();
        // Pairs that touch nearly always are joined, and so are those that the SRDF does not check.
        let name = |link: usize| self.tree.link_names().get(link).map_or("", |name| &**name);
        let is_disabled = |a: usize, b: usize| {
            let is_it = |[first, second]: &[String; 2]| {
                [name(a), name(b)] == [first, second] || [name(b), name(a)] == [first, second]
            };
            self.disabled.iter().any(|pair| is_it(&pair.links))
        };
        let named = mine.iter().flat_map(|a| others.iter().map(move |b| (*a, *b)));
        let joined: Vec<bool> = named
            .enumerate()
            .map(|(pair, (a, b))| {
                let touching = seen.iter().filter(|(_, near)| near.get(pair).is_some_and(|near| *near)).count();
                touching as f64 >= JOINED * seen.len() as f64 || is_disabled(a, b)
            })
            .collect();
        let is_free = |near: &[bool]| near.iter().zip(&joined).all(|(near, joined)| !near || *joined);
        let mut free: Vec<_> = tried.iter().zip(&seen).filter(|(_, (_, near))| is_free(near)).collect();
        free.sort_by(|(_, (a, _)), (_, (b, _))| a.total_cmp(b));
        // What has a name goes first, if it is no farther out than what was drawn mostly is.
        let named = free.iter().take(free.len().div_ceil(4)).find(|((_, name), _)| name.is_some());
        if let Some((named, _)) = named {
            return Some((*named).clone());
        }
        let ((first, _), (reach_m, _)) = free.first()?;
        let (mut best, mut best_m) = (first.clone(), *reach_m);
        for _ in 0..STEPS {
            let moved = best.iter().zip(&limits).map(|(value, limit)| {
                let value = value + rng.random_range(-STEP_RAD..STEP_RAD);
                if limit.is_unlimited() { value } else { value.clamp(limit.lower, limit.upper) }
            });
            let moved: Vec<f64> = moved.collect();
            let Some((reach_m, near)) = self.seen(rest, &moved, &mine, &others) else { continue };
            if reach_m < best_m && is_free(&near) {
                (best, best_m) = (moved, reach_m);
            }
        }
        Some((best, None))
    }

    /// How much the limb is in the way, and which of its links are near which other ones.
    fn seen(&self, rest: &[f64], joints: &[f64], mine: &[usize], others: &[usize]) -> Option<(f64, Vec<bool>)> {
        let mut values = rest.to_vec();
        for (variable, value) in self.variables.iter().zip(joints) {
            *values.get_mut(*variable)? = *value;
        }
        let mut poses = vec![Isometry3::identity(); self.tree.link_count()];
        self.tree.forward(&values, &Isometry3::identity(), &mut poses).ok()?;
        let body = |link: usize| Some((self.bodies.get(link)?.as_ref()?, poses.get(link)?));
        let mut reach_m = 0.0_f64;
        let mut near = Vec::new();
        for link in mine {
            let (shape, pose) = body(*link)?;
            for corner in corners(shape) {
                let at = pose * corner;
                reach_m = reach_m.max(self.footprint.in_the_way_m(&at));
            }
            for other in others {
                let (shape_there, there) = body(*other)?;
                let apart =
                    clearance::between(shape, pose, shape_there, there).map_or(f64::INFINITY, |found| found.distance);
                near.push(apart < APART_M);
            }
        }
        Some((reach_m, near))
    }
}

fn draw(limit: &JointLimit, rng: &mut Stream) -> f64 {
    if limit.lower.is_finite() && limit.upper.is_finite() {
        rng.random_range(limit.lower..=limit.upper)
    } else {
        rng.random_range(-3.1..3.1)
    }
}
