//! Bounds on the distance from many nodes at once: flat copies of the few numbers that a distance depends on.
//!
//! A node is 200 bytes and more, a distance reads a handful of numbers of it. Those are copied here in single precision,
//! coordinate by coordinate in blocks of [`LANES`] nodes, so that one pass over a block bounds all of its nodes. Blocks have
//! boxes around them, boxes have boxes around them, [`LANES`] to one; a query opens the box of the least bound first and
//! looks at a node itself only where its own bound does not rule it out. Whatever is rounded is allowed for, so the answer
//! is that of the linear scan, ties and all.
//!
//! Nodes come in the order of insertion, which follows the paths of the extensions. Every [`SORT_EVERY`] nodes the last of
//! them are sorted into compact blocks, every eighth time eight times as many, and so on: a node is sorted `log8 n` times.

use super::bounds::{LANES, Lanes};

/// How many nodes come between two sorts; a power of [`LANES`].
const SORT_EVERY: usize = LANES * LANES;
/// How many sorted stretches become one.
const MERGE: usize = 8;
/// Larger coordinates than this, metres, could overflow when squared; such nodes are always looked at.
pub(super) const LARGEST_M: f64 = 1e12;
/// Most samples that decide along which coordinate a stretch is split.
const SPLIT_SAMPLES: usize = 128;

/// The items of one level: nodes, or boxes around [`LANES`] items of the level below.
#[derive(Debug, Default)]
struct Level {
    len: usize,
    /// `[block][coordinate][lane]`; of nodes, the coordinates themselves.
    lower: Vec<Lanes>,
    /// As `lower`; empty at the level of the nodes.
    upper: Vec<Lanes>,
    /// By item: metres that every node of the box is penalised by at least; empty at the level of the nodes.
    penalties_m: Vec<f32>,
}

/// The index of one tree.
#[derive(Debug)]
pub(crate) struct CoordinateIndex {
    /// Coordinates per node.
    width: usize,
    levels: Vec<Level>,
    /// By slot of the lowest level: the node there.
    nodes: Vec<u32>,
    /// By slot: the placement of the node there.
    placements: Vec<u32>,
    /// By node: its slot.
    slots: Vec<u32>,
    /// Nodes with coordinates that bound nothing.
    odd: Vec<u32>,
    /// The largest coordinate, metres.
    scale_m: f64,
}

/// Appends without the half empty capacity of a doubling vector: at a million nodes that would be most of the memory.
pub(crate) fn push_frugally<T>(list: &mut Vec<T>, item: T) {
    if list.len() == list.capacity() {
        list.reserve_exact((list.len() / 16).max(64));
    }
    list.push(item);
}

fn index(at: usize) -> u32 {
    // The tree refuses more than u32::MAX nodes.
    u32::try_from(at).unwrap_or(u32::MAX)
}

impl CoordinateIndex {
    /// An empty index for nodes of `width` coordinates.
    pub(crate) fn new(width: usize) -> Self {
        Self {
            width,
            levels: vec![Level::default()],
            nodes: Vec::new(),
            placements: Vec::new(),
            slots: Vec::new(),
            odd: Vec::new(),
            scale_m: 0.0,
        }
    }

    /// How many levels.
    pub(crate) fn height(&self) -> usize {
        self.levels.len()
    }

    /// The nodes that are always to be looked at.
    pub(crate) fn odd(&self) -> &[u32] {
        &self.odd
    }

    /// The largest coordinate, metres.
    pub(crate) fn scale_m(&self) -> f64 {
        self.scale_m
    }

    /// Lower and upper coordinates of the boxes of one block; of nodes, the coordinates alone.
    #[inline]
    pub(crate) fn block(&self, level: usize, block: usize) -> Option<(&[Lanes], Option<&[Lanes]>)> {
        let range = block * self.width..(block + 1) * self.width;
        let level = self.levels.get(level)?;
        let lower = level.lower.get(range.clone())?;
        Some((lower, if level.upper.is_empty() { None } else { Some(level.upper.get(range)?) }))
    }

