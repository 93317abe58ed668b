//! The logarithmic axis of seconds, and the frame of a plot.

use nalgebra::Point2;
use svg::Node as _;
use svg::node::element::Element;

use crate::bench::survival::rounded;
use darrt_task::picture::ink::{self, Anchor, Ink};
use darrt_task::picture::palette;

/// Size of the small letters at an axis, page units.
pub(super) const SMALL: f64 = 10.5;
/// Room below a plot for the numbers and the name of its axis, page units.
pub(super) const BELOW: f64 = 36.0;

/// Where the inside of a plot lies on its image.
#[derive(Debug, Clone, Copy)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Area {
    pub(super) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(super) fn bottom(&self) -> f64 {
        self.top + self.height
    }
}

/// Seconds from left to right, by their logarithm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LogAxis {
    low: f64,
    high: f64,
}

/// Shortest time that is drawn, seconds.
const SHORTEST: f64 = 1e-3;

impl LogAxis {
    /// An axis with room for all these times.
    pub(super) fn over(times: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = times
            .into_iter()
            .fold((f64::INFINITY, SHORTEST), |(low, high), time| (low.min(time.max(SHORTEST)), high.max(time)));
        let low = if low.is_finite() { low } else { SHORTEST };
        Self { low: low / 1.25, high: (high * 1.25).max(low * 8.0) }
    }

    /// Where a time lies, held inside the area.
    pub(super) fn x(&self, seconds: f64, area: &Area) -> f64 {
        let share = (seconds.max(self.low) / self.low).ln() / (self.high / self.low).ln();
        area.left + area.width * share.clamp(0.0, 1.0)
    }

    /// Times with a line, and whether their number is written: 1, 2 and 5 of every decade if there is room.
    fn ticks(&self) -> Vec<(f64, bool)> {
        let decades = (self.high / self.low).log10();
        let mut ticks = Vec::new();
        for exponent in -3..=9 {
            for digit in 1..10 {
                let time = f64::from(digit) * 10.0_f64.powi(exponent);
                if (self.low..=self.high).contains(&time) {
                    let is_named = digit == 1 || (decades < 3.2 && matches!(digit, 2 | 5)) || decades < 0.8;
                    ticks.push((time, is_named));
                }
            }
        }
        ticks
    }

    /// Grid lines, numbers and the name of the axis.
    pub(super) fn draw(&self, area: &Area, group: &mut Element) {
        for (time, is_named) in self.ticks() {
            let x = self.x(time, area);
            let line = Ink::lined(if is_named { palette::FRAME } else { GRID }, 0.8);
            group.append(ink::polyline(&[Point2::new(x, area.top), Point2::new(x, area.bottom())], &line));
            if is_named {
                let at = Point2::new(x, area.bottom() + 14.0);
                group.append(ink::text(&at, SMALL, palette::QUIET, Anchor::Middle, &short(time)));
            }
        }
        let at = Point2::new(area.left + area.width / 2.0, area.bottom() + 29.0);
        group.append(ink::text(&at, SMALL, palette::QUIET, Anchor::Middle, "seconds"));
    }
}

/// Faint lines between the named ones.
const GRID: &str = "#eef0f3";

/// A tick's number without needless digits.
fn short(time: f64) -> String {
    let text = if time < 0.9995 { format!("{time:.3}") } else { rounded(time) };
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The image of a plot with its title; what is drawn next lies above the grid.
pub(super) fn image(width: f64, height: f64, label: &str) -> Element {
    let mut svg = Element::new("svg");
    svg.assign("viewBox", format!("0 0 {width} {height}"));
    svg.assign("role", "img");
    svg.assign("aria-label", ink::clean(label));
    svg.assign("font-family", FONT);
    svg
}

/// The letters of all texts.
pub(super) const FONT: &str = "system-ui, 'Segoe UI', 'Helvetica Neue', Arial, sans-serif";

/// The line around a plot.
pub(super) fn frame(area: &Area, group: &mut Element) {
    let corner = Point2::new(area.left, area.top);
    group.append(ink::rectangle(&corner, area.width, area.height, 0.0, &Ink::lined(palette::FURNITURE_LINE, 1.0)));
}

/// The title above a plot.
pub(super) fn title(area: &Area, words: &str, group: &mut Element) {
    let at = Point2::new(area.left, area.top - 9.0);
    group.append(ink::bold(ink::text(&at, 13.0, palette::TEXT, Anchor::Start, words)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_lie_in_order_and_inside() {
        let axis = LogAxis::over([0.2, 60.0, 3.0]);
        let area = Area { left: 10.0, top: 0.0, width: 100.0, height: 50.0 };
        let x = [0.0, 0.2, 3.0, 60.0, 1e9].map(|time| axis.x(time, &area));
        assert!(x.windows(2).all(|pair| pair[0] < pair[1]), "{x:?}");
        assert!(x[0] >= 10.0 && x[4] <= 110.0);
        let decade = axis.x(1.0, &area) - axis.x(0.5, &area);
        assert!((decade - (axis.x(20.0, &area) - axis.x(10.0, &area))).abs() < 1e-9, "logarithmic");
        assert!(LogAxis::over([]).ticks().iter().any(|(_, is_named)| *is_named));
    }

    #[test]
    fn numbers_of_ticks_are_short() {
        assert_eq!(
            [0.001, 0.02, 0.5, 1.0, 5.0, 10.0, 200.0].map(short),
            ["0.001", "0.02", "0.5", "1", "5", "10", "200"]
        );
    }
}
