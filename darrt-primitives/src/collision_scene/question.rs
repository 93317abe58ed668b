//! Is anything too near to anything else? Questions about one state, and about the segments of a motion.

use darrt_core::validity::Blame;
use darrt_geom::body_set::BodySet;
use darrt_geom::collide::{Hit, Query, Travel};

use super::{CollisionScene, Strict, Worker};
use crate::manipulator::Manipulator;
use crate::mode::Contacts;
use crate::tabletop::TabletopState;

impl CollisionScene {
    /// Is nothing too near to anything else in `state`, `contacts` excepted?
    ///
    /// # Errors
    /// The first pair found.
    pub fn check<M: Manipulator>(&self, robot: &M, state: &TabletopState<M>, contacts: &Contacts) -> Result<(), Blame> {
        self.check_at(robot, state, contacts, Strict::with(0))
    }

    /// [`CollisionScene::check`] with [care](CollisionScene::most_care), and without reasons, which takes less time where it is
    /// asked often.
    pub fn is_state_clear<M: Manipulator>(
        &self,
        robot: &M,
        state: &TabletopState<M>,
        contacts: &Contacts,
        care: usize,
    ) -> bool {
        self.with_worker(|worker| {
            self.set_rules(state, contacts, Strict::with(care), worker);
            self.find_poses(robot, state, worker);
            self.is_all_clear(worker)
        })
    }

    /// [`CollisionScene::is_state_clear`] without care where [`CollisionScene::is_base_clear`] is known.
    pub fn is_rest_clear<M: Manipulator>(&self, robot: &M, state: &TabletopState<M>, contacts: &Contacts) -> bool {
        self.with_worker(|worker| {
            self.set_rules(state, contacts, Strict::with(0), worker);
            self.pose_all(robot, state, worker);
            let rest = BodySet::ALL.difference(&self.base_links);
            let is_clear = self.is_clear(worker, &rest, &BodySet::ALL);
            let Worker { known, poses, allowed, keep, .. } = worker;
            if is_clear && known.base == Some(state.robot.base) {
                known.note(poses, allowed, &keep.terms);
            }
            is_clear
        })
    }

    /// Is nothing too near to anything else with the bodies at `worker.poses`?
    fn is_all_clear(&self, worker: &mut Worker) -> bool {
        if worker.known.is_clear(&worker.poses, &worker.allowed, &worker.keep.terms) {
            return true;
        }
        self.model.set_poses(&mut worker.scratch, &worker.poses);
        let is_clear = self.is_clear(worker, &BodySet::ALL, &BodySet::ALL);
        if is_clear {
            worker.known.note(&worker.poses, &worker.allowed, &worker.keep.terms);
        }
        is_clear
    }

    /// [`CollisionScene::check`] with this strictness.
    ///
    /// # Errors
    /// The first pair found.
    pub(crate) fn check_at<M: Manipulator>(
        &self,
        robot: &M,
        state: &TabletopState<M>,
        contacts: &Contacts,
        strict: Strict,
    ) -> Result<(), Blame> {
        let hit = self.with_worker(|worker| {
            self.set_rules(state, contacts, strict, worker);
            self.find_poses(robot, state, worker);
            self.first_hit(worker)
        });
        hit.map_or(Ok(()), |hit| Err(self.blame(&hit)))
    }

    /// The first pair found that is too near, of all bodies; they stand at `worker.poses`.
    pub(crate) fn first_hit(&self, worker: &mut Worker) -> Option<Hit> {
        // OPTIMIZATION: mostly there is none, and to find that out takes less time without a reason.
        if self.is_all_clear(worker) {
            return None;
        }
        self.lower_bound(worker, &BodySet::ALL, &BodySet::ALL, 0.0).err()
    }

    /// Smallest distance in metres over the pairs of one body in `moved` and one in `against`, up to `cap_m`.
    pub(crate) fn lower_bound(
        &self,
        worker: &mut Worker,
        moved: &BodySet,
        against: &BodySet,
        cap_m: f64,
    ) -> Result<f64, Hit> {
        let Worker { scratch, allowed, keep, .. } = worker;
        let (clearance, closer) = (keep.most_m, keep.closer.as_slice());
        self.model.lower_bound(scratch, &Query { moved, against, allowed, clearance, closer, cap: cap_m })
    }

    /// Are the pairs of one body in `moved` and one in `against` clear? [`CollisionScene::lower_bound`] without reasons.
    pub(crate) fn is_clear(&self, worker: &mut Worker, moved: &BodySet, against: &BodySet) -> bool {
        let Worker { scratch, allowed, keep, .. } = worker;
        let (clearance, closer) = (keep.most_m, keep.closer.as_slice());
        self.model.is_clear(scratch, &Query { moved, against, allowed, clearance, closer, cap: 0.0 })
    }

    /// Begins to watch a segment of a motion, from one parameter to another, on which every body travels as `worker.reach`
    /// says. The bodies in `chain` hang together.
    pub(crate) fn watch(
        &self,
        worker: &mut Worker,
        (moved, against, chain): (&BodySet, &BodySet, &BodySet),
        (from, to): (f64, f64),
    ) {
        let Worker { scratch, allowed, keep, reach, .. } = worker;
        let (clearance, closer) = (keep.most_m, keep.closer.as_slice());
        let query = Query { moved, against, allowed, clearance, closer, cap: 0.0 };
        self.model.watch(scratch, &query, &Travel { reach, chain, from, to });
    }

    /// The parameter up to which nothing that is watched can come nearer than the clearance, at most `now + cap`.
    pub(crate) fn free_until(&self, worker: &mut Worker, now: f64, cap: f64) -> Result<f64, Hit> {
        self.model.free_until(&mut worker.scratch, now, cap)
    }
}
