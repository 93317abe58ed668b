//! Position and heading in a bounded plane.

use rand::Rng;

use super::so2::{So2, turn, wrap};
use super::{ComponentSpace, RealBox};
use crate::error::Error;

/// `[x, y, yaw]`, metres and radians, `yaw` in `[-pi, pi]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Se2 {
    position: RealBox<2>,
    heading: So2,
    metres_per_rad: f64,
}

impl Se2 {
    /// A rectangle of positions and all headings; a turn of one radian costs `metres_per_rad` metres.
    ///
    /// # Errors
    /// [`Error::Parameter`] for bounds that are not finite or inverted, or a radius that is not positive.
    pub fn new(lower: [f64; 2], upper: [f64; 2], metres_per_rad: f64) -> Result<Self, Error> {
        Ok(Self { position: RealBox::new(lower, upper)?, heading: So2::new(metres_per_rad)?, metres_per_rad })
    }

    /// The rectangle of positions.
    pub fn position(&self) -> &RealBox<2> {
        &self.position
    }
}

impl ComponentSpace for Se2 {
    type Config = [f64; 3];

    fn dimension(&self) -> usize {
        3
    }

    fn contains(&self, [x, y, yaw]: &[f64; 3]) -> bool {
        self.position.contains(&[*x, *y]) && self.heading.contains(yaw)
    }

    fn distance(&self, a: &[f64; 3], b: &[f64; 3]) -> f64 {
        (a[0] - b[0]).hypot(a[1] - b[1]) + turn(a[2], b[2]).abs() * self.metres_per_rad
    }

    fn interpolate(&self, a: &[f64; 3], b: &[f64; 3], t: f64) -> [f64; 3] {
        if t <= 0.0 {
            return *a;
        }
        if t >= 1.0 {
            return *b;
        }
        let [x, y] = self.position.interpolate(&[a[0], a[1]], &[b[0], b[1]], t);
        [x, y, wrap(a[2] + turn(a[2], b[2]) * t)]
    }

    fn sample(&self, rng: &mut dyn Rng) -> [f64; 3] {
        let [x, y] = self.position.sample(rng);
        [x, y, self.heading.sample(rng)]
    }

    fn index_coordinates(&self, [x, y, yaw]: &[f64; 3], mark: &mut dyn FnMut(u32, f64)) {
        mark(0, *x);
        mark(0, *y);
        self.heading.index_coordinates(yaw, mark);
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn distance_adds_travel_and_turn() {
        let plane = Se2::new([-1.0; 2], [5.0; 2], 0.5).unwrap();
        assert!((plane.distance(&[0.0, 0.0, 3.0], &[3.0, 4.0, -3.0]) - (5.0 + 0.5 * (2.0 * PI - 6.0))).abs() < 1e-12);
        assert!(!plane.contains(&[0.0, 0.0, 3.2]) && !plane.contains(&[6.0, 0.0, 0.0]));
        assert!(!plane.contains(&[f64::NAN, 0.0, 0.0]) && !plane.contains(&[0.0, 0.0, f64::NAN]));
    }

    #[test]
    fn the_heading_takes_the_short_way_and_the_ends_are_exact() {
        let plane = Se2::new([-1.0; 2], [5.0; 2], 0.5).unwrap();
        let (a, b) = ([0.1, 0.2, 3.1], [0.7, -0.3, -3.1]);
        assert_eq!(plane.interpolate(&a, &b, 0.0), a);
        assert_eq!(plane.interpolate(&a, &b, 1.0), b);
        for i in 0..=10_u8 {
            let [_, _, yaw] = plane.interpolate(&a, &b, f64::from(i) / 10.0);
            assert!(yaw.abs() > 3.09, "{yaw} goes the long way");
        }
    }
}