    /// The penalties of the boxes of one block; empty for nodes.
    #[inline]
    pub(crate) fn penalties_m(&self, level: usize, block: usize) -> &[f32] {
        let Some(level) = self.levels.get(level) else { return &[] };
        let end = level.penalties_m.len().min((block + 1) * LANES);
        level.penalties_m.get(block * LANES..end).unwrap_or_default()
    }

    /// The nodes of one block, and their placements.
    #[inline]
    pub(crate) fn nodes(&self, block: usize) -> (&[u32], &[u32]) {
        let end = self.nodes.len().min((block + 1) * LANES);
        let of_block = |all| <[u32]>::get(all, block * LANES..end).unwrap_or_default();
        (of_block(&self.nodes), of_block(&self.placements))
    }

    /// Adds the next node. `penalties_m` are those of all placements.
    pub(crate) fn push(&mut self, coordinates: &[f64], placement: u32, penalties_m: &[f64]) {
        let slot = self.nodes.len();
        if slot > 0 && slot.is_multiple_of(SORT_EVERY) {
            let mut count = SORT_EVERY;
            let mut stretches = slot / SORT_EVERY;
            while stretches.is_multiple_of(MERGE) {
                stretches /= MERGE;
                count *= MERGE;
            }
            self.sort(slot - count, penalties_m);
        }
        push_frugally(&mut self.nodes, index(slot));
        push_frugally(&mut self.placements, placement);
        push_frugally(&mut self.slots, index(slot));
        let is_plain = coordinates.iter().all(|x| x.abs() <= LARGEST_M);
        if !is_plain {
            self.odd.push(index(slot));
        }
        let width = self.width;
        if let Some(level) = self.levels.first_mut() {
            if slot.is_multiple_of(LANES) {
                (0..width).for_each(|_| push_frugally(&mut level.lower, [f32::NAN; LANES]));
            }
            level.len += 1;
            let rows = level.lower.iter_mut().skip(slot / LANES * width);
            for (row, x) in rows.zip(coordinates) {
                if is_plain {
                    row[slot % LANES] = narrow(*x);
                    self.scale_m = self.scale_m.max(x.abs());
                }
            }
        }
        self.grow_levels();
        self.widen(slot, penalty_of(placement, penalties_m));
    }

    /// Takes back the node that was added last.
    pub(crate) fn pop(&mut self, penalties_m: &[f64]) {
        let (Some(slot), Some(last)) = (self.slots.pop(), self.nodes.len().checked_sub(1)) else { return };
        let (slot, removed) = (slot as usize, index(self.slots.len()));
        self.odd.retain(|node| *node != removed);
        if slot != last {
            self.swap(slot, last);
            let penalty_m = self.placements.get(slot).map_or(0.0, |p| penalty_of(*p, penalties_m));
            self.widen(slot, penalty_m);
        }
        self.nodes.pop();
        self.placements.pop();
        // The boxes stay: too large is not wrong. Their number is that of the level below.
        let mut len = last;
        for (height, level) in self.levels.iter_mut().enumerate() {
            level.len = len;
            level.lower.truncate(len.div_ceil(LANES) * self.width);
            if height > 0 {
                level.upper.truncate(len.div_ceil(LANES) * self.width);
                level.penalties_m.truncate(len);
            }
            len = len.div_ceil(LANES);
        }
    }

    /// Tells that the penalty of the placement of `node` has grown.
    pub(crate) fn refresh_penalty(&mut self, node: usize, penalties_m: &[f64]) {
        let Some(slot) = self.slots.get(node) else { return };
        let mut item = *slot as usize / LANES;
        for height in 1..self.levels.len() {
            self.set_penalty(height, item, penalties_m);
            item /= LANES;
        }
    }

    /// The block of a node, to see whether two nodes share one.
    pub(crate) fn block_of(&self, node: usize) -> Option<usize> {
        self.slots.get(node).map(|slot| *slot as usize / LANES)
    }

