//! What a program knows: its robot, the primitives, samplers, distances and costs by name, and the problems that it carries
//! inside. A user's own are added here, and are then planned with, exported, verified, drawn and benchmarked like ours.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use darrt_core::cost::ExecutionCost;
use darrt_core::distance::{Distance, Euclidean, ExactTour, GreedyVisit};
use darrt_core::error::Error;
use darrt_core::primitive::{Primitive, PrimitiveId};
use darrt_core::sample::{Full, RandomSubset, RobotOrObjects, Sampler};
use darrt_primitives::contract::Contract;
use darrt_primitives::execution_time::ExecutionTime;
use darrt_primitives::primitive::arm_rigid_transfer::ArmRigidTransfer;
use darrt_primitives::primitive::arm_transit::ArmTransit;
use darrt_primitives::primitive::base_rigid_transfer::BaseRigidTransfer;
use darrt_primitives::primitive::base_transit::BaseTransit;
use darrt_primitives::primitive::pick::Pick;
use darrt_primitives::primitive::place::Place;
use darrt_primitives::primitive::push::Push;
use darrt_primitives::primitive::straight_line_arm_transit::StraightLineArmTransit;
use darrt_primitives::primitive::{
    ARM_RIGID_TRANSFER, ARM_TRANSIT, PICK, PLACE, PUSH, STANDARD, STRAIGHT_LINE_ARM_TRANSIT,
};
use darrt_primitives::success::Success;
use darrt_primitives::tabletop::Tabletop;
use serde::de::DeserializeOwned;

use crate::planning_error::PlanningError;
use crate::problem_file::collection::Collection;
use crate::problem_file::error::{Flaw, Located};
use crate::problem_file::suggest::{nearest_expected, shown};
use crate::problem_file::{
    CostName, DistanceName, PrimitiveName, ProblemFile, ProblemFileError, SamplerName, Sampling,
};
use crate::robot::TaskRobot;

mod names;

use names::{no_setting, one_of};

/// A primitive that problem files can name: what a user's crate implements besides [`Primitive`].
///
/// # Example
/// The whole of a registration; `examples/` of the workspace's `benches` has a primitive that does something.
/// ```
/// # use darrt_core::prelude::*;
/// # use darrt_primitives::contract::{Contract, HandUse, HandWay, MovingPart};
/// # use darrt_primitives::tabletop::{Tabletop, TabletopState};
/// # use darrt_task::{registry::TaskPrimitive, robot::TaskRobot};
/// struct Wave { id: PrimitiveId, height_m: f64 }
///
/// #[derive(serde::Deserialize)]
/// #[serde(deny_unknown_fields, default)]
/// struct WaveSettings { height_m: f64 }
/// impl Default for WaveSettings { fn default() -> Self { Self { height_m: 0.2 } } }
///
/// impl<M: TaskRobot> TaskPrimitive<M> for Wave {
///     const NAME: &'static str = "Wave";
///     const CONTRACT: Contract = Contract::of(MovingPart::Arm, HandUse::Empty, HandWay::Free);
///     type Settings = WaveSettings;
///     fn new(id: PrimitiveId, settings: WaveSettings) -> Result<Self, String> {
///         if settings.height_m > 0.0 { Ok(Self { id, height_m: settings.height_m }) } else { Err("`height_m` must be above 0".into()) }
///     }
/// }
/// # impl<M: TaskRobot> Primitive<Tabletop<M>> for Wave {
/// #     fn id(&self) -> PrimitiveId { self.id }
/// #     fn useful(&self, _: &Tabletop<M>, _: &TabletopState<M>, _: &PartialState<Tabletop<M>>) -> bool { self.height_m < 0.0 }
/// #     fn propagate(&self, _: &Tabletop<M>, _: &TabletopState<M>, _: &PartialState<Tabletop<M>>, _: &mut dyn rand::Rng)
/// #         -> Result<Instances<Tabletop<M>>, Infeasible> { Err(Infeasible::NoProgress) }
/// # }
/// ```
pub trait TaskPrimitive<M: TaskRobot>: Primitive<Tabletop<M>> + Sized + 'static {
    /// Its name in files.
    const NAME: &'static str;

    /// What its instances keep to; all that the verifier knows of it.
    const CONTRACT: Contract;

    /// Names of the primitives whose instances it returns besides its own; they must be allowed where it is.
    const NEEDS: &'static [&'static str] = &[];

    /// What `[primitive.NAME]` of a problem file holds; every key has a default.
    type Settings: DeserializeOwned + Default;

    /// The primitive with these settings, known by `id` from here on.
    ///
    /// # Errors
    /// What is wrong with the settings: the key, the value, the bound.
    fn new(id: PrimitiveId, settings: Self::Settings) -> Result<Self, String>;
}

