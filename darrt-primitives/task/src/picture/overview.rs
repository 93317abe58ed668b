//! The large panels: the room from above, from two sides, and the surface where the object starts.

use nalgebra::{Point2, Point3};
use svg::Node as _;
use svg::node::element::Element;

use super::act::Act;
use super::badge::Badges;
use super::figure::{Detail, Figure, draw_goals, draw_objects, goal_points};
use super::ink::{self, Anchor, Ink};
use super::journey;
use super::palette;
use super::room::{Room, surface_points};
use super::story::Story;
use super::view::{Projection, View, Window};

/// Space around what a panel must show (m).
const MARGIN: f64 = 0.2;
/// Space around the surface of the close-up (m).
const CLOSE_MARGIN: f64 = 0.30;

/// The large panels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sheet {
    /// Everything from above.
    Above,
    /// The surface on which the first object starts, from above, with the pushes.
    CloseUp,
    /// Everything from one side; walls that would hide it are left out.
    Side(Projection),
}

impl Sheet {
    /// What is written over the panel.
    pub(super) fn title(self, story: &Story) -> &'static str {
        let has_pushes = story.steps.iter().any(|step| step.act == Act::Push);
        match self {
            Self::Above | Self::Side(Projection::Above) => "From above",
            Self::CloseUp if has_pushes => "Close-up: where the object starts, and its pushes",
            Self::CloseUp => "Close-up: where the object starts",
            Self::Side(Projection::FromTheRight) => "From the right",
            Self::Side(Projection::FromBehind) => "From behind",
        }
    }

    /// The part of the world to show, in a frame of at most this size.
    pub(super) fn view(self, story: &Story, room: &Room, width: f64, height: f64) -> View {
        let projection = match self {
            Self::Above | Self::CloseUp => Projection::Above,
            Self::Side(projection) => projection,
        };
        let whole = || {
            let points = room.inner_points().map(|p| projection.flat(p));
            fitted(projection, points.chain(moving_points(story, projection)), MARGIN, width, height)
        };
        if self != Self::CloseUp {
            return whole();
        }
        let surface = story.geometry.objects.first().and_then(|o| story.geometry.scene.surfaces().get(o.surface));
        surface.map_or_else(whole, |surface| {
            let corners = surface_points(surface).map(|p| projection.flat(&p));
            fitted(projection, corners, CLOSE_MARGIN, width, height)
        })
    }

    /// What the panel shows in a view.
    pub(super) fn draw(self, story: &Story, room: &Room, view: &View) -> Element {
        let mut group = Element::new("g");
        room.draw(view, &mut group);
        match self {
            Self::Above => {
                name_surfaces(story, view, &mut group);
                draw_all(story, view, &mut group);
            }
            Self::CloseUp => draw_close_up(story, room, view, &mut group),
            Self::Side(_) => {
                draw_all(story, view, &mut group);
                draw_heights(story, view, &mut group);
            }
        }
        group
    }
}

fn draw_close_up(story: &Story, room: &Room, view: &View, group: &mut Element) {
    draw_goals(story, view, group);
    draw_objects(story, &story.start, view, &start_ink(), group);
    room.name_clutter(view, group);
    journey::draw_ways(story, view, group);
    for (index, step) in story.drawn_steps() {
        let hand = |snapshot, strength, group: &mut Element| {
            Figure::new(story, snapshot).draw(view, Detail::Hand, palette::of(step.act), strength, group);
        };
        if let (Act::Push, Some(first)) = (step.act, step.snapshots.first()) {
            hand(first, 0.3, group);
        }
        if matches!(step.act, Act::Push | Act::Pick) {
            hand(story.end_of(index), 0.6, group);
        }
    }
    journey::draw_pushes(story, view, group);
    let mut badges = Badges::new(view.size());
    for (index, [from, to]) in journey::pushes(story, view) {
        let telling = story.telling(index);
        if !telling.is_drawn {
            continue;
        }
        // Beside the arrow, not on it.
        let along = (to - from).try_normalize(1e-9).unwrap_or_default();
        let aside = nalgebra::Vector2::new(-along.y, along.x) * (2.0 * journey::arrow_width(view));
        badges.draw(&(nalgebra::center(&from, &to) + aside), &[(telling.last, Act::Push)], group);
    }
}

