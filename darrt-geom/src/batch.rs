//! Distance of one ball to many boxes, or to many balls, at once: the first and cheapest look of the collision checker.
//!
//! They lie in blocks of [`LANES`], each coordinate of a block side by side, so that the compiler turns the loops over
//! lanes into vector instructions: those that the processor has, found out when the program runs. Multiplications and
//! additions are kept apart (no fused ones), so that every processor gives the same bits.

use crate::body_set::BodySet;
use nalgebra::{Matrix3, Vector3};
use pulp::{Arch, Simd, WithSimd};

/// Boxes per block.
pub(crate) const LANES: usize = 8;
/// Where the unused lanes of the last block lie: farther than any cap, near enough for finite squares.
const NOWHERE: f64 = 1e100;

/// A box at a pose: its centre, its axes as columns, half its edge lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedBox {
    pub(crate) centre: Vector3<f64>,
    pub(crate) axes: Matrix3<f64>,
    pub(crate) half: Vector3<f64>,
}

impl PlacedBox {
    /// Signed distance from the surface of a ball to the box: exact while the ball's centre is outside the box, and
    /// `-radius` when it is inside.
    #[inline]
    pub(crate) fn ball_distance(&self, centre: &Vector3<f64>, radius: f64) -> f64 {
        let from_box = self.axes.tr_mul(&(centre - self.centre));
        let over = (from_box.abs() - self.half).map(|x| if x > 0.0 { x } else { 0.0 });
        over.norm() - radius
    }
}

/// Centre and radius, metres.
type Ball = (Vector3<f64>, f64);

/// [`LANES`] boxes, transposed.
#[derive(Debug, Clone, Copy)]
struct Block {
    centre: [[f64; LANES]; 3],
    /// `axes[k][i]`: coordinate `i` of axis `k`.
    axes: [[[f64; LANES]; 3]; 3],
    half: [[f64; LANES]; 3],
    /// A ball around all of them.
    ball: Ball,
}

impl Block {
    const EMPTY: Self = Self {
        centre: [[NOWHERE; LANES]; 3],
        axes: [[[0.0; LANES]; 3]; 3],
        half: [[0.0; LANES]; 3],
        ball: (Vector3::new(NOWHERE, NOWHERE, NOWHERE), 0.0),
    };

    fn put(&mut self, lane: usize, placed: &PlacedBox) {
        for i in 0..3 {
            self.centre[i][lane] = placed.centre[i];
            self.half[i][lane] = placed.half[i];
            for k in 0..3 {
                self.axes[k][i][lane] = placed.axes[(i, k)];
            }
        }
    }

    /// The kernel: squared distances of a point to the boxes, 0 inside.
    #[expect(clippy::inline_always, reason = "only what is inlined is compiled for the processor at hand")]
    #[inline(always)]
    fn squared(&self, point: &Vector3<f64>) -> [f64; LANES] {
        let mut from = [[0.0; LANES]; 3];
        for (i, row) in from.iter_mut().enumerate() {
            for (lane, x) in row.iter_mut().enumerate() {
                *x = point[i] - self.centre[i][lane];
            }
        }
        let mut squared = [0.0; LANES];
        for (axis, half) in self.axes.iter().zip(&self.half) {
            for (lane, sum) in squared.iter_mut().enumerate() {
                let along =
                    axis[0][lane] * from[0][lane] + axis[1][lane] * from[1][lane] + axis[2][lane] * from[2][lane];
                let over = along.abs() - half[lane];
                // A comparison that a NaN fails would hide it, so a NaN is let through.
                let over = if over <= 0.0 { 0.0 } else { over };
                *sum += over * over;
            }
        }
        squared
    }
}

/// Blocks per group.
const FAN: usize = 8;
/// Boxes up to here are looked at in the order given: a list so short is looked through as fast as a tree of it.
const FEW: usize = 128;

/// An order of the boxes in which neighbours are near each other, [`LANES`] of them and [`FAN`] times as many and so on
/// together; that of the list itself if they are few.
pub(crate) fn by_place(boxes: &[PlacedBox]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    if boxes.len() > FEW {
        halve(&mut order, boxes);
    }
    order
}

