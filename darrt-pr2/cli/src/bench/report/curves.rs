//! Share of runs solved against time, one curve per variant.

use nalgebra::Point2;
use svg::Node as _;
use svg::node::element::Element;

use super::Look;
use super::axis::{Area, BELOW, LogAxis, SMALL, frame, image, title};
use crate::bench::statistics::Summary;
use darrt_task::picture::ink::{self, Anchor, Ink};
use darrt_task::picture::palette;

/// Width of one image, page units.
const WIDTH: f64 = 540.0;
/// Height of one image, page units.
const HEIGHT: f64 = 270.0;

/// The curves of one problem.
pub(super) fn draw(problem: &str, summaries: &[&Summary], axis: &LogAxis, look: &Look) -> String {
    let area = Area { left: 44.0, top: 28.0, width: WIDTH - 58.0, height: HEIGHT - 28.0 - BELOW };
    let mut svg = image(WIDTH, HEIGHT, &format!("{problem}: share of runs solved against time"));
    title(&area, problem, &mut svg);
    axis.draw(&area, &mut svg);
    for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let y = height(share, &area);
        let ends = [Point2::new(area.left, y), Point2::new(area.right(), y)];
        svg.append(ink::polyline(&ends, &Ink::lined(palette::FRAME, 0.8)));
        let at = Point2::new(area.left - 6.0, y + 3.5);
        svg.append(ink::text(&at, SMALL, palette::QUIET, Anchor::End, &format!("{:.0} %", share * 100.0)));
    }
    frame(&area, &mut svg);
    // The first variant is drawn last: it is what the others are held against.
    for summary in summaries.iter().rev() {
        svg.append(curve(summary, axis, &area, look));
    }
    svg.to_string()
}

fn height(share: f64, area: &Area) -> f64 {
    area.bottom() - area.height * share
}

fn curve(summary: &Summary, axis: &LogAxis, area: &Area, look: &Look) -> Element {
    let (colour, dash) = look.line(&summary.variant);
    let name = format!("{}: {} of {} solved", summary.variant, summary.solved, summary.runs);
    let mut group = ink::group(&name);
    let mut points = vec![Point2::new(area.left, height(0.0, area))];
    let mut before = 0.0;
    for (time, share) in summary.time.steps() {
        let x = axis.x(*time, area);
        points.extend([Point2::new(x, height(before, area)), Point2::new(x, height(*share, area))]);
        before = *share;
    }
    let is_censored = !summary.time.censored().is_empty();
    // Without censoring all is known for ever: the curve stays at the top.
    let end = if is_censored { axis.x(summary.time.last(), area) } else { area.right() };
    points.push(Point2::new(end, height(before, area)));
    group.append(ink::polyline(&points, &Ink::lined(colour, 2.0).dash(dash)));
    for time in summary.time.censored() {
        let (x, y) = (axis.x(*time, area), height(summary.time.share_by(*time), area));
        let tick = [Point2::new(x, y - 4.5), Point2::new(x, y + 4.5)];
        group.append(ink::polyline(&tick, &Ink::lined(colour, 1.4)));
    }
    group
}
