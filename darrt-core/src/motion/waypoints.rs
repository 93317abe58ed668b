//! A motion through given states: every component interpolated in its own space.

use std::fmt;

use super::Motion;
use crate::domain::Domain;
use crate::space::ComponentSpace;
use crate::state::State;

/// Visits its states in order; the parameter is proportional to the travel bound of each segment.
///
/// The mode is that of the first state at `t = 0`, that of the last at `t = 1`, and `during` in between.
pub struct Waypoints<D: Domain> {
    states: Vec<State<D>>,
    /// Parameter at each state: 0 first, 1 last, never decreasing.
    knots: Vec<f64>,
    during: D::Mode,
    length_m: f64,
}

impl<D: Domain> Waypoints<D> {
    /// A motion through `states`, where `lengths_m[i]` bounds the travel of every point between states `i`
    /// and `i + 1`. `None` unless there are at least two states and one finite, non-negative length per segment.
    pub fn new(states: Vec<State<D>>, lengths_m: &[f64], during: D::Mode) -> Option<Self> {
        if states.len() < 2
            || lengths_m.len() + 1 != states.len()
            || lengths_m.iter().any(|l| !l.is_finite() || *l < 0.0)
        {
            return None;
        }
        let length_m: f64 = lengths_m.iter().sum();
        let mut travelled = 0.0;
        let mut knots = vec![0.0];
        for (i, segment) in lengths_m.iter().enumerate() {
            travelled += segment;
            let last = i + 1 == lengths_m.len();
            knots.push(if last || length_m <= 0.0 {
                if last { 1.0 } else { 0.0 }
            } else {
                (travelled / length_m).min(1.0)
            });
        }
        Some(Self { states, knots, during, length_m })
    }
}

impl<D: Domain> Motion<D> for Waypoints<D> {
    fn length(&self) -> f64 {
        self.length_m
    }

    fn knots(&self) -> &[f64] {
        &self.knots
    }

    fn at_into(&self, m: &D, t: f64, out: &mut State<D>) {
        let t = t.clamp(0.0, 1.0);
        if let (true, Some(first)) = (t <= 0.0, self.states.first()) {
            // A first segment of no length would hide its state (and mode) behind the next.
            out.clone_from(first);
            return;
        }
        let segment = self.knots.partition_point(|k| *k <= t).clamp(1, self.knots.len() - 1);
        let (Some(a), Some(b)) = (self.states.get(segment - 1), self.states.get(segment)) else { return };
        let (Some(start), Some(end)) = (self.knots.get(segment - 1), self.knots.get(segment)) else { return };
        let s = if end > start { ((t - start) / (end - start)).clamp(0.0, 1.0) } else { 1.0 };
        out.robot = m.robot().interpolate(&a.robot, &b.robot, s);
        out.objects.clone_from(&a.objects);
        for (((slot, space), p), q) in out.objects.iter_mut().zip(m.objects()).zip(&a.objects).zip(&b.objects) {
            if p != q {
                *slot = space.interpolate(p, q, s);
            }
        }
        out.mode.clone_from(if t >= 1.0 { &b.mode } else { &self.during });
    }
}

impl<D: Domain> fmt::Debug for Waypoints<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Waypoints").field("states", &self.states).field("knots", &self.knots).finish_non_exhaustive()
    }
}
