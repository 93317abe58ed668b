use super::*;
use nalgebra::Unit;
use proptest::prelude::*;

const R: f64 = 0.13;

fn uniform() -> PressureConstant {
    PressureConstant::uniform_disc(R).unwrap()
}

fn mu(value: f64) -> Friction {
    Friction::new(value).unwrap()
}

fn check(pushed: Option<Pushed>, mode: ContactMode, linear: [f64; 2], angular: f64) {
    let pushed = pushed.unwrap();
    assert_eq!(pushed.mode, mode);
    assert!((pushed.twist.linear - Vector2::from(linear)).norm() < 1e-6);
    assert!((pushed.twist.angular - angular).abs() < 1e-6);
}

#[test]
fn a_disc_pushed_off_centre() {
    use ContactMode::{SlidingRightEdge, Sticking};
    let rim = PressureConstant::rim(R).unwrap();
    for (pressure, degrees, mode, linear, angular) in [
        (uniform(), 5.0, Sticking, [0.994_741, 0.060_109], 0.464_143),
        (uniform(), 15.0, Sticking, [0.953_624, 0.173_077], 1.378_326),
        (uniform(), 30.0, Sticking, [0.826_923, 0.299_778], 2.662_722),
        (uniform(), 45.0, SlidingRightEdge, [0.65, 0.35], 3.671_516),
        (uniform(), 60.0, SlidingRightEdge, [0.379_904, 0.358_013], 2.596_154),
        (rim, 30.0, Sticking, [0.875, 0.216_506], 1.923_077),
        (rim, 45.0, SlidingRightEdge, [0.65, 0.35], 1.631_785),
    ] {
        let psi: f64 = f64::to_radians(degrees);
        let contact = PointContact::on_disc(R, psi, mu(0.3)).unwrap();
        check(push(&contact, pressure, &Vector2::x()), mode, linear, angular);
    }
}

#[test]
fn a_rectangle_pushed_near_its_corner() {
    let pressure = PressureConstant::rectangle(0.30, 0.20).unwrap();
    let normal = Unit::new_normalize(Vector2::y());
    let contact = PointContact::new(Vector2::new(0.05, -0.10), normal, mu(0.3)).unwrap();
    for (vx, linear, angular) in [
        (0.0, [-0.228_600, 0.885_700], 2.285_997),
        (0.2, [-0.120_040, 0.839_980], 3.200_396),
        (0.5, [0.042_801, 0.771_400], 4.571_994),
    ] {
        let pushed = push(&contact, pressure, &Vector2::new(vx, 1.0));
        check(pushed, ContactMode::Sticking, linear, angular);
    }
    assert_eq!(push(&contact, pressure, &-Vector2::y()), None);
    assert_eq!(push(&contact, pressure, &Vector2::x()), None);
    assert_eq!(push(&contact, pressure, &Vector2::new(f64::NAN, 1.0)), None);
}

#[test]
fn e_fold_lengths() {
    let rim = PressureConstant::rim(R).unwrap();
    let length = |p, f| DiscDrift::new(R, p, mu(f)).unwrap();
    assert!((length(uniform(), 0.3).growth_length() - 0.188).abs() < 5e-4);
    assert!((length(rim, 0.3).growth_length() - 0.260).abs() < 5e-4);
    assert!((length(uniform(), 0.0).sliding_growth_length() - R).abs() < 1e-12);
}

#[test]
fn drift_table() {
    let drift = DiscDrift::new(R, uniform(), mu(0.3)).unwrap();
    // Start offset (mm), start angle, then (angle in degrees, offset in mm) after 0.1, 0.2, 0.3 m.
    let table = [
        (5.0, 2.20, [(3.753, 8.5), (6.389, 14.5), (10.861, 24.5)]),
        (10.0, 4.41, [(7.507, 17.0), (12.752, 28.7), (21.553, 47.8)]),
        (20.0, 8.85, [(15.017, 33.7), (25.306, 55.6), (41.852, 86.7)]),
    ];
    for (offset, degrees, rows) in table {
        let psi = drift.psi_of_offset(offset * 1e-3).unwrap();
        assert!((psi.to_degrees() - degrees).abs() < 5.1e-3);
        for (length, (angle, lateral)) in [0.1, 0.2, 0.3].into_iter().zip(rows) {
            let end = drift.advance(psi, length).unwrap();
            assert!((end.psi.to_degrees() - angle).abs() < 5.1e-4, "{end:?}");
            assert!((end.offset * 1e3 - lateral).abs() < 5.1e-2, "{end:?}");
            assert!((end.rotation - (end.psi - psi)).abs() < 1e-12);
            assert!(end.touching);
        }
    }
}

