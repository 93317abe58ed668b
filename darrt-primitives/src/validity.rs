//! What is in the way: robot, held and pushed objects against each other and against the scene, over whole motions.
//!
//! A motion is judged by conservative advancement: from a state whose smallest distance is `d`, no point can touch
//! anything before it has travelled `d`, so the next state to look at is that far on. Free therefore means free between
//! the states looked at as well.
//!
//! # Source
//! Mirtich, Impulse-based dynamic simulation of rigid body systems, 1996 (conservative advancement).

use std::sync::{Arc, Mutex};

use darrt_core::domain::Domain;
use darrt_core::motion::Instance;
use darrt_core::space::ComponentSpace;
use darrt_core::state::{ComponentId, ObjectId};
use darrt_core::validity::{Blame, BlockKind, FreePrefix, Validity};
use darrt_geom::allowed::{AllowedContacts, ContactReason};
use darrt_geom::body_set::{BodyIndex, BodySet};
use darrt_geom::collide::{CollisionModel, Hit, Query, Scratch};
use darrt_geom::error::GeomError;
use darrt_geom::scene::FixedBody;
use darrt_geom::shape::Shape;
use nalgebra::{Isometry3, Point2};

use crate::manipulator::{LinkGroup, Manipulator};
use crate::mode::{Contacts, TouchReason};
use crate::tabletop::{Tabletop, TabletopState};

/// How strict the check is; metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValidityOptions {
    /// Bodies nearer than this collide. Also the shortest distance that a motion advances at once, so it must be
    /// positive: it is what the check gives away to be certain between states.
    pub clearance_m: f64,
    /// Distances beyond this are not told apart: the farthest that a motion advances at once.
    pub cap_m: f64,
}

impl Default for ValidityOptions {
    fn default() -> Self {
        Self { clearance_m: 0.002, cap_m: 0.2 }
    }
}

/// The scene as seen by a table-top domain.
pub struct SceneValidity {
    model: CollisionModel,
    options: ValidityOptions,
    links: Vec<BodyIndex>,
    objects: Vec<BodyIndex>,
    fingers: Vec<BodyIndex>,
    /// By surface: the fixed bodies under it.
    supports: Vec<Vec<BodyIndex>>,
    arm_links: BodySet,
    finger_links: BodySet,
    all_links: BodySet,
    workers: Mutex<Vec<Worker>>,
}

/// Memory of one check at a time; reused, so that a check allocates nothing.
struct Worker {
    scratch: Scratch,
    poses: Vec<Isometry3<f64>>,
    allowed: AllowedContacts,
}

impl SceneValidity {
    /// The check for domain `m` among the `fixed` bodies.
    ///
    /// # Errors
    /// [`GeomError`] if there are too many bodies or a shape cannot be used.
    pub fn new<M: Manipulator>(
        m: &Tabletop<M>,
        fixed: &[FixedBody],
        options: ValidityOptions,
    ) -> Result<Self, GeomError> {
        let mut model = CollisionModel::builder();
        let robot = m.manipulator();
        let mut links = Vec::new();
        for link in robot.links() {
            links.push(model.add_moving(&link.body)?);
        }
        for (i, a) in links.iter().enumerate() {
            for (j, b) in links.iter().enumerate().skip(i + 1) {
                if !robot.self_pairs().contains(&(i, j)) && !robot.self_pairs().contains(&(j, i)) {
                    model.disable(*a, *b)?;
                }
            }
        }
        let mut objects = Vec::new();
        for movable in m.movables() {
            objects.push(model.add_moving(&movable.body)?);
        }
        let mut fixed_ids = Vec::new();
        for body in fixed {
            let id = model.add_fixed(&body.body, &body.world_from_body)?;
            // The base rolls on the floor: its links keep their height.
            if body.body.parts.iter().all(|part| matches!(part.shape, Shape::HalfSpace { .. })) {
                for (link, _) in links.iter().zip(robot.links()).filter(|(_, link)| link.group == LinkGroup::Base) {
                    model.disable(*link, id)?;
                }
            }
            fixed_ids.push((Arc::clone(&body.body.name), id));
        }
        let supports = m.supports().iter().map(|support| {
            let under = fixed_ids.iter().filter(|(name, _)| support.bodies.contains(name));
            under.map(|(_, id)| *id).collect()
        });
        let in_group = |wanted: &[LinkGroup]| {
            let mut set = BodySet::EMPTY;
            let links = links.iter().zip(robot.links());
            links.filter(|(_, link)| wanted.contains(&link.group)).for_each(|(id, _)| set.insert(*id));
            set
        };
        let fingers =
            links.iter().zip(robot.links()).filter(|(_, l)| l.group == LinkGroup::Finger).map(|(id, _)| *id).collect();
        Ok(Self {
            supports: supports.collect(),
            arm_links: in_group(&[LinkGroup::Arm, LinkGroup::Finger]),
            finger_links: in_group(&[LinkGroup::Finger]),
            all_links: in_group(&[LinkGroup::Base, LinkGroup::Arm, LinkGroup::Finger]),
            model: model.build(),
            options,
            links,
            objects,
            fingers,
            workers: Mutex::new(Vec::new()),
        })
    }

