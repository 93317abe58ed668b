//! Box plots of the time to the solution, one row per variant, with every run as a dot.

use nalgebra::Point2;
use svg::Node as _;
use svg::node::element::Element;

use super::Look;
use super::axis::{Area, BELOW, LogAxis, frame, image, title};
use crate::bench::record::Record;
use crate::bench::statistics::Summary;
use crate::bench::survival::Quantile;
use darrt_task::picture::ink::{self, Anchor, Ink};
use darrt_task::picture::palette;

/// Width of one image, page units.
const WIDTH: f64 = 540.0;
/// Height of one row, page units.
const ROW: f64 = 30.0;
/// Width of a letter of a variant's name, page units; at 11.5 few are wider.
const LETTER: f64 = 6.8;
/// Half the height of a box, page units.
const HALF: f64 = 7.5;
/// Dots that are drawn per row at most; more would only be a smear.
const MOST_DOTS: usize = 400;

/// The boxes of one problem.
pub(super) fn draw(problem: &str, rows: &[(&Summary, Vec<&Record>)], axis: &LogAxis, look: &Look) -> String {
    let height = 28.0 + ROW * rows.len() as f64 + BELOW;
    let letters = rows.iter().map(|(summary, _)| summary.variant.chars().count()).max().unwrap_or(0);
    // A name that would leave no room for the boxes is cut.
    let left = (20.0 + LETTER * letters as f64).min(WIDTH / 2.0);
    let area = Area { left, top: 28.0, width: WIDTH - 14.0 - left, height: ROW * rows.len() as f64 };
    let mut svg = image(WIDTH, height, &format!("{problem}: times of all runs"));
    title(&area, problem, &mut svg);
    axis.draw(&area, &mut svg);
    for (index, (summary, runs)) in rows.iter().enumerate() {
        let y = area.top + ROW * (index as f64 + 0.5);
        let at = Point2::new(area.left - 8.0, y + 4.0);
        svg.append(ink::text(&at, 11.5, palette::TEXT, Anchor::End, &summary.variant));
        svg.append(dots(runs, y, axis, &area));
        svg.append(one(summary, y, axis, &area, look.line(&summary.variant).0));
    }
    frame(&area, &mut svg);
    svg.to_string()
}

/// A box from quartile to quartile, whiskers from the 5th to the 95th percentile; open to the right where that is censored.
fn one(summary: &Summary, y: f64, axis: &LogAxis, area: &Area, colour: &str) -> Element {
    let quantile = |q: f64| summary.time.quantile(q);
    let x = |q: Quantile| q.value().map_or(area.right(), |seconds| axis.x(seconds, area));
    let line = Ink::lined(colour, 1.5);
    let [least, low, median, high, most] = [0.05, 0.25, 0.5, 0.75, 0.95].map(quantile);
    let tip = format!(
        "{}: {} of {} solved; quartiles {low}, {median}, {high} s; 95th percentile {most} s",
        summary.variant, summary.solved, summary.runs
    );
    let mut group = ink::group(&tip);
    let across = |from: f64, to: f64, group: &mut Element, line: &Ink<'_>| {
        group.append(ink::polyline(&[Point2::new(from, y), Point2::new(to, y)], line));
    };
    let upright = |at: f64, half: f64, group: &mut Element, line: &Ink<'_>| {
        group.append(ink::polyline(&[Point2::new(at, y - half), Point2::new(at, y + half)], line));
    };
    if least.value().is_some() && low.value().is_some() {
        across(x(least), x(low), &mut group, &line);
        upright(x(least), 4.0, &mut group, &line);
    }
    if low.value().is_some() {
        let (from, to) = (x(low), x(high));
        let corner = Point2::new(from, y - HALF);
        let fill = Ink::filled(colour).opacity(0.22);
        group.append(ink::rectangle(&corner, (to - from).max(1.0), 2.0 * HALF, 0.0, &fill));
        let end = |sign: f64| [Point2::new(from, y + sign * HALF), Point2::new(to, y + sign * HALF)];
        let edge = if high.value().is_some() { line } else { line.dash("3 3") };
        for side in [-1.0, 1.0] {
            group.append(ink::polyline(&end(side), &edge));
        }
        upright(from, HALF, &mut group, &line);
        if high.value().is_some() {
            upright(to, HALF, &mut group, &line);
            let is_known = most.value().is_some();
            across(to, x(most), &mut group, &if is_known { line } else { line.dash("3 3") });
            if is_known {
                upright(x(most), 4.0, &mut group, &line);
            }
        }
    }
    if median.value().is_some() {
        upright(x(median), HALF, &mut group, &Ink::lined(colour, 3.0));
    }
    group
}

/// Every run: a dot where it was solved, a triangle that points on where it ended without a plan.
fn dots(runs: &[&Record], y: f64, axis: &LogAxis, area: &Area) -> Element {
    let mut group = Element::new("g");
    for (index, run) in runs.iter().take(MOST_DOTS).enumerate() {
        // Spread by the golden ratio, so that equal times do not hide each other.
        let spread = (index as f64 * 0.618_033_988_749_895).fract() - 0.5;
        let at = Point2::new(axis.x(run.time().value, area), y + spread * 1.5 * HALF);
        if run.is_in_time() {
            group.append(ink::circle(&at, 2.0, &Ink::filled(palette::TEXT).opacity(0.45)));
        } else {
            let corner = |x: f64, y: f64| Point2::new(at.x + x, at.y + y);
            let triangle = [corner(-3.0, -3.0), corner(3.0, 0.0), corner(-3.0, 3.0)];
            group.append(ink::polygon(&triangle, &Ink::filled(palette::PAGE).line(palette::GOAL, 1.0)));
        }
    }
    group
}
