//! What is in the way: robot, held and pushed objects against each other and against the scene, over whole motions.
//!
//! A motion is judged by conservative advancement: a pair of bodies that is `d` apart cannot touch before the two have
//! travelled `d` towards each other, so the next state to look at is as far on as the most urgent pair allows. Free
//! therefore means free between the states looked at as well.
//!
//! # Source
//! Mirtich, Impulse-based dynamic simulation of rigid body systems, 1996 (conservative advancement); Schwarzer, Saha and
//! Latombe, Adaptive dynamic collision checking for single and multiple articulated robots in complex environments, 2005
//! (a bound on the travel of each body).

use std::sync::Arc;

use darrt_core::domain::Domain;
use darrt_core::motion::Instance;
use darrt_core::space::ComponentSpace;
use darrt_core::space::so2::turn;
use darrt_core::state::ObjectId;
use darrt_core::validity::{Blame, BlockKind, FreePrefix, Validity};
use darrt_geom::body_set::{BodyIndex, BodySet};
use darrt_geom::collide::CollisionModel;
use nalgebra::{Isometry3, Point2};

use crate::manipulator::Manipulator;
use crate::mode::Contacts;
use crate::surroundings::{KEPT_BETWEEN, Surroundings, Worker};
use crate::tabletop::{Tabletop, TabletopState};

/// The scene as seen by a table-top domain.
#[derive(Debug, Clone)]
pub struct SceneValidity {
    surroundings: Arc<Surroundings>,
}

/// One leg of a motion: everything moves in a straight line of its space.
struct Leg {
    /// Parameter at its end.
    end: f64,
    /// What moves.
    moved: BodySet,
    /// What it may meet: all but what moves rigidly with it.
    against: BodySet,
    /// The links, and what is held.
    chain: BodySet,
    /// Bound on the metres by which any pair approaches per unit of the parameter.
    fastest: f64,
}

impl SceneValidity {
    /// The check for domain `m`.
    pub fn new<M: Manipulator>(m: &Tabletop<M>) -> Self {
        Self { surroundings: Arc::clone(m.surroundings()) }
    }

    /// The collision model, for reports.
    pub fn model(&self) -> &CollisionModel {
        self.surroundings.model()
    }

    /// Joint limits and the bounds of the base.
    fn check_limits<M: Manipulator>(m: &Tabletop<M>, state: &TabletopState<M>) -> Result<(), Blame> {
        let [x, y, _] = state.robot.base;
        if let Some((joint, value)) = m.robot().first_outside(&state.robot.arm) {
            let bound =
                m.robot().limits().get(joint).map_or_else(String::new, |l| format!("[{}, {}]", l.lower, l.upper));
            let first = format!("arm joint {joint} at {value}").into();
            return Err(Blame { kind: BlockKind::Limits, first, second: bound.into(), place: [x, y, 0.0] });
        }
        if !m.robot().base().contains(&state.robot.base) {
            let first = format!("base at {:?}", state.robot.base).into();
            return Err(Blame {
                kind: BlockKind::Limits,
                first,
                second: "the base's bounds".into(),
                place: [x, y, 0.0],
            });
        }
        Ok(())
    }

    /// Limits and supports: everything that needs no geometry of bodies.
    fn check_rules<M: Manipulator>(m: &Tabletop<M>, state: &TabletopState<M>) -> Result<(), Blame> {
        Self::check_limits(m, state)?;
        for (i, pose) in state.objects.iter().enumerate() {
            let id = ObjectId::new(i);
            Self::check_object(m, state, id, pose)?;
        }
        Ok(())
    }

    /// An object is held, or rests over its surface.
    fn check_object<M: Manipulator>(
        m: &Tabletop<M>,
        state: &TabletopState<M>,
        id: ObjectId,
        pose: &Isometry3<f64>,
    ) -> Result<(), Blame> {
        let name = m.movable(id).map_or_else(|| "object".into(), |o| Arc::clone(&o.body.name));
        let place = [pose.translation.x, pose.translation.y, pose.translation.z];
        if m.objects().get(id.index()).is_some_and(|space| !space.contains(pose)) {
            return Err(Blame { kind: BlockKind::Limits, first: name, second: "the object's bounds".into(), place });
        }
        match state.mode.support_of(id).map(|s| m.surface(s)) {
            None if state.mode.held().is_some_and(|held| held.object == id) => Ok(()),
            Some(Some(surface)) if surface.contains(&Point2::new(place[0], place[1])) => Ok(()),
            Some(Some(surface)) => {
                Err(Blame { kind: BlockKind::OffSupport, first: name, second: surface.name().into(), place })
            }
            _ => Err(Blame { kind: BlockKind::OffSupport, first: name, second: "nothing".into(), place }),
        }
    }