    fn set_penalty(&mut self, height: usize, item: usize, penalties_m: &[f64]) {
        let least = if height == 1 {
            let all = self.placements.iter().skip(item * LANES).take(LANES);
            all.map(|p| penalty_of(*p, penalties_m)).fold(f32::INFINITY, f32::min)
        } else {
            self.penalties_m(height - 1, item).iter().copied().fold(f32::INFINITY, f32::min)
        };
        if let Some(slot) = self.levels.get_mut(height).and_then(|level| level.penalties_m.get_mut(item)) {
            *slot = least;
        }
    }

    /// Adds empty boxes, and levels of them, until everything has a box around it and the top is one block.
    fn grow_levels(&mut self) {
        let width = self.width;
        let mut height = 0;
        while let Some(below) = self.levels.get(height).map(|level| level.len) {
            height += 1;
            if below <= LANES && height == self.levels.len() {
                return;
            }
            let is_new = height == self.levels.len();
            if is_new {
                self.levels.push(Level::default());
            }
            let Some(level) = self.levels.get_mut(height) else { return };
            while level.len < below.div_ceil(LANES) {
                if level.len.is_multiple_of(LANES) {
                    (0..width).for_each(|_| push_frugally(&mut level.lower, [f32::INFINITY; LANES]));
                    (0..width).for_each(|_| push_frugally(&mut level.upper, [f32::NEG_INFINITY; LANES]));
                }
                push_frugally(&mut level.penalties_m, f32::INFINITY);
                level.len += 1;
            }
            if is_new {
                (0..below.div_ceil(LANES)).for_each(|item| self.enclose(height, item));
            }
        }
    }

    /// Widens the boxes around the node in `slot`.
    fn widen(&mut self, slot: usize, penalty_m: f32) {
        let width = self.width;
        let Some((nodes, boxes)) = self.levels.split_first_mut() else { return };
        let rows = nodes.lower.get(slot / LANES * width..).unwrap_or_default();
        let mut item = slot / LANES;
        for level in boxes {
            let start = item / LANES * width;
            let lower = level.lower.iter_mut().skip(start);
            let upper = level.upper.iter_mut().skip(start);
            for ((row, lower), upper) in rows.iter().take(width).zip(lower).zip(upper) {
                // Ignores what is not a number.
                lower[item % LANES] = lower[item % LANES].min(row[slot % LANES]);
                upper[item % LANES] = upper[item % LANES].max(row[slot % LANES]);
            }
            if let Some(least) = level.penalties_m.get_mut(item) {
                *least = least.min(penalty_m);
            }
            item /= LANES;
        }
    }

    /// Puts a box around the items of one block of the level below. Penalties are left to [`CoordinateIndex::set_penalty`], but for
    /// those of a box that has none yet.
    fn enclose(&mut self, height: usize, item: usize) {
        let Some((below, above)) = self.levels.split_at_mut_checked(height) else { return };
        let (Some(below), Some(level)) = (below.last(), above.first_mut()) else { return };
        let of_block = |rows: &[Lanes], d: usize| rows.get(item * self.width + d).copied();
        for d in 0..self.width {
            let Some(lower) = of_block(&below.lower, d) else { return };
            let upper = if below.upper.is_empty() { lower } else { of_block(&below.upper, d).unwrap_or(lower) };
            let at = item / LANES * self.width + d;
            if let (Some(low), Some(high)) = (level.lower.get_mut(at), level.upper.get_mut(at)) {
                low[item % LANES] = lower.into_iter().fold(f32::INFINITY, f32::min);
                high[item % LANES] = upper.into_iter().fold(f32::NEG_INFINITY, f32::max);
            }
        }
        if let Some(least) = level.penalties_m.get_mut(item) {
            // Zero bounds every penalty.
            *least = 0.0;
        }
    }

    fn coordinate(&self, slot: usize, d: usize) -> f32 {
        let row = self.levels.first().and_then(|level| level.lower.get(slot / LANES * self.width + d));
        row.map_or(f32::NAN, |row| row[slot % LANES])
    }

