//! Draws what moves: the robot, the objects and their goals.

use nalgebra::{Isometry3, Point2, Point3};
use svg::Node as _;
use svg::node::element::Element;

use super::ink::{self, Ink};
use super::outline::body_points;
use super::palette;
use super::story::{Snapshot, Story};
use super::view::{Projection, View};
use crate::problem_file::GoalTarget;

/// How much of the robot is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Detail {
    /// All of it.
    Whole,
    /// The manipulating arm below the shoulder only.
    Arm,
    /// The hand of the manipulating arm only.
    Hand,
}

/// Corners of the parts of the robot at one state, in the world.
#[derive(Debug, Clone)]
pub(super) struct Figure {
    base: Vec<Point3<f64>>,
    trunk: Vec<Vec<Point3<f64>>>,
    shoulder: Vec<Point3<f64>>,
    arm: Vec<Vec<Point3<f64>>>,
    hand: Vec<Vec<Point3<f64>>>,
}

impl Figure {
    /// The robot of `story` at `snapshot`.
    pub(super) fn new(story: &Story, snapshot: &Snapshot) -> Self {
        let poses = story.model.link_poses(&snapshot.robot);
        let points = |link: &usize| match (story.model.body(*link), poses.get(*link)) {
            (Some(body), Some(pose)) => body_points(body, pose),
            _ => Vec::new(),
        };
        let model = &story.model;
        Self {
            base: model.base_links.iter().flat_map(points).collect(),
            trunk: model.trunk_links.iter().map(points).collect(),
            shoulder: model.shoulder_links.iter().flat_map(points).collect(),
            arm: model.arm_links.iter().map(points).collect(),
            hand: model.hand_links.iter().map(points).collect(),
        }
    }

    /// All corners.
    pub(super) fn points(&self) -> impl Iterator<Item = &Point3<f64>> {
        let lists = self.trunk.iter().chain(&self.arm).chain(&self.hand);
        self.base.iter().chain(&self.shoulder).chain(lists.flatten())
    }

    /// The silhouette of the base: its footprint when seen from above.
    pub(super) fn base(&self, view: &View) -> Vec<Point2<f64>> {
        view.silhouette(&self.base)
    }

    /// Draws the robot in `colour`; `strength` from 0 (a breath) to 1.
    pub(super) fn draw(&self, view: &View, detail: Detail, colour: &str, strength: f64, group: &mut Element) {
        if detail == Detail::Whole {
            let base = Ink::filled(colour).opacity(0.16 * strength).line(colour, 0.5 + strength);
            group.append(ink::polygon(&self.base(view), &base));
            let rest: Vec<_> = self.trunk.iter().chain([&self.shoulder]).collect();
            group.append(layer(view, rest, &palette::tint(colour, 0.25), colour, 0.45 * strength));
        }
        let mut limbs: Vec<_> = self.hand.iter().collect();
        if detail != Detail::Hand {
            limbs.extend(&self.arm);
        }
        group.append(layer(view, limbs, &palette::tint(colour, 0.6), colour, strength));
    }
}

/// Parts in one layer of the given opacity, the nearest to the viewer on top.
fn layer(view: &View, mut parts: Vec<&Vec<Point3<f64>>>, fill: &str, line: &str, opacity: f64) -> Element {
    let top = |points: &[Point3<f64>]| points.iter().map(|p| view.projection.nearness(p)).fold(f64::MIN, f64::max);
    parts.sort_by(|a, b| top(a).total_cmp(&top(b)));
    let mut layer = Element::new("g");
    layer.assign("opacity", ink::rounded(opacity));
    let ink = Ink::filled(fill).line(line, 0.8);
    for part in parts {
        layer.append(ink::polygon(&view.silhouette(part), &ink));
    }
    layer
}

/// The silhouette of object `index` at a pose.
pub(super) fn object_outline(
    story: &Story,
    index: usize,
    world_from_object: &Isometry3<f64>,
    view: &View,
) -> Vec<Point2<f64>> {
    let object = story.geometry.objects.get(index);
    object.map_or_else(Vec::new, |object| view.silhouette(&body_points(&object.body, world_from_object)))
}

/// Draws all objects of a state, white with a dark line.
pub(super) fn draw_objects(story: &Story, snapshot: &Snapshot, view: &View, ink: &Ink<'_>, group: &mut Element) {
    for (index, pose) in snapshot.objects.iter().enumerate() {
        group.append(ink::polygon(&object_outline(story, index, pose, view), ink));
    }
}

/// Draws where the objects shall end: dashed outlines, and regions as dashed rectangles.
pub(super) fn draw_goals(story: &Story, view: &View, group: &mut Element) {
    let ink = Ink::filled(palette::GOAL).opacity(0.07).line(palette::GOAL, 1.6).dash("4 3");
    for outline in goal_outlines(story, view) {
        group.append(ink::polygon(&outline, &ink));
    }
}

/// The outlines of all goals that are points or regions of a surface.
fn goal_outlines(story: &Story, view: &View) -> Vec<Vec<Point2<f64>>> {
    let scene = &story.geometry.scene;
    let outline = |goal: &crate::problem_file::ObjectGoal| {
        let index = story.problem.objects.iter().position(|object| object.name == goal.object)?;
        if let Some(GoalTarget::Within { surface, region }) = goal.target() {
            let plane = scene.surface(surface)?;
            let (z, region) = (plane.height(), region.over(plane)?);
            let ([x, y], [u, v]) = (region.min, region.max);
            let corners = [[x, y], [u, y], [u, v], [x, v]].map(|[x, y]| Point3::new(x, y, z));
            return Some(view.silhouette(&corners));
        }
        let pose = story.geometry.objects.get(index)?.world_from_goal(goal, scene)?;
        Some(object_outline(story, index, &pose, view))
    };
    story.problem.goal.objects.iter().filter_map(outline).collect()
}

/// Corners of all goals, for windows that shall show them.
pub(super) fn goal_points(story: &Story, projection: Projection) -> Vec<Point2<f64>> {
    // In a view of scale 1 the page is the flat world turned upside down.
    let window = super::view::Window { low: Point2::origin(), high: Point2::origin() };
    let view = View { projection, window, scale: 1.0 };
    goal_outlines(story, &view).into_iter().flatten().map(|p| Point2::new(p.x, -p.y)).collect()
}
