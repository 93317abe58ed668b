//! The shortest way of the base between two poses: the robot with its arm at rest moves as one rigid body in the plane.
//!
//! | question | file |
//! |---|---|
//! | what does a solid look like from above, at these heights? | `section`, `outline` |
//! | where are the fixed bodies? | `floor_plan` |
//! | how far is the robot from the obstacles? | `footprint` |
//! | is a straight drive clear, and what does it cost? | `sight`, exactly `drive` |
//! | which poses are tried, and in what order? | `lattice`, `bound`, `search` |
//! | how is the middle of a narrow door found? | `nudge` |
//! | how does a way become short? | `shorten` |
//!
//! A* over a lattice of places and yaws in the signed distances of outlines, then shortcuts and pulling taut, then the exact
//! check of every straight drive. A coarse lattice first, a finer one where it finds nothing. No random choice, no clock.

use darrt_core::local_repair::NoWay;
use darrt_core::space::so2::turn;

use crate::manipulator::Manipulator;
use crate::tabletop::{Tabletop, TabletopState};

mod bound;
mod drive;
pub(crate) mod floor_plan;
mod footprint;
mod lattice;
mod nudge;
mod outline;
mod search;
mod section;
mod shorten;
mod sight;

use bound::Bounds;
use drive::Drives;
use footprint::Footprint;
use lattice::Lattice;
use nalgebra::Vector2;
use search::{Outcome, Search};
use shorten::PricedPath;
use sight::{Judge, Sight, Stop, Terms};

/// What a way of the base costs, and how hard it is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BasePath {
    /// How many times as much a metre counts where something is as near as the least margin, at least 1; in proportion up
    /// to the wanted margin, where it counts once. So much farther it goes at most to keep that.
    pub tight: f64,
    /// Metres of driving that a radian of turning is worth.
    pub turn_m: f64,
    /// Poses that are looked at before it gives up.
    pub looks: usize,
}

impl Default for BasePath {
    fn default() -> Self {
        Self { tight: 1.2, turn_m: 0.2, looks: 60_000 }
    }
}

/// A lattice: distance between rows in metres, between yaws in degrees.
#[derive(Debug, Clone, Copy)]
struct Level {
    spacing_m: f64,
    step_deg: f64,
}

/// Coarse first. HEURISTIC: a third of the robot's width and a twelfth of a half turn find nearly all ways at once.
const LEVELS: [Level; 2] = [Level { spacing_m: 0.1, step_deg: 15.0 }, Level { spacing_m: 0.05, step_deg: 7.5 }];

/// A way that costs more than so many times the straight drive is looked for once more, on a lattice
const STRAIGHT_ENOUGH: f64 = 1.1;
/// of so many rows across all that may be cheaper,
const ROWS: f64 = 16.0;
/// that are not farther apart, and not nearer, than that, metres,
const FINER: Level = Level { spacing_m: 0.06, step_deg: 7.5 };
const LEAST_SPACING_M: f64 = 0.02;
/// as long as not more than so many poses have been looked at.
const MORE_LOOKS: usize = 4_000;

/// Most cells of a lattice; where there are more, the rows are farther apart.
const CELLS: f64 = 2e6;

/// Expansions in which the goal must not turn out to be enclosed.
const FROM_GOAL: usize = 100;

/// A way along a lattice costs at most so many times what it does once it is short. HEURISTIC: eight directions alone cost a
/// twelfth.
const ON_LATTICE: f64 = 1.2;
/// Poses that are looked at for a way with more room than the shortest one.
const ROOMIER_LOOKS: usize = 10_000;

/// What is added to the least margin, and how finely a drive is looked at, metres: the exact check then finds what it asks for.
const SPARE_M: f64 = 5e-4;
/// What looks nearer than the least margin by more than this looks nearer than it is, metres.
const DOUBT_M: f64 = 1e-4;

impl BasePath {
    /// Poses of the base from that of `from`, the first, to `to`, the last, both bit for bit; straight drives lie between
    /// them, or those of a base that drives along its heading only. The arm, the objects and what is held stand as in `from`, whose mode is that on the way. Both ends are
    /// clear with this [care](darrt_core::validity::Validity::most_care); the way is clear, and keeps as much of this care as was
    /// found on ways that are not much longer.
    ///
    /// # Errors
    /// [`NoWay::WithAnyCare`] if none is found.
    pub fn find<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        care: usize,
        from: &TabletopState<M>,
        to: &[f64; 3],
    ) -> Result<Vec<[f64; 3]>, NoWay> {
        m.collision_scene().with_worker(|worker| {
            let mut finder = Finder { options: self, m, from, to, drives: Drives::new(m, from, worker) };
            let shortest = finder.shortest().ok_or(NoWay::WithAnyCare)?;
            for care in (1..=care).rev() {
                if finder.is_clear(&shortest.poses, care) {
                    break;
                }
                if let Some(roomier) = finder.roomier(care, &shortest) {
                    return Ok(roomier);
                }
            }
            Ok(shortest.poses)
        })
    }
}

