use super::*;
use proptest::prelude::*;

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not within {tolerance} of {expected}");
}

#[test]
fn pressure_constants_of_standard_supports() {
    for (radius, expected) in [(0.13, 0.086_667), (0.14, 0.093_333), (0.15, 0.1)] {
        let disc = PressureConstant::uniform_disc(radius).unwrap();
        assert_near(disc.meters(), expected, 5e-7);
    }
    assert_eq!(PressureConstant::rim(0.13).unwrap().meters(), 0.13);
    let ring = PressureConstant::ring(0.06, 0.08).unwrap();
    assert_near(ring.meters(), 0.070_476, 5e-7);
    assert_eq!(PressureConstant::line(0.2).unwrap().meters(), 0.05);
    for (a, b, expected) in [(1.0, 1.0, 0.382_597_86), (0.30, 0.20, 0.096_810_61), (0.20, 0.20, 0.076_519_57)] {
        let rectangle = PressureConstant::rectangle(a, b).unwrap();
        assert_near(rectangle.meters(), expected, 5e-9);
    }
}

#[test]
fn a_thin_rectangle_is_a_line_and_a_thin_ring_a_rim() {
    let thin = PressureConstant::rectangle(0.4, 1e-7).unwrap();
    assert_near(thin.meters(), 0.1, 1e-6);
    let ring = PressureConstant::ring(0.1 - 1e-9, 0.1).unwrap();
    assert_near(ring.meters(), 0.1, 1e-8);
}

#[test]
fn a_plate_of_half_a_kilogram() {
    let c = PressureConstant::uniform_disc(0.14).unwrap();
    let plate = LimitSurface::of_mass(c, 0.5, Friction::new(0.3).unwrap()).unwrap();
    assert_near(plate.max_force(), 1.47, 5e-3);
    assert_near(plate.max_moment(), 0.137, 5e-4);
    let idle = Twist { linear: Vector2::zeros(), angular: 0.0 };
    assert_eq!(plate.sustaining(&idle), None);
}

/// Columns: rho/R, exact F, exact M, exact h, ellipsoid F, ellipsoid M, ellipsoid h (in R).
const DISC_TABLE: [[f64; 7]; 6] = [
    [0.25, 0.24803, 0.95368, 2.5633, 0.35112, 0.93633, 1.7778],
    [0.5, 0.48384, 0.82162, 1.1321, 0.60000, 0.80000, 0.8889],
    [1.0, 0.84883, 0.42441, 0.3333, 0.83205, 0.55470, 0.4444],
    [1.5, 0.94082, 0.26070, 0.1847, 0.91381, 0.40614, 0.2963],
    [2.0, 0.96769, 0.19171, 0.1321, 0.94868, 0.31623, 0.2222],
    [4.0, 0.99213, 0.09425, 0.0633, 0.98639, 0.16440, 0.1111],
];

#[test]
fn exact_disc_and_ellipsoid_table() {
    let c = PressureConstant::uniform_disc(1.0).unwrap();
    let ellipsoid = LimitSurface::new(c, 1.0).unwrap();
    for [rho, force, moment, offset, approx_force, approx_moment, approx_offset] in DISC_TABLE {
        let exact = exact_disc(rho).unwrap();
        assert_near(exact.force, force, 5.1e-6);
        assert_near(exact.moment, moment, 5.1e-6);
        assert_near(exact.offset_in_radii(), offset, 5.1e-5);
        let turning = Twist { linear: Vector2::new(0.0, rho), angular: 1.0 };
        let wrench = ellipsoid.sustaining(&turning).unwrap();
        assert_near(wrench.force.norm(), approx_force, 5.1e-6);
        let moment = wrench.moment / ellipsoid.max_moment();
        assert_near(moment, approx_moment, 5.1e-6);
        assert_near(c.rotation_distance(rho), approx_offset, 5.1e-5);
    }
}

#[test]
fn exact_disc_at_its_ends_and_across_the_rim() {
    let spin = exact_disc(0.0).unwrap();
    assert_near(spin.force, 0.0, 1e-15);
    assert_near(spin.moment, 1.0, 1e-12);
    let slide = exact_disc(1e6).unwrap();
    assert_near(slide.force, 1.0, 1e-10);
    assert_near(slide.moment, 0.0, 1e-5);
    let (inside, outside) = (exact_disc(1.0).unwrap(), exact_disc(1.0 + 1e-12).unwrap());
    assert_near(inside.force, outside.force, 1e-9);
    assert_near(inside.moment, outside.moment, 1e-9);
    assert!(exact_disc(-0.1).is_err() && exact_disc(1.1e6).is_err());
}

