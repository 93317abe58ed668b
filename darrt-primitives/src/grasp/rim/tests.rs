use super::*;
use nalgebra::{Isometry3, Matrix3};
use proptest::prelude::*;

fn level() -> Rim {
    Rim::level(0.14, 0.02, 0.14).unwrap()
}

/// Taken 0.03 m inside the rim.
fn plate() -> RimGrasps {
    RimGrasps::new(level(), Grip::default(), RimOptions { insertion: 0.03, ..RimOptions::default() }).unwrap()
}

fn surface(corners: &[(f64, f64)]) -> SupportSurface {
    let corners: Vec<_> = corners.iter().map(|(x, y)| Point2::new(*x, *y)).collect();
    SupportSurface::new("table", &corners, 0.75).unwrap()
}

/// A square table whose corner at the origin faces +x +y.
fn corner() -> SupportSurface {
    surface(&[(-1.0, -1.0), (0.0, -1.0), (0.0, 0.0), (-1.0, 0.0)])
}

/// One configuration that an independent planner script checked against inverse kinematics and collisions.
struct Verified {
    /// Bottom centre of the plate.
    plate: [f64; 3],
    azimuth_deg: f64,
    tilt_deg: f64,
    tool_position: [f64; 3],
    /// Rows of the tool's rotation matrix.
    tool_rows: [[f64; 3]; 3],
}

const C30: f64 = 0.866_025;
const C45: f64 = std::f64::consts::FRAC_1_SQRT_2;
const RIGHT: ([f64; 3], f64, [f64; 3]) = ([-0.2, -0.53, 0.75], -90.0, [-0.2, -0.658, 0.76]);
const NEAR: ([f64; 3], f64, [f64; 3]) = ([-0.38, -0.12, 0.75], 180.0, [-0.508, -0.12, 0.76]);
const LEFT: ([f64; 3], f64, [f64; 3]) = ([-0.143, 0.533, 0.75], 90.0, [-0.143, 0.661, 0.76]);
const PLACE: ([f64; 3], f64, [f64; 3]) = ([-2.165, -1.115, 1.0], 0.0, [-2.037, -1.115, 1.01]);