type Boxed<M> = Box<dyn Primitive<Tabletop<M>>>;
type Build<M> = Arc<dyn Fn(&ProblemFile) -> Result<Boxed<M>, Located> + Send + Sync>;
type Sampling_<M> = Arc<dyn Fn(&Sampling) -> Result<Box<dyn Sampler<Tabletop<M>>>, Error> + Send + Sync>;
type Measure<M> = Arc<dyn Fn() -> Box<dyn Distance<Tabletop<M>>> + Send + Sync>;
type Saving<M> = Arc<dyn Fn() -> Box<dyn ExecutionCost<Tabletop<M>>> + Send + Sync>;

/// A primitive of a registry.
struct Entry<M: TaskRobot> {
    id: PrimitiveId,
    contract: Contract,
    needs: &'static [&'static str],
    build: Build<M>,
}

/// What a program knows about planning for the robot `M`.
pub struct Registry<M: TaskRobot> {
    primitives: Vec<Entry<M>>,
    samplers: Vec<(&'static str, Sampling_<M>)>,
    distances: Vec<(&'static str, Measure<M>)>,
    costs: Vec<(&'static str, Saving<M>)>,
    problems: Collection,
}

impl<M: TaskRobot> fmt::Debug for Registry<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let primitives: Vec<_> = self.primitives.iter().map(|entry| entry.id).collect();
        f.debug_struct("Registry").field("primitives", &primitives).finish_non_exhaustive()
    }
}

impl<M: TaskRobot> Default for Registry<M> {
    fn default() -> Self {
        Self::new()
    }
}

/// What each of the paper's primitives is made of besides itself, by index.
const STANDARD_NEEDS: [(PrimitiveId, &[&str]); 3] = [
    (PUSH, &[ARM_TRANSIT.name(), STRAIGHT_LINE_ARM_TRANSIT.name()]),
    (PICK, &[ARM_TRANSIT.name(), STRAIGHT_LINE_ARM_TRANSIT.name()]),
    (PLACE, &[ARM_RIGID_TRANSFER.name(), STRAIGHT_LINE_ARM_TRANSIT.name()]),
];

impl<M: TaskRobot> Registry<M> {
    /// The paper's eight primitives, the samplers and distances of this workspace, no problems.
    pub fn new() -> Self {
        let boxed: [fn() -> Boxed<M>; 8] = [
            || Box::new(ArmTransit),
            || Box::new(StraightLineArmTransit),
            || Box::new(ArmRigidTransfer),
            || Box::new(BaseTransit),
            || Box::new(BaseRigidTransfer),
            || Box::new(Pick),
            || Box::new(Place),
            || Box::new(Push),
        ];
        let standard = STANDARD.into_iter().zip(boxed).map(|((id, contract), boxed)| {
            let build: Build<M> = Arc::new(move |problem| no_setting(problem, id.name()).map(|()| boxed()));
            let needs = STANDARD_NEEDS.into_iter().find(|(of, _)| *of == id).map_or(&[][..], |(_, needs)| needs);
            Entry { id, contract, needs, build }
        });
        let mut registry = Self {
            primitives: standard.collect(),
            samplers: Vec::new(),
            distances: Vec::new(),
            costs: Vec::new(),
            problems: Collection::default(),
        };
        registry.samplers = vec![
            ("robot-or-objects", Arc::new(|s| Ok(Box::new(RobotOrObjects::new(s.object_share, s.base_only_share)?)))),
            ("random-subset", Arc::new(|_| Ok(Box::new(RandomSubset)))),
            ("full", Arc::new(|_| Ok(Box::new(Full)))),
        ];
        registry.distances = vec![
            ("greedy", Arc::new(|| Box::new(GreedyVisit))),
            ("euclidean", Arc::new(|| Box::new(Euclidean))),
            ("exact-tour", Arc::new(|| Box::new(ExactTour))),
        ];
        registry.costs =
            vec![("execution-time", Arc::new(|| Box::new(ExecutionTime))), ("success", Arc::new(|| Box::new(Success)))];
        registry
    }

