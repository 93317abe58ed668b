//! What the contract of a primitive permits.

use darrt_core::laws::{Broken, ensure};
use darrt_core::motion::Instance;
use darrt_core::primitive::PrimitiveId;
use darrt_core::state::ObjectId;

use super::{CONTRACT, SOUND, TAKES, TabletopClaims, Trial};
use crate::contract::{Contract, HandUse, HandWay, MovingPart, ObjectRule};
use crate::manipulator::Manipulator;
use crate::primitive::{STANDARD, STRAIGHT_LINE_ARM_TRANSIT};
use crate::tabletop::{Tabletop, TabletopState};

/// What is taken up moves by more than this, metres.
const LEAST_M: f64 = 1e-3;

/// `instances` that were propagated from `from` keep the contracts of their primitives: of those in `contracts`, which are a
/// user's own. ([`check_tabletop`](super::check_tabletop) knows those of the standard ones.)
///
/// # Errors
/// [`SOUND`] for a contract that contradicts itself, else the first law that an instance breaks.
pub fn check_contracts<M: Manipulator>(
    m: &Tabletop<M>,
    contracts: &[(PrimitiveId, Contract)],
    instances: &[Instance<Tabletop<M>>],
    from: &TabletopState<M>,
    ts: &[f64],
    claims: &TabletopClaims,
) -> Result<(), Broken> {
    for (id, contract) in contracts {
        let flaw = contract.flaw();
        ensure(SOUND, flaw.is_none(), || flaw.unwrap_or_default().to_owned(), "a contract that can be kept")
            .map_err(|broken| broken.of(id.name()).replayed_by(|| format!("{contract:?}.flaw()")))?;
    }
    let mut here = from.clone();
    for instance in instances {
        if let Some((_, contract)) = contracts.iter().find(|(id, _)| *id == instance.primitive) {
            let call =
                || format!("check_contracts(&m, &{contracts:?}, &[{instance:?}], &{here:?}, &{ts:?}, &{claims:?})");
            Trial::new(m, instance, &here, ts, claims)
                .keeps(*contract)
                .map_err(|broken| broken.of(format_args!("instance {:?}", instance.primitive)).replayed_by(call))?;
        }
        instance.motion.at_into(m, 1.0, &mut here);
    }
    Ok(())
}

impl<M: Manipulator> Trial<'_, M> {
    /// If it is one of the standard primitives.
    pub(super) fn contract(&self) -> Result<(), Broken> {
        let known = STANDARD.iter().find(|(id, _)| *id == self.instance.primitive);
        known.map_or(Ok(()), |(_, contract)| self.keeps(*contract))
    }

    fn keeps(&self, contract: Contract) -> Result<(), Broken> {
        let states = || self.looks.iter().map(|look| (look.t, &look.state)).chain([(1.0, &self.end)]);
        for (t, state) in states() {
            let stays = match contract.moves {
                MovingPart::Base => state.robot.arm == self.from.robot.arm,
                MovingPart::Arm => state.robot.base == self.from.robot.base,
            };
            let text = || format!("{:?}, from {:?}", state.robot, self.from.robot);
            ensure(
                CONTRACT,
                stays,
                text,
                match contract.moves {
                    MovingPart::Base => "the arm keeps its joints",
                    MovingPart::Arm => "the base stands",
                },
            )
            .map_err(|broken| broken.at(t))?;
        }
        let held = |state: &TabletopState<M>| state.mode.held().map(|held| held.object);
        let (before, during, after) = (held(self.from), held(&self.during), held(&self.end));
        let fits = match contract.hand {
            HandUse::Empty => during.is_none() && after.is_none(),
            HandUse::Takes => before.is_none() && during.is_some() && after == during,
            HandUse::Carries => during.is_some() && before == during && after == during,
            HandUse::LetsGo => during.is_some() && before == during && after.is_none(),
        };
        let text = || format!("{before:?} before, {during:?} meanwhile and {after:?} after in the hand");
        ensure(
            CONTRACT,
            fits,
            text,
            match contract.hand {
                HandUse::Empty => "nothing in the hand",
                HandUse::Takes => "nothing at first, then an object",
                HandUse::Carries => "an object all along",
                HandUse::LetsGo => "an object, let go at the end",
            },
        )?;
        for id in (0..self.m.movables().len()).map(ObjectId::new) {
            let moves = self.from.object(id) != self.end.object(id);
            let is_pushed = moves && during != Some(id);
            let text = || format!("{} moves at rest", self.name(id));
            ensure(CONTRACT, !is_pushed || contract.object != ObjectRule::Rests, text, "at rest, or in the hand")?;
        }
        let contacts = &self.instance.contacts;
        let touches = contacts.fingers.is_some() && !contract.fingers_touch;
        ensure(CONTRACT, !touches, || format!("{contacts:?}"), "fingers that touch nothing")?;
        // Its own law looks at that one.
        if contract.way == HandWay::Straight && self.instance.primitive != STRAIGHT_LINE_ARM_TRANSIT {
            self.straight()?;
        }
        match during.filter(|_| contract.hand == HandUse::Takes) {
            Some(id) => self.is_taken(id),
            None => Ok(()),
        }
    }

    fn is_taken(&self, id: ObjectId) -> Result<(), Broken> {
        let places = [self.from, &self.end].map(|state| state.object(id).map(|pose| pose.translation.vector));
        let [Some(before), Some(after)] = places else { return Ok(()) };
        let metres = (after - before).norm();
        ensure(TAKES, metres >= LEAST_M, || format!("{metres:?} m"), "a millimetre at least")
            .map_err(|broken| broken.of(self.name(id)))
    }
}
