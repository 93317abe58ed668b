//! Which pairs of a robot's links need a collision check, found out by sampling: for a robot that comes without a list.
//!
//! Every pair of links with shapes gets a [`PairFate`], with the reason. Configurations are drawn uniformly within the soft
//! limits from the caller's generator, so the same seed gives the same answer.

use std::f64::consts::PI;

use darrt_geom::{Body, BodyIndex, CollisionModel, GeomError};
use nalgebra::Isometry3;
use rand::{Rng, RngExt};

use super::limit::JointLimit;
use super::tree::{KinematicTree, KinematicsError, LinkMotion, expect_length};

/// Configurations that [`sample_pairs`] should be given for a robot of a size as they are usual.
pub const USUAL_SAMPLES: usize = 10_000;
/// Where a sliding joint without limits is sampled: so many metres to either side of zero.
const SLIDE_M: f64 = 1.0;

/// What is known of a pair of links.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairFate {
    /// No joint moves them against each other.
    Rigid,
    /// Joints connect them, with nothing between them that has a shape.
    Adjacent,
    /// They were too near each other in all samples, so that no check can help.
    Always,
    /// They were in none.
    Never,
    /// They were in some: the pair must be checked.
    Sometimes {
        /// In how many.
        hits: usize,
    },
}

impl PairFate {
    /// Must the pair be checked?
    pub fn is_checked(self) -> bool {
        matches!(self, Self::Sometimes { .. })
    }
}

/// A pair of links with shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SampledPair {
    /// The first link, an index into the links of the tree.
    pub first: usize,
    /// The second, greater than the first.
    pub second: usize,
    /// What was found.
    pub fate: PairFate,
}

/// All pairs of links with shapes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SampledPairs {
    /// Configurations that were looked at.
    pub samples: usize,
    /// The pairs, ordered by their links.
    pub pairs: Vec<SampledPair>,
}

impl SampledPairs {
    /// The pairs that must be checked.
    pub fn checked(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.pairs.iter().filter(|pair| pair.fate.is_checked()).map(|pair| (pair.first, pair.second))
    }

    /// The fate of a pair, in words.
    pub fn reason(&self, fate: PairFate) -> String {
        let samples = self.samples;
        match fate {
            PairFate::Rigid => "rigid: no joint moves them against each other".to_owned(),
            PairFate::Adjacent => "adjacent: joints connect them, and no shape stands between".to_owned(),
            PairFate::Always => format!("always: too near each other in all of {samples} samples"),
            PairFate::Never => format!("never: not near each other in {samples} samples"),
            PairFate::Sometimes { hits } => format!("checked: too near each other in {hits} of {samples} samples"),
        }
    }
}

/// Why pairs could not be sampled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PairSamplingError {
    /// There are not as many bodies as links.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// A body is unfit, or there are too many.
    #[error(transparent)]
    Geometry(#[from] GeomError),
    /// Nothing can be said from no sample.
    #[error("pairs of links are sampled with {samples} configurations; at least 1 is needed")]
    NoSample {
        /// How many were asked for.
        samples: usize,
    },
}

/// Samples the pairs of all links with shapes.
///
/// `bodies`: the shape of every link of `tree`, from [`link_bodies`](super::link_bodies). `held`: variables that stand at a value,
/// for they do not move while the robot is planned with. `clearance_m`: nearer than this is too
/// near; touching always is. A pair that is too near in more than `3 / samples` of all configurations is called
/// [`PairFate::Never`] with a probability of less than 5 % (rule of three).
///
/// # Errors
/// As [`PairSamplingError`] says.
pub fn sample_pairs(
    tree: &KinematicTree,
    bodies: &[Option<Body>],
    held: &[(usize, f64)],
    (clearance_m, samples): (f64, usize),
    rng: &mut dyn Rng,
) -> Result<SampledPairs, PairSamplingError> {
    expect_length("bodies", bodies.len(), tree.link_count())?;
    if samples == 0 {
        return Err(PairSamplingError::NoSample { samples });
    }
    let mut builder = CollisionModel::builder();
    let mut shaped: Vec<(usize, BodyIndex)> = Vec::new();
    for (link, body) in bodies.iter().enumerate() {
        if let Some(body) = body {
            shaped.push((link, builder.add_moving(body)?));
        }
    }
    let model = builder.build();
    let (mut pairs, mut counted) = (Vec::new(), Vec::new());
    for (at, &(first, a)) in shaped.iter().enumerate() {
        for &(second, b) in shaped.iter().skip(at + 1) {
            let fate = fixed_fate(tree, bodies, first, second);
            if fate.is_none() {
                counted.push(Counted { pair: pairs.len(), bodies: (a, b), hits: 0 });
            }
            pairs.push(SampledPair { first, second, fate: fate.unwrap_or(PairFate::Never) });
        }
    }
    let mut ranges = ranges(tree);
    for (variable, value) in held {
        if let Some(range) = ranges.get_mut(*variable) {
            *range = (*value, *value);
        }
    }
    count(tree, (&model, &ranges), &shaped, (clearance_m, samples), rng, &mut counted)?;
    for Counted { pair, hits, .. } in counted {
        if let Some(pair) = pairs.get_mut(pair) {
            pair.fate = match hits {
                0 => PairFate::Never,
                hits if hits == samples => PairFate::Always,
                hits => PairFate::Sometimes { hits },
            };
        }
    }
    Ok(SampledPairs { samples, pairs })
}

