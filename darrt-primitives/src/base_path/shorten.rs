//! Makes few straight drives of a way along a lattice: leaves out what can be left out, then pulls it taut.
//!
//! # Source
//! Geraerts and Overmars, Creating high-quality paths for motion planning, 2007 (shortcuts, and each degree of freedom by
//! itself); here the shortcuts are chosen by dynamic programming over all pairs instead of at random.

use std::ops::ControlFlow;

use darrt_core::space::so2::{turn, wrap};

use super::sight::{Sight, Stop};

/// Shortcuts are tried between at most so many poses.
const POSES: usize = 14;
/// Most rounds of pulling.
const ROUNDS: usize = 10;
/// Rounds end when one gains less than this, metres.
const GAIN_M: f64 = 2e-3;
/// How far a pose is pulled towards the straight line, as a share.
const PULLS: [f64; 4] = [1.0, 0.5, 0.2, 0.05];
/// Steps that differ by less than this, metres or radians, go on in one direction.
const STRAIGHT: f64 = 1e-9;

/// A way with what its drives cost.
#[derive(Debug, Clone)]
pub(super) struct PricedPath {
    stops: Vec<Stop>,
    /// Of the drive to each stop from the one before, metres; 0 for the first.
    costs_m: Vec<f64>,
}

impl PricedPath {
    /// The way by these poses; `None` if one of its drives is not clear, or there is none.
    fn by(sight: &mut Sight<'_>, poses: &[[f64; 3]]) -> Option<Self> {
        let mut way = Self { stops: vec![sight.stop(poses.first()?)?], costs_m: vec![0.0] };
        for pose in poses.iter().skip(1) {
            let stop = sight.stop(pose)?;
            way.costs_m.push(sight.cost_m(way.stops.last()?, &stop)?);
            way.stops.push(stop);
        }
        Some(way)
    }

    /// The cheapest way by some of these poses, in their order, or by poses beside them where there is more room.
    fn best_by(sight: &mut Sight<'_>, poses: &[[f64; 3]]) -> Option<Self> {
        let mut stops = Vec::with_capacity(2 * poses.len());
        for (i, at) in poses.iter().enumerate() {
            let stop = sight.stop(at)?;
            stops.push(stop);
            if i > 0 && i + 1 < poses.len() {
                stops.extend(sight.stop_aside(&stop));
            }
        }
        // By stop: what the rest costs from there, what the drive costs that begins there, and where that ends.
        let mut best = vec![(f64::INFINITY, 0.0, 0); stops.len()];
        *best.last_mut()? = (0.0, 0.0, 0);
        for (i, from) in stops.iter().enumerate().rev().skip(1) {
            // The farthest first: what it costs rules out most of the others.
            for (j, to) in stops.iter().enumerate().skip(i + 1).rev() {
                let (rest_m, so_far_m) = (best.get(j)?.0, best.get(i)?.0);
                if rest_m + sight.open_cost_m(&from.at, &to.at) < so_far_m
                    && let Some(cost_m) = sight.cost_m(from, to)
                    && rest_m + cost_m < so_far_m
                {
                    *best.get_mut(i)? = (rest_m + cost_m, cost_m, j);
                }
            }
        }
        let mut way = Self { stops: vec![*stops.first()?], costs_m: vec![0.0] };
        let mut i = 0;
        while i + 1 < stops.len() {
            let (_, cost_m, next) = *best.get(i).filter(|(rest_m, ..)| rest_m.is_finite())?;
            way.stops.push(*stops.get(next)?);
            way.costs_m.push(cost_m);
            i = next;
        }
        Some(way)
    }

    /// The poses.
    pub(super) fn poses(&self) -> Vec<[f64; 3]> {
        self.stops.iter().map(|stop| stop.at).collect()
    }

    /// How far the base drives, metres.
    pub(super) fn length_m(&self) -> f64 {
        let far = |pair: &[Stop]| match pair {
            [a, b] => (b.at[0] - a.at[0]).hypot(b.at[1] - a.at[1]),
            _ => 0.0,
        };
        self.stops.windows(2).map(far).sum()
    }

    /// What all of it costs, metres.
    pub(super) fn cost_m(&self) -> f64 {
        self.costs_m.iter().sum()
    }

    /// Pulls every pose between the ends towards the straight line between its neighbours as long as that makes the way
    /// cheaper, and leaves out those that nothing needs.
    fn pull_taut(&mut self, sight: &mut Sight<'_>) {
        for _ in 0..ROUNDS {
            let before_m = self.cost_m();
            let mut i = 1;
            while i + 1 < self.stops.len() {
                // A pose that is left out makes room for the next one.
                if self.pull(sight, i).is_continue() {
                    i += 1;
                }
            }
            if before_m - self.cost_m() < GAIN_M {
                break;
            }
        }
    }

