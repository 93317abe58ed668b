//! Putting a puck problem together.

use super::clearance::{Clearance, Obstacle, Outline};
use super::judge::Judge;
use super::world::{Mode, Point, Puck, PuckWorld};
use super::{Carry, Pick, Place, Push, Transit};
use crate::distance::GreedyVisit;
use crate::error::{Error, in_range};
use crate::extend::ExtendOptions;
use crate::goal::Reach;
use crate::partial::PartialState;
use crate::problem::{Parts, Problem};
use crate::sample::{GoalBiased, RobotOrObjects};
use crate::search::Strategy;
use crate::state::{ObjectId, PerObject, State};

/// Collects the pieces of a problem; [`Setup::problem`] checks them. The origin is the lower left corner
/// of the floor; every length is in metres.
#[derive(Debug, Clone)]
#[must_use]
pub struct Setup {
    size: Point,
    robot_radius_m: f64,
    robot_at: Point,
    pucks: Vec<(Puck, Point)>,
    obstacles: Vec<Obstacle>,
    robot_goal: Option<Point>,
    puck_goals: Vec<(usize, Point)>,
}

impl Setup {
    /// A floor of `size` with a robot in its middle.
    pub fn new(size: Point, robot_radius_m: f64) -> Self {
        Self {
            size,
            robot_radius_m,
            robot_at: size.map(|side| side / 2.0),
            pucks: Vec::new(),
            obstacles: Vec::new(),
            robot_goal: None,
            puck_goals: Vec::new(),
        }
    }

    /// Where the robot starts.
    pub fn robot_at(mut self, at: Point) -> Self {
        self.robot_at = at;
        self
    }

    /// Adds a puck that can only be pushed.
    pub fn puck(self, name: &str, radius_m: f64, at: Point) -> Self {
        self.add_puck(Puck { name: name.into(), radius_m, is_graspable: false }, at)
    }

    /// Adds a puck that can be pushed and grabbed.
    pub fn graspable_puck(self, name: &str, radius_m: f64, at: Point) -> Self {
        self.add_puck(Puck { name: name.into(), radius_m, is_graspable: true }, at)
    }

    fn add_puck(mut self, puck: Puck, at: Point) -> Self {
        self.pucks.push((puck, at));
        self
    }

    /// Adds a wall along the axes, given by two opposite corners.
    pub fn wall(mut self, name: &str, lower: Point, upper: Point) -> Self {
        self.obstacles.push(Obstacle { name: name.into(), outline: Outline::Rectangle { lower, upper } });
        self
    }

    /// Adds a round pillar.
    pub fn pillar(mut self, name: &str, centre: Point, radius_m: f64) -> Self {
        self.obstacles.push(Obstacle { name: name.into(), outline: Outline::Disc { centre, radius_m } });
        self
    }

    /// Where the robot should end; without it, anywhere.
    pub fn robot_goal(mut self, at: Point) -> Self {
        self.robot_goal = Some(at);
        self
    }

    /// Where the puck of this index (in the order of adding) should end, lying free; without it, anywhere.
    pub fn puck_goal(mut self, index: usize, at: Point) -> Self {
        self.puck_goals.push((index, at));
        self
    }

    /// The parts of the problem, for changing some of them: add a primitive, replace the judge.
    ///
    /// # Errors
    /// [`Error`] if a radius or an obstacle is malformed, or a goal names a puck that is not there.
    pub fn parts(self) -> Result<Parts<PuckWorld>, Error> {
        for obstacle in &self.obstacles {
            check_obstacle(obstacle)?;
        }
        let (pucks, places): (Vec<Puck>, PerObject<Point>) = self.pucks.into_iter().unzip();
        let domain = PuckWorld::new(self.size, self.robot_radius_m, pucks)?;
        let mode = Mode::resting(places.len());
        let start = State { robot: self.robot_at, objects: places, mode };
        let mut target = PartialState::anywhere(&domain);
        if let Some(at) = self.robot_goal {
            target = target.with_robot(&domain, at);
        }
        for (index, at) in self.puck_goals {
            if index >= start.objects.len() {
                return Err(Error::ObjectCount {
                    what: "the goal",
                    found: index.saturating_add(1),
                    expected: start.objects.len(),
                });
            }
            target = target.with_object(ObjectId::new(index), at);
        }
        Ok(Parts {
            domain,
            start,
            goal: Box::new(Reach::new(target).in_mode(Box::new(|mode: &Mode| mode.held().is_none()))),
            primitives: vec![Box::new(Transit), Box::new(Push), Box::new(Pick), Box::new(Carry), Box::new(Place)],
            validity: Box::new(Clearance::new(self.obstacles.clone())),
            verifier: Box::new(Judge::new(self.obstacles)),
        })
    }

    /// The problem.
    ///
    /// # Errors
    /// As [`Setup::parts`] and [`Problem::new`]: also if something starts in a collision or off the floor.
    pub fn problem(self) -> Result<Problem<PuckWorld>, Error> {
        Problem::new(self.parts()?)
    }
}

fn check_obstacle(obstacle: &Obstacle) -> Result<(), Error> {
    let name = &obstacle.name;
    let finite = |what: &str, x: f64| in_range(&format!("{what} of {name}"), x, f64::MIN, f64::MAX, "finite");
    match obstacle.outline {
        Outline::Disc { centre, radius_m } => {
            in_range(&format!("radius of {name}"), radius_m, f64::MIN_POSITIVE, f64::MAX, "finite and positive")?;
            finite("x", centre[0])?;
            finite("y", centre[1])?;
        }
        Outline::Rectangle { lower, upper } => {
            for (l, u) in lower.into_iter().zip(upper) {
                finite("upper corner", u)?;
                in_range(&format!("lower corner of {name}"), l, f64::MIN, u, "finite and at most the upper corner")?;
            }
        }
    }
    Ok(())
}

/// The paper's choices: samples of robot or objects, one in five from the goal, greedy tour distance
/// (sections 4.2 and 4.3).
///
/// # Errors
/// None in practice: all parameters are in range.
pub fn paper_strategy() -> Result<Strategy<PuckWorld>, Error> {
    Ok(Strategy {
        sampler: Box::new(GoalBiased::new(RobotOrObjects::new(0.5, 0.0)?, 0.2)?),
        distance: Box::new(GreedyVisit),
        extend: ExtendOptions::default(),
        local_repair: None,
        try_penalty_m: 0.0,
        shorten: crate::shorten::ShortenOptions::default(),
        improve: None,
    })
}
