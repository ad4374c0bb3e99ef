//! Participating media: smoke, fog and liquids, which absorb and scatter light between surfaces.
//!
//! Along a segment of a path
//!
//! T(a, b) = exp(-τ), τ = ∫ σ_t, σ_t = σ_a + σ_s
//!
//! of the light arrives \[Chandrasekhar60\], lane by lane. A vertex in a medium scatters σ_s p, where p is the
//! [phase function](HenyeyGreenstein).
//!
//! A walk that leaves a with a density p_ω of directions reaches b with the density
//!
//! p_ω |cosθ_b| / d² · mean(T) on a surface, p_ω / d² · mean(σ_t T) in a medium,
//!
//! with T only of the media that scatter or emit, and with means over lanes. A walk draws its distance by one lane,
//! all equally likely, so that the density is the same function of the path from whichever end it is walked
//! (docs/derivations/media.md).
//!
//! Every [`Locus`](crate::locus::Locus) names a medium on each of its sides.

mod cells;
mod flight;
mod glow;
mod grid;
mod phase;

pub(crate) use flight::{Drawn, Stretch};
pub use glow::Glow;
pub(crate) use glow::GlowCells;
pub(crate) use grid::Detail;
pub use grid::Grid;
pub use phase::HenyeyGreenstein;

use crate::math::Vec3;
use crate::spectrum::{Lanes, Rgb, Spectrum};
use accel::Aabb;

/// A medium of a scene, by number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MediumId(u8);

impl MediumId {
    /// Empty space.
    pub const VACUUM: Self = Self(0);
    /// The most media of a scene, besides the vacuum.
    pub const MOST: usize = u8::MAX as usize;

    /// Returns the medium with this index in the scene, which does not count the vacuum. None: beyond
    /// [`MOST`](Self::MOST).
    pub(crate) fn new(index: usize) -> Option<Self> {
        u8::try_from(index + 1).ok().map(Self)
    }

    /// Returns the index among the media of a scene. None: the vacuum.
    #[inline]
    pub(crate) fn index(self) -> Option<usize> {
        usize::from(self.0).checked_sub(1)
    }
}

/// The media on both sides of a point. They are equal if there is no boundary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MediumSides {
    /// On the side of the geometric normal.
    pub outside: MediumId,
    /// On the other.
    pub inside: MediumId,
}

impl MediumSides {
    /// Vacuum all around.
    pub const VACUUM: Self = Self::all(MediumId::VACUUM);

    /// Puts one medium on both sides.
    pub const fn all(medium: MediumId) -> Self {
        Self {
            outside: medium,
            inside: medium,
        }
    }

    /// Returns true where two media meet.
    #[inline]
    pub fn is_boundary(self) -> bool {
        self.outside != self.inside
    }

    /// Returns the medium of a ray that leaves along `w`, where `cos` is that of `w` to the geometric normal.
    #[inline]
    pub fn toward(self, cos: f32) -> MediumId {
        if cos < 0.0 { self.inside } else { self.outside }
    }
}

/// A medium of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    field: Field,
    phase: HenyeyGreenstein,
    scatters: bool,
    glow: Option<Glow>,
}

/// The coefficients at a point. Unit: 1/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// σ_t.
    extinction: Rgb,
    /// σ_s.
    scattering: Rgb,
}

/// The coefficients at all points.
#[derive(Clone, Debug, PartialEq)]
enum Field {
    Homogeneous(Coefficients),
    /// Coefficients times a density, in a box.
    Density(Coefficients, Grid<1>),
    /// Coefficients of their own for each channel, in a box.
    Chromatic {
        extinction: Grid<3>,
        scattering: Grid<3>,
    },
}

impl Coefficients {
    /// Makes σ_t = σ_a + σ_s and σ_s. None: a coefficient is negative, or the sum is not finite.
    pub fn new(absorption: Rgb, scattering: Rgb) -> Option<Self> {
        let valid = 0.0..=f32::MAX;
        let mut pairs = absorption.iter().zip(&scattering);
        let is_valid = |(a, s): (&f32, &f32)| {
            valid.contains(a) && valid.contains(s) && valid.contains(&(a + s))
        };
        pairs.all(is_valid).then(|| Self {
            extinction: std::array::from_fn(|i| absorption[i] + scattering[i]),
            scattering,
        })
    }

    /// Returns true if σ_s is not 0.
    const fn scatter(&self) -> bool {
        let [r, g, b] = self.scattering;
        r > 0.0 || g > 0.0 || b > 0.0
    }

    /// Returns σ_a.
    fn absorption(&self) -> Rgb {
        std::array::from_fn(|i| (self.extinction[i] - self.scattering[i]).max(0.0))
    }

    /// Returns both coefficients times a density.
    fn scaled(self, density: f32) -> Self {
        let scale = |rgb: Rgb| rgb.map(|channel| channel * density);
        Self {
            extinction: scale(self.extinction),
            scattering: scale(self.scattering),
        }
    }
}

