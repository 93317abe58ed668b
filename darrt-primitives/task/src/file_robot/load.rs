//! From a robot file to the robot.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use darrt_geom::Body;
use darrt_primitives::hand_ties::HandTies;
use darrt_primitives::joints::Joints;
use darrt_primitives::kinematics::{JointLimit, KinematicTree, MeshPlaces, RobotDescription, UrdfError, link_bodies};
use darrt_primitives::manipulator::{JointVector as _, LinkGroup, Manipulator as _, RobotLink};
use nalgebra::{Isometry3, Point3, Vector3};

use super::arm::PlannedArm;
use super::chain::{ArmChain, Driver, Fingers, Place};
use super::semantic::Semantic;
use super::skeleton::Skeleton;
use super::ties::ties;
use super::travel::{Levers, corners};
use super::{FileRobot, Speeds, pairs, shipped};
use crate::problem_file::Limits;
use crate::problem_file::Robot as RobotSettings;
use crate::problem_file::suggest::{hint, nearest};
use crate::robot_file::error::Fault;
use crate::robot_file::{Amended, AmendedArm, ArmTables, BaseKind, RobotFileError, Source, amend};

/// So far a wheel may press into the floor, metres: as far as the verifier lets it.
const FLOOR_M: f64 = 1e-3;
/// So far above the floor is what moves over it, metres: twice the least margin, for nothing is planned nearer.
pub(super) const ABOVE_FLOOR_M: f64 = 0.01;
/// Share of a joint's speed limit that a robot is planned with where its file does not say.
const SPEED_SHARE: f64 = 0.5;
/// The speed of a joint that nobody limits, radians or metres per second.
const UNKNOWN_SPEED: f64 = 1.0;
/// What a unit of a joint counts at least, metres of the hand.
const LEAST_WEIGHT_M: f64 = 0.05;
/// Share of the farthest that a joint can move the hand which it moves it in a bent posture.
const BENT: f64 = 0.5;

/// The robot file that the table `[robot]` names, and the description if that is inside too.
pub(super) fn source(settings: &RobotSettings) -> Result<(Source, Option<&'static str>), RobotFileError> {
    match (&settings.file, &settings.model) {
        (Some(path), _) => Ok((Source::read(path)?, None)),
        (None, model) => {
            let robot = shipped::find(model.as_deref().unwrap_or_default())?;
            Ok((Source::from_text(robot.text, robot.name)?, Some(robot.urdf)))
        }
    }
}

/// The tree of a robot and the shape of every link.
type Solids = (KinematicTree, Vec<Option<Body>>);

/// A robot file with its description, read and completed.
#[derive(Debug, Clone)]
pub(super) struct Loaded {
    pub(super) source: Source,
    pub(super) amended: Amended,
    pub(super) meshes: MeshPlaces,
    pub(super) semantic: Option<Semantic>,
    /// Read when it is first asked for.
    solids: OnceLock<Solids>,
}

impl Loaded {
    /// The robot that the table `[robot]` names.
    pub(super) fn of(settings: &RobotSettings) -> Result<Self, RobotFileError> {
        let (source, urdf) = source(settings)?;
        Self::new(source, urdf)
    }

    /// Reads the description, unless this is its text, and completes it.
    pub(super) fn new(source: Source, urdf: Option<&str>) -> Result<Self, RobotFileError> {
        let path = source.urdf();
        let description = match urdf {
            Some(text) => RobotDescription::from_text(text),
            None => RobotDescription::from_file(&path),
        };
        let wrong = |source_error| RobotFileError::Description { file: source.name.clone(), source: source_error };
        let description = description.map_err(wrong)?;
        description.check_shapes(&source.file.shapeless).map_err(|error| {
            source.located(Fault::new("shapeless", format!("does not fit the description: {error}")))
        })?;
        let semantic = Semantic::of(&source, &description)?;
        let meshes = if urdf.is_some() { MeshPlaces::default() } else { source.meshes() };
        let amended = amend(&source.file, description, &meshes.paths()).map_err(|fault| source.located(fault))?;
        Ok(Self { source, amended, meshes, semantic, solids: OnceLock::new() })
    }

    /// Tree and shapes.
    pub(super) fn solids(&self) -> Result<&Solids, RobotFileError> {
        if let Some(known) = self.solids.get() {
            return Ok(known);
        }
        let tree = self.tree()?;
        let bodies = link_bodies(&self.amended.description, &tree, &self.meshes.paths());
        let bodies = bodies.map_err(|source| self.wrong(source))?;
        Ok(self.solids.get_or_init(|| (tree, bodies)))
    }

