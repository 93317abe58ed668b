//! Forward kinematics of many configurations at once, for any tree, without allocation.
//!
//! [`LANES`] configurations stand side by side: one row per variable goes in, and per link three axes and an origin come
//! out, each coordinate a row. At set-up the tree becomes a list of steps in which everything constant is done: links
//! that are fixed are folded into what hangs on them, unless their poses are asked for, and a turn about a coordinate
//! axis of its link costs two columns instead of a product of matrices.

#![expect(clippy::inline_always, reason = "only what is inlined is compiled for the processor at hand")]

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use pulp::{Arch, Simd, WithSimd};

use super::lanes::{LANES, Lanes, Row, registers};
use super::tree::{Drive, KinematicTree, KinematicsError, LinkMotion, expect_length};

/// [`LANES`] poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseLanes {
    /// `axes[k][i]`: coordinate `i` of axis `k` of the link, unit.
    pub axes: [[Row; 3]; 3],
    /// Coordinates of the link's origin, m.
    pub origin: [Row; 3],
}

impl PoseLanes {
    /// The same pose in every lane.
    pub fn splat(pose: &Isometry3<f64>) -> Self {
        let rotation = pose.rotation.to_rotation_matrix().into_inner();
        Self {
            axes: std::array::from_fn(|k| std::array::from_fn(|i| Row::splat(rotation[(i, k)]))),
            origin: std::array::from_fn(|i| Row::splat(pose.translation.vector[i])),
        }
    }

    /// The pose of one lane, `None` beyond [`LANES`].
    pub fn pose(&self, lane: usize) -> Option<Isometry3<f64>> {
        if lane >= LANES {
            return None;
        }
        let rotation = Matrix3::from_fn(|i, k| self.axes[k][i].0[lane]);
        // Products of rotations are rotations up to rounding.
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
        let origin = Vector3::from_fn(|i, _| self.origin[i].0[lane]);
        Some(Isometry3::from_parts(Translation3::from(origin), rotation))
    }
}

/// Poses of the links of a batch, and the memory for them; from [`BatchForward::poses`].
#[derive(Debug, Clone)]
pub struct BatchPoses {
    /// Sine and cosine of every turn.
    turns: Vec<[Row; 2]>,
    /// The root and then one per step.
    frames: Vec<PoseLanes>,
    frame_of_link: Vec<Option<usize>>,
}

impl BatchPoses {
    /// World poses of a link; `None` if they were not asked for at set-up.
    pub fn link(&self, link: usize) -> Option<&PoseLanes> {
        self.frames.get((*self.frame_of_link.get(link)?)?)
    }
}

/// How a link moves against its parent: constants in the order in which they are used.
#[derive(Debug, Clone, Copy)]
enum Joint {
    /// Not at all.
    Fixed,
    /// About a coordinate axis of the link.
    TurnAbout { axis: usize, turn: usize },
    /// About any axis: `parent_from_link = still + sine * with_sine + cosine * with_cosine`.
    Turn { still: [[f64; 3]; 3], with_sine: [[f64; 3]; 3], with_cosine: [[f64; 3]; 3], turn: usize },
    /// Along a direction in the parent's frame.
    Slide { direction: [f64; 3], drive: Drive },
}

/// A link that is written.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// Frame of the parent.
    parent: usize,
    /// From the parent's origin, in its axes, m.
    offset: [f64; 3],
    /// Columns of the constant rotation before the joint, where there is one and the joint has not taken it in.
    turned: Option<[[f64; 3]; 3]>,
    joint: Joint,
}

/// Forward kinematics of a tree, [`LANES`] configurations at a time.
///
/// # Laws
/// Every pose is that of [`KinematicTree::forward`], up to rounding (1e-14 per metre and step), and has the same bits on
/// every processor.
#[derive(Debug, Clone)]
pub struct BatchForward {
    steps: Vec<Step>,
    turns: Vec<Drive>,
    variables: usize,
    frame_of_link: Vec<Option<usize>>,
}

impl BatchForward {
    /// The poses of all links of `tree`.
    pub fn new(tree: &KinematicTree) -> Self {
        Self::where_asked(tree, &vec![true; tree.link_count()])
    }

    /// The poses of some links only, by their indices in `tree`.
    ///
    /// # Errors
    /// [`KinematicsError::UnknownLink`] for an index that does not exist, by its number.
    pub fn for_links(tree: &KinematicTree, links: &[usize]) -> Result<Self, KinematicsError> {
        let mut asked = vec![false; tree.link_count()];
        for link in links {
            let unknown = || KinematicsError::UnknownLink { name: format!("number {link}") };
            *asked.get_mut(*link).ok_or_else(unknown)? = true;
        }
        Ok(Self::where_asked(tree, &asked))
    }

