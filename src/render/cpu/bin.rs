//! Sorting triangles by the tiles of the picture that they reach, so that each tile is drawn from first to last while its samples are
//! at hand. Here goes what is not seen at all: the far sides of closed skin, and triangles that fall between the samples.
//! Never lives here: which samples a triangle covers.

use super::geometry::{Geometry, Place};
use super::grid::{Grid, Rectangle, TILE};
use super::parallelism::Parallelism;
use super::project::{Projected, STEPS};
use super::samples::Pattern;
use super::triangle::side;
use crate::scene::Size;

/// Triangles that follow each other, as one thread sorted them. Kept from picture to picture.
#[derive(Default)]
pub(super) struct Chunk {
    /// Those that reach a few tiles, in the order in which they are drawn.
    few: Vec<Reaching>,
    /// Those that reach many, likewise. Each tile looks through all of them: named at each tile that they reach, a few thousand would fill
    /// gigabytes.
    many: Vec<Reaching>,
    /// Numbers of the triangles that reach a few tiles, tile after tile, row by row; in each tile in the order in which they are drawn.
    by_tile: Vec<u32>,
    /// Where in `by_tile` each tile starts, and where the last one ends.
    starts: Vec<u32>,
}

/// A triangle that is seen, and its tiles.
#[derive(Debug, Clone, Copy)]
struct Reaching {
    triangle: u32,
    /// In both directions, the first and the last.
    columns: [u16; 2],
    rows: [u16; 2],
}

impl Reaching {
    fn tile_count(&self) -> usize {
        let count = |[first, last]: [u16; 2]| usize::from(last - first) + 1;
        count(self.columns) * count(self.rows)
    }

    #[inline(always)]
    fn reaches(&self, [column, row]: [u16; 2]) -> bool {
        let is_within = |at: u16, [first, last]: [u16; 2]| first <= at && at <= last;
        is_within(column, self.columns) && is_within(row, self.rows)
    }

    fn tiles(self, grid: &Grid) -> impl Iterator<Item = usize> {
        let columns = grid.columns as usize;
        let [first, last] = self.columns.map(usize::from);
        let rows = self.rows[0]..=self.rows[1];
        rows.flat_map(move |row| {
            (first..=last).map(move |column| usize::from(row) * columns + column)
        })
    }
}

/// More tiles than this are many.
const FEW: usize = 8;

/// Triangles from one check for cancellation to the next.
const ASK_AFTER: usize = 1 << 16;

impl Chunk {
    /// Sorts the triangles of `geometry` whose numbers are in `range`.
    pub(super) fn fill(
        &mut self,
        geometry: &Geometry<'_>,
        range: std::ops::Range<u32>,
        grid: &Grid,
        pattern: Pattern,
        parallelism: Parallelism<'_>,
    ) {
        self.few.clear();
        self.many.clear();
        for surface in geometry.surfaces {
            let (start, end) = (
                surface.first_triangle.max(range.start),
                surface.end().min(range.end),
            );
            for triangle in start..end {
                if (triangle as usize).is_multiple_of(ASK_AFTER) && parallelism.is_cancelled() {
                    return;
                }
                let place = Place {
                    surface,
                    triangle: (triangle - surface.first_triangle) as usize,
                };
                let corners = geometry.projected_of(place);
                let reached = if corners.iter().any(|corner| corner.is_beyond()) {
                    let pieces = geometry.pieces(place);
                    pieces
                        .filter_map(|piece| {
                            seen(piece.map(|corner| corner.projected), place, grid, pattern)
                        })
                        .reduce(Rectangle::and)
                } else {
                    seen(corners, place, grid, pattern)
                };
                if let Some(reached) = reached {
                    self.add(triangle, reached);
                }
            }
        }
        self.sort(grid);
    }

    #[inline(always)]
    fn add(&mut self, triangle: u32, reached: Rectangle) {
        // The largest picture has fewer than 65,536 of them.
        let tiles = |axis: usize| {
            [reached.min[axis], reached.max[axis]].map(|pixel| (pixel / TILE[axis]) as u16)
        };
        let reaching = Reaching {
            triangle,
            columns: tiles(0),
            rows: tiles(1),
        };
        if reaching.tile_count() > FEW {
            self.many.push(reaching);
        } else {
            self.few.push(reaching);
        }
    }

