//! Is there room for a part alone: the base without its arm, the hand without an arm behind it, an object that slides?
//!
//! Much cheaper than to look for a base and an arm first, so it is asked before.

use darrt_core::state::ObjectId;
use darrt_core::validity::Blame;
use darrt_geom::allowed::AllowedContacts;
use darrt_geom::body_set::{BodyIndex, BodySet};
use nalgebra::{Isometry3, Point3};

use super::{CollisionScene, Strict, Worker};
use crate::manipulator::{Configuration, Manipulator, world_from_base};
use crate::mode::Contacts;
use crate::push::slide::Slide;
use crate::tabletop::TabletopState;

/// The bodies of the hand as they hang on the tool.
#[derive(Debug, Clone)]
pub struct Hand {
    /// Which one.
    links: BodySet,
    tool_from_link: Vec<(BodyIndex, Isometry3<f64>)>,
}

impl CollisionScene {
    /// Do base, trunk and whatever else is rigid to the base keep clear of the fixed bodies? Asks nothing of the arm.
    pub fn is_base_clear<M: Manipulator>(&self, robot: &M, q: &Configuration<M::Joints>) -> bool {
        self.with_base_at(robot, q, |worker, against| {
            let is_clear = self.is_clear(worker, &self.base_links, against);
            if is_clear {
                worker.known.base = Some(q.base);
            }
            is_clear
        })
    }

    /// [`CollisionScene::is_base_clear`] with a reason.
    ///
    /// # Errors
    /// The first pair found.
    pub fn check_base<M: Manipulator>(&self, robot: &M, q: &Configuration<M::Joints>) -> Result<(), Blame> {
        let bound =
            self.with_base_at(robot, q, |worker, against| self.lower_bound(worker, &self.base_links, against, 0.0));
        bound.map(drop).map_err(|hit| self.blame(&hit))
    }

    /// Puts the links of the base where they are in `q`, and asks about them and the fixed bodies: what the arm does and where
    /// the objects are does not count.
    fn with_base_at<M: Manipulator, T>(
        &self,
        robot: &M,
        q: &Configuration<M::Joints>,
        ask: impl FnOnce(&mut Worker, &BodySet) -> T,
    ) -> T {
        // OPTIMIZATION: the arm's links need no places here.
        let base_from_link = self.base_from_link.get_or_init(|| {
            let mut poses = vec![Isometry3::identity(); self.links.len()];
            robot.link_poses(&Configuration { base: [0.0; 3], arm: q.arm }, robot.hand().max_gap_m(), &mut poses);
            let of_base = self.links.iter().copied().zip(poses).filter(|(id, _)| self.base_links.contains(*id));
            of_base.collect()
        });
        let world_from_base = world_from_base(&q.base);
        self.with_worker(|worker| {
            worker.allowed = AllowedContacts::none();
            self.keep_alone(Strict::with(0), &mut worker.keep);
            for (id, base_from_link) in base_from_link {
                self.model.set_pose(&mut worker.scratch, *id, &(world_from_base * base_from_link));
            }
            ask(worker, &BodySet::ALL.difference(self.model.moving()))
        })
    }

    /// The hand with the opening of `like`, for [`CollisionScene::check_hand`].
    pub fn hand<M: Manipulator>(&self, robot: &M, like: &TabletopState<M>) -> Hand {
        let mut world_from_link = vec![Isometry3::identity(); self.links.len()];
        robot.link_poses(&like.robot, like.mode.gap_m(), &mut world_from_link);
        let tool_from_world = robot.world_from_tool(&like.robot).inverse();
        let own = self.hand_at_work(like);
        let links = self.links.iter().zip(&world_from_link).filter(|(id, _)| own.contains(**id));
        Hand { links: own, tool_from_link: links.map(|(id, pose)| (*id, tool_from_world * pose)).collect() }
    }

