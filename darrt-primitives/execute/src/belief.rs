//! What a robot knows of where it and everything is, and how well: a Kalman filter over its base, the errors of its joints and the
//! places of the objects.
//!
//! The errors are true minus believed: x, y (m) and yaw (rad) of the base, one constant of every joint of the arm (rad or m), x, y
//! and yaw of every object. Drives and contacts change them as linear maps, looks bring them down. What is known of the mechanics
//! is where the two funnels come in: fingers that push, and fingers that close.
//!
//! # Sources
//! - Filter, maps and gains: Thrun, Burgard, Fox, *Probabilistic Robotics* (2005), chapter 3.
//! - Pushes: [`Funnel`], `darrt_primitives::push::settling`.
//! - Closing: a grasp takes away what is off along the axis of the fingers (Mason, *The mechanics of manipulation*, 1985); pads turn
//!   what they hold flush (measured, README).

use darrt_primitives::push::settling::Funnel;
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix2, Matrix3, Point2, Point3, Translation3, UnitQuaternion, Vector2, Vector3,
};

use crate::noise::{NoiseModel, PlanarError};

/// What a contact leaves an object off by of itself, m: what plans end with when nothing else is off (README, no noise).
const CONTACT_M: f64 = 0.001;
/// A sight so much less likely than one standard deviation is no error of sight: the object is where it is seen. The square of the
/// distance in standard deviations, which one in a thousand exceeds by chance (chi square, two and three numbers).
const SURPRISE: f64 = 15.0;

/// Base, joints and objects as they are believed to be, with the covariance of the errors.
#[derive(Debug, Clone)]
pub(crate) struct Belief {
    pub(crate) base: [f64; 3],
    /// By joint of the arm.
    pub(crate) biases: Vec<f64>,
    pub(crate) objects: Vec<Isometry3<f64>>,
    is_round: Vec<bool>,
    covariance: DMatrix<f64>,
    noise: NoiseModel,
}

/// What is seen from the robot: x, y and yaw in the frame of its base.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight {
    /// Which object; `None`: furniture that stands fast, here in the world.
    pub(crate) object: Option<usize>,
    pub(crate) world_from_room: Point2<f64>,
    pub(crate) base_from_body: PlanarError,
}

impl Belief {
    /// Before the first look: everything as the plan has it, give or take what the noise says.
    pub(crate) fn new(
        noise: &NoiseModel,
        base: [f64; 3],
        joints: usize,
        objects: &[Isometry3<f64>],
        is_round: Vec<bool>,
    ) -> Self {
        let size = 3 + joints + 3 * objects.len();
        let mut covariance = DMatrix::zeros(size, size);
        for joint in 0..joints {
            covariance[(3 + joint, 3 + joint)] = (1e-3 * noise.joint_bias_mrad).powi(2);
        }
        let mut belief =
            Self { base, biases: vec![0.0; joints], objects: objects.to_vec(), is_round, covariance, noise: *noise };
        for object in 0..objects.len() {
            belief.forget(object);
        }
        belief
    }

    fn robot_size(&self) -> usize {
        3 + self.biases.len()
    }

    fn at(&self, object: usize) -> usize {
        self.robot_size() + 3 * object
    }

    fn of_detection(&self) -> [f64; 3] {
        let (m, rad) = (self.noise.detection_m, self.noise.detection_deg.to_radians());
        [m * m, m * m, rad * rad]
    }

    /// An object is nowhere but where it has just been detected.
    fn forget(&mut self, object: usize) {
        let (at, size) = (self.at(object), self.covariance.nrows());
        self.covariance.view_mut((at, 0), (3, size)).fill(0.0);
        self.covariance.view_mut((0, at), (size, 3)).fill(0.0);
        for (index, variance) in self.of_detection().into_iter().enumerate() {
            self.covariance[(at + index, at + index)] = variance;
        }
    }

    /// Covariance of x, y, yaw of an object in the world.
    pub(crate) fn of_object(&self, object: usize) -> Matrix3<f64> {
        let at = self.at(object);
        self.covariance.fixed_view::<3, 3>(at, at).into_owned()
    }

    /// Covariance of x, y, yaw of the base.
    pub(crate) fn of_base(&self) -> Matrix3<f64> {
        self.covariance.fixed_view::<3, 3>(0, 0).into_owned()
    }

