//! What the paper says about its problems, checked on the embedded files with plain disc geometry.
//!
//! The model: the pushed plate is a disc with 10 mm of clearance, the hand a rectangle 0.05 m deep and 0.19 m wide behind
//! it, both must miss every box on the table and the plate's centre must keep its distance from every edge. Pushes are
//! straight; a push is useful when it ends with the centre 0.03 to 0.10 m inside an edge, where the rim can be grasped.
//! The counts hold for this model at the resolutions given here.
//!
//! Sources: sections 5.2 and 6.1 of the paper.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops at the first surprise")]

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use darrt_pr2::problems::builtin;
use darrt_task::problem_file::{ProblemFile, ShapeSpec};
use nalgebra::{Point2, Vector2};

/// Free space around the disc (m).
const CLEARANCE: f64 = 0.01;
/// Half depth and half width of the hand (m).
const HAND: [f64; 2] = [0.025, 0.095];
/// Distance of the centre inside the edge (m) at which the rim can be grasped.
const GRASPABLE: [f64; 2] = [0.03, 0.10];
/// Slack for distances that meet a bound exactly (m).
const ROUNDING: f64 = 1e-9;

/// A side of the central table as seen by the robot at its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Side {
    Near,
    Far,
    Left,
    Right,
}

/// An upright box on the table: centre and half size.
struct Obstacle {
    centre: Point2<f64>,
    half: Vector2<f64>,
}

/// The top of the central table, what stands on it, and the plate.
struct Tabletop {
    low: Point2<f64>,
    high: Point2<f64>,
    obstacles: Vec<Obstacle>,
    start: Point2<f64>,
    radius: f64,
}

impl Tabletop {
    fn of(problem: &ProblemFile) -> Self {
        let geometry = problem.geometry().unwrap();
        let (low, high) = geometry.scene.surface("central table").unwrap().bounds();
        let obstacles = problem
            .obstacles
            .iter()
            .filter(|obstacle| obstacle.standing_on.as_deref() == Some("central table"))
            .map(|obstacle| match &obstacle.shape {
                ShapeSpec::Box { size } => Obstacle {
                    centre: Point2::new(obstacle.at[0], obstacle.at[1]),
                    half: Vector2::new(size[0], size[1]) / 2.0,
                },
                other => panic!("`{}` is a {}, not a box", obstacle.name, other.kind()),
            })
            .collect();
        let plate = &problem.objects[0];
        Self { low, high, obstacles, start: Point2::from(plate.at), radius: plate.shape.round_radius().unwrap() }
    }

    /// Distance of a point inside each edge.
    fn edge_distances(&self, p: &Point2<f64>) -> [(Side, f64); 4] {
        [
            (Side::Near, p.x - self.low.x),
            (Side::Far, self.high.x - p.x),
            (Side::Left, self.high.y - p.y),
            (Side::Right, p.y - self.low.y),
        ]
    }

    /// The edges at which the plate can be grasped; `None` when it lies too near to one.
    fn graspable_at(&self, p: &Point2<f64>) -> Option<Vec<Side>> {
        let distances = self.edge_distances(p);
        let [least, most] = GRASPABLE;
        if distances.iter().any(|(_, distance)| *distance < least - ROUNDING) {
            return None;
        }
        Some(distances.iter().filter(|(_, d)| *d <= most + ROUNDING).map(|(side, _)| *side).collect())
    }

    /// Neither the disc at `p` nor the hand behind it touches a box.
    fn is_free(&self, p: &Point2<f64>, heading: &Vector2<f64>) -> bool {
        let hand = p - heading * (self.radius + HAND[0]);
        self.obstacles
            .iter()
            .all(|obstacle| !obstacle.meets_disc(p, self.radius + CLEARANCE) && !obstacle.meets_hand(&hand, heading))
    }

