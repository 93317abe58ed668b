use super::*;
use proptest::prelude::*;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

fn points(raw: &[[f64; 2]]) -> Vec<Point2<f64>> {
    raw.iter().map(|p| Point2::from(*p)).collect()
}

/// An L of two metre-wide arms.
fn ell() -> SupportSurface {
    let raw = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    SupportSurface::new("ell", &points(&raw), 0.7).unwrap()
}

/// A star-shaped polygon: one radius per angle, so it is simple by construction.
fn star() -> impl Strategy<Value = SupportSurface> {
    (prop::collection::vec(0.2_f64..2.0, 3..14), any::<bool>(), -5.0_f64..5.0).prop_map(|(radii, clockwise, shift)| {
        let step = std::f64::consts::TAU / radii.len() as f64;
        let mut raw: Vec<_> = radii
            .iter()
            .enumerate()
            .map(|(i, r)| Point2::new(shift + r * (step * i as f64).cos(), r * (step * i as f64).sin() - shift))
            .collect();
        if clockwise {
            raw.reverse();
        }
        SupportSurface::new("star", &raw, 0.5).unwrap()
    })
}

/// A point near the surface: a fraction of its bounds, a little beyond them.
fn near(surface: &SupportSurface, u: f64, v: f64) -> Point2<f64> {
    let (low, high) = surface.bounds();
    let size = high - low;
    Point2::new(low.x + (1.4 * u - 0.2) * size.x, low.y + (1.4 * v - 0.2) * size.y)
}