    fn where_asked(tree: &KinematicTree, asked: &[bool]) -> Self {
        // A link is needed if it or something below it is asked for.
        let mut needed = asked.to_vec();
        for link in (1..needed.len()).rev() {
            if let Some(parent) = tree.parent(link).filter(|_| needed[link]) {
                needed[parent] = true;
            }
        }
        let count = tree.variables().len();
        let mut this = Self { steps: Vec::new(), turns: Vec::new(), variables: count, frame_of_link: Vec::new() };
        // By link: the frame it hangs on, and its pose there; a frame of its own has the identity.
        let mut places: Vec<(usize, Isometry3<f64>)> = Vec::with_capacity(needed.len());
        for link in 0..needed.len() {
            let place = match (tree.parent(link), tree.motion(link), tree.parent_from_link(link)) {
                (Some(parent), Some(motion), Some(parent_from_link)) if needed[link] => {
                    let (frame, frame_from_parent) = places[parent];
                    let frame_from_link = frame_from_parent * parent_from_link;
                    let is_fixed = matches!(motion, LinkMotion::Fixed);
                    if is_fixed && (!asked[link] || frame_from_link == Isometry3::identity()) {
                        (frame, frame_from_link)
                    } else {
                        (this.add(frame, &frame_from_link, motion), Isometry3::identity())
                    }
                }
                _ => (0, Isometry3::identity()),
            };
            this.frame_of_link.push(asked[link].then_some(place.0));
            places.push(place);
        }
        this
    }

    /// Adds a step; returns its frame.
    fn add(&mut self, parent: usize, parent_from_link: &Isometry3<f64>, motion: &LinkMotion) -> usize {
        let rotation = parent_from_link.rotation.to_rotation_matrix().into_inner();
        let is_turned = parent_from_link.rotation != UnitQuaternion::identity();
        let mut turned = is_turned.then(|| columns(&rotation));
        let joint = match motion {
            LinkMotion::Fixed => Joint::Fixed,
            LinkMotion::Sliding { axis, drive } => {
                Joint::Slide { direction: (rotation * axis.into_inner()).into(), drive: *drive }
            }
            LinkMotion::Turning { axis, drive } => {
                if let Some(along) = axis.iter().position(|x| x.abs() == 1.0) {
                    let sign = axis[along];
                    let Drive { variable, multiplier, offset } = *drive;
                    let turn = self.turn(Drive { variable, multiplier: sign * multiplier, offset: sign * offset });
                    Joint::TurnAbout { axis: along, turn }
                } else {
                    turned = None;
                    let along = axis.into_inner();
                    let still = along * along.transpose();
                    Joint::Turn {
                        still: columns(&(rotation * still)),
                        with_sine: columns(&(rotation * along.cross_matrix())),
                        with_cosine: columns(&(rotation * (Matrix3::identity() - still))),
                        turn: self.turn(*drive),
                    }
                }
            }
        };
        self.steps.push(Step { parent, offset: parent_from_link.translation.vector.into(), turned, joint });
        self.steps.len()
    }

    /// The number of a turn by this angle.
    fn turn(&mut self, drive: Drive) -> usize {
        let known = self.turns.iter().position(|turn| *turn == drive);
        known.unwrap_or_else(|| {
            self.turns.push(drive);
            self.turns.len() - 1
        })
    }

    /// Memory for the poses of a batch.
    pub fn poses(&self) -> BatchPoses {
        BatchPoses {
            turns: vec![[Row::splat(0.0); 2]; self.turns.len()],
            frames: vec![PoseLanes::splat(&Isometry3::identity()); self.steps.len() + 1],
            frame_of_link: self.frame_of_link.clone(),
        }
    }

    /// Writes the world poses of the links asked for at set-up.
    ///
    /// `joint_values`: one row per variable of the tree (rad or m); those that move nothing asked for are not read.
    /// Angles beyond [`LARGEST_ANGLE`](super::lanes::LARGEST_ANGLE) give poses of NaN. `world_from_root`: poses of the
    /// root. `out`: from [`poses`](Self::poses). Does not allocate.
    ///
    /// # Errors
    /// [`KinematicsError::Length`] when `joint_values` has the wrong length or `out` belongs to another tree; nothing is
    /// written then.
    pub fn forward(
        &self,
        joint_values: &[Row],
        world_from_root: &PoseLanes,
        out: &mut BatchPoses,
    ) -> Result<(), KinematicsError> {
        Arch::new().dispatch(self.run(joint_values, world_from_root, out)?);
        Ok(())
    }

