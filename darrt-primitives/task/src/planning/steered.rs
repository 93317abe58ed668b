//! Primitives that keep to the rules by which a person steers a plan, and a goal that asks for what the plan must contain.
//!
//! What a rule requires is part of the state: the step that does it leaves a mark in the mode, which every later state carries, and
//! only a state with all marks is in the goal. So a tree, a shortened plan and an improved one are in the goal only if their
//! own way there contains what is required.

use std::sync::Arc;

use darrt_core::goal::Goal;
use darrt_core::motion::{Instance, Motion};
use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use darrt_core::validity::{Blame, BlockKind};
use darrt_geom::{Scene, SupportSurface};
use darrt_primitives::contract::{Contract, HandUse};
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::tabletop::{Tabletop, TabletopState};
use nalgebra::{Point2, Point3};
use rand::{Rng, RngExt};

use crate::problem_file::{Region, Steer};

/// What stands for a body in the way of a step that a rule forbids.
pub(crate) const STEER: &str = "`steer`";
/// The side of the hand is that of a point so far behind its tool frame, metres: at a grasp the frame itself is in the object.
const WRIST_M: f64 = 0.1;
/// A hand of which that is no farther beside the centre of an object is above it, metres.
const ABOVE_M: f64 = 0.01;

/// How often, of ten times, a step into the goal is refused that would be there before what is required has been done. Not always:
/// the way to it may lead through the goal.
const OFTEN: u32 = 9;
/// An object stands on a surface if its bottom is no farther above or below it, metres.
const ON_TOP_M: f64 = 1e-3;

/// A primitive of which only those chains are proposed that keep to the rules; they mark what they do of what is required.
pub(super) struct Steered<P, G> {
    pub(super) part: P,
    pub(super) rules: Arc<[Rule]>,
    /// What is wanted besides what is required.
    pub(super) goal: Arc<G>,
}

/// A rule, and the primitive that it is about; `None`: all of them.
pub(super) struct Rule {
    primitive: Option<PrimitiveId>,
    steer: Steer,
    /// The surface that it names.
    surface: Option<SupportSurface>,
    /// For what is required, its mark in a mode; else 0.
    mark: u64,
}

/// The rules about these primitives in this scene.
pub(super) fn rules(steers: &[Steer], primitives: &[PrimitiveId], scene: &Scene) -> Arc<[Rule]> {
    let known = |steer: &Steer| match &steer.primitive {
        None => Some(None),
        Some(name) => primitives.iter().find(|id| id.name() == name.as_str()).map(|id| Some(*id)),
    };
    let rule = |(index, steer): (usize, &Steer)| {
        let surface = steer.surface.as_ref().and_then(|name| scene.surface(name)).cloned();
        let mark = if steer.require { 1_u64.checked_shl(u32::try_from(index).ok()?)? } else { 0 };
        Some(Rule { primitive: known(steer)?, steer: steer.clone(), surface, mark })
    };
    steers.iter().enumerate().filter_map(rule).collect()
}

/// The marks of all that is required.
pub(super) fn required(rules: &[Rule]) -> u64 {
    rules.iter().fold(0, |marks, rule| marks | rule.mark)
}

/// A goal whose states have done what is required besides.
pub(super) struct Required<G> {
    pub(super) part: Arc<G>,
    /// See [`Mode::done`](darrt_primitives::mode::Mode::done).
    pub(super) marks: u64,
}

impl<M: Manipulator, G: Goal<Tabletop<M>>> Goal<Tabletop<M>> for Required<G> {
    fn is_satisfied(&self, m: &Tabletop<M>, state: &TabletopState<M>) -> bool {
        state.mode.done() & self.marks == self.marks && self.part.is_satisfied(m, state)
    }

    fn sample(&self, m: &Tabletop<M>, rng: &mut dyn Rng) -> Option<PartialState<Tabletop<M>>> {
        self.part.sample(m, rng)
    }

    fn parts_met(&self, m: &Tabletop<M>, state: &TabletopState<M>) -> usize {
        self.part.parts_met(m, state) + (state.mode.done() & self.marks).count_ones() as usize
    }
}

/// A motion behind which, or at whose end, something has been done that is required.
struct Marked<M: Manipulator> {
    part: Box<dyn Motion<Tabletop<M>>>,
    /// Marks on the way, and at the end.
    marks: [u64; 2],
}

impl<M: Manipulator> std::fmt::Debug for Marked<M> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Marked").field("part", &self.part).field("marks", &self.marks).finish()
    }
}

impl<M: Manipulator> Motion<Tabletop<M>> for Marked<M> {
    fn length(&self) -> f64 {
        self.part.length()
    }

    fn knots(&self) -> &[f64] {
        self.part.knots()
    }

    fn at_into(&self, m: &Tabletop<M>, t: f64, out: &mut TabletopState<M>) {
        self.part.at_into(m, t, out);
        let [on_the_way, at_the_end] = self.marks;
        out.mode.note_done(if t >= 1.0 { at_the_end } else { on_the_way });
    }
}

impl<M: Manipulator, G: Goal<Tabletop<M>>> Primitive<Tabletop<M>> for Steered<Box<dyn Primitive<Tabletop<M>>>, G> {
    fn id(&self) -> PrimitiveId {
        self.part.id()
    }

