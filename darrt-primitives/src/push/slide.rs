//! The way of a pushed object over a surface: straight, or an arc of a circle along which it turns with the hand.

use std::f64::consts::PI;

use darrt_core::space::so2::wrap;
use nalgebra::{Isometry3, Rotation2, Unit, UnitQuaternion, Vector2, Vector3};

/// A turn that is no turn, radians: what rounding may do to a pose that was never turned.
const NO_TURN_RAD: f64 = 1e-12;

/// An even planar motion from one pose to another at the same height: everything turns about one vertical axis, or, without a
/// turn, everything goes straight.
///
/// # Laws
/// `at(0)` and `at(1)` are the two poses, bit for bit; equal steps of the share are equally long and turn equally far; and any
/// part of a slide is the slide between its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slide {
    from: Isometry3<f64>,
    to: Isometry3<f64>,
    /// About the vertical, counter-clockwise, in `(-pi, pi]`.
    turn: f64,
}

impl Slide {
    /// The motion from one upright pose to another; which of the two ways round is decided by the shorter turn.
    pub fn new(from: Isometry3<f64>, to: Isometry3<f64>) -> Self {
        let turn = if from.rotation == to.rotation { 0.0 } else { yaw_between(&from, &to) };
        Self { from, to, turn: if turn.abs() < NO_TURN_RAD { 0.0 } else { turn } }
    }

    /// The slide of an object at `from` whose centre goes along an arc to `to` (world x and y, metres), turned by `turn`
    /// radians, counter-clockwise, in `(-pi, pi)`.
    pub fn along_arc(from: Isometry3<f64>, to: &Vector2<f64>, turn: f64) -> Self {
        let mut end = from;
        (end.translation.x, end.translation.y) = (to.x, to.y);
        if turn != 0.0 {
            end.rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn) * from.rotation;
        }
        Self { from, to: end, turn }
    }

    /// Where it begins.
    pub fn from(&self) -> &Isometry3<f64> {
        &self.from
    }

    /// Where it ends.
    pub fn to(&self) -> &Isometry3<f64> {
        &self.to
    }

    /// How far it turns in all, radians, counter-clockwise.
    pub fn turn(&self) -> f64 {
        self.turn
    }

    /// The way of its centre, metres.
    pub fn length_m(&self) -> f64 {
        self.chord().norm() * arc_over_chord(self.turn)
    }

    /// Turn per metre of the centre's way, 1/m, counter-clockwise; 0 if it does not turn, infinite if it only turns.
    pub fn curvature(&self) -> f64 {
        if self.turn == 0.0 { 0.0 } else { self.turn / self.length_m() }
    }

    /// The direction in which its centre sets out; `None` if it stays.
    pub fn heading(&self) -> Option<Unit<Vector2<f64>>> {
        Unit::try_new(Rotation2::new(-self.turn / 2.0) * self.chord(), 1e-12)
    }

    /// Where the object is when `share` of the way is done, in `[0, 1]`.
    pub fn at(&self, share: f64) -> Isometry3<f64> {
        if share >= 1.0 {
            return self.to;
        }
        if share <= 0.0 {
            return self.from;
        }
        let mut pose = self.from;
        let chord = self.chord();
        let gone = if self.turn == 0.0 {
            chord * share
        } else {
            // The chord to a part of an arc is as long as the sine of half its turn, and turned back by half of what is left.
            let (half, part) = (self.turn / 2.0, self.turn * share / 2.0);
            pose.rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.turn * share) * self.from.rotation;
            Rotation2::new(part - half) * chord * (part.sin() / half.sin())
        };
        pose.translation.x += gone.x;
        pose.translation.y += gone.y;
        pose
    }

    /// The same as far as `share` of it.
    #[must_use]
    pub fn until(&self, share: f64) -> Self {
        Self { from: self.from, to: self.at(share), turn: self.turn * share.clamp(0.0, 1.0) }
    }

    fn chord(&self) -> Vector2<f64> {
        self.to.translation.vector.xy() - self.from.translation.vector.xy()
    }
}