    /// Covariance of x, y, yaw of a point of the hand, by what errors of the robot make of it.
    pub(crate) fn of_hand(&self, hand: &DMatrix<f64>) -> Matrix3<f64> {
        let size = self.robot_size();
        let robot = self.covariance.view((0, 0), (size, size));
        (hand * robot * hand.transpose()).fixed_view::<3, 3>(0, 0).into_owned()
    }

    /// Covariance of x, y, yaw of an object against the hand.
    pub(crate) fn to_hand(&self, object: usize, hand: &DMatrix<f64>) -> Matrix3<f64> {
        let map = self.difference(object, hand);
        (&map * &self.covariance * map.transpose()).fixed_view::<3, 3>(0, 0).into_owned()
    }

    /// Takes the error of the hand from that of an object.
    fn difference(&self, object: usize, hand: &DMatrix<f64>) -> DMatrix<f64> {
        let mut map = DMatrix::zeros(3, self.covariance.nrows());
        map.view_mut((0, self.at(object)), (3, 3)).fill_with_identity();
        map.view_mut((0, 0), (3, self.robot_size())).copy_from(&(-hand));
        map
    }

    fn change(&mut self, map: &DMatrix<f64>) {
        self.covariance = map * &self.covariance * map.transpose();
    }

    /// The base has been driven to where it is told to be; the joints stay.
    pub(crate) fn drive(&mut self, base: [f64; 3]) {
        self.base = base;
        let size = self.covariance.nrows();
        if !self.noise.base_adds_up {
            self.covariance.view_mut((0, 0), (3, size)).fill(0.0);
            self.covariance.view_mut((0, 0), (size, 3)).fill(0.0);
        }
        let (m, rad) = (self.noise.base_m, self.noise.base_deg.to_radians());
        for (index, sigma) in [m, m, rad].into_iter().enumerate() {
            self.covariance[(index, index)] += sigma * sigma;
        }
    }

    /// An object is from now on off against the hand by `keep` of what it is, and no longer against the world.
    pub(crate) fn grip(&mut self, object: usize, hand: &DMatrix<f64>, keep: &Matrix3<f64>) {
        let mut map = DMatrix::identity(self.covariance.nrows(), self.covariance.nrows());
        let rows = DMatrix::from_column_slice(3, 3, keep.as_slice()) * self.difference(object, hand);
        map.view_mut((self.at(object), 0), (3, rows.ncols())).copy_from(&rows);
        self.change(&map);
    }

    /// The way back: the hand is elsewhere, and has turned by `yaw` since, with the object.
    pub(crate) fn release(&mut self, object: usize, hand: &DMatrix<f64>, yaw: f64) {
        let size = self.covariance.nrows();
        let mut map = DMatrix::identity(size, size);
        let at = self.at(object);
        map.fixed_view_mut::<3, 3>(at, at).copy_from(&turn(yaw));
        map.view_mut((at, 0), (3, self.robot_size())).copy_from(hand);
        self.change(&map);
    }

    /// A contact has added its own part.
    pub(crate) fn contact(&mut self, object: usize) {
        let at = self.at(object);
        for index in 0..2 {
            self.covariance[(at + index, at + index)] += CONTACT_M * CONTACT_M;
        }
    }