    /// By counting: how many each tile has tells where each tile ends, and from there they are filled in backward.
    fn sort(&mut self, grid: &Grid) {
        self.starts.clear();
        self.starts.resize(grid.tile_count() + 1, 0);
        for reaching in &self.few {
            for tile in reaching.tiles(grid) {
                self.starts[tile] += 1;
            }
        }
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        self.by_tile.resize(end as usize, 0);
        for reaching in self.few.iter().rev() {
            for tile in reaching.tiles(grid) {
                self.starts[tile] -= 1;
                self.by_tile[self.starts[tile] as usize] = reaching.triangle;
            }
        }
    }

    /// What is drawn in a tile.
    pub(super) fn of_tile(&self, [column, row]: [u32; 2], grid: &Grid) -> OfTile<'_> {
        let tile = (row * grid.columns + column) as usize;
        let [start, end] = [self.starts[tile], self.starts[tile + 1]].map(|at| at as usize);
        OfTile {
            tile: [column, row].map(|at| at as u16),
            few: &self.by_tile[start..end],
            many: &self.many,
        }
    }
}

/// Numbers of triangles, in the order in which they are drawn.
pub(super) struct OfTile<'a> {
    tile: [u16; 2],
    few: &'a [u32],
    many: &'a [Reaching],
}

impl OfTile<'_> {
    /// Those with a smaller number than `end`.
    pub(super) fn before(self, end: u32) -> Self {
        // Most often that is all of them.
        let few = match self.few {
            [.., last] if *last >= end => &self.few[..self.few.partition_point(|it| *it < end)],
            few => few,
        };
        let many = match self.many {
            [.., last] if last.triangle >= end => {
                let count = self.many.partition_point(|it| it.triangle < end);
                &self.many[..count]
            }
            many => many,
        };
        Self { few, many, ..self }
    }

    /// The others.
    pub(super) fn from(self, start: u32) -> Self {
        let few = self.few.partition_point(|it| *it < start);
        let many = self.many.partition_point(|it| it.triangle < start);
        Self {
            few: &self.few[few..],
            many: &self.many[many..],
            ..self
        }
    }
}

impl Iterator for OfTile<'_> {
    type Item = u32;

    #[inline(always)]
    fn next(&mut self) -> Option<u32> {
        while let [first, rest @ ..] = self.many
            && !first.reaches(self.tile)
        {
            self.many = rest;
        }
        match (self.few, self.many) {
            ([few, rest @ ..], [many, ..]) if *few < many.triangle => {
                self.few = rest;
                Some(*few)
            }
            (_, [many, rest @ ..]) => {
                self.many = rest;
                Some(many.triangle)
            }
            ([few, rest @ ..], []) => {
                self.few = rest;
                Some(*few)
            }
            ([], []) => None,
        }
    }
}

/// Where a triangle or a piece of one may be seen.
#[inline(always)]
pub(super) fn seen(
    corners: [Projected; 3],
    place: Place<'_>,
    grid: &Grid,
    pattern: Pattern,
) -> Option<Rectangle> {
    match side(corners) {
        Some(side) if Some(side) != place.surface.culled => pixels(corners, grid.size, pattern),
        _ => None,
    }
}

/// Whose samples may lie in a triangle; `None` where there is no such sample.
#[inline(always)]
pub(super) fn pixels(corners: [Projected; 3], size: Size, pattern: Pattern) -> Option<Rectangle> {
    let [a, b, c] = corners;
    let span = |[a, b, c]: [i32; 3], side: u32| {
        let first = pattern.first_at(a.min(b).min(c)).max(0);
        let last = pattern.last_at(a.max(b).max(c));
        // Both lie at samples, so that rounding down finds their pixels.
        let (first, last) = (
            first / STEPS,
            last.min(side as i32 * STEPS - 1) >> STEPS.ilog2(),
        );
        (first <= last).then_some([first as u32, last as u32])
    };
    let ([left, right], [top, bottom]) = (
        span([a.x, b.x, c.x], size.width)?,
        span([a.y, b.y, c.y], size.height)?,
    );
    Some(Rectangle {
        min: [left, top],
        max: [right, bottom],
    })
}