    fn useful(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> bool {
        self.part.useful(m, from, to)
    }

    fn approach(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> Option<f64> {
        self.part.approach(m, from, to)
    }

    fn propagate(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &PartialState<Tabletop<M>>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<Tabletop<M>>, Infeasible> {
        let proposed = self.part.propagate(m, from, to, rng)?;
        let mut chain = Instances::with_capacity(proposed.len());
        let mut here = from.clone();
        let mut marks = 0;
        let required = required(&self.rules);
        for instance in proposed {
            let after = instance.at(m, 1.0, &here);
            let refused = |what: String| {
                let [x, y, _] = here.robot.base;
                let (first, second) = (what.as_str().into(), STEER.into());
                Err(Infeasible::Blocked(Blame { kind: BlockKind::Other, first, second, place: [x, y, 0.0] }))
            };
            let mut gained = 0;
            if let Some(contract) = m.contract(instance.primitive).copied().filter(Contract::manipulates) {
                match self.judged(m, contract, &instance, (&here, &after)) {
                    Ok(done) => gained = done,
                    Err(broken) => return refused(broken),
                }
            }
            let missing = required & !(after.mode.done() | marks | gained);
            if missing != 0 && self.goal.is_satisfied(m, &after) && rng.random_ratio(OFTEN, 10) {
                return refused(format!("{} into the goal before what is required", instance.primitive.name()));
            }
            here = after;
            chain.push(if marks | gained == 0 {
                instance
            } else {
                let motion = Box::new(Marked { part: instance.motion, marks: [marks, marks | gained] });
                // Backwards it would take back what has been done.
                Instance { motion, reversible: instance.reversible && gained == 0, ..instance }
            });
            marks |= gained;
        }
        Ok(chain)
    }
}

impl<P, G> Steered<P, G> {
    /// The marks of what an instance does of what is required, or what of it a rule forbids.
    fn judged<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        contract: Contract,
        instance: &Instance<Tabletop<M>>,
        (before, after): (&TabletopState<M>, &TabletopState<M>),
    ) -> Result<u64, String> {
        let found = instance.object.and_then(|id| Some((id, m.movable(id)?)));
        let Some((id, movable)) = found else { return Ok(0) };
        let name = &*movable.body.name;
        let at = if contract.hand == HandUse::LetsGo { after } else { before };
        let Some(pose) = at.object(id) else { return Ok(0) };
        let wrist = m.manipulator().world_from_tool(&at.robot) * Point3::new(-WRIST_M, 0.0, 0.0);
        let hand = wrist.coords - pose.translation.vector;
        let [x, y, _] = at.robot.base;
        let (centre, bottom_m) =
            (Point2::from(pose.translation.vector.xy()), pose.translation.z - movable.half_height_m);
        let stands_on = |top: &SupportSurface| (bottom_m - top.height()).abs() <= ON_TOP_M && top.contains(&centre);
        let side =
            |range: [f64; 2]| hand.xy().norm() <= ABOVE_M || is_between(hand.y.atan2(hand.x).to_degrees(), range);
        let is_about = |rule: &&Rule| {
            rule.steer.object.as_deref().is_none_or(|object| object == name)
                && rule.primitive.is_none_or(|id| id == instance.primitive)
        };
        let keeps = |Rule { steer: rule, surface, .. }: &Rule| {
            rule.from_deg.is_none_or(side)
                && rule.base.as_ref().is_none_or(|region| holds(region, [x, y]))
                && !rule.not_base.as_ref().is_some_and(|region| holds(region, [x, y]))
                && surface.as_ref().is_none_or(stands_on)
        };
        let mut done = 0;
        for rule in self.rules.iter().filter(is_about) {
            match (rule.steer.require, rule.steer.forbid, keeps(rule)) {
                (true, _, true) => done |= rule.mark,
                (true, _, false) | (_, true, false) | (false, false, true) => {}
                (_, true, true) | (false, false, false) => {
                    return Err(format!("{} of {name}", instance.primitive.name()));
                }
            }
        }
        Ok(done)
    }
}

/// Is a direction in a range, counter-clockwise from its beginning? All in degrees.
fn is_between(direction: f64, [from, to]: [f64; 2]) -> bool {
    (direction - from).rem_euclid(360.0) <= to - from || to - from >= 360.0
}

fn holds(region: &Region, at: [f64; 2]) -> bool {
    (0..2).all(|axis| (region.min[axis]..=region.max[axis]).contains(&at[axis]))
}

#[cfg(test)]
mod tests {
    use super::is_between;

    #[test]
    fn ranges_go_counter_clockwise_and_over_the_seam() {
        assert!(is_between(90.0, [80.0, 100.0]) && !is_between(110.0, [80.0, 100.0]));
        assert!(is_between(-170.0, [170.0, 200.0]) && is_between(179.0, [170.0, 200.0]));
        assert!(is_between(0.0, [-10.0, 10.0]) && !is_between(180.0, [-10.0, 10.0]));
        assert!(is_between(123.0, [0.0, 360.0]));
    }
}