    /// Takes what is seen into account. True if an object is seen where nobody would have expected it.
    pub(crate) fn see(&mut self, sight: &Sight) -> bool {
        let (seen, yaw) = self.placed(sight.base_from_body);
        let (believed, believed_yaw) = match sight.object {
            Some(object) => {
                self.objects.get(object).map_or((seen, yaw), |pose| (pose.translation.vector.xy(), yaw_of(pose)))
            }
            None => (sight.world_from_room.coords, 0.0),
        };
        let away = believed - Vector2::new(self.base[0], self.base[1]);
        let size = self.covariance.nrows();
        // How what is seen less what is believed depends on the errors.
        let mut map = DMatrix::zeros(3, size);
        for index in 0..3 {
            map[(index, index)] = -1.0;
        }
        (map[(0, 2)], map[(1, 2)]) = (away.y, -away.x);
        if let Some(object) = sight.object {
            map.view_mut((0, self.at(object)), (3, 3)).fill_with_identity();
        }
        let off = seen - believed;
        let mut off = DVector::from_vec(vec![off.x, off.y, wrapped(yaw - believed_yaw)]);
        let mut variances = self.of_detection().to_vec();
        if sight.object.is_some_and(|object| self.is_round.get(object) == Some(&true)) {
            map = map.rows(0, 2).into_owned();
            off = off.rows(0, 2).into_owned();
            variances.truncate(2);
        }
        // A sight without error would leave nothing to divide by.
        let smallest = CONTACT_M * CONTACT_M * 1e-6;
        let noise = DMatrix::from_diagonal(&DVector::from_vec(variances).map(|v| v.max(smallest)));
        let spread = &map * &self.covariance * map.transpose() + noise;
        let Some(inverse) = spread.cholesky().map(|factors| factors.inverse()) else { return false };
        let unlikely = (off.transpose() * &inverse * &off)[(0, 0)];
        if let Some(object) = sight.object.filter(|_| unlikely > SURPRISE) {
            self.put(object, seen, yaw);
            self.forget(object);
            return true;
        }
        let gain = &self.covariance * map.transpose() * inverse;
        let change = &gain * off;
        self.covariance = (DMatrix::identity(size, size) - gain * map) * &self.covariance;
        // Rounding must not make it lopsided.
        self.covariance = (&self.covariance + self.covariance.transpose()) * 0.5;
        self.correct(change.as_slice());
        false
    }

    /// Where something is in the world that is seen from the believed base: x, y and yaw.
    fn placed(&self, [x, y, yaw]: PlanarError) -> (Vector2<f64>, f64) {
        let (sin, cos) = self.base[2].sin_cos();
        let at = Vector2::new(self.base[0] + cos * x - sin * y, self.base[1] + sin * x + cos * y);
        (at, self.base[2] + yaw)
    }

    fn put(&mut self, object: usize, at: Vector2<f64>, yaw: f64) {
        let is_round = self.is_round.get(object) == Some(&true);
        if let Some(pose) = self.objects.get_mut(object) {
            let by = if is_round { 0.0 } else { wrapped(yaw - yaw_of(pose)) };
            *pose = moved(pose, [at.x - pose.translation.x, at.y - pose.translation.y, by]);
        }
    }

    fn correct(&mut self, change: &[f64]) {
        let (robot, objects) = change.split_at(self.robot_size().min(change.len()));
        self.base.iter_mut().zip(robot).for_each(|(value, by)| *value += by);
        self.biases.iter_mut().zip(robot.iter().skip(3)).for_each(|(value, by)| *value += by);
        for (pose, by) in self.objects.iter_mut().zip(objects.chunks_exact(3)) {
            if let &[x, y, yaw] = by {
                *pose = moved(pose, [x, y, yaw]);
            }
        }
    }
}

/// What a push leaves of the error of an object against the hand: nothing lengthwise, and sideways what the funnel leaves of one
/// standard deviation. `funnel` is none where two fingers hold what is pushed by its own width.
pub(crate) fn left_by_push(
    direction: Vector2<f64>,
    sideways_m: f64,
    length_m: f64,
    funnel: Option<&Funnel>,
) -> Matrix3<f64> {
    let left = funnel.map_or(0.0, |funnel| {
        let after = funnel.push(sideways_m, length_m).map_or(sideways_m, |after| after.lateral_error.abs());
        if sideways_m > 0.0 { (after / sideways_m).min(1.0) } else { 0.0 }
    });
    let across = Vector2::new(-direction.y, direction.x);
    let plane: Matrix2<f64> = across * across.transpose() * left;
    let mut keep = Matrix3::zeros();
    keep.fixed_view_mut::<2, 2>(0, 0).copy_from(&plane);
    keep
}

/// What closing leaves of the error of an object against the hand: what is off along the axis of the fingers goes, as far as that
/// lies level. If it is the wall of something round that they close on, its middle beside the hand, the flat pads turn it until its
/// wall lies flush, and what is off along the wall goes too.
pub(crate) fn left_by_closing(finger_axis: &Vector3<f64>, is_round_wall: bool) -> Matrix3<f64> {
    let level = finger_axis.xy();
    let mut keep = Matrix3::identity();
    let gone: Matrix2<f64> = level * level.transpose();
    let gone = if is_round_wall { Matrix2::identity() * level.norm_squared() } else { gone };
    keep.fixed_view_mut::<2, 2>(0, 0).copy_from(&(Matrix2::identity() - gone));
    keep
}