/// Eleven picks and places: every edge at tilts 0, 30, 45 and the two places.
fn verified() -> Vec<Verified> {
    let row = |(plate, azimuth_deg, tool_position), tilt_deg, tool_rows| Verified {
        plate,
        azimuth_deg,
        tilt_deg,
        tool_position,
        tool_rows,
    };
    vec![
        row(RIGHT, 0.0, [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]),
        row(RIGHT, 30.0, [[0.0, 0.0, -1.0], [C30, -0.5, 0.0], [-0.5, -C30, 0.0]]),
        row(RIGHT, 45.0, [[0.0, 0.0, -1.0], [C45, -C45, 0.0], [-C45, -C45, 0.0]]),
        row(NEAR, 0.0, [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
        row(NEAR, 30.0, [[C30, -0.5, 0.0], [0.0, 0.0, 1.0], [-0.5, -C30, 0.0]]),
        row(NEAR, 45.0, [[C45, -C45, 0.0], [0.0, 0.0, 1.0], [-C45, -C45, 0.0]]),
        row(LEFT, 0.0, [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]),
        row(LEFT, 30.0, [[0.0, 0.0, 1.0], [-C30, 0.5, 0.0], [-0.5, -C30, 0.0]]),
        row(LEFT, 45.0, [[0.0, 0.0, 1.0], [-C45, C45, 0.0], [-C45, -C45, 0.0]]),
        row(PLACE, 30.0, [[-C30, 0.5, 0.0], [0.0, 0.0, -1.0], [-0.5, -C30, 0.0]]),
        row(PLACE, 45.0, [[-C45, C45, 0.0], [0.0, 0.0, -1.0], [-C45, -C45, 0.0]]),
    ]
}

#[test]
fn verified_picks_and_places_are_reproduced() {
    for case in verified() {
        let [x, y, bottom] = case.plate;
        let world_from_plate = Isometry3::translation(x, y, bottom + 0.01);
        let grasp = plate().grasp(case.azimuth_deg.to_radians(), case.tilt_deg.to_radians(), false);
        let tool = grasp.world_from_tool(&world_from_plate);
        // The verified hands stand in the plate's middle plane and close to its thickness; ours differ from them only
        // along the opening, by as much as a tilted hand stands higher between its contacts.
        let [tx, ty, tz] = case.tool_position;
        let offset = tool.rotation.inverse() * (tool.translation.vector - Vector3::new(tx, ty, tz));
        let above = if case.tilt_deg == 0.0 { 0.0 } else { -offset.y };
        assert!((offset + Vector3::y() * above).norm() < 1e-9 && (0.0..0.01).contains(&above), "{offset}");
        let [a, b, c] = case.tool_rows;
        let expected = Matrix3::from_rows(&[a.into(), b.into(), c.into()]);
        let found = tool.rotation.to_rotation_matrix();
        assert!((found.matrix() - expected).norm() < 2e-6, "{found}");
    }
}

#[test]
fn the_pads_of_a_tilted_hand_touch_the_plate_and_do_not_enter_it() {
    for tilt_deg in [-45.0, -20.0, -1.0, 0.0, 1.0, 10.0, 30.0, 45.0_f64] {
        let grasp = plate().grasp(0.7, tilt_deg.to_radians(), false);
        // How deep the pads, closed, reach into the plate; they go on behind the rim.
        let mut touches = [f64::INFINITY; 2];
        for (side, touch) in [1.0, -1.0].into_iter().zip(&mut touches) {
            for step in 0..=2000 {
                let along = 0.018 - 0.06 * f64::from(step) / 2000.0;
                let on_pad = nalgebra::Point3::new(along, side * grasp.closed_gap_m / 2.0, 0.0);
                let p = grasp.object_from_tool * on_pad;
                if p.x.hypot(p.y) <= 0.14 {
                    *touch = touch.min(p.z.abs() - 0.01);
                }
            }
        }
        assert!(touches.iter().all(|t| t.abs() < 1e-4), "{tilt_deg}: {touches:?}");
        let free = grasp.open_gap_m - grasp.closed_gap_m;
        assert!((free - 0.03).abs() < 1e-12);
    }
}

#[test]
fn the_wrist_stands_outside_and_the_fingertips_end_inside_the_rim() {
    let grasp = plate().grasp(0.4, 0.0, true);
    // 0.18 from wrist to tool origin, 0.018 from there to the fingertips.
    let wrist = grasp.object_from_tool * nalgebra::Point3::new(-0.18, 0.0, 0.0);
    assert!((wrist.coords.norm() - 0.308).abs() < 1e-12);
    let tip = grasp.object_from_tool * nalgebra::Point3::new(0.018, 0.0, 0.0);
    assert!((tip.coords.norm() - 0.110).abs() < 1e-12);
    assert_eq!(grasp.closed_gap_m, 0.02);
}

#[test]
fn the_grid_has_every_azimuth_tilt_and_roll() {
    assert_eq!(plate().grid().len(), 24 * 2);
    let tilts = [-0.5, 0.0, 1.0].map(f64::to_radians).to_vec();
    let three = RimGrasps::new(level(), Grip::default(), RimOptions { tilts, ..RimOptions::default() });
    assert_eq!(three.unwrap().grid().len(), 24 * 3 * 2);
}

#[test]
fn a_sloping_rim_is_taken_flush_from_its_end() {
    let slope = 14.0_f64.to_radians();
    let rim = Rim::sloping(0.14, 0.012, slope, 0.045, 0.005).unwrap();
    let grasps = RimGrasps::new(rim, Grip::default(), RimOptions::default()).unwrap();
    let (sin, cos) = slope.sin_cos();
    for grasp in grasps.grid() {
        assert_eq!((grasp.closed_gap_m, grasp.open_gap_m), (0.005, 0.05));
        // The end of the rim as the hand has it: 0.04 behind the fingertips, its corners on the pads.
        let mut corners =
            [0.0025, -0.0025].map(|side| grasp.object_from_tool * nalgebra::Point3::new(-0.022, side, 0.0));
        corners.sort_by(|a, b| a.z.total_cmp(&b.z));
        let [lower, upper] = corners.map(|p| [p.x.hypot(p.y), p.z]);
        let expected = [[0.14, 0.012 - 0.005 * cos], [0.14 - 0.005 * sin, 0.012]];
        for (found, expected) in [lower, upper].into_iter().flatten().zip(expected.into_iter().flatten()) {
            assert!((found - expected).abs() < 1e-12, "{lower:?} {upper:?}");
        }
        let pads = grasps.pads(&grasp).unwrap();
        assert!(pads.askew_rad < 1e-12 && (pads.size_m[0] - 0.036).abs() < 1e-12, "{pads:?}");
    }
}

#[test]
fn what_the_pads_lie_on_ends_at_the_fingertips_at_the_rim_and_at_its_inner_end() {
    // Insertion, width of the rim, and from where to where along the tool the pads lie on it.
    for (insertion, width, from, to) in [
        (0.03, 0.14, -0.012, 0.018),
        (0.036, 0.14, -0.018, 0.018),
        (0.05, 0.14, -0.018, 0.018),
        (0.03, 0.02, -0.012, 0.008),
        (0.05, 0.02, -0.018, -0.012),
        (0.06, 0.02, -0.018, -0.022),
    ] {
        let rim = Rim::level(0.14, 0.02, width).unwrap();
        let grasps = RimGrasps::new(rim, Grip::default(), RimOptions { insertion, ..RimOptions::default() }).unwrap();
        let pads = grasps.pads(&grasps.grid()[5]).unwrap();
        assert!((pads.middle_m[0] - f64::midpoint(from, to)).abs() < 1e-12, "{insertion} {pads:?}");
        assert!((pads.size_m[0] - f64::max(to - from, 0.0)).abs() < 1e-12, "{insertion} {pads:?}");
        assert_eq!((pads.size_m[1], pads.middle_m[1]), (0.0226, 0.0));
    }
}

#[test]
fn unusable_options_are_refused() {
    let with = |change: fn(&mut RimOptions)| {
        let mut options = RimOptions::default();
        change(&mut options);
        RimGrasps::new(level(), Grip::default(), options)
    };
    assert!(with(|_| ()).is_ok());
    assert!(with(|o| o.insertion = 0.2).is_err());
    assert!(with(|o| o.grid_azimuths = 0).is_err());
    assert!(with(|o| o.tilts.push(1.0_f64.to_radians())).is_ok());
    assert!(with(|o| o.tilts.push(-1.1_f64.to_radians())).is_err());
    assert!(with(|o| o.tilts.push(f64::NAN)).is_err());
    let thick = Rim::level(0.14, 0.06, 0.14).unwrap();
    assert!(RimGrasps::new(thick, Grip::default(), RimOptions::default()).is_err());
}

#[test]
fn rims_that_cannot_be_are_refused_by_name() {
    let said = |rim: Result<Rim, PrimitiveError>| rim.unwrap_err().to_string();
    assert_eq!(said(Rim::level(0.14, 0.0, 0.14)), "plate thickness must be above 0, found 0");
    assert_eq!(said(Rim::level(0.0, 0.02, 0.14)), "plate radius must be above 0, found 0");
    assert_eq!(said(Rim::level(0.14, 0.02, 0.15)), "rim width must lie in [0, 0.14], found 0.15");
    assert!(said(Rim::sloping(0.14, 0.01, 1.0, 0.03, 0.005)).starts_with("rim slope must lie in [0, 0.78"));
    assert_eq!(said(Rim::sloping(0.14, 0.01, 0.2, 0.03, 0.0)), "rim thickness must be above 0, found 0");
    assert_eq!(said(Rim::sloping(0.14, -0.01, 0.2, 0.03, 0.005)), "plate top must be above 0, found -0.01");
}

#[test]
fn a_level_hand_needs_an_overhang_of_the_insertion() {
    // Centre a inside the edge x = 0, azimuth 0: graspable iff 0.14 - a >= insertion + clearance.
    for (insertion, clearance) in [(0.0301, 0.0), (0.0291, 0.0), (0.030, 0.01)] {
        for millimetres in 10..139 {
            let a = f64::from(millimetres) * 1e-3 + 0.000_05;
            let center = Point2::new(-a, -0.5);
            let found = rim_is_graspable(&corner(), &center, 0.14, 0.0, insertion, clearance);
            assert_eq!(found, 0.14 - a >= insertion + clearance, "a {a}");
        }
    }
    // Exactly at the limit of the planner's rule.
    let limit = Point2::new(-0.10, -0.5);
    assert!(rim_is_graspable(&corner(), &limit, 0.14, 0.0, 0.03, 0.01));
}

#[test]
fn azimuths_are_spread_over_the_turn() {
    let found: Vec<_> = azimuths(4).map(|a| a.to_degrees().round()).collect();
    assert_eq!(found, [0.0, 90.0, 180.0, 270.0]);
}

#[test]
fn a_plate_well_inside_cannot_be_grasped_at_all() {
    for azimuth in azimuths(48) {
        let center = Point2::new(-0.5, -0.5);
        assert!(!rim_is_graspable(&corner(), &center, 0.14, azimuth, 0.03, 0.0));
    }
}

#[test]
fn level_azimuths_at_a_table_corner() {
    // Centre a inside both edges; the azimuths (7.5 degree steps, from -52.5) at which a level hand of
    // half width 0.0112 with its fingertips 0.0291 in (gap 0.03) is beside the table.
    for (a, free) in [
        (0.090, &[-30.0, -22.5, -15.0, -7.5, 0.0, 7.5, 15.0, 22.5, 30.0][..]),
        (0.100, &[-15.0, -7.5, 0.0, 7.5, 15.0][..]),
        (0.110, &[0.0][..]),
        (0.115, &[][..]),
    ] {
        let center = Point2::new(-a, -a);
        for step in -7..=6 {
            let degrees = 7.5 * f64::from(step);
            for (azimuth, name) in [(degrees, "+x"), (90.0 - degrees, "+y")] {
                let azimuth = f64::to_radians(azimuth);
                let gap = fingertip_edge_distance(&corner(), &center, 0.14, azimuth, 0.0291, 0.0112);
                assert_eq!(gap.is_some(), free.contains(&degrees), "{a} {degrees} {name}");
            }
        }
    }
}

#[test]
fn a_notch_in_the_table_must_be_wide_enough() {
    let notched = |half: f64| {
        surface(&[
            (-1.0, -1.0),
            (0.0, -1.0),
            (0.0, -half),
            (-0.2, -half),
            (-0.2, half),
            (0.0, half),
            (0.0, 1.0),
            (-1.0, 1.0),
        ])
    };
    let gap = |half, width| fingertip_edge_distance(&notched(half), &Point2::new(-0.25, 0.0), 0.14, 0.0, 0.03, width);
    assert!((gap(0.05, 0.0112).unwrap() - 0.0388).abs() < 1e-9);
    assert!(gap(0.01, 0.0112).is_none());
    // A post narrower than a fingertip is still in the way.
    let post = surface(&[(0.12, -0.001), (0.122, -0.001), (0.122, 0.001), (0.12, 0.001)]);
    let blocked = fingertip_edge_distance(&post, &Point2::origin(), 0.14, 0.0, 0.03, 0.0112);
    assert_eq!(blocked, None);
}

#[test]
fn a_post_beside_a_fingertip_is_as_far_as_it_looks_and_one_that_meets_it_is_in_the_way() {
    // The fingertip is 0.11 to 0.14 along the azimuth and 0.02 wide, the post 0.002 square.
    let at = [[0.125, 0.006], [0.125, 0.0], [0.112, 0.0], [0.138, 0.0]];
    let half_covered = [[0.125, 0.01], [0.11, 0.004], [0.14, 0.004]];
    let beside = [[0.125, 0.016], [0.112, 0.016], [0.138, 0.016], [0.104, 0.002], [0.146, 0.002]];
    let distances = [(&at[..], None), (&half_covered[..], None), (&beside[..], Some(0.005))];
    let center = Point2::new(0.3, -0.2);
    for (azimuth, mirror) in [0.0, 0.7, 2.5, -2.0_f64].into_iter().flat_map(|a| [(a, 1.0), (a, -1.0)]) {
        let outward = Vector2::new(azimuth.cos(), azimuth.sin());
        let aside = mirror * Vector2::new(-outward.y, outward.x);
        for (posts, expected) in distances {
            for [along, across] in posts {
                let corner = |[u, v]: [f64; 2]| {
                    let p = center + (along + 0.001 * u) * outward + (across + 0.001 * v) * aside;
                    (p.x, p.y)
                };
                let post = surface(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(corner));
                let found = fingertip_edge_distance(&post, &center, 0.14, azimuth, 0.03, 0.01);
                let off = found.unwrap_or(-1.0) - expected.unwrap_or(-1.0);
                assert!(off.abs() < 1e-9, "{azimuth} {along} {across}: {found:?}");
            }
        }
    }
}

#[test]
fn segments_cross_where_each_has_its_ends_on_both_sides_of_the_other() {
    let p = |x, y| Point2::new(x, y);
    let (a, b) = (p(1.0, 2.0), p(4.0, 3.5));
    for (c, d, expected) in [
        (p(2.0, 1.0), p(3.0, 6.0), true),
        // The line through the one meets the other, beyond an end or beside it.
        (p(5.0, 1.0), p(6.0, 8.0), false),
        (p(2.0, 4.0), p(2.5, 6.0), false),
        (p(2.0, 1.0), p(2.1, 1.5), false),
        (p(1.0, 3.0), p(4.0, 4.5), false),
        // They only touch.
        (p(2.0, 2.5), p(2.0, 6.0), false),
        (p(0.0, 1.0), p(2.0, 3.0), false),
    ] {
        for [a, b, c, d] in [[a, b, c, d], [b, a, c, d], [a, b, d, c], [c, d, a, b], [d, c, b, a]] {
            assert_eq!(segments_cross(&a, &b, &c, &d), expected, "{a} {b} {c} {d}");
        }
    }
}

#[test]
fn a_point_is_as_far_from_a_segment_as_from_its_nearest_point() {
    let (a, b) = (Point2::new(1.0, 2.0), Point2::new(4.0, 2.0));
    for (x, y, expected) in [(3.0, 2.5, 0.5), (2.0, 1.0, 1.0), (-2.0, 6.0, 5.0), (7.0, -2.0, 5.0), (1.5, 2.0, 0.0)] {
        assert_eq!(point_segment_distance(&Point2::new(x, y), &a, &b), expected);
        assert_eq!(point_segment_distance(&Point2::new(x, y), &b, &a), expected);
    }
    assert_eq!(point_segment_distance(&Point2::new(4.0, 6.0), &a, &a), 5.0);
}

proptest! {
    #[test]
    fn fingertip_distance_agrees_with_sampling(
        x in -0.5..0.2_f64, y in -0.5..0.2_f64, azimuth in -3.2..3.2_f64, half_width in 0.0..0.03_f64,
    ) {
        let (table, center) = (corner(), Point2::new(x, y));
        let gap = fingertip_edge_distance(&table, &center, 0.14, azimuth, 0.03, half_width);
        let outward = Vector2::new(azimuth.cos(), azimuth.sin());
        let aside = Vector2::new(-outward.y, outward.x);
        let mut sampled = f64::INFINITY;
        for i in 0..=30 {
            for j in -15..=15 {
                let reach = 0.11 + 0.03 * f64::from(i) / 30.0;
                let point = center + reach * outward + half_width * f64::from(j) / 15.0 * aside;
                sampled = sampled.min(-table.depth(&point));
            }
        }
        match gap {
            Some(gap) => prop_assert!(gap <= sampled + 1e-9 && gap > sampled - 0.003),
            // Touching somewhere between the samples.
            None => prop_assert!(sampled < 0.003),
        }
    }
}
