//! The robot as the base moves it: one rigid body with everything on it, and how far it is from the obstacles.
//!
//! An obstacle only meets what of the robot is at its height. So the robot has a layer for every range of heights of an
//! obstacle: the sections of its solids there, as outlines in the frame of the base. The distance of two outlines is never
//! more than that of the solids, so what is clear here is clear.

use darrt_core::domain::Domain;
use darrt_core::space::Se2;
use nalgebra::{Isometry3, Vector2, Vector3};

use super::floor_plan::{FloorPlan, Obstacle};
use super::outline::{Contact, Frame, Outline};
use super::section::Placed;
use crate::manipulator::{Configuration, Manipulator, world_from_base};
use crate::tabletop::{Tabletop, TabletopState};

/// How many outlines of a layer are asked whether they hold another one.
const HOLDERS: usize = 6;

/// What of the robot is between two heights.
#[derive(Debug, Clone)]
struct Layer {
    z_m: [f64; 2],
    /// In the frame of the base, those that reach farthest first; none lies within another.
    outlines: Vec<Outline>,
    /// Farthest from the axis of the base, metres.
    reach_m: f64,
    /// A disc of this radius about the axis lies in one of the outlines. Where none holds the axis: minus the distance of the
    /// nearest one, so that only obstacles that reach so far beyond the axis collide at every yaw.
    inner_m: f64,
}

/// An obstacle that is at the height of something of the robot.
#[derive(Debug, Clone)]
struct Standing {
    outline: Outline,
    layer: usize,
}

/// One pair that is near.
#[derive(Debug, Clone, Copy)]
pub(super) struct Near {
    /// Signed distance, metres.
    pub(super) distance_m: f64,
    /// How the distance grows with x, y (metres per metre) and yaw (metres per radian) of the base.
    pub(super) slope: Vector3<f64>,
}

impl Near {
    /// The slope with the yaw in metres that a point at `reach_m` travels.
    pub(super) fn row(&self, reach_m: f64) -> Vector3<f64> {
        Vector3::new(self.slope.x, self.slope.y, self.slope.z / reach_m)
    }
}

/// The robot among the obstacles. Asking for a distance allocates nothing.
#[derive(Debug, Clone)]
pub(super) struct Footprint {
    layers: Vec<Layer>,
    standing: Vec<Standing>,
    /// Pairs of an obstacle and an outline of its layer that do not count.
    forgiven: Vec<(usize, usize)>,
    bounds: Se2,
    reach_m: f64,
    /// The outline of an obstacle as the base sees it.
    seen: Outline,
    /// The pair that was nearest to the pose asked about last.
    nearest: Option<(usize, usize)>,
    /// Poses asked about.
    looks: usize,
}

impl Footprint {
    /// The robot of `state` with what it holds, among the fixed bodies of `plan` and the objects that it does not hold.
    /// What is nearer than `clearance_m` above or below each other counts as being at one height.
    pub(super) fn new<M: Manipulator>(
        m: &Tabletop<M>,
        state: &TabletopState<M>,
        plan: &FloorPlan,
        clearance_m: f64,
    ) -> Self {
        let robot = m.manipulator();
        let mut poses = vec![Isometry3::identity(); robot.links().len()];
        let parked = Configuration { base: [0.0; 3], arm: state.robot.arm };
        robot.link_poses(&parked, state.mode.gap_m(), &mut poses);
        let links = robot.links().iter().map(|link| &link.body).zip(poses);
        let held = state.mode.held().map(|held| held.object.index());
        let base_from_world = world_from_base(&state.robot.base).inverse();
        let objects = m.movables().iter().zip(&state.objects).enumerate();
        let in_hand = objects.clone().filter(|(i, _)| Some(*i) == held);
        let in_hand = in_hand.map(|(_, (movable, pose))| (&movable.body, base_from_world * pose));
        let solids: Vec<_> = links
            .chain(in_hand)
            .flat_map(|(body, pose)| body.parts.iter().filter_map(move |part| Placed::new(part, &pose)))
            .collect();
        let others = objects.filter(|(i, _)| Some(*i) != held).flat_map(|(_, (movable, pose))| {
            let solids = movable.body.parts.iter().filter_map(|part| Placed::new(part, pose));
            solids.filter_map(|solid| Obstacle::new(&solid))
        });
        let mut footprint = Self {
            layers: Vec::new(),
            standing: Vec::new(),
            forgiven: Vec::new(),
            bounds: m.robot().base().clone(),
            reach_m: 0.0,
            seen: Outline::default(),
            nearest: None,
            looks: 0,
        };
        for obstacle in plan.obstacles.iter().cloned().chain(others) {
            footprint.add(obstacle, &solids, clearance_m);
        }
        footprint.reach_m = footprint.layers.iter().map(|layer| layer.reach_m).fold(0.0, f64::max);
        footprint
    }

