//! Robot, movable objects and fixed bodies in one collision model: who may touch whom, and what is too near.
//!
//! The model is part of the domain, so that primitives can ask it before they propose something: the obstacles are known,
//! and a stance in which the robot stands in a kettle is not worth a chain of motions. Whether a whole motion is free is
//! the question of [`validity`](crate::validity).

use std::sync::{Arc, Mutex, OnceLock};

use darrt_core::state::ObjectId;
use darrt_core::validity::{Blame, BlockKind};
use darrt_geom::allowed::{AllowedContacts, ContactReason};
use darrt_geom::body_set::{BodyIndex, BodySet, FIRST_OF_CROWD};
use darrt_geom::collide::{Closer, CollisionModel, Hit, Scratch};
use darrt_geom::error::GeomError;
use darrt_geom::scene::FixedBody;
use darrt_geom::shape::Shape;
use nalgebra::Isometry3;

use crate::base_path::floor_plan::FloorPlan;
use crate::manipulator::{JointVector as _, LinkGroup, Manipulator};
use crate::mode::{Contacts, TouchReason};
use crate::tabletop::{Movable, Support, TabletopState};

mod known;
mod load;
mod margins;
mod question;
mod room;

use known::Known;
pub(crate) use load::Load;
pub(crate) use margins::Strict;
use margins::{Keep, UNSEEN_M};
pub use margins::{NearPair, Strictness};
pub use room::Hand;

/// Bodies of the robot, the objects and the scene, and the rules of touching.
pub struct CollisionScene {
    model: CollisionModel,
    strictness: Strictness,
    /// How much farther apart than their clearance pairs are at the states looked at, metres.
    unseen_m: f64,
    /// Pairs that begin, or end, nearer than their margin.
    exceptions: Vec<Closer>,
    links: Vec<BodyIndex>,
    objects: Vec<BodyIndex>,
    /// By hand.
    fingers: Vec<Vec<BodyIndex>>,
    /// By surface: the fixed bodies under it.
    supports: Vec<Vec<BodyIndex>>,
    base_links: BodySet,
    arm_links: BodySet,
    /// Palms and fingers, and the fingers alone, of all hands.
    hand_links: BodySet,
    finger_links: BodySet,
    /// By hand: palm and fingers.
    hands: Vec<BodySet>,
    all_links: BodySet,
    /// The fixed bodies seen from above.
    floor_plan: Arc<FloorPlan>,
    /// The links of the base in its frame.
    base_from_link: OnceLock<Vec<(BodyIndex, Isometry3<f64>)>>,
    workers: Mutex<Vec<Worker>>,
}

/// Memory of one check at a time; reused, so that a check allocates nothing.
pub(crate) struct Worker {
    scratch: Scratch,
    /// Where the links and then the objects stand.
    pub(crate) poses: Vec<Isometry3<f64>>,
    allowed: AllowedContacts,
    keep: Keep,
    /// By body: metres that it travels per unit of the motion's parameter.
    pub(crate) reach: Vec<f64>,
    /// By link: metres that it travels on one segment of a motion.
    pub(crate) link_travel: Vec<f64>,
    known: Known,
}