    /// Could the hand be at `world_from_tool` with the objects of `like`, if there were no arm behind it? The hand and the
    /// object that `contacts` or the mode names are asked about. Much cheaper than to look for an arm and a base first.
    ///
    /// # Errors
    /// The first pair found.
    pub fn check_hand<M: Manipulator>(
        &self,
        hand: &Hand,
        like: &TabletopState<M>,
        world_from_tool: &Isometry3<f64>,
        contacts: &Contacts,
    ) -> Result<(), Blame> {
        let hit = self.with_worker(|worker| {
            self.set_rules(like, contacts, Strict::with(0), worker);
            let (moved, others) = self.pose_hand(hand, like, world_from_tool, contacts, worker);
            self.lower_bound(worker, &moved, &others, 0.0)
        });
        hit.map(|_| ()).map_err(|hit| self.blame(&hit))
    }

    /// [`CollisionScene::check_hand`] with [care](CollisionScene::most_care) and without reasons.
    pub fn is_hand_clear<M: Manipulator>(
        &self,
        hand: &Hand,
        like: &TabletopState<M>,
        world_from_tool: &Isometry3<f64>,
        contacts: &Contacts,
        care: usize,
    ) -> bool {
        self.with_worker(|worker| {
            self.set_rules(like, contacts, Strict::with(care), worker);
            let (moved, others) = self.pose_hand(hand, like, world_from_tool, contacts, worker);
            self.is_clear(worker, &moved, &others)
        })
    }

    /// Puts objects and hand where they are asked about; says what counts as moved, and against what.
    fn pose_hand<M: Manipulator>(
        &self,
        hand: &Hand,
        like: &TabletopState<M>,
        world_from_tool: &Isometry3<f64>,
        contacts: &Contacts,
        worker: &mut Worker,
    ) -> (BodySet, BodySet) {
        self.pose_objects(like, worker);
        for (id, tool_from_link) in &hand.tool_from_link {
            self.model.set_pose(&mut worker.scratch, *id, &(world_from_tool * tool_from_link));
        }
        let mut moved = hand.links;
        let with = contacts.support.map(|(object, _)| object).or(like.mode.held().map(|held| held.object));
        if let Some(object) = with.and_then(|object| self.objects.get(object.index())) {
            moved.insert(*object);
        }
        (moved, BodySet::ALL.difference(&self.all_links.difference(&hand.links)))
    }

    /// How far a resting object could slide with this [care](CollisionScene::most_care) if the robot were not there: metres
    /// along the way of its centre, at most all of it, and what ends it.
    pub fn free_slide<M: Manipulator>(
        &self,
        from: &TabletopState<M>,
        object: ObjectId,
        slide: &Slide,
        care: usize,
    ) -> (f64, Option<Blame>) {
        let length_m = slide.length_m();
        let Some(id) = self.objects.get(object.index()).copied() else { return (0.0, None) };
        let (centre, radius) = self.model.ball(id).map_or((Point3::origin(), 0.0), |ball| ball);
        // How far the farthest point goes for each metre of the centre.
        let widest = 1.0 + slide.curvature().abs() * (centre.coords.norm() + radius);
        let hit = self.with_worker(|worker| {
            self.set_rules(from, &Contacts::default(), Strict::with(care), worker);
            self.pose_objects(from, worker);
            let mut moved = BodySet::EMPTY;
            moved.insert(id);
            let others = BodySet::ALL.difference(&self.all_links);
            let mut s = 0.0;
            loop {
                let pose = slide.at(if length_m > 0.0 { s / length_m } else { 0.0 });
                self.model.set_pose(&mut worker.scratch, id, &pose);
                match self.lower_bound(worker, &moved, &others, self.strictness.cap_m) {
                    // Up to here it came by no more than was free, so it was clear that much before.
                    Err(hit) => return Err(((s - worker.keep.most_m).max(0.0), hit)),
                    Ok(_) if s >= length_m => return Ok(()),
                    Ok(free) => s = (s + free.max(self.unseen_m) / widest).min(length_m),
                }
            }
        });
        match hit {
            Ok(()) => (length_m, None),
            Err((s, hit)) => (s, Some(self.blame(&hit))),
        }
    }

    /// Puts the objects where they are in `state`.
    pub(super) fn pose_objects<M: Manipulator>(&self, state: &TabletopState<M>, worker: &mut Worker) {
        for (id, pose) in self.objects.iter().zip(&state.objects) {
            self.model.set_pose(&mut worker.scratch, *id, pose);
        }
    }
}
