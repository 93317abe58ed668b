//! What a propagation may do at most, judged from outside: what it moves, what it spoils, where it changes the mode, and
//! whether it really can be run backwards.

use super::{AT_HAND, HARM, MOVES, REVERSIBLE, Trial};
use crate::domain::Domain;
use crate::laws::domain::CARRIED;
use crate::laws::feed::components;
use crate::laws::{Broken, ensure};
use crate::motion::Instance;
use crate::partial::PartialState;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, State};

/// How often the way back is tried.
const TRIES: u64 = 4;
/// How far the robot may be from where it was, in tolerances of its space, and still be there.
const STAYS: f64 = 10.0;

impl<D: Domain> Trial<'_, '_, D> {
    pub(super) fn at_most(&self, instances: &[Instance<D>], end: &State<D>) -> Result<(), Broken> {
        let mut here = self.from.clone();
        for (i, instance) in instances.iter().enumerate() {
            let of = |broken: Broken| broken.of(format_args!("instance {i} {:?}", instance.primitive));
            let after = instance.at(self.m, 1.0, &here);
            if !self.claims.moves_others {
                self.moves(instance).map_err(of)?;
            }
            self.takes_along(instance, &here, &after).map_err(of)?;
            self.holds(instance, &here, &after).map_err(of)?;
            self.mode_changes_at_hand(instance, &here, &after).map_err(of)?;
            if instance.reversible {
                self.way_back(instance, &here, &after).map_err(of)?;
            }
            here = after;
        }
        self.harm(end)
    }

    /// The robot, and the object that the instance names.
    fn moves(&self, instance: &Instance<D>) -> Result<(), Broken> {
        for id in (0..self.m.objects().len()).map(ObjectId::new) {
            let is_moved = instance.moves.contains(ComponentId::Object(id));
            let text = || format!("moves {} as well", self.m.component_name(ComponentId::Object(id)));
            ensure(MOVES, !is_moved || instance.object == Some(id), text, "the robot and the object that it names")?;
        }
        Ok(())
    }

    /// What is carried goes where the robot goes.
    fn takes_along(&self, instance: &Instance<D>, before: &State<D>, after: &State<D>) -> Result<(), Broken> {
        let during = instance.at(self.m, 0.5, before).mode;
        // What is taken up or let go is what the instance is about.
        for (mode, next) in [(&before.mode, &during), (&during, &after.mode)] {
            let [was, is] = [mode, next].map(|mode| self.m.carried(mode));
            for id in components(self.m, was.union(is)) {
                let changes = was.contains(id) != is.contains(id);
                let is_its = instance.object.is_some_and(|object| ComponentId::Object(object) == id);
                let text = || format!("{} taken up or let go, from {mode:?} to {next:?}", self.m.component_name(id));
                ensure(CARRIED, !changes || is_its, text, "only the object that the instance names")?;
            }
        }
        if before.robot == after.robot {
            return Ok(());
        }
        let carried = self.m.carried(&during);
        for id in components(self.m, carried) {
            let text = || format!("the robot without {}, in mode {during:?}", self.m.component_name(id));
            ensure(CARRIED, instance.moves.contains(id), text, "what is carried moves as well")?;
        }
        Ok(())
    }

    /// What was where the target wants it is still there.
    fn harm(&self, end: &State<D>) -> Result<(), Broken> {
        if self.is_excused(end) {
            return Ok(());
        }
        for (id, _) in self.to.objects() {
            let is_spoilt = self.to.is_object_met(self.m, self.from, id) && !self.to.is_object_met(self.m, end, id);
            let name = || format!("{} was at its target, and no longer is", self.name(id));
            ensure(HARM, !is_spoilt, name, "still at its target")?;
        }
        Ok(())
    }

    fn name(&self, id: ObjectId) -> String {
        self.m.component_name(ComponentId::Object(id)).into_owned()
    }

    /// Where the mode changes, the robot is at the object; unless the domain says that motions go on over the change.
    fn mode_changes_at_hand(&self, instance: &Instance<D>, before: &State<D>, after: &State<D>) -> Result<(), Broken> {
        if self.m.objects().is_empty() {
            return Ok(());
        }
        let during = instance.at(self.m, 0.5, before).mode;
        for (t, at, next) in [(0.0, before, &during), (1.0, after, &after.mode)] {
            let mode = if t > 0.0 { &during } else { &before.mode };
            if mode == next || self.m.may_go_on(mode, next) || self.m.may_go_on(next, mode) {
                continue;
            }
            let reach = |id: ObjectId| at.object(id).map(|place| self.m.reach(&at.robot, id, place));
            // At the start the robot may leave another object than the one that it goes to.
            let nearest = match instance.object.filter(|_| t > 0.0) {
                Some(id) => reach(id),
                None => (0..at.objects.len()).filter_map(|i| reach(ObjectId::new(i))).min_by(f64::total_cmp),
            };
            let is_at_hand = nearest.is_some_and(|metres| metres <= self.claims.hand_m);
            let text = || format!("from {mode:?} to {next:?}, {nearest:?} m from the object");
            ensure(AT_HAND, is_at_hand, text, "a change where the robot can act on the object")
                .map_err(|broken| broken.at(t))?;
        }
        Ok(())
    }

    /// Run backwards, the motion brings the object back without any other motion before. So whoever propagates back finds
    /// such a motion, at least once: if it always has to go to another side first, this was a push.
    fn way_back(&self, instance: &Instance<D>, before: &State<D>, after: &State<D>) -> Result<(), Broken> {
        let Some(id) = instance.object.filter(|id| before.object(*id) != after.object(*id)) else { return Ok(()) };
        let Some(old) = before.object(id) else { return Ok(()) };
        let target = PartialState::anywhere(self.m).with_object(id, old.clone());
        let mut detours = 0;
        for attempt in 0..TRIES {
            if !self.is_useful_from(after, &target)? {
                return Ok(());
            }
            let Ok(instances) = self.propagate_from(after, &target, attempt)? else { continue };
            let Some(first) = first_that_moves(self.m, &instances, after, id) else { continue };
            let robot = self.m.robot();
            if robot.distance(&first.robot, &after.robot) <= STAYS * robot.tolerance() {
                return Ok(());
            }
            detours += 1;
        }
        let text = || format!("reversible, but {detours} of {TRIES} ways back begin by going somewhere else");
        ensure(REVERSIBLE, detours == 0, text, "a way back that begins where this one ends")
    }
}

/// The state in which the instance begins that moves `id` first.
fn first_that_moves<D: Domain>(m: &D, instances: &[Instance<D>], from: &State<D>, id: ObjectId) -> Option<State<D>> {
    let mut here = from.clone();
    for instance in instances {
        let next = instance.at(m, 1.0, &here);
        if next.object(id) != here.object(id) {
            return Some(here);
        }
        here = next;
    }
    None
}