/// Writes the name and height of each support surface inside the corner that is farthest from what matters.
fn name_surfaces(story: &Story, view: &View, group: &mut Element) {
    const SIZE: f64 = 10.5;
    let busy: Vec<_> = goal_points(story, view.projection).iter().map(|p| view.place(p)).collect();
    let start = &story.start;
    let base = Point3::new(start.robot.base[0], start.robot.base[1], 0.0);
    let objects = start.objects.iter().map(|pose| view.see(&pose.translation.vector.into()));
    let busy: Vec<_> = busy.into_iter().chain(objects).chain([view.see(&base)]).collect();
    for surface in story.geometry.scene.surfaces() {
        let Some(window) = Window::around(surface_points(surface).map(|p| view.see(&p))) else { continue };
        let label = format!("{} {:.2} m", surface.name(), surface.height());
        let inside = (view.size().0 - ink::text_width(&label, SIZE) - 4.0).max(4.0);
        let left = (window.low.x + 5.0).clamp(4.0, inside);
        let right = (window.high.x - 5.0 - ink::text_width(&label, SIZE)).clamp(4.0, inside);
        let (top, bottom) = (window.low.y + 14.0, window.high.y - 6.0);
        let corners = [[left, top], [right, top], [left, bottom], [right, bottom]].map(Point2::from);
        let room = |at: &Point2<f64>| {
            let middle = at + nalgebra::Vector2::new(ink::text_width(&label, SIZE) / 2.0, 0.0);
            busy.iter().map(|p| (p - middle).norm()).fold(f64::INFINITY, f64::min)
        };
        if let Some(at) = corners.iter().max_by(|a, b| room(a).total_cmp(&room(b))) {
            group.append(ink::text(at, SIZE, palette::TABLE_LINE, Anchor::Start, &label));
        }
    }
}

/// What the large panels share: goals, start, ways, robots.
fn draw_all(story: &Story, view: &View, group: &mut Element) {
    draw_goals(story, view, group);
    draw_objects(story, &story.start, view, &start_ink(), group);
    let mut badges = Badges::new(view.size());
    let mut numbers = Element::new("g");
    journey::draw_robots(story, view, group);
    journey::draw_numbers(story, view, &mut badges, &mut numbers);
    journey::draw_ways(story, view, group);
    journey::draw_pushes(story, view, group);
    group.append(numbers);
}

/// Paint of an object that rests.
pub(super) fn start_ink() -> Ink<'static> {
    Ink::filled(palette::OBJECT).opacity(0.95).line(palette::OBJECT_LINE, 1.3)
}

/// A dashed line at the height of every support surface, with the height in metres.
fn draw_heights(story: &Story, view: &View, group: &mut Element) {
    let (width, _) = view.size();
    let mut labelled: Vec<f64> = Vec::new();
    for surface in story.geometry.scene.surfaces() {
        let y = view.place(&Point2::new(0.0, surface.height())).y;
        if labelled.iter().any(|other| (other - y).abs() < 11.0) {
            continue;
        }
        labelled.push(y);
        let line = [Point2::new(0.0, y), Point2::new(width, y)];
        group.append(ink::polyline(&line, &Ink::lined(palette::TABLE_LINE, 0.6).dash("3 4")));
        let at = Point2::new(4.0, y - 3.0);
        let label = format!("{:.2} m", surface.height());
        group.append(ink::haloed(ink::text(&at, 10.0, palette::TABLE_LINE, Anchor::Start, &label)));
    }
}

/// Where the base, the objects and the goals are seen over the whole plan, and the robot at its key states.
fn moving_points(story: &Story, projection: Projection) -> Vec<Point2<f64>> {
    let mut points = goal_points(story, projection);
    for snapshot in story.snapshots() {
        points.extend(snapshot.objects.iter().map(|pose| projection.flat(&pose.translation.vector.into())));
    }
    let ends = (0..story.steps.len()).map(|index| story.end_of(index));
    for snapshot in std::iter::once(&story.start).chain(ends) {
        points.extend(Figure::new(story, snapshot).points().map(|p| projection.flat(p)));
    }
    points
}

/// A view of all points with a margin (m); a metre about the origin when there are none.
fn fitted(
    projection: Projection,
    points: impl IntoIterator<Item = Point2<f64>>,
    margin: f64,
    width: f64,
    height: f64,
) -> View {
    let window = Window::around(points).unwrap_or_else(|| Window::centred(&Point2::origin(), 1.0, 1.0));
    View::fitted(projection, window.padded(margin), width, height)
}
