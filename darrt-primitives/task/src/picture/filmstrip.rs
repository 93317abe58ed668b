//! One small view from above per step, with its caption.

use nalgebra::{Point2, Vector2};
use svg::Node as _;
use svg::node::element::Element;

use super::badge::{self, badge};
use super::figure::{Detail, Figure, draw_goals, draw_objects};
use super::ink::{self, Anchor, Ink};
use super::journey;
use super::overview::start_ink;
use super::palette;
use super::panel::Panel;
use super::room::Room;
use super::story::{Story, StoryStep};
use super::travel::Travel;
use super::view::{Projection, View, Window};

/// Frames side by side.
const COLUMNS: usize = 5;
/// Space between frames, page units.
const GAP: f64 = 14.0;
/// Height of a frame over its width.
const ASPECT: f64 = 0.92;
/// Room for the caption under a frame, page units.
const CAPTION: f64 = 52.0;
/// A frame shows at least this much of the world (m).
const LEAST: f64 = 1.9;
/// Space around what a frame must show (m).
const MARGIN: f64 = 0.12;

/// Draws all frames from `top` down, between `left` and `left + width`; returns the height used.
pub(super) fn draw(story: &Story, room: &Room, left: f64, top: f64, width: f64, page: &mut Element) -> f64 {
    let frame = (width - GAP * (COLUMNS as f64 - 1.0)) / COLUMNS as f64;
    let height = frame * ASPECT;
    for (place, (index, step)) in story.drawn_steps().enumerate() {
        let (row, column) = (place / COLUMNS, place % COLUMNS);
        let offset = Vector2::new(column as f64 * (frame + GAP), row as f64 * (height + CAPTION));
        let corner = Point2::new(left, top) + offset;
        let view = view(story, index, step, frame, height);
        let mut content = Element::new("g");
        draw_frame(story, room, index, step, &view, &mut content);
        Panel { corner, view }.draw("", content, page);
        draw_caption(story, index, step, &(corner + Vector2::new(0.0, height)), frame, page);
    }
    story.drawn_steps().count().div_ceil(COLUMNS) as f64 * (height + CAPTION)
}

/// A window about the robot before and after the step and all that moves in between.
fn view(story: &Story, index: usize, step: &StoryStep, width: f64, height: f64) -> View {
    let flat = |p: &nalgebra::Point3<f64>| Projection::Above.flat(p);
    let figures = [before(story, index), story.end_of(index)].map(|snapshot| Figure::new(story, snapshot));
    let robots = figures.iter().flat_map(|figure| figure.points().map(flat));
    let objects = step.snapshots.iter().filter_map(|snapshot| snapshot.objects.get(step.object.unwrap_or(0)));
    let hands = step.snapshots.iter().map(|snapshot| story.world_from_tool(snapshot, step.hand));
    let places = objects.copied().chain(hands).map(|pose| flat(&pose.translation.vector.into()));
    let points: Vec<_> = robots.chain(places).collect();
    let shown = Window::around(points).unwrap_or_else(|| Window::centred(&Point2::origin(), LEAST, LEAST));
    let middle = nalgebra::center(&shown.low, &shown.high);
    let (w, h) = shown.padded(MARGIN).size();
    let w = w.max(LEAST).max(h * width / height);
    View { projection: Projection::Above, window: Window::centred(&middle, w, w * height / width), scale: width / w }
}

fn before(story: &Story, index: usize) -> &super::story::Snapshot {
    let first = story.steps.get(index).and_then(|step| step.snapshots.first());
    first.unwrap_or(&story.start)
}

fn draw_frame(story: &Story, room: &Room, index: usize, step: &StoryStep, view: &View, group: &mut Element) {
    let colour = palette::of(step.act);
    room.draw(view, group);
    draw_goals(story, view, group);
    let (before, after) = (before(story, index), story.end_of(index));
    let ghost = Ink::filled(palette::OBJECT).opacity(0.5).line(palette::QUIET, 0.8).dash("3 2");
    draw_objects(story, before, view, &ghost, group);
    Figure::new(story, before).draw(view, Detail::Whole, palette::ROBOT, 0.5, group);
    draw_objects(story, after, view, &start_ink(), group);
    Figure::new(story, after).draw(view, Detail::Whole, colour, 0.9, group);
    draw_hand_way(story, step, view, group);
    for (pushed, [from, to]) in journey::pushes(story, view) {
        if pushed == index {
            group.append(super::panel::push_arrow(&from, &to, journey::arrow_width(view)));
        }
    }
}

/// A dotted line along the way of the hand.
fn draw_hand_way(story: &Story, step: &StoryStep, view: &View, group: &mut Element) {
    let place = |snapshot| view.see(&story.world_from_tool(snapshot, step.hand).translation.vector.into());
    let mut way: Vec<Point2<f64>> = Vec::new();
    for point in step.snapshots.iter().map(place) {
        if way.last().is_none_or(|last| (point - last).norm() > 1.0) {
            way.push(point);
        }
    }
    if way.len() > 1 {
        group.append(ink::polyline(&way, &Ink::lined(palette::TEXT, 1.1).dash("1.5 2.5")));
    }
}

fn draw_caption(story: &Story, index: usize, step: &StoryStep, at: &Point2<f64>, width: f64, page: &mut Element) {
    let centre = at + Vector2::new(badge::RADIUS + 1.0, badge::RADIUS + 6.0);
    let telling = story.telling(index);
    page.append(badge(&centre, telling.last, step.act));
    let travel = Travel::of(story, step);
    let object = travel.object.and_then(|object| story.problem.objects.get(object));
    let numbers = if telling.first == telling.last { String::new() } else { format!(" ({})", telling.label()) };
    let heading = match object {
        Some(object) => format!("{} {}{numbers}", step.primitive, object.name),
        None => format!("{}{numbers}", step.primitive),
    };
    let line = at + Vector2::new(2.0 * badge::RADIUS + 7.0, 18.0);
    page.append(ink::bold(ink::text(&line, 11.5, palette::TEXT, Anchor::Start, &heading)));
    // In a step in which a hand only opens nothing goes anywhere.
    let parts = [story.tool_of(step).map(str::to_owned), Some(travel.in_words()).filter(|words| !words.is_empty())];
    let words = parts.into_iter().flatten().collect::<Vec<_>>().join(": ");
    for (row, text) in (0_u8..).zip(ink::wrapped(&words, 10.5, width)) {
        let line = at + Vector2::new(2.0, 34.0 + 12.0 * f64::from(row));
        page.append(ink::text(&line, 10.5, palette::QUIET, Anchor::Start, &text));
    }
}
