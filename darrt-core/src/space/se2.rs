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
}