    fn tree(&self) -> Result<KinematicTree, RobotFileError> {
        KinematicTree::new(&self.amended.description).map_err(|source| self.wrong(source))
    }

    /// Something is wrong with the description.
    fn wrong(&self, source: UrdfError) -> RobotFileError {
        RobotFileError::Description { file: self.source.name.clone(), source }
    }

    /// What moves the variables of the tree.
    fn drivers(&self, tree: &KinematicTree) -> Option<Vec<Driver>> {
        let mut drivers: Vec<_> = tree.variables().iter().map(|v| Driver::Rests(v.limit.clamp(0.0))).collect();
        for (name, value) in &self.amended.rest {
            *drivers.get_mut(tree.variable_index(name)?)? = Driver::Rests(*value);
        }
        for (hand, tables) in self.source.file.arms().enumerate() {
            *drivers.get_mut(tree.variable_index(&tables.gripper.joint)?)? = Driver::Finger(hand);
        }
        for (index, name) in self.amended.arm_joints.iter().enumerate() {
            *drivers.get_mut(tree.variable_index(name)?)? = Driver::Arm(index);
        }
        Some(drivers)
    }

    /// The same with no pair of links left out: what the laws of robots are about.
    pub(super) fn with_all_pairs(&self) -> Self {
        let mut all = Self { semantic: None, ..self.clone() };
        all.source.file.ignore.clear();
        all
    }

    /// The robot, its base at `base`.
    pub(super) fn robot(&self, kind: Limits, base: [f64; 3]) -> Result<FileRobot, RobotFileError> {
        self.built(kind, base, true)
    }

    /// What the joints of its arms do not change of their hands. Reads no meshes.
    pub(super) fn hand_ties(&self) -> Result<Vec<HandTies>, RobotFileError> {
        let tree = &self.tree()?;
        let no_layout = || self.source.located(Fault::new("arm", "does not fit the description"));
        let drivers = self.drivers(tree).ok_or_else(no_layout)?;
        let of_arm = |arm: &AmendedArm| {
            let layout = Self::layout(tree, &drivers, arm)?;
            Some(ties(&layout.chain(tree.link_index(&arm.tool_link)?)?))
        };
        self.amended.arms().map(of_arm).collect::<Option<_>>().ok_or_else(no_layout)
    }

    /// The robot wherever its lowest point may be.
    pub(super) fn robot_anywhere(&self) -> Result<FileRobot, RobotFileError> {
        self.built(Limits::Soft, [0.0; 3], false)
    }