    fn run<'a>(
        &'a self,
        joint_values: &'a [Row],
        world_from_root: &'a PoseLanes,
        out: &'a mut BatchPoses,
    ) -> Result<Run<'a>, KinematicsError> {
        expect_length("joint_values", joint_values.len(), self.variables)?;
        expect_length("out", out.frames.len(), self.steps.len() + 1)?;
        expect_length("out", out.turns.len(), self.turns.len())?;
        Ok(Run { program: self, joint_values, world_from_root, out })
    }
}

fn columns(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    std::array::from_fn(|k| std::array::from_fn(|i| matrix[(i, k)]))
}

/// One call of [`BatchForward::forward`], compiled for every kind of processor.
struct Run<'a> {
    program: &'a BatchForward,
    joint_values: &'a [Row],
    world_from_root: &'a PoseLanes,
    out: &'a mut BatchPoses,
}

impl WithSimd for Run<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { program, joint_values, world_from_root, out } = self;
        // All sines first: two angles at a time do not wait for each other.
        for (drives, rows) in program.turns.chunks(2).zip(out.turns.chunks_mut(2)) {
            for register in 0..registers::<S>() {
                match (drives, &mut *rows) {
                    ([first, second], [of_first, of_second]) => {
                        let second = value(simd, second, joint_values, register);
                        let (sine, cosine) = value(simd, first, joint_values, register).beside(second).sin_cos();
                        let ([sine, other_sine], [cosine, other_cosine]) = (sine.apart(), cosine.apart());
                        store2([sine, cosine], of_first, register);
                        store2([other_sine, other_cosine], of_second, register);
                    }
                    ([last], [of_last]) => {
                        let (sine, cosine) = value(simd, last, joint_values, register).sin_cos();
                        store2([sine, cosine], of_last, register);
                    }
                    _ => {}
                }
            }
        }
        if let Some(root) = out.frames.first_mut() {
            *root = *world_from_root;
        }
        for register in 0..registers::<S>() {
            let mut frame = Frame::load(simd, world_from_root, register);
            for (at, step) in program.steps.iter().enumerate() {
                // OPTIMIZATION: along a chain the parent is the frame at hand.
                if step.parent != at {
                    frame = Frame::load(simd, &out.frames[step.parent], register);
                }
                frame = match &step.joint {
                    Joint::Fixed => frame.shifted(&step.offset).turned(step.turned.as_ref()),
                    Joint::TurnAbout { axis, turn } => {
                        let sine_cosine = load2(simd, &out.turns[*turn], register);
                        frame.shifted(&step.offset).turned(step.turned.as_ref()).turned_about(*axis, sine_cosine)
                    }
                    Joint::Turn { still, with_sine, with_cosine, turn } => {
                        let [sine, cosine] = load2(simd, &out.turns[*turn], register);
                        let frame = frame.shifted(&step.offset);
                        let x = frame.mixed(column(sine, &with_sine[0], cosine, &with_cosine[0], &still[0]));
                        let y = frame.mixed(column(sine, &with_sine[1], cosine, &with_cosine[1], &still[1]));
                        let z = frame.mixed(column(sine, &with_sine[2], cosine, &with_cosine[2], &still[2]));
                        Frame { axes: [x, y, z], ..frame }
                    }
                    Joint::Slide { direction: [x, y, z], drive } => {
                        let length = value(simd, drive, joint_values, register);
                        let [i, j, k] = step.offset;
                        frame.moved([length * *x + i, length * *y + j, length * *z + k]).turned(step.turned.as_ref())
                    }
                };
                frame.store(&mut out.frames[at + 1], register);
            }
        }
    }
}

// In what follows no closure is called and no array mapped: they would not be compiled for the processor at hand.

/// The value of a driven joint.
#[inline(always)]
fn value<S: Simd>(simd: S, drive: &Drive, joint_values: &[Row], register: usize) -> Lanes<S> {
    Lanes::load(simd, &joint_values[drive.variable], register) * drive.multiplier + drive.offset
}

#[inline(always)]
fn store2<S: Simd>([a, b]: [Lanes<S>; 2], rows: &mut [Row; 2], register: usize) {
    a.store(&mut rows[0], register);
    b.store(&mut rows[1], register);
}

#[inline(always)]
fn load2<S: Simd>(simd: S, [a, b]: &[Row; 2], register: usize) -> [Lanes<S>; 2] {
    [Lanes::load(simd, a, register), Lanes::load(simd, b, register)]
}

