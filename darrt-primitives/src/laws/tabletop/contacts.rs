//! Forgotten exemptions.

use darrt_core::laws::Broken;
use darrt_core::motion::Instance;
use darrt_core::validity::{Blame, BlockKind, Validity};

use super::{FINGERS, TabletopClaims, Trial};
use crate::manipulator::{LinkGroup, Manipulator};
use crate::tabletop::{Tabletop, TabletopState};

/// The fingers may touch what `instances`, propagated from `from`, push, close on, hold, let go of and retreat from:
/// `validity` may find other reasons why a motion is not free, such as a held object that hits the robot's base, but not
/// that the fingers touch what they handle.
///
/// # Errors
/// [`FINGERS`] with the blame.
pub fn check_finger_contacts<M: Manipulator>(
    m: &Tabletop<M>,
    validity: &dyn Validity<Tabletop<M>>,
    instances: &[Instance<Tabletop<M>>],
    from: &TabletopState<M>,
    ts: &[f64],
) -> Result<(), Broken> {
    let claims = TabletopClaims::default();
    let mut here = from.clone();
    for instance in instances {
        let trial = Trial::new(m, instance, &here, ts, &claims);
        if let Some(name) = trial.handled() {
            let looks = trial.looks.iter().map(|look| (look.t, &look.state));
            for (t, state) in looks.chain([(0.0, &here), (1.0, &trial.end)]) {
                let Err(blame) = validity.check(m, state, &instance.contacts) else { continue };
                if trial.is_finger_on(&blame, &name) {
                    let broken = Broken::new(FINGERS, blame.to_string(), format!("contact with {name} allowed"));
                    let call = || format!("check_finger_contacts(&m, &validity, &[{instance:?}], &{here:?}, &{ts:?})");
                    return Err(broken.at(t).of(format_args!("instance {:?}", instance.primitive)).replayed_by(call));
                }
            }
        }
        instance.motion.at_into(m, 1.0, &mut here);
    }
    Ok(())
}

impl<M: Manipulator> Trial<'_, M> {
    /// Name of the object that the fingers have to touch.
    fn handled(&self) -> Option<String> {
        let mode = &self.during.mode;
        let at = mode.engaged().filter(|id| {
            let leaves = self.end.mode.engaged().is_none();
            leaves || self.from.object(*id) != self.end.object(*id)
        });
        mode.held().map(|held| held.object).or(at).map(|id| self.name(id))
    }

    fn is_finger_on(&self, blame: &Blame, name: &str) -> bool {
        let robot = self.m.manipulator();
        let is_finger = |body: &str| {
            let mut links = robot.links().iter().enumerate().filter(|(_, link)| link.group == LinkGroup::Finger);
            links
                .any(|(number, link)| *link.body.name == *body && robot.hand_of_link(number) == self.during.mode.hand())
        };
        let pairs = [(&blame.first, &blame.second), (&blame.second, &blame.first)];
        blame.kind == BlockKind::RobotObject && pairs.iter().any(|(a, b)| is_finger(a) && ***b == *name)
    }
}
