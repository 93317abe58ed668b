//! Is anything too near to anything else? Questions about one state, and about the legs of a motion.

use darrt_core::validity::Blame;
use darrt_geom::body_set::BodySet;
use darrt_geom::collide::{Hit, Query, Travel};

use super::{Surroundings, Worker};
use crate::manipulator::Manipulator;
use crate::mode::Contacts;
use crate::tabletop::TabletopState;

impl Surroundings {
    /// Is nothing too near to anything else in `state`, `contacts` excepted?
    ///
    /// # Errors
    /// The first pair found.
    pub fn check<M: Manipulator>(&self, robot: &M, state: &TabletopState<M>, contacts: &Contacts) -> Result<(), Blame> {
        self.check_at(robot, state, contacts, self.strictness.clearance_m)
    }

    /// [`Surroundings::check`] without reasons, which takes less time where it is asked often.
    pub fn is_state_clear<M: Manipulator>(&self, robot: &M, state: &TabletopState<M>, contacts: &Contacts) -> bool {
        self.with_worker(|worker| {
            self.allow(state, contacts, &mut worker.allowed);
            self.find_poses(robot, state, worker);
            self.is_all_clear(worker, self.strictness.clearance_m)
        })
    }

    /// [`Surroundings::is_state_clear`] where [`Surroundings::is_base_clear`] is known.
    pub fn is_rest_clear<M: Manipulator>(&self, robot: &M, state: &TabletopState<M>, contacts: &Contacts) -> bool {
        self.with_worker(|worker| {
            self.allow(state, contacts, &mut worker.allowed);
            self.pose_all(robot, state, worker);
            let rest = BodySet::ALL.difference(&self.base_links);
            let is_clear = self.is_clear(worker, &rest, &BodySet::ALL);
            let Worker { known, poses, allowed, .. } = worker;
            if is_clear && known.base == Some(state.robot.base) {
                known.note(poses, allowed, self.strictness.clearance_m);
            }
            is_clear
        })
    }

    /// Is nothing too near to anything else with the bodies at `worker.poses`?
    fn is_all_clear(&self, worker: &mut Worker, clearance_m: f64) -> bool {
        if worker.known.is_clear(&worker.poses, &worker.allowed, clearance_m) {
            return true;
        }
        self.model.set_poses(&mut worker.scratch, &worker.poses);
        let is_clear = self.is_clear_at(worker, &BodySet::ALL, &BodySet::ALL, clearance_m);
        if is_clear {
            worker.known.note(&worker.poses, &worker.allowed, clearance_m);
        }
        is_clear
    }

    /// [`Surroundings::check`] with the clearance that a motion keeps between the states looked at.
    ///
    /// # Errors
    /// The first pair found.
    pub(crate) fn check_on_the_way<M: Manipulator>(
        &self,
        robot: &M,
        state: &TabletopState<M>,
        contacts: &Contacts,
    ) -> Result<(), Blame> {
        self.check_at(robot, state, contacts, super::KEPT_BETWEEN * self.strictness.clearance_m)
    }

    fn check_at<M: Manipulator>(
        &self,
        robot: &M,
        state: &TabletopState<M>,
        contacts: &Contacts,
        clearance_m: f64,
    ) -> Result<(), Blame> {
        let hit = self.with_worker(|worker| {
            self.allow(state, contacts, &mut worker.allowed);
            self.find_poses(robot, state, worker);
            self.first_hit_at(worker, clearance_m)
        });
        hit.map_or(Ok(()), |hit| Err(self.blame(&hit)))
    }

    /// The first pair found that is too near, of all bodies; they stand at `worker.poses`.
    pub(crate) fn first_hit(&self, worker: &mut Worker) -> Option<Hit> {
        self.first_hit_at(worker, self.strictness.clearance_m)
    }

    fn first_hit_at(&self, worker: &mut Worker, clearance_m: f64) -> Option<Hit> {
        // OPTIMIZATION: mostly there is none, and to find that out takes less time without a reason.
        if self.is_all_clear(worker, clearance_m) {
            return None;
        }
        self.lower_bound_at(worker, &BodySet::ALL, &BodySet::ALL, 0.0, clearance_m).err()
    }

    /// Smallest distance in metres over the pairs of one body in `moved` and one in `against`, up to `cap_m`.
    pub(crate) fn lower_bound(
        &self,
        worker: &mut Worker,
        moved: &BodySet,
        against: &BodySet,
        cap_m: f64,
    ) -> Result<f64, Hit> {
        self.lower_bound_at(worker, moved, against, cap_m, self.strictness.clearance_m)
    }

    /// Are the pairs of one body in `moved` and one in `against` clear? [`Surroundings::lower_bound`] without reasons.
    pub(crate) fn is_clear(&self, worker: &mut Worker, moved: &BodySet, against: &BodySet) -> bool {
        self.is_clear_at(worker, moved, against, self.strictness.clearance_m)
    }

    fn is_clear_at(&self, worker: &mut Worker, moved: &BodySet, against: &BodySet, clearance_m: f64) -> bool {
        let Worker { scratch, allowed, .. } = worker;
        self.model.is_clear(scratch, &Query { moved, against, allowed, clearance: clearance_m, cap: 0.0 })
    }

    /// [`Surroundings::lower_bound`] with another clearance.
    fn lower_bound_at(
        &self,
        worker: &mut Worker,
        moved: &BodySet,
        against: &BodySet,
        cap_m: f64,
        clearance_m: f64,
    ) -> Result<f64, Hit> {
        let Worker { scratch, allowed, .. } = worker;
        self.model.lower_bound(scratch, &Query { moved, against, allowed, clearance: clearance_m, cap: cap_m })
    }

    /// Begins to watch a leg of a motion, from one parameter to another, on which every body travels as `worker.reach`
    /// says. The bodies in `chain` hang together.
    pub(crate) fn watch(
        &self,
        worker: &mut Worker,
        (moved, against, chain): (&BodySet, &BodySet, &BodySet),
        (from, to): (f64, f64),
    ) {
        let Worker { scratch, allowed, reach, .. } = worker;
        let query = Query { moved, against, allowed, clearance: self.strictness.clearance_m, cap: 0.0 };
        self.model.watch(scratch, &query, &Travel { reach, chain, from, to });
    }

    /// The parameter up to which nothing that is watched can come nearer than the clearance, at most `now + cap`.
    pub(crate) fn free_until(&self, worker: &mut Worker, now: f64, cap: f64) -> Result<f64, Hit> {
        self.model.free_until(&mut worker.scratch, now, cap)
    }
}
