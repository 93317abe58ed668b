use super::super::ON_BOUNDARY;
use super::*;
use nalgebra::{Rotation2, Unit};
use proptest::prelude::*;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

fn surface(name: &str, corners: &[[f64; 2]]) -> SupportSurface {
    let corners: Vec<_> = corners.iter().map(|p| Point2::from(*p)).collect();
    SupportSurface::new(name, &corners, 0.75).unwrap()
}

/// The rectangle between two corners.
fn board(name: &str, [x, y]: [f64; 2], [u, v]: [f64; 2]) -> SupportSurface {
    surface(name, &[[x, y], [u, y], [u, v], [x, v]])
}

fn joined(parts: &[&SupportSurface]) -> SupportSurface {
    SupportSurface::joined("all", parts).unwrap()
}

/// The same boards turned about the origin and shifted, so that no side lies along an axis.
fn turned(surface: &SupportSurface, yaw: f64) -> SupportSurface {
    let corners: Vec<_> = surface.vertices().map(|p| Rotation2::new(yaw) * p + Vector2::new(0.3, -0.2)).collect();
    SupportSurface::new(surface.name(), &corners, surface.height()).unwrap()
}

/// Two surfaces say the same about a point, and about the ray that leaves it.
fn agree(whole: &SupportSurface, parts: &SupportSurface, p: &Point2<f64>, angle: f64) -> Result<(), TestCaseError> {
    let (depth, other) = (whole.depth(p), parts.depth(p));
    prop_assert!((depth - other).abs() < 1e-7, "{p}: {depth} of the whole, {other} of the parts");
    prop_assert!(depth.abs() < 1e-6 || whole.contains(p) == parts.contains(p), "{p}: {depth}");
    let [a, b] = [whole, parts].map(|surface| surface.nearest_edge_point(p));
    prop_assert!((a.distance - b.distance).abs() < 1e-7);
    let way = Unit::new_normalize(Vector2::new(angle.cos(), angle.sin()));
    if depth > 1e-6 {
        let [a, b] = [whole, parts].map(|surface| surface.first_crossing(p, &way).unwrap());
        prop_assert!(
            (a.distance - b.distance).abs() < 1e-6 || way.dot(&a.outward).min(way.dot(&b.outward)) < 1e-3,
            "{a:?} {b:?}"
        );
    }
    Ok(())
}

#[test]
fn an_ell_of_two_tables_is_an_ell() {
    let (long, short) = (board("long", [0.0, 0.0], [1.0, 3.0]), board("short", [1.0, 0.0], [3.0, 1.0]));
    assert!(long.is_flush_with(&short) && short.is_flush_with(&long));
    let both = joined(&[&long, &short]);
    assert_eq!(both.edges().len(), 7, "{:?}", both.edges());
    assert!((both.area() - 5.0).abs() < 1e-12);
    // Over the seam, beside it, and in the corner between the arms.
    assert!((both.depth(&Point2::new(1.0, 0.4)) - 0.4).abs() < 1e-12);
    assert!((both.depth(&Point2::new(2.0, 0.4)) - 0.4).abs() < 1e-12);
    assert!((both.depth(&Point2::new(0.9, 0.9)) - 0.1_f64.hypot(0.1)).abs() < 1e-12);
    assert!((both.depth(&Point2::new(2.0, 2.0)) + 1.0).abs() < 1e-12);
    let out = both.first_crossing(&Point2::new(0.5, 0.5), &Vector2::x_axis()).unwrap();
    assert!((out.distance - 2.5).abs() < 1e-12);
    assert_eq!(both.bounds(), (Point2::new(0.0, 0.0), Point2::new(3.0, 3.0)));
}