/// Midpoint integration of the push law itself, step by step.
fn integrate(drift: &DiscDrift, psi: f64, length: f64) -> (f64, f64) {
    let steps = 20_000;
    let ds = length / f64::from(steps);
    let law = |psi: f64| {
        let contact = PointContact::on_disc(drift.radius, psi, drift.friction).unwrap();
        let twist = push(&contact, drift.pressure, &Vector2::x()).unwrap().twist;
        // The centre moves sideways at vy = R cos(psi) psi'.
        (twist.linear.y / (drift.radius * psi.cos()), twist.angular)
    };
    let (mut psi, mut rotation) = (psi, 0.0);
    for _ in 0..steps {
        let middle = psi + 0.5 * ds * law(psi).0;
        let (rate, turn) = law(middle);
        psi += ds * rate;
        rotation += ds * turn;
    }
    (psi, rotation)
}

#[test]
fn closed_forms_agree_with_integration_across_the_cone_edge() {
    for (pressure, friction, start, length) in [
        (uniform(), 0.3, 0.5, 0.12),
        (uniform(), 0.1, 0.2, 0.15),
        (uniform(), 0.0, 0.3, 0.1),
        (PressureConstant::rim(R).unwrap(), 0.5, 0.7, 0.1),
        (PressureConstant::rim(R).unwrap(), 1.0, 1.2, 0.05),
    ] {
        let drift = DiscDrift::new(R, pressure, mu(friction)).unwrap();
        let (psi, rotation) = integrate(&drift, start, length);
        let end = drift.advance(start, length).unwrap();
        assert!((end.psi - psi).abs() < 1e-6, "{} {psi}", end.psi);
        assert!((end.rotation - rotation).abs() < 1e-5, "{} {rotation}", end.rotation);
    }
}

#[test]
fn the_finger_loses_the_disc_in_the_end() {
    let drift = DiscDrift::new(R, uniform(), mu(0.3)).unwrap();
    let end = drift.advance(-0.3, 2.0).unwrap();
    assert!(!end.touching);
    assert_eq!(end.psi, -FRAC_PI_2);
    assert_eq!(drift.advance(0.0, 5.0).unwrap().psi, 0.0);
    assert_eq!(drift.length_between(0.0, 0.2).unwrap(), f64::INFINITY);
    assert_eq!(drift.length_between(0.0, 0.0).unwrap(), 0.0);
    assert!(drift.advance(2.0, 0.1).is_err());
    assert!(drift.advance(0.2, -0.1).is_err());
    assert!(drift.length_between(0.3, 0.2).is_err());
    assert!(drift.psi_of_offset(0.2).is_err());
}

#[test]
fn the_finger_slips_beyond_the_sticking_limit() {
    let drift = DiscDrift::new(R, uniform(), mu(0.3)).unwrap();
    for (psi, sticks) in [(drift.sticking_limit() - 1e-6, true), (drift.sticking_limit() + 1e-6, false)] {
        let contact = PointContact::on_disc(R, psi, mu(0.3)).unwrap();
        assert_eq!(contact.sticks(uniform(), &Vector2::x()), sticks);
    }
}

proptest! {
    #[test]
    fn length_between_inverts_advance(
        psi in 0.01..1.2_f64, length in 0.0..0.2_f64, friction in 0.0..1.0_f64,
    ) {
        let drift = DiscDrift::new(R, uniform(), mu(friction)).unwrap();
        let end = drift.advance(psi, length).unwrap();
        if !end.touching {
            return Ok(());
        }
        let back = drift.length_between(psi, end.psi).unwrap();
        prop_assert!((back - length).abs() < 1e-9);
        let mirrored = drift.length_between(-psi, -end.psi).unwrap();
        prop_assert!((mirrored - length).abs() < 1e-9);
    }

    #[test]
    fn pieces_of_a_push_add_up(
        psi in -1.2..1.2_f64, first in 0.0..0.2_f64, second in 0.0..0.2_f64,
        friction in 0.0..1.0_f64,
    ) {
        let drift = DiscDrift::new(R, uniform(), mu(friction)).unwrap();
        let whole = drift.advance(psi, first + second).unwrap();
        let half = drift.advance(psi, first).unwrap();
        let rest = drift.advance(half.psi, second).unwrap();
        prop_assert!((whole.psi - rest.psi).abs() < 1e-9);
        prop_assert!((whole.rotation - half.rotation - rest.rotation).abs() < 1e-8);
    }

    #[test]
    fn the_finger_never_penetrates(
        x in -0.2..0.2_f64, y in -0.2..0.2_f64, azimuth in -3.0..3.0_f64,
        heading in -1.5..1.5_f64, friction in 0.0..1.0_f64,
    ) {
        let normal = Unit::new_normalize(Vector2::new(azimuth.cos(), azimuth.sin()));
        let contact = PointContact::new(Vector2::new(x, y), normal, mu(friction)).unwrap();
        let angle = azimuth + heading;
        let velocity = Vector2::new(angle.cos(), angle.sin());
        let pushed = push(&contact, uniform(), &velocity).unwrap();
        let slip = velocity - pushed.twist.velocity_at(&contact.point());
        prop_assert!(slip.dot(&normal).abs() < 1e-9);
        if pushed.mode == ContactMode::Sticking {
            prop_assert!(slip.norm() < 1e-9);
        }
    }
}
