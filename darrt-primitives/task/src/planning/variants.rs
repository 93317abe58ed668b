//! What a benchmark compares the planner with: changes of its search strategy, as data. Planning itself makes none of them.

use darrt_core::error::Error;
use darrt_core::sample::{Full, Placed, Sampler};
use darrt_core::search::Strategy;
use darrt_core::shorten::ShortenOptions;
use darrt_core::space::Place;
use darrt_core::variants::{ApproachVisit, Frontier, Weighted};
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::primitive::pick::Pick;
use darrt_primitives::primitive::push::Push;
use darrt_primitives::tabletop::Tabletop;

/// One change of a search strategy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StrategyChange {
    /// Blocked motions are cut short, no way around is looked for.
    NoLocalRepair,
    /// Every motion is judged as soon as it is propagated.
    Eager,
    /// Nodes do not count as farther once tried.
    NoPenalty,
    /// The first plan is taken as it is.
    NoShortening,
    /// Plans are improved without those of further trees beside them.
    OneTree,
    /// Every motion is judged at once, and a node stands every so many metres of travel.
    NodeEvery(f64),
    /// An extension ends after so many metres of travel.
    StepAtMost(f64),
    /// Seven in ten samples of objects stand on a surface.
    OnSupport,
    /// Three in ten samples lie where extensions were blocked.
    Frontier,
    /// Distance: the sum of all ways, the robot's times this.
    RobotWeight(f64),
    /// Distance: the longest way of all.
    LongestWay,
    /// Distance: greedy, but the first way leads to the contact or grasp.
    Approach,
}

impl StrategyChange {
    /// Makes the change. Numbers out of range change nothing.
    pub fn apply<M: Manipulator>(self, strategy: &mut Strategy<Tabletop<M>>) {
        match self {
            Self::NoLocalRepair => {
                strategy.local_repair = None;
                strategy.extend.defer = false;
            }
            Self::Eager => strategy.extend.defer = false,
            Self::NoPenalty => strategy.try_penalty_m = 0.0,
            Self::NoShortening => {
                strategy.shorten = ShortenOptions { extensions: 0 };
                strategy.extend.defer = false;
            }
            Self::OneTree => {
                if let Some(improvement) = &mut strategy.improve {
                    improvement.options.further_trees = 0;
                }
            }
            Self::NodeEvery(spacing_m) => {
                strategy.extend.spacing_m = spacing_m;
                strategy.extend.defer = false;
            }
            Self::StepAtMost(step_m) => {
                strategy.extend.step_m = Some(step_m);
                strategy.extend.defer = false;
            }
            Self::OnSupport => resample(strategy, |inner| Ok(Box::new(Placed::new(inner, Place::OnSupport, 0.7)?))),
            Self::Frontier => resample(strategy, |inner| Ok(Box::new(Frontier::new(inner, 0.3, 0.2)?))),
            Self::RobotWeight(weight) => remeasure(strategy, || Weighted::sum(weight, 1.0)),
            Self::LongestWay => remeasure(strategy, || Weighted::maximum(1.0, 1.0)),
            // One that the problem does not allow makes the way no longer.
            Self::Approach => {
                strategy.distance = Box::new(ApproachVisit::new(vec![Box::new(Push), Box::new(Pick)]));
            }
        }
    }
}

type Inner<M> = Box<dyn Sampler<Tabletop<M>>>;

/// Puts another sampler around that of `strategy`.
fn resample<M: Manipulator>(
    strategy: &mut Strategy<Tabletop<M>>,
    around: impl FnOnce(Inner<M>) -> Result<Inner<M>, Error>,
) {
    let inner = std::mem::replace(&mut strategy.sampler, Box::new(Full));
    if let Ok(sampler) = around(inner) {
        strategy.sampler = sampler;
    }
}

fn remeasure<M: Manipulator>(strategy: &mut Strategy<Tabletop<M>>, distance: impl FnOnce() -> Result<Weighted, Error>) {
    if let Ok(distance) = distance() {
        strategy.distance = Box::new(distance);
    }
}
