//! What a robot offers to the primitives: a holonomic base with one arm and a two-finger gripper.
//!
//! A new robot implements [`Manipulator`]; everything else in this crate works through it.

use std::fmt::Debug;

use darrt_geom::body::Body;
use nalgebra::{Isometry3, Point2, Vector3};
use rand::Rng;

use crate::hand_ties::HandTies;
use crate::kinematics::JointLimit;
use crate::object_space::upright;

/// The values of an arm's joints: an array of `f64` for an arm whose number of joints is known when the program is compiled,
/// [`Joints`](crate::joints::Joints) for one that comes as a file.
///
/// # Laws
/// As many values come back from `as_ref` as went into `from_values`, and the same ones; `zeros` of as many is one of them.
///
/// # Example
/// Joints with names, for a robot whose code speaks of them.
/// ```
/// use darrt_primitives::manipulator::JointVector;
///
/// #[derive(Debug, Clone, Copy, PartialEq)]
/// struct Scara([f64; 3]);
///
/// impl Scara {
///     fn lift_m(&self) -> f64 { self.0[2] }
/// }
/// impl AsRef<[f64]> for Scara {
///     fn as_ref(&self) -> &[f64] { &self.0 }
/// }
/// impl AsMut<[f64]> for Scara {
///     fn as_mut(&mut self) -> &mut [f64] { &mut self.0 }
/// }
/// impl JointVector for Scara {
///     fn from_values(values: &[f64]) -> Option<Self> { values.try_into().ok().map(Self) }
///     fn zeros(count: usize) -> Option<Self> { (count == 3).then_some(Self([0.0; 3])) }
/// }
///
/// assert_eq!(Scara::from_values(&[0.1, 0.2, 0.3]).map(|q| q.lift_m()), Some(0.3));
/// assert_eq!(Scara::from_values(&[0.1]), None);
/// ```
pub trait JointVector: AsRef<[f64]> + AsMut<[f64]> + Copy + PartialEq + Debug + Send + Sync + 'static {
    /// These values; `None` when there are more or fewer than this vector can have.
    fn from_values(values: &[f64]) -> Option<Self>;

    /// So many joints at zero; `None` as for [`JointVector::from_values`].
    fn zeros(count: usize) -> Option<Self>;

    /// Which hand of a robot with several is at work, counted from 0; 0 after `from_values` and `zeros`. It is no joint: the
    /// robot stands alike whichever it is, but for the fingers.
    fn hand_at_work(&self) -> usize {
        0
    }

    /// The same joints with another hand at work; the same vector (the default) for robots with one hand.
    #[must_use]
    fn with_hand_at_work(self, _hand: usize) -> Self {
        self
    }
}

impl<const N: usize> JointVector for [f64; N] {
    fn from_values(values: &[f64]) -> Option<Self> {
        values.try_into().ok()
    }

    fn zeros(count: usize) -> Option<Self> {
        (count == N).then_some([0.0; N])
    }
}

/// Speed of a robot that says nothing of its speeds, metres per second: that of a person who walks slowly.
const DEFAULT_SPEED_M_PER_S: f64 = 0.5;

/// Gap of the empty hand where no action asks for another, metres.
pub(crate) const USUAL_GAP_M: f64 = 0.08;

/// Configuration of base and arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Configuration<J> {
    /// `[x, y, yaw]` of the base in the world, metres and radians.
    pub base: [f64; 3],
    /// Joint values in radians (turning) or metres (sliding).
    pub arm: J,
}

/// The frame of the base, which lies on the floor, in the world, for a base at `[x, y, yaw]` (m, m, rad).
pub fn world_from_base(&[x, y, yaw]: &[f64; 3]) -> Isometry3<f64> {
    upright(Vector3::new(x, y, 0.0), yaw)
}