/// Looks for ways between two poses.
struct Finder<'a, M: Manipulator> {
    options: &'a BasePath,
    m: &'a Tabletop<M>,
    from: &'a TabletopState<M>,
    to: &'a [f64; 3],
    drives: Drives<'a, M>,
}

/// The poses of a way, and what it would cost if there were room everywhere.
#[derive(Debug, Clone, PartialEq)]
struct FoundPath {
    poses: Vec<[f64; 3]>,
    open_cost_m: f64,
}

impl<M: Manipulator> Finder<'_, M> {
    /// The robot among the obstacles, and the terms of a way that keeps `margin_m` from them. What is exactly known to be clear
    /// at the ends may not look so from above: that does not count. Was there such a thing?
    fn sight_terms(&self, margin_m: f64) -> (Footprint, Terms, bool) {
        let around = self.m.collision_scene();
        let mut footprint = Footprint::new(self.m, self.from, around.floor_plan(), margin_m);
        let mut least_m = margin_m + SPARE_M;
        let mut is_doubtful = false;
        for end in [&self.from.robot.base, self.to] {
            is_doubtful |= footprint.forgive(end, margin_m - DOUBT_M);
            least_m = least_m.min(footprint.distance_m(end, least_m, f64::NEG_INFINITY));
        }
        let [wanted_m, _] = around.drive_margins_m(around.most_care());
        let terms = Terms {
            least_m,
            wanted_m: wanted_m.max(margin_m) + SPARE_M,
            resolution_m: SPARE_M,
            turn_m: self.options.turn_m,
            tight: self.options.tight.max(1.0),
            is_along_heading: self.m.manipulator().drives_along_heading(),
        };
        (footprint, terms, is_doubtful)
    }

    /// Are all drives of a way clear?
    fn is_clear(&mut self, way: &[[f64; 3]], care: usize) -> bool {
        way.windows(2).all(|pair| matches!(pair, [a, b] if self.drives.is_clear(care, a, b)))
    }

    /// The cheapest way that keeps the least margins.
    fn shortest(&mut self) -> Option<FoundPath> {
        let around = self.m.collision_scene();
        let [_, least_m] = around.drive_margins_m(0);
        let (mut footprint, terms, has_forgiven) = self.sight_terms(least_m);
        let mut is_doubtful = around.floor_plan().has_gaps || has_forgiven;
        let ends = [&self.from.robot.base, self.to];
        for level in LEVELS {
            let looks = footprint.looks() + self.options.looks;
            if !is_doubtful {
                match way_along(level, ends, &mut Sight::new(&mut footprint, terms, None), f64::INFINITY, looks) {
                    Trial::Found(way) if self.is_clear(&way.poses, 0) => return Some(way),
                    // Seen from above it is clear, but not in space.
                    Trial::Found(_) => is_doubtful = true,
                    Trial::Hope => continue,
                    Trial::Hopeless => break,
                }
            }
            let drives = &mut self.drives;
            let judge: &mut Judge<'_> = &mut |a, b| drives.is_clear(0, a, b);
            match way_along(level, ends, &mut Sight::new(&mut footprint, terms, Some(judge)), f64::INFINITY, looks) {
                Trial::Found(way) if self.is_clear(&way.poses, 0) => return Some(way),
                Trial::Hope => {}
                Trial::Found(_) | Trial::Hopeless => break,
            }
        }
        None
    }

    /// A way with this care that is not much longer than the shortest one.
    fn roomier(&mut self, care: usize, shortest: &FoundPath) -> Option<Vec<[f64; 3]>> {
        let around = self.m.collision_scene();
        let [margin_m, _] = around.drive_margins_m(care);
        let (mut footprint, terms, has_forgiven) = self.sight_terms(margin_m);
        let below_m = terms.tight * shortest.open_cost_m;
        let drives = &mut self.drives;
        let judge: &mut Judge<'_> = &mut |a, b| drives.is_clear(care, a, b);
        let is_doubtful = around.floor_plan().has_gaps || has_forgiven;
        let mut sight = Sight::new(&mut footprint, terms, is_doubtful.then_some(judge));
        let [level, _] = LEVELS;
        let ends = [&self.from.robot.base, self.to];
        let way = match way_along(level, ends, &mut sight, ON_LATTICE * below_m, ROOMIER_LOOKS) {
            Trial::Found(way) if way.open_cost_m <= below_m => way.poses,
            _ => return None,
        };
        self.is_clear(&way, care).then_some(way)
    }
}

/// What a search along one lattice comes to.
#[derive(Debug, Clone, PartialEq)]
enum Trial {
    /// The poses of a way.
    Found(FoundPath),
    /// No way, but a finer lattice may have one.
    Hope,
    /// No way, nor a passage that is wide enough, or nearly.
    Hopeless,
}