    /// The same with a further primitive; it takes the place of one of the same name.
    #[must_use]
    pub fn with_primitive<P: TaskPrimitive<M>>(mut self) -> Self {
        let known = self.primitives.iter().position(|entry| entry.id.name() == P::NAME);
        let index = known.unwrap_or(self.primitives.len());
        // Nobody has so many; more than fit share the last index, and the planner refuses that.
        let id = PrimitiveId::new(u16::try_from(index).unwrap_or(u16::MAX), P::NAME);
        let build: Build<M> = Arc::new(move |problem| {
            let primitive = P::new(id, settings_of::<P::Settings>(problem, P::NAME)?);
            let flaw = |why| (format!("primitive.{}", P::NAME), Flaw::Inconsistent(format!("cannot be used: {why}")));
            primitive.map(|primitive| Box::new(primitive) as Boxed<M>).map_err(flaw)
        });
        let entry = Entry { id, contract: P::CONTRACT, needs: P::NEEDS, build };
        match self.primitives.get_mut(index) {
            Some(slot) => *slot = entry,
            None => self.primitives.push(entry),
        }
        self
    }

    /// The same with a further sampler, for `sampler = "NAME"` in `[sampling]`.
    #[must_use]
    pub fn with_sampler(
        mut self,
        name: &'static str,
        build: impl Fn(&Sampling) -> Result<Box<dyn Sampler<Tabletop<M>>>, Error> + Send + Sync + 'static,
    ) -> Self {
        self.samplers.insert(0, (name, Arc::new(build)));
        self
    }

    /// The same with a further distance, for `distance = "NAME"` in `[sampling]`.
    #[must_use]
    pub fn with_distance(
        mut self,
        name: &'static str,
        build: impl Fn() -> Box<dyn Distance<Tabletop<M>>> + Send + Sync + 'static,
    ) -> Self {
        self.distances.insert(0, (name, Arc::new(build)));
        self
    }

    /// The same with a further cost in which plans are improved, for `--cost NAME`.
    #[must_use]
    pub fn with_cost(
        mut self,
        name: &'static str,
        build: impl Fn() -> Box<dyn ExecutionCost<Tabletop<M>>> + Send + Sync + 'static,
    ) -> Self {
        self.costs.insert(0, (name, Arc::new(build)));
        self
    }

    /// The same with these problems inside.
    #[must_use]
    pub fn with_problems(self, problems: Collection) -> Self {
        Self { problems, ..self }
    }

    /// The problems inside.
    pub fn problems(&self) -> &Collection {
        &self.problems
    }

    /// The primitives by name, each with its contract.
    pub fn contracts(&self) -> BTreeMap<PrimitiveName, Contract> {
        let named = |entry: &Entry<M>| (PrimitiveName::new(entry.id.name()), entry.contract);
        self.primitives.iter().map(named).collect()
    }

    /// Those that are not the paper's, as the domain wants them.
    pub(crate) fn further(&self) -> Vec<(PrimitiveId, Contract)> {
        self.primitives.iter().skip(STANDARD.len()).map(|entry| (entry.id, entry.contract)).collect()
    }

    /// The primitives that a problem allows, with their contracts, in the order of the registry.
    pub fn allowed<'a>(&'a self, problem: &'a ProblemFile) -> impl Iterator<Item = (PrimitiveId, Contract)> + 'a {
        let allowed = self.primitives.iter().filter(|entry| is_allowed(problem, entry.id.name()));
        allowed.map(|entry| (entry.id, entry.contract))
    }

    /// The primitives that a problem allows, built with their settings, in the order of the registry.
    ///
    /// # Errors
    /// [`PlanningError::Problem`] with the key at fault.
    pub fn build_primitives(&self, problem: &ProblemFile) -> Result<Vec<Boxed<M>>, PlanningError> {
        let allowed = self.primitives.iter().filter(|entry| is_allowed(problem, entry.id.name()));
        let built = allowed.map(|entry| (entry.build)(problem).map_err(|flaw| invalid(&problem.name, flaw).into()));
        built.collect()
    }

    /// The sampler of this name.
    ///
    /// # Errors
    /// [`PlanningError::Problem`] for an unknown name, [`PlanningError::Core`] for a share outside its range.
    pub fn sampler(
        &self,
        name: &SamplerName,
        sampling: &Sampling,
    ) -> Result<Box<dyn Sampler<Tabletop<M>>>, PlanningError> {
        let found = named(&self.samplers, ("sampler", "sampling.sampler"), name.as_str())?;
        Ok(found(sampling)?)
    }

