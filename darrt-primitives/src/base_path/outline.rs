//! Convex outlines in the plane of the floor, and the signed distance between two of them.
//!
//! # Source
//! Separating axes and the nearest features of convex polygons: Ericson, Real-Time Collision Detection, 2005, sections 5.2.1
//! and 5.1.9.

use nalgebra::Vector2;

/// All points within a radius of a convex polygon. A disc has one corner, a rod two.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Outline {
    /// Counter-clockwise.
    corners: Vec<Vector2<f64>>,
    /// Outward unit normal of the edge from each corner to the next; none for a disc, two for a rod.
    normals: Vec<Vector2<f64>>,
    radius_m: f64,
    centre: Vector2<f64>,
    reach_m: f64,
    farthest_m: f64,
}

/// A pose in the plane, ready to be applied.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    cos: f64,
    sin: f64,
    origin: Vector2<f64>,
}

/// Where two outlines are nearest, or deepest in each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Contact {
    /// Distance in metres when positive. Otherwise minus how far they must be moved apart; for outlines with a radius that is
    /// a bound only as long as their polygons are apart.
    pub(crate) distance_m: f64,
    /// Unit vector along which the first outline leaves the second.
    pub(crate) away: Vector2<f64>,
    /// The point of the first outline's polygon that is nearest.
    pub(crate) at: Vector2<f64>,
}

impl Frame {
    pub(crate) fn new([x, y, yaw]: &[f64; 3]) -> Self {
        let (sin, cos) = yaw.sin_cos();
        Self { cos, sin, origin: Vector2::new(*x, *y) }
    }

    /// A direction of this frame, in the world.
    pub(crate) fn turned(&self, v: &Vector2<f64>) -> Vector2<f64> {
        Vector2::new(self.cos * v.x - self.sin * v.y, self.sin * v.x + self.cos * v.y)
    }

    /// A direction of the world, in this frame.
    fn turned_back(&self, v: &Vector2<f64>) -> Vector2<f64> {
        Vector2::new(self.cos * v.x + self.sin * v.y, self.cos * v.y - self.sin * v.x)
    }

    /// A point of the world, in this frame.
    pub(crate) fn local(&self, p: &Vector2<f64>) -> Vector2<f64> {
        self.turned_back(&(p - self.origin))
    }
}

impl Outline {
    /// The smallest outline that holds discs of one radius around `points`. `None` without points.
    pub(crate) fn around(points: &mut Vec<Vector2<f64>>, radius_m: f64) -> Option<Self> {
        let corners = convex_hull(points);
        let (low, high) = corners.iter().fold(None, |bounds: Option<(Vector2<f64>, Vector2<f64>)>, p| {
            Some(bounds.map_or((*p, *p), |(low, high)| (low.inf(p), high.sup(p))))
        })?;
        let centre = 0.5 * (low + high);
        let reach_m = corners.iter().map(|p| (p - centre).norm()).fold(0.0, f64::max) + radius_m;
        let farthest_m = corners.iter().map(Vector2::norm).fold(0.0, f64::max) + radius_m;
        let mut outline = Self { corners, normals: Vec::new(), radius_m, centre, reach_m, farthest_m };
        outline.find_normals();
        Some(outline)
    }

    fn find_normals(&mut self) {
        let ends = self.corners.iter().cycle().skip(1);
        let outward = |(a, b): (&Vector2<f64>, &Vector2<f64>)| Vector2::new(b.y - a.y, a.x - b.x).normalize();
        self.normals.clear();
        if self.corners.len() > 1 {
            self.normals.extend(self.corners.iter().zip(ends).map(outward));
        }
    }

    /// Centre of a circle around the outline.
    pub(crate) fn centre(&self) -> &Vector2<f64> {
        &self.centre
    }

    /// Radius of a circle around the outline, metres.
    pub(crate) fn reach_m(&self) -> f64 {
        self.reach_m
    }

    /// Distance of the farthest point from the origin, metres.
    pub(crate) fn farthest_m(&self) -> f64 {
        self.farthest_m
    }

    /// The same as seen from `frame`, written over `out`.
    pub(crate) fn seen_from(&self, frame: &Frame, out: &mut Self) {
        out.corners.clear();
        out.corners.extend(self.corners.iter().map(|p| frame.local(p)));
        out.normals.clear();
        out.normals.extend(self.normals.iter().map(|n| frame.turned_back(n)));
        out.radius_m = self.radius_m;
        out.centre = frame.local(&self.centre);
        out.reach_m = self.reach_m;
        out.farthest_m = f64::INFINITY;
    }

