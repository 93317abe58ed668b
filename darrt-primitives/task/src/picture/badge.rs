//! The numbers of the steps, kept apart from each other.

use nalgebra::{Point2, Vector2};
use svg::Node as _;
use svg::node::element::Element;

use super::act::Act;
use super::ink::{self, Anchor, Ink};
use super::palette;

/// Radius of a badge, page units.
pub(super) const RADIUS: f64 = 8.0;
/// Badges side by side in a cluster.
const COLUMNS: usize = 4;
/// How far clusters may be moved to keep them apart, page units.
const FARTHEST: f64 = 160.0;

/// One number in the colour of its primitive.
pub(super) fn badge(centre: &Point2<f64>, number: usize, act: Act) -> Element {
    let mut group = Element::new("g");
    group.append(ink::circle(centre, RADIUS, &Ink::filled(palette::of(act)).line("#ffffff", 1.2)));
    let at = centre + Vector2::new(0.0, 3.4);
    let size = if number < 100 { 9.5 } else { 7.5 };
    group.append(ink::bold(ink::text(&at, size, "#ffffff", Anchor::Middle, &number.to_string())));
    group
}

/// Places clusters of badges so that they overlap neither each other nor the border.
#[derive(Debug, Clone)]
pub(super) struct Badges {
    size: Vector2<f64>,
    taken: Vec<(Point2<f64>, Vector2<f64>)>,
}

impl Badges {
    /// For a panel of this width and height.
    pub(super) fn new((width, height): (f64, f64)) -> Self {
        Self { size: Vector2::new(width, height), taken: Vec::new() }
    }

    /// Draws `numbers` in rows about `anchor`, or near it with a line that leads there.
    pub(super) fn draw(&mut self, anchor: &Point2<f64>, numbers: &[(usize, Act)], group: &mut Element) {
        if numbers.is_empty() {
            return;
        }
        let pitch = 2.0 * RADIUS + 1.0;
        let columns = numbers.len().min(COLUMNS);
        let rows = numbers.len().div_ceil(COLUMNS);
        let half = Vector2::new(columns as f64, rows as f64) * (pitch / 2.0);
        let centre = self.free_place(anchor, &half);
        self.taken.push((centre, half));
        if (centre - anchor).norm() > half.norm() {
            group.append(ink::polyline(&[*anchor, centre], &Ink::lined(palette::QUIET, 0.8)));
            group.append(ink::circle(anchor, 1.8, &Ink::filled(palette::QUIET)));
        }
        for (index, (number, act)) in numbers.iter().enumerate() {
            let (row, column) = (index / COLUMNS, index % COLUMNS);
            let offset = Vector2::new(column as f64 + 0.5, row as f64 + 0.5) * pitch - half;
            group.append(badge(&(centre + offset), *number, *act));
        }
    }

    /// The free place nearest to `anchor`, or `anchor` itself when all is full.
    // HEURISTIC: rings of sixteen places, six units apart; the first free one is near enough.
    fn free_place(&self, anchor: &Point2<f64>, half: &Vector2<f64>) -> Point2<f64> {
        let mut radius = 0.0;
        while radius <= FARTHEST {
            for turn in 0..16_u32 {
                let (sine, cosine) = (std::f64::consts::TAU * f64::from(turn) / 16.0).sin_cos();
                let place = anchor + Vector2::new(cosine, -sine) * radius;
                if self.is_free(&place, half) {
                    return place;
                }
            }
            radius += 6.0;
        }
        *anchor
    }

    fn is_free(&self, place: &Point2<f64>, half: &Vector2<f64>) -> bool {
        let (low, high) = (place - half, place + half);
        let inside = low.x >= 1.0 && low.y >= 1.0 && high.x <= self.size.x - 1.0 && high.y <= self.size.y - 1.0;
        let apart = |(other, extent): &(Point2<f64>, Vector2<f64>)| {
            let gap = (place - other).abs() - half - extent;
            gap.x > 1.0 || gap.y > 1.0
        };
        inside && self.taken.iter().all(apart)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clusters_at_one_place_are_moved_apart() {
        let mut badges = Badges::new((300.0, 300.0));
        let mut group = Element::new("g");
        for number in 0..12 {
            badges.draw(&Point2::new(5.0, 150.0), &[(number, Act::Push); 3], &mut group);
        }
        for (index, (a, half)) in badges.taken.iter().enumerate() {
            assert!(a.x - half.x >= 0.0);
            for (b, extent) in &badges.taken[..index] {
                let gap = (a - b).abs() - half - extent;
                assert!(gap.x > 0.0 || gap.y > 0.0);
            }
        }
    }
}
