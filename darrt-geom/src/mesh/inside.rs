//! What a mesh encloses: which of its pieces are closed, and which points lie in them.
//!
//! A piece is what hangs together by edges. It is closed when every edge belongs to an even number of triangles; then a ray from a
//! point crosses it an odd number of times exactly when the point is inside, however the triangles are turned. Pieces that lie
//! in others are cavities, and what lies in a cavity is solid again; pieces that only overlap are solid together.
//!
//! # Source
//! The parity rule is Jordan's; rays fall between triangles nowhere because each edge is judged once, whichever triangle asks
//! (E. Haines, Point in polygon strategies, Graphics Gems IV, 1994, for the plane).

use nalgebra::{Point3, Vector3};
use std::collections::HashMap;

/// Slope of the rays against the z axis: so that they are along no edge and in no face of what people draw.
const SLOPE: [f64; 2] = [0.317_529_461_8, 0.183_902_745_1];
/// How many triangles a cell of the grid holds about.
const PER_CELL: usize = 2;
/// Cells are made larger until the lists of all together have at most so many entries for each triangle.
const ENTRIES_PER_TRIANGLE: usize = 16;

/// The solid of a mesh.
#[derive(Debug, Default)]
pub(super) struct Inside {
    open_edges: usize,
    /// The places where triangles have corners, each once, along the rays.
    places: Vec<Vector3<f64>>,
    /// Triangles as indices into `places`.
    triangles: Vec<[u32; 3]>,
    /// By triangle: its piece.
    piece_of: Vec<usize>,
    /// By piece: what being in it counts, 1 for a solid, -1 for a cavity, 0 for a piece that is not closed.
    counts: Vec<i32>,
    /// By piece: one of its corners.
    corners: Vec<Point3<f64>>,
    grid: Grid,
}

/// Squares across the rays, with the triangles that lie over them.
#[derive(Debug, Default)]
struct Grid {
    low: [f64; 2],
    cell: [f64; 2],
    count: usize,
    /// Where the list of each square begins in `entries`, and where the last one ends.
    starts: Vec<usize>,
    entries: Vec<u32>,
}

impl Inside {
    /// Of triangles by their corners; those without an area count for the edges.
    pub(super) fn new(triangles: impl Iterator<Item = [Point3<f64>; 3]>) -> Self {
        let mut inside = Self::default();
        let mut known = HashMap::new();
        let mut place = |p: Point3<f64>| {
            // Adding zero makes one of the two zeros.
            let key = [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
            *known.entry(key).or_insert_with(|| {
                inside.places.push(along(&p));
                // At most three places for each triangle, far below 2^32.
                u32::try_from(inside.places.len() - 1).unwrap_or(u32::MAX)
            })
        };
        inside.triangles = triangles.map(|corners| corners.map(&mut place)).collect();
        inside.find_pieces();
        inside.grid = Grid::new(&inside.triangles, &inside.places);
        inside.find_cavities();
        inside
    }

    /// Finds out what hangs together, and what of it is closed.
    fn find_pieces(&mut self) {
        let mut edges: Vec<([u32; 2], usize)> = Vec::with_capacity(3 * self.triangles.len());
        for (number, [a, b, c]) in self.triangles.iter().enumerate() {
            let sides = [(a, b), (b, c), (c, a)].into_iter().filter(|(one, other)| one != other);
            edges.extend(sides.map(|(one, other)| ([*one.min(other), *one.max(other)], number)));
        }
        edges.sort_unstable();
        let mut pieces = Pieces((0..self.triangles.len()).collect());
        let mut is_open = vec![false; self.triangles.len()];
        for edge in edges.chunk_by(|one, other| one.0 == other.0) {
            for two in edge.windows(2) {
                if let [(_, one), (_, other)] = two {
                    pieces.join(*one, *other);
                }
            }
            if edge.len() % 2 == 1 {
                self.open_edges += 1;
                for (_, triangle) in edge {
                    is_open[*triangle] = true;
                }
            }
        }
        let mut numbers = HashMap::new();
        for (triangle, is_open) in is_open.into_iter().enumerate() {
            let next = numbers.len();
            let piece = *numbers.entry(pieces.root(triangle)).or_insert(next);
            if piece == next {
                self.counts.push(1);
                self.corners.push(back(&self.places[self.triangles[triangle][0] as usize]));
            }
            if is_open {
                self.counts[piece] = 0;
            }
            self.piece_of.push(piece);
        }
    }

    /// Edges that belong to an odd number of triangles: none if the whole mesh is closed.
    pub(super) fn open_edges(&self) -> usize {
        self.open_edges
    }

    /// One point of each piece: a piece that touches nothing lies wholly on one side of it, as its point does.
    pub(super) fn corners(&self) -> &[Point3<f64>] {
        &self.corners
    }

    /// Is the point in the solid?
    pub(super) fn contains(&self, p: &Point3<f64>) -> bool {
        self.counts.iter().any(|count| *count > 0)
            && self.around(p).iter().map(|piece| self.counts[*piece]).sum::<i32>() > 0
    }

    /// The triangles of the closed pieces, each with its piece and what being in that counts.
    pub(super) fn closed(&self) -> impl Iterator<Item = ([Point3<f64>; 3], usize, i32)> + '_ {
        let all =
            self.triangles.iter().zip(&self.piece_of).map(|(corners, piece)| (corners, *piece, self.counts[*piece]));
        all.filter(|(.., count)| *count != 0)
            .map(|(corners, piece, count)| (corners.map(|corner| back(&self.places[corner as usize])), piece, count))
    }

