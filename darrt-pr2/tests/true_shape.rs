//! The solids of the built-in description hold the real robot: points measured on its meshes, which are not part of this
//! project, lie inside them at any values of the joints, and the solids reach little farther.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops at the first surprise")]

use std::collections::BTreeMap;
use std::f64::consts::PI;

use darrt_geom::{Body, Shape};
use darrt_pr2::arm::{LimitKind, Side};
use darrt_pr2::model::{Pr2Model, WholeBody};
use nalgebra::{Isometry3, Point3, Rotation3, Vector3};
use rand::{RngExt as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;

/// The points are rounded to a tenth of a millimetre.
const ROUNDED_M: f64 = 1e-4;
/// Where the four casters swivel, in the frame of `base_link`.
const SWIVELS: [[f64; 3]; 4] =
    [[0.2246, 0.2246, 0.0282], [0.2246, -0.2246, 0.0282], [-0.2246, 0.2246, 0.0282], [-0.2246, -0.2246, 0.0282]];

/// Measured points by link; arm links without their side.
fn measured() -> BTreeMap<String, Vec<Point3<f64>>> {
    let file: serde_json::Value = serde_json::from_str(include_str!("data/true_shape.json")).unwrap();
    let links = file["links"].as_object().unwrap().iter();
    let number = |v: &serde_json::Value| v.as_f64().unwrap();
    let points = |v: &serde_json::Value| {
        v.as_array().unwrap().iter().map(|p| Point3::new(number(&p[0]), number(&p[1]), number(&p[2]))).collect()
    };
    links.map(|(name, list)| (name.clone(), points(list))).collect()
}

/// The names under which a measured link occurs in the description.
fn names(link: &str) -> Vec<String> {
    let trunk = ["base_link", "torso_lift_link", "head_pan_link", "head_tilt_link", "laser_tilt_mount_link"];
    if trunk.contains(&link) { vec![link.to_owned()] } else { ["r_", "l_"].map(|side| format!("{side}{link}")).into() }
}

/// Metres by which a point lies outside a solid of the body; negative inside.
fn outside(body: &Body, p: &Point3<f64>) -> f64 {
    let of_part = |part: &darrt_geom::Part| {
        let q = part.body_from_shape.inverse_transform_point(p);
        let over = match &part.shape {
            Shape::Cuboid { half_extents, .. } => q.coords.abs() - half_extents,
            Shape::Cylinder { radius, half_height, .. } => {
                Vector3::new(q.x.hypot(q.y) - radius, 0.0, q.z.abs() - half_height)
            }
            other => panic!("{}: {}", body.name, other.kind()),
        };
        over.max()
    };
    body.parts.iter().map(of_part).fold(f64::INFINITY, f64::min)
}

/// A state with every joint anywhere within its hard limits.
fn anyhow(model: &Pr2Model, rng: &mut Xoshiro256PlusPlus) -> WholeBody {
    let mut state = WholeBody::at_rest();
    state.torso_m = rng.random_range(0.0..0.33);
    state.head = [rng.random_range(-3.0..3.0), rng.random_range(-0.47..1.39)];
    for side in Side::BOTH {
        let limits = model.limits(side, LimitKind::Hard);
        state.arms[side.index()] = limits.map(|l| rng.random_range(l.lower.max(-PI)..l.upper.min(PI)));
        state.finger_angles[side.index()] = rng.random_range(0.0..0.548);
    }
    state
}

#[test]
fn every_measured_point_lies_in_a_solid_whatever_the_joints() {
    let model = Pr2Model::embedded().unwrap();
    let measured = measured();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    for _ in 0..60 {
        let state = anyhow(&model, &mut rng);
        let poses = model.link_poses(&state);
        for (link, points) in measured.iter().filter(|(link, _)| *link != "caster") {
            for name in names(link) {
                let pose = poses[model.tree().link_index(&name).unwrap()];
                for p in points {
                    let world = pose * p;
                    let solids = model.bodies().iter().zip(&poses);
                    let least = solids.filter_map(|(body, pose)| {
                        Some(outside(body.as_ref()?, &pose.inverse_transform_point(&world)))
                    });
                    let least = least.fold(f64::INFINITY, f64::min);
                    assert!(least <= ROUNDED_M, "{name} {p}: {:.2} mm outside in {state:?}", 1e3 * least);
                }
            }
        }
    }
}

#[test]
fn the_casters_are_covered_at_every_angle_and_stand_on_the_floor() {
    let model = Pr2Model::embedded().unwrap();
    let base = model.tree().link_index("base_link").unwrap();
    let body = model.body(base).unwrap();
    let points = &measured()["caster"];
    for at in SWIVELS {
        for degrees in 0..360 {
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), f64::from(degrees).to_radians());
            for p in points {
                let least = outside(body, &(Point3::from(at) + turn * p.coords));
                assert!(least <= ROUNDED_M, "{at:?} {degrees} {p}: {:.2} mm outside", 1e3 * least);
            }
        }
    }
    let world_from_base = model.link_poses(&WholeBody::at_rest())[base];
    let lowest = model.body(base).unwrap().parts.iter().map(|part| {
        let pose: Isometry3<f64> = world_from_base * part.body_from_shape;
        pose.translation.z - part.shape.support_extent(&pose.inverse_transform_vector(&-Vector3::z()))
    });
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    assert!(lowest.abs() < 1e-9, "the lowest point of the base is at {lowest}");
}

/// What a link reaches beyond its own measured points along the axes, for the links that cover nothing of another link.
#[test]
fn solids_end_where_the_robot_ends() {
    let model = Pr2Model::embedded().unwrap();
    let own = [
        "torso_lift_link",
        "laser_tilt_mount_link",
        "upper_arm_link",
        "forearm_link",
        "wrist_flex_link",
        "gripper_l_finger_link",
        "gripper_l_finger_tip_link",
    ];
    for (link, points) in measured().iter().filter(|(link, _)| own.contains(&link.as_str())) {
        let name = names(link).swap_remove(0);
        let body = model.body(model.tree().link_index(&name).unwrap()).unwrap();
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().flat_map(|a| [a, -a]) {
            // The shaft of the upper arm and the shafts that carry a link lie in the link before.
            let reach = points.iter().map(|p| axis.dot(&p.coords)).fold(f64::NEG_INFINITY, f64::max);
            let solid = body.parts.iter().map(|part| {
                let own = part.body_from_shape.inverse_transform_vector(&axis);
                axis.dot(&part.body_from_shape.translation.vector) + part.shape.support_extent(&own)
            });
            let solid = solid.fold(f64::NEG_INFINITY, f64::max);
            assert!(solid <= reach + 0.005, "{name} along {axis:?}: {:.1} mm too far", 1e3 * (solid - reach));
        }
    }
}