#[test]
fn steps_wide_gaps_and_corners_do_not_join() {
    let left = board("left", [0.0, 0.0], [1.0, 1.0]);
    let at = |x: f64, y: f64| board("right", [x, y], [x + 1.0, y + 1.0]);
    assert!(left.is_flush_with(&at(1.0, 0.0)) && left.is_flush_with(&at(1.0 + FLUSH_GAP, 0.3)));
    assert!(!left.is_flush_with(&at(1.0 + FLUSH_GAP + 1e-4, 0.0)), "too far");
    assert!(!left.is_flush_with(&at(1.0, 1.0)), "a corner");
    assert!(
        !left.is_flush_with(&at(1.0, 1.0 - LEAST_SEAM + 1e-4)) && left.is_flush_with(&at(1.0, 1.0 - LEAST_SEAM - 1e-6))
    );
    let raised = |by: f64| SupportSurface { height: left.height() + by, ..at(1.0, 0.0) };
    assert!(left.is_flush_with(&raised(0.9 * FLUSH_HEIGHT)) && !left.is_flush_with(&raised(1.1 * FLUSH_HEIGHT)));
    // One within the other, and the same twice.
    let patch = board("patch", [0.2, 0.2], [0.6, 0.6]);
    for (a, b) in [(&left, &patch), (&patch, &left), (&left, &left)] {
        assert!(a.is_flush_with(b), "{} {}", a.name(), b.name());
        let both = joined(&[a, b]);
        assert!((both.depth(&Point2::new(0.3, 0.4)) - 0.3).abs() < 1e-12);
    }
}

#[test]
fn groups_hold_together_by_way_of_others() {
    let boards = [
        board("a", [0.0, 0.0], [1.0, 1.0]),
        board("far", [5.0, 0.0], [6.0, 1.0]),
        board("c", [2.0, 0.0], [3.0, 1.0]),
        board("b", [1.0, 0.0], [2.0, 1.0]),
    ];
    assert_eq!(SupportSurface::flush_groups(&boards.iter().collect::<Vec<_>>()), [vec![0, 2, 3], vec![1]]);
    assert!(SupportSurface::flush_groups(&[]).is_empty());
}

#[test]
fn one_surface_is_joined_to_itself_and_none_to_nothing() {
    let left = board("left", [0.0, 0.0], [1.0, 1.0]);
    assert_eq!(SupportSurface::joined("left", &[&left]).unwrap(), left);
    assert!(matches!(SupportSurface::joined("none", &[]), Err(GeomError::Count { .. })));
    assert!(SupportSurface::joined("", &[&left]).is_err());
    let many: Vec<_> = (0..100).map(|_| &left).collect();
    assert!(SupportSurface::joined("many", &many).is_err());
}

#[test]
fn a_ring_of_boards_has_a_hole() {
    let boards = [
        board("south", [0.0, 0.0], [3.0, 1.0]),
        board("north", [0.0, 2.0], [3.0, 3.0]),
        board("west", [0.0, 1.0], [1.0, 2.0]),
        board("east", [2.0, 1.0], [3.0, 2.0]),
    ];
    let ring = joined(&boards.iter().collect::<Vec<_>>());
    assert!(!ring.contains(&Point2::new(1.5, 1.5)) && (ring.depth(&Point2::new(1.5, 1.5)) + 0.5).abs() < 1e-12);
    assert!((ring.depth(&Point2::new(0.5, 1.5)) - 0.5).abs() < 1e-12);
    let out = ring.first_crossing(&Point2::new(1.5, 0.5), &Vector2::y_axis()).unwrap();
    assert!((out.distance - 0.5).abs() < 1e-12);
}