    /// How far the parameter may grow before an object that slides could leave its surface: its centre is as far from
    /// the edge as the surface says. For surfaces with notches; the end of a slide is looked at anyhow.
    fn to_edge<M: Manipulator>(&self, m: &Tabletop<M>, state: &TabletopState<M>, leg: &Leg) -> f64 {
        let mut least = f64::INFINITY;
        for (i, (body, pose)) in self.surroundings.objects().iter().zip(&state.objects).enumerate() {
            if leg.moved.contains(*body)
                && let Some(surface) = state.mode.support_of(ObjectId::new(i)).and_then(|s| m.surface(s))
            {
                let depth_m = surface.depth(&Point2::new(pose.translation.x, pose.translation.y));
                least = least.min(depth_m.max(0.0) / leg.fastest);
            }
        }
        least
    }

    /// Objects that moved still keep the rules.
    fn check_moved_objects<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        state: &TabletopState<M>,
        moved: &BodySet,
    ) -> Result<(), Blame> {
        for (i, (body, pose)) in self.surroundings.objects().iter().zip(&state.objects).enumerate() {
            if moved.contains(*body) {
                Self::check_object(m, state, ObjectId::new(i), pose)?;
            }
        }
        Ok(())
    }

    /// What moves from `a`, where every body stands, to `b`, and how fast each body travels: written to `worker.reach`,
    /// metres per unit of the parameter, of which the leg takes `span`.
    fn leg<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        a: &TabletopState<M>,
        b: &TabletopState<M>,
        (end, span): (f64, f64),
        worker: &mut Worker,
    ) -> Leg {
        let around = &*self.surroundings;
        let mut moved = around.moved(a, b);
        let mut chain = *around.all_links();
        let drives = a.robot.arm == b.robot.arm && a.robot.base != b.robot.base;
        let mut held_travel = 0.0;
        if a.robot == b.robot {
            worker.link_travel.fill(0.0);
        } else {
            let reach_m = m.held_reach_m(&a.mode);
            held_travel = m.manipulator().link_travel_m(&a.robot, &b.robot, reach_m, &mut worker.link_travel);
        }
        worker.reach.fill(0.0);
        let mut fastest = 0.0_f64;
        for ((id, travel), pose) in around.links().iter().zip(&worker.link_travel).zip(&worker.poses) {
            let travel = if drives { travel.min(self.drive_travel(*id, pose, a, b)) } else { *travel };
            if let Some(slot) = worker.reach.get_mut(id.get()) {
                *slot = travel / span;
                fastest = fastest.max(*slot);
            }
        }
        let fastest_link = fastest;
        for (i, ((id, from), to)) in around.objects().iter().zip(&a.objects).zip(&b.objects).enumerate() {
            let Some(slot) = worker.reach.get_mut(id.get()) else { continue };
            if a.mode.held().is_some_and(|held| held.object.index() == i) {
                chain.insert(*id);
                let travel = if drives { held_travel.min(self.drive_travel(*id, from, a, b)) } else { held_travel };
                *slot = travel / span;
                fastest = fastest.max(*slot);
            } else {
                *slot = (to.translation.vector - from.translation.vector).norm() / span;
                fastest = fastest.max(fastest_link + *slot);
            }
        }
        // A held object that happens to end where it began moves in between.
        if let Some(id) = a.mode.held().and_then(|held| around.objects().get(held.object.index()))
            && a.robot != b.robot
        {
            moved.insert(*id);
        }
        // A robot that drives with its arm at rest moves as one body, with what it holds.
        let against = if drives { BodySet::ALL.difference(&moved) } else { BodySet::ALL };
        Leg { end, moved, against, chain, fastest }
    }

    /// Bound on the travel of a body, now at `pose`, that turns about the axis of the base and drives with it.
    fn drive_travel<M: Manipulator>(
        &self,
        body: BodyIndex,
        pose: &Isometry3<f64>,
        a: &TabletopState<M>,
        b: &TabletopState<M>,
    ) -> f64 {
        let Some((centre, radius)) = self.model().ball(body) else { return f64::INFINITY };
        let [x, y, yaw] = a.robot.base;
        let drive = (b.robot.base[0] - x).hypot(b.robot.base[1] - y);
        let centre = pose * centre;
        drive + turn(yaw, b.robot.base[2]).abs() * ((centre.x - x).hypot(centre.y - y) + radius)
    }

    fn advance<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        instance: &Instance<Tabletop<M>>,
        from: &TabletopState<M>,
        worker: &mut Worker,
    ) -> FreePrefix {
        let around = &*self.surroundings;
        let robot = m.manipulator();
        let mut here = from.clone();
        let mut next = from.clone();
        // The entry is judged with everything that this instance may touch: exemptions of the last one are over.
        // Its mode is that of the interior, in which the motion begins at once.
        instance.motion.at_into(m, f64::MIN_POSITIVE, &mut here);
        around.allow(&here, &instance.contacts, &mut worker.allowed);
        around.pose_all(robot, &here, worker);
        if let Err(hit) = around.lower_bound(worker, &BodySet::ALL, &BodySet::ALL, 0.0) {
            return FreePrefix::blocked(0.0, around.blame(&hit));
        }
        // Fixed pairs are settled; from here on only what moves counts.
        let mut t = 0.0;
        let ends = instance.motion.knots().iter().copied().filter(|knot| *knot > 0.0 && *knot < 1.0);
        for end in ends.chain([1.0]) {
            if end <= t {
                continue;
            }
            instance.motion.at_into(m, end, &mut next);
            next.mode.clone_from(&here.mode);
            // Limits and bounds are convex: what holds at both ends of a leg holds between them.
            if let Err(blame) = Self::check_limits(m, &next) {
                return FreePrefix::blocked(t, blame);
            }
            let leg = self.leg(m, &here, &next, (end, end - t), worker);
            if let Err((free, blame)) = self.advance_leg(m, instance, &leg, t, &mut here, &mut next, worker) {
                return FreePrefix::blocked(free, blame);
            }
            t = end;
        }
        // Letting go or closing changes the gripper: the final state is judged in its own mode.
        instance.motion.at_into(m, 1.0, &mut here);
        around.pose_all(robot, &here, worker);
        around.allow(&here, &instance.contacts, &mut worker.allowed);
        match around.lower_bound(worker, &BodySet::ALL, &BodySet::ALL, 0.0) {
            Ok(_) => FreePrefix::FREE,
            // The end itself is blocked: everything before it is free.
            Err(hit) => FreePrefix::blocked(1.0 - f64::EPSILON, around.blame(&hit)),
        }
    }

    /// Advances `here`, which stands at `t` and is free, to the end of the leg.
    #[expect(clippy::too_many_arguments, reason = "the loop's state, kept by the caller from leg to leg")]
    fn advance_leg<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        instance: &Instance<Tabletop<M>>,
        leg: &Leg,
        mut t: f64,
        here: &mut TabletopState<M>,
        next: &mut TabletopState<M>,
        worker: &mut Worker,
    ) -> Result<(), (f64, Blame)> {
        let around = &*self.surroundings;
        let strictness = around.strictness();
        // Farther than this no pair is told apart; so far every pair may come nearer unseen.
        let unseen_m = (1.0 - KEPT_BETWEEN) * strictness.clearance_m;
        let (cap, least) = (strictness.cap_m / leg.fastest, unseen_m / leg.fastest);
        // Nothing touches up to here, and the rules were last found kept there.
        let (mut free, mut kept) = (t, t);
        around.watch(worker, (&leg.moved, &leg.against, &leg.chain), (t, leg.end));
        loop {
            let until = around.free_until(worker, t, cap).map_err(|hit| (free, around.blame(&hit)))?;
            self.check_moved_objects(m, here, &leg.moved).map_err(|blame| (kept, blame))?;
            kept = t;
            if t >= leg.end {
                return Ok(());
            }
            free = until.min(t + self.to_edge(m, here, leg));
            t = if free + least >= leg.end { leg.end } else { free + least };
            instance.motion.at_into(m, t, next);
            // At the end of a motion the mode may change, which is judged apart.
            next.mode.clone_from(&here.mode);
            around.pose(m.manipulator(), next, &leg.moved, worker);
            std::mem::swap(here, next);
        }
    }
}

impl<M: Manipulator> Validity<Tabletop<M>> for SceneValidity {
    fn check(&self, m: &Tabletop<M>, state: &TabletopState<M>, contacts: &Contacts) -> Result<(), Blame> {
        Self::check_rules(m, state)?;
        self.surroundings.check_on_the_way(m.manipulator(), state, contacts)
    }

    fn free_prefix(&self, m: &Tabletop<M>, instance: &Instance<Tabletop<M>>, from: &TabletopState<M>) -> FreePrefix {
        self.surroundings.with_worker(|worker| self.advance(m, instance, from, worker))
    }
}
