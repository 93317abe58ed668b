//! The robot, the room and the objects as data.

use darrt_geom::Body;
use darrt_primitives::kinematics::tree::{Drive, LinkMotion};
use darrt_primitives::kinematics::urdf::{JointDescription, JointKind};
use darrt_primitives::kinematics::{KinematicTree, MeshPlaces, RobotDescription, link_bodies};

use super::ViewerError;
use super::data::{
    self, BodyData, JointData, JointKindData, LinkData, ObjectData, RegionData, RobotData, SurfaceData, VariableData,
    rounded,
};
use super::meshes;
use crate::plan_file::JointTable;
use crate::plan_file::tool::tool_links;
use crate::problem_file::geometry::Geometry;
use crate::problem_file::{GoalTarget, ProblemFile};
use crate::robot::RobotFacts;

/// A robot as the viewer needs it: a tree of links with what they occupy. Nothing here knows which robot it is.
#[derive(Debug)]
pub struct RobotModel {
    name: String,
    pub(super) tree: KinematicTree,
    table: JointTable,
    /// By link.
    pub(super) bodies: Vec<Option<Body>>,
    /// By hand, at least one.
    tools: Vec<usize>,
    /// By variable: does the joint slide?
    slides: Vec<bool>,
}

impl RobotModel {
    /// The robot of a description whose meshes lie at `meshes`; what it holds is rigid to the link `tool`.
    ///
    /// # Errors
    /// When the description is no tree, geometry cannot be used, or there is no such link.
    pub fn new(description: &RobotDescription, meshes: &MeshPlaces, tool: &str) -> Result<Self, ViewerError> {
        let tree = KinematicTree::new(description)?;
        let bodies = link_bodies(description, &tree, &meshes.paths())?;
        let tools = vec![link_called(&tree, tool)?];
        let is_sliding = |joint: &JointDescription| joint.kind == JointKind::Sliding;
        let slides = tree.variables().iter().map(|variable| {
            description.joints.iter().find(|joint| joint.name == variable.name).is_some_and(is_sliding)
        });
        let slides = slides.collect();
        Ok(Self {
            name: description.name.clone(),
            table: JointTable::new(description, &tree),
            tree,
            bodies,
            tools,
            slides,
        })
    }

    /// The robot of these facts.
    ///
    /// # Errors
    /// As [`RobotModel::new`].
    pub fn of(facts: &RobotFacts) -> Result<Self, ViewerError> {
        let mut robot = Self::new(&facts.description, &facts.meshes, &facts.tool_link)?;
        for tool in tool_links(facts).into_iter().skip(1) {
            robot.tools.push(link_called(&robot.tree, tool)?);
        }
        Ok(robot)
    }

    /// The link to which what a hand holds is rigid; hands are counted from 0.
    pub(super) fn tool(&self, hand: usize) -> usize {
        self.tools.get(hand).copied().unwrap_or_default()
    }

    /// Their names, by hand.
    pub(super) fn tool_names(&self) -> Vec<&str> {
        self.tools.iter().filter_map(|tool| self.tree.link_names().get(*tool)).map(|name| &**name).collect()
    }

    /// The joints that a waypoint lists.
    pub fn table(&self) -> &JointTable {
        &self.table
    }

    /// Its links and joints as data.
    pub(super) fn data(&self) -> RobotData {
        let links = (0..self.tree.link_count()).zip(self.tree.link_names());
        let variables = self.tree.variables().iter().zip(&self.slides).map(|(variable, slides)| VariableData {
            name: variable.name.to_string(),
            kind: if *slides { JointKindData::Sliding } else { JointKindData::Turning },
            limits: bounded([variable.limit.lower, variable.limit.upper]),
        });
        RobotData {
            name: self.name.clone(),
            links: links.map(|(link, name)| self.link(link, name)).collect(),
            variables: variables.collect(),
            tool: self.tool(0),
            tools: if self.tools.len() > 1 { self.tools.clone() } else { Vec::new() },
        }
    }

