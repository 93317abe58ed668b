use super::*;
use proptest::prelude::*;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

fn table() -> SupportSurface {
    let corners = [(-0.45, -0.6), (0.45, -0.6), (0.45, 0.6), (-0.45, 0.6)];
    let corners = corners.map(|(x, y)| Point2::new(x, y));
    SupportSurface::new("table", &corners, 0.75).unwrap()
}

fn stop(rule: EdgeRule) -> EdgeStop {
    EdgeStop { rule, target_margin: 0.03, edge_distance: 0.06 }
}

fn end(rule: EdgeRule, from: [f64; 2], target: [f64; 2]) -> Result<PushEnd, NoPush> {
    stop(rule).end_of_push(&table(), &Point2::from(from), &Point2::from(target))
}

fn assert_center(found: Result<PushEnd, NoPush>, x: f64, y: f64, limited: bool) {
    let found = found.unwrap();
    assert!((found.center - Point2::new(x, y)).norm() < 1e-8, "{found:?}");
    assert_eq!(found.limited_by_edge, limited);
}

#[test]
fn edge_distances_of_a_plate() {
    let plate = RimReach::default().edge_distances(0.14).unwrap().unwrap();
    assert!((plate.least() - 0.03).abs() < 1e-12);
    assert!((plate.most() - 0.10).abs() < 1e-12);
    assert!((plate.middle() - 0.065).abs() < 1e-12);
    assert!(plate.contains(0.1, 1e-9) && !plate.contains(0.12, 1e-9));
    assert_eq!(RimReach::default().edge_distances(0.06), Ok(None));
    assert!(RimReach::default().edge_distances(-0.14).is_err());
    assert!(EdgeDistances::new(0.2, 0.1).is_err());
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    for _ in 0..100 {
        assert!(plate.contains(plate.sample(&mut rng), 0.0));
    }
}

#[test]
fn a_target_on_the_table_is_the_end() {
    for rule in [EdgeRule::NearestEdgePoint, EdgeRule::LineCrossing] {
        assert_center(end(rule, [0.0, 0.0], [0.2, -0.3]), 0.2, -0.3, false);
        assert_eq!(end(rule, [0.1, 0.1], [0.1, 0.1]), Err(NoPush::NothingToDo));
        assert_eq!(end(rule, [0.7, 0.0], [0.1, 0.1]), Err(NoPush::NotOnSupport));
    }
}

#[test]
fn the_two_rules_differ_off_the_table() {
    let (from, target) = ([0.0, 0.0], [-0.9, 0.45]);
    // Nearest edge point (-0.45, 0.45), 0.06 inside.
    let nearest = end(EdgeRule::NearestEdgePoint, from, target);
    assert_center(nearest, -0.39, 0.45, true);
    // The line meets the edge at (-0.45, 0.225).
    assert_center(end(EdgeRule::LineCrossing, from, target), -0.39, 0.195, true);
}

#[test]
fn at_a_corner_both_edges_keep_the_distance() {
    let from = [0.0, 0.0];
    let nearest = end(EdgeRule::NearestEdgePoint, from, [0.8, 0.9]);
    assert_center(nearest, 0.39, 0.54, true);
    let crossing = end(EdgeRule::LineCrossing, from, [0.9, 1.2]).unwrap();
    assert!(table().depth(&crossing.center) >= 0.06 - 1e-8);
    assert!((crossing.center - Point2::new(0.39, 0.52)).norm() < 1e-8);
}

#[test]
fn an_object_at_the_edge_has_no_room_to_cross_it() {
    let crossing = end(EdgeRule::LineCrossing, [-0.42, 0.0], [-0.9, 0.0]);
    assert_eq!(crossing, Err(NoPush::NoRoomBeforeEdge));
    let along = end(EdgeRule::LineCrossing, [-0.449, 0.0], [-0.4501, 0.5]);
    assert_eq!(along, Err(NoPush::NoRoomBeforeEdge));
}

