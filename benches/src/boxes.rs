//! The arm of a PR2 among a table and ten boxes: pairs of free configurations.

use darrt_core::domain::Domain as _;
use darrt_core::local_repair::LocalRepair as _;
use darrt_core::motion::Instance;
use darrt_core::space::ComponentSpace as _;
use darrt_core::state::ComponentSet;
use darrt_core::validity::Validity as _;
use darrt_pr2::problems::builtin;
use darrt_pr2::{World, WorldState};
use darrt_primitives::arm_motion::{ArmMotion, Carried, Waypoint};
use darrt_primitives::local_repair::TransitRepair;
use darrt_primitives::manipulator::{Configuration, Manipulator as _};
use darrt_primitives::mode::Contacts;
use darrt_primitives::primitive::ARM_TRANSIT;
use darrt_primitives::validity::SceneValidity;
use darrt_task::problem_file::{Obstacle, ShapeSpec};
use darrt_task::world::{Built, build};
use rand::RngExt as _;

use crate::stream;

/// How many boxes stand on the table.
const BOXES: u64 = 10;
/// Full size of a box, metres.
const BOX_M: [f64; 3] = [0.10, 0.10, 0.25];

/// The table with its boxes, the PR2 before it.
#[derive(Debug)]
pub struct Boxes {
    world: World,
    validity: SceneValidity,
    /// From where to where the arm shall go.
    pub queries: Vec<(WorldState, WorldState)>,
}

impl Boxes {
    /// `count` pairs of configurations with the hand over the table, each free by itself.
    pub fn new(count: usize) -> Self {
        let mut file = builtin("simple-plate").unwrap();
        file.robot.base = [-0.80, -0.15, 0.0];
        let rng = &mut stream(0);
        for number in 0..BOXES {
            file.obstacles.push(Obstacle {
                name: format!("box {number}"),
                shape: ShapeSpec::Box { size: BOX_M },
                // Beside the plate.
                at: vec![rng.random_range(0.05..0.40), rng.random_range(-0.55..0.55), 0.75 + BOX_M[2] / 2.0],
                standing_on: None,
                yaw: Some(rng.random_range(-3.0..3.0)),
                rpy: None,
                quaternion: None,
            });
        }
        let Built { world, start, .. } = build(&darrt_pr2::registry(), &file).unwrap();
        let validity = SceneValidity::new(&world);
        let mut boxes = Self { world, validity, queries: Vec::new() };
        boxes.queries = (0..count).map(|_| (boxes.free(&start, rng), boxes.free(&start, rng))).collect();
        boxes
    }

    /// A free state with the hand between the boxes or not far above them.
    fn free(&self, start: &WorldState, rng: &mut darrt_core::random::Stream) -> WorldState {
        loop {
            let mut state = start.clone();
            state.robot.arm = self.world.robot().sample(rng).arm;
            let tool = self.world.manipulator().world_from_tool(&state.robot).translation.vector;
            let is_there = tool.x > -0.35 && tool.z > 0.76 && tool.z < 1.15;
            if is_there && self.validity.check(&self.world, &state, &Contacts::default()).is_ok() {
                return state;
            }
        }
    }

    /// The way that a transit takes: straight if that is free, else around what is in the way.
    pub fn way(&self, (from, to): &(WorldState, WorldState), seed: u64) -> Option<Instance<World>> {
        let (m, mode) = (&self.world, &from.mode);
        let target = Waypoint { robot: Configuration { base: from.robot.base, arm: to.robot.arm }, pushed: 0.0 };
        let motion = ArmMotion::new(m, from, &[target], Carried::Nothing, mode.clone(), mode.clone());
        let straight = Instance {
            primitive: ARM_TRANSIT,
            motion: Box::new(motion),
            contacts: Contacts::default(),
            moves: ComponentSet::ROBOT,
            object: None,
            reversible: true,
        };
        let is_free = |way: &Instance<World>| self.validity.free_prefix(m, way, from).blame.is_none();
        if is_free(&straight) {
            return Some(straight);
        }
        let around = TransitRepair::default().repair(m, &self.validity, 0, &straight, from, &mut stream(seed)).ok()?;
        is_free(&around).then_some(around)
    }
}