/// Halves a list across its longest side until what is left is one block. Halves are whole blocks or groups of them, so that
/// only the last one of all is not full.
fn halve(order: &mut [usize], boxes: &[PlacedBox]) {
    if order.len() <= LANES {
        return;
    }
    let centres = || order.iter().filter_map(|&i| boxes.get(i)).map(|placed| placed.centre);
    let low = centres().fold(Vector3::repeat(f64::INFINITY), |low, centre| low.inf(&centre));
    let high = centres().fold(Vector3::repeat(f64::NEG_INFINITY), |high, centre| high.sup(&centre));
    let longest = (high - low).imax();
    order.sort_by(|&i, &j| boxes[i].centre[longest].total_cmp(&boxes[j].centre[longest]).then(i.cmp(&j)));
    let mut whole = LANES;
    while whole * FAN < order.len() {
        whole *= FAN;
    }
    let middle = (order.len() / 2).div_ceil(whole) * whole;
    let (first, second) = order.split_at_mut(middle.min(order.len()));
    if second.is_empty() {
        return;
    }
    halve(first, boxes);
    halve(second, boxes);
}

/// A ball around the balls.
fn ball_around(balls: &[Ball]) -> Ball {
    let centre = balls.iter().map(|(centre, _)| centre).sum::<Vector3<f64>>() / balls.len() as f64;
    let reach = |(other, radius): &Ball| (other - centre).norm() + radius;
    (centre, balls.iter().map(reach).fold(0.0, f64::max) * (1.0 + 1e-12))
}

/// The search of [`BoxBatch::near`], compiled for every kind of processor.
struct Near<'a> {
    levels: Option<&'a [Vec<Ball>; 2]>,
    blocks: &'a [Block],
    point: &'a Vector3<f64>,
    reach: f64,
    out: &'a mut Vec<NearBox>,
}

impl WithSimd for Near<'_> {
    type Output = ();

    #[expect(clippy::inline_always, reason = "only what is inlined is compiled for the processor at hand")]
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { levels, blocks, point, reach, out } = self;
        let Some([groups, wholes]) = levels else {
            for (number, block) in blocks.iter().enumerate() {
                look(block, number, point, reach, out);
            }
            return;
        };
        for (whole, _) in wholes.iter().enumerate().filter(|(_, ball)| reaches(ball, point, reach)) {
            let of_whole = (whole * FAN..).zip(groups.iter().skip(whole * FAN).take(FAN));
            for (group, _) in of_whole.filter(|(_, ball)| reaches(ball, point, reach)) {
                for (number, block) in (group * FAN..).zip(blocks.iter().skip(group * FAN).take(FAN)) {
                    look(block, number, point, reach, out);
                }
            }
        }
    }
}

/// Is something of the ball as near to the point as `reach`?
#[expect(clippy::inline_always, reason = "only what is inlined is compiled for the processor at hand")]
#[inline(always)]
fn reaches((centre, radius): &Ball, point: &Vector3<f64>, reach: f64) -> bool {
    let apart = reach + radius;
    // Written so that a NaN is near.
    let is_far = (point - centre).norm_squared() > apart * apart;
    !is_far
}

/// Looks at the boxes of a block.
#[expect(clippy::inline_always, reason = "only what is inlined is compiled for the processor at hand")]
#[inline(always)]
fn look(block: &Block, number: usize, point: &Vector3<f64>, reach: f64, out: &mut Vec<NearBox>) {
    // OPTIMIZATION: what stands together is registered together, and mostly it is far away together.
    if !reaches(&block.ball, point, reach) {
        return;
    }
    let limit = reach * reach;
    let squared = block.squared(point);
    // Written so that a NaN is near.
    let nearest = squared.iter().fold(f64::INFINITY, |least, s| if *s >= least { least } else { *s });
    if nearest >= limit {
        return;
    }
    for (lane, squared) in squared.into_iter().enumerate() {
        let is_far = squared >= limit;
        if !is_far {
            out.push(NearBox { index: number * LANES + lane, distance: squared.sqrt() });
        }
    }
}

/// A box near a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NearBox {
    /// Its place in the batch.
    pub(crate) index: usize,
    /// From the point to the box, metres; 0 inside.
    pub(crate) distance: f64,
}

/// Boxes that stay where they are.
#[derive(Debug, Clone, Default)]
pub(crate) struct BoxBatch {
    blocks: Vec<Block>,
    /// Balls around [`FAN`] blocks each, and around [`FAN`] of those balls; neither for few boxes.
    levels: Option<[Vec<Ball>; 2]>,
}

