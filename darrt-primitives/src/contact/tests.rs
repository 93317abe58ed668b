use super::*;
use proptest::prelude::*;

/// The gripper that pushes the paper's plates: half a fingertip's width, and how far the tips reach beyond the tool.
const TIPS: Fingertips = Fingertips { beyond_tool: 0.0069, half_width: 0.0112 };
/// A plate 20 mm high, the tips 5 mm above the table.
const HEIGHTS: PushHeights = PushHeights { tips: 0.005, top: 0.02 };
/// A table's height.
const TABLE: f64 = 0.75;

fn plate() -> RimContact {
    RimContact::new(0.14, 0.08, TIPS).unwrap()
}

fn toward(x: f64, y: f64) -> Unit<Vector2<f64>> {
    Unit::new_normalize(Vector2::new(x, y))
}

#[test]
fn tool_positions_of_verified_pushes() {
    let upright = HandStance::default();
    assert!((plate().setback(&HEIGHTS, &upright).unwrap() - 0.1454).abs() < 5e-5);
    // Plate centre, direction, tool position; computed by an independent planner script.
    for (center, direction, tool) in [
        ([-0.2, 0.05], [0.0, -1.0], [-0.2, 0.195_364]),
        ([-0.03, -0.12], [-1.0, 0.0], [0.115_364, -0.12]),
        ([-0.03, -0.12], [-1.0, 1.0], [0.072_788, -0.222_788]),
        ([-0.143, -0.007], [0.0, 1.0], [-0.143, -0.152_364]),
    ] {
        let direction = toward(direction[0], direction[1]);
        let pose = plate().world_from_tool(&Point2::from(center), &direction, TABLE, &HEIGHTS, &upright).unwrap();
        let expected = Vector3::new(tool[0], tool[1], TABLE + 0.005 + TIPS.beyond_tool);
        assert!((pose.translation.vector - expected).norm() < 1e-6, "{pose}");
    }
}

#[test]
fn the_hand_points_down_with_its_fingers_across_the_push() {
    let direction = toward(1.0, 0.0);
    let pose = |twin| {
        let stance = HandStance { twin, ..HandStance::default() };
        plate().world_from_tool(&Point2::origin(), &direction, TABLE, &HEIGHTS, &stance).unwrap()
    };
    let (one, other) = (pose(false), pose(true));
    assert!((one * Vector3::x() + Vector3::z()).norm() < 1e-12);
    assert!((one * Vector3::y() - Vector3::y()).norm() < 1e-12);
    assert!((one * Vector3::z() - Vector3::x()).norm() < 1e-12);
    assert!((other * Vector3::x() + Vector3::z()).norm() < 1e-12);
    assert!((other * Vector3::y() + Vector3::y()).norm() < 1e-12);
    assert_eq!(one.translation, other.translation);
    assert!((one.rotation.angle_to(&other.rotation) - std::f64::consts::PI).abs() < 1e-7);
}

#[test]
fn unusable_numbers_are_refused() {
    assert!(RimContact::new(0.04, 0.08, TIPS).is_err());
    assert!(RimContact::new(f64::NAN, 0.08, TIPS).is_err());
    assert!(RimContact::new(0.14, 0.08, Fingertips { half_width: 0.0, ..TIPS }).is_err());
    assert!(RimContact::new(0.14, 0.08, Fingertips { beyond_tool: -0.01, ..TIPS }).is_err());
    let pose = |heights, lean| {
        let stance = HandStance { lean, ..HandStance::default() };
        plate().world_from_tool(&Point2::origin(), &toward(1.0, 0.0), TABLE, &heights, &stance)
    };
    assert!(pose(HEIGHTS, 1.5).is_ok());
    assert!(pose(HEIGHTS, 1.6).is_err() && pose(HEIGHTS, -0.1).is_err());
    assert!(pose(PushHeights { tips: 0.02, ..HEIGHTS }, 0.0).is_err(), "they pass above it");
}

#[test]
fn a_hand_that_leans_over_the_edge_presses_the_disc_down() {
    let at = |lean: f64| {
        let stance = HandStance { lean, ..HandStance::default() };
        plate().pressing_down(&HEIGHTS, &stance)
    };
    // The front of the tips' ends rises above the plate where 2 * 11.2 mm * sin(lean) exceeds 15 mm: at 42 degrees.
    assert_eq!((at(0.0), at(41_f64.to_radians())), (0.0, 0.0));
    assert!((at(60_f64.to_radians()) - 1.0 / 3.0_f64.sqrt()).abs() < 1e-12);
}

proptest! {
    #[test]
    fn contact_points_lie_on_the_rim_a_gap_apart(
        radius in 0.05..0.3_f64, share in 0.05..0.99_f64, heading in -3.0..3.0_f64,
        x in -2.0..2.0_f64, y in -2.0..2.0_f64,
    ) {
        let contact = RimContact::new(radius, 2.0 * radius * share, TIPS).unwrap();
        let (center, direction) = (Point2::new(x, y), toward(heading.cos(), heading.sin()));
        let [left, right] = contact.contact_points(&center, &direction);
        prop_assert!(((left - center).norm() - radius).abs() < 1e-12);
        prop_assert!(((right - center).norm() - radius).abs() < 1e-12);
        prop_assert!(((left - right).norm() - contact.gap()).abs() < 1e-12);
        prop_assert!((left - right).dot(&left_of(&direction)) > 0.0);
    }

    /// The inner face of each fingertip, a rectangle in the plane of its contact: of its points that are no higher than the
    /// disc, the foremost is at the contact, and none is lower than the tips should be.
    #[test]
    fn the_foremost_point_of_a_fingertip_touches_the_rim(
        lean in 0.0..=FRAC_PI_2, tips in 0.001..0.02_f64, height in 0.001..0.1_f64, twin in any::<bool>(),
        heading in -3.0..3.0_f64,
    ) {
        let (center, direction) = (Point2::new(0.2, -0.4), toward(heading.cos(), heading.sin()));
        let heights = PushHeights { tips, top: tips + height };
        let stance = HandStance { twin, lean };
        let pose = plate().world_from_tool(&center, &direction, TABLE, &heights, &stance).unwrap();
        for point in plate().contact_points(&center, &direction) {
            let across = pose.inverse_transform_vector(&Vector3::new(point.x - center.x, point.y - center.y, 0.0)).y;
            prop_assert!((across.abs() - 0.04).abs() < 1e-9);
            let (mut foremost, mut lowest) = (f64::NEG_INFINITY, f64::INFINITY);
            for i in 0..=200 {
                for j in [-1.0, 1.0] {
                    let along = f64::from(i) / 200.0;
                    let corners = [
                        Point3::new(TIPS.beyond_tool - 0.05 * along, across, j * TIPS.half_width),
                        Point3::new(TIPS.beyond_tool, across, TIPS.half_width * (2.0 * along - 1.0)),
                    ];
                    for corner in corners.map(|corner| pose * corner) {
                        lowest = lowest.min(corner.z - TABLE);
                        if corner.z - TABLE <= heights.top + 1e-12 {
                            foremost = foremost.max((corner.xy() - point).dot(&direction));
                        }
                    }
                }
            }
            prop_assert!((lowest - tips).abs() < 1e-9, "{lowest}");
            // The end is looked at every 0.112 mm.
            prop_assert!((-1.2e-4..=1e-9).contains(&foremost), "{foremost}");
        }
    }
}
