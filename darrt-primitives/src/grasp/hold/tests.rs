use std::f64::consts::FRAC_PI_2;

use nalgebra::UnitQuaternion;
use proptest::prelude::*;

use super::*;
use crate::grasp::footprint::Footprint;
use crate::grasp::overhead::{OverheadGrasps, WallGrasps, WallOptions};
use crate::grasp::rim::{Rim, RimGrasps, RimOptions};
use crate::grasp::side::SideGrasps;
use crate::grasp::{GraspFamily, Grip};

const PLATE: Load = Load { mass_kg: 0.5, friction: 0.4, grip_force_n: 50.0, payload_kg: 1.8 };

/// The plate of the facts, taken `insertion` inside its rim.
fn rim(insertion: f64) -> RimGrasps {
    let options = RimOptions { insertion, ..RimOptions::default() };
    RimGrasps::new(Rim::level(0.14, 0.02, 0.14).unwrap(), Grip::default(), options).unwrap()
}

/// What is said about the first grasp of a family.
fn holds(family: &dyn GraspFamily, load: &Load) -> Result<Hold, NoHold> {
    let grasp = family.grid()[0];
    hold(&grasp.object_from_tool.inverse(), &family.pads(&grasp).unwrap(), load)
}

fn needs(found: Result<Hold, NoHold>) -> (Yield, f64) {
    match found {
        Err(NoHold::Weak { cause, needs_n, .. }) => (cause, needs_n),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_plate_of_half_a_kilogram_needs_41_newton_on_30_millimetres() {
    let weak = Load { grip_force_n: 20.0, ..PLATE };
    let (cause, force) = needs(holds(&rim(0.03), &weak));
    // 0.5 x 9.81 x 0.125 = 0.613 N m, of which each newton bears 0.015.
    assert_eq!(cause, Yield::Tips);
    assert!((force / SAFETY - 40.875).abs() < 1e-9, "{force}");
}

#[test]
fn fifty_newton_hold_the_plate_by_the_whole_pads_only() {
    // Where the pads lie on it whole, deeper is better: the lever is shorter.
    for (insertion, force) in [(0.03, 61.31), (0.035, 51.50), (0.036, 49.87), (0.04, 48.23), (0.045, 46.19)] {
        let (_, found) = needs(holds(&rim(insertion), &Load { grip_force_n: 10.0, ..PLATE }));
        assert!((found - force).abs() < 5e-3, "{insertion}: {found}");
        assert_eq!(holds(&rim(insertion), &PLATE).is_ok(), force < 50.0);
    }
}

#[test]
fn a_plate_held_level_may_lean_until_it_turns_about_the_normal_of_the_pads() {
    let found = holds(&rim(0.04), &PLATE).unwrap().max_tilt_rad;
    // 2 x 0.4 x 50 N x 11.4 mm against 1.5 x 0.579 N m x sin.
    assert!((found.to_degrees() - 31.5).abs() < 1.0, "{}", found.to_degrees());
    let rough = holds(&rim(0.04), &Load { friction: 0.8, ..PLATE }).unwrap().max_tilt_rad;
    assert!(rough > 2.0 * found);
}

#[test]
fn what_cannot_be_held_is_said_with_its_numbers() {
    let said = |load: Load| holds(&rim(0.04), &load).unwrap_err().to_string();
    assert_eq!(said(Load { mass_kg: 50.0, ..PLATE }), "it weighs 50 kg, the arm carries 1.8");
    assert_eq!(said(Load { friction: 0.0, ..PLATE }), "the fingers have no friction with it");
    let tips = "against tipping out of the pads it needs 86.9 N of grip, the gripper has 50";
    assert_eq!(said(Load { mass_kg: 0.9, ..PLATE }), tips);
    let slips = "against slipping out it needs 73.6 N of grip, the gripper has 50";
    assert_eq!(said(Load { friction: 0.05, ..PLATE }), slips);
}

#[test]
fn pads_that_are_not_flush_do_not_hold() {
    let family = rim(0.04);
    let ask = |tilt_deg: f64, friction: f64| {
        let grasp = family.grasp(0.3, f64::to_radians(tilt_deg), false);
        hold(&grasp.object_from_tool.inverse(), &family.pads(&grasp).unwrap(), &Load { friction, ..PLATE })
    };
    assert!(ask(0.9, 0.4).is_ok() && ask(-0.9, 0.4).is_ok());
    assert_eq!(
        ask(10.0, 0.8).unwrap_err().to_string(),
        "the pads are 10.0 degrees from flush with it, at most 1.0 hold"
    );
    assert!(ask(-1.1, 0.8).is_err());
    // On slippery pads the friction cone is narrower than that.
    assert!(
        matches!(ask(0.9, 0.01), Err(NoHold::Askew { most_rad, .. }) if (most_rad - 0.01_f64.atan()).abs() < 1e-12)
    );
}

#[test]
fn a_bowl_by_its_wall_and_a_mug_by_its_side_hold_far_over() {
    let bowl = WallGrasps::new(0.075, 0.065, 0.005, Grip::default(), WallOptions::default()).unwrap();
    let bowl = holds(&bowl, &Load { mass_kg: 0.3, friction: 0.5, ..PLATE }).unwrap();
    assert!((30.0..60.0).contains(&bowl.max_tilt_rad.to_degrees()), "{bowl:?}");
    let (grip, disc) = (Grip { open_gap: 0.09, ..Grip::default() }, Footprint::Disc { radius: 0.035 });
    let side = SideGrasps::new(disc, 0.1, 0.01, 0.0, grip).unwrap();
    let overhead = OverheadGrasps::new(disc, 0.1, 0.03, grip).unwrap();
    for family in [&side as &dyn GraspFamily, &overhead] {
        let light = Load { mass_kg: 0.25, ..PLATE };
        assert!(holds(family, &light).unwrap().max_tilt_rad > 0.7);
        assert!(matches!(holds(family, &Load { mass_kg: 500.0, ..light }), Err(NoHold::TooHeavy { .. })));
        assert_eq!(holds(family, &Load { friction: 0.0, ..light }), Err(NoHold::NoFriction));
    }
    // By the side the axis goes through the middle of the pads: nothing turns it, and only its weight makes it slip.
    assert_eq!(holds(&side, &Load { mass_kg: 0.25, ..PLATE }).unwrap().max_tilt_rad, PI);
}

#[test]
fn pads_that_do_not_come_to_the_axis_of_a_round_thing_touch_it_askew() {
    let (grip, disc) = (Grip { open_gap: 0.09, ..Grip::default() }, Footprint::Disc { radius: 0.035 });
    let side = |past_axis| SideGrasps::new(disc, 0.1, past_axis, 0.0, grip).unwrap();
    for past_axis in [0.0, 0.01, 0.036] {
        assert!(holds(&side(past_axis), &PLATE).is_ok());
    }
    for past_axis in [-0.002, 0.038] {
        assert!(matches!(holds(&side(past_axis), &PLATE), Err(NoHold::Askew { .. })));
    }
}

#[test]
fn round_ends_are_not_gripped() {
    let (grip, disc) = (Grip { open_gap: 0.09, ..Grip::default() }, Footprint::Disc { radius: 0.035 });
    let overhead = |depth| OverheadGrasps::new(disc, 0.1, depth, grip).unwrap().with_round_ends(0.035);
    let light = Load { mass_kg: 0.1, ..PLATE };
    assert_eq!(holds(&overhead(0.03), &light), Err(NoHold::NoContact));
    assert!(holds(&overhead(0.05), &light).is_ok());
    let side = |offset| SideGrasps::new(disc, 0.1, 0.01, offset, grip).unwrap().with_round_ends(0.035);
    assert!(holds(&side(0.0), &light).is_ok());
    assert_eq!(holds(&side(0.04), &light), Err(NoHold::NoContact));
}

/// Does the hold bear gravity along a unit vector of the object frame? From the definition.
fn bears(tool_from_object: &Isometry3<f64>, contact: &PadContact, load: &Load, down: &Vector3<f64>) -> bool {
    let force = tool_from_object.rotation * down * (SAFETY * load.mass_kg * GRAVITY);
    let [x, z] = contact.middle_m;
    let moment = (tool_from_object.translation.vector - Vector3::new(x, 0.0, z)).cross(&force);
    let (grip, [length, width]) = (load.grip_force_n, contact.size_m);
    let slide = 2.0 * load.friction * grip;
    let slip = (force.x / slide).powi(2) + (force.z / slide).powi(2) + (moment.y / slide / contact.spin_arm_m).powi(2);
    let tip = moment.z.abs() / (grip * length / 2.0) + moment.x.abs() / (grip * width / 2.0);
    let slack = 1.0 + 1e-9;
    slip <= slack && tip <= slack && force.y.abs() <= 2.0 * grip * slack
}

fn any_contact() -> impl Strategy<Value = (Isometry3<f64>, PadContact)> {
    let at = [-0.15..0.15_f64, -0.05..0.05, -0.05..0.05];
    let turn = [-3.0..3.0_f64, -1.5..1.5, -3.0..3.0];
    (at, turn, 0.002..0.036_f64, 0.002..0.0226_f64, -0.01..0.01_f64).prop_map(|(at, [r, p, y], length, width, x)| {
        let tool_from_object =
            Isometry3::from_parts(Vector3::from(at).into(), UnitQuaternion::from_euler_angles(r, p, y));
        (tool_from_object, PadContact::flat([x, -width / 2.0], [x + length, width / 2.0]))
    })
}

fn any_load() -> impl Strategy<Value = Load> {
    (0.01..1.5_f64, 0.05..1.5_f64, 10.0..200.0_f64).prop_map(|(mass_kg, friction, grip_force_n)| Load {
        mass_kg,
        friction,
        grip_force_n,
        payload_kg: 1.8,
    })
}

proptest! {
    #[test]
    fn what_holds_bears_its_weight_at_every_lean_up_to_the_limit(
        (at, contact) in any_contact(), load in any_load(), share in 0.0..1.0_f64, azimuth in -3.2..3.2_f64,
    ) {
        if let Ok(Hold { max_tilt_rad }) = hold(&at, &contact, &load) {
            prop_assert!(max_tilt_rad >= FLUSH_RAD * (1.0 - 1e-9), "{max_tilt_rad}");
            let (lean, (sin, cos)) = (share * max_tilt_rad, azimuth.sin_cos());
            let down = Vector3::new(lean.sin() * cos, lean.sin() * sin, -lean.cos());
            prop_assert!(bears(&at, &contact, &load, &down), "{lean} of {max_tilt_rad}");
        }
    }

    #[test]
    fn what_does_not_hold_says_how_much_more_force_it_needs(
        (at, contact) in any_contact(), load in any_load(),
    ) {
        if let Err(NoHold::Weak { needs_n, has_n, .. }) = hold(&at, &contact, &load) {
            prop_assert!(needs_n > has_n);
            let enough = Load { grip_force_n: 1.001 * needs_n, ..load };
            if let Err(NoHold::Weak { needs_n: more_n, .. }) = hold(&at, &contact, &enough) {
                prop_assert!(more_n > needs_n, "{needs_n} {more_n}");
            }
        }
    }

    #[test]
    fn mass_never_helps_friction_and_force_always_do(
        (at, contact) in any_contact(), load in any_load(), more in 1.0..3.0_f64,
    ) {
        let limit = |load: &Load| hold(&at, &contact, load).map_or(-1.0, |found| found.max_tilt_rad);
        let given = limit(&load);
        let heavier = limit(&Load { mass_kg: load.mass_kg * more, ..load });
        prop_assert!(heavier <= given + 1e-9, "{heavier}");
        let rougher = limit(&Load { friction: load.friction * more, ..load });
        prop_assert!(rougher >= given - 1e-9, "{rougher}");
        let stronger = limit(&Load { grip_force_n: load.grip_force_n * more, ..load });
        prop_assert!(stronger >= given - 1e-9, "{stronger}");
        let sturdier = limit(&Load { payload_kg: load.payload_kg * more, ..load });
        prop_assert!(sturdier >= given, "{sturdier}");
    }

    #[test]
    fn the_azimuth_of_a_grasp_does_not_matter(azimuth in -3.2..3.2_f64, flipped in any::<bool>()) {
        let family = rim(0.04);
        let ask = |azimuth, flipped| {
            let grasp = family.grasp(azimuth, 0.0, flipped);
            hold(&grasp.object_from_tool.inverse(), &family.pads(&grasp).unwrap(), &PLATE).unwrap().max_tilt_rad
        };
        prop_assert!((ask(azimuth, flipped) - ask(0.0, false)).abs() < 1e-9);
    }

    #[test]
    fn the_largest_tilt_is_where_the_need_meets_the_force(
        upright in 0.0..50.0_f64, sideways in 0.0..200.0_f64,
    ) {
        let tilt = largest_tilt(upright, sideways, 50.0);
        let need = |tilt: f64| tilt.cos().abs() * upright + tilt.sin().abs() * sideways;
        if tilt < PI {
            prop_assert!((need(tilt) - 50.0).abs() < 1e-9 && tilt <= FRAC_PI_2);
        }
        for part in 0..=20 {
            prop_assert!(need(tilt * f64::from(part) / 20.0) <= 50.0 + 1e-9);
        }
    }
}
