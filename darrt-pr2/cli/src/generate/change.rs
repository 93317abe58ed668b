//! One random change of a problem: sizes, places, heights, start and goal.

use rand::{Rng, RngExt};

use darrt_task::problem_file::{Obstacle, ProblemFile, ShapeSpec};

/// How far what stands on a table is moved, in x and in y, m.
const CLUTTER_SHIFT: f64 = 0.08;
/// Factors of its size.
const CLUTTER_SCALE: [f64; 2] = [0.8, 1.2];
/// Share of what stands on tables that is taken away.
const CLUTTER_GONE: f64 = 0.15;
/// Most things that are put on the first table on which something stands.
const CLUTTER_NEW: usize = 2;
/// Footprint of what is put there, m.
const NEW_WIDTH: [f64; 2] = [0.06, 0.16];
/// Height of what is put there, m.
const NEW_HEIGHT: [f64; 2] = [0.06, 0.20];
/// How much tables are raised, m.
const TABLE_RISE: [f64; 2] = [-0.04, 0.06];
/// Factors of the size of round objects.
const OBJECT_SCALE: [f64; 2] = [0.88, 1.08];
/// How far objects are moved at the start, in x and in y, m.
const OBJECT_SHIFT: f64 = 0.08;
/// How far goals are moved, in x and in y, m.
const GOAL_SHIFT: f64 = 0.05;
/// How far goals in the air are moved up or down, m.
const GOAL_RISE: f64 = 0.05;
/// How far the robot is moved, in x and in y, m.
const BASE_SHIFT: f64 = 0.15;
/// How far the robot is turned, rad.
const BASE_TURN: f64 = 0.3;
/// Surfaces that touch within this belong together, m.
const TOUCH: f64 = 1e-6;

/// A problem like `base`. It may be invalid: start and goal are placed without looking. Lengths are whole millimetres.
pub fn changed(base: &ProblemFile, rng: &mut dyn Rng) -> ProblemFile {
    let mut problem = base.clone();
    raise_tables(&mut problem, rng);
    change_clutter(&mut problem, rng);
    for object in &mut problem.objects {
        let scale = within(OBJECT_SCALE, rng);
        resize(&mut object.shape, scale);
        shift(&mut object.at, OBJECT_SHIFT, rng);
    }
    for goal in &mut problem.goal.objects {
        if let Some(at) = &mut goal.at {
            shift(at, GOAL_SHIFT, rng);
        }
        if let Some([x, y, z]) = &mut goal.position {
            for (value, size) in [(x, GOAL_SHIFT), (y, GOAL_SHIFT), (z, GOAL_RISE)] {
                *value = rounded(*value + within([-size, size], rng));
            }
        }
    }
    let [x, y, yaw] = &mut problem.robot.base;
    for (value, size) in [(x, BASE_SHIFT), (y, BASE_SHIFT), (yaw, BASE_TURN)] {
        *value = rounded(*value + within([-size, size], rng));
    }
    problem
}

/// Raises or lowers every box that carries a surface: a solid one grows from the floor, the legs of one that stands on legs
/// grow with it.
fn raise_tables(problem: &mut ProblemFile, rng: &mut dyn Rng) {
    let tops: Vec<String> = problem.surfaces.iter().filter_map(|surface| surface.top_of.clone()).collect();
    for name in tops {
        let rise = rounded(within(TABLE_RISE, rng));
        let Some(table) = problem.obstacles.iter_mut().find(|obstacle| obstacle.name == name) else { continue };
        let Some((bottom, _)) = extent(table) else { continue };
        if bottom.abs() < TOUCH {
            grow(table, rise);
            continue;
        }
        if let Some(z) = table.at.get_mut(2) {
            *z = rounded(*z + rise);
        }
        let carries = |leg: &&mut Obstacle| {
            extent(leg).is_some_and(|(low, high)| low.abs() < TOUCH && (high - bottom).abs() < TOUCH)
        };
        for leg in problem.obstacles.iter_mut().filter(carries) {
            grow(leg, rise);
        }
    }
}

/// Lowest and highest point of an upright box that is given by its centre, m.
fn extent(obstacle: &Obstacle) -> Option<(f64, f64)> {
    let (ShapeSpec::Box { size: [_, _, height] }, Some(z)) = (&obstacle.shape, obstacle.at.get(2)) else { return None };
    let is_upright = obstacle.rpy.is_none() && obstacle.quaternion.is_none();
    is_upright.then_some((z - height / 2.0, z + height / 2.0))
}