    /// Pulls one pose; `Break` if it has been left out.
    fn pull(&mut self, sight: &mut Sight<'_>, i: usize) -> ControlFlow<()> {
        let (Some([before, here, after]), Some([first_m, second_m])) =
            (window(&self.stops, i - 1), window(&self.costs_m, i))
        else {
            return ControlFlow::Continue(());
        };
        let now_m = first_m + second_m;
        if let Some(cost_m) = sight.cost_m(&before, &after).filter(|cost_m| *cost_m <= now_m) {
            self.stops.remove(i);
            self.costs_m.remove(i);
            self.put_cost(i, cost_m);
            return ControlFlow::Break(());
        }
        let (come_m, go_m) = (sight.open_cost_m(&before.at, &here.at), sight.open_cost_m(&here.at, &after.at));
        let on_line = sight.between(&before.at, &after.at, come_m / (come_m + go_m));
        let [x, y, yaw] = here.at;
        let [to_x, to_y] = [on_line[0] - x, on_line[1] - y];
        let to_yaw = turn(yaw, on_line[2]);
        for pull in PULLS {
            for (shift, turn) in [(pull, pull), (pull, 0.0), (0.0, pull)] {
                let at = [x + shift * to_x, y + shift * to_y, wrap(yaw + turn * to_yaw)];
                if sight.open_cost_m(&before.at, &at) + sight.open_cost_m(&at, &after.at) >= now_m - STRAIGHT {
                    continue;
                }
                let Some(stop) = sight.stop(&at) else { continue };
                let Some(first_m) = sight.cost_m(&before, &stop) else { continue };
                let Some(second_m) = sight.cost_m(&stop, &after) else { continue };
                if first_m + second_m < now_m - STRAIGHT {
                    if let Some(slot) = self.stops.get_mut(i) {
                        *slot = stop;
                    }
                    self.put_cost(i, first_m);
                    self.put_cost(i + 1, second_m);
                    return ControlFlow::Continue(());
                }
            }
        }
        ControlFlow::Continue(())
    }

    fn put_cost(&mut self, i: usize, cost_m: f64) {
        if let Some(slot) = self.costs_m.get_mut(i) {
            *slot = cost_m;
        }
    }
}

fn window<T: Copy, const N: usize>(all: &[T], from: usize) -> Option<[T; N]> {
    all.get(from..from + N)?.try_into().ok()
}

/// A shorter way of few straight drives. `None` if `poses` is not a clear way itself.
pub(super) fn shorten(sight: &mut Sight<'_>, poses: &[[f64; 3]]) -> Option<PricedPath> {
    let corners = corners(poses);
    let mut way = PricedPath::best_by(sight, &subdivided(&corners)).or_else(|| PricedPath::by(sight, poses))?;
    way.pull_taut(sight);
    Some(way)
}

/// The poses in which the direction changes, and both ends.
fn corners(poses: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut corners: Vec<[f64; 3]> = Vec::new();
    let step = |a: &[f64; 3], b: &[f64; 3]| [b[0] - a[0], b[1] - a[1], turn(a[2], b[2])];
    let mut last = None;
    for pair in poses.windows(2) {
        let [a, b] = pair else { continue };
        let next = step(a, b);
        let goes_on = last.is_some_and(|last: [f64; 3]| last.iter().zip(next).all(|(p, q)| (p - q).abs() < STRAIGHT));
        if !goes_on {
            corners.push(*a);
        }
        last = Some(next);
    }
    corners.extend(poses.last());
    corners
}

/// With poses between the corners, as long as there are not too many: shortcuts begin and end in the middle of a drive too.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number, at most POSES")]
fn subdivided(corners: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let length_m = |pair: &[[f64; 3]]| match pair {
        [a, b] => (b[0] - a[0]).hypot(b[1] - a[1]),
        _ => 0.0,
    };
    let total_m: f64 = corners.windows(2).map(length_m).sum();
    let spare = POSES.saturating_sub(corners.len());
    let mut poses = Vec::with_capacity(POSES.max(corners.len()));
    for pair in corners.windows(2) {
        let [a, b] = pair else { continue };
        let pieces = if total_m > 0.0 { (spare as f64 * length_m(pair) / total_m).floor() } else { 0.0 } + 1.0;
        let between = |i: usize| {
            let share = i as f64 / pieces;
            [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), wrap(a[2] + share * turn(a[2], b[2]))]
        };
        poses.push(*a);
        poses.extend((1..pieces as usize).map(between));
    }
    poses.extend(corners.last());
    poses
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_where_the_direction_changes() {
        let way: Vec<_> = (0..4).map(|i| [0.1 * f64::from(i), 0.0, 0.0]).collect();
        assert_eq!(corners(&way), [way[0], way[3]]);
        let mut bent = way.clone();
        bent.extend([[0.3, 0.1, 0.0], [0.3, 0.2, 0.0], [0.3, 0.2, 0.5]]);
        assert_eq!(corners(&bent), [way[0], way[3], [0.3, 0.2, 0.0], [0.3, 0.2, 0.5]]);
        assert_eq!(corners(&way[..1]), [way[0]]);
    }

    #[test]
    fn subdivision_keeps_corners_and_spends_what_is_left() {
        let corners = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 1.0, 1.0]];
        let poses = subdivided(&corners);
        assert!(poses.len() <= POSES && poses.len() > POSES - 3);
        assert!(corners.iter().all(|corner| poses.contains(corner)));
        assert_eq!(subdivided(&corners[..1]), corners[..1]);
    }
}