    /// Lower bound of the signed distance from a point: exact inside and beside an edge.
    pub(crate) fn beyond_edges(&self, point: &Vector2<f64>) -> f64 {
        let from_disc = || self.corners.first().map_or(f64::INFINITY, |corner| (point - corner).norm());
        let over = self.normals.iter().zip(&self.corners).map(|(n, corner)| n.dot(&(point - corner)));
        over.fold(None, |most: Option<f64>, d| Some(most.map_or(d, |most| most.max(d)))).unwrap_or_else(from_disc)
            - self.radius_m
    }

    /// Signed distance from a point, metres.
    pub(crate) fn beyond_m(&self, point: &Vector2<f64>) -> f64 {
        let inside = self.beyond_edges(point);
        if self.normals.len() > 2 && inside <= -self.radius_m {
            return inside;
        }
        let (_, nearest) = nearest(std::slice::from_ref(point), &self.corners);
        (point - nearest).norm() - self.radius_m
    }

    /// Does every point of `other` lie in this outline?
    pub(crate) fn holds(&self, other: &Self) -> bool {
        // A rod has no inside of its own: its two normals say nothing of its ends.
        let is_plump = self.corners.len() != 2;
        is_plump && other.corners.iter().all(|corner| self.beyond_edges(corner) + other.radius_m <= 0.0)
    }

    /// Half way from this outline to the one that it is apart from with this contact.
    pub(crate) fn beside(&self, contact: &Contact) -> Vector2<f64> {
        contact.at - contact.away * (self.radius_m + 0.5 * contact.distance_m)
    }

    /// Where this outline and `other` are nearest. What is at least `enough` metres away may be nearer than it says.
    pub(crate) fn contact(&self, other: &Self, enough: f64) -> Contact {
        let radii = self.radius_m + other.radius_m;
        let mut best = Contact { distance_m: f64::NEG_INFINITY, away: Vector2::x(), at: self.centre };
        for (n, corner) in other.normals.iter().zip(&other.corners) {
            let (d, at) = lowest(&self.corners, corner, n);
            if d > best.distance_m {
                best = Contact { distance_m: d, away: *n, at };
            }
        }
        for (n, corner) in self.normals.iter().zip(&self.corners) {
            let (d, at) = lowest(&other.corners, corner, n);
            if d > best.distance_m {
                best = Contact { distance_m: d, away: -n, at: at - n * d };
            }
        }
        let has_ends = self.normals.len() < 3 || other.normals.len() < 3;
        let is_far = best.distance_m - radii >= enough;
        // Apart: the nearest points may be two corners. The polygons of rods and discs are apart where no edge says so.
        if !is_far && (best.distance_m > 0.0 || has_ends && best.distance_m >= -FLAT_M) {
            let (own, others) = nearest(&self.corners, &other.corners);
            let apart = own - others;
            let distance_m = apart.norm();
            if distance_m > best.distance_m.max(0.0) {
                best = Contact { distance_m, away: apart / distance_m, at: own };
            }
        } else if best.distance_m == f64::NEG_INFINITY {
            let apart = self.centre - other.centre;
            let distance_m = apart.norm();
            let away = if distance_m > 0.0 { apart / distance_m } else { Vector2::x() };
            best = Contact { distance_m, away, at: self.centre };
        }
        best.distance_m -= radii;
        best
    }
}

/// Rounding in which a point lies on a line, metres.
const FLAT_M: f64 = 1e-9;

/// The least `n . (p - corner)` over `points`, and which.
fn lowest(points: &[Vector2<f64>], corner: &Vector2<f64>, n: &Vector2<f64>) -> (f64, Vector2<f64>) {
    let first = (f64::INFINITY, *corner);
    points.iter().fold(first, |least, p| {
        let d = n.dot(&(p - corner));
        if d < least.0 { (d, *p) } else { least }
    })
}

