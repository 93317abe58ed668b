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

#[test]
fn unusable_bowls_are_refused() {
    let build = |radius, height, wall, change: fn(&mut WallOptions)| {
        let mut options = WallOptions::default();
        change(&mut options);
        WallGrasps::new(radius, height, wall, Grip::default(), options).is_ok()
    };
    assert!(build(0.075, 0.065, 0.005, |_| ()));
    assert!(!build(0.075, 0.065, 0.06, |_| ()));
    assert!(!build(0.075, 0.02, 0.005, |_| ()));
    assert!(!build(f64::NAN, 0.065, 0.005, |_| ()));
    assert!(!build(0.075, 0.065, 0.005, |o| o.inset = Some(0.1)));
    assert!(!build(0.075, 0.065, 0.005, |o| o.max_lean = 2.0));
    assert!(!build(0.075, 0.065, 0.005, |o| o.grid_leans.push(0.9)));
    assert!(!build(0.075, 0.065, 0.005, |o| o.grid_leans.clear()));
    assert!(!build(0.075, 0.065, 0.005, |o| o.grid_azimuths = 0));
}

#[test]
fn grip_force_of_a_bowl() {
    let force = least_grip_force(0.3, Friction::new(0.5).unwrap()).unwrap();
    assert!((force - 2.9).abs() < 0.05);
    let smooth = least_grip_force(0.3, Friction::new(0.25).unwrap()).unwrap();
    assert!((smooth - 2.0 * force).abs() < 1e-12, "half the friction, twice the force");
    assert!(least_grip_force(0.3, Friction::NONE).is_err());
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
}
