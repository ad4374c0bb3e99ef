//! Patterns of cells: checkerboards, dots, and colours between four corners.
//!
//! Edges are sharp: a pixel's samples average them.

use super::noise::noise;
use super::{Mapping, RequiredInputs, Texture, TexturePoint, TextureSpace, Value};
use crate::math::{Vec2, Vec3};

/// Values at the corners of the unit square of (s, t), interpolated between them.
#[derive(Clone, Copy, Debug)]
pub struct Bilerp<T> {
    /// The values at (0, 0), (1, 0), (0, 1) and (1, 1).
    pub corners: [T; 4],
    /// The mapping to the square.
    pub mapping: Mapping,
}

impl<T: Value> Bilerp<T> {
    pub(super) fn eval(&self, at: &TexturePoint) -> T {
        let st = self.mapping.st(at);
        let [c00, c10, c01, c11] = self.corners;
        c00.lerp(c10, st.x).lerp(c01.lerp(c11, st.x), st.y)
    }
}

/// The cells of a checkerboard, of width 1.
#[derive(Clone, Copy, Debug)]
pub enum Cells {
    /// Squares.
    Plane(Mapping),
    /// Cubes.
    Space(TextureSpace),
}

/// Two textures in alternating cells; the cell that begins at the origin has the first.
#[derive(Clone, Debug)]
pub struct Checkerboard<T: Value> {
    /// The textures of the cells.
    pub textures: [Texture<T>; 2],
    /// The cells.
    pub cells: Cells,
}

impl Cells {
    pub(super) fn needs(&self) -> RequiredInputs {
        match self {
            Self::Plane(mapping) => mapping.needs(),
            Self::Space(_) => RequiredInputs::SURFACE,
        }
    }

    /// Returns true where the coordinates of the cell add up to an odd number.
    fn is_odd(&self, at: &TexturePoint) -> bool {
        let cell = match self {
            Self::Plane(mapping) => mapping.st(at).floor().extend(0.0),
            Self::Space(space) => space.point(at).floor(),
        };
        let parity = |x: f32| x.rem_euclid(2.0);
        (parity(cell.x) + parity(cell.y) + parity(cell.z)).rem_euclid(2.0) >= 1.0
    }
}

impl<T: Value> Checkerboard<T> {
    pub(super) fn cell(&self, at: &TexturePoint) -> &Texture<T> {
        &self.textures[usize::from(self.cells.is_odd(at))]
    }
}

/// Round dots in about half of the cells of a grid, each at a random position in its cell.
#[derive(Clone, Debug)]
pub struct Dots<T: Value> {
    /// The texture outside of the dots, and the one inside.
    pub textures: [Texture<T>; 2],
    /// The mapping to the grid, whose cells have width 1 and are centred at whole numbers.
    pub mapping: Mapping,
}

/// The radius of dots.
const RADIUS: f32 = 0.35;

impl<T: Value> Dots<T> {
    pub(super) fn cell(&self, at: &TexturePoint) -> &Texture<T> {
        let st = self.mapping.st(at);
        let cell = (st + 0.5).floor();
        let number = |x: f32, y: f32| noise(Vec3::new(cell.x + x, cell.y + y, 0.5));
        // The offsets into the noise are pbrt-v4's, so that dots have the same positions.
        let has_dot = number(0.5, 0.5) > 0.0;
        let shift = Vec2::new(number(1.5, 2.8), number(4.5, 9.8)) * (0.5 - RADIUS);
        let is_inside = (st - cell - shift).length_squared() < RADIUS * RADIUS;
        &self.textures[usize::from(has_dot && is_inside)]
    }
}
