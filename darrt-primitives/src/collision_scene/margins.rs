//! How far pairs of bodies keep from each other: the margins of the problem, as clearances for the collision model.
//!
//! Three kinds of pairs keep less than the rest: what must be near because the hand is at work there, what the robot's own
//! joints bring together, and what already was nearer when the problem began.

use std::sync::Arc;

use darrt_core::state::ObjectId;
use darrt_geom::body_set::{BodyIndex, BodySet};
use darrt_geom::collide::Closer;

use super::CollisionScene;
use crate::manipulator::Manipulator;
use crate::mode::Contacts;
use crate::tabletop::{SafetySettings, TabletopState};

/// How strict the check is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strictness {
    /// The margins, which hold between the states looked at as well.
    pub safety: SafetySettings,
    /// Distances beyond this count as this: the farthest that a motion advances at once, metres.
    pub cap_m: f64,
}

impl Default for Strictness {
    fn default() -> Self {
        Self { safety: SafetySettings::default(), cap_m: 0.2 }
    }
}

/// By care: how much of the wanted margins is asked for. The least margins are asked for at any.
const SHARES: [f64; 3] = [0.0, 0.5, 1.0];

/// How much farther apart than its margin a pair is at the states looked at, metres: what a motion may give away between
/// them, so that it advances however near it passes.
pub(super) const UNSEEN_M: f64 = 2e-5;

/// A pair that begins nearer than its margin may come nearer by this much, metres: as far as the hand may stray from a straight
/// line ([`line`](crate::action::line)).
const STRAY_M: f64 = 5e-4;

/// How far the distances may be off by which it is decided which pairs begin too near, metres.
const ROUNDING_M: f64 = 1e-5;

/// Nearer than this is not apart, metres: so near the collision model calls it touching.
const TOUCHING_M: f64 = 1e-7;

/// Two bodies that are nearer than the least margin at the start or at the goal, and do not touch.
#[derive(Debug, Clone, PartialEq)]
pub struct NearPair {
    /// Their names.
    pub bodies: [Arc<str>; 2],
    /// Metres.
    pub distance_m: f64,
    /// Is it at the goal? Else at the start.
    pub is_at_goal: bool,
}

/// What is asked about a state or a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Strict {
    /// See [`Validity::most_care`](darrt_core::validity::Validity::most_care).
    pub(crate) care: usize,
    /// With what a motion may give away between the states looked at.
    pub(crate) is_between: bool,
}

impl Strict {
    /// As states are looked at.
    pub(crate) fn with(care: usize) -> Self {
        Self { care, is_between: false }
    }
}

/// Which pairs are near because the hand is at work, and how strictly all are judged.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Terms {
    pub(super) strict: Strict,
    /// Hand and object, against the object and what carries it.
    pub(super) near: Option<(BodySet, BodySet)>,
    pub(super) held: BodySet,
    /// The hand at work.
    pub(super) hand: BodySet,
}

impl Terms {
    /// Is what is clear on these terms clear on the others?
    pub(super) fn imply(&self, other: &Self) -> bool {
        self.strict.care >= other.strict.care
            && self.strict.is_between <= other.strict.is_between
            && (self.near.is_none() || self.near == other.near)
            && self.held == other.held
            && self.hand == other.hand
    }
}

/// The clearances of all pairs.
#[derive(Debug, Default)]
pub(crate) struct Keep {
    pub(super) terms: Terms,
    /// Of pairs that are not among the closer ones, metres.
    pub(super) most_m: f64,
    pub(super) closer: Vec<Closer>,
}

impl CollisionScene {
    /// The most care there is: see [`Validity::most_care`](darrt_core::validity::Validity::most_care).
    pub fn most_care(&self) -> usize {
        let SafetySettings { robot_margin_m, held_margin_m, object_margin_m, least_margin_m, .. } =
            self.strictness.safety;
        let is_more =
            |share: &f64| [robot_margin_m, held_margin_m, object_margin_m].iter().any(|m| share * m > least_margin_m);
        SHARES.iter().rposition(is_more).unwrap_or(0)
    }

    /// How far the robot and what it holds keep from everything else with this care, metres, and how far at least.
    pub(crate) fn drive_margins_m(&self, care: usize) -> [f64; 2] {
        let SafetySettings { robot_margin_m, held_margin_m, least_margin_m, .. } = self.strictness.safety;
        let share = SHARES.get(care).copied().unwrap_or(1.0);
        [(share * robot_margin_m.max(held_margin_m)).max(least_margin_m), least_margin_m]
    }

    /// How far every pair keeps in this mode during an instance with these contacts: into `keep`.
    pub(super) fn keep<M: Manipulator>(
        &self,
        state: &TabletopState<M>,
        contacts: &Contacts,
        strict: Strict,
        keep: &mut Keep,
    ) {
        let mode = &state.mode;
        let resting = |object: ObjectId| Some((object, mode.support_of(object)?));
        let touched = contacts.fingers.and_then(|(object, _)| resting(object));
        let at_work = contacts.support.or(touched).or_else(|| mode.engaged().and_then(resting));
        let body = |object: ObjectId| self.objects.get(object.index()).copied();
        let hand = self.hand_at_work(state);
        let near = at_work.and_then(|(object, surface)| {
            let object = body(object)?;
            let under = self.supports.get(surface.index()).into_iter().flatten().copied();
            let (mut ones, mut others) = (hand, under.collect::<BodySet>());
            for set in [&mut ones, &mut others] {
                set.insert(object);
            }
            Some((ones, others))
        });
        let held = mode.held().and_then(|held| body(held.object)).into_iter().collect();
        self.write(&Terms { strict, near, held, hand }, keep);
    }