    /// The closed pieces around a point, in ascending order.
    pub(super) fn around(&self, p: &Point3<f64>) -> Vec<usize> {
        let at = along(p);
        let mut crossed = Vec::new();
        for triangle in self.grid.over(&at) {
            let piece = self.piece_of[*triangle as usize];
            if self.counts[piece] != 0 && self.is_above(self.triangles[*triangle as usize], &at) {
                crossed.push(piece);
            }
        }
        crossed.sort_unstable();
        let odd = crossed.chunk_by(|a, b| a == b).filter(|times| times.len() % 2 == 1);
        odd.map(|times| times[0]).collect()
    }

    /// Does the ray upwards from `at` cross the triangle?
    fn is_above(&self, [a, b, c]: [u32; 3], at: &Vector3<f64>) -> bool {
        let place = |index: u32| &self.places[index as usize];
        let is_left = |from: u32, to: u32| {
            // Judged from the corner with the smaller index, so that both triangles at the edge see the same.
            let is_turned = from > to;
            let (from, to) = if is_turned { (place(to), place(from)) } else { (place(from), place(to)) };
            let cross = (to.x - from.x) * (at.y - from.y) - (to.y - from.y) * (at.x - from.x);
            (cross >= 0.0) != is_turned
        };
        let first = is_left(a, b);
        if is_left(b, c) != first || is_left(c, a) != first {
            return false;
        }
        let normal = (place(b) - place(a)).cross(&(place(c) - place(a)));
        // The plane is `height / normal.z` above the point.
        let height = normal.dot(&(place(a) - at));
        normal.z != 0.0 && height != 0.0 && (height > 0.0) == (normal.z > 0.0)
    }

    /// A piece all of whose corners are in other pieces, in an odd number of them, is a cavity.
    fn find_cavities(&mut self) {
        if self.counts.len() < 2 {
            return;
        }
        let mut around: Vec<Option<Vec<usize>>> = vec![None; self.counts.len()];
        // A corner belongs to several triangles of its piece.
        let mut asked = vec![usize::MAX; self.places.len()];
        for (corners, piece) in self.triangles.iter().zip(&self.piece_of) {
            if self.counts[*piece] == 0 {
                continue;
            }
            for corner in corners {
                let known = &mut around[*piece];
                let is_asked = std::mem::replace(&mut asked[*corner as usize], *piece) == *piece;
                if is_asked || known.as_ref().is_some_and(Vec::is_empty) {
                    continue;
                }
                let here = self.around(&back(&self.places[*corner as usize]));
                let is_around = |other: &usize| other != piece && here.contains(other);
                match known {
                    None => *known = Some(here.iter().copied().filter(is_around).collect()),
                    Some(known) => known.retain(is_around),
                }
            }
        }
        for (count, around) in self.counts.iter_mut().zip(around) {
            if around.is_some_and(|around| around.len() % 2 == 1) {
                *count = -*count;
            }
        }
    }
}

