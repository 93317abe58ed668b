use super::*;
use nalgebra::{Isometry3, Matrix3, Point3};
use proptest::prelude::*;

fn bowl(options: WallOptions) -> WallGrasps {
    WallGrasps::new(0.075, 0.065, 0.005, Grip::default(), options).unwrap()
}

fn block(size_x: f64, size_y: f64) -> Result<OverheadGrasps, PrimitiveError> {
    let grip = Grip { open_gap: 0.09, ..Grip::default() };
    OverheadGrasps::new(Footprint::Box { size_x, size_y }, 0.1, 0.03, grip)
}

#[test]
fn verified_bowl_grasps_are_reproduced() {
    // Bottom centre, azimuth, tool position, tool rows; from an independent planner script that
    // put the middle between the fingers on the outer radius.
    let cases = [
        (
            [-1.2, 2.29, 0.8],
            0.276,
            [-1.127_839, 2.310_438, 0.853],
            [[0.0, -0.962_153, -0.272_509], [0.0, -0.272_509, 0.962_153], [-1.0, 0.0, 0.0]],
        ),
        (
            [-0.2, -0.2, 0.75],
            1.085,
            [-0.164_982, -0.133_677, 0.803],
            [[0.0, -0.466_913, -0.884_303], [0.0, -0.884_303, 0.466_913], [-1.0, 0.0, 0.0]],
        ),
    ];
    let family = bowl(WallOptions { inset: Some(0.0), ..WallOptions::default() });
    for ([x, y, bottom], azimuth, [tx, ty, tz], [a, b, c]) in cases {
        let world_from_bowl = Isometry3::translation(x, y, bottom + 0.0325);
        let tool = family.grasp(azimuth, 0.0, false).world_from_tool(&world_from_bowl);
        assert!((tool.translation.vector - Vector3::new(tx, ty, tz)).norm() < 2e-6);
        let expected = Matrix3::from_rows(&[a.into(), b.into(), c.into()]);
        let found = tool.rotation.to_rotation_matrix();
        assert!((found.matrix() - expected).norm() < 3e-6);
    }
}

#[test]
fn a_whole_bowl_is_too_wide_but_its_wall_is_not() {
    let grip = Grip { open_gap: 0.09, ..Grip::default() };
    let whole = OverheadGrasps::new(Footprint::Disc { radius: 0.075 }, 0.065, 0.03, grip);
    let refused = PrimitiveError::NotBelow { name: "held thickness", value: 0.15, bound: 0.09 };
    assert_eq!(whole, Err(refused));
    assert_eq!(bowl(WallOptions::default()).grid().len(), 24 * 3 * 2);
}

#[test]
fn a_box_is_gripped_across_its_narrow_side() {
    let grid = block(0.05, 0.2).unwrap().grid();
    assert_eq!(grid.len(), 2);
    for grasp in grid {
        assert_eq!(grasp.closed_gap_m, 0.05);
        let opening = grasp.object_from_tool * Vector3::y();
        assert!((opening.x.abs() - 1.0).abs() < 1e-12);
        let tips = grasp.object_from_tool * Point3::new(0.018, 0.0, 0.0);
        assert!((tips.z - 0.02).abs() < 1e-12);
    }
    assert_eq!(block(0.05, 0.06).unwrap().grid().len(), 4);
    assert!(block(0.1, 0.2).is_err());
    assert!(block(0.05, -1.0).is_err());
}

/// What a bowl is made of.
struct Bowl {
    radius: f64,
    height: f64,
    wall: f64,
    options: WallOptions,
}