impl CollisionScene {
    /// The model of `robot` with the `movables` among the `fixed` bodies.
    ///
    /// # Errors
    /// [`GeomError`] if there are too many bodies or a shape cannot be used.
    pub fn new<M: Manipulator>(
        robot: &M,
        movables: &[Movable],
        supports: &[Support],
        fixed: &[FixedBody],
        strictness: Strictness,
    ) -> Result<Self, GeomError> {
        let mut model = CollisionModel::builder();
        let links: Vec<_> =
            robot.links().iter().map(|link| model.add_moving(&link.body)).collect::<Result<_, GeomError>>()?;
        for (i, a) in links.iter().enumerate() {
            for (j, b) in links.iter().enumerate().skip(i + 1) {
                if !robot.self_pairs().contains(&(i, j)) && !robot.self_pairs().contains(&(j, i)) {
                    model.disable(*a, *b)?;
                }
            }
        }
        let objects = movables.iter().map(|o| model.add_moving(&o.body)).collect::<Result<Vec<_>, GeomError>>()?;
        // What is told apart in sets comes before the crowd.
        let is_told_apart = |body: &FixedBody| {
            let name = &body.body.name;
            supports.iter().any(|support| support.bodies.contains(name)) || !body.body.is_bounded()
        };
        let mut in_order: Vec<_> = fixed.iter().collect();
        if links.len() + objects.len() + fixed.len() > FIRST_OF_CROWD {
            in_order.sort_by_cached_key(|body| !is_told_apart(body));
            let count = links.len() + objects.len() + fixed.iter().filter(|body| is_told_apart(body)).count();
            if count > FIRST_OF_CROWD {
                let name = "links, objects and obstacles that carry a surface, together,".to_owned();
                return Err(GeomError::Count { name, count, minimum: 0, maximum: FIRST_OF_CROWD });
            }
        }
        let mut fixed_ids = Vec::new();
        for body in in_order {
            let id = model.add_fixed(&body.body, &body.world_from_body)?;
            // The base rolls on the floor: its links keep their height.
            if body.body.parts.iter().all(|part| matches!(part.shape, Shape::HalfSpace { .. })) {
                for (link, _) in links.iter().zip(robot.links()).filter(|(_, link)| link.group == LinkGroup::Base) {
                    model.disable(*link, id)?;
                }
            }
            fixed_ids.push((Arc::clone(&body.body.name), id));
        }
        let supports = supports.iter().map(|support| {
            let under = fixed_ids.iter().filter(|(name, _)| support.bodies.contains(name));
            under.map(|(_, id)| *id).collect()
        });
        let in_group = |wanted: &[LinkGroup]| -> BodySet {
            let links = links.iter().zip(robot.links());
            links.filter(|(_, link)| wanted.contains(&link.group)).map(|(id, _)| *id).collect()
        };
        let of_hand = |hand: usize, set: BodySet| -> Vec<BodyIndex> {
            let links =
                links.iter().enumerate().filter(|(link, id)| set.contains(**id) && robot.hand_of_link(*link) == hand);
            links.map(|(_, id)| *id).collect()
        };
        let hands = robot.hands().max(1);
        let [finger_links, hand_links] =
            [&[LinkGroup::Finger][..], &[LinkGroup::Hand, LinkGroup::Finger]].map(in_group);
        Ok(Self {
            supports: supports.collect(),
            base_links: in_group(&[LinkGroup::Base]),
            arm_links: in_group(&[LinkGroup::Arm, LinkGroup::Hand, LinkGroup::Finger]),
            hands: (0..hands).map(|hand| of_hand(hand, hand_links).into_iter().collect()).collect(),
            hand_links,
            all_links: links.iter().copied().collect(),
            fingers: (0..hands).map(|hand| of_hand(hand, finger_links)).collect(),
            finger_links,
            model: model.build(),
            strictness,
            unseen_m: UNSEEN_M,
            exceptions: Vec::new(),
            links,
            objects,
            floor_plan: Arc::new(FloorPlan::new(fixed)),
            base_from_link: OnceLock::new(),
            workers: Mutex::new(Vec::new()),
        })
    }

    /// The same for the objects alone: no pair with a link is tested, as if the robot could pass through everything.
    #[must_use]
    pub fn without_robot(&self) -> Self {
        self.with_model(self.model.without_pairs_of(&self.all_links))
    }

    /// The same once more.
    pub(crate) fn copy(&self) -> Self {
        self.with_model(self.model.clone())
    }

    /// The same with another model of the same bodies.
    fn with_model(&self, model: CollisionModel) -> Self {
        Self {
            model,
            strictness: self.strictness,
            unseen_m: self.unseen_m,
            exceptions: self.exceptions.clone(),
            links: self.links.clone(),
            objects: self.objects.clone(),
            fingers: self.fingers.clone(),
            supports: self.supports.clone(),
            base_links: self.base_links,
            arm_links: self.arm_links,
            hand_links: self.hand_links,
            finger_links: self.finger_links,
            hands: self.hands.clone(),
            all_links: self.all_links,
            floor_plan: Arc::clone(&self.floor_plan),
            base_from_link: OnceLock::new(),
            workers: Mutex::new(Vec::new()),
        }
    }

    /// The collision model, for reports.
    pub fn model(&self) -> &CollisionModel {
        &self.model
    }

    /// How much farther apart than their clearance pairs are at the states looked at, metres: what a motion may give away
    /// between them.
    pub(crate) fn unseen_m(&self) -> f64 {
        self.unseen_m
    }

    /// The fixed bodies seen from above.
    pub(crate) fn floor_plan(&self) -> &FloorPlan {
        &self.floor_plan
    }

    /// How strict the check is.
    pub fn strictness(&self) -> &Strictness {
        &self.strictness
    }

    /// Lends a worker to `work`.
    pub(crate) fn with_worker<T>(&self, work: impl FnOnce(&mut Worker) -> T) -> T {
        let spare = self.workers.lock().ok().and_then(|mut w| w.pop());
        let mut worker = spare.unwrap_or_else(|| self.new_worker());
        let result = work(&mut worker);
        if let Ok(mut workers) = self.workers.lock() {
            workers.push(worker);
        }
        result
    }

    fn new_worker(&self) -> Worker {
        let poses = vec![Isometry3::identity(); self.links.len() + self.objects.len()];
        let mut scratch = self.model.scratch();
        // Questions place only the bodies that they are about, and the others must have some pose.
        self.model.set_poses(&mut scratch, &poses);
        Worker {
            scratch,
            reach: vec![0.0; poses.len()],
            poses,
            allowed: AllowedContacts::none(),
            keep: Keep::default(),
            link_travel: vec![0.0; self.links.len()],
            known: Known::default(),
        }
    }