/// Triangles that hang together.
struct Pieces(Vec<usize>);

impl Pieces {
    fn root(&mut self, mut of: usize) -> usize {
        while self.0[of] != of {
            self.0[of] = self.0[self.0[of]];
            of = self.0[of];
        }
        of
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }
}

/// A point in the frame of the rays: the first two coordinates say which ray it is on, the third how far along.
fn along(p: &Point3<f64>) -> Vector3<f64> {
    Vector3::new(p.x + SLOPE[0] * p.z, p.y + SLOPE[1] * p.z, p.z)
}

fn back(at: &Vector3<f64>) -> Point3<f64> {
    Point3::new(at.x - SLOPE[0] * at.z, at.y - SLOPE[1] * at.z, at.z)
}

impl Grid {
    fn new(triangles: &[[u32; 3]], places: &[Vector3<f64>]) -> Self {
        let boxes: Vec<_> = triangles.iter().map(|corners| bounds(corners.map(|i| places[i as usize]))).collect();
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for (least, most) in &boxes {
            for i in 0..2 {
                low[i] = low[i].min(least[i]);
                high[i] = high[i].max(most[i]);
            }
        }
        let mut count = 1;
        while count * count * PER_CELL < triangles.len() {
            count *= 2;
        }
        loop {
            let cell = [0, 1].map(|i| ((high[i] - low[i]) / count as f64).max(f64::MIN_POSITIVE));
            let mut grid = Self { low, cell, count, ..Self::default() };
            let wide = |(least, most): &([f64; 2], [f64; 2])| {
                let [x, y] = [0, 1].map(|i| grid.column(i, most[i]) - grid.column(i, least[i]) + 1);
                x * y
            };
            let entries: usize = boxes.iter().map(wide).sum();
            if count == 1 || entries <= ENTRIES_PER_TRIANGLE * triangles.len() {
                grid.fill(&boxes);
                return grid;
            }
            count /= 2;
        }
    }

    fn fill(&mut self, boxes: &[([f64; 2], [f64; 2])]) {
        let cells = |grid: &Self, (least, most): &([f64; 2], [f64; 2])| {
            let [xs, ys] = [0, 1].map(|i| grid.column(i, least[i])..=grid.column(i, most[i]));
            let count = grid.count;
            ys.flat_map(move |y| xs.clone().map(move |x| y * count + x))
        };
        // Counted, then filled from the back.
        let mut ends = vec![0; self.count * self.count + 1];
        boxes.iter().flat_map(|bounds| cells(self, bounds)).for_each(|cell| ends[cell] += 1);
        let mut sum = 0;
        for end in &mut ends {
            sum += *end;
            *end = sum;
        }
        self.entries = vec![0; sum];
        for (number, bounds) in (0_u32..).zip(boxes) {
            for cell in cells(self, bounds) {
                ends[cell] -= 1;
                self.entries[ends[cell]] = number;
            }
        }
        self.starts = ends;
    }

    /// The column, or row, of a coordinate; the first or last one for what lies outside.
    fn column(&self, i: usize, x: f64) -> usize {
        let cells = ((x - self.low[i]) / self.cell[i]).floor();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the count")]
        let cells = cells.clamp(0.0, self.count.saturating_sub(1) as f64) as usize;
        cells
    }

    /// The triangles over the square of a ray.
    fn over(&self, at: &Vector3<f64>) -> &[u32] {
        let cell = self.column(1, at.y) * self.count + self.column(0, at.x);
        let range = self.starts.get(cell).zip(self.starts.get(cell + 1));
        range.and_then(|(from, to)| self.entries.get(*from..*to)).unwrap_or_default()
    }
}

fn bounds([a, b, c]: [Vector3<f64>; 3]) -> ([f64; 2], [f64; 2]) {
    let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
    ([low.x, low.y], [high.x, high.y])
}

#[cfg(test)]
mod tests;
