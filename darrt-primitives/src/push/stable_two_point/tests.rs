use super::*;
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

fn two(radius: f64, degrees: f64, mu: f64, rim: bool) -> TwoPointContact {
    let pressure =
        if rim { PressureConstant::rim(radius).unwrap() } else { PressureConstant::uniform_disc(radius).unwrap() };
    let friction = Friction::new(mu).unwrap();
    TwoPointContact::new(radius, degrees.to_radians(), pressure, friction).unwrap()
}

#[test]
fn turning_table() {
    // R, beta, mu, h_max, rho_min uniform, rho_min rim, kappa_max uniform.
    let gap = |radius: f64, gap: f64| (0.5 * gap / radius).asin().to_degrees();
    let table = [
        [0.13, 30.0, 0.3, 0.041_315, 0.1818, 0.4091, 5.5005],
        [0.13, 30.0, 0.6, 0.065_000, 0.1156, 0.2600, 8.6538],
        [0.13, 30.0, 0.1, 0.014_862, 0.5054, 1.1371, 1.9787],
        [0.13, 15.0, 0.3, 0.033_646, 0.2232, 0.5023, 4.4796],
        [0.14, gap(0.14, 0.08), 0.3, 0.040_000, 0.2178, 0.4900, 4.5918],
        [0.15, gap(0.15, 0.09), 0.3, 0.043_278, 0.2311, 0.5199, 4.3278],
    ];
    for [radius, beta, mu, offset, uniform_radius, rim_radius, curvature] in table {
        let (uniform, rim) = (two(radius, beta, mu, false), two(radius, beta, mu, true));
        assert!((uniform.max_force_offset() - offset).abs() < 5.1e-7);
        assert!((uniform.min_turning_radius() - uniform_radius).abs() < 5.1e-5);
        assert!((rim.min_turning_radius() - rim_radius).abs() < 5.1e-5);
        assert!((uniform.max_curvature() - curvature).abs() < 5.1e-5);
        let [low, high] = uniform.curvature_range(0.0).unwrap();
        assert!((high - uniform.max_curvature()).abs() < 1e-9);
        assert!((low + uniform.max_curvature()).abs() < 1e-9);
    }
}

#[test]
fn gaps_of_the_table() {
    for (radius, gap, degrees) in [(0.14, 0.08, 16.602), (0.15, 0.09, 17.458)] {
        let c = PressureConstant::uniform_disc(radius).unwrap();
        let friction = Friction::new(0.3).unwrap();
        let contact = TwoPointContact::from_gap(radius, gap, c, friction).unwrap();
        assert!((contact.half_angle().to_degrees() - degrees).abs() < 5.1e-4);
        let apart = TwoPointContact::from_gap(radius, 2.0 * radius, c, friction).unwrap_err();
        assert!(apart.to_string().contains("finger gap"), "{apart}");
    }
}

#[test]
fn translation_is_stable_inside_beta_for_any_friction() {
    for mu in [0.0, 0.3, 0.6] {
        let contact = two(0.13, 30.0, mu, false);
        for tenths in -450..=450_i32 {
            let heading = (f64::from(tenths) / 10.0).to_radians();
            let twist = Twist { linear: Vector2::new(heading.cos(), heading.sin()), angular: 0.0 };
            if tenths.abs() == 300 {
                continue;
            }
            assert_eq!(contact.is_translation_stable(heading), tenths.abs() < 300);
            // Rounding of the moment sum: without friction the interval is a single point.
            if mu > 0.0 {
                assert_eq!(contact.is_stable(&twist), tenths.abs() < 300, "{tenths}");
            } else {
                assert_eq!(contact.curvature_range(heading).is_some(), tenths.abs() < 300);
            }
        }
    }
}

#[test]
fn without_friction_no_turning() {
    let contact = two(0.13, 30.0, 0.0, false);
    assert_eq!(contact.max_force_offset(), 0.0);
    assert_eq!(contact.min_turning_radius(), f64::INFINITY);
    assert_eq!(contact.edge_centers(), None);
    let [low, high] = contact.curvature_range(0.0).unwrap();
    assert!(low.abs() < 1e-12 && high.abs() < 1e-12);
}

#[test]
fn edge_centres_of_rotation() {
    let found = two(0.13, 30.0, 0.3, false).edge_centers().unwrap();
    let expected = [
        (-0.046_26, -0.195_68, Rotation::Clockwise),
        (0.146_33, 0.137_90, Rotation::CounterClockwise),
        (0.146_33, -0.137_90, Rotation::Clockwise),
        (-0.046_26, 0.195_68, Rotation::CounterClockwise),
    ];
    for (x, y, rotation) in expected {
        let near = |c: &&EdgeCenter| (c.point - Vector2::new(x, y)).norm() < 1e-5;
        let hit = found.iter().find(near).unwrap();
        assert_eq!(hit.rotation, rotation);
    }
}