#[test]
fn an_indented_table_is_not_crossed() {
    let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.2, 1.0), (1.2, 0.2), (0.8, 0.2), (0.8, 1.0), (0.0, 1.0)]
        .map(|(x, y)| Point2::new(x, y));
    let bay = SupportSurface::new("bay", &corners, 0.75).unwrap();
    let rule = stop(EdgeRule::NearestEdgePoint);
    let across = rule.end_of_push(&bay, &Point2::new(0.4, 0.7), &Point2::new(1.6, 0.7));
    assert_eq!(across, Err(NoPush::LeavesSupport));
    // The bridge is 0.2 wide: nowhere 0.06 from both of its sides beside its edge, but further on.
    let wide = EdgeStop { edge_distance: 0.6, ..rule };
    let none = wide.end_of_push(&bay, &Point2::new(0.4, 0.7), &Point2::new(-0.5, 0.5));
    assert_eq!(none, Err(NoPush::EdgeTooNarrow));
}

/// A table of 2 m by 2 m, so that borders are exact in floating point.
fn square(rule: EdgeRule, target_margin: f64, from: [f64; 2], target: [f64; 2]) -> Result<PushEnd, NoPush> {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Point2::new(x, y));
    let table = SupportSurface::new("table", &corners, 0.75).unwrap();
    let stop = EdgeStop { rule, target_margin, edge_distance: 0.375 };
    stop.end_of_push(&table, &Point2::from(from), &Point2::from(target))
}

#[test]
fn borders_of_the_edge_distances() {
    let exact = RimReach { insertion: 0.25, clearance: 0.25, tip_margin: 0.5 };
    let one = exact.edge_distances(1.0).unwrap().unwrap();
    assert_eq!((one.least(), one.most()), (0.5, 0.5));
    assert!(EdgeDistances::new(0.0, 0.1).is_ok() && EdgeDistances::new(-0.1, 0.1).is_err());
    let some = EdgeDistances::new(0.03, 0.1).unwrap();
    assert!(some.contains(0.0299, 1e-3) && some.contains(0.1001, 1e-3));
    assert!(!some.contains(0.0299, 1e-5) && !some.contains(0.1001, 1e-5));
}

#[test]
fn a_target_at_the_margin_lies_on_the_table() {
    let rule = EdgeRule::NearestEdgePoint;
    assert_center(square(rule, 0.25, [0.0, 0.0], [0.75, 0.0]), 0.75, 0.0, false);
    assert_center(square(rule, 0.25, [0.0, 0.0], [0.8, 0.0]), 0.625, 0.0, true);
    // With no margin a push may end on the edge itself.
    assert_center(square(rule, 0.0, [0.0, 0.0], [1.0, 0.0]), 1.0, 0.0, false);
}

#[test]
fn a_push_that_brings_nothing_nearer_is_not_made() {
    // The stop is at (0.625, 0), 0.625 m from the target, as far as the object is (3, 4, 5).
    let aside = square(EdgeRule::NearestEdgePoint, 0.25, [0.875, 0.5], [1.25, 0.0]);
    assert_eq!(aside, Err(NoPush::NothingToDo));
    assert!(square(EdgeRule::NearestEdgePoint, 0.25, [0.875, 0.625], [1.25, 0.0]).is_ok());
}

#[test]
fn the_line_to_one_edge_gives_way_to_another() {
    // It meets the right edge at (0.45, 0.56), but is within 0.06 m of the upper edge from (0.3, 0.54) on.
    assert_center(end(EdgeRule::LineCrossing, [0.0, 0.5], [0.9, 0.62]), 0.3, 0.54, true);
}

proptest! {
    #[test]
    fn an_edge_limited_stop_keeps_its_distance(
        fx in -0.35..0.35_f64, fy in -0.5..0.5_f64, tx in -2.0..2.0_f64, ty in -2.0..2.0_f64,
        distance in 0.03..0.1_f64, line in any::<bool>(),
    ) {
        let rule = if line { EdgeRule::LineCrossing } else { EdgeRule::NearestEdgePoint };
        let stop = EdgeStop { rule, target_margin: 0.03, edge_distance: distance };
        let (from, target) = (Point2::new(fx, fy), Point2::new(tx, ty));
        let Ok(end) = stop.end_of_push(&table(), &from, &target) else { return Ok(()); };
        let depth = table().depth(&end.center);
        if end.limited_by_edge {
            prop_assert!((depth - distance).abs() < 1e-7, "{depth}");
        } else {
            prop_assert!(depth >= 0.03);
            prop_assert_eq!(end.center, target);
        }
        let reached = from + end.length * end.direction.into_inner();
        prop_assert!((reached - end.center).norm() < 1e-9);
    }
}