/// Yaw of a pose, radians.
pub(crate) fn yaw_of(pose: &Isometry3<f64>) -> f64 {
    pose.rotation.euler_angles().2
}

/// A pose moved level and turned about its own upright axis.
pub(crate) fn moved(pose: &Isometry3<f64>, [x, y, yaw]: PlanarError) -> Isometry3<f64> {
    let by = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    Isometry3::from_parts(Translation3::from(pose.translation.vector + Vector3::new(x, y, 0.0)), by * pose.rotation)
}

/// What takes one pose to another, level: about the first one's own place.
pub(crate) fn level_change(from: &Isometry3<f64>, to: &Isometry3<f64>, is_round: bool) -> PlanarError {
    let by = to.translation.vector - from.translation.vector;
    [by.x, by.y, if is_round { 0.0 } else { wrapped(yaw_of(to) - yaw_of(from)) }]
}

/// `pose` carried along when what is at `about` is moved level and turned by `change`.
pub(crate) fn carried(pose: &Isometry3<f64>, about: &Point3<f64>, [x, y, yaw]: PlanarError) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    let arm = pose.translation.vector - about.coords;
    let at = about.coords + turn * arm + Vector3::new(x, y, 0.0);
    Isometry3::from_parts(Translation3::from(at), turn * pose.rotation)
}

fn turn(yaw: f64) -> Matrix3<f64> {
    let (sin, cos) = yaw.sin_cos();
    Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
}