/// How much longer an arc that turns by `turn` radians is than the chord between its ends.
pub fn arc_over_chord(turn: f64) -> f64 {
    let half = turn / 2.0;
    if half == 0.0 { 1.0 } else { half / half.sin() }
}

/// By how much the second pose is turned about the vertical against the first, radians in `[-pi, pi]`.
fn yaw_between(from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
    let turn = to.rotation * from.rotation.inverse();
    // The turn about the vertical of a rotation that is one: twice the angle of the quaternion.
    let half = turn.k.atan2(turn.w);
    let yaw = wrap(2.0 * half);
    if yaw <= -PI { PI } else { yaw }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pose(x: f64, y: f64, yaw: f64) -> Isometry3<f64> {
        Isometry3::new(Vector3::new(x, y, 0.76), Vector3::z() * yaw)
    }

    fn differ(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
        (a.translation.vector - b.translation.vector).norm() + a.rotation.angle_to(&b.rotation)
    }

    #[test]
    fn a_quarter_of_a_circle() {
        // About (0, 1), from below it to its right.
        let slide = Slide::new(pose(0.0, 0.0, 0.3), pose(1.0, 1.0, 0.3 + PI / 2.0));
        assert!((slide.turn() - PI / 2.0).abs() < 1e-12 && (slide.length_m() - PI / 2.0).abs() < 1e-12);
        assert!((slide.curvature() - 1.0).abs() < 1e-12);
        assert!((slide.heading().unwrap().into_inner() - Vector2::x()).norm() < 1e-12);
        let (half, diagonal) = (slide.at(0.5), 0.5_f64.sqrt());
        assert!(differ(&half, &pose(diagonal, 1.0 - diagonal, 0.3 + PI / 4.0)) < 1e-12, "{half}");
    }

    #[test]
    fn what_does_not_turn_goes_straight() {
        let (a, b) = (pose(0.1, 0.2, 1.0), pose(0.4, -0.2, 1.0));
        let slide = Slide::new(a, b);
        assert_eq!((slide.turn(), slide.curvature(), slide.at(0.0), slide.at(1.0)), (0.0, 0.0, a, b));
        assert!((slide.length_m() - 0.5).abs() < 1e-12);
        assert!(differ(&slide.at(0.25), &pose(0.175, 0.1, 1.0)) < 1e-12);
    }

    proptest! {
        #[test]
        fn a_part_of_a_slide_is_the_slide_between_its_ends(
            x in -1.0..1.0_f64, y in -1.0..1.0_f64, yaw in -3.0..3.0_f64, turn in -2.5..2.5_f64,
            parts in (0.0..1.0_f64, 0.0..1.0_f64, 0.0..1.0_f64),
        ) {
            let slide = Slide::new(pose(0.0, 0.0, yaw), pose(x, y, yaw + turn));
            prop_assert!((slide.turn() - turn).abs() < 1e-9);
            let (low, high) = (parts.0.min(parts.1), parts.0.max(parts.1));
            let part = Slide::new(slide.at(low), slide.at(high));
            let there = part.at(parts.2);
            let expected = slide.at(low + (high - low) * parts.2);
            prop_assert!(differ(&there, &expected) < 1e-9, "{there} {expected}");
            prop_assert!((part.length_m() - (high - low) * slide.length_m()).abs() < 1e-9);
            let until = slide.until(high);
            prop_assert!(differ(&until.at(parts.2), &slide.at(high * parts.2)) < 1e-9);
        }

        #[test]
        fn everything_turns_about_one_point(
            x in -1.0..1.0_f64, y in -1.0..1.0_f64, turn in 0.1..2.5_f64, share in 0.0..1.0_f64,
        ) {
            let slide = Slide::along_arc(pose(0.0, 0.0, 0.0), &Vector2::new(x, y), turn);
            prop_assume!(x.hypot(y) > 0.01);
            let heading = slide.heading().unwrap().into_inner();
            let centre = Vector2::new(-heading.y, heading.x) / slide.curvature();
            let still = slide.from().inverse_transform_point(&nalgebra::Point3::new(centre.x, centre.y, 0.0));
            let moved = slide.at(share) * still;
            prop_assert!((moved.xy().coords - centre).norm() < 1e-9, "{moved} {centre}");
        }
    }
}
