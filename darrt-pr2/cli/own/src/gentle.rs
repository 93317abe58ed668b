//! A cost: seconds of execution, and what the arm does with something in the hand counts twice.

use darrt_core::cost::ExecutionCost;
use darrt_core::prelude::*;
use darrt_primitives::execution_time::ExecutionTime;
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::tabletop::{Tabletop, TabletopState};

pub struct Gentle;

impl<M: Manipulator> ExecutionCost<Tabletop<M>> for Gentle {
    fn seconds(&self, m: &Tabletop<M>, instance: &Instance<Tabletop<M>>, from: &TabletopState<M>, until: f64) -> f64 {
        let seconds = ExecutionTime.seconds(m, instance, from, until);
        if instance.object.is_some() { 2.0 * seconds } else { seconds }
    }

    fn step_s(&self) -> f64 {
        ExecutionCost::<Tabletop<M>>::step_s(&ExecutionTime)
    }

    fn between(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &TabletopState<M>) -> f64 {
        ExecutionTime.between(m, from, to)
    }
}
