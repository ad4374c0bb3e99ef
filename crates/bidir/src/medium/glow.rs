//! Media that emit light: each unit of length adds σ_a L_e to the light along it \[Chandrasekhar60\].
//!
//! Within a thick medium of constant L_e, the radiance is L_e, as in a furnace.

use super::{Coefficients, Field, Grid, Medium, largest};
use crate::math::{Affine3A, Vec3};
use crate::spectrum::{Illuminant, Lanes, Rgb, Spectrum, luminance};
use accel::Aabb;

/// L_e of a medium: the radiance within it if it were thick.
#[derive(Clone, Debug, PartialEq)]
pub enum Glow {
    /// The same radiance everywhere.
    Even(Illuminant),
    /// The radiance in the cells of the medium's own grid.
    Grid(Grid<3>),
}

/// The emission of a box, in equal cells.
#[derive(Clone, Debug)]
pub(crate) struct GlowCells {
    pub(crate) world_from_cube: Affine3A,
    pub(crate) size: [usize; 3],
    /// The approximate mean of σ_a L_e in each cell, x fastest; positive if any part of the cell emits. Unit: W/(m³
    /// sr), luminance.
    pub(crate) emission: Vec<f32>,
}

impl Glow {
    fn most(&self) -> f32 {
        match self {
            Self::Even(radiance) => largest(radiance.color()),
            Self::Grid(grid) => grid.most(),
        }
    }

    #[inline]
    fn at(&self, point: Vec3, lanes: Lanes) -> Spectrum {
        match self {
            Self::Even(radiance) => lanes.light(radiance),
            Self::Grid(grid) => lanes.illuminant(grid.at(point)),
        }
    }

    /// Returns the cells of `grid`; `absorption` returns σ_a by the number of a cell.
    fn cells<const N: usize>(
        &self,
        grid: &Grid<N>,
        absorption: impl Fn(usize) -> Rgb,
    ) -> GlowCells {
        let radiance = |i: usize| match self {
            Self::Even(radiance) => radiance.color(),
            Self::Grid(grid) => grid.values()[i],
        };
        // The product of means is not the mean of the product, but it is positive if that is.
        let products: [Vec<f32>; 3] = std::array::from_fn(|channel| {
            let mut product = grid.cell_means(|i| absorption(i)[channel]);
            let radiance = grid.cell_means(|i| radiance(i)[channel]);
            for (a, b) in product.iter_mut().zip(radiance) {
                *a *= b;
            }
            product
        });
        let emission = |i: usize| luminance(std::array::from_fn(|channel| products[channel][i]));
        GlowCells {
            world_from_cube: grid.world_from_cube(),
            size: grid.size(),
            emission: (0..products[0].len()).map(emission).collect(),
        }
    }
}

impl Medium {
    /// The largest σ_t L_e, so that products with volumes stay finite.
    pub const BRIGHTEST: f32 = 1e18;

    /// Makes the medium emit light. None: L_e is negative or not finite, σ_t L_e may be above
    /// [`BRIGHTEST`](Self::BRIGHTEST), or the grid of L_e has other cells than the grid of the medium.
    pub fn glowing(self, glow: Glow) -> Option<Self> {
        let most = glow.most();
        let is_along = match (&glow, &self.field) {
            (Glow::Even(_), _) => true,
            (Glow::Grid(_), Field::Homogeneous(_)) => false,
            (Glow::Grid(ours), Field::Density(_, theirs)) => ours.has_cells_of(theirs),
            (Glow::Grid(ours), Field::Chromatic { extinction, .. }) => {
                ours.has_cells_of(extinction)
            }
        };
        let is_light = match &glow {
            Glow::Even(radiance) => radiance
                .color()
                .iter()
                .all(|l| (0.0..=f32::MAX).contains(l)),
            // The values of grids are finite and not negative.
            Glow::Grid(_) => true,
        };
        let is_valid = is_along && is_light && most * self.most() <= Self::BRIGHTEST;
        is_valid.then_some(Self {
            glow: (most > 0.0).then_some(glow),
            ..self
        })
    }

    /// Returns the largest L_e. Unit: luminance.
    pub(crate) fn brightest(&self) -> f32 {
        match &self.glow {
            None => 0.0,
            Some(Glow::Even(radiance)) => radiance.luminance(),
            Some(Glow::Grid(grid)) => {
                let cells = grid.values().iter();
                cells.map(|&rgb| luminance(rgb)).fold(0.0, f32::max)
            }
        }
    }

    /// Returns true if the medium emits light.
    #[inline]
    pub const fn glows(&self) -> bool {
        self.glow.is_some()
    }

    /// Returns σ_a L_e at a point, which lies in the medium. Unit: W/(m³ sr).
    #[inline]
    pub fn emission(&self, point: Vec3, lanes: Lanes) -> Spectrum {
        self.glow.as_ref().map_or(Spectrum::ZERO, |glow| {
            lanes.unbounded(self.at(point).absorption()) * glow.at(point, lanes)
        })
    }

    /// Returns the cells of emission; the box of a homogeneous medium is `bounds`. None: the medium emits nothing, or
    /// it has no box, or a flat one.
    pub(crate) fn glow_cells(&self, bounds: Option<Aabb>) -> Option<GlowCells> {
        let glow = self.glow.as_ref()?;
        match &self.field {
            Field::Homogeneous(_) => {
                let bounds = bounds?;
                let size = bounds.max - bounds.min;
                size.cmpgt(Vec3::ZERO).all().then(|| GlowCells {
                    world_from_cube: Affine3A::from_translation(bounds.min)
                        * Affine3A::from_scale(size),
                    size: [1; 3],
                    emission: vec![Lanes::Rgb.luminance(self.emission(bounds.min, Lanes::Rgb))],
                })
            }
            Field::Density(at, grid) => {
                let density = |i: usize| grid.values()[i][0];
                Some(glow.cells(grid, |i| at.scaled(density(i)).absorption()))
            }
            Field::Chromatic {
                extinction,
                scattering,
            } => {
                let at = |i: usize| Coefficients {
                    extinction: extinction.values()[i],
                    scattering: scattering.values()[i],
                };
                Some(glow.cells(extinction, |i| at(i).absorption()))
            }
        }
    }
}
