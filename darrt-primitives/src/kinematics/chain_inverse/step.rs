//! One damped step towards the target.

use super::Turns;
use super::constants::{Column, PoseError};
use super::{JointValues, LONGEST_STEP, MAX_JOINTS};
use crate::kinematics::limit::JointLimit;
use std::f64::consts::TAU;

/// Share of the squared error that damps.
const DAMPING: f64 = 0.03;
/// Least damping: what keeps the system solvable when joints are lined up, and where the chain has fewer than six.
const LEAST_DAMPING: f64 = 1e-12;

/// What a step is made from.
#[derive(Debug)]
pub(super) struct Step<'a> {
    pub(super) columns: &'a [Column],
    pub(super) error: &'a PoseError,
    pub(super) limits: &'a [JointLimit],
}

impl Step<'_> {
    /// Moves `joints` by one step, within the limits. `false` when there is none.
    pub(super) fn take(&self, joints: &mut JointValues, turns: Turns) -> bool {
        let error = self.error.row();
        let damping = DAMPING * self.error.square() + LEAST_DAMPING;
        let mut free = [true; MAX_JOINTS];
        for ((free, column), (value, limit)) in free.iter_mut().zip(self.columns).zip(joints.iter().zip(self.limits)) {
            // A joint at its limit that would move further out is held.
            let slope = dot(column, &error);
            *free = !((slope < 0.0 && *value <= limit.lower) || (slope > 0.0 && *value >= limit.upper));
        }
        let Some(pull) = damped(self.columns, &free, damping, &error) else {
            return false;
        };
        let mut changes = [0.0; MAX_JOINTS];
        let mut largest = 0.0_f64;
        for ((change, column), free) in changes.iter_mut().zip(self.columns).zip(free) {
            if free {
                *change = dot(column, &pull);
                largest = largest.max(change.abs());
            }
        }
        if !largest.is_finite() {
            return false;
        }
        let scale = if largest > LONGEST_STEP { LONGEST_STEP / largest } else { 1.0 };
        for ((value, change), limit) in joints.iter_mut().zip(changes).zip(self.limits) {
            let moved = *value + scale * change;
            *value = match turns {
                Turns::Free if moved > limit.upper && moved - TAU >= limit.lower => moved - TAU,
                Turns::Free if moved < limit.lower && moved + TAU <= limit.upper => moved + TAU,
                _ => limit.clamp(moved),
            };
        }
        true
    }
}

fn dot(a: &Column, b: &Column) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])
}

/// `(J J^T + damping I)^-1 error` over the free columns, by Cholesky; `None` when it is not positive.
fn damped(columns: &[Column], free: &[bool], damping: f64, error: &Column) -> Option<Column> {
    let mut a = [[0.0; 6]; 6];
    for (column, _) in columns.iter().zip(free).filter(|(_, free)| **free) {
        for i in 0..6 {
            for j in 0..=i {
                a[i][j] += column[i] * column[j];
            }
        }
    }
    // a becomes L below the diagonal, and one over the diagonal of L on it.
    for i in 0..6 {
        a[i][i] += damping;
        for j in 0..=i {
            let rest = (0..j).fold(a[i][j], |rest, k| rest - a[i][k] * a[j][k]);
            if i > j {
                a[i][j] = rest * a[j][j];
            } else if rest > 0.0 {
                a[i][i] = rest.sqrt().recip();
            } else {
                return None;
            }
        }
    }
    let mut x = *error;
    for i in 0..6 {
        for k in 0..i {
            x[i] -= a[i][k] * x[k];
        }
        x[i] *= a[i][i];
    }
    for i in (0..6).rev() {
        for k in i + 1..6 {
            x[i] -= a[k][i] * x[k];
        }
        x[i] *= a[i][i];
    }
    Some(x)
}
