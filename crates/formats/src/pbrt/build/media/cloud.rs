//! Clouds of noise.

use super::super::reader::Reader;
use super::{Recipe, own_coefficients, phase, scaled};
use crate::pbrt::transform::Transforms;
use crate::source::Fault;
use bidir::math::{Affine3A, Vec3};
use bidir::medium::{Grid, Medium};
use bidir::texture::fractal_noise;
use rayon::prelude::*;

/// Number of cells along the longest side: almost two per period of the finest octave, for a cloud in the unit cube.
const CELLS: f64 = 128.0;

/// The parameters of a cloud.
struct Cloud {
    low: Vec3,
    high: Vec3,
    density: f32,
    wispiness: f32,
    frequency: f32,
}

/// Reads a cloud: noise in a box, which gets thinner with height.
pub(super) fn read(reader: &mut Reader<'_, '_>, transforms: &Transforms) -> Result<Recipe, Fault> {
    /// Maximum value of the parameters. Beyond it, adjacent cells are independent.
    const MOST: f32 = 1e4;
    let place = super::grid::place(reader, transforms)?;
    let [low, high] = [
        reader.point3("p0", [0.0; 3])?,
        reader.point3("p1", [1.0; 3])?,
    ]
    .map(Vec3::from_array);
    let mut number = |name, default| reader.float_within(name, default, [0.0, MOST]);
    let cloud = Cloud {
        low,
        high,
        density: number("density", 1.0)?,
        wispiness: number("wispiness", 1.0)?,
        frequency: number("frequency", 5.0)?,
    };
    let given = own_coefficients(reader)?.map(|given| given.unwrap_or([1.0; 3]));
    let coefficients = scaled(reader, given, 1.0)?;
    let phase = phase(reader)?;
    let span = reader.span();
    Ok(Box::new(move || {
        let grid = cloud.grid(place);
        let medium = grid.and_then(|grid| Medium::of_density(coefficients, grid, phase));
        let message = "the box of the cloud has no volume, or its coefficients are too large";
        medium.ok_or_else(|| Fault::scene(span, message))
    }))
}

impl Cloud {
    /// Returns the densities of all cells. None: the box has no volume.
    fn grid(&self, place: Affine3A) -> Option<Grid<1>> {
        let extent = self.high.as_dvec3() - self.low.as_dvec3();
        let parts = extent / extent.max_element() * CELLS;
        let size = parts
            .to_array()
            .map(|count| (count.round() as usize).max(1));
        let [nx, ny, nz] = size;
        let at = |i: usize| {
            let cell = [i % nx, i / nx % ny, i / (nx * ny)];
            let part = |axis: usize| (cell[axis] as f32 + 0.5) / size[axis] as f32;
            self.low + (self.high - self.low) * Vec3::from_array(std::array::from_fn(part))
        };
        let cells = (0..nx * ny * nz).into_par_iter();
        let values = cells.map(|i| [self.density_at(at(i))]).collect();
        Grid::new(size, values, place)
    }

    /// Returns the density at a point, in `[0, 1]` \[PBRT4, §11.4.5\]. For wisps, noise moves the point at which the
    /// noise is evaluated.
    fn density_at(&self, p: Vec3) -> f32 {
        let mut at = p * self.frequency;
        let mut reach = 0.05 * self.wispiness;
        for frequency in [10.0, 19.9] {
            let noise = |shift: f32| fractal_noise(at * frequency + shift, 1, 1.0);
            at += Vec3::new(noise(0.0), noise(31.4), noise(-27.2)) * reach;
            reach *= 0.5;
        }
        let noise = 0.5 * fractal_noise(at, 5, 0.5);
        let above = ((1.0 - p.y) * 4.5 * self.density * noise).clamp(0.0, 1.0);
        (above + 2.0 * (0.5 - p.y).max(0.0)).clamp(0.0, 1.0)
    }
}
