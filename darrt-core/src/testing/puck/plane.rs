//! The little plane geometry that the domain needs.

use super::world::Point;

/// Metres between two points.
pub(super) fn distance(a: &Point, b: &Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Unit vector from `a` to `b`; `None` if they are less than a nanometre apart.
pub(super) fn direction(a: &Point, b: &Point) -> Option<Point> {
    let d = distance(a, b);
    (d > 1e-9).then(|| [(b[0] - a[0]) / d, (b[1] - a[1]) / d])
}

/// The point `s` metres from `from` along the unit vector `direction`.
pub(super) fn along(from: &Point, direction: &Point, s: f64) -> Point {
    [from[0] + s * direction[0], from[1] + s * direction[1]]
}

/// `a + b`.
pub(super) fn add(a: &Point, b: &Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

/// `a - b`.
pub(super) fn subtract(a: &Point, b: &Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

/// Signed metres from `p` to the rectangle `[lower, upper]`: negative inside, by the depth.
pub(super) fn to_rectangle(p: &Point, lower: &Point, upper: &Point) -> f64 {
    let dx = (lower[0] - p[0]).max(p[0] - upper[0]);
    let dy = (lower[1] - p[1]).max(p[1] - upper[1]);
    dx.max(0.0).hypot(dy.max(0.0)) + dx.max(dy).min(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_to_a_rectangle_is_exact_outside_on_and_inside() {
        let (lower, upper) = ([0.0, 0.0], [2.0, 1.0]);
        for (p, expected) in [
            ([3.0, 0.5], 1.0),
            ([5.0, 5.0], 5.0),
            ([1.0, -0.25], 0.25),
            ([2.0, 0.5], 0.0),
            ([1.0, 0.5], -0.5),
            ([0.1, 0.5], -0.1),
        ] {
            assert!((to_rectangle(&p, &lower, &upper) - expected).abs() < 1e-15, "{p:?}");
        }
    }

    #[test]
    fn no_direction_between_equal_points() {
        assert_eq!(direction(&[1.0, 1.0], &[1.0, 1.0]), None);
        assert_eq!(direction(&[0.0, 0.0], &[3.0, 4.0]), Some([0.6, 0.8]));
        assert_eq!(direction(&[f64::NAN, 0.0], &[3.0, 4.0]), None);
    }
}