    /// How far every pair keeps while the hand is at work nowhere: into `keep`.
    pub(super) fn keep_alone(&self, strict: Strict, keep: &mut Keep) {
        self.write(&Terms { strict, ..Terms::default() }, keep);
    }

    fn write(&self, terms: &Terms, keep: &mut Keep) {
        let SafetySettings { robot_margin_m, held_margin_m, object_margin_m, least_margin_m, contact_margin_m, .. } =
            self.strictness.safety;
        let unseen_m = if terms.strict.is_between { 0.0 } else { self.unseen_m };
        let share = SHARES.get(terms.strict.care).copied().unwrap_or(1.0);
        let [robot_m, held_m, object_m] = [robot_margin_m, held_margin_m, object_margin_m]
            .map(|margin| (share * margin).max(least_margin_m) + unseen_m);
        let (least_m, contact_m) = (least_margin_m + unseen_m, contact_margin_m + unseen_m);
        let Keep { closer, most_m, .. } = keep;
        closer.clear();
        closer.extend(self.exceptions.iter().map(|e| Closer { clearance: e.clearance + unseen_m, ..*e }));
        let mut may = |ones: BodySet, others: BodySet, clearance: f64| {
            closer.push(Closer { ones, others, clearance, only: None });
        };
        if let Some((ones, others)) = terms.near {
            may(ones, others, contact_m);
        }
        if !terms.held.is_empty() {
            may(terms.hand, terms.held, contact_m);
        }
        *most_m = robot_m.max(held_m).max(object_m);
        if *most_m > least_m {
            // What the joints bring to the robot's own body is no nearer to it than to a table: only the links of an arm are
            // near each other by the way they are built.
            may(self.hand_links, self.base_links, robot_m);
            may(self.all_links, self.all_links, least_m);
            may(self.all_links, BodySet::ALL, robot_m);
            may(terms.held, BodySet::ALL, held_m);
            may(BodySet::ALL, BodySet::ALL, object_m);
        }
        keep.terms = *terms;
    }

    /// Pairs that do not touch in `state`, though they are nearer than the least margin: from now on they may be as near as
    /// they are there, but for what a hand strays from a straight line. `counts` says of which pairs to ask.
    ///
    /// Called before anything else is asked: what is known of states with other margins is not forgotten.
    pub(crate) fn accept_near<M: Manipulator>(
        &mut self,
        robot: &M,
        state: &TabletopState<M>,
        is_at_goal: bool,
    ) -> Vec<NearPair> {
        let mut worker = self.new_worker();
        self.pose_all(robot, state, &mut worker);
        self.allow(state, &Contacts::default(), &mut worker.allowed);
        let least_m = self.strictness.safety.least_margin_m;
        let enough_m = least_m + UNSEEN_M + ROUNDING_M;
        // Those that move were registered first.
        let pairs =
            self.model.moving().iter().flat_map(|a| self.model.indices().map(move |b| (a, b))).filter(|(a, b)| {
                let is_asked = !is_at_goal || !self.all_links.contains(*a) && !self.all_links.contains(*b);
                a < b && is_asked && self.model.is_tested(*a, *b) && !worker.allowed.contains(*a, *b)
            });
        let near = pairs.map(|(a, b)| (a, b, self.model.distance_between(&worker.scratch, a, b, enough_m)));
        let near: Vec<_> = near.filter(|(.., distance_m)| (TOUCHING_M..enough_m).contains(distance_m)).collect();
        let name = |id| self.model.name(id).map_or_else(|| "unknown body".into(), Arc::clone);
        let told = near.iter().filter(|(.., distance_m)| *distance_m < least_m - ROUNDING_M);
        let told =
            told.map(|(a, b, distance_m)| NearPair { bodies: [*a, *b].map(name), distance_m: *distance_m, is_at_goal });
        let told = told.collect();
        for (a, b, distance_m) in near {
            self.except(a, b, distance_m);
        }
        told
    }

    /// The two may be nearly as near to each other as `distance_m`.
    fn except(&mut self, a: BodyIndex, b: BodyIndex, distance_m: f64) {
        let clearance = (distance_m - STRAY_M).max(0.0);
        // Even a pair that nearly touches must have something to give away between two states.
        self.unseen_m = self.unseen_m.min(distance_m / 4.0);
        let [ones, others] = [a, b].map(|id| BodySet::from_iter([id]));
        let only = Some((a.min(b), a.max(b)));
        match self.exceptions.iter_mut().find(|e| e.only == only) {
            Some(known) => known.clearance = known.clearance.min(clearance),
            None => self.exceptions.push(Closer { ones, others, clearance, only }),
        }
    }
}