    fn built(&self, kind: Limits, base: [f64; 3], is_placed: bool) -> Result<FileRobot, RobotFileError> {
        let (tree, bodies) = self.solids()?;
        let no_layout = || self.source.located(Fault::new("arm", "does not fit the description"));
        let drivers = self.drivers(tree).ok_or_else(no_layout)?;
        let file = &self.source.file;
        let first = self.skeleton((tree, &drivers), (file.first_arm(), &self.amended.first), kind)?;
        let second = file.second_arm().zip(self.amended.second.as_ref());
        let second = second.map(|of| self.skeleton((tree, &drivers), of, kind)).transpose()?;
        let mut limits = vec![JointLimit::UNLIMITED; self.amended.arm_joints.len()];
        for skeleton in std::iter::once(&first).chain(&second) {
            for (joint, limit) in skeleton.own.indices().zip(skeleton.inverse.limits()) {
                *limits.get_mut(joint).ok_or_else(no_layout)? = *limit;
            }
        }
        let mut links = Vec::new();
        let mut places = Vec::new();
        let mut owners = Vec::new();
        let mut numbers = Vec::new();
        for (link, body) in bodies.iter().enumerate() {
            let Some(body) = body else { continue };
            let place = first.layout.place(link).ok_or_else(no_layout)?;
            // What the second arm alone moves is its own.
            let (owner, skeleton, place) = match &second {
                Some(second) if is_of_second(&place, self.amended.first.joints.len()) => {
                    (1, second, second.layout.place(link).ok_or_else(no_layout)?)
                }
                _ => (0, &first, place),
            };
            links.push(RobotLink { body: body.clone(), group: group(&place, skeleton.chain.joints.len(), owner) });
            places.push(place);
            owners.push(owner);
            numbers.push(link);
        }
        if is_placed {
            self.check_floor(&first.chain, &links, &places)?;
        }
        let finger = |of: ArmTables<'_>| {
            let variable = tree.variable_index(&of.gripper.joint).and_then(|index| tree.variables().get(index));
            variable.map_or(JointLimit::UNLIMITED, |v| v.limit)
        };
        let fingers = [finger(file.first_arm()), file.second_arm().map_or(JointLimit::UNLIMITED, finger)];
        let carrier = |owner: usize| second.as_ref().filter(|_| owner == 1).unwrap_or(&first).carrier(&limits, fingers);
        let levers = places.iter().zip(&links).zip(&owners);
        let levers: Vec<_> =
            levers.map(|((place, link), owner)| Levers::new(&carrier(*owner), place, &corners(&link.body))).collect();
        let tool_levers = |skeleton: &Skeleton<'_>| {
            let chain = &skeleton.chain;
            let at_tool = Place { anchor: chain.joints.len(), steps: Vec::new(), offset: chain.wrist_from_tool };
            Levers::new(&skeleton.carrier(&limits, fingers), &at_tool, &[Point3::origin()])
        };
        let of_tools = (tool_levers(&first), second.as_ref().map(tool_levers));
        let farthest = |(joint, lever): (usize, &f64)| {
            let other = of_tools.1.as_ref().and_then(|levers| levers.arm.get(joint));
            other.map_or(*lever, |other| lever.max(*other))
        };
        let weights_m = of_tools.0.arm.iter().enumerate().map(farthest);
        let weights_m = weights_m.map(|lever| (BENT * lever).max(LEAST_WEIGHT_M)).collect();
        let base = (!file.base.kind.drives()).then_some(base);
        let first = self.arm(first, of_tools.0, bodies, base)?;
        let second =
            second.zip(of_tools.1).map(|(second, levers)| self.arm(second, levers, bodies, base)).transpose()?;
        let semantic = self.semantic.as_ref();
        let self_pairs = pairs::pairs((&self.source, semantic), tree, &numbers, (&places, &owners), &links)?;
        let speeds = self.speeds(tree)?;
        let postures = self.postures(&limits)?;
        let at_home = self.home(&postures)?;
        let least = |of: fn(&PlannedArm) -> f64| second.iter().map(of).fold(of(&first), f64::min);
        let mut robot = FileRobot {
            base_kind: file.base.kind,
            payload_kg: least(|arm| arm.payload_kg),
            push_force_n: least(|arm| arm.push_force_n),
            first,
            second,
            links,
            places,
            owners,
            levers,
            self_pairs,
            drivers,
            idle: Fingers::default(),
            speeds,
            weights_m,
            limits,
            postures,
            home: file.home.clone(),
            at_home,
        };
        let idle_m = robot.idle_gap_m();
        for (slot, arm) in robot.idle.iter_mut().zip(std::iter::once(&robot.first).chain(&robot.second)) {
            *slot = arm.hand.opening.joint(idle_m);
        }
        Ok(robot)
    }

    /// What is rigid to the base stands on the floor, not in it; what a rail carries moves above it.
    fn check_floor(&self, chain: &ArmChain, links: &[RobotLink], places: &[Place]) -> Result<(), RobotFileError> {
        if self.source.file.base.kind == BaseKind::Rail
            && let Some(rail) = chain.joints.first()
        {
            let carried = links.iter().zip(places).filter(|(_, place)| place.anchor == 1 && place.steps.is_empty());
            for (link, place) in carried {
                let lowest_m = lowest_m(&link.body, &(rail.before * place.offset));
                if lowest_m < ABOVE_FLOOR_M {
                    let why = format!(
                        "puts `{}`, which the rail carries, {:.1} mm above the floor, must be {:.0} mm above it: raise its z",
                        link.body.name,
                        1e3 * lowest_m,
                        1e3 * ABOVE_FLOOR_M
                    );
                    return Err(self.source.located(Fault::new("base.xyz", why)));
                }
            }
        }
        let rigid = links.iter().zip(places).filter(|(link, _)| link.group == LinkGroup::Base);
        for (link, place) in rigid {
            let lowest_m = lowest_m(&link.body, &place.offset);
            if lowest_m < -FLOOR_M {
                let why = format!(
                    "puts `{}` {:.1} mm into the floor: raise its z by so much",
                    link.body.name,
                    -1e3 * lowest_m
                );
                return Err(self.source.located(Fault::new("base.xyz", why)));
            }
        }
        Ok(())
    }

    fn speeds(&self, tree: &KinematicTree) -> Result<Speeds, RobotFileError> {
        let allowed = |name: &String| {
            let variable = tree.variable_index(name).and_then(|index| tree.variables().get(index));
            let most = variable.map_or(0.0, |v| v.max_velocity);
            if most > 0.0 { SPEED_SHARE * most } else { UNKNOWN_SPEED }
        };
        let mut joints = Vec::new();
        for (tables, amended) in self.source.file.arms().zip(self.amended.arms()) {
            let count = amended.joints.len();
            let arm = tables.arm;
            for (key, list) in [("arm.speeds", &arm.speeds), ("arm.accelerations", &arm.accelerations)] {
                if let Some(list) = list.as_ref().filter(|list| list.len() != count) {
                    let why = format!("has {} entries, must have {count}, one for each joint of the arm", list.len());
                    return Err(self.source.located(Fault::new(tables.key(key), why)));
                }
            }
            let speeds = arm.speeds.clone().unwrap_or_else(|| amended.joints.iter().map(allowed).collect());
            // A joint of both arms moves as the first says.
            let shared = self.amended.arm_joints.get(..joints.len()).unwrap_or_default();
            let new = amended.joints.iter().zip(speeds).filter(|(name, _)| !shared.contains(name));
            let new: Vec<f64> = new.map(|(_, speed)| speed).collect();
            joints.extend(new);
        }
        let base = &self.source.file.base;
        Ok(Speeds { joints, base: [base.speed, base.loaded_speed] })
    }

    /// The postures of the file, each with as many joints as the robot.
    fn postures(&self, limits: &[JointLimit]) -> Result<BTreeMap<String, Joints>, RobotFileError> {
        let file = &self.source.file;
        let mut postures = BTreeMap::new();
        let whose = if file.second.is_some() { "both arms" } else { "the arm" };
        for (name, values) in &file.postures {
            let refuse = |why: String| self.source.located(Fault::new(format!("postures.{name}"), why));
            let count = limits.len();
            let joints = Joints::from_values(values).filter(|_| values.len() == count);
            let joints = joints.ok_or_else(|| {
                refuse(format!("has {} entries, must have {count}, one for each joint of {whose}", values.len()))
            })?;
            let names = values.iter().zip(limits).zip(&self.amended.arm_joints);
            for ((value, limit), joint) in names {
                if !(value.is_finite() && limit.contains(*value)) {
                    let [low, high] = [limit.lower, limit.upper];
                    return Err(refuse(format!("has {value} for `{joint}`, which must be in [{low}, {high}]")));
                }
            }
            postures.insert(name.clone(), joints);
        }
        Ok(postures)
    }

    /// The posture in which the robot starts.
    fn home(&self, postures: &BTreeMap<String, Joints>) -> Result<Joints, RobotFileError> {
        let home = &self.source.file.home;
        postures.get(home).copied().ok_or_else(|| {
            let near = nearest(home, postures.keys().map(String::as_str)).map(str::to_owned);
            let why = format!("names the posture `{home}`, which is not among `postures`{}", hint(near.as_deref()));
            self.source.located(Fault::new("home", why))
        })
    }
}

