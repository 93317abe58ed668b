//! Where the time goes: shares of the planning time by primitive and by kind of work.

use nalgebra::Point2;
use svg::Node as _;
use svg::node::element::Element;

use super::axis::{SMALL, image};
use crate::bench::record::{PrimitiveRecord, Record};
use crate::bench::survival::rounded;
use darrt_task::picture::ink::{self, Anchor, Ink};
use darrt_task::picture::palette;

/// Width of the image, page units.
const WIDTH: f64 = 1100.0;
/// Height of one row, page units.
const ROW: f64 = 22.0;
/// Where the bars begin: names stand left of them.
const LEFT: f64 = 235.0;
/// Width of each of the two bars.
const BAR: f64 = 385.0;
/// Space between the bars.
const GAP: f64 = 20.0;

/// Colours of the paper's primitives; each kind of motion has one hue.
pub(super) const PRIMITIVES: [(&str, &str); 8] = [
    ("Arm-Transit", "#2148d8"),
    ("Straight-Line-Arm-Transit", "#7d97f2"),
    ("Base-Transit", "#38bdd8"),
    ("Arm-Rigid-Transfer", "#a21caf"),
    ("Base-Rigid-Transfer", "#e59aec"),
    ("Pick", "#149a3e"),
    ("Place", "#e8590c"),
    ("Push", "#d9a514"),
];
/// The verifier.
const VERIFICATION: (&str, &str) = ("verification", "#4b5563");
/// All else.
const REST: (&str, &str) = ("sampling, nearest node, tree", "#cbd2d9");
/// Kinds of work within the primitives.
const WORK: [(&str, &str); 3] = [
    ("propagation (inverse kinematics, grasps, contacts)", "#0f766e"),
    ("collision checks", "#f2a93b"),
    ("ways around", "#b4541a"),
];

/// The legend of the bars by primitive.
pub(super) fn primitives_legend() -> Vec<(&'static str, &'static str)> {
    PRIMITIVES.into_iter().chain([VERIFICATION, REST]).collect()
}

/// The legend of the bars by kind of work.
pub(super) fn work_legend() -> Vec<(&'static str, &'static str)> {
    WORK.into_iter().chain([VERIFICATION, REST]).collect()
}

/// Mean seconds of a group of runs, by part.
#[derive(Debug, Clone, PartialEq)]
struct Split {
    total: f64,
    by_primitive: Vec<f64>,
    by_work: Vec<f64>,
}

impl Split {
    fn of(runs: &[&Record]) -> Self {
        let count = runs.len().max(1) as f64;
        let mean = |value: &dyn Fn(&Record) -> f64| runs.iter().map(|run| value(run)).sum::<f64>() / count;
        let total = mean(&|run| run.seconds.total);
        let verification = mean(&|run| run.seconds.verification);
        let sum = |run: &Record, name: Option<&str>, part: fn(&PrimitiveRecord) -> f64| -> f64 {
            run.primitives.iter().filter(|p| name.is_none_or(|name| p.name == name)).map(part).sum()
        };
        let all: fn(&PrimitiveRecord) -> f64 = |p| p.propagate_s + p.collision_s + p.local_repair_s;
        let work: [fn(&PrimitiveRecord) -> f64; 3] = [|p| p.propagate_s, |p| p.collision_s, |p| p.local_repair_s];
        let rest = (total - verification - mean(&|run| sum(run, None, all))).max(0.0);
        let with_rest = |parts: Vec<f64>| parts.into_iter().chain([verification, rest]).collect();
        Self {
            total,
            by_primitive: with_rest(PRIMITIVES.map(|(name, _)| mean(&|run| sum(run, Some(name), all))).to_vec()),
            by_work: with_rest(work.map(|part| mean(&|run| sum(run, None, part))).to_vec()),
        }
    }
}

/// One row per group of runs with its name.
pub(super) fn draw(rows: &[(String, Vec<&Record>)]) -> String {
    let height = 24.0 + ROW * rows.len() as f64;
    let mut svg = image(WIDTH, height, "where the time goes");
    for (column, words) in ["by primitive", "by kind of work"].into_iter().enumerate() {
        let at = Point2::new(LEFT + column as f64 * (BAR + GAP), 14.0);
        svg.append(ink::bold(ink::text(&at, 12.0, palette::TEXT, Anchor::Start, words)));
    }
    let at = Point2::new(WIDTH - 4.0, 14.0);
    svg.append(ink::text(&at, SMALL, palette::QUIET, Anchor::End, "mean s"));
    for (index, (name, runs)) in rows.iter().enumerate() {
        let (split, y) = (Split::of(runs), 22.0 + ROW * index as f64);
        let at = Point2::new(LEFT - 8.0, y + 14.0);
        svg.append(ink::text(&at, 11.5, palette::TEXT, Anchor::End, name));
        svg.append(bar(&split.by_primitive, &primitives_legend(), split.total, LEFT, y));
        svg.append(bar(&split.by_work, &work_legend(), split.total, LEFT + BAR + GAP, y));
        let at = Point2::new(WIDTH - 4.0, y + 14.0);
        svg.append(ink::text(&at, 11.5, palette::TEXT, Anchor::End, &rounded(split.total)));
    }
    svg.to_string()
}

fn bar(parts: &[f64], legend: &[(&str, &str)], total: f64, left: f64, y: f64) -> Element {
    let mut group = Element::new("g");
    // Timers and clock do not agree to the last digit: the bar is full in any case.
    let whole = parts.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let mut x = left;
    for (seconds, (name, colour)) in parts.iter().zip(legend) {
        let width = BAR * seconds / whole;
        if width < 0.05 {
            continue;
        }
        let mut part = ink::group(&format!("{name}: {} s of {} s", rounded(*seconds), rounded(total)));
        part.append(ink::rectangle(&Point2::new(x, y), width, ROW - 4.0, 0.0, &Ink::filled(colour)));
        if width > 30.0 {
            let middle = Point2::new(x + width / 2.0, y + 13.0);
            let ink_colour = if palette::is_light(colour) { palette::TEXT } else { palette::PAGE };
            let words = format!("{:.0} %", 100.0 * seconds / whole);
            part.append(ink::text(&middle, 10.0, ink_colour, Anchor::Middle, &words));
        }
        group.append(part);
        x += width;
    }
    group
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::record::tests::sample;
    use darrt_task::problem_file::PrimitiveName;

    #[test]
    fn the_parts_make_up_the_whole_in_both_ways() {
        let runs = [sample("bowl", "default", 0, 1.0, true), sample("bowl", "default", 1, 3.0, true)];
        let split = Split::of(&runs.iter().collect::<Vec<_>>());
        for parts in [&split.by_primitive, &split.by_work] {
            assert!((parts.iter().sum::<f64>() - 2.0).abs() < 1e-9, "{split:?}");
        }
        let pick = PRIMITIVES.iter().position(|(name, _)| *name == "Pick").unwrap();
        assert!((split.by_primitive[pick] - 1.0).abs() < 1e-9);
        assert_eq!((split.by_primitive.len(), split.by_work.len()), (primitives_legend().len(), work_legend().len()));
    }

    #[test]
    fn every_primitive_has_a_colour() {
        for name in PrimitiveName::PAPER {
            assert!(PRIMITIVES.iter().any(|(other, _)| *other == name.as_str()), "{name}");
        }
    }
}