/// A short way along a lattice that costs less than `below_m` there, as long as not more than `looks` poses have been looked at.
fn way_along(level: Level, [start, goal]: [&[f64; 3]; 2], sight: &mut Sight<'_>, below_m: f64, looks: usize) -> Trial {
    let (Some(start), Some(goal)) = (sight.stop(start), sight.stop(goal)) else { return Trial::Hopeless };
    let stops = [start, goal];
    let step_rad = level.step_deg.to_radians();
    let lattice = lattice(level, &stops, sight.footprint);
    let [start_place, goal_place] = stops.map(|stop| lattice.nearest(&stop.at).place);
    let bounds = Bounds::around(&lattice, sight.footprint, [start_place, goal_place], lattice.spacing_m());
    let Some(bounds) = bounds else { return Trial::Hopeless };
    let narrow = sight.narrow();
    // The other way round first, for a little while: mostly it is the goal that is enclosed, if one end is.
    let back = Bounds::straight(&lattice, start_place);
    let mut outcome = Search::new(sight, &lattice, &back, step_rad, [goal, start]).below(below_m).run(FROM_GOAL, looks);
    if let Outcome::Found(way) = &mut outcome {
        way.reverse();
    }
    if outcome == Outcome::Stopped {
        outcome = Search::new(sight, &lattice, &bounds, step_rad, stops).below(below_m).run(usize::MAX, looks);
    }
    match outcome {
        Outcome::Found(way) => match shorten::shorten(sight, &way) {
            Some(way) => {
                let poses = refined(way, stops, sight, looks).poses();
                let open_m = |pair: &[[f64; 3]]| match pair {
                    [a, b] => sight.open_cost_m(a, b),
                    _ => 0.0,
                };
                let open_cost_m = poses.windows(2).map(open_m).sum();
                Trial::Found(FoundPath { poses, open_cost_m })
            }
            None => Trial::Hope,
        },
        Outcome::Enclosed if sight.narrow() == narrow => Trial::Hopeless,
        Outcome::Enclosed | Outcome::Stopped => Trial::Hope,
    }
}

/// The way, or a cheaper one along a lattice that is finer the shorter the way is, where there may be one.
fn refined(way: PricedPath, stops: [Stop; 2], sight: &mut Sight<'_>, looks: usize) -> PricedPath {
    let [start, goal] = stops.map(|stop| stop.at);
    let cost_m = way.cost_m();
    if cost_m <= STRAIGHT_ENOUGH * sight.open_cost_m(&start, &goal) {
        return way;
    }
    // What is cheaper lies in the ellipse around both ends, thus in a circle about the middle.
    let turn_m = sight.terms.turn_m * turn(start[2], goal[2]).abs();
    let radius_m = 0.5 * (cost_m - turn_m);
    let spacing_m = 2.0 * radius_m / ROWS;
    if spacing_m > FINER.spacing_m {
        return way;
    }
    let [from, to] = [start, goal].map(|at| Vector2::new(at[0], at[1]));
    let middle = 0.5 * (from + to);
    let position = sight.footprint.bounds().position();
    let low = (middle - Vector2::repeat(radius_m)).sup(&Vector2::from(*position.lower()));
    let high = (middle + Vector2::repeat(radius_m)).inf(&Vector2::from(*position.upper()));
    let step_rad = FINER.step_deg.to_radians();
    let lattice = Lattice::new(&from, [low, high], [start[2], goal[2]], spacing_m.max(LEAST_SPACING_M), step_rad);
    let bounds = Bounds::straight(&lattice, lattice.nearest(&goal).place);
    let looks = looks.min(sight.footprint.looks() + MORE_LOOKS);
    let found = Search::new(sight, &lattice, &bounds, step_rad, stops).below(cost_m).run(usize::MAX, looks);
    let finer = match found {
        // Neither shall less turning be bought with a longer way.
        Outcome::Found(finer) => shorten::shorten(sight, &finer)
            .filter(|finer| finer.cost_m() < cost_m && finer.length_m() <= way.length_m()),
        _ => None,
    };
    finer.unwrap_or(way)
}

/// Rows in which the robot can go around all obstacles, within its bounds.
fn lattice(level: Level, stops: &[Stop; 2], footprint: &Footprint) -> Lattice {
    let step_rad = level.step_deg.to_radians();
    let [start, goal] = stops.map(|stop| Vector2::new(stop.at[0], stop.at[1]));
    let beside = Vector2::repeat(2.0 * footprint.reach_m() + sight::FAR_M);
    let (mut low, mut high) = (start.inf(&goal), start.sup(&goal));
    if let Some([from, to]) = footprint.extent() {
        (low, high) = (low.inf(&(from - beside)), high.sup(&(to + beside)));
    }
    let position = footprint.bounds().position();
    low = low.sup(&Vector2::from(*position.lower()));
    high = high.inf(&Vector2::from(*position.upper()));
    let yaws = std::f64::consts::TAU / step_rad + 2.0;
    let area_m2 = (high.x - low.x) * (high.y - low.y);
    let spacing_m = level.spacing_m.max((area_m2 * yaws / CELLS).sqrt());
    Lattice::new(&start, [low, high], stops.map(|stop| stop.at[2]), spacing_m, step_rad)
}
