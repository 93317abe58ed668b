//! The PR2 in the scene of Plate3.

use std::sync::Arc;

use darrt_core::domain::Domain as _;
use darrt_core::motion::Instance;
use darrt_core::observe::Silent;
use darrt_core::partial::PartialState;
use darrt_core::path::path;
use darrt_core::search::{Darrt, Strategy};
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::space::ComponentSpace as _;
use darrt_core::state::State;
use darrt_geom::oracle::PosedBody;
use darrt_geom::{Body, Scene};
use darrt_pr2::problems::builtin;
use darrt_pr2::robot::Pr2;
use darrt_pr2::{World, WorldState};
use darrt_primitives::manipulator::Manipulator as _;
use darrt_primitives::mobile_arm_space::ARM;
use darrt_primitives::validity::SceneValidity;
use darrt_task::planning::{PlanRequest, Prepared, prepare, strategy};
use darrt_task::problem_file::ProblemFile;
use darrt_task::world::{Built, build};
use nalgebra::Isometry3;

use crate::stream;

/// The problem file.
pub fn plate3() -> ProblemFile {
    builtin("plate3").unwrap()
}

/// The room, its collision check, and states to ask about.
#[derive(Debug)]
pub struct Room {
    /// The PR2 and the plate.
    pub world: World,
    /// Tables and obstacles.
    pub scene: Scene,
    /// The planner's check.
    pub validity: SceneValidity,
    start: WorldState,
}

impl Room {
    /// The room of Plate3.
    pub fn new() -> Self {
        let Built { world, start, scene, .. } = build(&darrt_pr2::registry(), &plate3()).unwrap();
        let validity = SceneValidity::new(&world);
        Self { world, scene, validity, start }
    }

    /// The `index`-th state with robot and plate anywhere in their spaces; colliding ones are among them.
    pub fn state(&self, index: u64) -> WorldState {
        let rng = &mut stream(index);
        State {
            robot: self.world.robot().sample(rng),
            objects: self.world.objects().iter().map(|space| space.sample(rng)).collect(),
            mode: self.start.mode.clone(),
        }
    }

    /// The same with what `holding` holds in the hand as there.
    pub fn state_holding(&self, index: u64, holding: &WorldState) -> WorldState {
        let mut state = self.state(index);
        state.mode.clone_from(&holding.mode);
        if let Some(held) = holding.mode.held() {
            let world_from_tool = self.world.manipulator().world_from_tool(&state.robot);
            state.objects[held.object.index()] = world_from_tool * held.tool_from_object;
        }
        state
    }

    /// The first `count` of these states.
    pub fn states(&self, count: u64) -> Vec<WorldState> {
        (0..count).map(|index| self.state(index)).collect()
    }

    /// World poses of links and objects: what the collision model calls its moving bodies.
    pub fn moving_poses(&self, state: &WorldState) -> Vec<Isometry3<f64>> {
        let robot = self.world.manipulator();
        let mut poses = vec![Isometry3::identity(); robot.links().len()];
        robot.link_poses(&state.robot, state.mode.gap_m(), &mut poses);
        poses.extend(state.objects.iter().copied());
        poses
    }

    /// Every body at its pose, in the order of the collision model: links, objects, fixed bodies.
    pub fn posed(&self, state: &WorldState) -> Vec<PosedBody<'_>> {
        let robot = self.world.manipulator();
        let links = robot.links().iter().map(|link| &link.body);
        let objects = self.world.movables().iter().map(|movable| &movable.body);
        let posed = |(body, world_from_body): (_, Isometry3<f64>)| PosedBody { body, world_from_body };
        let moving: Vec<&Body> = links.chain(objects).collect();
        let moving = moving.into_iter().zip(self.moving_poses(state)).map(posed);
        let fixed = self.scene.bodies().iter().map(|fixed| posed((&fixed.body, fixed.world_from_body)));
        moving.chain(fixed).collect()
    }
}

impl Default for Room {
    fn default() -> Self {
        Self::new()
    }
}

/// Plate3 ready for planning, with the strategy of its file.
pub fn prepared() -> (Prepared<Pr2>, Strategy<World>) {
    let file = plate3();
    let strategy = strategy(&darrt_pr2::registry(), &PlanRequest::new(file.clone(), 0)).unwrap();
    (prepare(&darrt_pr2::registry(), &file).unwrap(), strategy)
}

/// Metres that the farthest point may travel between two configurations of a motion: the verifier's resolution.
pub const RESOLUTION_M: f64 = 0.0025;

/// A motion of the arm with the plate in its hand, as the planner proposes it.
#[derive(Debug)]
pub struct HeldMotion {
    /// Where it begins.
    pub from: WorldState,
    /// The motion.
    pub instance: Arc<Instance<World>>,
    /// Configurations at [`RESOLUTION_M`] up to its end or to where it is blocked.
    pub configurations: f64,
}

impl HeldMotion {
    /// A configuration on it, `share` of the way to its end.
    pub fn at(&self, room: &Room, share: f64) -> WorldState {
        self.instance.at(&room.world, share, &self.from)
    }
}

/// `count` draws of motions to anywhere from states of a plan in which the plate is held; those that begin free.
pub fn held_motions(count: usize) -> Vec<HeldMotion> {
    let (prepared, strategy) = prepared();
    let problem = &prepared.problem;
    let m = problem.domain();
    let options = SolveOptions { seed: 2, ..SolveOptions::default() };
    let plan = solve(problem, &strategy, &options, &mut Silent).solution.unwrap().plan().clone();
    let states = (0..plan.steps().len()).filter_map(|step| plan.at(m, step, 1.0));
    let held: Vec<_> = states.filter(|state| state.mode.held().is_some()).collect();
    let draw = |(index, from): (u64, &WorldState)| {
        let rng = &mut stream(index);
        let to = PartialState::anywhere(m).with_robot_groups(m.robot().sample(rng), ARM);
        let path = path(m, problem.primitives(), from, &to, 1, rng);
        let instance =
            Arc::clone(&path.instances.first().filter(|(_, i)| i.primitive.name() == "Arm-Rigid-Transfer")?.1);
        let free = problem.validity().free_prefix(m, &instance, from).fraction;
        let configurations = (instance.motion.length() * free / RESOLUTION_M).ceil();
        (configurations > 1.0).then(|| HeldMotion { from: from.clone(), instance, configurations })
    };
    (0..).zip(held.iter().cycle().take(count)).filter_map(draw).collect()
}

/// States of a tree that has grown for `iterations`, at most `count`, spread over the tree.
pub fn grown(prepared: &Prepared<Pr2>, strategy: &Strategy<World>, iterations: u64, count: usize) -> Vec<WorldState> {
    let mut darrt = Darrt::new(&prepared.problem, strategy, 2012, 0, usize::MAX);
    for _ in 0..iterations {
        darrt.step();
    }
    let tree = darrt.tree();
    let apart = tree.len().div_ceil(count);
    tree.iter().step_by(apart).map(|(_, node)| node.state.clone()).collect()
}