    fn link(&self, link: usize, name: &str) -> LinkData {
        let joint = |kind, axis: [f64; 3], drive: &Drive| JointData {
            kind,
            axis: axis.map(|value| data::to(value, 1e9)),
            variable: drive.variable,
            multiplier: drive.multiplier,
            offset: drive.offset,
        };
        LinkData {
            name: name.to_owned(),
            parent: self.tree.parent(link),
            pose: data::pose(&self.tree.parent_from_link(link).copied().unwrap_or_default()),
            joint: match self.tree.motion(link) {
                Some(LinkMotion::Turning { axis, drive }) => {
                    Some(joint(JointKindData::Turning, axis.into_inner().into(), drive))
                }
                Some(LinkMotion::Sliding { axis, drive }) => {
                    Some(joint(JointKindData::Sliding, axis.into_inner().into(), drive))
                }
                Some(LinkMotion::Fixed) | None => None,
            },
            parts: self.bodies.get(link).and_then(Option::as_ref).map(meshes::parts).unwrap_or_default(),
        }
    }

    /// Is this link rigid to the root?
    pub(super) fn is_rigid_to_root(&self, mut link: usize) -> bool {
        while let Some(parent) = self.tree.parent(link) {
            if !matches!(self.tree.motion(link), Some(LinkMotion::Fixed)) {
                return false;
            }
            link = parent;
        }
        true
    }
}

fn link_called(tree: &KinematicTree, name: &str) -> Result<usize, ViewerError> {
    tree.link_index(name).ok_or_else(|| ViewerError::NoLink { name: name.to_owned() })
}

/// JSON knows no infinity.
fn bounded(limits: [f64; 2]) -> Option<[f64; 2]> {
    limits.iter().all(|limit| limit.is_finite()).then(|| limits.map(rounded))
}

/// What does not move, but for the floor.
pub(super) fn bodies(problem: &ProblemFile, geometry: &Geometry) -> Vec<BodyData> {
    let obstacles = problem.obstacles.iter().zip(geometry.scene.bodies()).enumerate();
    let body =
        |(index, (obstacle, fixed)): (usize, (&crate::problem_file::Obstacle, &darrt_geom::FixedBody))| BodyData {
            name: obstacle.name.clone(),
            pose: data::pose(&fixed.world_from_body),
            carries: geometry.carriers.contains(&Some(index)),
            parts: meshes::parts_of(&obstacle.shape, &fixed.body),
        };
    obstacles.map(body).collect()
}

/// What things stand on.
pub(super) fn surfaces(geometry: &Geometry) -> Vec<SurfaceData> {
    let surfaces = geometry.scene.surfaces().iter();
    let surface = surfaces.map(|surface| SurfaceData {
        name: surface.name().to_owned(),
        z: rounded(surface.height()),
        corners: surface.vertices().map(|corner| [corner.x, corner.y].map(rounded)).collect(),
    });
    surface.collect()
}

/// What can be moved, and where it shall end.
pub(super) fn objects(problem: &ProblemFile, geometry: &Geometry) -> Vec<ObjectData> {
    let objects = problem.objects.iter().zip(&geometry.objects).map(|(object, solid)| {
        let own = || problem.goal.objects.iter().filter(|goal| goal.object == object.name);
        let region = |goal: &crate::problem_file::ObjectGoal| match goal.target()? {
            GoalTarget::Within { surface, region } => Some(RegionData {
                min: region.min.map(rounded),
                max: region.max.map(rounded),
                z: rounded(geometry.scene.surface(surface)?.height()),
            }),
            GoalTarget::On { .. } | GoalTarget::At { .. } => None,
        };
        ObjectData {
            name: object.name.clone(),
            parts: meshes::parts_of(&object.shape, &solid.body),
            goals: own()
                .filter_map(|goal| solid.world_from_goal(goal, &geometry.scene))
                .map(|pose| data::pose(&pose))
                .collect(),
            regions: own().filter_map(region).collect(),
        }
    });
    objects.collect()
}