#[inline(always)]
fn load3<S: Simd>(simd: S, [a, b, c]: &[Row; 3], register: usize) -> Vector<S> {
    [Lanes::load(simd, a, register), Lanes::load(simd, b, register), Lanes::load(simd, c, register)]
}

/// `a * by + b * other`.
#[inline(always)]
fn sum<S: Simd>(a: Vector<S>, by: Lanes<S>, b: Vector<S>, other: Lanes<S>) -> Vector<S> {
    [a[0] * by + b[0] * other, a[1] * by + b[1] * other, a[2] * by + b[2] * other]
}

/// `sum + a * by`.
#[inline(always)]
fn plus<S: Simd>(sum: Vector<S>, a: Vector<S>, by: Lanes<S>) -> Vector<S> {
    [sum[0] + a[0] * by, sum[1] + a[1] * by, sum[2] + a[2] * by]
}

/// A column of a rotation by an angle about a constant axis.
#[inline(always)]
fn column<S: Simd>(sine: Lanes<S>, s: &[f64; 3], cosine: Lanes<S>, c: &[f64; 3], still: &[f64; 3]) -> Vector<S> {
    [
        sine * s[0] + cosine * c[0] + still[0],
        sine * s[1] + cosine * c[1] + still[1],
        sine * s[2] + cosine * c[2] + still[2],
    ]
}

type Vector<S> = [Lanes<S>; 3];

/// Poses in one register.
#[derive(Debug, Clone, Copy)]
struct Frame<S: Simd> {
    axes: [Vector<S>; 3],
    origin: Vector<S>,
}

impl<S: Simd> Frame<S> {
    #[inline(always)]
    fn load(simd: S, PoseLanes { axes: [x, y, z], origin }: &PoseLanes, register: usize) -> Self {
        let axes = [load3(simd, x, register), load3(simd, y, register), load3(simd, z, register)];
        Self { axes, origin: load3(simd, origin, register) }
    }

    #[inline(always)]
    fn store(&self, poses: &mut PoseLanes, register: usize) {
        for k in 0..3 {
            for i in 0..3 {
                self.axes[k][i].store(&mut poses.axes[k][i], register);
            }
            self.origin[k].store(&mut poses.origin[k], register);
        }
    }

    /// Moved by a constant in its own axes.
    #[inline(always)]
    fn shifted(self, [x, y, z]: &[f64; 3]) -> Self {
        self.shifted_along(0, *x).shifted_along(1, *y).shifted_along(2, *z)
    }

    #[inline(always)]
    fn shifted_along(mut self, axis: usize, by: f64) -> Self {
        // OPTIMIZATION: most offsets lie along one axis.
        if by != 0.0 {
            self.origin = plus(self.origin, self.axes[axis], Lanes::splat(self.origin[0].simd(), by));
        }
        self
    }

    /// Moved in its own axes.
    #[inline(always)]
    fn moved(self, by: Vector<S>) -> Self {
        let [x, y, z] = self.axes;
        Self { origin: plus(plus(plus(self.origin, x, by[0]), y, by[1]), z, by[2]), ..self }
    }

    /// The direction with these coordinates in its own axes.
    #[inline(always)]
    fn mixed(&self, by: Vector<S>) -> Vector<S> {
        let [x, y, z] = self.axes;
        plus(sum(x, by[0], y, by[1]), z, by[2])
    }

    /// Turned by a constant.
    #[inline(always)]
    fn turned(self, rotation: Option<&[[f64; 3]; 3]>) -> Self {
        let Some([x, y, z]) = rotation else { return self };
        let simd = self.origin[0].simd();
        let x = self.mixed([Lanes::splat(simd, x[0]), Lanes::splat(simd, x[1]), Lanes::splat(simd, x[2])]);
        let y = self.mixed([Lanes::splat(simd, y[0]), Lanes::splat(simd, y[1]), Lanes::splat(simd, y[2])]);
        let z = self.mixed([Lanes::splat(simd, z[0]), Lanes::splat(simd, z[1]), Lanes::splat(simd, z[2])]);
        Self { axes: [x, y, z], ..self }
    }

    /// Turned about one of its own axes.
    #[inline(always)]
    fn turned_about(self, axis: usize, [sine, cosine]: [Lanes<S>; 2]) -> Self {
        let [x, y, z] = self.axes;
        let axes = match axis {
            0 => [x, sum(y, cosine, z, sine), sum(z, cosine, y, -sine)],
            1 => [sum(x, cosine, z, -sine), y, sum(z, cosine, x, sine)],
            _ => [sum(x, cosine, y, sine), sum(y, cosine, x, -sine), z],
        };
        Self { axes, ..self }
    }
}

#[cfg(test)]
mod tests;