fn wrapped(angle: f64) -> f64 {
    darrt_primitives::kinematics::limit::wrap_to_pi(angle)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test says what is wrong by panicking")]

    use darrt_primitives::push::Friction;
    use darrt_primitives::push::limit_surface::PressureConstant;

    use super::*;
    use crate::noise::Draws;

    const NOISE: NoiseModel = NoiseModel {
        detection_m: 0.010,
        detection_deg: 2.0,
        base_m: 0.015,
        base_deg: 1.0,
        base_adds_up: false,
        joint_bias_mrad: 4.0,
        table_friction: 0.0,
        finger_friction: 0.0,
        mass: 0.0,
    };

    fn belief() -> Belief {
        Belief::new(&NOISE, [0.0; 3], 2, &[Isometry3::translation(0.8, 0.1, 0.5)], vec![true])
    }

    fn sight_of(object: Option<usize>, at: [f64; 3]) -> Sight {
        Sight { object, world_from_room: Point2::new(0.8, 0.1), base_from_body: at }
    }

    fn sigma(covariance: &Matrix3<f64>) -> f64 {
        covariance[(0, 0)].sqrt()
    }

    #[test]
    fn a_second_look_from_the_same_place_halves_the_variance() {
        let mut belief = belief();
        assert!((sigma(&belief.of_object(0)) - 0.010).abs() < 1e-12);
        // Two detections of equal weight: half way between them.
        assert!(!belief.see(&sight_of(Some(0), [0.808, 0.1, 0.0])));
        assert!((sigma(&belief.of_object(0)) - 0.010 / 2.0_f64.sqrt()).abs() < 1e-9);
        assert!((belief.objects[0].translation.x - 0.804).abs() < 1e-9);
    }

    #[test]
    fn drives_and_furniture_tell_of_the_base() {
        let mut belief = belief();
        belief.drive([0.0; 3]);
        assert!((sigma(&belief.of_base()) - 0.015).abs() < 1e-12);
        // Straight ahead: 15 mm of the base against 10 mm of sight.
        let ahead = Point2::new(0.8, 0.0);
        let sight = Sight { object: None, world_from_room: ahead, base_from_body: [0.79, 0.0, 0.0] };
        assert!(!belief.see(&sight));
        let known = (0.015_f64.powi(-2) + 0.010_f64.powi(-2)).powf(-0.5);
        assert!((sigma(&belief.of_base()) - known).abs() < 1e-9, "{}", sigma(&belief.of_base()));
        // What is seen nearer than it should be: the base stands farther ahead.
        assert!(belief.base[0] > 0.005 && belief.base[0] < 0.008, "{:?}", belief.base);
    }

    #[test]
    fn what_is_somewhere_else_altogether_is_believed_at_once() {
        let mut belief = belief();
        assert!(belief.see(&sight_of(Some(0), [0.95, 0.1, 0.0])));
        assert_eq!(belief.objects[0].translation.x, 0.95);
        assert!((sigma(&belief.of_object(0)) - 0.010).abs() < 1e-12);
    }

    #[test]
    fn what_is_held_goes_with_the_errors_of_the_hand() {
        let mut belief = belief();
        // A hand without joints that stands where the object is, 0.8 m ahead of the base.
        let hand = DMatrix::from_row_slice(3, 5, &[1., 0., -0.1, 0., 0., 0., 1., 0.8, 0., 0., 0., 0., 1., 0., 0.]);
        let before = belief.of_object(0);
        belief.grip(0, &hand, &Matrix3::identity());
        belief.release(0, &hand, 0.0);
        assert!((belief.of_object(0) - before).norm() < 1e-15, "nothing moves, nothing changes");
        belief.grip(0, &hand, &Matrix3::identity());
        belief.drive([0.0; 3]);
        belief.release(0, &hand, 0.0);
        // y: what it was, the base, and its yaw at 0.8 m.
        let yaw = 0.8 * 1.0_f64.to_radians();
        let wanted = (0.010_f64.powi(2) + 0.015_f64.powi(2) + yaw * yaw).sqrt();
        assert!((belief.of_object(0)[(1, 1)].sqrt() - wanted).abs() < 1e-9);
    }

    #[test]
    fn two_fingers_take_away_what_they_funnel() {
        let pressure = PressureConstant::uniform_disc(0.14).unwrap();
        let funnel = Funnel::new(0.14, 0.08, pressure, Friction::new(0.3).unwrap()).unwrap();
        // 10 mm are gone after 0.0601 m (the table in `settling`), and part of them before.
        let long = left_by_push(Vector2::x(), 0.010, 0.061, Some(&funnel));
        assert_eq!(long, Matrix3::zeros());
        let short = left_by_push(Vector2::x(), 0.010, 0.03, Some(&funnel));
        assert!(short[(0, 0)] == 0.0 && short[(1, 1)] > 0.2 && short[(1, 1)] < 0.9, "{short}");
        // Upright fingers leave level errors alone, level ones take those along their axis away.
        assert_eq!(left_by_closing(&Vector3::z(), true), Matrix3::identity());
        let level = left_by_closing(&Vector3::y(), false);
        assert_eq!((level[(0, 0)], level[(1, 1)]), (1.0, 0.0));
        let wall = left_by_closing(&Vector3::y(), true);
        assert_eq!((wall[(0, 0)], wall[(1, 1)]), (0.0, 0.0));
    }

    /// The errors that are left are as large as the covariance says.
    #[test]
    fn the_filter_is_as_sure_as_it_may_be() {
        let (mut squares, mut expected, runs) = (0.0, 0.0, 400);
        for run in 0..runs {
            let mut draws = Draws::new(NOISE, 7, run);
            let mut belief = belief();
            let at = draws.object().at;
            let truth = belief.objects[0].translation.vector.xy() + Vector2::new(at[0], at[1]);
            let base = draws.drive([0.0; 3]);
            belief.drive([0.0; 3]);
            let world_from_base = darrt_primitives::manipulator::world_from_base(&base);
            for _ in 0..3 {
                let bodies = [(None, Vector2::new(0.8, 0.1)), (Some(0), truth)];
                for (object, world) in bodies {
                    let error = draws.sight();
                    let seen = world_from_base.inverse() * Point3::new(world.x, world.y, 0.0);
                    belief.see(&sight_of(object, [seen.x + error[0], seen.y + error[1], error[2] - base[2]]));
                }
            }
            squares += (belief.objects[0].translation.vector.xy() - truth).norm_squared();
            expected += belief.of_object(0).fixed_view::<2, 2>(0, 0).trace();
        }
        let ratio = (squares / expected).sqrt();
        assert!((0.9..1.1).contains(&ratio), "{ratio}");
    }
}
