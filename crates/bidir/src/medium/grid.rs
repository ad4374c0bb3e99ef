//! Grids of numbers over a box, and exact integrals along lines through them.
//!
//! Between the centres of its cells a grid is trilinear, so that along a line each cell holds a polynomial of degree
//! three. Gaussian quadrature with two points integrates it exactly:
//!
//! ∫ f dt = (b - a) (f(m - h) + f(m + h)) / 2, m = (a + b) / 2, h = (b - a) / (2 √3)
//!
//! \[Press07, §4.6\]. So T is not an estimate, and the density of a walk is known, as in a homogeneous medium.

use super::cells::{CubeBox, Line, Range};
use crate::math::{Affine3A, Vec3};
use accel::{Aabb, Ray};
use std::ops::ControlFlow;

/// The side of a block, in cells. A line passes a constant block in a single step.
const BLOCK: usize = 8;

/// Numbers of `N` channels at the centres of equal cells of a box: linear between them, constant from the outermost
/// centres to the faces, and zero outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<const N: usize> {
    size: [usize; 3],
    /// The transform to the lattice: the centre of the first cell is at 1 along each axis, and cells have the side 1.
    lattice_from_world: Affine3A,
    bounds: Aabb,
    values: Vec<[f32; N]>,
    blocks: Vec<Block<N>>,
    /// The number of blocks along each axis.
    block_counts: [usize; 3],
}

/// A block of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Block<const N: usize> {
    mean: [f32; N],
    is_constant: bool,
}

/// The detail in which a line sees a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Detail {
    /// The grid itself.
    Full,
    /// Means over blocks of cells.
    Means,
}

/// A part of a line along which a grid is one polynomial.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece<const N: usize> {
    pub(super) range: Range,
    field: Field<N>,
}

#[derive(Clone, Copy, Debug)]
enum Field<const N: usize> {
    Constant([f32; N]),
    /// The values at the corners of a cell, x fastest, and the line relative to the first corner.
    Cell([[f32; N]; 8], Line),
}

impl<const N: usize> Grid<N> {
    /// Makes a grid of `size` cells, x fastest, over the unit cube that `world_from_cube` places. None: the number of
    /// `values` is not that of cells, or is 0; a value is negative or not finite; or the box is flat.
    pub fn new(size: [usize; 3], values: Vec<[f32; N]>, world_from_cube: Affine3A) -> Option<Self> {
        let count = size.iter().try_fold(1_usize, |n, &k| n.checked_mul(k))?;
        let is_valid = |value: &f32| (0.0..=f32::MAX).contains(value);
        let cube_from_world = world_from_cube.inverse();
        let fits = count == values.len() && count > 0 && cube_from_world.is_finite();
        if !fits || !values.as_flattened().iter().all(is_valid) {
            return None;
        }
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
        let corners: Vec<Vec3> = (0..8)
            .map(|i| world_from_cube.transform_point3(corner(i)))
            .collect();
        let mut grid = Self {
            size,
            lattice_from_world: lattice_from_cube(size) * cube_from_world,
            bounds: Aabb::around(&corners),
            values,
            blocks: Vec::new(),
            // One cell more than centres: half a cell on either side.
            block_counts: size.map(|n| n / BLOCK + 1),
        };
        grid.blocks = grid.all_blocks();
        Some(grid)
    }

    /// Returns the bounds of the box in the world.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Returns the number of cells along each axis.
    pub(super) fn size(&self) -> [usize; 3] {
        self.size
    }

    /// Returns the values at the centres of cells, x fastest.
    pub(super) fn values(&self) -> &[[f32; N]] {
        &self.values
    }

    /// Returns the transform from the unit cube to its box in the world.
    pub(super) fn world_from_cube(&self) -> Affine3A {
        self.lattice_from_world.inverse() * lattice_from_cube(self.size)
    }

    /// Returns true where the other grid has the same box and cells.
    pub(super) fn has_cells_of<const M: usize>(&self, other: &Grid<M>) -> bool {
        self.size == other.size && self.lattice_from_world == other.lattice_from_world
    }

    /// Returns the mean over each cell of a function that is `value` of the cell's number at its centre, and linear
    /// between centres: along an axis, (f(i - 1) + 6 f(i) + f(i + 1)) / 8.
    pub(super) fn cell_means(&self, value: impl Fn(usize) -> f32) -> Vec<f32> {
        let mut means: Vec<f32> = (0..self.values.len()).map(value).collect();
        let mut stride = 1;
        for count in self.size {
            let before = means.clone();
            for (i, mean) in means.iter_mut().enumerate() {
                let along = i / stride % count;
                let low = before[i - stride * usize::from(along > 0)];
                let high = before[i + stride * usize::from(along + 1 < count)];
                *mean = 0.125 * low + 0.75 * before[i] + 0.125 * high;
            }
            stride *= count;
        }
        means
    }

    /// Returns the largest value.
    pub(super) fn most(&self) -> f32 {
        self.values
            .as_flattened()
            .iter()
            .copied()
            .fold(0.0, f32::max)
    }

    /// Returns true where the other grid has the same box and cells, and nowhere smaller numbers.
    pub(super) fn is_nowhere_above(&self, other: &Self) -> bool {
        let ours = self.values.as_flattened();
        let theirs = other.values.as_flattened();
        self.has_cells_of(other) && ours.iter().zip(theirs).all(|(our, their)| our <= their)
    }

    /// Returns the values at a point of the box; outside, those of the nearest face.
    pub fn at(&self, point: Vec3) -> [f32; N] {
        let origin = self.lattice_from_world.transform_point3(point);
        let [low, high] = self.faces();
        let line = Line {
            origin: origin.clamp(low, high),
            direction: Vec3::ZERO,
        };
        let cell = std::array::from_fn(|axis| (line.origin[axis] as usize).min(self.size[axis]));
        self.piece(cell, line, [0.0; 2]).at(0.0)
    }