/// The height of a body's lowest point, metres.
pub(super) fn lowest_m(body: &Body, world_from_body: &Isometry3<f64>) -> f64 {
    let parts = body.parts.iter().map(|part| {
        let at = world_from_body * part.body_from_shape;
        at.translation.z - part.shape.support_extent(&(at.rotation.inverse() * -Vector3::z()))
    });
    parts.fold(f64::INFINITY, f64::min)
}

/// Does the second hand, or a joint that is not among those of the first arm, which has so many, move a link? The place is that which
/// the link has for the first arm.
fn is_of_second(place: &Place, first: usize) -> bool {
    place.steps.iter().any(|step| match step.driver {
        Driver::Arm(joint) => joint >= first,
        Driver::Finger(hand) => hand == 1,
        Driver::Rests(_) => false,
    })
}

/// What carries a link of this arm along.
fn group(place: &Place, joints: usize, arm: usize) -> LinkGroup {
    let is_finger = place.steps.iter().any(|step| step.driver == Driver::Finger(arm));
    match place.anchor {
        _ if is_finger => LinkGroup::Finger,
        _ if !place.steps.is_empty() => LinkGroup::Arm,
        0 => LinkGroup::Base,
        anchor if anchor == joints => LinkGroup::Hand,
        _ => LinkGroup::Arm,
    }
}
