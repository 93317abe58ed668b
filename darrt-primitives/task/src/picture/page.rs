//! Puts the panels on one page.

use nalgebra::Point2;
use svg::Node as _;
use svg::node::element::Element;

use super::Extent;
use super::filmstrip;
use super::ink::{self, Anchor, Ink};
use super::overview::{Sheet, start_ink};
use super::palette;
use super::panel::{Panel, TITLE};
use super::room::Room;
use super::story::Story;
use super::view::Projection;

/// Width of the page in its own units.
pub(super) const WIDTH: f64 = 1200.0;
/// Space left and right, page units.
const SIDE: f64 = 20.0;
/// Space between panels, page units.
const GAP: f64 = 20.0;
/// Highest large panel, page units.
const TALLEST: f64 = 640.0;
/// Highest view from the side, page units.
const TALLEST_SIDE: f64 = 340.0;

/// The whole page as one SVG element.
pub(super) fn draw(story: &Story, extent: Extent) -> Element {
    let mut page = Element::new("g");
    let room = Room::new(&story.geometry);
    let mut y = draw_header(story, &mut page);

    y = draw_row(story, &room, [Sheet::Above, Sheet::CloseUp], y, TALLEST, &mut page);
    let sides = [Sheet::Side(Projection::FromBehind), Sheet::Side(Projection::FromTheRight)];
    y = draw_row(story, &room, sides, y, TALLEST_SIDE, &mut page);

    if !story.steps.is_empty() && extent == Extent::Whole {
        let title = "Step by step, from above (grey: before, colour: after, dots: way of the hand)";
        let at = Point2::new(SIDE, y + 6.0);
        page.append(ink::bold(ink::text(&at, 14.0, palette::TEXT, Anchor::Start, title)));
        y += 16.0;
        y += filmstrip::draw(story, &room, SIDE, y, WIDTH - 2.0 * SIDE, &mut page);
    }
    let mut svg = document(WIDTH, y + 4.0);
    svg.append(page);
    svg
}

/// The root element of a picture of this size, with its ground.
pub(super) fn document(width: f64, height: f64) -> Element {
    let mut svg = Element::new("svg");
    svg.assign("xmlns", "http://www.w3.org/2000/svg");
    svg.assign("viewBox", format!("0 0 {} {}", ink::rounded(width), ink::rounded(height)));
    svg.assign("width", ink::rounded(width));
    svg.assign("height", ink::rounded(height));
    svg.assign("font-family", "system-ui, 'Segoe UI', 'Helvetica Neue', Arial, sans-serif");
    svg.append(ink::rectangle(&Point2::origin(), width, height, 0.0, &Ink::filled(palette::PAGE)));
    svg
}

/// Draws two panels of one height side by side; returns where the next row begins.
fn draw_row(story: &Story, room: &Room, row: [Sheet; 2], top: f64, tallest: f64, page: &mut Element) -> f64 {
    let width = (WIDTH - 2.0 * SIDE - GAP) / 2.0;
    let views = row.map(|sheet| sheet.view(story, room, width, tallest));
    let height = views.iter().map(|view| view.size().1).fold(0.0, f64::max);
    let mut corner = Point2::new(SIDE, top + TITLE);
    for (sheet, view) in row.into_iter().zip(views) {
        let view = view.filling(width, height);
        Panel { corner, view }.draw(sheet.title(story), sheet.draw(story, room, &view), page);
        corner.x += width + GAP;
    }
    top + TITLE + height + GAP
}

/// Title, description, note and legend; returns where the panels begin.
fn draw_header(story: &Story, page: &mut Element) -> f64 {
    let problem = &story.problem;
    let title = if problem.title.is_empty() { &problem.name } else { &problem.title };
    page.append(ink::bold(ink::text(&Point2::new(SIDE, 36.0), 22.0, palette::TEXT, Anchor::Start, title)));
    let mut y = 58.0;
    for text in [problem.description.as_str(), story.note.as_str()] {
        for line in ink::wrapped(text, 12.5, WIDTH - 2.0 * SIDE) {
            page.append(ink::text(&Point2::new(SIDE, y), 12.5, palette::QUIET, Anchor::Start, &line));
            y += 17.0;
        }
    }
    draw_legend(story, y + 4.0, page);
    y + 26.0
}

fn draw_legend(story: &Story, y: f64, page: &mut Element) {
    let mut x = SIDE;
    let mut entry = |ink: &Ink<'_>, name: &str| {
        page.append(ink::rectangle(&Point2::new(x, y - 9.0), 20.0, 12.0, 2.0, ink));
        page.append(ink::text(&Point2::new(x + 26.0, y + 1.0), 12.0, palette::TEXT, Anchor::Start, name));
        x += 26.0 + ink::text_width(name, 12.0) + 22.0;
    };
    entry(&start_ink(), "object at the start");
    entry(&Ink::filled(palette::GOAL).opacity(0.07).line(palette::GOAL, 1.6).dash("4 3"), "goal");
    entry(&Ink::filled(palette::CLUTTER).line(palette::CLUTTER_LINE, 1.0), "obstacle");
    entry(&Ink::filled(palette::ROBOT).opacity(0.3).line(palette::ROBOT, 1.0), "robot at the start");
    if story.steps.is_empty() {
        return;
    }
    for (name, act) in palette::KINDS {
        if story.steps.iter().any(|step| step.act == act) {
            let colour = palette::of(act);
            entry(&Ink::filled(colour).opacity(0.6).line(colour, 1.0), name);
        }
    }
}
