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
use darrt_core::state::ObjectId;
use darrt_core::validity::{Blame, BlockKind, FreePrefix, Validity};
use darrt_geom::body_set::BodySet;
use darrt_geom::collide::CollisionModel;
use nalgebra::{Isometry3, Point2};

use crate::collision_scene::{CollisionScene, Strict, Worker};
use crate::manipulator::Manipulator;
use crate::mode::Contacts;
use crate::segment::Segment;
use crate::tabletop::{Tabletop, TabletopState};
use crate::tilt::UNSEEN_RAD;

/// The scene as seen by a table-top domain.
#[derive(Debug, Clone)]
pub struct SceneValidity {
    collision_scene: Arc<CollisionScene>,
    /// The robot can pass through everything and has no limits.
    ignores_robot: bool,
}

impl SceneValidity {
    /// The check for domain `m`.
    pub fn new<M: Manipulator>(m: &Tabletop<M>) -> Self {
        Self { collision_scene: Arc::clone(m.collision_scene()), ignores_robot: false }
    }

    /// The collision model, for reports.
    pub fn model(&self) -> &CollisionModel {
        self.collision_scene.model()
    }

    /// Joint limits and the bounds of the base.
    fn check_limits<M: Manipulator>(&self, m: &Tabletop<M>, state: &TabletopState<M>) -> Result<(), Blame> {
        if self.ignores_robot {
            return Ok(());
        }
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
    fn check_rules<M: Manipulator>(&self, m: &Tabletop<M>, state: &TabletopState<M>) -> Result<(), Blame> {
        self.check_limits(m, state)?;
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
            None if state.mode.held().is_some_and(|held| held.object == id) => match m.tilt_left_rad(state) {
                Some(left) if left < 0.0 => {
                    Err(Blame { kind: BlockKind::Limits, first: name, second: "how far it may lean".into(), place })
                }
                _ => Ok(()),
            },
            Some(Some(surface)) if surface.contains(&Point2::new(place[0], place[1])) => Ok(()),
            Some(Some(surface)) => {
                Err(Blame { kind: BlockKind::OffSupport, first: name, second: surface.name().into(), place })
            }
            _ => Err(Blame { kind: BlockKind::OffSupport, first: name, second: "nothing".into(), place }),
        }
    }

    /// How far the parameter may grow before an object that slides could leave its surface: its centre is as far from
    /// the edge as the surface says. For surfaces with notches; the end of a slide is looked at anyhow.
    fn to_edge<M: Manipulator>(&self, m: &Tabletop<M>, state: &TabletopState<M>, segment: &Segment) -> f64 {
        let mut least = f64::INFINITY;
        for (i, (body, pose)) in self.collision_scene.objects().iter().zip(&state.objects).enumerate() {
            if segment.moved.contains(*body)
                && let Some(surface) = state.mode.support_of(ObjectId::new(i)).and_then(|s| m.surface(s))
            {
                let depth_m = surface.depth(&Point2::new(pose.translation.x, pose.translation.y));
                least = least.min(depth_m.max(0.0) / segment.fastest);
            }
        }
        least
    }

    /// How far the parameter may grow before a held object could lean too far, between the states looked at: it tilts no
    /// faster than the joints turn.
    fn to_tilt<M: Manipulator>(m: &Tabletop<M>, state: &TabletopState<M>, tilting: f64) -> f64 {
        match m.tilt_left_rad(state) {
            Some(left) if tilting > 0.0 => (left.max(0.0) + UNSEEN_RAD) / tilting,
            _ => f64::INFINITY,
        }
    }

