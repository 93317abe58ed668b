//! A plan that moves in one SVG file: the room from above and from one side, frame after frame on the clock of the plan.
//!
//! It needs no script, so that it moves wherever images are shown; a program that does not move pictures, and a person who asks
//! for less motion, see the last frame.

use nalgebra::Point2;
use svg::Node as _;
use svg::node::Text;
use svg::node::element::Element;

use super::PictureError;
use super::figure::{Detail, Figure, draw_goals, draw_objects};
use super::ink::{self, Anchor, Ink};
use super::model::Pose;
use super::overview::{Sheet, start_ink};
use super::page::document;
use super::palette;
use super::panel::Panel;
use super::room::Room;
use super::story::{Snapshot, Story};
use super::view::{Projection, View};
use crate::clock::TimedPlan;
use crate::plan_file::PlanFile;
use crate::robot::RobotFacts;

/// Seconds of the plan between two frames, unless that makes too many.
const EVERY_S: f64 = 0.5;
/// Frames at most, besides those at which the picture rests at its end.
const MOST_FRAMES: usize = 64;
/// Seconds that a frame is shown.
const SHOWN_S: f64 = 0.1;
/// Frames for which the end is shown.
const REST: usize = 12;
/// Space around and between the panels, page units.
const GAP: f64 = 12.0;
/// Width of each panel, page units.
const WIDTH: f64 = 480.0;
/// Height of a panel at most, page units.
const TALLEST: f64 = 420.0;
/// Height of the line that names the step, page units.
const CAPTION: f64 = 30.0;

/// The plan, moving; the same plan gives the same bytes.
///
/// # Errors
/// [`PictureError`] as for [`Story::of_plan`], and for a plan whose clock is none.
pub fn animate(plan: &PlanFile, robot: &RobotFacts) -> Result<String, PictureError> {
    let story = Story::of_plan(plan, robot)?;
    let timed = TimedPlan::new(plan, robot)?;
    let room = Room::new(&story.geometry);
    let views = [Sheet::Above, Sheet::Side(Projection::FromTheRight)].map(|s| s.view(&story, &room, WIDTH, TALLEST));
    let height = views.iter().map(|view| view.size().1).fold(0.0, f64::max);
    let views = views.map(|view| view.filling(WIDTH, height));
    let corners = [0.0, 1.0].map(|place| Point2::new(GAP + place * (WIDTH + GAP), GAP));
    let size = (2.0 * WIDTH + 3.0 * GAP, height + 2.0 * GAP + CAPTION);

    let frames = frames(&story, &timed);
    let period_s = frames.iter().map(|frame| frame.shown_s).sum::<f64>();
    let mut style = Element::new("style");
    style.append(Text::new(rules(&frames, period_s)));
    let mut page = document(size.0, size.1);
    page.append(style);
    for (corner, view) in corners.iter().zip(&views) {
        let mut content = Element::new("g");
        room.draw(view, &mut content);
        draw_goals(&story, view, &mut content);
        Panel { corner: *corner, view: *view }.draw("", content, &mut page);
    }
    let mut begins_s = 0.0;
    for (place, frame) in frames.iter().enumerate() {
        let mut group = frame.draw(&story, &corners, &views, size);
        group.assign("class", if place + 1 == frames.len() { "f last" } else { "f" });
        // Backwards in time, so that every frame is in its cycle from the start.
        group.assign("style", format!("animation-delay:{}s", ink::rounded(begins_s - period_s)));
        begins_s += frame.shown_s;
        page.append(group);
    }
    Ok(format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{page}\n"))
}

/// One state of the plan.
struct Frame {
    snapshot: Snapshot,
    /// The step that it belongs to.
    step: usize,
    /// The share of the plan's time that is over.
    share: f64,
    shown_s: f64,
}

/// Evenly over the time of the plan, the last for longer.
fn frames(story: &Story, timed: &TimedPlan) -> Vec<Frame> {
    let duration_s = timed.duration_s();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
    let count = ((duration_s / EVERY_S).ceil() as usize).clamp(1, MOST_FRAMES);
    let frame = |index: usize| {
        let share = index as f64 / count as f64;
        let moment = timed.at(share * duration_s);
        let poses = timed.objects(&moment);
        let names = story.problem.objects.iter().zip(&story.start.objects);
        let objects = names.map(|(object, start)| poses.get(object.name.as_str()).copied().unwrap_or(*start));
        let robot = Pose { base: moment.base, joints: moment.joints };
        let rest = if index == count { REST } else { 1 };
        let snapshot = Snapshot { robot, objects: objects.collect() };
        Frame { snapshot, step: moment.step, share, shown_s: rest as f64 * SHOWN_S }
    };
    (0..=count).map(frame).collect()
}

/// Frames are hidden but for their turn; the last, which is shown longer, has a cycle of its own.
fn rules(frames: &[Frame], period_s: f64) -> String {
    let cycle = |name: &str, shown_s: f64| {
        let until = 100.0 * shown_s / period_s;
        format!("@keyframes {name}{{0%{{visibility:visible}}{until:.4}%,100%{{visibility:hidden}}}}")
    };
    let last_s = frames.last().map_or(SHOWN_S, |frame| frame.shown_s);
    format!(
        "{}{}.f{{visibility:hidden;animation:turn {period_s:.3}s step-end infinite}}\
         .last{{visibility:visible;animation-name:rest}}\
         @media (prefers-reduced-motion:reduce){{.f{{animation:none}}}}",
        cycle("turn", SHOWN_S),
        cycle("rest", last_s),
    )
}

impl Frame {
    fn draw(&self, story: &Story, corners: &[Point2<f64>; 2], views: &[View; 2], size: (f64, f64)) -> Element {
        let mut group = Element::new("g");
        let step = story.steps.get(self.step);
        let colour = step.map_or(palette::ROBOT, |step| palette::of(step.act));
        for (corner, view) in corners.iter().zip(views) {
            let mut inside = Element::new("svg");
            let (width, height) = view.size();
            for (name, value) in [("x", corner.x), ("y", corner.y), ("width", width), ("height", height)] {
                inside.assign(name, ink::rounded(value));
            }
            // From above the hand hides what it holds; what is held is seen through it.
            Figure::new(story, &self.snapshot).draw(view, Detail::Whole, colour, 0.9, &mut inside);
            draw_objects(story, &self.snapshot, view, &start_ink().opacity(0.75), &mut inside);
            group.append(inside);
        }
        let bottom = size.1 - GAP;
        if let Some(step) = step {
            let object = step.object.and_then(|object| story.problem.objects.get(object));
            let object = object.map_or_else(String::new, |object| format!(" {}", object.name));
            let tool = story.tool_of(step).map_or_else(String::new, |tool| format!(", {tool}"));
            let text = format!("{}. {}{object}{tool}", self.step + 1, step.primitive);
            let at = Point2::new(GAP, bottom - 10.0);
            group.append(ink::bold(ink::text(&at, 15.0, colour, Anchor::Start, &text)));
        }
        let whole = size.0 - 2.0 * GAP;
        let bar = |share: f64, ink: &Ink<'_>| ink::rectangle(&Point2::new(GAP, bottom), whole * share, 4.0, 0.0, ink);
        group.append(bar(1.0, &Ink::filled(palette::FRAME)));
        group.append(bar(self.share, &Ink::filled(colour)));
        group
    }
}