/// A pair that sampling decides about.
struct Counted {
    /// Its place among all pairs.
    pair: usize,
    bodies: (BodyIndex, BodyIndex),
    /// Samples in which it was too near.
    hits: usize,
}

/// Counts the samples in which the pairs are too near.
fn count(
    tree: &KinematicTree,
    (model, ranges): (&CollisionModel, &[(f64, f64)]),
    shaped: &[(usize, BodyIndex)],
    (clearance_m, samples): (f64, usize),
    rng: &mut dyn Rng,
    counted: &mut [Counted],
) -> Result<(), KinematicsError> {
    // Balls around the bodies settle most pairs.
    let balls: Vec<_> = shaped.iter().map(|&(_, body)| model.ball(body)).collect();
    let mut scratch = model.scratch();
    let mut poses = vec![Isometry3::identity(); tree.link_count()];
    let mut values = vec![0.0; ranges.len()];
    let mut centres = vec![None; shaped.len()];
    // Touching, as the collision model means it.
    let too_near = clearance_m.max(1e-7);
    for _ in 0..samples {
        for (value, (lower, upper)) in values.iter_mut().zip(ranges) {
            *value = rng.random_range(*lower..=*upper);
        }
        tree.forward(&values, &Isometry3::identity(), &mut poses)?;
        for (((link, body), ball), centre) in shaped.iter().zip(&balls).zip(&mut centres) {
            let Some(pose) = poses.get(*link) else { continue };
            model.set_pose(&mut scratch, *body, pose);
            *centre = ball.map(|(centre, radius)| (pose * centre, radius));
        }
        for pair in counted.iter_mut() {
            let (a, b) = pair.bodies;
            let ball = |body: BodyIndex| centres.get(body.get()).copied().flatten();
            let is_far = match (ball(a), ball(b)) {
                (Some((p, r)), Some((q, s))) => nalgebra::distance(&p, &q) - r - s > too_near,
                _ => false,
            };
            if !is_far && model.distance_between(&scratch, a, b, too_near) < too_near {
                pair.hits += 1;
            }
        }
    }
    Ok(())
}

/// Where the variables are sampled.
fn ranges(tree: &KinematicTree) -> Vec<(f64, f64)> {
    let is_sliding = |variable: usize| {
        let link = tree.variables().get(variable).map(|v| v.link);
        matches!(link.and_then(|link| tree.motion(link)), Some(LinkMotion::Sliding { .. }))
    };
    let variables = tree.variables().iter().enumerate();
    variables
        .map(|(index, variable)| range(&variable.soft_limit, if is_sliding(index) { SLIDE_M } else { PI }))
        .collect()
}

/// What is known of two links without a sample.
fn fixed_fate(tree: &KinematicTree, bodies: &[Option<Body>], first: usize, second: usize) -> Option<PairFate> {
    // From either link up to where both ways meet: the joints passed that move, and the links between that have a shape.
    let (mut a, mut b) = (first, second);
    let (mut moving, mut between) = (0_usize, 0_usize);
    while a != b {
        // A parent stands before its children, so the later one is not above the other.
        let lower = if a > b { &mut a } else { &mut b };
        moving += usize::from(!matches!(tree.motion(*lower), Some(LinkMotion::Fixed) | None));
        *lower = tree.parent(*lower)?;
        let is_end = *lower == first || *lower == second;
        between += usize::from(!is_end && bodies.get(*lower).is_some_and(Option::is_some));
    }
    match (moving, between) {
        (0, _) => Some(PairFate::Rigid),
        (_, 0) => Some(PairFate::Adjacent),
        _ => None,
    }
}