/// Returns the largest channel.
fn largest(rgb: Rgb) -> f32 {
    rgb.into_iter().fold(0.0, f32::max)
}

impl Medium {
    /// The largest σ_t of a grid, so that products with lengths stay finite.
    pub const DENSEST: f32 = 1e12;

    /// Makes a medium that is the same everywhere.
    pub const fn homogeneous(coefficients: Coefficients, phase: HenyeyGreenstein) -> Self {
        Self {
            field: Field::Homogeneous(coefficients),
            phase,
            scatters: coefficients.scatter(),
            glow: None,
        }
    }

    /// Makes a medium whose coefficients are multiplied by the density of a grid, and are 0 outside its box. None:
    /// σ_t is above [`DENSEST`](Self::DENSEST) somewhere.
    pub fn of_density(
        coefficients: Coefficients,
        density: Grid<1>,
        phase: HenyeyGreenstein,
    ) -> Option<Self> {
        let most = density.most() * largest(coefficients.extinction);
        (most <= Self::DENSEST).then_some(Self {
            field: Field::Density(coefficients, density),
            phase,
            scatters: coefficients.scatter(),
            glow: None,
        })
    }

    /// Makes a medium with the coefficients of two grids, which are 0 outside their box. Unit: 1/m. None: the grids
    /// differ in box or size, or somewhere σ_s is above σ_t, or σ_t above [`DENSEST`](Self::DENSEST).
    pub fn chromatic(
        extinction: Grid<3>,
        scattering: Grid<3>,
        phase: HenyeyGreenstein,
    ) -> Option<Self> {
        let is_valid =
            scattering.is_nowhere_above(&extinction) && extinction.most() <= Self::DENSEST;
        is_valid.then_some(Self {
            scatters: scattering.most() > 0.0,
            field: Field::Chromatic {
                extinction,
                scattering,
            },
            phase,
            glow: None,
        })
    }

    /// Returns the name of its kind.
    pub const fn kind(&self) -> &'static str {
        match &self.field {
            Field::Homogeneous(_) => "homogeneous",
            Field::Density(..) => "density grid",
            Field::Chromatic { .. } => "colour grid",
        }
    }

    /// Returns the box that the medium fills. None: it is endless.
    pub fn bounds(&self) -> Option<Aabb> {
        match &self.field {
            Field::Homogeneous(_) => None,
            Field::Density(_, grid) => Some(grid.bounds()),
            Field::Chromatic { extinction, .. } => Some(extinction.bounds()),
        }
    }

    /// Returns true if it is the same everywhere.
    pub fn is_even(&self) -> bool {
        self.bounds().is_none()
    }

    /// Returns true if paths have vertices in the medium: if it scatters or emits. A medium that only absorbs stops
    /// no walk: T weights the light through it.
    #[inline]
    pub const fn stops_walks(&self) -> bool {
        self.scatters || self.glow.is_some()
    }

    /// Returns the largest σ_t. Unit: 1/m.
    fn most(&self) -> f32 {
        match &self.field {
            Field::Homogeneous(at) => largest(at.extinction),
            Field::Density(at, grid) => grid.most() * largest(at.extinction),
            Field::Chromatic { extinction, .. } => extinction.most(),
        }
    }

    /// Returns the coefficients at a point, which lies in the medium.
    fn at(&self, point: Vec3) -> Coefficients {
        match &self.field {
            Field::Homogeneous(coefficients) => *coefficients,
            Field::Density(coefficients, grid) => {
                let [density] = grid.at(point);
                coefficients.scaled(density)
            }
            Field::Chromatic {
                extinction,
                scattering,
            } => Coefficients {
                extinction: extinction.at(point),
                scattering: scattering.at(point),
            },
        }
    }

    /// Returns σ_t at a point. Unit: 1/m.
    #[inline]
    pub fn extinction(&self, point: Vec3, lanes: Lanes) -> Spectrum {
        lanes.unbounded(self.at(point).extinction)
    }

    /// Returns the scattering of a vertex in the medium.
    #[inline]
    pub fn scattering(&self, point: Vec3, lanes: Lanes) -> MediumScattering {
        let at = self.at(point);
        let [coefficient, extinction] =
            [at.scattering, at.extinction].map(|rgb| lanes.unbounded(rgb));
        let part = |s: f32, t: f32| if t > 0.0 { s / t } else { 0.0 };
        MediumScattering {
            coefficient,
            albedo: coefficient.zip(extinction, part),
            phase: self.phase,
        }
    }
}

/// The scattering of a vertex in a medium: σ_s p.
#[derive(Clone, Copy, Debug)]
pub struct MediumScattering {
    /// σ_s. Unit: 1/m.
    pub coefficient: Spectrum,
    /// σ_s / σ_t.
    pub albedo: Spectrum,
    /// p.
    pub phase: HenyeyGreenstein,
}

#[cfg(test)]
mod tests;
