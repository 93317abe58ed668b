//! The chance that a plan succeeds open loop, as a cost beside the seconds that it takes.
//!
//! What a robot that does not look again is off by comes from its drives: each ends with an error of its own (localisation, some
//! 15 mm and a degree). Two contacts from one stand share that error, so that the second finds the object where the first has
//! left it against the hand: a push from where the robot then stands to grasp makes up for the drive before it, and for where
//! the object was detected. A push bears an error of centimetres, its fingers being a funnel; a grasp by the rim does not, and
//! hands it on to where the object is set down. So a drive before a contact costs some seconds, and many before a grasp.
//!
//! The weights are a choice: how many seconds somebody would give for a tenth more of success.

use darrt_core::cost::ExecutionCost;
use darrt_core::domain::Domain as _;
use darrt_core::motion::Instance;
use darrt_core::partial::PartialState;
use darrt_core::state::ObjectId;
use nalgebra::{Isometry3, Point2, Translation3};
use rand::{Rng, RngExt};

use crate::execution_time::ExecutionTime;
use crate::manipulator::Manipulator;
use crate::tabletop::{Tabletop, TabletopState};

/// What a drive before a push or a place is worth, seconds.
const DRIVE_S: f64 = 5.0;
/// What a drive before a grasp is worth: the error of the grasp is with the object from then on, seconds.
const DRIVE_TO_GRASP_S: f64 = 40.0;
/// How long a push is that is made to know better where its object is, least and most, metres: it settles the error of a drive
/// across the fingers for the most part, and lies within the reach of an arm that will grasp next.
const NUDGE_M: [f64; 2] = [0.08, 0.22];
/// How many places are drawn for the beginning of such a push.
const NUDGE_TRIES: usize = 16;

/// Seconds of [`ExecutionTime`], and seconds for what makes success less likely.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Success;

impl<M: Manipulator> ExecutionCost<Tabletop<M>> for Success {
    fn step_s(&self) -> f64 {
        ExecutionCost::<Tabletop<M>>::step_s(&ExecutionTime)
    }

    fn seconds(&self, m: &Tabletop<M>, instance: &Instance<Tabletop<M>>, from: &TabletopState<M>, until: f64) -> f64 {
        ExecutionTime.seconds(m, instance, from, until)
    }

    fn between(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &TabletopState<M>) -> f64 {
        ExecutionTime.between(m, from, to)
    }

    fn arrival(
        &self,
        m: &Tabletop<M>,
        last: &TabletopState<M>,
        entry: &TabletopState<M>,
        exit: &TabletopState<M>,
    ) -> f64 {
        let is_grasp = m.carried(&entry.mode).is_empty() && !m.carried(&exit.mode).is_empty();
        match (last.robot.base == entry.robot.base, is_grasp) {
            (true, _) => 0.0,
            (false, true) => DRIVE_TO_GRASP_S,
            (false, false) => DRIVE_S,
        }
    }

    /// The object that is moved, beside where it shall be.
    fn stopover(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &TabletopState<M>,
        rng: &mut dyn Rng,
    ) -> Option<PartialState<Tabletop<M>>> {
        let mut moved = (0..to.objects.len()).map(ObjectId::new).filter(|id| from.object(*id) != to.object(*id));
        let object = moved.next()?;
        let (end, on) = (to.object(object)?, to.mode.support_of(object)?);
        let surface = m.surface(on)?;
        let beside = (0..NUDGE_TRIES).find_map(|_| {
            let away_m = rng.random_range(NUDGE_M[0]..NUDGE_M[1]);
            let (sin, cos) = rng.random_range(0.0..std::f64::consts::TAU).sin_cos();
            let beside: Isometry3<f64> = Translation3::new(away_m * cos, away_m * sin, 0.0) * end;
            let centre = Point2::new(beside.translation.x, beside.translation.y);
            (surface.contains(&centre) && m.keeps_from_edge(object, on, &centre)).then_some(beside)
        })?;
        Some(PartialState::anywhere(m).with_object(object, beside))
    }
}
