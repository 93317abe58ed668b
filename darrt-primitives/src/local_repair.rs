//! A way around for a blocked transit or transfer: [`arm`] searches at random, the base by a planner of its own,
//! [`BasePath`].

use darrt_core::local_repair::{LocalRepair, NoWay};
use darrt_core::motion::Instance;
use darrt_core::validity::Validity;
use rand::Rng;

pub mod arm;

pub use arm::ArmRepair;

use crate::arm_motion::{ArmMotion, Carried, Waypoint};
use crate::base_path::BasePath;
use crate::contract::Contract;
use crate::manipulator::{Configuration, Manipulator};
use crate::mode::Contacts;
use crate::tabletop::{Tabletop, TabletopState};

/// How ways around are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TransitRepair {
    /// Where the arm moves.
    pub arm: ArmRepair,
    /// Where the base moves.
    pub base: BasePath,
}

impl<M: Manipulator> LocalRepair<Tabletop<M>> for TransitRepair {
    fn is_free_to_turn(&self, m: &Tabletop<M>, instance: &Instance<Tabletop<M>>) -> bool {
        // Not an approach, a push, a pick or a place.
        let is_free = m.contract(instance.primitive).is_some_and(Contract::is_free);
        instance.reversible && is_free && instance.contacts == Contacts::default()
    }

    fn repair(
        &self,
        m: &Tabletop<M>,
        validity: &dyn Validity<Tabletop<M>>,
        care: usize,
        instance: &Instance<Tabletop<M>>,
        from: &TabletopState<M>,
        rng: &mut dyn Rng,
    ) -> Result<Instance<Tabletop<M>>, NoWay> {
        if !LocalRepair::<Tabletop<M>>::is_free_to_turn(self, m, instance) {
            return Err(NoWay::WithAnyCare);
        }
        let end = instance.at(m, 1.0, from);
        let inside = instance.at(m, f64::MIN_POSITIVE, from);
        // An end that is itself too near to something cannot be left, whichever way.
        for state in [&inside, &end] {
            validity.check_with(care, m, state, &Contacts::default()).map_err(|_| NoWay::WithThisCare)?;
        }
        let way = match (end.robot.base == from.robot.base, end.robot.arm == from.robot.arm) {
            (true, false) => self.arm.find(m, care, &inside, from, &end, rng).ok_or(NoWay::WithThisCare)?,
            (false, true) => {
                let bases = self.base.find(m, care, &inside, &end.robot.base)?;
                bases.into_iter().map(|base| Configuration { base, arm: from.robot.arm }).collect()
            }
            _ => return Err(NoWay::WithAnyCare),
        };
        let waypoints: Vec<_> = way.iter().skip(1).map(|q| Waypoint { robot: *q, pushed: 0.0 }).collect();
        let carried = inside.mode.held().map_or(Carried::Nothing, |held| Carried::Held(*held));
        let motion = ArmMotion::new(m, from, &waypoints, carried, inside.mode.clone(), inside.mode);
        let around = Instance {
            primitive: instance.primitive,
            motion: Box::new(motion),
            contacts: Contacts::default(),
            moves: instance.moves,
            object: instance.object,
            reversible: true,
        };
        // It was searched for by samples.
        let free = validity.free_prefix_with(0, m, &around, from);
        if free.blame.is_some() && free.fraction < 1.0 { Err(NoWay::WithThisCare) } else { Ok(around) }
    }
}