    /// The places that the plate passes while it is pushed from `from`, every `step` metres, until something is in the way.
    fn push(&self, from: Point2<f64>, heading: Vector2<f64>, step: f64) -> impl Iterator<Item = Point2<f64>> + '_ {
        let place = move |count: u32| from + heading * (f64::from(count) * step);
        let possible = move |p: &Point2<f64>| self.graspable_at(p).is_some() && self.is_free(p, &heading);
        let begins = possible(&from);
        (1..).map(place).take_while(move |p| begins && possible(p))
    }

    /// The sides that one push reaches, with the headings (degrees) that do it, 72 headings in steps of 2 cm.
    fn single_pushes(&self) -> BTreeMap<Side, BTreeSet<u32>> {
        let mut reached: BTreeMap<Side, BTreeSet<u32>> = BTreeMap::new();
        for degrees in (0..360).step_by(5) {
            for p in self.push(self.start, heading(degrees), 0.02) {
                for side in self.graspable_at(&p).into_iter().flatten() {
                    reached.entry(side).or_default().insert(degrees);
                }
            }
        }
        reached
    }

    /// The fewest pushes to each side, up to `most`: breadth first, 24 headings, steps of 5 cm, one visit per 1 cm cell.
    fn fewest_pushes(&self, most: u32) -> BTreeMap<Side, u32> {
        let mut fewest = BTreeMap::new();
        let mut seen = BTreeSet::new();
        let mut level = vec![self.start];
        for count in 1..=most {
            let mut next = Vec::new();
            for from in level {
                for degrees in (0..360).step_by(15) {
                    for p in self.push(from, heading(degrees), 0.05) {
                        for side in self.graspable_at(&p).into_iter().flatten() {
                            fewest.entry(side).or_insert(count);
                        }
                        if seen.insert(cell(&p)) {
                            next.push(p);
                        }
                    }
                }
            }
            level = next;
        }
        fewest
    }
}

impl Obstacle {
    fn meets_disc(&self, p: &Point2<f64>, radius: f64) -> bool {
        let outside = ((p - self.centre).abs() - self.half).sup(&Vector2::zeros());
        outside.norm() < radius
    }

    /// Separating axes of the box and of the hand's rectangle, whose depth is along `heading`.
    fn meets_hand(&self, hand: &Point2<f64>, heading: &Vector2<f64>) -> bool {
        let across = Vector2::new(-heading.y, heading.x);
        let between = self.centre - hand;
        let reach = |axis: &Vector2<f64>| {
            self.half.dot(&axis.abs()) + HAND[0] * heading.dot(axis).abs() + HAND[1] * across.dot(axis).abs()
        };
        [Vector2::x(), Vector2::y(), *heading, across].iter().all(|axis| between.dot(axis).abs() <= reach(axis))
    }
}

fn heading(degrees: u32) -> Vector2<f64> {
    let angle = f64::from(degrees) / 360.0 * TAU;
    Vector2::new(angle.cos(), angle.sin())
}

/// The 1 cm cell of a place.
#[allow(clippy::cast_possible_truncation, reason = "places on a table are a few hundred cells from the origin")]
fn cell(p: &Point2<f64>) -> (i64, i64) {
    ((p.x * 100.0).round() as i64, (p.y * 100.0).round() as i64)
}

fn tabletop(name: &str) -> Tabletop {
    Tabletop::of(&builtin(name).unwrap())
}

fn degrees(range: impl IntoIterator<Item = u32>) -> BTreeSet<u32> {
    range.into_iter().collect()
}

/// "The plate can be moved to the edge of the table in a straight line parallel to the robot's torso."
#[test]
fn plate1_single_pushes_reach_only_the_right_edge() {
    let table = tabletop("plate1");
    let reached = table.single_pushes();
    assert_eq!(reached, BTreeMap::from([(Side::Right, degrees([270, 275]))]));
    // Straight to the right, that is parallel to the torso of a robot that faces +x, and at least 0.56 m long.
    let first = table.push(table.start, heading(270), 0.02).find(|p| !table.graspable_at(p).unwrap().is_empty());
    assert!((first.unwrap() - table.start).norm() > 0.56 - 1e-9);
    assert_eq!(builtin("plate1").unwrap().robot.base[2], 0.0);
}

#[test]
fn plate1_other_edges_take_more_pushes() {
    let fewest = tabletop("plate1").fewest_pushes(3);
    let expected = [(Side::Near, 2), (Side::Far, 2), (Side::Left, 3), (Side::Right, 1)];
    assert_eq!(fewest, BTreeMap::from(expected));
}

/// "It is possible to move the plate to the edge of the table by pushing the plate back towards the robot using a single
/// push or to the left edge of the table using a minimum of two pushes to move the plate around the small bowl."
#[test]
fn plate2_takes_one_push_toward_the_robot_or_two_to_the_left() {
    let table = tabletop("plate2");
    assert_eq!(table.single_pushes(), BTreeMap::from([(Side::Near, degrees((135..=195).step_by(5)))]));
    let fewest = table.fewest_pushes(3);
    assert_eq!(fewest, BTreeMap::from([(Side::Near, 1), (Side::Left, 2), (Side::Far, 3)]));
}

