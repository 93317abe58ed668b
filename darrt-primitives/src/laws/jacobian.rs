//! Laws of a Jacobian.

use darrt_core::laws::{Broken, at_most, ensure, equal};
use nalgebra::{Isometry3, Point3, Vector6};

use crate::kinematics::{KinematicChain, KinematicTree};

/// One column per joint.
pub const COLUMNS: &str = "jacobian.columns: there is one column of finite numbers for every joint";
/// Upper half.
pub const LINEAR: &str =
    "jacobian.linear: the upper half of a column is the velocity of the point in the world, per unit of the joint";
/// Lower half.
pub const ANGULAR: &str =
    "jacobian.angular: the lower half of a column is the angular velocity in the world, per unit of the joint";
/// Pure.
pub const PURE: &str = "jacobian.pure: the same joints have the same Jacobian, bit for bit";

/// The laws of this file.
pub const LAWS: &[&str] = &[COLUMNS, LINEAR, ANGULAR, PURE];

/// Half the step of the finite differences, rad or m.
const HALF_STEP: f64 = 1e-6;
/// How far column and difference may be apart, per metre or radian of the column.
const TOLERANCE: f64 = 1e-7;

/// World pose of a link for joint values.
pub type Forward<'a> = &'a dyn Fn(&[f64]) -> Isometry3<f64>;

/// Columns of a Jacobian for joint values: velocity of a point of the link above angular velocity, both in the world.
pub type Columns<'a> = &'a dyn Fn(&[f64]) -> Vec<Vector6<f64>>;

/// The Jacobian of the point `link_point` (in the link's frame, metres) agrees with central differences of `forward`
/// at `q`.
///
/// # Errors
/// The first law that is [`Broken`], with the joint.
pub fn check_jacobian(
    q: &[f64],
    link_point: &Point3<f64>,
    forward: Forward<'_>,
    jacobian: Columns<'_>,
) -> Result<(), Broken> {
    let check = || {
        let columns = jacobian(q);
        let text = || format!("{columns:?}");
        let is_whole = columns.len() == q.len() && columns.iter().flatten().all(|x| x.is_finite());
        ensure(COLUMNS, is_whole, text, "as many finite columns as joints")?;
        for (joint, column) in columns.iter().enumerate() {
            against_differences(q, joint, link_point, forward, column)
                .map_err(|broken| broken.of(format_args!("joint {joint}")))?;
        }
        equal(PURE, &jacobian(q), &columns)
    };
    check().map_err(|broken: Broken| broken.replayed_by(|| format!("check_jacobian(&{q:?}, &{link_point:?}, ..)")))
}

fn against_differences(
    q: &[f64],
    joint: usize,
    link_point: &Point3<f64>,
    forward: Forward<'_>,
    column: &Vector6<f64>,
) -> Result<(), Broken> {
    let stepped = |step: f64| {
        let mut moved = q.to_vec();
        if let Some(slot) = moved.get_mut(joint) {
            *slot += step;
        }
        forward(&moved)
    };
    let (plus, minus) = (stepped(HALF_STEP), stepped(-HALF_STEP));
    let linear = (plus * link_point - minus * link_point) / (2.0 * HALF_STEP);
    let angular = (plus.rotation * minus.rotation.inverse()).scaled_axis() / (2.0 * HALF_STEP);
    for (law, found, expected) in
        [(LINEAR, column.fixed_rows::<3>(0), linear), (ANGULAR, column.fixed_rows::<3>(3), angular)]
    {
        let allowed = TOLERANCE * (1.0 + expected.norm());
        if at_most(law, (found - expected).norm(), 0.0, allowed).is_err() {
            let [left, right] = [found.clone_owned(), expected].map(|v| format!("{:?}", v.as_slice()));
            return Err(Broken::new(law, left, right).within(allowed));
        }
    }
    Ok(())
}

/// The Jacobian of `chain` in `tree` agrees with the tree's own forward kinematics at `q`, one value per variable of
/// the tree.
///
/// # Errors
/// The first law that is [`Broken`], with the joint; [`COLUMNS`] if `q` has the wrong length.
pub fn check_chain(
    tree: &KinematicTree,
    chain: &KinematicChain,
    q: &[f64],
    world_from_root: &Isometry3<f64>,
    tip_point: &Point3<f64>,
) -> Result<(), Broken> {
    let text = || format!("{} values", q.len());
    ensure(COLUMNS, q.len() == tree.variables().len(), text, "one value for every variable of the tree")?;
    // The chain's own joints are put among the others, which stay.
    let all = |values: &[f64]| {
        let mut all = q.to_vec();
        for (variable, value) in chain.variables().iter().zip(values) {
            if let Some(slot) = all.get_mut(*variable) {
                *slot = *value;
            }
        }
        let mut poses = vec![Isometry3::identity(); tree.link_count()];
        let is_forward = tree.forward(&all, world_from_root, &mut poses).is_ok();
        is_forward.then_some(poses)
    };
    let forward = |values: &[f64]| all(values).and_then(|p| p.get(chain.tip()).copied()).unwrap_or_default();
    let jacobian = |values: &[f64]| {
        let mut columns = vec![Vector6::zeros(); chain.variables().len()];
        let solved = all(values).is_some_and(|poses| chain.jacobian(tree, &poses, tip_point, &mut columns).is_ok());
        if solved { columns } else { Vec::new() }
    };
    let own: Vec<f64> = chain.variables().iter().filter_map(|variable| q.get(*variable).copied()).collect();
    check_jacobian(&own, tip_point, &forward, &jacobian)
}
