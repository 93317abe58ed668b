//! What truly happened in one execution, to be looked at beside what was planned.

use nalgebra::Isometry3;

/// Between two frames, s.
pub const FRAME_S: f64 = 0.05;

/// One execution, frame by frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// In the order of time.
    pub frames: Vec<Frame>,
    /// The steps as they were executed: also those of plans made on the way, and ways back.
    pub steps: Vec<RecordedStep>,
    /// When the robot looked, seconds.
    pub looks_s: Vec<f64>,
}

/// A step of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedStep {
    /// The plan: 0 is the one that was to be executed, 1 the first that was made on the way.
    pub plan: usize,
    /// The step in it, from 1.
    pub step: usize,
    /// Its primitive.
    pub primitive: String,
    /// When it began, seconds.
    pub begin_s: f64,
}

/// Where everything truly is at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Seconds from the beginning.
    pub time_s: f64,
    /// x, y (m) and yaw (rad) of the robot's root.
    pub base: [f64; 3],
    /// By variable of the robot's tree.
    pub joints: Vec<f64>,
    /// By object.
    pub objects: Vec<Isometry3<f64>>,
    /// By object: where the plan has it now.
    pub planned: Vec<Isometry3<f64>>,
}

impl Recording {
    /// The frames of a step: from the one with which it begins to the one with which the next begins.
    pub fn frames_of(&self, step: usize) -> &[Frame] {
        let at = |step: usize| {
            let begin_s = self.steps.get(step).map_or(f64::INFINITY, |step| step.begin_s);
            self.frames.partition_point(|frame| frame.time_s < begin_s)
        };
        let (from, to) = (at(step), (at(step + 1) + 1).min(self.frames.len()));
        self.frames.get(from.min(to)..to).unwrap_or_default()
    }
}