/// What carries a link along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinkGroup {
    /// Rigid to the base: base, torso, head, a parked arm.
    Base,
    /// Moved by the joints of the planned arm.
    Arm,
    /// Rigid to the tool frame: the palm.
    Hand,
    /// A finger of the planned arm: also moved by the gripper, and allowed to touch what it manipulates.
    Finger,
}

/// One rigid link with its shape.
#[derive(Debug, Clone)]
pub struct RobotLink {
    /// The shape, in the link's frame; its name is the link's.
    pub body: Body,
    /// What moves it.
    pub group: LinkGroup,
}

/// The facts about a two-finger gripper that contacts and grasps need. Tool frame: x forward out of the hand, y the
/// finger opening axis, z the finger width axis.
///
/// # Example
/// Fingers that swing open on arcs: the wider the gap, the less far their tips reach.
/// ```
/// use darrt_primitives::manipulator::Hand;
///
/// struct Swinging { finger_m: f64 }
///
/// impl Hand for Swinging {
///     fn max_gap_m(&self) -> f64 { 1.2 * self.finger_m }
///     fn tip_beyond_tool_m(&self, gap_m: f64) -> f64 { (self.finger_m.powi(2) - (0.5 * gap_m).powi(2)).sqrt() }
///     fn tip_half_width_m(&self) -> f64 { 0.01 }
///     fn grip_force_n(&self) -> f64 { 60.0 }
/// }
///
/// let hand = Swinging { finger_m: 0.1 };
/// assert!((hand.tip_beyond_tool_m(0.0) - 0.1).abs() < 1e-12 && (hand.tip_beyond_tool_m(0.12) - 0.08).abs() < 1e-12);
/// ```
pub trait Hand: Send + Sync {
    /// The widest gap between the pads, metres.
    fn max_gap_m(&self) -> f64;

    /// How far the fingertips reach beyond the tool frame along its x axis at this gap, metres.
    fn tip_beyond_tool_m(&self, gap_m: f64) -> f64;

    /// Half the width of a fingertip along the tool's z axis, metres.
    fn tip_half_width_m(&self) -> f64;

    /// How long a pad is along the tool's x axis, from its tip back, metres; by default as wide as long.
    fn pad_length_m(&self) -> f64 {
        2.0 * self.tip_half_width_m()
    }

    /// Force with which each finger closes on what it holds, newton; infinite (the default): never the limit.
    fn grip_force_n(&self) -> f64 {
        f64::INFINITY
    }
}

