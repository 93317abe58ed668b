//! The table of configurations that attempts start from.
//!
//! Its configurations are the terms of an additive recurrence, so they need not be kept, and each window of consecutive ones
//! covers the joint space evenly. Poses are kept in single precision: they only say where to start.

#![allow(clippy::cast_possible_truncation, reason = "poses of starts in single precision are precise enough")]

use std::f64::consts::PI;

use nalgebra::Isometry3;
use rand::{Rng, RngExt};

use super::constants::Constants;
use super::{JointValues, MAX_JOINTS};
use crate::kinematics::limit::JointLimit;

/// Configurations in the table.
const COUNT: usize = 8192;
/// How many of them an attempt looks at: so many attempts have seen all.
const WINDOW: usize = 512;

/// Poses of configurations all over the joint space.
#[derive(Debug, Clone)]
pub(super) struct Seeds {
    /// Position (x, y, z; m) and rotation (w, x, y, z) of the tool for each, one row per coordinate; the first `WINDOW` stand
    /// at the end again, so that a window may go past it.
    poses: [Vec<f32>; 7],
    /// Where each joint may start, and the step of its recurrence.
    joints: Vec<Range>,
    /// Squared metres that one squared radian of the tool counts as.
    rotation_weight: f32,
}

#[derive(Debug, Clone)]
struct Range {
    lower: f64,
    width: f64,
    step: f64,
}

impl Seeds {
    pub(super) fn new(constants: &Constants, limits: &[JointLimit]) -> Self {
        let ratio = golden(limits.len());
        let mut step = 1.0;
        let range = |(limit, is_turning): (&JointLimit, &bool)| {
            step /= ratio;
            let (lower, width) = range(limit, if *is_turning { 2.0 * PI } else { constants.length_m() });
            Range { lower, width, step }
        };
        let joints: Vec<Range> = limits.iter().zip(constants.turning()).map(range).collect();
        let mut new = Self {
            poses: std::array::from_fn(|_| Vec::with_capacity(COUNT + WINDOW)),
            joints,
            rotation_weight: (constants.length_m() * constants.length_m()) as f32,
        };
        let mut values = JointValues::new();
        for index in 0..COUNT + WINDOW {
            new.values(index % COUNT, &mut values);
            for (row, coordinate) in new.poses.iter_mut().zip(coordinates(&constants.pose(&values))) {
                row.push(coordinate);
            }
        }
        new
    }

    /// Where the first window of a call starts.
    pub(super) fn draw(rng: &mut dyn Rng) -> usize {
        rng.random_range(0..COUNT)
    }

    /// Writes the configuration whose pose is nearest to `base_from_tool` of those in the window that is the `attempt`th after
    /// the one that starts at `first`.
    pub(super) fn nearest(
        &self,
        base_from_tool: &Isometry3<f64>,
        first: usize,
        attempt: usize,
        values: &mut JointValues,
    ) {
        let start = (first + attempt.wrapping_mul(WINDOW)) % COUNT;
        let wanted = coordinates(base_from_tool);
        let row = |i: usize| self.poses.get(i).and_then(|row| row.get(start..start + WINDOW)).unwrap_or_default();
        let rows: [&[f32]; 7] = std::array::from_fn(row);
        let mut distances = [f32::INFINITY; WINDOW];
        let [x, y, z, a, b, c, d] = rows;
        for (i, distance) in distances.iter_mut().enumerate().take(x.len()) {
            let away = [x[i] - wanted[0], y[i] - wanted[1], z[i] - wanted[2]];
            let cosine = a[i] * wanted[3] + b[i] * wanted[4] + c[i] * wanted[5] + d[i] * wanted[6];
            // Of half the angle: 8 (1 - cos(t / 2)) is t^2 and something.
            let turn = 8.0 * (1.0 - cosine.abs());
            *distance = away[0] * away[0] + away[1] * away[1] + away[2] * away[2] + self.rotation_weight * turn;
        }
        let nearest = distances.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(i, _)| i);
        self.values((start + nearest) % COUNT, values);
    }

    /// The configuration at `index`.
    fn values(&self, index: usize, out: &mut JointValues) {
        out.clear();
        // The joints are no more than fit.
        let value = |range: &Range| range.lower + range.width * (0.5 + range.step * index as f64).fract();
        out.extend(self.joints.iter().take(MAX_JOINTS).map(value));
    }
}

fn coordinates(pose: &Isometry3<f64>) -> [f32; 7] {
    let (p, r) = (pose.translation.vector, pose.rotation);
    [p.x, p.y, p.z, r.w, r.i, r.j, r.k].map(|coordinate| coordinate as f32)
}

/// Lower end and width of where a joint starts; `width` stands in for what an infinite end leaves open.
fn range(limit: &JointLimit, width: f64) -> (f64, f64) {
    match (limit.lower.is_finite(), limit.upper.is_finite()) {
        (true, true) => (limit.lower, limit.upper - limit.lower),
        (true, false) => (limit.lower, width),
        (false, true) => (limit.upper - width, width),
        (false, false) => (-0.5 * width, width),
    }
}

/// The root above 1 of `x^(n + 1) = x + 1`; the fractions of `k / x^j` cover `n` dimensions evenly.
///
/// # Source
/// Roberts 2018, *The unreasonable effectiveness of quasirandom sequences*.
fn golden(dimensions: usize) -> f64 {
    let mut x = 2.0_f64;
    for _ in 0..64 {
        x = (1.0 + x).powf(1.0 / (dimensions as f64 + 1.0));
    }
    x
}