#[test]
fn curvature_ranges_of_oblique_headings() {
    let contact = two(0.13, 30.0, 0.3, false);
    for (degrees, low, high) in [(10.0_f64, -5.7035, 5.1304), (20.0, -5.7332, 3.0054), (29.0, -5.6109, 0.3021)] {
        let range = contact.curvature_range(degrees.to_radians()).unwrap();
        assert!((range[0] - low).abs() < 5.1e-5, "{range:?}");
        assert!((range[1] - high).abs() < 5.1e-5, "{range:?}");
    }
    assert_eq!(contact.curvature_range(1.5), None);
}

#[test]
fn wedging_contacts_are_refused() {
    let c = PressureConstant::uniform_disc(0.14).unwrap();
    let at = |mu| {
        let friction = Friction::new(mu).unwrap();
        TwoPointContact::from_gap(0.14, 0.08, c, friction).is_ok()
    };
    assert!(at(3.3) && !at(3.4));
}

#[test]
fn contacts_face_the_centre() {
    let contact = two(0.13, 30.0, 0.3, false);
    let edges = contact.friction_edges();
    let mut both = edges.iter();
    for point in contact.contacts().unwrap() {
        for share in [1.0, -1.0] {
            let wrench = point.wrench(share);
            let scale = wrench.force.norm();
            let edge = both.next().unwrap();
            assert!((wrench.force / scale - edge.force).norm() < 1e-12);
            assert!((wrench.moment / scale - edge.moment).abs() < 1e-12);
        }
    }
}

/// Cone membership from scratch: some three edges combine to the wrench without pulling.
fn in_cone(contact: &TwoPointContact, wrench: &Wrench, slack: f64) -> bool {
    let column = |w: &Wrench| Vector3::new(w.force.x, w.force.y, w.moment);
    let edges = contact.friction_edges().map(|e| column(&e));
    (0..4).any(|skip| {
        let kept: Vec<_> = (0..4).filter(|i| *i != skip).map(|i| edges[i]).collect();
        Matrix3::from_columns(&kept)
            .try_inverse()
            .is_some_and(|inverse| (inverse * column(wrench)).iter().all(|s| *s >= -slack))
    })
}

#[test]
fn the_border_of_the_force_cone_is_stable() {
    let (degrees, friction) = (30.0_f64, Friction::new(0.3).unwrap());
    let contact = two(0.13, degrees, 0.3, false);
    assert!(!contact.is_translation_stable(contact.half_angle()));
    // Along the outermost edge of either finger there is one curvature left: that of the edge alone.
    let curvature = 0.13 * friction.angle().sin() / contact.pressure.squared();
    for side in [-1.0, 1.0] {
        let heading = side * (degrees.to_radians() + friction.angle());
        let [low, high] = contact.curvature_range(heading).unwrap();
        assert!((low + side * curvature).abs() < 1e-9 && (high + side * curvature).abs() < 1e-9, "{low} {high}");
        assert_eq!(contact.curvature_range(heading + side * 1e-6), None);
    }
}

/// Where only one of several pairs of edges reaches the direction up to rounding, as on an edge itself, it counts.
#[test]
fn every_friction_edge_alone_is_within_the_range() {
    for degrees in [10.0, 30.0, 50.0] {
        let contact = two(0.13, degrees, 0.3, false);
        for edge in contact.friction_edges() {
            let [low, high] = contact.curvature_range(edge.force.y.atan2(edge.force.x)).unwrap();
            let alone = edge.moment / contact.pressure.squared();
            assert!((low - 1e-9..=high + 1e-9).contains(&alone), "{alone} is not in {low}..{high}");
        }
    }
}

#[test]
fn standing_is_stable_and_spinning_is_not() {
    let contact = two(0.13, 30.0, 0.3, false);
    let spin = |angular| Twist { linear: Vector2::zeros(), angular };
    assert!(contact.is_stable(&spin(0.0)));
    assert!(!contact.is_stable(&spin(1.0)) && !contact.is_stable(&spin(-0.1)));
}

proptest! {
    #[test]
    fn stability_is_cone_membership(
        degrees in 3.0..60.0_f64, mu in 0.02..0.55_f64, heading in -1.5..1.5_f64,
        curvature in -12.0..12.0_f64, speed in 0.1..10.0_f64, rim in any::<bool>(),
    ) {
        let contact = two(0.13, degrees, mu, rim);
        let twist = Twist {
            linear: speed * Vector2::new(heading.cos(), heading.sin()),
            angular: speed * curvature,
        };
        let wrench = contact.pressure.wrench_of(&twist);
        let surely_in = in_cone(&contact, &wrench, -1e-7);
        let maybe_in = in_cone(&contact, &wrench, 1e-7);
        prop_assume!(surely_in == maybe_in);
        prop_assert_eq!(contact.is_stable(&twist), maybe_in);
    }

    #[test]
    fn closed_form_and_enumeration_agree_straight_ahead(
        degrees in 3.0..60.0_f64, mu in 0.0..0.55_f64,
    ) {
        let contact = two(0.14, degrees, mu, false);
        let [low, high] = contact.curvature_range(0.0).unwrap();
        prop_assert!((high - contact.max_curvature()).abs() < 1e-9);
        prop_assert!((low + contact.max_curvature()).abs() < 1e-9);
    }
}