    fn add(&mut self, obstacle: Obstacle, solids: &[Placed<'_>], clearance_m: f64) {
        let z_m = [obstacle.z_m[0] - clearance_m, obstacle.z_m[1] + clearance_m];
        let layer = self.layers.iter().position(|layer| layer.z_m == z_m).unwrap_or_else(|| {
            self.layers.push(Layer::new(solids, z_m));
            self.layers.len() - 1
        });
        if self.layers.get(layer).is_some_and(|layer| !layer.outlines.is_empty()) {
            self.standing.push(Standing { outline: obstacle.outline, layer });
        }
    }

    /// No point of the robot travels farther than this per radian that the base turns, metres; only what is at the height of
    /// some obstacle counts.
    pub(super) fn reach_m(&self) -> f64 {
        self.reach_m
    }

    /// How many poses have been asked about.
    pub(super) fn looks(&self) -> usize {
        self.looks
    }

    /// The bounds of the base.
    pub(super) fn bounds(&self) -> &Se2 {
        &self.bounds
    }

    /// Corners of a rectangle around the obstacles. `None` if there are none.
    pub(super) fn extent(&self) -> Option<[Vector2<f64>; 2]> {
        self.standing.iter().fold(None, |extent, Standing { outline, .. }| {
            let reach = Vector2::repeat(outline.reach_m());
            let (low, high) = (outline.centre() - reach, outline.centre() + reach);
            Some(extent.map_or([low, high], |[a, b]: [Vector2<f64>; 2]| [a.inf(&low), b.sup(&high)]))
        })
    }

    /// How near the obstacles come to the base's axis at `at` whichever way it faces, beyond what always collides: where it
    /// is negative every yaw collides. Metres, at most `cap_m`.
    pub(super) fn beyond_core_m(&self, at: &Vector2<f64>, cap_m: f64) -> f64 {
        self.standing.iter().fold(cap_m, |least, Standing { outline, layer }| {
            let inner_m = self.layers.get(*layer).map_or(f64::NEG_INFINITY, |layer| layer.inner_m);
            if (at - outline.centre()).norm() - outline.reach_m() - inner_m >= least {
                return least;
            }
            least.min(outline.beyond_m(at) - inner_m)
        })
    }

    /// Lower bound of the distance to the obstacles with the base at `q`, metres: exact if less than `cap_m`, which it never
    /// exceeds; negative where they overlap. As soon as it is less than `least_m`, others are not looked at. Outside the
    /// bounds of the base it is negative infinity.
    pub(super) fn distance_m(&mut self, q: &[f64; 3], cap_m: f64, least_m: f64) -> f64 {
        if !self.is_within(q) {
            return f64::NEG_INFINITY;
        }
        self.looks += 1;
        // OPTIMIZATION: what was nearest to the pose before mostly is nearest to this one, and rules out the others.
        let mut least = self.distance_of(self.nearest, q, cap_m);
        let mut nearest = self.nearest;
        if least >= least_m {
            self.visit(q, least, |pair, contact| {
                (least, nearest) = (contact.distance_m, Some(pair));
                (least >= least_m).then_some(least)
            });
            self.nearest = nearest;
        }
        least
    }

    /// The distance of one pair, at most `cap_m`.
    fn distance_of(&mut self, pair: Option<(usize, usize)>, q: &[f64; 3], cap_m: f64) -> f64 {
        let standing = pair.and_then(|(number, _)| self.standing.get(number));
        let layer = standing.and_then(|standing| self.layers.get(standing.layer));
        let outline = layer.and_then(|layer| layer.outlines.get(pair?.1));
        let (Some(standing), Some(outline)) = (standing, outline) else { return cap_m };
        standing.outline.seen_from(&Frame::new(q), &mut self.seen);
        outline.contact(&self.seen, cap_m).distance_m.min(cap_m)
    }

    /// The pairs that are nearer than `range_m` with the base at `q`, written over `out`.
    pub(super) fn near(&mut self, q: &[f64; 3], range_m: f64, out: &mut Vec<Near>) {
        out.clear();
        self.looks += 1;
        let frame = Frame::new(q);
        self.visit(q, range_m, |_, contact| {
            let away = frame.turned(&contact.away);
            let slope = Vector3::new(away.x, away.y, contact.at.perp(&contact.away));
            out.push(Near { distance_m: contact.distance_m, slope });
            Some(range_m)
        });
    }

    /// What is nearer than `least_m` with the base at `q` does not count from here on: somebody who knows better has found
    /// this pose clear. Was there anything?
    pub(super) fn forgive(&mut self, q: &[f64; 3], least_m: f64) -> bool {
        let mut near = Vec::new();
        self.visit(q, least_m, |pair, _| {
            near.push(pair);
            Some(least_m)
        });
        self.forgiven.extend_from_slice(&near);
        self.nearest = None;
        !near.is_empty()
    }

    /// Is the base within its bounds?
    pub(super) fn is_within(&self, [x, y, _]: &[f64; 3]) -> bool {
        let position = self.bounds.position();
        let ([x_low, y_low], [x_high, y_high]) = (position.lower(), position.upper());
        (x_low..=x_high).contains(&x) && (y_low..=y_high).contains(&y)
    }

    /// Calls `each` with the pairs nearer than `cap_m`, which it may lower for those that follow; `None` ends the visit.
    fn visit(&mut self, q: &[f64; 3], mut cap_m: f64, mut each: impl FnMut((usize, usize), &Contact) -> Option<f64>) {
        let mut seen = std::mem::take(&mut self.seen);
        let frame = Frame::new(q);
        let here = Vector2::new(q[0], q[1]);
        'visit: for (number, Standing { outline: obstacle, layer }) in self.standing.iter().enumerate() {
            let Some(layer) = self.layers.get(*layer) else { continue };
            if (obstacle.centre() - here).norm() - obstacle.reach_m() - layer.reach_m >= cap_m {
                continue;
            }
            obstacle.seen_from(&frame, &mut seen);
            let from_axis_m = seen.beyond_edges(&Vector2::zeros());
            for (part, outline) in layer.outlines.iter().enumerate() {
                // All that follow reach less far.
                if from_axis_m - outline.farthest_m() >= cap_m {
                    break;
                }
                if seen.beyond_edges(outline.centre()) - outline.reach_m() >= cap_m
                    || self.forgiven.contains(&(number, part))
                {
                    continue;
                }
                let contact = outline.contact(&seen, cap_m);
                if contact.distance_m < cap_m {
                    match each((number, part), &contact) {
                        Some(cap) => cap_m = cap,
                        None => break 'visit,
                    }
                }
            }
        }
        self.seen = seen;
    }
}

impl Layer {
    fn new(solids: &[Placed<'_>], z_m: [f64; 2]) -> Self {
        let mut sections: Vec<_> = solids.iter().filter_map(|solid| solid.section(z_m)).collect();
        // Most of what lies within another outline lies within one of the largest.
        sections.sort_by(|a, b| b.reach_m().total_cmp(&a.reach_m()));
        let mut outlines: Vec<Outline> = Vec::new();
        for section in sections {
            if !outlines.iter().take(HOLDERS).any(|outline| outline.holds(&section)) {
                outlines.push(section);
            }
        }
        outlines.sort_by(|a, b| b.farthest_m().total_cmp(&a.farthest_m()));
        let axis = Vector2::zeros();
        let reach_m = outlines.first().map_or(0.0, Outline::farthest_m);
        let inner_m = outlines.iter().map(|outline| -outline.beyond_m(&axis)).fold(f64::NEG_INFINITY, f64::max);
        Self { z_m, outlines, reach_m, inner_m }
    }
}