/// The nearest points of two polygons that do not meet, the first one's first.
fn nearest(a: &[Vector2<f64>], b: &[Vector2<f64>]) -> (Vector2<f64>, Vector2<f64>) {
    let mut best = (f64::INFINITY, (Vector2::zeros(), Vector2::zeros()));
    for (corners, edges, is_first) in [(a, b, true), (b, a, false)] {
        for p in corners {
            for (start, end) in edges.iter().zip(edges.iter().cycle().skip(1)) {
                let edge = end - start;
                let length = edge.norm_squared();
                let t = if length > 0.0 { ((p - start).dot(&edge) / length).clamp(0.0, 1.0) } else { 0.0 };
                let on_edge = start + edge * t;
                let d = (p - on_edge).norm_squared();
                if d < best.0 {
                    best = (d, if is_first { (*p, on_edge) } else { (on_edge, *p) });
                }
            }
        }
    }
    best.1
}

/// Corners of the convex hull, counter-clockwise, without those in the middle of an edge. Sorts the points.
///
/// # Source
/// Andrew, Another efficient algorithm for convex hulls in two dimensions, 1979.
fn convex_hull(points: &mut Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup_by(|a, b| (*a - *b).norm() < FLAT_M);
    let mut hull: Vec<Vector2<f64>> = Vec::with_capacity(points.len());
    let mut lower_end = 1;
    let back = points.iter().rev().skip(1);
    for (i, p) in points.iter().chain(back).enumerate() {
        if i == points.len() {
            lower_end = hull.len();
        }
        while hull.len() > lower_end
            && let [.., a, b] = hull.as_slice()
            && (b - a).perp(&(p - a)) <= FLAT_M * (p - a).norm()
        {
            hull.pop();
        }
        hull.push(*p);
    }
    if hull.len() > 1 {
        hull.pop();
    }
    hull
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn outline(points: &[[f64; 2]], radius_m: f64) -> Outline {
        Outline::around(&mut points.iter().map(|p| Vector2::from(*p)).collect(), radius_m).unwrap()
    }

    fn square(half: f64, at: [f64; 2]) -> Outline {
        let [x, y] = at;
        outline(&[[x - half, y - half], [x + half, y - half], [x + half, y + half], [x - half, y + half]], 0.0)
    }

    fn moved(outline: &Outline, by: &Vector2<f64>) -> Outline {
        Outline::around(&mut outline.corners.iter().map(|p| p + by).collect(), outline.radius_m).unwrap()
    }

    #[test]
    fn hulls_have_corners_only() {
        let mut points: Vec<_> = (0..25).map(|i| Vector2::new(f64::from(i % 5), f64::from(i / 5))).collect();
        let hull = Outline::around(&mut points, 0.0).unwrap();
        assert_eq!(hull.corners.len(), 4);
        assert!(hull.normals.iter().zip(&hull.corners).all(|(n, c)| n.dot(&(hull.centre - c)) < -1.9));
        assert_eq!(outline(&[[1.0, 2.0]; 3], 0.1).corners.len(), 1);
        assert_eq!(outline(&[[0.0, 0.0], [1.0, 1.0], [0.5, 0.5]], 0.1).corners.len(), 2);
        assert!(Outline::around(&mut Vec::new(), 1.0).is_none());
    }

    #[test]
    fn known_distances() {
        let unit = square(1.0, [0.0, 0.0]);
        let far = f64::INFINITY;
        let cases = [
            (square(1.0, [3.0, 0.5]), 1.0),
            (square(1.0, [5.0, 6.0]), 5.0),
            (square(1.0, [1.5, 0.0]), -0.5),
            (outline(&[[4.0, 5.0]], 0.5), 4.5),
            (outline(&[[1.25, 0.0]], 0.5), -0.25),
            (outline(&[[4.0, 0.0], [9.0, 0.0]], 1.0), 2.0),
        ];
        for (other, expected) in cases {
            assert!((unit.contact(&other, far).distance_m - expected).abs() < 1e-12, "{other:?}");
            assert!((other.contact(&unit, far).distance_m - expected).abs() < 1e-12, "{other:?}");
        }
        let rod = outline(&[[0.0, 0.0], [1.0, 0.0]], 0.1);
        assert!((rod.contact(&outline(&[[3.0, 0.0], [4.0, 0.0]], 0.1), far).distance_m - 1.8).abs() < 1e-12);
        assert!((rod.contact(&outline(&[[3.0, 0.0]], 0.1), far).distance_m - 1.8).abs() < 1e-12);
        let disc = outline(&[[0.0, 0.0]], 1.0);
        assert!((disc.contact(&outline(&[[3.0, 4.0]], 1.0), far).distance_m - 3.0).abs() < 1e-12);
        assert!(disc.contact(&disc, far).distance_m <= -2.0);
    }

    #[test]
    fn what_holds_and_what_does_not() {
        let unit = square(1.0, [0.0, 0.0]);
        assert!(unit.holds(&square(0.5, [0.4, 0.4])) && !unit.holds(&square(0.5, [0.6, 0.0])));
        assert!(unit.holds(&outline(&[[0.5, 0.0]], 0.5)) && !unit.holds(&outline(&[[0.6, 0.0]], 0.5)));
        assert!(outline(&[[0.0, 0.0]], 2.0).holds(&unit) && !outline(&[[0.0, 0.0]], 1.3).holds(&unit));
        assert!(!outline(&[[0.0, 0.0], [1.0, 0.0]], 0.1).holds(&outline(&[[5.0, 0.0]], 0.01)));
    }

    fn any_outline() -> impl Strategy<Value = Outline> {
        (prop::collection::vec(prop::array::uniform2(-1.0_f64..1.0), 1..7), 0.0_f64..0.3)
            .prop_map(|(points, radius)| outline(&points, radius))
    }

    proptest! {
        /// The distance is that of sample points at best, and moving apart by what is missing separates.
        #[test]
        fn distances_are_distances(a in any_outline(), b in any_outline(), by in prop::array::uniform2(-3.0_f64..3.0)) {
            let b = moved(&b, &Vector2::from(by));
            let found = a.contact(&b, f64::INFINITY);
            let back = b.contact(&a, f64::INFINITY);
            prop_assert!((found.distance_m - back.distance_m).abs() < 1e-9);
            prop_assert!((found.away.norm() - 1.0).abs() < 1e-9);
            let cores = |p: &Vector2<f64>| b.corners.iter().map(|q| (p - q).norm()).fold(f64::INFINITY, f64::min);
            let seen = a.corners.iter().map(cores).fold(f64::INFINITY, f64::min) - a.radius_m - b.radius_m;
            prop_assert!(found.distance_m <= seen + 1e-9);
            // No nearer than said: a shift by less than the distance never makes them meet.
            if found.distance_m > 0.0 {
                let shifted = moved(&a, &(-found.away * (found.distance_m + 1e-6)));
                prop_assert!(shifted.contact(&b, f64::INFINITY).distance_m <= 1e-9);
                for turn in 0..8 {
                    let (sin, cos) = f64::from(turn).sin_cos();
                    let shifted = moved(&a, &(Vector2::new(cos, sin) * (found.distance_m - 1e-6)));
                    prop_assert!(shifted.contact(&b, f64::INFINITY).distance_m > 0.0);
                }
            } else if a.normals.len() > 2 && b.normals.len() > 2 {
                let shifted = moved(&a, &(found.away * (1e-6 - found.distance_m)));
                prop_assert!(shifted.contact(&b, f64::INFINITY).distance_m > -1e-9, "{}", shifted.contact(&b, f64::INFINITY).distance_m);
            }
        }

        /// A bound that is enough is a lower bound.
        #[test]
        fn what_is_enough_is_not_too_much(a in any_outline(), b in any_outline(), by in prop::array::uniform2(-3.0_f64..3.0), enough in 0.0_f64..2.0) {
            let b = moved(&b, &Vector2::from(by));
            let (exact, quick) = (a.contact(&b, f64::INFINITY).distance_m, a.contact(&b, enough).distance_m);
            prop_assert!(quick <= exact + 1e-12 && (quick == exact || quick >= enough));
        }

        /// Seen from elsewhere the distance is the same.
        #[test]
        fn frames_change_nothing(a in any_outline(), b in any_outline(), pose in prop::array::uniform3(-3.0_f64..3.0)) {
            let frame = Frame::new(&pose);
            let (mut a_seen, mut b_seen) = (Outline::default(), Outline::default());
            a.seen_from(&frame, &mut a_seen);
            b.seen_from(&frame, &mut b_seen);
            let (here, there) = (a.contact(&b, f64::INFINITY), a_seen.contact(&b_seen, f64::INFINITY));
            prop_assert!((here.distance_m - there.distance_m).abs() < 1e-9);
        }
    }
}
