//! What several test files share.

use std::ops::ControlFlow;

use darrt_core::budget::Budget;
use darrt_core::distance::{Distance, GreedyVisit};
use darrt_core::extend::ExtendOptions;
use darrt_core::motion::{Instance, Waypoints};
use darrt_core::observe::{Event, Observer, Silent};
use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use darrt_core::problem::Problem;
use darrt_core::random::{Purpose, Stream, stream};
use darrt_core::sample::{GoalBiased, RobotOrObjects, Sampler};
use darrt_core::search::Strategy;
use darrt_core::solve::{Outcome, SolveOptions, solve};
use darrt_core::state::{ComponentSet, ObjectId, State};
use darrt_core::testing::puck::{Mode, Point, PuckWorld, Setup, paper_strategy};
use rand::Rng;

pub(crate) type World = PuckWorld;

/// A small floor with the robot at (0.5, 1) and one puck at (1, 1).
pub(crate) fn small() -> Setup {
    Setup::new([3.0, 2.0], 0.15).robot_at([0.5, 1.0]).puck("red", 0.12, [1.0, 1.0])
}

pub(crate) fn rng(seed: u64) -> Stream {
    stream(seed, 0, 0, Purpose::Extend)
}

pub(crate) fn id(index: usize) -> ObjectId {
    ObjectId::new(index)
}

/// Restarts every 200 iterations.
pub(crate) fn options(seed: u64, iterations: u64) -> SolveOptions {
    SolveOptions {
        seed,
        budget: Budget { iterations: Some(iterations), ..Budget::default() },
        restart_iterations: Some(200),
        threads: 1,
    }
}

pub(crate) fn strategy(
    sampler: impl Sampler<World> + 'static,
    distance: impl Distance<World> + 'static,
) -> Strategy<World> {
    Strategy {
        sampler: Box::new(GoalBiased::new(sampler, 0.2).unwrap()),
        distance: Box::new(distance),
        extend: ExtendOptions::default(),
        local_repair: None,
        try_penalty_m: 0.0,
        shorten: darrt_core::shorten::ShortenOptions::default(),
        improve: None,
    }
}

pub(crate) fn greedy(sampler: impl Sampler<World> + 'static) -> Strategy<World> {
    strategy(sampler, GreedyVisit)
}

pub(crate) fn robot_or_objects() -> RobotOrObjects {
    RobotOrObjects::new(0.5, 0.0).unwrap()
}

/// With the paper's strategy and nobody listening.
pub(crate) fn run(problem: &Problem<World>, options: &SolveOptions) -> Outcome<World> {
    solve(problem, &paper_strategy().unwrap(), options, &mut Silent)
}

pub(crate) fn run_observed(
    problem: &Problem<World>,
    options: &SolveOptions,
    observer: impl FnMut(&Event<'_>) -> ControlFlow<()> + Send,
) -> Outcome<World> {
    solve(problem, &paper_strategy().unwrap(), options, &mut Listener(observer))
}

struct Listener<F>(F);

impl<F: FnMut(&Event<'_>) -> ControlFlow<()> + Send> Observer for Listener<F> {
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        (self.0)(event)
    }
}

/// Another id for every name of these tests.
pub(crate) fn called(name: &'static str) -> PrimitiveId {
    let index = name.bytes().fold(7_u16, |sum, byte| sum.wrapping_mul(31).wrapping_add(byte.into()));
    PrimitiveId::new(index, name)
}

/// A primitive made of two functions.
pub(crate) struct Made<U, P> {
    pub(crate) name: &'static str,
    pub(crate) useful: U,
    /// The robot configurations to visit; each becomes an instance.
    pub(crate) visit: P,
}

impl<U, P> Primitive<World> for Made<U, P>
where
    U: Fn(&State<World>) -> bool + Send + Sync,
    P: Fn(&State<World>) -> Vec<Point> + Send + Sync,
{
    fn id(&self) -> PrimitiveId {
        called(self.name)
    }

    fn useful(&self, _: &World, from: &State<World>, _: &PartialState<World>) -> bool {
        (self.useful)(from)
    }

    fn propagate(
        &self,
        _: &World,
        from: &State<World>,
        _: &PartialState<World>,
        _: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        let mut here = from.clone();
        let mut instances = Vec::new();
        for robot in (self.visit)(from) {
            let there = State { robot, ..here.clone() };
            instances.push(robot_instance(&here, &there));
            here = there;
        }
        Ok(instances)
    }
}

/// The robot from one state to another, claiming a length of one metre.
pub(crate) fn robot_instance(from: &State<World>, to: &State<World>) -> Instance<World> {
    let motion = Waypoints::new(vec![from.clone(), to.clone()], &[1.0], from.mode.clone()).unwrap();
    Instance {
        primitive: called("made"),
        motion: Box::new(motion),
        contacts: ComponentSet::EMPTY,
        moves: ComponentSet::ROBOT,
        object: None,
        reversible: true,
    }
}

/// A random state of the world, valid or not, and a random target that names some of it.
pub(crate) fn random_pair(m: &World, sampler: &dyn Sampler<World>, seed: u64) -> (State<World>, PartialState<World>) {
    use darrt_core::domain::Domain;
    use darrt_core::space::ComponentSpace;
    let mut rng = rng(seed);
    let robot = m.robot().sample(&mut rng);
    let objects: darrt_core::state::PerObject<Point> = m.objects().iter().map(|o| o.sample(&mut rng)).collect();
    let mode = Mode::resting(objects.len());
    let goal = darrt_core::goal::Reach::new(PartialState::anywhere(m));
    let target = sampler.sample(m, &goal, &mut rng);
    (State { robot, objects, mode }, target)
}
