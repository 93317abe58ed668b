//! Draws the ways of the objects and the key states of the robot into a view.

use nalgebra::Point2;
use svg::Node as _;
use svg::node::element::Element;

use super::act::Act;
use super::badge::Badges;
use super::figure::{Detail, Figure, object_outline};
use super::ink::{self, Ink};
use super::palette;
use super::panel::push_arrow;
use super::story::{Story, StoryStep};
use super::view::{Projection, View};

/// Base poses nearer than this (m, rad) are drawn once.
const SAME_BASE: f64 = 0.01;
/// How strongly the robot is drawn after a transit.
const PALE: f64 = 0.3;
/// A drawn way leaves out points nearer to the last one than this, page units.
const FINE: f64 = 0.4;

/// Key states that share a pose of the base, and the numbers of their steps from 1; ways of the empty arm are not counted.
#[derive(Debug, Clone)]
struct Stop {
    /// The steps that end here.
    numbers: Vec<(usize, Act)>,
    /// The robot at the end of the first of them.
    figure: Figure,
    base: [f64; 3],
}

/// The key states, the end of each step, gathered by base pose; in order of first visit.
fn stops(story: &Story) -> Vec<Stop> {
    let mut stops: Vec<Stop> = Vec::new();
    let counted = |step: &StoryStep| moves_base(step) || strength(step.act) > PALE;
    for (index, step) in story.drawn_steps().filter(|(_, step)| counted(step)) {
        let base = story.end_of(index).robot.base;
        let entry = (story.telling(index).last, step.act);
        let same = |stop: &&mut Stop| stop.base.iter().zip(base).all(|(a, b)| (a - b).abs() < SAME_BASE);
        match stops.iter_mut().find(same) {
            Some(stop) => stop.numbers.push(entry),
            None => {
                stops.push(Stop { numbers: vec![entry], figure: Figure::new(story, story.end_of(index)), base });
            }
        }
    }
    stops
}

/// Draws the robot at its start in grey, and at every key state in the colour of its primitive.
pub(super) fn draw_robots(story: &Story, view: &View, group: &mut Element) {
    let strength = if story.steps.is_empty() { 1.0 } else { 0.6 };
    Figure::new(story, &story.start).draw(view, Detail::Whole, palette::ROBOT, strength, group);
    // What only moves the robot lies below and is paler, what changes the object's state is on top.
    for strength in [PALE, 0.4, 0.75] {
        for (index, step) in story.drawn_steps() {
            if self::strength(step.act) != strength {
                continue;
            }
            let mut drawn = ink::group(&format!("step {}: {}", story.telling(index).label(), step.primitive));
            let detail = if moves_base(step) { Detail::Whole } else { Detail::Arm };
            let colour = palette::of(step.act);
            Figure::new(story, story.end_of(index)).draw(view, detail, colour, strength, &mut drawn);
            group.append(drawn);
        }
    }
}

/// How strongly the robot is drawn after a primitive.
const fn strength(act: Act) -> f64 {
    match act {
        Act::Transit => PALE,
        Act::Transfer => 0.4,
        Act::Pick | Act::Place | Act::Push => 0.75,
    }
}

fn moves_base(step: &StoryStep) -> bool {
    match (step.snapshots.first(), step.snapshots.last()) {
        (Some(first), Some(last)) => first.robot.base != last.robot.base,
        _ => false,
    }
}

/// Writes the numbers of the steps onto the bases where they end.
pub(super) fn draw_numbers(story: &Story, view: &View, badges: &mut Badges, group: &mut Element) {
    for stop in stops(story) {
        let outline = stop.figure.base(view);
        let middle = outline.iter().fold(Point2::origin(), |sum, p| sum + p.coords / outline.len().max(1) as f64);
        badges.draw(&middle, &stop.numbers, group);
    }
}

/// Draws the way of every object, coloured by primitive, with its outline at the end of each step that moved it.
pub(super) fn draw_ways(story: &Story, view: &View, group: &mut Element) {
    for (index, step) in story.steps.iter().enumerate() {
        let colour = palette::of(step.act);
        let telling = story.telling(index);
        let mut drawn = ink::group(&format!("step {}: {}", telling.label(), step.primitive));
        for object in 0..story.start.objects.len() {
            let way = way(step, object, view);
            if way.len() < 2 {
                continue;
            }
            let end = step.snapshots.last().filter(|_| telling.is_drawn);
            if let Some(pose) = end.and_then(|snapshot| snapshot.objects.get(object)) {
                let ink = Ink::filled(colour).opacity(0.10).line(colour, 1.0);
                drawn.append(ink::polygon(&object_outline(story, object, pose, view), &ink));
            }
            drawn.append(ink::polyline(&way, &Ink::lined(colour, 2.6)));
        }
        group.append(drawn);
    }
}

/// Draws each push as a white arrow from where the object was to where it comes; seen from above only.
pub(super) fn draw_pushes(story: &Story, view: &View, group: &mut Element) {
    if view.projection != Projection::Above {
        return;
    }
    for (_, [from, to]) in pushes(story, view) {
        group.append(push_arrow(&from, &to, arrow_width(view)));
    }
}

/// Width of a push arrow: two centimetres of the world, within reason.
pub(super) fn arrow_width(view: &View) -> f64 {
    (0.02 * view.scale).clamp(3.5, 8.0)
}

/// Index of the step, and where the pushed object is before and after, on the page.
pub(super) fn pushes(story: &Story, view: &View) -> Vec<(usize, [Point2<f64>; 2])> {
    let push = |(index, step): (usize, &StoryStep)| {
        if step.act != Act::Push {
            return None;
        }
        let ways = (0..story.start.objects.len()).map(|object| way(step, object, view));
        let way = ways.filter(|way| way.len() > 1).max_by(|a, b| a.len().cmp(&b.len()))?;
        Some((index, [*way.first()?, *way.last()?]))
    };
    story.steps.iter().enumerate().filter_map(push).collect()
}

/// The way of an object's centre in one step on the page, thinned; one point or none for an object that rests.
fn way(step: &StoryStep, object: usize, view: &View) -> Vec<Point2<f64>> {
    let mut way: Vec<Point2<f64>> = Vec::new();
    let places = step.snapshots.iter().filter_map(|snapshot| snapshot.objects.get(object));
    let mut last = None;
    for pose in places {
        let place = view.see(&pose.translation.vector.into());
        last = Some(place);
        if way.last().is_none_or(|previous| (place - previous).norm() > FINE) {
            way.push(place);
        }
    }
    if let (Some(last), Some(end)) = (last, way.last_mut())
        && (last - *end).norm() <= FINE
    {
        *end = last;
    }
    way
}