/// "It is not possible to find an arm trajectory that can push the plate towards the robot without first moving the
/// robot's base": the fingers must be behind the plate, farther from the shoulder than the arm is long.
#[test]
fn plate2_near_push_is_out_of_reach_from_the_start() {
    /// The pan axis of the right shoulder in the frame of the base, and the arm's length to the tool (m).
    const SHOULDER: [f64; 2] = [-0.05, -0.188];
    const REACH: f64 = 1.001;
    /// Half the width of a fingertip (m).
    const HALF_TIP: f64 = 0.0112;
    let problem = builtin("plate2").unwrap();
    let table = Tabletop::of(&problem);
    let [x, y, yaw] = problem.robot.base;
    assert_eq!(yaw, 0.0);
    let shoulder = Point2::new(x + SHOULDER[0], y + SHOULDER[1]);
    let half_gap = problem.push.gap_m / 2.0;
    let behind = (table.radius.powi(2) - half_gap.powi(2)).sqrt() + HALF_TIP;
    assert!((behind - 0.1441).abs() < 1e-4);
    for degrees in (135..=195).step_by(5) {
        let tool = table.start - heading(degrees) * behind;
        let distance = (tool - shoulder).norm();
        assert!((1.115..1.175).contains(&distance) && distance > REACH, "{degrees}: {distance}");
    }
}

/// "We removed all possible straight line paths to the edge of the table, forcing the planner to plan at least two pushes."
#[test]
fn plate3_has_no_single_push_and_two_to_the_left_suffice() {
    for name in ["plate3", "plate3-no-place"] {
        let table = tabletop(name);
        assert_eq!(table.single_pushes(), BTreeMap::new(), "{name}: none of 72 headings");
        let fewest = table.fewest_pushes(3);
        assert_eq!(fewest, BTreeMap::from([(Side::Near, 3), (Side::Far, 3), (Side::Left, 2)]));
    }
}

/// The two pushes around the small bowl, in Plate2 and in Plate3.
#[test]
fn the_way_around_the_small_bowl_is_free() {
    for name in ["plate2", "plate3"] {
        let table = tabletop(name);
        let aside = table.push(table.start, heading(135), 0.01).nth(15).unwrap();
        assert!((aside - Point2::new(-0.143, -0.007)).norm() < 1e-3);
        let left = table.push(aside, heading(90), 0.01).nth(51).unwrap();
        assert_eq!(table.graspable_at(&left), Some(vec![Side::Left]), "{name}");
    }
}

#[test]
fn plate3_mugs_leave_no_gap_for_the_plate() {
    let table = tabletop("plate3");
    let mut mugs: Vec<_> = table.obstacles.iter().filter(|o| (o.centre.x + 0.40).abs() < 1e-9).collect();
    mugs.sort_by(|a, b| a.centre.y.total_cmp(&b.centre.y));
    assert_eq!(mugs.len(), 3);
    for pair in mugs.windows(2) {
        let gap = pair[1].centre.y - pair[0].centre.y - pair[0].half.y - pair[1].half.y;
        assert!((gap - 0.12).abs() < 1e-9 && gap < 2.0 * table.radius);
    }
}

/// "A simple world in which there are no obstacles on the table": every heading ends at an edge, and every edge is reached.
#[test]
fn simple_plate_can_be_pushed_in_all_directions() {
    let table = tabletop("simple-plate");
    let reached = table.single_pushes();
    let headings: BTreeSet<u32> = reached.values().flatten().copied().collect();
    assert_eq!(headings.len(), 72);
    let count = |side| reached[&side].len();
    assert_eq!((count(Side::Near), count(Side::Far)), (30, 18));
    assert!(count(Side::Left) >= 14 && count(Side::Right) >= 13);
}

/// "The central table where the pickup happens is one under which the robot can move its base whereas the table for the
/// place has a solid base."
#[test]
fn the_base_fits_under_the_central_table_only() {
    /// Width of the base and height of its deck (m).
    const BASE_WIDTH: f64 = 0.668;
    const DECK: f64 = 0.301;
    for name in ["plate1", "plate2", "plate3", "bowl"] {
        let problem = builtin(name).unwrap();
        let inner = |leg: &str| {
            let leg = problem.obstacle(leg).unwrap();
            match &leg.shape {
                ShapeSpec::Box { size } => leg.at[1].abs() - size[1] / 2.0,
                other => panic!("{}", other.kind()),
            }
        };
        let between_legs = inner("leg near right") + inner("leg near left");
        assert!((between_legs - 1.05).abs() < 1e-9 && between_legs > BASE_WIDTH);
        let underside = |name: &str| {
            let obstacle = problem.obstacle(name).unwrap();
            obstacle.at[2] - obstacle.shape.depth_below_origin().unwrap()
        };
        assert!((underside("central table top") - 0.71).abs() < 1e-9 && underside("central table top") > DECK);
        assert!(underside("side table").abs() < 1e-9, "solid down to the floor");
    }
}
