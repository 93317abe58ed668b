//! Any plan with finite numbers survives writing and reading bit for bit; any other is refused by the writer.
#![no_main]

use arbitrary::Arbitrary;
use darrt_pr2::problems::{builtin, builtin_names};
use darrt_task::plan_file::{
    AllowedContact, ContactReason, GradeName, Hold, PlanFile, PlanFileError, PlanFormat, PlannerFacts, Pose,
    SearchName, Step, VERSION, Waypoint,
};
use darrt_task::problem_file::{DistanceName, PrimitiveName, SamplerName};
use libfuzzer_sys::fuzz_target;

#[derive(Debug, Clone, Arbitrary)]
struct PlanSketch {
    problem: u8,
    seed: u64,
    counts: [u64; 3],
    variants: [u8; 2],
    searches: Vec<u8>,
    improve: Option<u8>,
    as_found: bool,
    start: WaypointSketch,
    steps: Vec<StepSketch>,
}

#[derive(Debug, Clone, Arbitrary)]
struct StepSketch {
    primitive: u8,
    object: Option<String>,
    holds: Option<(String, PoseSketch)>,
    pushes: Option<String>,
    contacts: Vec<(String, String, u8)>,
    waypoints: Vec<WaypointSketch>,
    tool: Option<String>,
}

#[derive(Debug, Clone, Arbitrary)]
struct WaypointSketch {
    base: [f64; 3],
    joints: Vec<(String, f64)>,
    objects: Vec<(String, PoseSketch)>,
}

type PoseSketch = ([f64; 3], [f64; 4]);

fn pose((position, quaternion): &PoseSketch) -> Pose {
    Pose { position: *position, quaternion: *quaternion }
}

fn pick<T: Clone>(all: &[T], which: u8) -> T {
    all[usize::from(which) % all.len()].clone()
}

impl WaypointSketch {
    fn waypoint(&self) -> Waypoint {
        Waypoint {
            base: self.base,
            joints: self.joints.iter().map(|(name, value)| (name.as_str().into(), *value)).collect(),
            objects: self.objects.iter().map(|(name, at)| (name.as_str().into(), pose(at))).collect(),
        }
    }
}

impl StepSketch {
    fn step(&self) -> Step {
        let reasons = [ContactReason::Push, ContactReason::Grasp, ContactReason::Retreat, ContactReason::Support];
        let contact = |(a, b, reason): &(String, String, u8)| AllowedContact {
            a: a.clone(),
            b: b.clone(),
            reason: pick(&reasons, *reason),
        };
        Step {
            primitive: pick(&PrimitiveName::PAPER, self.primitive),
            object: self.object.clone(),
            tool: self.tool.clone(),
            holds: self.holds.as_ref().map(|(object, at)| Hold { object: object.clone(), tool_from_object: pose(at) }),
            pushes: self.pushes.clone(),
            allowed_contacts: self.contacts.iter().map(contact).collect(),
            waypoints: self.waypoints.iter().map(WaypointSketch::waypoint).collect(),
        }
    }
}

impl PlanSketch {
    fn plan(&self) -> PlanFile {
        let samplers = [SamplerName::ROBOT_OR_OBJECTS, SamplerName::RANDOM_SUBSET, SamplerName::FULL];
        let costs = [GradeName::Steps, GradeName::Travel, GradeName::Clearance];
        let distances = [DistanceName::GREEDY, DistanceName::EUCLIDEAN, DistanceName::EXACT_TOUR];
        let problem = builtin(pick(&builtin_names(), self.problem)).expect("a built-in problem");
        let contracts = darrt_pr2::registry()
            .allowed(&problem)
            .map(|(id, contract)| (id.name().to_owned().into(), contract))
            .collect();
        PlanFile {
            format: PlanFormat::DarrtPlan,
            version: VERSION,
            problem,
            seed: self.seed,
            planner: PlannerFacts {
                sampler: pick(&samplers, self.variants[0]),
                distance: pick(&distances, self.variants[1]),
                searches: self.searches.iter().map(|which| pick(&SearchName::ALL, *which)).collect(),
                improve: self.improve.map(|which| pick(&costs, which)),
                as_found: self.as_found,
                iterations: self.counts[0],
                restarts: self.counts[1],
                nodes: self.counts[2],
            },
            contracts,
            partial: None,
            start: self.start.waypoint(),
            steps: self.steps.iter().map(StepSketch::step).collect(),
            timing: None,
        }
    }
}

fn is_finite(plan: &PlanFile) -> bool {
    let finite = |pose: &Pose| pose.position.iter().chain(&pose.quaternion).all(|x| x.is_finite());
    let held = plan.steps.iter().filter_map(|step| step.holds.as_ref()).all(|hold| finite(&hold.tool_from_object));
    let mut waypoints = std::iter::once(&plan.start).chain(plan.steps.iter().flat_map(|step| &step.waypoints));
    held && waypoints
        .all(|at| at.base.iter().chain(at.joints.values()).all(|x| x.is_finite()) && at.objects.values().all(finite))
}

fuzz_target!(|sketch: PlanSketch| {
    let plan = sketch.plan();
    match plan.to_json() {
        Ok(text) => {
            assert!(is_finite(&plan));
            let again = PlanFile::from_json(&text, "fuzz.json").unwrap_or_else(|error| panic!("{error}\n{text}"));
            assert_eq!(again, plan);
            // The sign of a zero is not seen by `==`.
            assert_eq!(again.to_json().expect("as before"), text);
        }
        Err(PlanFileError::NotFinite { .. }) => assert!(!is_finite(&plan)),
        Err(other) => panic!("{other}"),
    }
});