    /// The distance of this name.
    ///
    /// # Errors
    /// [`PlanningError::Problem`] for an unknown name.
    pub fn distance(&self, name: &DistanceName) -> Result<Box<dyn Distance<Tabletop<M>>>, PlanningError> {
        Ok(named(&self.distances, ("distance", "sampling.distance"), name.as_str())?())
    }

    /// The cost of this name.
    ///
    /// # Errors
    /// [`PlanningError::Problem`] for an unknown name.
    pub fn cost(&self, name: &CostName) -> Result<Box<dyn ExecutionCost<Tabletop<M>>>, PlanningError> {
        Ok(named(&self.costs, ("cost", "cost"), name.as_str())?())
    }

    /// Checks what only a program can know of a problem: names of primitives, postures, samplers and distances, and the
    /// settings of primitives.
    ///
    /// # Errors
    /// [`ProblemFileError::Invalid`] with the key at fault, in the file called `source_name`.
    pub fn check(&self, problem: &ProblemFile, source_name: &str) -> Result<(), ProblemFileError> {
        self.flaw(problem).map_or(Ok(()), |flaw| Err(invalid(source_name, flaw)))
    }

    fn flaw(&self, problem: &ProblemFile) -> Option<Located> {
        let primitives: Vec<_> = self.primitives.iter().map(|entry| entry.id.name()).collect();
        let samplers: Vec<_> = self.samplers.iter().map(|(name, _)| *name).collect();
        let distances: Vec<_> = self.distances.iter().map(|(name, _)| *name).collect();
        let (models, postures) = (M::models(), M::posture_names(&problem.robot));
        let postures = match postures {
            Ok(postures) => postures,
            Err(error) => return Some(Flaw::Inconsistent(format!("cannot be used: {error}")).at("robot")),
        };
        let [models, postures] = [&models, &postures].map(|names| names.iter().map(String::as_str).collect::<Vec<_>>());
        names::unknown(problem, &models, &primitives, &postures, &samplers, &distances)
            .or_else(|| {
                let mut allowed = self.primitives.iter().filter(|entry| is_allowed(problem, entry.id.name()));
                allowed.find_map(|entry| (entry.build)(problem).err())
            })
            .or_else(|| crate::steer_feasibility::idle_rule(problem, self.allowed(problem)))
    }

    /// Every primitive is made of others, which must be allowed too.
    pub(crate) fn check_companions(&self, problem: &ProblemFile) -> Result<(), PlanningError> {
        for entry in self.primitives.iter().filter(|entry| is_allowed(problem, entry.id.name())) {
            if let Some(missing) = entry.needs.iter().find(|name| !is_allowed(problem, name)) {
                let (primitive, needs) = (entry.id.name().to_owned(), (*missing).to_owned());
                return Err(PlanningError::MissingPrimitive { primitive, needs });
            }
        }
        Ok(())
    }
}

fn is_allowed(problem: &ProblemFile, name: &str) -> bool {
    problem.primitives.iter().any(|allowed| allowed.as_str() == name)
}

fn invalid(source_name: &str, (key, flaw): Located) -> ProblemFileError {
    ProblemFileError::Invalid { file: source_name.to_owned(), key: shown(&key), flaw: Box::new(flaw) }
}

fn named<'a, T>(
    entries: &'a [(&'static str, T)],
    (kind, key): (&'static str, &str),
    name: &str,
) -> Result<&'a T, ProblemFileError> {
    let names: Vec<_> = entries.iter().map(|(name, _)| *name).collect();
    one_of(kind, key, name, &names).map_err(|flaw| invalid("the request", flaw))?;
    let found = entries.iter().find(|(other, _)| *other == name).map(|(_, entry)| entry);
    found.ok_or_else(|| invalid("the request", (key.to_owned(), Flaw::Inconsistent("is unknown".to_owned()))))
}

/// The settings `[primitive.NAME]`, or all defaults.
fn settings_of<S: DeserializeOwned + Default>(problem: &ProblemFile, name: &str) -> Result<S, Located> {
    let Some(table) = problem.primitive_settings.get(name) else { return Ok(S::default()) };
    serde_json::from_value(serde_json::Value::Object(table.clone())).map_err(|error| {
        let message = error.to_string();
        let hint = nearest_expected(&message).map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"));
        Flaw::Inconsistent(format!("{message}{hint}")).at(format!("primitive.{name}"))
    })
}