    /// Objects that moved still keep the rules.
    fn check_moved_objects<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        state: &TabletopState<M>,
        moved: &BodySet,
    ) -> Result<(), Blame> {
        for (i, (body, pose)) in self.collision_scene.objects().iter().zip(&state.objects).enumerate() {
            if moved.contains(*body) {
                Self::check_object(m, state, ObjectId::new(i), pose)?;
            }
        }
        Ok(())
    }

    fn advance<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        instance: &Instance<Tabletop<M>>,
        from: &TabletopState<M>,
        care: usize,
        worker: &mut Worker,
    ) -> FreePrefix {
        let around = &*self.collision_scene;
        let robot = m.manipulator();
        let mut here = from.clone();
        let mut next = from.clone();
        // The entry is judged with everything that this instance may touch: exemptions of the last one are over.
        // Its mode is that of the interior, in which the motion begins at once.
        instance.motion.at_into(m, f64::MIN_POSITIVE, &mut here);
        around.set_rules(&here, &instance.contacts, Strict::with(care), worker);
        around.pose_all(robot, &here, worker);
        if let Some(hit) = around.first_hit(worker) {
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
            // Limits and bounds are convex: what holds at both ends of a segment holds between them.
            if let Err(blame) = self.check_limits(m, &next) {
                return FreePrefix::blocked(t, blame);
            }
            let segment = Segment::new(m, &here, &next, (t, end), worker);
            if let Err((free, blame)) = self.advance_segment(m, instance, &segment, t, &mut here, &mut next, worker) {
                return FreePrefix::blocked(free, blame);
            }
            t = end;
        }
        // Letting go or closing changes the gripper: the final state is judged in its own mode.
        instance.motion.at_into(m, 1.0, &mut here);
        around.pose_all(robot, &here, worker);
        around.set_rules(&here, &instance.contacts, Strict::with(care), worker);
        match around.first_hit(worker) {
            None => FreePrefix::FREE,
            // The end itself is blocked: everything before it is free.
            Some(hit) => FreePrefix::blocked(1.0 - f64::EPSILON, around.blame(&hit)),
        }
    }

    /// Advances `here`, which stands at `t` and is free, to the end of the segment.
    #[expect(clippy::too_many_arguments, reason = "the loop's state, kept by the caller from segment to segment")]
    fn advance_segment<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        instance: &Instance<Tabletop<M>>,
        segment: &Segment,
        mut t: f64,
        here: &mut TabletopState<M>,
        next: &mut TabletopState<M>,
        worker: &mut Worker,
    ) -> Result<(), (f64, Blame)> {
        let around = &*self.collision_scene;
        // Farther than this no pair is told apart; so far every pair may come nearer unseen.
        let (cap, least) = (around.strictness().cap_m / segment.fastest, around.unseen_m() / segment.fastest);
        // Nothing touches up to here, and the rules were last found kept there.
        let (mut free, mut kept) = (t, t);
        let tilting = m.tilt_travel_rad(&here.robot, &next.robot) / (segment.end - segment.begin);
        segment.watch(around, worker);
        loop {
            let until = around.free_until(worker, t, cap).map_err(|hit| (free, around.blame(&hit)))?;
            self.check_moved_objects(m, here, &segment.moved).map_err(|blame| (kept, blame))?;
            kept = t;
            if t >= segment.end {
                return Ok(());
            }
            free = until.min(t + self.to_edge(m, here, segment)).min(t + Self::to_tilt(m, here, tilting));
            t = if free + least >= segment.end { segment.end } else { free + least };
            instance.motion.at_into(m, t, next);
            // At the end of a motion the mode may change, which is judged apart.
            next.mode.clone_from(&here.mode);
            around.pose(m.manipulator(), next, &segment.moved, worker);
            std::mem::swap(here, next);
        }
    }
}

impl<M: Manipulator> Validity<Tabletop<M>> for SceneValidity {
    fn check(&self, m: &Tabletop<M>, state: &TabletopState<M>, contacts: &Contacts) -> Result<(), Blame> {
        self.check_with(0, m, state, contacts)
    }

    fn without_robot(&self) -> Option<Arc<dyn Validity<Tabletop<M>>>> {
        Some(Arc::new(Self { collision_scene: Arc::new(self.collision_scene.without_robot()), ignores_robot: true }))
    }

    fn free_prefix(&self, m: &Tabletop<M>, instance: &Instance<Tabletop<M>>, from: &TabletopState<M>) -> FreePrefix {
        self.free_prefix_with(0, m, instance, from)
    }

    /// 2: all of the wanted margins, 1: half of them.
    fn most_care(&self) -> usize {
        self.collision_scene.most_care()
    }

    fn check_with(
        &self,
        care: usize,
        m: &Tabletop<M>,
        state: &TabletopState<M>,
        contacts: &Contacts,
    ) -> Result<(), Blame> {
        self.check_rules(m, state)?;
        self.collision_scene.check_at(m.manipulator(), state, contacts, Strict { care, is_between: true })
    }

    fn free_prefix_with(
        &self,
        care: usize,
        m: &Tabletop<M>,
        instance: &Instance<Tabletop<M>>,
        from: &TabletopState<M>,
    ) -> FreePrefix {
        self.collision_scene.with_worker(|worker| self.advance(m, instance, from, care, worker))
    }
}
