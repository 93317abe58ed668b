//! What the world and the robot are off from what the plan takes them for: a documented file, scaled, and drawn by seed.

use rand::{Rng, RngExt as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Standard deviations of the errors of one execution. Missing keys are zero.
///
/// `noise/real.toml` is the built-in one. Errors are normal, cut off at three standard deviations, so that one in four
/// hundred draws is drawn again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct NoiseModel {
    /// Where an object truly stands at the start against where it was detected: x and y each, metres.
    pub detection_m: f64,
    /// The same for its yaw, degrees. Round objects do not notice.
    pub detection_deg: f64,
    /// Where the base stands after a drive against where it shall: x and y each, metres.
    pub base_m: f64,
    /// The same for its yaw, degrees.
    pub base_deg: f64,
    /// Do the errors of drives add up, as without localisation, or is each a new one?
    pub base_adds_up: bool,
    /// A constant error of every joint of the arm, milliradians.
    pub joint_bias_mrad: f64,
    /// The friction of an object with what it stands on, as a part of its value.
    pub table_friction: f64,
    /// The friction of an object with the fingers, as a part of its value.
    pub finger_friction: f64,
    /// The mass of an object, as a part of its value.
    pub mass: f64,
}

/// The file of the built-in model, with the source of every figure.
pub const REAL_NOISE: &str = include_str!("../noise/real.toml");

/// A noise model that cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NoiseError {
    /// The file is no noise model.
    #[error("{file}: {message}")]
    Syntax {
        /// The file.
        file: String,
        /// What is wrong.
        message: String,
    },
    /// A number out of its bounds.
    #[error("{file}: `{key}` is {value}, must be from 0 to {most}")]
    Range {
        /// The file.
        file: String,
        /// The key.
        key: &'static str,
        /// Its value.
        value: f64,
        /// The bound.
        most: f64,
    },
}

impl NoiseModel {
    /// Reads a model; `file` is how errors call the text.
    ///
    /// # Errors
    /// [`NoiseError`] for what is no TOML, an unknown key, and a number that is negative, not finite or absurdly large.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, NoiseError> {
        let model: Self = toml::from_str(text).map_err(|error| {
            let line = error.span().map_or(1, |span| text.get(..span.start).map_or(1, |t| t.lines().count().max(1)));
            NoiseError::Syntax { file: format!("{file}:{line}"), message: error.message().replace('\n', " ") }
        })?;
        model.check(file)?;
        Ok(model)
    }

    /// The errors of a real robot, as far as they are known: [`REAL_NOISE`].
    ///
    /// # Errors
    /// Never: a test reads the file.
    pub fn real() -> Result<Self, NoiseError> {
        Self::from_toml(REAL_NOISE, "real.toml")
    }

    /// The same model with every standard deviation times `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let Self {
            detection_m,
            detection_deg,
            base_m,
            base_deg,
            base_adds_up,
            joint_bias_mrad,
            table_friction,
            finger_friction,
            mass,
        } = *self;
        Self {
            detection_m: detection_m * factor,
            detection_deg: detection_deg * factor,
            base_m: base_m * factor,
            base_deg: base_deg * factor,
            base_adds_up,
            joint_bias_mrad: joint_bias_mrad * factor,
            table_friction: table_friction * factor,
            finger_friction: finger_friction * factor,
            mass: mass * factor,
        }
    }

    fn check(&self, file: &str) -> Result<(), NoiseError> {
        let bounds = [
            ("detection_m", self.detection_m, 1.0),
            ("detection_deg", self.detection_deg, 180.0),
            ("base_m", self.base_m, 1.0),
            ("base_deg", self.base_deg, 180.0),
            ("joint_bias_mrad", self.joint_bias_mrad, 1000.0),
            ("table_friction", self.table_friction, 0.33),
            ("finger_friction", self.finger_friction, 0.33),
            ("mass", self.mass, 0.33),
        ];
        for (key, value, most) in bounds {
            if !(0.0..=most).contains(&value) {
                return Err(NoiseError::Range { file: file.to_owned(), key, value, most });
            }
        }
        Ok(())
    }

    /// Is there no noise at all?
    pub fn is_none(&self) -> bool {
        *self == Self { base_adds_up: self.base_adds_up, ..Self::default() }
    }
}

/// An error of a pose on the floor: x and y (m), yaw (rad).
pub(crate) type PlanarError = [f64; 3];

/// Draws the errors of one run.
#[derive(Debug)]
pub(crate) struct Draws {
    model: NoiseModel,
    rng: Xoshiro256PlusPlus,
}

/// What one object truly is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ObjectDraw {
    pub(crate) at: PlanarError,
    pub(crate) table_friction: f64,
    pub(crate) finger_friction: f64,
    pub(crate) mass: f64,
}

impl Draws {
    /// Every run has its own stream.
    pub(crate) fn new(model: NoiseModel, seed: u64, run: u64) -> Self {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let stream = rng.next_u64() ^ run.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        Self { model, rng: Xoshiro256PlusPlus::seed_from_u64(stream) }
    }

    /// A normal number, within three standard deviations.
    fn normal(&mut self) -> f64 {
        loop {
            // Box and Muller; the logarithm of zero is avoided.
            let (u, v): (f64, f64) = (1.0 - self.rng.random::<f64>(), self.rng.random());
            let z = (-2.0 * u.ln()).sqrt() * (TAU * v).cos();
            if z.abs() <= 3.0 {
                return z;
            }
        }
    }

    fn planar(&mut self, metres: f64, degrees: f64) -> PlanarError {
        [metres * self.normal(), metres * self.normal(), degrees.to_radians() * self.normal()]
    }

    pub(crate) fn object(&mut self) -> ObjectDraw {
        let NoiseModel { detection_m, detection_deg, table_friction, finger_friction, mass, .. } = self.model;
        ObjectDraw {
            at: self.planar(detection_m, detection_deg),
            table_friction: 1.0 + table_friction * self.normal(),
            finger_friction: 1.0 + finger_friction * self.normal(),
            mass: 1.0 + mass * self.normal(),
        }
    }

    pub(crate) fn joint_biases(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| 1e-3 * self.model.joint_bias_mrad * self.normal()).collect()
    }

    /// The error with which a body is seen.
    pub(crate) fn sight(&mut self) -> PlanarError {
        self.planar(self.model.detection_m, self.model.detection_deg)
    }

    /// The error of the base after a drive that began with error `before`.
    pub(crate) fn drive(&mut self, before: PlanarError) -> PlanarError {
        let new = self.planar(self.model.base_m, self.model.base_deg);
        if self.model.base_adds_up { [0, 1, 2].map(|i| before[i] + new[i]) } else { new }
    }
}