/// A mobile manipulator.
///
/// # Laws
/// Run by [`check_manipulator`](crate::laws::check_manipulator) and [`check_reaches`](crate::laws::check_reaches); all
/// of them are in [`laws::manipulator`](crate::laws::manipulator).
/// - `world_from_tool` of every configuration returned by `inverse` or `inverse_near` is the pose asked for (1e-9), and
///   its joints lie within [`Manipulator::limits`].
/// - No point of the robot moves farther than [`Manipulator::travel_m`] while base and arm move on the straight line
///   between two configurations, and no point of a link farther than [`Manipulator::link_travel_m`] says of it.
/// - `link_poses` follows `world_from_tool`: hand links are rigid to the tool, finger links for a constant gap.
/// - What `hand_ties` tells is so in every configuration, and it tells all that is. What `turn_to_reach` turns is reached.
///
/// # Example
/// A crane on wheels: three slides, and a hand that always points down.
/// ```
/// use darrt_primitives::hand_ties::HandTies;
/// use darrt_primitives::kinematics::JointLimit;
/// use darrt_primitives::manipulator::{Configuration, Hand, LinkGroup, Manipulator, RobotLink, world_from_base};
/// # use darrt_geom::{body::Body, shape::Shape};
/// # use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
/// # use rand::{Rng, RngExt};
///
/// struct Jaw;
/// impl Hand for Jaw {
///     fn max_gap_m(&self) -> f64 { 0.1 }
///     fn tip_beyond_tool_m(&self, _gap_m: f64) -> f64 { 0.03 }
///     fn tip_half_width_m(&self) -> f64 { 0.01 }
/// }
///
/// struct Crane { limits: [JointLimit; 3], links: Vec<RobotLink> }
/// fn base_from_tool(arm: [f64; 3]) -> Isometry3<f64> {
///     let down = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
///     Isometry3::from_parts(Translation3::from(arm), down)
/// }
/// impl Crane {
///     fn solve(&self, base: &[f64; 3], tool: &Isometry3<f64>) -> Option<[f64; 3]> {
///         let wanted = world_from_base(base).inverse() * tool;
///         let arm: [f64; 3] = wanted.translation.vector.into();
///         let points_down = wanted.rotation.angle_to(&base_from_tool(arm).rotation) < 1e-9;
///         (points_down && arm.iter().zip(&self.limits).all(|(x, limit)| limit.contains(*x))).then_some(arm)
///     }
/// }
/// impl Manipulator for Crane {
///     type Joints = [f64; 3];
///     fn hand(&self) -> &dyn Hand { &Jaw }
///     fn limits(&self) -> &[JointLimit] { &self.limits }
///     fn joint_weights_m(&self) -> &[f64] { &[1.0; 3] }
///     fn links(&self) -> &[RobotLink] { &self.links }
///     fn self_pairs(&self) -> &[(usize, usize)] { &[] }
///     fn world_from_tool(&self, q: &Configuration<[f64; 3]>) -> Isometry3<f64> {
///         world_from_base(&q.base) * base_from_tool(q.arm)
///     }
///     fn inverse(&self, base: &[f64; 3], tool: &Isometry3<f64>, _: &mut dyn Rng) -> Option<[f64; 3]> {
///         self.solve(base, tool)
///     }
///     fn inverse_near(&self, base: &[f64; 3], tool: &Isometry3<f64>, _near: &[f64; 3]) -> Option<[f64; 3]> {
///         self.solve(base, tool)
///     }
///     fn base_for(&self, tool: &Isometry3<f64>, rng: &mut dyn Rng) -> [f64; 3] {
///         let ahead = tool * Vector3::z() * rng.random_range(0.1..0.9); // along the x axis of the base
///         [tool.translation.x - ahead.x, tool.translation.y - ahead.y, ahead.y.atan2(ahead.x)]
///     }
///     fn may_reach(&self, base: &[f64; 3], tool: &Isometry3<f64>) -> bool { self.solve(base, tool).is_some() }
///     fn link_poses(&self, q: &Configuration<[f64; 3]>, gap_m: f64, out: &mut [Isometry3<f64>]) {
///         let finger = |side: f64| self.world_from_tool(q) * Translation3::new(0.0, side * (0.5 * gap_m + 0.01), 0.0);
///         out.copy_from_slice(&[finger(1.0), finger(-1.0)]);
///     }
///     fn travel_m(&self, a: &Configuration<[f64; 3]>, b: &Configuration<[f64; 3]>, held_reach_m: f64) -> f64 {
///         let along = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
///         let farthest_m = 1.5 + held_reach_m; // of any point from the axis of the base: limits and fingers
///         let turn_rad = (b.base[2] - a.base[2] + 9.42477796076938).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
///         along(&a.base[..2], &b.base[..2]) + turn_rad.abs() * farthest_m + along(&a.arm, &b.arm)
///     }
///     fn hand_ties(&self) -> HandTies {
///         HandTies { up_in_tool: Some(-Vector3::x_axis()), height_m: None } // it points down, and is lifted
///     }
/// }
///
/// let finger = |name: &str| -> Result<RobotLink, darrt_geom::GeomError> {
///     let body = Body::single(name, Shape::cuboid(Vector3::new(0.03, 0.01, 0.01))?)?;
///     Ok(RobotLink { body, group: LinkGroup::Finger })
/// };
/// let links = vec![finger("left finger")?, finger("right finger")?];
/// let crane = Crane { limits: [JointLimit::new(0.0, 1.0), JointLimit::new(-0.5, 0.5), JointLimit::new(0.1, 1.5)], links };
/// let [a, b] = [[0.2, 0.1, 0.8], [0.6, -0.3, 1.2]].map(|arm| Configuration { base: [0.0; 3], arm });
/// # use darrt_primitives::laws::{ManipulatorClaims, check_manipulator};
/// check_manipulator(&crane, [&a, &b], [0.02, 0.08], 0, &ManipulatorClaims::default())?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Manipulator: Send + Sync + 'static {
    /// The arm's joint vector.
    type Joints: JointVector;

    /// The gripper.
    fn hand(&self) -> &dyn Hand;

    /// Limits of the arm's joints; an unlimited joint is a continuous one, whose values lie in `(-pi, pi]`.
    fn limits(&self) -> &[JointLimit];

    /// Pose of the tool frame in the world.
    fn world_from_tool(&self, q: &Configuration<Self::Joints>) -> Isometry3<f64>;

    /// Some arm configuration that brings the tool to `world_from_tool` from this base; redundancy is drawn from `rng`.
    /// `None` if there is none within the limits (or none was found).
    fn inverse(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<Self::Joints>;

    /// The arm configuration near `near` that brings the tool to `world_from_tool`: for following a line in small steps.
    fn inverse_near(
        &self,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        near: &Self::Joints,
    ) -> Option<Self::Joints>;

    /// A base pose from which the tool may reach `world_from_tool`, drawn at random; obstacles are ignored.
    fn base_for(&self, world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> [f64; 3];

    /// Can the tool possibly reach `world_from_tool` from this base? A cheap necessary condition.
    fn may_reach(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool;

    /// All links, in a fixed order.
    fn links(&self) -> &[RobotLink];

    /// Pairs of links (indices into [`Manipulator::links`]) that can collide and must be checked.
    fn self_pairs(&self) -> &[(usize, usize)];

    /// By how much to turn `world_from_tool` about the vertical through `centre` (world x, y), so that the arm reaches it from this
    /// base; radians. Asked for what looks alike from all sides. `None` (the default) where it is not to be turned: an arm of six
    /// joints or more comes to poses at any heading, one of fewer to some.
    fn turn_to_reach(
        &self,
        _base: &[f64; 3],
        _world_from_tool: &Isometry3<f64>,
        _centre: &Point2<f64>,
        _rng: &mut dyn Rng,
    ) -> Option<f64> {
        None
    }

    /// Writes the world pose of every link, in the order of [`Manipulator::links`]. `out` has as many places.
    fn link_poses(&self, q: &Configuration<Self::Joints>, gap_m: f64, out: &mut [Isometry3<f64>]);

    /// Metres: bound on the travel of any point of the robot, and of a held object that reaches `held_reach_m` beyond
    /// the tool frame, on the straight line from `a` to `b`.
    fn travel_m(&self, a: &Configuration<Self::Joints>, b: &Configuration<Self::Joints>, held_reach_m: f64) -> f64;

    /// The same link by link: writes for every link, in the order of [`Manipulator::links`], a bound on the travel of any of
    /// its points, and returns one for a held object. The tighter, the fewer states a motion is checked at; by default
    /// every link gets [`Manipulator::travel_m`].
    fn link_travel_m(
        &self,
        a: &Configuration<Self::Joints>,
        b: &Configuration<Self::Joints>,
        held_reach_m: f64,
        out: &mut [f64],
    ) -> f64 {
        let bound = self.travel_m(a, b, held_reach_m);
        out.fill(bound);
        bound
    }

    /// The heaviest object that the arm carries, kilograms; infinite (the default): never the limit.
    fn payload_kg(&self) -> f64 {
        f64::INFINITY
    }

    /// The largest force with which the arm can push sideways, newton; infinite (the default): never the limit.
    fn push_force_n(&self) -> f64 {
        f64::INFINITY
    }

    /// What neither the joints nor the base change of the pose of the hand; by default nothing is tied. A hand that is tied is asked
    /// to stand nowhere else: Push leans it as it leans, at the height at which it is.
    fn hand_ties(&self) -> HandTies {
        HandTies::default()
    }

    /// Typical metres of hand travel per unit of each joint: weights of the arm's distance.
    fn joint_weights_m(&self) -> &[f64];

    /// How many hands it has, each at the end of an arm of its own. Arms may share joints, such as those of a lift.
    ///
    /// One (the default) is all that most robots need to say. A robot with several plans with all its joints in one vector,
    /// which also says [which hand is at work](JointVector::hand_at_work): that is the hand that [`Manipulator::world_from_tool`]
    /// and [`Manipulator::inverse_near`] are about, and that is open by the gap; the others are empty and open by
    /// [`Manipulator::idle_gap_m`]. The methods below from here on say of each hand what `hand`, `inverse`, `base_for`,
    /// `may_reach`, `turn_to_reach` and `hand_ties` say of the first.
    fn hands(&self) -> usize {
        1
    }

    /// How far a hand is open that is not at work, metres; it is opened so far before another hand goes to work.
    fn idle_gap_m(&self) -> f64 {
        let gaps = (0..self.hands()).map(|hand| self.hand_of(hand).max_gap_m());
        gaps.fold(USUAL_GAP_M, f64::min)
    }

    /// One of the hands.
    fn hand_of(&self, _hand: usize) -> &dyn Hand {
        self.hand()
    }

    /// [`Manipulator::inverse`] for the hand that is at work in `now`; joints that do not move this hand stay as in `now`.
    fn inverse_from(
        &self,
        _now: &Self::Joints,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        rng: &mut dyn Rng,
    ) -> Option<Self::Joints> {
        self.inverse(base, world_from_tool, rng)
    }

    /// [`Manipulator::base_for`] for one of the hands.
    fn base_for_hand(&self, _hand: usize, world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> [f64; 3] {
        self.base_for(world_from_tool, rng)
    }

    /// [`Manipulator::may_reach`] for one of the hands.
    fn may_reach_with(&self, _hand: usize, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool {
        self.may_reach(base, world_from_tool)
    }

    /// [`Manipulator::turn_to_reach`] for one of the hands.
    fn turn_to_reach_with(
        &self,
        _hand: usize,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        centre: &Point2<f64>,
        rng: &mut dyn Rng,
    ) -> Option<f64> {
        self.turn_to_reach(base, world_from_tool, centre, rng)
    }

    /// [`Manipulator::hand_ties`] of one of the hands.
    fn hand_ties_of(&self, _hand: usize) -> HandTies {
        self.hand_ties()
    }

    /// Of which hand a link of the groups [`LinkGroup::Hand`] and [`LinkGroup::Finger`] is a part; a number of the links of any
    /// other group that nobody asks for.
    fn hand_of_link(&self, _link: usize) -> usize {
        0
    }

    /// `now` with those joints that do not move the hand at work as in `posture`: its other arms out of the way.
    fn with_others_at(&self, now: &Self::Joints, _posture: &Self::Joints) -> Self::Joints {
        *now
    }

    /// Does the base move along its heading only, and turn on the spot? Its drives then are those of
    /// [`heading_drive`](crate::heading_drive).
    fn drives_along_heading(&self) -> bool {
        false
    }

    /// Seconds from `a` to `b` on the straight line between them at the speeds that the robot is planned with, with something
    /// in its hand or with none; starting and stopping not counted. By default the bound on the travel at half a metre per
    /// second.
    fn duration_s(&self, a: &Configuration<Self::Joints>, b: &Configuration<Self::Joints>, _is_loaded: bool) -> f64 {
        self.travel_m(a, b, 0.0) / DEFAULT_SPEED_M_PER_S
    }
}
