use super::*;
use proptest::prelude::*;

fn plate() -> RimContact {
    RimContact::new(0.14, 0.08, DEFAULT_HALF_TIP).unwrap()
}

fn toward(x: f64, y: f64) -> Unit<Vector2<f64>> {
    Unit::new_normalize(Vector2::new(x, y))
}

#[test]
fn tool_positions_of_verified_pushes() {
    assert!((plate().setback() - 0.1454).abs() < 5e-5);
    // Plate centre, direction, tool position; computed by an independent planner script.
    for (center, direction, tool) in [
        ([-0.2, 0.05], [0.0, -1.0], [-0.2, 0.195_364]),
        ([-0.03, -0.12], [-1.0, 0.0], [0.115_364, -0.12]),
        ([-0.03, -0.12], [-1.0, 1.0], [0.072_788, -0.222_788]),
        ([-0.143, -0.007], [0.0, 1.0], [-0.143, -0.152_364]),
    ] {
        let center = Point2::from(center);
        let direction = toward(direction[0], direction[1]);
        let found = plate().tool_position(&center, &direction);
        assert!((found - Point2::from(tool)).norm() < 1e-6, "{found}");
        let stance = HandStance::default();
        let pose = plate().world_from_tool(&center, &direction, 0.7625, &stance).unwrap();
        let expected = Vector3::new(tool[0], tool[1], 0.7625);
        assert!((pose.translation.vector - expected).norm() < 1e-6);
    }
}

#[test]
fn the_hand_points_down_with_its_fingers_across_the_push() {
    let direction = toward(1.0, 0.0);
    let pose = |twin| {
        let stance = HandStance { twin, ..HandStance::default() };
        plate().world_from_tool(&Point2::origin(), &direction, 0.7, &stance).unwrap()
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
    assert!(RimContact::new(0.04, 0.08, 0.01).is_err());
    assert!(RimContact::new(f64::NAN, 0.08, 0.01).is_err());
    assert!(RimContact::new(0.14, 0.08, 0.0).is_err());
    let lying = HandStance { lean: 1.5, ..HandStance::default() };
    let pose = plate().world_from_tool(&Point2::origin(), &toward(1.0, 0.0), 0.7, &lying);
    assert!(pose.is_err());
}

#[test]
fn one_finger_alone_does_not_touch() {
    let (center, direction) = (Point2::new(0.3, 0.1), toward(0.6, 0.8));
    let tool = plate().tool_position(&center, &direction);
    assert!(plate().touches_rim(&tool, &direction, &center, 1e-9));
    let aside = tool + 0.01 * left_of(&direction);
    assert!(!plate().touches_rim(&aside, &direction, &center, 1e-3));
    let ahead = center + (center - tool);
    assert!(!plate().touches_rim(&ahead, &direction, &center, 1e-3));
}

proptest! {
    #[test]
    fn contact_points_lie_on_the_rim_a_gap_apart(
        radius in 0.05..0.3_f64, share in 0.05..0.99_f64, heading in -3.0..3.0_f64,
        x in -2.0..2.0_f64, y in -2.0..2.0_f64,
    ) {
        let contact = RimContact::new(radius, 2.0 * radius * share, 0.01).unwrap();
        let (center, direction) = (Point2::new(x, y), toward(heading.cos(), heading.sin()));
        let [left, right] = contact.contact_points(&center, &direction);
        prop_assert!(((left - center).norm() - radius).abs() < 1e-12);
        prop_assert!(((right - center).norm() - radius).abs() < 1e-12);
        prop_assert!(((left - right).norm() - contact.gap()).abs() < 1e-12);
        prop_assert!((left - right).dot(&left_of(&direction)) > 0.0);
        let tool = contact.tool_position(&center, &direction);
        prop_assert!(contact.touches_rim(&tool, &direction, &center, 1e-9));
        prop_assert!((contact.center_ahead_of(&tool, &direction) - center).norm() < 1e-12);
    }

    #[test]
    fn a_leaning_finger_face_passes_through_the_contact(
        lean in -1.0..1.0_f64, below in -0.02..0.03_f64, twin in any::<bool>(),
        heading in -3.0..3.0_f64,
    ) {
        let (center, direction) = (Point2::new(0.2, -0.4), toward(heading.cos(), heading.sin()));
        let stance = HandStance { twin, lean, contact_below_tool: below };
        let pose = plate().world_from_tool(&center, &direction, 0.8, &stance).unwrap();
        for point in plate().contact_points(&center, &direction) {
            let local = pose.inverse_transform_point(&Point3::new(point.x, point.y, 0.8 - below));
            // The front face of a fingertip is at half its width along the finger width axis.
            let front = if twin { -DEFAULT_HALF_TIP } else { DEFAULT_HALF_TIP };
            prop_assert!((local.z - front).abs() < 1e-9);
            prop_assert!((local.y.abs() - 0.04).abs() < 1e-9);
        }
    }
}
