//! From the world to the page: three parallel projections and the windows that show them.

use nalgebra::{Point2, Point3};

/// From where the world is seen. Flat coordinates are metres, first to the right, second up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Projection {
    /// From above; +x up, +y to the left, as the robot at its start sees it.
    Above,
    /// From the right of the room (y negative); +x to the right, z up.
    FromTheRight,
    /// From behind the robot (x negative); +y to the left, z up.
    FromBehind,
}

impl Projection {
    /// Where a point of the world appears (m).
    pub(super) fn flat(self, p: &Point3<f64>) -> Point2<f64> {
        match self {
            Self::Above => Point2::new(-p.y, p.x),
            Self::FromTheRight => Point2::new(p.x, p.z),
            Self::FromBehind => Point2::new(-p.y, p.z),
        }
    }

    /// How near to the viewer a point is (m); what is nearer is drawn later.
    pub(super) fn nearness(self, p: &Point3<f64>) -> f64 {
        match self {
            Self::Above => p.z,
            Self::FromTheRight => -p.y,
            Self::FromBehind => -p.x,
        }
    }

    /// Names of the world axes to the right and up, with the sign that has them point that way.
    pub(super) fn axes(self) -> [&'static str; 2] {
        match self {
            Self::Above => ["\u{2212}y", "x"],
            Self::FromTheRight => ["x", "z"],
            Self::FromBehind => ["\u{2212}y", "z"],
        }
    }
}

/// A rectangle of flat coordinates, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window {
    /// Lower left corner.
    pub(super) low: Point2<f64>,
    /// Upper right corner.
    pub(super) high: Point2<f64>,
}

impl Window {
    /// The smallest window around `points`; `None` when there are none.
    pub(super) fn around(points: impl IntoIterator<Item = Point2<f64>>) -> Option<Self> {
        points.into_iter().filter(|p| p.x.is_finite() && p.y.is_finite()).fold(None, |window, p| {
            let w = window.unwrap_or(Self { low: p, high: p });
            Some(Self { low: w.low.inf(&p), high: w.high.sup(&p) })
        })
    }

    /// A window of the given size about `centre`.
    pub(super) fn centred(centre: &Point2<f64>, width: f64, height: f64) -> Self {
        let half = nalgebra::Vector2::new(width / 2.0, height / 2.0);
        Self { low: centre - half, high: centre + half }
    }

    /// The window with a margin on every side.
    pub(super) fn padded(self, margin: f64) -> Self {
        let margin = nalgebra::Vector2::repeat(margin);
        Self { low: self.low - margin, high: self.high + margin }
    }

    /// Width and height (m), at least a millimetre.
    pub(super) fn size(&self) -> (f64, f64) {
        let size = self.high - self.low;
        (size.x.max(1e-3), size.y.max(1e-3))
    }
}

/// A window of the world at a place of the page, in page units from the top left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View {
    /// From where the world is seen.
    pub(super) projection: Projection,
    /// What is shown.
    pub(super) window: Window,
    /// Page units per metre.
    pub(super) scale: f64,
}

impl View {
    /// A view as wide as `width` page units, and no higher than `height`.
    pub(super) fn fitted(projection: Projection, window: Window, width: f64, height: f64) -> Self {
        let (w, h) = window.size();
        Self { projection, window, scale: (width / w).min(height / h) }
    }

    /// The same, with more of the world around it so that it fills a frame of this size.
    pub(super) fn filling(self, width: f64, height: f64) -> Self {
        let (w, h) = self.window.size();
        let scale = (width / w).min(height / h);
        let centre = nalgebra::center(&self.window.low, &self.window.high);
        Self { window: Window::centred(&centre, width / scale, height / scale), scale, ..self }
    }

    /// Width and height in page units.
    pub(super) fn size(&self) -> (f64, f64) {
        let (w, h) = self.window.size();
        (w * self.scale, h * self.scale)
    }

    /// Where a flat point lands, page units from the top left of the view.
    pub(super) fn place(&self, flat: &Point2<f64>) -> Point2<f64> {
        Point2::new((flat.x - self.window.low.x) * self.scale, (self.window.high.y - flat.y) * self.scale)
    }

    /// Where a point of the world lands.
    pub(super) fn see(&self, p: &Point3<f64>) -> Point2<f64> {
        self.place(&self.projection.flat(p))
    }

    /// The silhouette of a convex solid given by its corners.
    pub(super) fn silhouette(&self, points: &[Point3<f64>]) -> Vec<Point2<f64>> {
        super::outline::hull(points.iter().map(|p| self.see(p)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_robot_looks_up_from_above_and_stands_upright_from_the_side() {
        let window = Window { low: Point2::new(-1.0, -2.0), high: Point2::new(3.0, 4.0) };
        let view = |projection| View::fitted(projection, window, 400.0, 1e9);
        let (ahead, left) = (Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0));
        let above = view(Projection::Above);
        let origin = above.see(&Point3::origin());
        assert!(above.see(&ahead).y < origin.y && above.see(&left).x < origin.x);
        assert_eq!(above.size(), (400.0, 600.0));
        for projection in [Projection::FromTheRight, Projection::FromBehind] {
            let side = view(projection);
            assert!(side.see(&Point3::new(0.0, 0.0, 1.0)).y < side.see(&Point3::origin()).y);
        }
        assert!(Projection::FromTheRight.nearness(&left) < 0.0 && Projection::FromBehind.nearness(&ahead) < 0.0);
    }

    #[test]
    fn a_filling_view_shows_at_least_as_much() {
        let window = Window { low: Point2::new(-1.0, -2.0), high: Point2::new(3.0, 4.0) };
        let view = View::fitted(Projection::Above, window, 100.0, 300.0).filling(400.0, 300.0);
        assert!((view.size().0 - 400.0).abs() < 1e-9 && (view.size().1 - 300.0).abs() < 1e-9);
        assert!(view.window.low.x <= -1.0 && view.window.high.x >= 3.0 && view.scale == 50.0);
    }

    #[test]
    fn windows_ignore_what_is_not_finite() {
        assert_eq!(Window::around([Point2::new(f64::NAN, 0.0)]), None);
        let window = Window::around([Point2::new(0.0, 1.0), Point2::new(2.0, -1.0)]).unwrap().padded(0.5);
        assert_eq!(window.size(), (3.0, 3.0));
        assert_eq!(Window::centred(&Point2::origin(), 0.0, 0.0).size(), (1e-3, 1e-3));
    }
}