#[test]
fn the_exact_integrals_agree_with_a_sum_over_the_disc() {
    for rho in [0.3, 0.8, 1.7] {
        let (mut force, mut moment, mut count) = (0.0_f64, 0.0_f64, 0.0_f64);
        let cells = 400;
        for ix in -cells..cells {
            for iy in -cells..cells {
                let x = (f64::from(ix) + 0.5) / f64::from(cells);
                let y = (f64::from(iy) + 0.5) / f64::from(cells);
                if x.hypot(y) <= 1.0 {
                    let reach = (x - rho).hypot(y);
                    force += (x - rho) / reach;
                    moment += (x * (x - rho) + y * y) / reach;
                    count += 1.0;
                }
            }
        }
        let exact = exact_disc(rho).unwrap();
        assert_near(exact.force, (force / count).abs(), 1e-4);
        assert_near(exact.moment, 1.5 * moment / count, 1e-4);
    }
}

#[test]
fn centre_of_rotation_of_the_sharpest_turn() {
    let c = PressureConstant::uniform_disc(0.13).unwrap();
    assert_near(c.rotation_distance(0.041_315), 0.181_80, 5.1e-6);
    let push = Wrench::of_force_at(&Vector2::new(0.0, -0.041_315), Vector2::x());
    let cor = c.center_of_rotation(&push).unwrap();
    // The force passes on the right (y < 0), so the centre of rotation lies on the left.
    assert_near(cor.x, 0.0, 1e-15);
    assert_near(cor.y, 0.181_80, 5.1e-6);
}

#[test]
fn the_largest_force_and_moment_lie_on_the_surface() {
    let c = PressureConstant::new(0.1).unwrap();
    for max_force in [0.5, 3.0] {
        let surface = LimitSurface::new(c, max_force).unwrap();
        let slide = Wrench { force: Vector2::new(0.0, -max_force), moment: 0.0 };
        let spin = Wrench { force: Vector2::zeros(), moment: surface.max_moment() };
        assert_near(surface.level(&slide), 1.0, 1e-12);
        assert_near(surface.level(&spin), 1.0, 1e-12);
        let half = Wrench { force: 0.5 * slide.force, moment: 0.0 };
        assert_near(surface.level(&half), 0.5, 1e-12);
    }
}

#[test]
fn a_force_through_the_centre_turns_nothing() {
    let c = PressureConstant::new(0.1).unwrap();
    let straight = Wrench { force: Vector2::new(0.3, 0.4), moment: 0.0 };
    assert_eq!(c.center_of_rotation(&straight), None);
    assert_eq!(c.rotation_distance(0.0), f64::INFINITY);
    assert_eq!(c.rotation_distance(-0.05), c.rotation_distance(0.05));
}

proptest! {
    #[test]
    fn twist_and_wrench_are_inverse(
        c in 0.01..0.5_f64, fx in -2.0..2.0_f64, fy in -2.0..2.0_f64, m in -0.5..0.5_f64,
    ) {
        let pressure = PressureConstant::new(c).unwrap();
        let wrench = Wrench { force: Vector2::new(fx, fy), moment: m };
        let back = pressure.wrench_of(&pressure.twist_of(&wrench));
        prop_assert!((back.force - wrench.force).norm() < 1e-12);
        prop_assert!((back.moment - wrench.moment).abs() < 1e-12);
    }

    #[test]
    fn the_sustaining_wrench_lies_on_the_surface_and_does_the_most_work(
        vx in -1.0..1.0_f64, vy in -1.0..1.0_f64, om in 0.1..4.0_f64,
        ax in -1.0..1.0_f64, ay in -1.0..1.0_f64, am in -1.0..1.0_f64,
    ) {
        let c = PressureConstant::new(0.09).unwrap();
        let surface = LimitSurface::new(c, 1.5).unwrap();
        let twist = Twist { linear: Vector2::new(vx, vy), angular: om };
        let wrench = surface.sustaining(&twist).unwrap();
        prop_assert!((surface.level(&wrench) - 1.0).abs() < 1e-12);
        let power = |w: &Wrench| w.force.dot(&twist.linear) + w.moment * twist.angular;
        let other = Twist { linear: Vector2::new(ax, ay), angular: am };
        if let Some(rival) = surface.sustaining(&other) {
            prop_assert!(power(&rival) <= power(&wrench) + 1e-12);
        }
    }
}
