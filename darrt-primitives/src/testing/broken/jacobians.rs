//! Broken Jacobians of the gantry's arm.

use std::sync::atomic::{AtomicU32, Ordering};

use darrt_core::laws::Broken;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3, Vector6};

use super::Case;
use crate::laws::check_jacobian;
use crate::laws::jacobian::{ANGULAR, COLUMNS, LINEAR, PURE};
use crate::testing::gantry::{Configuration, Joints, motion};

const Q: Joints = [0.1, 0.2, 1.0, 0.05, 0.7, 1.1, 0.3];
const BASE: [f64; 3] = [0.4, -0.2, 0.9];

fn point() -> Point3<f64> {
    Point3::new(0.05, 0.02, -0.03)
}

fn configuration(q: &[f64]) -> Configuration {
    let mut arm = Q;
    arm.iter_mut().zip(q).for_each(|(slot, value)| *slot = *value);
    Configuration { base: BASE, arm }
}

fn forward(q: &[f64]) -> Isometry3<f64> {
    motion::forward(&configuration(q))
}

/// The honest Jacobian of [`point`]: slides move it, turns move it about the wrist.
fn columns(q: &[f64]) -> Vec<Vector6<f64>> {
    about(q, &(motion::world_from_base(&BASE) * Point3::from(motion::base_from_wrist(&configuration(q).arm))))
}

/// The same, with all axes of the wrist through `centre`.
fn about(q: &[f64], centre: &Point3<f64>) -> Vec<Vector6<f64>> {
    let arm = configuration(q).arm;
    let base = motion::world_from_base(&BASE).rotation;
    let turned = |axis: Vector3<f64>, angle: f64| UnitQuaternion::from_scaled_axis(axis * angle);
    let swung = base * turned(Vector3::z(), arm[4]);
    let bent = swung * turned(Vector3::y(), arm[5]);
    let lever = forward(q) * point() - centre;
    let slide = |axis: Vector3<f64>| stacked(&(base * axis), &Vector3::zeros());
    let turn = |axis: Vector3<f64>| stacked(&axis.cross(&lever), &axis);
    let slides = [Vector3::x(), Vector3::y(), Vector3::z(), Vector3::x()].map(slide);
    let turns = [base * Vector3::z(), swung * Vector3::y(), bent * Vector3::z()].map(turn);
    slides.into_iter().chain(turns).collect()
}

fn stacked(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}

fn check(jacobian: fn(&[f64]) -> Vec<Vector6<f64>>) -> Result<(), Broken> {
    check_jacobian(&Q, &point(), &forward, &jacobian)
}

pub(super) fn cases() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || check(columns) };
    vec![
        case("a column per link", "the fixed joint of the tool has a column, too", COLUMNS, || {
            check(|q| columns(q).into_iter().chain([Vector6::zeros()]).collect())
        }),
        case("Jacobian in the wrong frame", "the columns are given in the tool's frame", LINEAR, || {
            check(|q| {
                let back = forward(q).rotation.inverse();
                let halves =
                    |c: &Vector6<f64>| (c.fixed_rows::<3>(0).clone_owned(), c.fixed_rows::<3>(3).clone_owned());
                columns(q).iter().map(halves).map(|(l, a)| stacked(&(back * l), &(back * a))).collect()
            })
        }),
        case("about the tool", "the lever is measured from the tool frame, not from the axis", LINEAR, || {
            check(|q| about(q, &Point3::from(forward(q).translation.vector)))
        }),
        case("slides that turn", "every joint is taken for a turning one", ANGULAR, || {
            check(|q| {
                let mut all = columns(q);
                if let Some(column) = all.get_mut(2) {
                    column.z = 1.0;
                    column[5] = 1.0;
                }
                all
            })
        }),
        case("buffer that is not cleared", "columns are added to those of the last call", PURE, || {
            check(|q| {
                let more = f64::from(CALLS.fetch_add(1, Ordering::Relaxed)) * 1e-12;
                columns(q).iter().map(|c| c * (1.0 + more)).collect()
            })
        }),
    ]
}