    /// Visits the pieces of a part of `ray`, in order.
    #[inline]
    pub(super) fn visit<B>(
        &self,
        ray: &Ray,
        range: Range,
        detail: Detail,
        mut visit: impl FnMut(&Piece<N>) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let line = Line {
            origin: self.lattice_from_world.transform_point3(ray.origin),
            direction: self.lattice_from_world.transform_vector3(ray.direction),
        };
        let Some(range) = line.within(self.faces(), range) else {
            return ControlFlow::Continue(());
        };
        let blocks = CubeBox {
            first: [0; 3],
            last: self.block_counts.map(|n| n as i32 - 1),
        };
        for (at, part) in line.cubes(BLOCK as f32, blocks, range) {
            let at = at.map(|n| n as usize);
            let block = &self.blocks[index(at, self.block_counts)];
            if block.is_constant || detail == Detail::Means {
                visit(&Piece {
                    range: part,
                    field: Field::Constant(block.mean),
                })?;
                continue;
            }
            for (cell, part) in line.cubes(1.0, self.cells_of(at), part) {
                visit(&self.piece(cell.map(|n| n as usize), line, part))?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Returns the corners of the box in the lattice.
    fn faces(&self) -> [Vec3; 2] {
        let far = self.size.map(|n| n as f32 + 0.5);
        [Vec3::splat(0.5), Vec3::from_array(far)]
    }

    /// Returns the cells of a block.
    fn cells_of(&self, block: [usize; 3]) -> CubeBox {
        let first = block.map(|n| n * BLOCK);
        let last =
            std::array::from_fn(|axis| (first[axis] + BLOCK - 1).min(self.size[axis]) as i32);
        CubeBox {
            first: first.map(|n| n as i32),
            last,
        }
    }

    /// Returns the values at the corners of a cell. There is one more cell than centres along each axis.
    #[inline]
    fn corners(&self, cell: [usize; 3]) -> [[f32; N]; 8] {
        let ends: [[usize; 2]; 3] = std::array::from_fn(|axis| {
            let last = self.size[axis] - 1;
            [cell[axis].saturating_sub(1), cell[axis].min(last)]
        });
        std::array::from_fn(|i| {
            let at = [ends[0][i & 1], ends[1][i >> 1 & 1], ends[2][i >> 2]];
            self.values[index(at, self.size)]
        })
    }

    #[inline]
    fn piece(&self, cell: [usize; 3], line: Line, range: Range) -> Piece<N> {
        let first = Vec3::from_array(cell.map(|n| n as f32));
        let relative = Line {
            origin: line.origin - first,
            ..line
        };
        Piece {
            range,
            field: Field::Cell(self.corners(cell), relative),
        }
    }

    fn all_blocks(&self) -> Vec<Block<N>> {
        let [nx, ny, nz] = self.block_counts;
        let all = (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / (nx * ny)]);
        all.map(|at| self.block(at)).collect()
    }

    fn block(&self, at: [usize; 3]) -> Block<N> {
        let CubeBox { first, last } = self.cells_of(at);
        let mut sum = [0.0_f64; N];
        let mut count = 0.0;
        let any = self.corners(first.map(|n| n as usize))[0];
        let mut is_constant = true;
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                for x in first[0]..=last[0] {
                    for corner in self.corners([x, y, z].map(|n| n as usize)) {
                        is_constant &= corner.map(f32::to_bits) == any.map(f32::to_bits);
                        count += 1.0;
                        for (sum, value) in sum.iter_mut().zip(corner) {
                            *sum += f64::from(value);
                        }
                    }
                }
            }
        }
        let mean = sum.map(|sum| (sum / count) as f32);
        Block {
            mean: if is_constant { any } else { mean },
            is_constant,
        }
    }
}

impl<const N: usize> Piece<N> {
    /// Returns the values at `t`.
    #[inline]
    pub(super) fn at(&self, t: f32) -> [f32; N] {
        let (corners, line) = match &self.field {
            Field::Constant(value) => return *value,
            Field::Cell(corners, line) => (corners, line),
        };
        let [x, y, z] = line.at(t).clamp(Vec3::ZERO, Vec3::ONE).to_array();
        std::array::from_fn(|channel| {
            let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
            let along_x = |i: usize| mix(corners[i][channel], corners[i + 1][channel], x);
            let [front, back] = [0, 4].map(|i| mix(along_x(i), along_x(i + 2), y));
            mix(front, back, z)
        })
    }

    /// Returns the mean of each channel along the line, from where the piece begins to `end`.
    #[inline]
    pub(super) fn mean(&self, end: f32) -> [f32; N] {
        /// 1 / (2 √3)
        const REACH: f32 = 0.288_675_13;
        let [begin, _] = self.range;
        let (middle, reach) = (0.5 * (begin + end), REACH * (end - begin));
        let [a, b] = [middle - reach, middle + reach].map(|t| self.at(t));
        std::array::from_fn(|channel| 0.5 * (a[channel] + b[channel]))
    }
}

/// Returns the transform from the box as a unit cube to the lattice.
fn lattice_from_cube(size: [usize; 3]) -> Affine3A {
    let cells = Vec3::from_array(size.map(|n| n as f32));
    Affine3A::from_translation(Vec3::splat(0.5)) * Affine3A::from_scale(cells)
}

/// Returns the index of a cell, x fastest, in an array of `[nx, ny, nz]` cells.
#[inline]
fn index([x, y, z]: [usize; 3], [nx, ny, _]: [usize; 3]) -> usize {
    (z * ny + y) * nx + x
}