/// Where a joint is sampled; `reach` stands in for an infinite end.
fn range(limit: &JointLimit, reach: f64) -> (f64, f64) {
    match (limit.lower.is_finite(), limit.upper.is_finite()) {
        (true, true) => (limit.lower, limit.upper),
        (true, false) => (limit.lower, limit.lower + 2.0 * reach),
        (false, true) => (limit.upper - 2.0 * reach, limit.upper),
        (false, false) => (-reach, reach),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::{RobotDescription, link_bodies, no_meshes};
    use rand::SeedableRng;
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// A column with a plate screwed to it, an arm that folds onto the column, and two lamps: one that never moves away from
    /// the column's plate, one far up.
    const ROBOT: &str = "<robot name='r'>
        <link name='column'><collision><origin xyz='0 0 0.5'/><geometry><box size='0.2 0.2 1'/></geometry></collision></link>
        <link name='plate'><collision><geometry><box size='0.4 0.4 0.1'/></geometry></collision></link>
        <link name='shoulder'/>
        <link name='upper'><collision><origin xyz='0.2 0 0'/><geometry><box size='0.4 0.1 0.1'/></geometry></collision></link>
        <link name='lower'><collision><origin xyz='0.2 0 0'/><geometry><box size='0.4 0.1 0.1'/></geometry></collision></link>
        <link name='sunk'><collision><geometry><sphere radius='0.3'/></geometry></collision></link>
        <link name='lamp'><collision><geometry><sphere radius='0.05'/></geometry></collision></link>
        <joint name='screws' type='fixed'><parent link='column'/><child link='plate'/></joint>
        <joint name='turn' type='continuous'><parent link='column'/><child link='shoulder'/>
            <origin xyz='0.2 0 0.8'/><axis xyz='0 0 1'/></joint>
        <joint name='mount' type='fixed'><parent link='shoulder'/><child link='upper'/></joint>
        <joint name='bend' type='continuous'><parent link='upper'/><child link='lower'/>
            <origin xyz='0.42 0 0'/><axis xyz='0 0 1'/></joint>
        <joint name='high' type='fixed'><parent link='plate'/><child link='lamp'/><origin xyz='0 0 4'/></joint>
        <joint name='swing' type='revolute'><parent link='lamp'/><child link='sunk'/>
            <origin xyz='0 0 -4'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' velocity='1' effort='1'/></joint>
        </robot>";

    fn sampled(samples: usize, seed: u64) -> (KinematicTree, SampledPairs) {
        let robot = RobotDescription::from_text(ROBOT).unwrap();
        let tree = KinematicTree::new(&robot).unwrap();
        let bodies = link_bodies(&robot, &tree, &no_meshes).unwrap();
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let found = sample_pairs(&tree, &bodies, &[], (0.0, samples), &mut rng).unwrap();
        (tree, found)
    }

    #[test]
    fn every_pair_has_its_reason() {
        let (tree, found) = sampled(2000, 1);
        let link = |name: &str| tree.link_index(name).unwrap();
        let fate = |a: &str, b: &str| {
            let (a, b) = (link(a).min(link(b)), link(a).max(link(b)));
            found.pairs.iter().find(|pair| (pair.first, pair.second) == (a, b)).unwrap().fate
        };
        assert_eq!(found.pairs.len(), 15);
        assert_eq!(fate("column", "plate"), PairFate::Rigid);
        assert_eq!(fate("column", "lamp"), PairFate::Rigid);
        // Through the shoulder, which has no shape.
        assert_eq!(fate("column", "upper"), PairFate::Adjacent);
        assert_eq!(fate("upper", "lower"), PairFate::Adjacent);
        assert_eq!(fate("column", "sunk"), PairFate::Always);
        assert_eq!(fate("lower", "lamp"), PairFate::Never);
        // The lower arm reaches the column when both joints are folded: in some of the samples.
        let PairFate::Sometimes { hits } = fate("column", "lower") else { panic!("{:?}", fate("column", "lower")) };
        assert!((20..1000).contains(&hits), "{hits}");
        assert_eq!(found.checked().collect::<Vec<_>>(), [(link("column"), link("lower"))]);
        let said = found.reason(fate("lower", "lamp"));
        assert_eq!(said, "never: not near each other in 2000 samples");
    }

    #[test]
    fn a_joint_that_is_held_does_not_move() {
        let robot = RobotDescription::from_text(ROBOT).unwrap();
        let tree = KinematicTree::new(&robot).unwrap();
        let bodies = link_bodies(&robot, &tree, &no_meshes).unwrap();
        // Stretched out, the lower arm never reaches the column.
        let held = [(tree.variable_index("bend").unwrap(), 0.0)];
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
        let found = sample_pairs(&tree, &bodies, &held, (0.0, 500), &mut rng).unwrap();
        assert_eq!(found.checked().count(), 0);
    }

    #[test]
    fn the_same_seed_gives_the_same_pairs_and_no_sample_none() {
        assert_eq!(sampled(300, 5).1, sampled(300, 5).1);
        let robot = RobotDescription::from_text(ROBOT).unwrap();
        let tree = KinematicTree::new(&robot).unwrap();
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(0);
        let bodies = vec![None; tree.link_count()];
        assert_eq!(
            sample_pairs(&tree, &bodies, &[], (0.0, 0), &mut rng),
            Err(PairSamplingError::NoSample { samples: 0 })
        );
        assert!(sample_pairs(&tree, &bodies[1..], &[], (0.0, 1), &mut rng).is_err());
        assert!(sample_pairs(&tree, &bodies, &[], (0.0, 1), &mut rng).unwrap().pairs.is_empty());
    }
}