#[test]
fn bad_polygons_are_refused_with_numbers() {
    let bow_tie = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.5]];
    let touching = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]];
    let spike = [[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [2.0, 0.0], [0.0, 2.0]];
    for raw in [&bow_tie[..], &touching, &spike] {
        assert!(matches!(SupportSurface::new("p", &points(raw), 0.0), Err(GeomError::SelfIntersecting { .. })));
    }
    let line = points(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]);
    assert!(matches!(SupportSurface::new("p", &line, 0.0), Err(GeomError::Degenerate { .. })));
    let twice = points(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    assert!(matches!(SupportSurface::new("p", &twice, 0.0), Err(GeomError::Degenerate { .. })));
    let two = points(&[[0.0, 0.0], [1.0, 0.0]]);
    let message = SupportSurface::new("shelf", &two, 0.0).unwrap_err().to_string();
    assert!(message.contains("shelf") && message.contains('2') && message.contains('3'), "{message}");
    let nan = points(&[[0.0, 0.0], [1.0, f64::NAN], [0.0, 1.0]]);
    assert!(matches!(SupportSurface::new("p", &nan, 0.0), Err(GeomError::NotFinite { .. })));
    let good = points(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    assert!(SupportSurface::new("p", &good, f64::INFINITY).is_err() && SupportSurface::new("", &good, 0.0).is_err());
}

#[test]
fn an_ell_is_measured_around_its_notch() {
    let ell = ell();
    assert!((ell.area() - 5.0).abs() < 1e-12);
    assert!(ell.contains(&Point2::new(0.5, 2.5)) && !ell.contains(&Point2::new(2.0, 2.0)));
    assert!((ell.depth(&Point2::new(2.0, 0.4)) - 0.4).abs() < 1e-12);
    assert!((ell.depth(&Point2::new(2.0, 2.0)) + 1.0).abs() < 1e-12);
    let from = Point2::new(0.5, 2.0);
    let out = ell.first_crossing(&from, &Vector2::x_axis()).unwrap();
    assert!((out.distance - 0.5).abs() < 1e-12 && out.edge == 3 && (out.outward.x - 1.0).abs() < 1e-12);
    assert!(ell.first_crossing(&Point2::new(2.0, 2.0), &Vector2::x_axis()).is_none());
    assert!((ell.overhang(&Point2::new(2.9, 0.5), 0.3) - 0.2).abs() < 1e-12);
    assert_eq!(ell.overhang(&Point2::new(2.0, 0.5), 0.3), 0.0);
}

#[test]
fn orientation_is_normalised_and_rectangles_turn() {
    let turned = SupportSurface::rectangle("r", Point2::new(1.0, 2.0), Vector2::new(2.0, 1.0), 0.5, 0.7).unwrap();
    assert!((turned.area() - 2.0).abs() < 1e-12 && (turned.depth(&Point2::new(1.0, 2.0)) - 0.5).abs() < 1e-12);
    let reversed: Vec<_> = turned.vertices().rev().collect();
    let again = SupportSurface::new("r", &reversed, 0.7).unwrap();
    assert!(polygon::twice_area(&again.vertices().collect::<Vec<_>>()) > 0.0);
    assert_eq!((turned.name(), turned.height()), ("r", 0.7));
}

#[test]
fn samples_are_uniform_and_inset() {
    let ell = ell();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
    let mut in_long_arm = 0.0;
    for _ in 0..4000 {
        let p = ell.sample(&mut rng, 0.1).unwrap();
        assert!(ell.depth(&p) >= 0.1);
        if p.x > 0.9 {
            in_long_arm += 1.0;
        }
    }
    // Inset area: 0.8 x 2.8 plus 2.0 x 0.8, a little more in the rounded inner corner.
    assert!((in_long_arm / 4000.0_f64 - 1.6 / 3.84).abs() < 0.03, "{in_long_arm}");
    assert!(ell.sample(&mut rng, 0.6).is_none() && ell.sample(&mut rng, f64::NAN).is_none());
}

proptest! {
    #[test]
    fn the_nearest_edge_point_is_nearest(surface in star(), u in 0.0_f64..1.0, v in 0.0_f64..1.0) {
        let p = near(&surface, u, v);
        let nearest = surface.nearest_edge_point(&p);
        prop_assert!(surface.nearest_edge_point(&nearest.point).distance < 1e-9);
        prop_assert!(((p - nearest.point).norm() - nearest.distance).abs() < 1e-12);
        for Edge { start: a, end: b, .. } in surface.edges() {
            for k in 0..=20 {
                let q = a + (b - a) * (f64::from(k) / 20.0);
                prop_assert!((p - q).norm() >= nearest.distance - 1e-9);
            }
        }
    }

    #[test]
    fn depth_agrees_with_contains(surface in star(), u in 0.0_f64..1.0, v in 0.0_f64..1.0) {
        let p = near(&surface, u, v);
        prop_assert_eq!(surface.depth(&p) >= 0.0, surface.contains(&p));
        let by_tiles = surface.tiles.iter().any(|(tile, _)| polygon::winds_around(tile, &p));
        if surface.depth(&p).abs() > 1e-6 && by_tiles {
            prop_assert!(surface.contains(&p));
        }
    }

    #[test]
    fn tiles_cover_the_area(surface in star()) {
        let area = polygon::twice_area(&surface.vertices().collect::<Vec<_>>()) / 2.0;
        prop_assert!((surface.area() - area).abs() < 1e-9);
    }

    #[test]
    fn crossings_lie_on_the_boundary_and_the_ray(
        surface in star(), u in 0.0_f64..1.0, v in 0.0_f64..1.0, angle in 0.0_f64..6.3,
    ) {
        let from = near(&surface, u, v);
        let direction = Unit::new_normalize(Vector2::new(angle.cos(), angle.sin()));
        match surface.first_crossing(&from, &direction) {
            None => prop_assert!(!surface.contains(&from)),
            Some(out) => {
                prop_assert!(surface.nearest_edge_point(&out.point).distance < 1e-8);
                prop_assert!((from + direction.as_ref() * out.distance - out.point).norm() < 1e-7);
                prop_assert!(direction.dot(&out.outward) > 0.0);
                for k in 1..20 {
                    let on_the_way = from + direction.as_ref() * (out.distance * f64::from(k) / 20.0);
                    prop_assert!(surface.depth(&on_the_way) > -1e-7);
                }
            }
        }
    }

    #[test]
    fn overhang_bounds_every_point_of_the_disc(
        surface in star(), u in 0.0_f64..1.0, v in 0.0_f64..1.0, radius in 0.01_f64..1.0,
    ) {
        let centre = near(&surface, u, v);
        let overhang = surface.overhang(&centre, radius);
        for k in 0..64 {
            let angle = f64::from(k) * std::f64::consts::TAU / 64.0;
            let q = centre + Vector2::new(angle.cos(), angle.sin()) * radius;
            prop_assert!(-surface.depth(&q) <= overhang + 1e-9);
        }
    }

    #[test]
    fn overhang_is_attained_on_convex_surfaces(
        yaw in 0.0_f64..3.0, u in 0.0_f64..1.0, v in 0.0_f64..1.0, radius in 0.01_f64..0.4,
    ) {
        let table = SupportSurface::rectangle("t", Point2::origin(), Vector2::new(1.0, 0.6), yaw, 0.7).unwrap();
        let centre = near(&table, u, v);
        prop_assume!(table.depth(&centre) > 0.0);
        let edge = table.nearest_edge_point(&centre);
        let worst = centre + edge.outward.as_ref() * radius;
        prop_assert!((table.overhang(&centre, radius) - (-table.depth(&worst)).max(0.0)).abs() < 1e-9);
    }
}