    /// The collision model, for reports.
    pub fn model(&self) -> &CollisionModel {
        &self.model
    }

    fn worker(&self) -> Worker {
        let spare = self.workers.lock().ok().and_then(|mut w| w.pop());
        spare.unwrap_or_else(|| Worker {
            scratch: self.model.scratch(),
            poses: vec![Isometry3::identity(); self.links.len() + self.objects.len()],
            allowed: AllowedContacts::none(),
        })
    }

    fn give_back(&self, worker: Worker) {
        if let Ok(mut workers) = self.workers.lock() {
            workers.push(worker);
        }
    }

    /// Puts every body where it is in `state`.
    fn pose_all<M: Manipulator>(&self, m: &Tabletop<M>, state: &TabletopState<M>, worker: &mut Worker) {
        let (link_poses, object_poses) = worker.poses.split_at_mut(self.links.len());
        m.manipulator().link_poses(&state.robot, state.mode.gap_m(), link_poses);
        object_poses.iter_mut().zip(&state.objects).for_each(|(slot, pose)| *slot = *pose);
        self.model.set_poses(&mut worker.scratch, &worker.poses);
    }

    /// Puts every body where it is in `state`, knowing that the last one was `before`. Returns what may have moved.
    fn pose_moved<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        before: &TabletopState<M>,
        state: &TabletopState<M>,
        worker: &mut Worker,
    ) -> BodySet {
        let (link_poses, object_poses) = worker.poses.split_at_mut(self.links.len());
        let mut moved = if before.robot.base != state.robot.base {
            self.all_links
        } else if before.robot.arm != state.robot.arm {
            self.arm_links
        } else if before.mode.gap_m() != state.mode.gap_m() {
            self.finger_links
        } else {
            BodySet::EMPTY
        };
        if !moved.is_empty() {
            m.manipulator().link_poses(&state.robot, state.mode.gap_m(), link_poses);
            for (id, pose) in self.links.iter().zip(link_poses.iter()) {
                if moved.contains(*id) {
                    self.model.set_pose(&mut worker.scratch, *id, pose);
                }
            }
        }
        for (((id, slot), a), b) in self.objects.iter().zip(object_poses).zip(&before.objects).zip(&state.objects) {
            if a != b {
                *slot = *b;
                self.model.set_pose(&mut worker.scratch, *id, b);
                moved.insert(*id);
            }
        }
        moved
    }

    /// What may touch in this mode during an instance with these contacts.
    fn allow<M: Manipulator>(&self, state: &TabletopState<M>, contacts: &Contacts, out: &mut AllowedContacts) {
        *out = AllowedContacts::none();
        for (i, object) in self.objects.iter().enumerate() {
            if let Some(under) = state.mode.support_of(ObjectId::new(i)).and_then(|s| self.supports.get(s.index())) {
                for body in under {
                    out.allow(*object, *body, ContactReason::RestsOn);
                }
            }
        }
        if let Some(held) = state.mode.held() {
            self.allow_fingers(held.object, ContactReason::Held, out);
        }
        if let Some((object, reason)) = contacts.fingers {
            let reason = match reason {
                TouchReason::Push => ContactReason::PushContact,
                _ => ContactReason::GraspContact,
            };
            self.allow_fingers(object, reason, out);
        }
        if let Some((object, surface)) = contacts.support
            && let (Some(object), Some(under)) = (self.objects.get(object.index()), self.supports.get(surface.index()))
        {
            for body in under {
                out.allow(*object, *body, ContactReason::RestsOn);
            }
        }
    }

    fn allow_fingers(&self, object: ObjectId, reason: ContactReason, out: &mut AllowedContacts) {
        if let Some(object) = self.objects.get(object.index()) {
            self.fingers.iter().for_each(|finger| out.allow(*finger, *object, reason));
        }
    }

    /// Smallest distance over the pairs of one body in `moved` and one in `against`, up to the cap.
    fn clearance(&self, worker: &mut Worker, moved: &BodySet, against: &BodySet) -> Result<f64, Hit> {
        let Worker { scratch, allowed, .. } = worker;
        let ValidityOptions { clearance_m: clearance, cap_m: cap } = self.options;
        self.model.lower_bound(scratch, &Query { moved, against, allowed, clearance, cap })
    }

    fn blame(&self, hit: &Hit) -> Blame {
        let is_object = |id: &BodyIndex| self.objects.contains(id);
        let is_link = |id: &BodyIndex| self.all_links.contains(*id);
        let (a, b) = (&hit.first, &hit.second);
        let kind = match (is_link(a) || is_link(b), is_object(a) || is_object(b)) {
            (true, true) => BlockKind::RobotObject,
            (true, false) if is_link(a) && is_link(b) => BlockKind::RobotItself,
            (true, false) => BlockKind::RobotFixed,
            (false, true) if is_object(a) && is_object(b) => BlockKind::ObjectObject,
            (false, _) => BlockKind::ObjectFixed,
        };
        let place = [hit.place.x, hit.place.y, hit.place.z];
        let name = |id: &BodyIndex| self.model.name(*id).map_or_else(|| "unknown body".into(), Arc::clone);
        Blame { kind, first: name(a), second: name(b), place }
    }

    /// Limits and supports: everything that needs no geometry of bodies.
    fn check_rules<M: Manipulator>(m: &Tabletop<M>, state: &TabletopState<M>) -> Result<(), Blame> {
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

    /// Objects that moved still keep the rules.
    fn check_moved_objects<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        state: &TabletopState<M>,
        moved: &BodySet,
    ) -> Result<(), Blame> {
        for (i, (body, pose)) in self.objects.iter().zip(&state.objects).enumerate() {
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
        worker: &mut Worker,
    ) -> FreePrefix {
        let length_m = instance.motion.length();
        let mut here = from.clone();
        let mut next = from.clone();
        // The entry is judged with everything that this instance may touch: exemptions of the last one are over.
        // Its mode is that of the interior, in which the motion begins at once.
        instance.motion.at_into(m, f64::MIN_POSITIVE, &mut here);
        self.allow(&here, &instance.contacts, &mut worker.allowed);
        self.pose_all(m, &here, worker);
        if let Err(hit) = self.clearance(worker, &BodySet::ALL, &BodySet::ALL) {
            return FreePrefix::blocked(0.0, self.blame(&hit));
        }
        // Fixed pairs are settled; from here on only what moves counts. The first step is as short as can be because
        // the clearance of what will move is not yet known on its own.
        let mut t = 0.0;
        let mut ahead_m = self.options.clearance_m;
        // A pushed object and the link beside it may both move, towards each other.
        let slides = |id: &ObjectId| instance.moves.contains(ComponentId::Object(*id)) && here.mode.held().is_none();
        let closing = if instance.object.as_ref().is_some_and(slides) { 2.0 } else { 1.0 };
        while t < 1.0 {
            let step = if length_m > 0.0 { ahead_m.max(self.options.clearance_m) / (closing * length_m) } else { 1.0 };
            let t_next = if t + step >= 1.0 { 1.0 } else { t + step };
            instance.motion.at_into(m, t_next, &mut next);
            let moved = self.pose_moved(m, &here, &next, worker);
            // A robot that drives with its arm at rest moves as one body, with what it holds.
            let drives = here.robot.arm == next.robot.arm && here.mode.gap_m() == next.mode.gap_m();
            let against = if drives { BodySet::ALL.difference(&moved) } else { BodySet::ALL };
            let blame = match self.clearance(worker, &moved, &against) {
                Ok(distance) => {
                    ahead_m = distance;
                    self.check_moved_objects(m, &next, &moved).err()
                }
                Err(hit) => Some(self.blame(&hit)),
            };
            if let Some(blame) = blame {
                return FreePrefix::blocked(t, blame);
            }
            std::mem::swap(&mut here, &mut next);
            t = t_next;
        }
        // Letting go or closing changes the gripper: the final state is judged in its own mode.
        self.pose_all(m, &here, worker);
        self.allow(&here, &instance.contacts, &mut worker.allowed);
        match self.clearance(worker, &BodySet::ALL, &BodySet::ALL) {
            Ok(_) => FreePrefix::FREE,
            // The end itself is blocked: everything before it is free.
            Err(hit) => FreePrefix::blocked(1.0 - f64::EPSILON, self.blame(&hit)),
        }
    }
}

impl<M: Manipulator> Validity<Tabletop<M>> for SceneValidity {
    fn check(&self, m: &Tabletop<M>, state: &TabletopState<M>, contacts: &Contacts) -> Result<(), Blame> {
        Self::check_rules(m, state)?;
        let mut worker = self.worker();
        self.allow(state, contacts, &mut worker.allowed);
        self.pose_all(m, state, &mut worker);
        let result = self.clearance(&mut worker, &BodySet::ALL, &BodySet::ALL).map(|_| ());
        self.give_back(worker);
        result.map_err(|hit| self.blame(&hit))
    }

    fn free_prefix(&self, m: &Tabletop<M>, instance: &Instance<Tabletop<M>>, from: &TabletopState<M>) -> FreePrefix {
        let mut worker = self.worker();
        let free = self.advance(m, instance, from, &mut worker);
        self.give_back(worker);
        free
    }
}

impl std::fmt::Debug for SceneValidity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SceneValidity").field("options", &self.options).finish_non_exhaustive()
    }
}