#[test]
fn unusable_bowls_are_refused_by_name() {
    type Change = fn(&mut Bowl);
    let build = |change: Change| {
        let mut bowl = Bowl { radius: 0.075, height: 0.065, wall: 0.005, options: WallOptions::default() };
        change(&mut bowl);
        WallGrasps::new(bowl.radius, bowl.height, bowl.wall, Grip::default(), bowl.options)
    };
    assert!(build(|_| ()).is_ok());
    let refused: [(Change, &str); 13] = [
        (|b| b.radius = f64::NAN, "bowl radius must be finite, found NaN"),
        (|b| b.height = 0.0, "bowl height must be above 0, found 0"),
        (|b| b.wall = 0.0, "wall thickness must be above 0, found 0"),
        (|b| (b.radius, b.wall) = (0.04, 0.04), "wall thickness must be below 0.04, found 0.04"),
        (|b| b.wall = 0.06, "held thickness must be below 0.05, found 0.06"),
        (|b| b.options.depth = 0.0, "fingertip depth must be above 0, found 0"),
        (|b| b.options.depth = 0.07, "fingertip depth must lie in [0, 0.065], found 0.07"),
        (|b| b.options.inset = Some(0.1), "grip inset must lie in [0, 0.075], found 0.1"),
        (|b| b.options.inset = Some(-0.001), "grip inset must lie in [0, 0.075], found -0.001"),
        (|b| b.options.max_lean = 2.0, "largest lean must lie in [0, 1.0471975511965979], found 2"),
        (
            |b| (b.options.max_lean, b.options.grid_leans) = (0.5, vec![0.9]),
            "grid lean must lie in [-0.5, 0.5], found 0.9",
        ),
        (|b| b.options.grid_leans.clear(), "lean grid must not be empty"),
        (|b| b.options.grid_azimuths = 0, "azimuth grid must not be empty"),
    ];
    for (change, why) in refused {
        assert_eq!(build(change).map_err(|why| why.to_string()), Err(why.to_owned()));
    }
}

#[test]
fn small_things_that_cannot_be_gripped_from_above_are_refused_by_name() {
    let build = |height, depth| OverheadGrasps::new(Footprint::Disc { radius: 0.02 }, height, depth, Grip::default());
    assert!(build(0.08, 0.08).is_ok(), "the fingertips may reach down to the bottom");
    for (height, depth, why) in [
        (f64::INFINITY, 0.03, "object height must be finite, found inf"),
        (0.08, 0.0, "fingertip depth must be above 0, found 0"),
        (0.08, 0.09, "fingertip depth must lie in [0, 0.08], found 0.09"),
    ] {
        assert_eq!(build(height, depth).map_err(|why| why.to_string()), Err(why.to_owned()));
    }
}

proptest! {
    #[test]
    fn wall_fingertips_end_at_their_depth_on_both_sides(
        azimuth in -3.2..3.2_f64, lean in -0.5..0.5_f64, flipped in any::<bool>(),
    ) {
        let grasp = bowl(WallOptions::default()).grasp(azimuth, lean, flipped);
        for side in [-1.0, 1.0] {
            let pad = grasp.object_from_tool * Point3::new(0.018, side * 0.0025, 0.0);
            prop_assert!((pad.z - (0.0325 - 0.03)).abs() < 1e-12);
            // Inner and outer face of the wall.
            let flat = pad.coords.xy().norm();
            prop_assert!((flat - 0.070).abs() < 1e-9 || (flat - 0.075).abs() < 1e-9);
        }
    }
    #[test]
    fn the_hand_leans_along_the_wall_and_its_fingers_can_be_exchanged(
        azimuth in -3.2..3.2_f64, lean in -0.5..0.5_f64,
    ) {
        let (outward, counter_clockwise) = radial_and_tangent(azimuth);
        for (flipped, sign) in [(false, -1.0), (true, 1.0)] {
            let hand = bowl(WallOptions::default()).grasp(azimuth, lean, flipped).object_from_tool.rotation;
            let pointing = hand * Vector3::x();
            prop_assert!((pointing.dot(&counter_clockwise) - lean.sin()).abs() < 1e-12);
            prop_assert!((pointing.z + lean.cos()).abs() < 1e-12);
            prop_assert!((hand * Vector3::y() - sign * outward).norm() < 1e-12);
        }
    }
}