impl BoxBatch {
    /// The given boxes, in order.
    pub(crate) fn new(boxes: &[PlacedBox]) -> Self {
        let blocks: Vec<Block> = boxes
            .chunks(LANES)
            .map(|chunk| {
                let mut block = Block::EMPTY;
                chunk.iter().enumerate().for_each(|(lane, placed)| block.put(lane, placed));
                block.ball =
                    ball_around(&chunk.iter().map(|placed| (placed.centre, placed.half.norm())).collect::<Vec<_>>());
                // Unused lanes: identity axes, so that the far centre counts.
                for lane in chunk.len()..LANES {
                    for k in 0..3 {
                        block.axes[k][k][lane] = 1.0;
                    }
                }
                block
            })
            .collect();
        let levels = (boxes.len() > FEW).then(|| {
            let balls: Vec<_> = blocks.iter().map(|block| block.ball).collect();
            let groups: Vec<_> = balls.chunks(FAN).map(ball_around).collect();
            let wholes = groups.chunks(FAN).map(ball_around).collect();
            [groups, wholes]
        });
        Self { blocks, levels }
    }

    /// Writes into `out` the boxes nearer to a point than `reach` metres (not negative), in order.
    pub(crate) fn near(&self, point: &Vector3<f64>, reach: f64, out: &mut Vec<NearBox>) {
        out.clear();
        Arch::new().dispatch(Near { levels: self.levels.as_ref(), blocks: &self.blocks, point, reach, out });
    }
}

/// [`LANES`] balls, transposed.
#[derive(Debug, Clone, Copy)]
struct Balls {
    centre: [[f64; LANES]; 3],
    radius: [f64; LANES],
}

/// Balls that move, by body: where each of them is, side by side.
#[derive(Debug, Clone, Default)]
pub(crate) struct BallBatch {
    blocks: Vec<Balls>,
}

impl BallBatch {
    /// As many balls as there are radii in metres, farther than any other until they are put somewhere.
    pub(crate) fn new(radii: &[f64]) -> Self {
        let block = |chunk: &[f64]| {
            let mut block = Balls { centre: [[NOWHERE; LANES]; 3], radius: [0.0; LANES] };
            block.radius.iter_mut().zip(chunk).for_each(|(slot, radius)| *slot = *radius);
            block
        };
        Self { blocks: radii.chunks(LANES).map(block).collect() }
    }

    /// Puts a ball somewhere.
    #[inline]
    pub(crate) fn put(&mut self, index: usize, centre: &Vector3<f64>) {
        if let Some(block) = self.blocks.get_mut(index / LANES) {
            let lane = index % LANES;
            block.centre.iter_mut().zip(centre.iter()).for_each(|(row, x)| row[lane] = *x);
        }
    }

    /// Where the centre of a ball is.
    #[inline]
    pub(crate) fn centre(&self, index: usize) -> Vector3<f64> {
        let block = self.blocks.get(index / LANES);
        block.map_or_else(|| Vector3::repeat(NOWHERE), |block| block.centre.map(|row| row[index % LANES]).into())
    }

    /// Of the `wanted` balls those of which some point is nearer to a point than `reach` metres (not negative).
    #[inline]
    pub(crate) fn near(&self, wanted: &BodySet, point: &Vector3<f64>, reach: f64) -> BodySet {
        Arch::new().dispatch(NearBalls { blocks: &self.blocks, wanted, point, reach })
    }
}

/// The search of [`BallBatch::near`], compiled for every kind of processor.
struct NearBalls<'a> {
    blocks: &'a [Balls],
    wanted: &'a BodySet,
    point: &'a Vector3<f64>,
    reach: f64,
}