    /// Puts every body where it is in `state`.
    pub(crate) fn pose_all<M: Manipulator>(&self, robot: &M, state: &TabletopState<M>, worker: &mut Worker) {
        self.find_poses(robot, state, worker);
        self.model.set_poses(&mut worker.scratch, &worker.poses);
    }

    /// Finds out where every body is in `state`.
    fn find_poses<M: Manipulator>(&self, robot: &M, state: &TabletopState<M>, worker: &mut Worker) {
        let (link_poses, object_poses) = worker.poses.split_at_mut(self.links.len());
        robot.link_poses(&state.robot, state.mode.gap_m(), link_poses);
        object_poses.iter_mut().zip(&state.objects).for_each(|(slot, pose)| *slot = *pose);
    }

    /// The bodies that stand elsewhere in `state` than in `before`, or may do so.
    pub(crate) fn moved<M: Manipulator>(&self, before: &TabletopState<M>, state: &TabletopState<M>) -> BodySet {
        let mut moved = if before.robot.base != state.robot.base {
            self.all_links
        } else if before.robot.arm != state.robot.arm {
            self.arm_links
        } else if before.mode.gap_m() != state.mode.gap_m() {
            self.finger_links
        } else {
            BodySet::EMPTY
        };
        for ((id, a), b) in self.objects.iter().zip(&before.objects).zip(&state.objects) {
            if a != b {
                moved.insert(*id);
            }
        }
        moved
    }

    /// Puts the bodies in `moved` where they are in `state`.
    pub(crate) fn pose<M: Manipulator>(
        &self,
        robot: &M,
        state: &TabletopState<M>,
        moved: &BodySet,
        worker: &mut Worker,
    ) {
        let (link_poses, object_poses) = worker.poses.split_at_mut(self.links.len());
        if !moved.intersection(&self.all_links).is_empty() {
            robot.link_poses(&state.robot, state.mode.gap_m(), link_poses);
            for (id, pose) in self.links.iter().zip(link_poses.iter()) {
                if moved.contains(*id) {
                    self.model.set_pose(&mut worker.scratch, *id, pose);
                }
            }
        }
        for ((id, slot), pose) in self.objects.iter().zip(object_poses).zip(&state.objects) {
            if moved.contains(*id) {
                *slot = *pose;
                self.model.set_pose(&mut worker.scratch, *id, pose);
            }
        }
    }

    /// What may touch, and how far all else keeps, in this mode during an instance with these contacts: what is asked from
    /// here on.
    pub(crate) fn set_rules<M: Manipulator>(
        &self,
        state: &TabletopState<M>,
        contacts: &Contacts,
        strict: Strict,
        worker: &mut Worker,
    ) {
        self.allow(state, contacts, &mut worker.allowed);
        self.keep(state, contacts, strict, &mut worker.keep);
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
            self.allow_fingers(state, held.object, ContactReason::Held, out);
        }
        if let Some((object, reason)) = contacts.fingers {
            let reason = match reason {
                TouchReason::Push => ContactReason::PushContact,
                _ => ContactReason::GraspContact,
            };
            self.allow_fingers(state, object, reason, out);
        }
        if let Some((object, surface)) = contacts.support
            && let (Some(object), Some(under)) = (self.objects.get(object.index()), self.supports.get(surface.index()))
        {
            for body in under {
                out.allow(*object, *body, ContactReason::RestsOn);
            }
        }
    }

    /// The fingers of the hand at work may touch an object.
    fn allow_fingers<M: Manipulator>(
        &self,
        state: &TabletopState<M>,
        object: ObjectId,
        reason: ContactReason,
        out: &mut AllowedContacts,
    ) {
        let fingers = self.fingers.get(state.robot.arm.hand_at_work());
        if let Some((object, fingers)) = self.objects.get(object.index()).zip(fingers) {
            for finger in fingers {
                out.allow(*finger, *object, reason);
            }
        }
    }

    /// Palm and fingers of the hand at work.
    fn hand_at_work<M: Manipulator>(&self, state: &TabletopState<M>) -> BodySet {
        self.hands.get(state.robot.arm.hand_at_work()).copied().unwrap_or(BodySet::EMPTY)
    }

    /// The bodies of the objects, by id.
    pub(crate) fn objects(&self) -> &[BodyIndex] {
        &self.objects
    }

    /// The bodies of the links, as a set.
    pub(crate) fn all_links(&self) -> &BodySet {
        &self.all_links
    }

    /// The bodies of the links, in the robot's order.
    pub(crate) fn links(&self) -> &[BodyIndex] {
        &self.links
    }

    /// A hit in words.
    pub(crate) fn blame(&self, hit: &Hit) -> Blame {
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
}

impl std::fmt::Debug for CollisionScene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("CollisionScene").field("strictness", &self.strictness).finish_non_exhaustive()
    }
}