proptest! {
    #[test]
    fn a_board_cut_in_two_and_joined_is_whole(
        cut in 0.2_f64..1.8, lean in -0.05_f64..0.05, gap in prop_oneof![Just(0.0), 0.0..FLUSH_GAP, Just(FLUSH_GAP)],
        yaw in -3.0_f64..3.0, u in -0.2_f64..1.2, v in -0.2_f64..1.2, angle in 0.0_f64..6.3,
    ) {
        let half = gap / 2.0 / lean.cos();
        let left = surface("left", &[[0.0, 0.0], [cut - half - lean.tan(), 0.0], [cut - half, 1.0], [0.0, 1.0]]);
        let right = surface("right", &[[cut + half - lean.tan(), 0.0], [2.0, 0.0], [2.0, 1.0], [cut + half, 1.0]]);
        let [whole, left, right] = [&board("whole", [0.0, 0.0], [2.0, 1.0]), &left, &right].map(|s| turned(s, yaw));
        prop_assert!(left.is_flush_with(&right));
        let parts = joined(&[&left, &right]);
        let p = Rotation2::new(yaw) * Point2::new(2.0 * u, v) + Vector2::new(0.3, -0.2);
        // A slanting gap has slanting ends: they are as deep as the gap is wide times the lean.
        let lost = gap * lean.tan().abs();
        let (depth, other) = (whole.depth(&p), parts.depth(&p));
        prop_assert!((depth - other).abs() < lost + 1e-7, "{p}: {depth} of the whole, {other} of the parts");
        if lost < 1e-9 {
            agree(&whole, &parts, &p, angle)?;
        }
    }

    #[test]
    fn a_board_cut_in_nine_and_joined_is_whole(
        x in prop::array::uniform2(0.1_f64..0.9), y in prop::array::uniform2(0.1_f64..0.9), gap in 0.0..FLUSH_GAP,
        yaw in -3.0_f64..3.0, u in -0.2_f64..1.2, v in -0.2_f64..1.2, angle in 0.0_f64..6.3,
    ) {
        let sorted = |[a, b]: [f64; 2]| [0.0, a.min(b), a.max(b) + 0.05, 1.05];
        let (x, y) = (sorted(x), sorted(y));
        // Gaps between columns only: where four pieces meet, a gap both ways would leave a square hole.
        let piece = |i: usize, j: usize| {
            let inner = if i == 2 { x[3] } else { x[i + 1] - gap };
            turned(&board(&format!("{i}{j}"), [x[i], y[j]], [inner, y[j + 1]]), yaw)
        };
        let pieces: Vec<_> = (0..9).map(|k| piece(k / 3, k % 3)).collect();
        prop_assume!(pieces.iter().all(|piece| piece.area() > 1e-4));
        let whole = turned(&board("whole", [0.0, 0.0], [1.05, 1.05]), yaw);
        let p = Rotation2::new(yaw) * Point2::new(1.05 * u, 1.05 * v) + Vector2::new(0.3, -0.2);
        agree(&whole, &joined(&pieces.iter().collect::<Vec<_>>()), &p, angle)?;
    }

    #[test]
    fn overlapping_boards_are_their_union(
        corners in prop::collection::vec(prop::array::uniform4(0.0_f64..1.0), 2..5), yaws in prop::array::uniform4(-0.8_f64..0.8),
        u in -0.5_f64..1.5, v in -0.5_f64..1.5, seed in any::<u64>(),
    ) {
        let parts: Vec<_> = corners.iter().zip(yaws).enumerate().map(|(i, ([x, y, w, h], yaw))| {
            turned(&board(&format!("{i}"), [*x, *y], [x + 0.1 + w, y + 0.1 + h]), yaw)
        }).collect();
        let union = joined(&parts.iter().collect::<Vec<_>>());
        let p = Point2::new(u, v);
        let is_in_some = parts.iter().any(|part| part.contains(&p));
        // Filled gaps are at most that wide.
        let is_in_gap = parts.iter().filter(|part| part.depth(&p) > -FLUSH_GAP).count() > 1;
        prop_assert!(union.contains(&p) == is_in_some || is_in_gap || union.depth(&p).abs() < 1e-7);
        // No edge lies within a part, and none is farther away than the nearest way out by samples of all edges.
        let distance = union.depth(&p).abs();
        for edge in union.edges() {
            for share in [0.01, 0.3, 0.5, 0.99] {
                let q = edge.start + (edge.end - edge.start) * share;
                prop_assert!(parts.iter().all(|part| part.depth(&q) < 1e-6), "{q}");
                prop_assert!((q - p).norm() >= distance - 1e-9);
            }
        }
        // Every way into or out of the union crosses an edge.
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let inside = union.sample(&mut rng, 0.0).unwrap();
        prop_assert!(union.contains(&inside) && union.sample(&mut rng, 0.04).is_none_or(|q| union.depth(&q) >= 0.04));
        let steps = 200;
        for k in 0..steps {
            let [a, b] = [k, k + 1].map(|k| inside + (p - inside) * (f64::from(k) / f64::from(steps)));
            if union.contains(&a) != union.contains(&b) {
                prop_assert!(union.nearest_edge_point(&a).distance <= (b - a).norm() + ON_BOUNDARY);
            }
        }
    }
}