impl WithSimd for NearBalls<'_> {
    type Output = BodySet;

    #[expect(clippy::inline_always, reason = "only what is inlined is compiled for the processor at hand")]
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> BodySet {
        let mut near = BodySet::EMPTY;
        for (number, block) in self.blocks.iter().enumerate() {
            let wanted = self.wanted.eight(number);
            if wanted == 0 {
                continue;
            }
            let mut squared = [0.0; LANES];
            for (row, at) in block.centre.iter().zip(self.point.iter()) {
                for (sum, x) in squared.iter_mut().zip(row) {
                    *sum += (at - x) * (at - x);
                }
            }
            let mut bits = 0_u8;
            for (lane, (squared, radius)) in squared.iter().zip(&block.radius).enumerate() {
                let limit = self.reach + radius;
                // Written so that a NaN is near.
                let is_far = *squared >= limit * limit;
                bits |= u8::from(!is_far) << lane;
            }
            near.insert_eight(number, bits & wanted);
        }
        near
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body_set::BodyIndex;
    use nalgebra::UnitQuaternion;
    use proptest::prelude::*;

    fn placed() -> impl Strategy<Value = PlacedBox> {
        (
            prop::array::uniform3(-2.0_f64..2.0),
            prop::array::uniform3(-3.0_f64..3.0),
            prop::array::uniform3(0.01_f64..1.0),
        )
            .prop_map(|(centre, turn, half)| PlacedBox {
                centre: Vector3::from(centre),
                axes: UnitQuaternion::from_scaled_axis(Vector3::from(turn)).to_rotation_matrix().into_inner(),
                half: Vector3::from(half),
            })
    }

    proptest! {
        #[test]
        fn the_batch_says_what_each_box_says(
            boxes in prop_oneof![prop::collection::vec(placed(), 0..19), prop::collection::vec(placed(), 129..700)], at in prop::array::uniform3(-3.0_f64..3.0), reach in 0.0_f64..3.0,
        ) {
            let at = Vector3::from(at);
            let mut out = vec![NearBox { index: 7, distance: 7.0 }];
            let order = by_place(&boxes);
            prop_assert!(boxes.len() > FEW || order.is_sorted());
            let boxes: Vec<_> = order.iter().map(|i| boxes[*i]).collect();
            BoxBatch::new(&boxes).near(&at, reach, &mut out);
            let near = boxes.iter().map(|placed| placed.ball_distance(&at, 0.0)).enumerate().filter(|(_, d)| *d < reach);
            let near: Vec<_> = near.collect();
            prop_assert_eq!(out.len(), near.len());
            for ((index, expected), found) in near.into_iter().zip(out) {
                prop_assert_eq!(index, found.index);
                prop_assert!((expected - found.distance).abs() < 1e-12);
            }
        }

        #[test]
        fn balls_are_found_as_one_by_one(
            balls in prop::collection::vec((prop::array::uniform3(-2.0_f64..2.0), 0.0_f64..0.5), 0..70),
            at in prop::array::uniform3(-2.0_f64..2.0), reach in 0.0_f64..2.0,
        ) {
            let at = Vector3::from(at);
            let radii: Vec<f64> = balls.iter().map(|(_, radius)| *radius).collect();
            let mut batch = BallBatch::new(&radii);
            prop_assert!(batch.near(&BodySet::ALL, &at, reach).is_empty());
            balls.iter().enumerate().for_each(|(i, (centre, _))| batch.put(i, &Vector3::from(*centre)));
            let near = batch.near(&BodySet::ALL, &at, reach);
            let wanted: BodySet = (0..70).step_by(3).map(BodyIndex::new).collect();
            prop_assert_eq!(batch.near(&wanted, &at, reach), near.intersection(&wanted));
            for ((centre, radius), i) in balls.iter().zip(0_u16..) {
                let gap = (Vector3::from(*centre) - at).norm() - radius - reach;
                prop_assert!(gap.abs() < 1e-12 || near.contains(BodyIndex::new(i)) == (gap < 0.0));
            }
            prop_assert!(near.iter().all(|i| i.get() < balls.len()));
        }

        #[test]
        fn the_distance_is_that_of_the_nearest_point(placed in placed(), at in prop::array::uniform3(-3.0_f64..3.0)) {
            let at = Vector3::from(at);
            let distance = placed.ball_distance(&at, 0.0);
            for i in 0..8 {
                let sign = Vector3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0 - Vector3::repeat(1.0);
                let corner = placed.centre + placed.axes * placed.half.component_mul(&sign);
                prop_assert!((corner - at).norm() >= distance - 1e-12);
            }
            let local = placed.axes.tr_mul(&(at - placed.centre));
            let nearest = placed.centre + placed.axes * local.sup(&-placed.half).inf(&placed.half);
            prop_assert!(((nearest - at).norm() - distance).abs() < 1e-12);
        }
    }
}