/// Makes a box higher; its bottom stays.
fn grow(obstacle: &mut Obstacle, rise: f64) {
    if let (ShapeSpec::Box { size: [_, _, height] }, Some(z)) = (&mut obstacle.shape, obstacle.at.get_mut(2)) {
        *height = rounded(*height + rise);
        // Half a millimetre is kept: rounded, the bottom would not stay.
        *z = *height / 2.0;
    }
}

/// Moves, resizes, takes away and adds what stands on tables. Nothing hangs over an edge that did not, and what would
/// stand in something else is taken away.
fn change_clutter(problem: &mut ProblemFile, rng: &mut dyn Rng) {
    let Some(table) = problem.obstacles.iter().find_map(|obstacle| obstacle.standing_on.clone()) else {
        // An empty table is what the problem is about.
        return;
    };
    let mut kept: Vec<Obstacle> = Vec::new();
    for mut obstacle in problem.obstacles.clone() {
        let Some(surface) = obstacle.standing_on.clone() else {
            kept.push(obstacle);
            continue;
        };
        // Drawn in any case, so that one decision does not change the numbers of the next.
        let (is_gone, scale) = (rng.random_bool(CLUTTER_GONE), within(CLUTTER_SCALE, rng));
        resize(&mut obstacle.shape, scale);
        for value in obstacle.at.iter_mut().take(2) {
            *value = rounded(*value + within([-CLUTTER_SHIFT, CLUTTER_SHIFT], rng));
        }
        if let Some(top) = top(problem, &surface) {
            move_inside(&mut obstacle, top);
        }
        if !is_gone && is_free(&obstacle, &kept) {
            kept.push(obstacle);
        }
    }
    for number in 1..=rng.random_range(0..=CLUTTER_NEW) {
        let [x, y] = [0, 1].map(|_| within(NEW_WIDTH, rng));
        let height = within(NEW_HEIGHT, rng);
        let place = [rng.random::<f64>(), rng.random::<f64>()];
        let Some([low, high]) = top(problem, &table) else { continue };
        let at = low.iter().zip(high).zip(place).map(|((low, high), share)| rounded(low + (high - low) * share));
        let mut thing = Obstacle {
            name: format!("thing {number}"),
            shape: ShapeSpec::Box { size: [x, y, height].map(rounded) },
            at: at.collect(),
            standing_on: Some(table.clone()),
            yaw: None,
            rpy: None,
            quaternion: None,
        };
        move_inside(&mut thing, [low, high]);
        if is_free(&thing, &kept) && problem.obstacle(&thing.name).is_none() {
            kept.push(thing);
        }
    }
    problem.obstacles = kept;
}

/// The corners of a surface that is the top of an upright box.
fn top(problem: &ProblemFile, surface: &str) -> Option<[[f64; 2]; 2]> {
    let table = problem.obstacle(problem.surface(surface)?.top_of.as_deref()?)?;
    extent(table)?;
    footprint(table)
}

/// The corners of what a box covers, as seen from above; `None` for what is no box or is turned.
fn footprint(obstacle: &Obstacle) -> Option<[[f64; 2]; 2]> {
    let (ShapeSpec::Box { size: [width, depth, _] }, [x, y, ..]) = (&obstacle.shape, obstacle.at.as_slice()) else {
        return None;
    };
    let is_straight = obstacle.yaw.is_none_or(|yaw| yaw == 0.0);
    is_straight.then_some([[x - width / 2.0, y - depth / 2.0], [x + width / 2.0, y + depth / 2.0]])
}

/// Moves a box that hangs over an edge back onto the table.
fn move_inside(obstacle: &mut Obstacle, [low, high]: [[f64; 2]; 2]) {
    let Some([from, to]) = footprint(obstacle) else { return };
    let edges = low.into_iter().zip(high).zip(from.into_iter().zip(to));
    for (value, ((low, high), (from, to))) in obstacle.at.iter_mut().zip(edges) {
        if to - from < high - low {
            *value = rounded(*value + (low - from).max(0.0) - (to - high).max(0.0));
        }
    }
}

/// Does a box stand apart from all others that stand on the same table?
fn is_free(obstacle: &Obstacle, others: &[Obstacle]) -> bool {
    let Some([low, high]) = footprint(obstacle) else { return true };
    let mut beside = others.iter().filter(|other| other.standing_on == obstacle.standing_on).filter_map(footprint);
    let is_apart = |[from, to]: [[f64; 2]; 2]| {
        low.into_iter().zip(to).any(|(low, to)| low >= to)
            || high.into_iter().zip(from).any(|(high, from)| high <= from)
    };
    beside.all(is_apart)
}

