//! From a robot file to the robot.

use std::sync::OnceLock;

use darrt_geom::{Body, Shape};
use darrt_primitives::hand_ties::HandTies;
use darrt_primitives::joints::Joints;
use darrt_primitives::kinematics::{
    JointLimit, KinematicTree, KinematicsError, MeshPlaces, RobotDescription, UrdfError, link_bodies,
};
use darrt_primitives::manipulator::{JointVector as _, LinkGroup, RobotLink};
use nalgebra::{Isometry3, Point3, Vector3};

use super::bases::Ring;
use super::chain::{ArmChain, Driver, Layout, Place};
use super::few_joints::FewJoints;
use super::inverse::Inverse;
use super::opening::{Law, Opening};
use super::semantic::Semantic;
use super::ties::ties;
use super::travel::{Levers, corners};
use super::{FileRobot, ParallelHand, Speeds, pairs, shipped};
use crate::problem_file::Limits;
use crate::problem_file::Robot as RobotSettings;
use crate::robot_file::error::Fault;
use crate::robot_file::{Amended, BaseKind, RobotFileError, Source, amend};

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

    /// The tree's variables at rest, the hand open.
    fn layout<'a>(&self, tree: &'a KinematicTree) -> Option<(Layout<'a>, usize)> {
        let finger = tree.variable_index(&self.source.file.gripper.joint)?;
        let mut drivers: Vec<_> = tree.variables().iter().map(|v| Driver::Rests(v.limit.clamp(0.0))).collect();
        for (name, value) in &self.amended.rest {
            *drivers.get_mut(tree.variable_index(name)?)? = Driver::Rests(*value);
        }
        *drivers.get_mut(finger)? = Driver::Finger;
        let mut arm_links = Vec::new();
        for (index, name) in self.amended.arm_joints.iter().enumerate() {
            let variable = tree.variable_index(name)?;
            *drivers.get_mut(variable)? = Driver::Arm(index);
            arm_links.push(tree.variables().get(variable)?.link);
        }
        Some((Layout { tree, drivers, arm_links }, finger))
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

    /// What the joints of the arm do not change of its hand. Reads no meshes.
    pub(super) fn hand_ties(&self) -> Result<HandTies, RobotFileError> {
        let tree = &self.tree()?;
        let chain = self.layout(tree).zip(tree.link_index(&self.amended.tool_link));
        let chain = chain.and_then(|((layout, _), tool)| layout.chain(tool));
        let no_layout = || self.source.located(Fault::new("arm", "does not fit the description"));
        Ok(ties(&chain.ok_or_else(no_layout)?))
    }

    /// The robot wherever its lowest point may be.
    pub(super) fn robot_anywhere(&self) -> Result<FileRobot, RobotFileError> {
        self.built(Limits::Soft, [0.0; 3], false)
    }

    fn built(&self, kind: Limits, base: [f64; 3], is_placed: bool) -> Result<FileRobot, RobotFileError> {
        let (tree, bodies) = self.solids()?;
        let at = |key: &str, why: &str| self.source.located(Fault::new(key, why));
        let no_layout = || at("arm", "does not fit the description");
        let (layout, finger) = self.layout(tree).ok_or_else(no_layout)?;
        let tool = tree.link_index(&self.amended.tool_link).ok_or_else(no_layout)?;
        let chain = layout.chain(tool).ok_or_else(no_layout)?;
        let unsolvable = |error: KinematicsError| at("arm.to", &format!("cannot be used: {error}"));
        let inverse = Inverse::new(tree, &self.amended, &layout, kind).map_err(unsolvable)?;
        let limits = inverse.limits().to_vec();
        let mut links = Vec::new();
        let mut places = Vec::new();
        let mut numbers = Vec::new();
        for (link, body) in bodies.iter().enumerate() {
            let Some(body) = body else { continue };
            let place = layout.place(link).ok_or_else(no_layout)?;
            links.push(RobotLink { body: body.clone(), group: group(&place, chain.joints.len()) });
            places.push(place);
            numbers.push(link);
        }
        if is_placed {
            self.check_floor(&chain, &links, &places)?;
        }
        let hand = self.hand(&layout, bodies, tool, finger)?;
        let finger_limit = tree.variables().get(finger).map_or(JointLimit::UNLIMITED, |v| v.limit);
        let levers_at =
            |place: &Place, corners: &[Point3<f64>]| Levers::new(&chain, &limits, place, finger_limit, corners);
        let levers: Vec<_> =
            places.iter().zip(&links).map(|(place, link)| levers_at(place, &corners(&link.body))).collect();
        let at_tool = Place { anchor: chain.joints.len(), steps: Vec::new(), offset: chain.wrist_from_tool };
        let tool_levers = levers_at(&at_tool, &[Point3::origin()]);
        let weights_m = tool_levers.arm.iter().map(|lever| (BENT * lever).max(LEAST_WEIGHT_M)).collect();
        let self_pairs = pairs::pairs((&self.source, self.semantic.as_ref()), tree, &numbers, &places, &links)?;
        let drives = self.source.file.base.kind.drives();
        let ring = Ring::new(&chain, &limits, (!drives).then_some(base));
        let speeds = self.speeds(tree, &layout)?;
        let postures = self.postures(&limits)?;
        let file = &self.source.file;
        Ok(FileRobot {
            base_kind: file.base.kind,
            hand,
            links,
            places,
            levers,
            tool_levers,
            self_pairs,
            inverse,
            ring,
            few: FewJoints::new(&chain, &limits).map_err(unsolvable)?,
            ties: ties(&chain),
            speeds,
            weights_m,
            limits,
            chain,
            payload_kg: file.arm.payload_kg,
            push_force_n: file.arm.push_force_n,
            postures,
            home: file.home.clone(),
        })
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

    /// The opening of the hand, from where the pads are.
    fn hand(
        &self,
        layout: &Layout<'_>,
        bodies: &[Option<Body>],
        tool: usize,
        finger: usize,
    ) -> Result<ParallelHand, RobotFileError> {
        let gripper = &self.source.file.gripper;
        let refuse = |why: &str| self.source.located(Fault::new("gripper.joint", why));
        let lost = || refuse("does not move the tips");
        let limit = layout.tree.variables().get(finger).ok_or_else(lost)?.limit;
        let tip = |name: &String| {
            let link = layout.tree.link_index(name)?;
            let part = bodies.get(link)?.as_ref()?.parts.first()?;
            let Shape::Cuboid { half_extents, .. } = &part.shape else { return None };
            Some((layout.place(link)?, part.body_from_shape, *half_extents))
        };
        let [Some(left), Some(right)] = [&self.amended.tip_links[0], &self.amended.tip_links[1]].map(tip) else {
            return Err(lost());
        };
        let wrist_from_tool = layout.place(tool).ok_or_else(lost)?.in_anchor(&[], 0.0);
        let centre = |(place, link_from_box, _): &(Place, Isometry3<f64>, _), q: f64| {
            wrist_from_tool.inverse() * (place.in_anchor(&[], q) * link_from_box * Point3::origin())
        };
        let gap = |q: f64| centre(&left, q).y - left.2.y - (centre(&right, q).y + right.2.y);
        let end = |q: f64| centre(&left, q).x + left.2.x;
        let range = [limit.lower, limit.upper];
        let turns: Vec<f64> = left.0.steps.iter().map(|step| step.multiplier.abs()).collect();
        let no_law = || {
            refuse(
                "opens the pads neither in proportion to its value nor to a sine of it; such hands are not planned with",
            )
        };
        let (gap, end) = Law::of(gap, range, &turns).zip(Law::of(end, range, &turns)).ok_or_else(no_law)?;
        let opening = Opening::new(gap, end, range, gripper.max_gap_m)
            .ok_or_else(|| refuse("does not open the pads further and further, or not at all, between its limits"))?;
        Ok(ParallelHand {
            opening,
            tip_half_width_m: left.2.z,
            pad_length_m: gripper.pad_length_m.min(2.0 * left.2.x),
            grip_force_n: gripper.grip_force_n,
        })
    }

    fn speeds(&self, tree: &KinematicTree, layout: &Layout<'_>) -> Result<Speeds, RobotFileError> {
        let file = &self.source.file;
        let count = layout.arm_links.len();
        for (key, list) in [("arm.speeds", &file.arm.speeds), ("arm.accelerations", &file.arm.accelerations)] {
            if let Some(list) = list.as_ref().filter(|list| list.len() != count) {
                let why = format!("has {} entries, must have {count}, one for each joint of the arm", list.len());
                return Err(self.source.located(Fault::new(key, why)));
            }
        }
        let allowed = |name: &String| {
            let variable = tree.variable_index(name).and_then(|index| tree.variables().get(index));
            let most = variable.map_or(0.0, |v| v.max_velocity);
            if most > 0.0 { SPEED_SHARE * most } else { UNKNOWN_SPEED }
        };
        let joints = file.arm.speeds.clone().unwrap_or_else(|| self.amended.arm_joints.iter().map(allowed).collect());
        Ok(Speeds { joints, base: [file.base.speed, file.base.loaded_speed] })
    }

    /// The postures of the file, each with as many joints as the arm.
    fn postures(&self, limits: &[JointLimit]) -> Result<std::collections::BTreeMap<String, Joints>, RobotFileError> {
        let file = &self.source.file;
        let mut postures = std::collections::BTreeMap::new();
        for (name, values) in &file.postures {
            let refuse = |why: String| self.source.located(Fault::new(format!("postures.{name}"), why));
            let count = limits.len();
            let joints = Joints::from_values(values).filter(|_| values.len() == count);
            let joints = joints.ok_or_else(|| {
                refuse(format!("has {} entries, must have {count}, one for each joint of the arm", values.len()))
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
        if !postures.contains_key(&file.home) {
            let known = postures.keys().map(String::as_str);
            let near = crate::problem_file::suggest::nearest(&file.home, known).map(str::to_owned);
            let hint = crate::problem_file::suggest::hint(near.as_deref());
            let why = format!("names the posture `{}`, which is not among `postures`{hint}", file.home);
            return Err(self.source.located(Fault::new("home", why)));
        }
        Ok(postures)
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

/// What carries a link along.
fn group(place: &Place, joints: usize) -> LinkGroup {
    let is_finger = place.steps.iter().any(|step| step.driver == Driver::Finger);
    match place.anchor {
        _ if is_finger => LinkGroup::Finger,
        _ if !place.steps.is_empty() => LinkGroup::Arm,
        0 => LinkGroup::Base,
        anchor if anchor == joints => LinkGroup::Hand,
        _ => LinkGroup::Arm,
    }
}