    /// Exchanges what lies in two slots of the lowest level; the boxes are left as they are.
    fn swap(&mut self, a: usize, b: usize) {
        self.nodes.swap(a, b);
        self.placements.swap(a, b);
        for slot in [a, b] {
            let node = self.nodes.get(slot).map(|node| *node as usize);
            if let Some(back) = node.and_then(|node| self.slots.get_mut(node)) {
                *back = index(slot);
            }
        }
        for d in 0..self.width {
            let (p, q) = (self.coordinate(a, d), self.coordinate(b, d));
            for (slot, x) in [(a, q), (b, p)] {
                let row = self.levels.first_mut().and_then(|l| l.lower.get_mut(slot / LANES * self.width + d));
                if let Some(row) = row {
                    row[slot % LANES] = x;
                }
            }
        }
    }

    /// Sorts the slots from `start` to the end into compact blocks. `start` and the end are multiples of [`SORT_EVERY`].
    fn sort(&mut self, start: usize, penalties_m: &[f64]) {
        let end = self.nodes.len();
        let mut order: Vec<u32> = (start..end).map(index).collect();
        self.split(&mut order);
        let old_nodes = self.nodes.get(start..end).unwrap_or_default().to_vec();
        let old_placements = self.placements.get(start..end).unwrap_or_default().to_vec();
        let rows = start / LANES * self.width..end / LANES * self.width;
        let old = self.levels.first().and_then(|l| l.lower.get(rows)).unwrap_or_default().to_vec();
        for (slot, from) in (start..end).zip(order) {
            let from = from as usize - start;
            let Some((node, placement)) = old_nodes.get(from).zip(old_placements.get(from)) else { continue };
            if let Some(slot_of) = self.slots.get_mut(*node as usize) {
                *slot_of = index(slot);
            }
            if let (Some(n), Some(p)) = (self.nodes.get_mut(slot), self.placements.get_mut(slot)) {
                (*n, *p) = (*node, *placement);
            }
            let Some(level) = self.levels.first_mut() else { return };
            let new = level.lower.iter_mut().skip(slot / LANES * self.width).take(self.width);
            for (row, was) in new.zip(old.iter().skip(from / LANES * self.width)) {
                row[slot % LANES] = was[from % LANES];
            }
        }
        let (mut first, mut last) = (start / LANES, (end - 1) / LANES);
        for height in 1..self.levels.len() {
            for item in first..=last {
                self.enclose(height, item);
                self.set_penalty(height, item, penalties_m);
            }
            (first, last) = (first / LANES, last / LANES);
        }
    }

    /// Orders slots so that every aligned run of [`LANES`], `LANES`², ... of them is compact: halves along the widest
    /// coordinate, again and again.
    fn split(&self, slots: &mut [u32]) {
        if slots.len() <= LANES {
            return;
        }
        let mut unit = LANES;
        while unit * LANES < slots.len() {
            unit *= LANES;
        }
        let middle = slots.len().div_ceil(2).next_multiple_of(unit).min(slots.len() - 1);
        let d = self.widest(slots);
        let key = |slot: u32| self.coordinate(slot as usize, d);
        slots.select_nth_unstable_by(middle, |a, b| key(*a).total_cmp(&key(*b)).then(a.cmp(b)));
        let (left, right) = slots.split_at_mut(middle);
        self.split(left);
        self.split(right);
    }

    fn widest(&self, slots: &[u32]) -> usize {
        let apart = slots.len().div_ceil(SPLIT_SAMPLES);
        let extent = |d: usize| {
            let all = slots.iter().step_by(apart).map(|slot| self.coordinate(*slot as usize, d));
            let (low, high) = all.fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            high - low
        };
        let all = (0..self.width).map(|d| (d, extent(d)));
        all.fold((0, f32::NEG_INFINITY), |best, next| if next.1 > best.1 { next } else { best }).0
    }
}

/// Single precision; what is lost is allowed for where bounds are compared.
#[allow(clippy::cast_possible_truncation, reason = "rounding is meant")]
#[inline]
pub(crate) fn narrow(x: f64) -> f32 {
    x as f32
}

fn penalty_of(placement: u32, penalties_m: &[f64]) -> f32 {
    narrow(penalties_m.get(placement as usize).copied().unwrap_or(0.0))
}