/// Makes a shape larger or smaller. The thickness of plates and of the walls of bowls stays, hulls and meshes stay.
fn resize(shape: &mut ShapeSpec, scale: f64) {
    let sizes: Vec<&mut f64> = match shape {
        ShapeSpec::Box { size } => size.iter_mut().collect(),
        ShapeSpec::Sphere { radius } | ShapeSpec::Cylinder { radius, .. } | ShapeSpec::Plate { radius, .. } => {
            vec![radius]
        }
        ShapeSpec::Capsule { radius, height } | ShapeSpec::Bowl { radius, height, .. } => vec![radius, height],
        ShapeSpec::Hull { .. } | ShapeSpec::Mesh { .. } => Vec::new(),
    };
    for size in sizes {
        *size = rounded(*size * scale);
    }
}

fn shift(at: &mut [f64; 2], size: f64, rng: &mut dyn Rng) {
    for value in at {
        *value = rounded(*value + within([-size, size], rng));
    }
}

fn within([low, high]: [f64; 2], rng: &mut dyn Rng) -> f64 {
    low + (high - low) * rng.random::<f64>()
}

/// To the millimetre (or milliradian), without a negative zero.
fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use darrt_core::random::{Purpose, stream};
    use darrt_pr2::problems::{builtin, builtin_names};

    #[test]
    fn tables_stay_on_their_legs_and_on_the_floor() {
        for name in builtin_names() {
            let base = builtin(name).unwrap();
            for seed in 0..20 {
                let problem = changed(&base, &mut stream(seed, 0, 0, Purpose::Sample));
                let of = |name: &str| extent(problem.obstacle(name).unwrap()).unwrap();
                let (bottom, top) = of("central table top");
                assert!((top - 0.75).abs() <= 0.06 + TOUCH);
                for leg in ["leg near right", "leg far left"] {
                    let (low, high) = of(leg);
                    assert!(low.abs() < TOUCH && (high - bottom).abs() < TOUCH, "{name} {seed}: {low} {high} {bottom}");
                }
                assert!(of("side table").0.abs() < TOUCH);
                assert_eq!(of("wall far"), (0.0, 2.0), "walls stay");
            }
        }
    }

    #[test]
    fn things_stand_whole_on_their_table_and_not_in_each_other() {
        let base = builtin("plate3").unwrap();
        for seed in 0..60 {
            let problem = changed(&base, &mut stream(seed, 0, 0, Purpose::Sample));
            let [low, high] = top(&problem, "central table").unwrap();
            let things: Vec<_> = problem.obstacles.iter().filter(|o| o.standing_on.is_some()).collect();
            for (index, thing) in things.iter().enumerate() {
                let [from, to] = footprint(thing).unwrap();
                for axis in 0..2 {
                    assert!(low[axis] <= from[axis] + 1e-3 && to[axis] <= high[axis] + 1e-3, "{seed}: {}", thing.name);
                }
                for other in &things[..index] {
                    let [a, b] = footprint(other).unwrap();
                    let overlap = |axis: usize| to[axis].min(b[axis]) - from[axis].max(a[axis]);
                    assert!(overlap(0) <= 0.0 || overlap(1) <= 0.0, "{seed}: {} in {}", thing.name, other.name);
                }
            }
        }
    }

    #[test]
    fn everything_that_may_differ_does_and_the_rest_stays() {
        let base = builtin("plate3").unwrap();
        let all: Vec<_> = (0..30).map(|seed| changed(&base, &mut stream(seed, 0, 0, Purpose::Sample))).collect();
        let differs = |what: &dyn Fn(&ProblemFile) -> String| all.iter().filter(|p| what(p) != what(&base)).count();
        assert!(differs(&|p| format!("{:?}", p.objects)) == 30 && differs(&|p| format!("{:?}", p.goal)) == 30);
        assert!(differs(&|p| format!("{:?}", p.robot.base)) == 30);
        let counts: std::collections::BTreeSet<_> = all.iter().map(|p| p.obstacles.len()).collect();
        assert!(counts.len() >= 3, "{counts:?}");
        for kept in
            [&|p: &ProblemFile| format!("{:?}{:?}", p.primitives, p.push), &|p: &ProblemFile| format!("{:?}", p.bounds)]
                as [&dyn Fn(&ProblemFile) -> String; 2]
        {
            assert_eq!(differs(kept), 0);
        }
        let empty = builtin("simple-plate").unwrap();
        let problem = changed(&empty, &mut stream(1, 0, 0, Purpose::Sample));
        assert_eq!(problem.obstacles.len(), empty.obstacles.len(), "an empty table stays empty");
    }
}
