//! Every stock space keeps every law of its trait, at random and in the corners.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use std::f64::consts::{FRAC_PI_2, PI};

use darrt_core::laws::{SpaceClaims, check_component_space, check_covering};
use darrt_core::space::{ComponentSpace, Fixed, Product, RealBox, Se2, Se3, So2};
use darrt_core::testing::strategies::{config, configs, parameters, seeds};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

const REGRESSIONS: Option<&str> = Some("tests/regressions/laws_spaces.txt");

/// Random configurations, and all triples of `corners`.
fn check<S: ComponentSpace>(space: &S, corners: &[S::Config]) {
    let claims = SpaceClaims::default();
    let triples = (configs(space), configs(space), configs(space));
    proptest!(config(64, REGRESSIONS), |((a, b, c) in triples, t in parameters(), u in parameters(), seed in seeds())| {
        check_component_space(space, &claims, [&a, &b, &c], [t, u], seed)?;
        check_component_space(space, &claims, [&a, &a, &b], [t, u], seed)?;
    });
    for a in corners {
        for b in corners {
            for c in corners {
                for ts in [[1e-9, 0.5], [0.25, 0.75], [0.5, 0.999_999_9]] {
                    check_component_space(space, &claims, [a, b, c], ts, 1).unwrap_or_else(|broken| panic!("{broken}"));
                }
            }
        }
    }
}

#[test]
fn real_boxes() {
    check(&RealBox::new([0.0], [1.0]).unwrap(), &[[0.0], [-0.0], [1.0], [f64::MIN_POSITIVE], [0.1 + 0.2]]);
    check(&RealBox::new([-1.0, 2.0], [1.0, 2.0]).unwrap(), &[[-1.0, 2.0], [1.0, 2.0], [0.0, 2.0]]);
    let arm = RealBox::weighted([-2.0; 7], [3.0; 7], [0.8, 0.7, 0.6, 0.5, 0.2, 0.1, 0.05]).unwrap();
    check(&arm, &[[-2.0; 7], [3.0; 7], [0.0; 7], [1.0 / 3.0; 7]]);
    check(&RealBox::new([-1e6], [1e6]).unwrap(), &[[-1e6], [1e6], [1e-9], [0.0]]);
}

const ANGLES: [f64; 12] =
    [0.0, -0.0, 1e-20, -1e-12, FRAC_PI_2, -FRAC_PI_2, PI, -PI, PI.next_down(), -PI.next_down(), 3.0, -3.0];

#[test]
fn circles() {
    check(&So2::new(1.0).unwrap(), &ANGLES);
    check(&So2::new(0.3).unwrap(), &ANGLES);
}

#[test]
fn planes_with_heading() {
    let corners: Vec<[f64; 3]> = ANGLES.iter().step_by(2).map(|yaw| [-1.0, 3.0, *yaw]).collect();
    check(&Se2::new([-1.0, -2.0], [4.0, 3.0], 0.5).unwrap(), &[corners, vec![[4.0, -2.0, PI], [0.0; 3]]].concat());
}

#[test]
fn poses() {
    let turn = |axis: Vector3<f64>, angle: f64| {
        let rotation = UnitQuaternion::from_scaled_axis(axis.normalize() * angle);
        Isometry3::from_parts(Translation3::new(0.5, 0.0, 1.0), rotation)
    };
    let mut corners = vec![Isometry3::identity()];
    for angle in [1e-9, 1e-4, FRAC_PI_2, PI - 1e-9, PI, PI + 1e-9] {
        corners.push(turn(Vector3::new(1.0, 2.0, 3.0), angle));
        corners.push(turn(Vector3::z(), angle));
    }
    // The same rotations by the opposite quaternion.
    let opposite = |p: &Isometry3<f64>| {
        let q = p.rotation.into_inner();
        Isometry3::from_parts(p.translation, UnitQuaternion::new_unchecked(Quaternion::from(-q.coords)))
    };
    let twins: Vec<_> = corners.iter().step_by(3).map(opposite).collect();
    check(&Se3::new([-1.0; 3], [1.0; 3], 0.1).unwrap(), &[corners.clone(), twins].concat());
    check(&Se3::new([-1.0; 3], [1.0; 3], 0.0).unwrap(), &corners[..4]);
}

#[test]
fn fixed_and_products() {
    check(&Fixed::new(7_u8), &[7]);
    let base = Se2::new([0.0, 0.0], [5.0, 5.0], 0.4).unwrap();
    let arm = RealBox::new([-1.0; 3], [1.0; 3]).unwrap();
    let robot = Product::new(base, arm);
    check(&robot, &[([0.0, 0.0, PI], [1.0; 3]), ([5.0, 5.0, -PI], [-1.0; 3])]);
    check(&Product::new(robot.clone(), robot.clone()), &[]);
    check(&Product::new(Fixed::new([0.0]), robot), &[]);
}

#[test]
fn samples_reach_every_corner() {
    let square = RealBox::new([0.0, 0.0], [1.0, 1.0]).unwrap();
    for corner in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [0.5, 0.5]] {
        check_covering(&square, &corner, 0.1, 2000, 3).unwrap();
    }
    for angle in ANGLES {
        check_covering(&So2::new(1.0).unwrap(), &angle, 0.02, 2000, 3).unwrap();
    }
    let poses = Se3::new([0.0; 3], [1e-9; 3], 1.0).unwrap();
    for k in 0..12 {
        let axis = Vector3::new(f64::from(k % 3) - 1.0, f64::from(k % 4) - 1.5, 0.3).normalize();
        let rotation = UnitQuaternion::from_scaled_axis(axis * (f64::from(k) * PI / 11.0));
        check_covering(&poses, &Isometry3::from_parts(Translation3::identity(), rotation), 0.4, 4000, 3).unwrap();
    }
}
