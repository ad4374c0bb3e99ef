//! Clouds of noise.

use super::super::reader::Reader;
use super::{own_coefficients, phase, scaled};
use crate::pbrt::transform::Transforms;
use crate::source::Fault;
use bidir::math::Vec3;
use bidir::medium::{Grid, Medium};
use bidir::texture::fractal_noise;
use rayon::prelude::*;

/// The cells along the longest side: two for a period of the finest octave of a cloud in the unit cube.
const CELLS: f32 = 160.0;

/// The shape of a cloud.
struct Cloud {
    density: f32,
    wispiness: f32,
    frequency: f32,
}

/// Reads a cloud: noise in a box, thinner the higher.
pub(super) fn read(reader: &mut Reader<'_, '_>, transforms: &Transforms) -> Result<Medium, Fault> {
    let place = super::grid::place(reader, transforms)?;
    let [low, high] = [
        reader.point3("p0", [0.0; 3])?,
        reader.point3("p1", [1.0; 3])?,
    ]
    .map(Vec3::from_array);
    let mut number = |name, default| reader.float_within(name, default, [0.0, f32::MAX]);
    let cloud = Cloud {
        density: number("density", 1.0)?,
        wispiness: number("wispiness", 1.0)?,
        frequency: number("frequency", 5.0)?,
    };
    let given = own_coefficients(reader)?.map(|given| given.unwrap_or([1.0; 3]));
    let coefficients = scaled(reader, given, 1.0)?;
    let phase = phase(reader)?;
    let cell = (high - low).max_element() / CELLS;
    let size = ((high - low) / cell).to_array();
    let size = size.map(|count| (count.round() as usize).max(1));
    let step = (high - low) / Vec3::from_array(size.map(|count| count as f32));
    let [nx, ny, nz] = size;
    let at = |i: usize| {
        let cell = [i % nx, i / nx % ny, i / (nx * ny)];
        low + step * (Vec3::from_array(cell.map(|n| n as f32)) + 0.5)
    };
    let cells = (0..nx * ny * nz).into_par_iter();
    let values = cells.map(|i| [cloud.density_at(at(i))]).collect();
    let grid = Grid::new(size, values, place)
        .ok_or_else(|| Fault::scene(reader.span(), "the box of the cloud has no volume"))?;
    Ok(Medium::of_density(coefficients, grid, phase))
}

impl Cloud {
    /// The density at a point, in `[0, 1]` \[PBRT4, §11.4.5\]. Noise disturbs the place at which noise is asked for,
    /// by wisps.
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
