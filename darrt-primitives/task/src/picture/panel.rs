//! A framed view with its title, axes and scale.

use nalgebra::{Point2, Vector2};
use svg::Node as _;
use svg::node::element::Element;

use super::ink::{self, Anchor, Ink};
use super::palette;
use super::view::View;

/// Room above a panel for its title, page units.
pub(super) const TITLE: f64 = 24.0;

/// A place of the page and what it shows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Panel {
    /// Top left corner of the frame on the page.
    pub(super) corner: Point2<f64>,
    /// What is shown.
    pub(super) view: View,
}

impl Panel {
    /// Draws the panel: `content` is cut off at the frame.
    pub(super) fn draw(&self, title: &str, content: Element, page: &mut Element) {
        let (width, height) = self.view.size();
        if !title.is_empty() {
            let at = self.corner - Vector2::new(0.0, 8.0);
            page.append(ink::bold(ink::text(&at, 14.0, palette::TEXT, Anchor::Start, title)));
        }
        page.append(ink::rectangle(&self.corner, width, height, 0.0, &Ink::filled(palette::FLOOR)));
        let mut inside = Element::new("svg");
        for (name, value) in [("x", self.corner.x), ("y", self.corner.y), ("width", width), ("height", height)] {
            inside.assign(name, ink::rounded(value));
        }
        inside.append(content);
        self.draw_scale(&mut inside);
        page.append(inside);
        page.append(ink::rectangle(&self.corner, width, height, 0.0, &Ink::lined(palette::FRAME, 1.0)));
    }

    /// A bar of a round length and the directions of the axes, in the lower left corner.
    fn draw_scale(&self, inside: &mut Element) {
        let (width, height) = self.view.size();
        let length = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0]
            .into_iter()
            .find(|length| length * self.view.scale >= width / 8.0)
            .unwrap_or(10.0);
        let start = Point2::new(8.0, height - 8.0);
        let end = start + Vector2::new(length * self.view.scale, 0.0);
        inside.append(ink::polyline(&[start, end], &Ink::lined("#ffffff", 6.0)));
        inside.append(ink::polyline(&[start, end], &Ink::lined(palette::TEXT, 2.0)));
        let label = format!("{length} m");
        let at = Point2::new(start.x, start.y - 5.0);
        inside.append(ink::haloed(ink::text(&at, 10.0, palette::TEXT, Anchor::Start, &label)));
        if width > 300.0 {
            self.draw_axes(inside);
        }
    }

    fn draw_axes(&self, inside: &mut Element) {
        let (width, height) = self.view.size();
        let [right, up] = self.view.projection.axes();
        // An axis that points against the page is drawn pointing its own way.
        let (sign, name) = right.strip_prefix('\u{2212}').map_or((1.0, right), |name| (-1.0, name));
        let origin = Point2::new(if sign > 0.0 { width - 48.0 } else { width - 22.0 }, height - 14.0);
        let tips = [(Vector2::new(26.0 * sign, 0.0), name), (Vector2::new(0.0, -26.0), up)];
        for (along, name) in tips {
            inside.append(arrow(&origin, &(origin + along), 1.2, palette::QUIET));
            let at = origin + along * 1.25 + Vector2::new(0.0, 3.5);
            inside.append(ink::haloed(ink::text(&at, 10.0, palette::QUIET, Anchor::Middle, name)));
        }
    }
}

/// An arrow of one colour.
pub(super) fn arrow(from: &Point2<f64>, to: &Point2<f64>, width: f64, colour: &str) -> Element {
    let mut group = Element::new("g");
    let Some(along) = (to - from).try_normalize(1e-9) else { return group };
    let (length, half) = (width * 3.0 + 2.0, width * 1.5 + 1.0);
    let across = Vector2::new(-along.y, along.x);
    let neck = to - along * length;
    group.append(ink::polyline(&[*from, neck], &Ink::lined(colour, width)));
    group.append(ink::polygon(&[*to, neck + across * half, neck - across * half], &Ink::filled(colour)));
    group
}

/// A broad white arrow with a grey line, as the paper's figure 5 draws a push.
pub(super) fn push_arrow(from: &Point2<f64>, to: &Point2<f64>, width: f64) -> Element {
    let Some(along) = (to - from).try_normalize(1e-9) else { return Element::new("g") };
    let across = Vector2::new(-along.y, along.x);
    let head = (width * 2.2).min((to - from).norm());
    let neck = to - along * head;
    let (shaft, barb) = (across * (width / 2.0), across * (width * 1.15));
    let points = [from - shaft, neck - shaft, neck - barb, *to, neck + barb, neck + shaft, from + shaft];
    ink::polygon(&points, &Ink::filled("#ffffff").opacity(0.95).line("#6b7280", 1.2))
}
