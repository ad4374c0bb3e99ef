//! Connections of two diffuse vertices, from what each of them knows beforehand.
//!
//! With d² the squared distance of z and y, w the direction from z to y, n_g and n_s the normals on the side
//! that the walk came from, and f = ρ/π,
//!
//! C = (β f |ω·n_s| / |ω·n_g|)_z (β f)_y (n_g·w)_z (n_s·-w)_y / d²,
//!
//! as [`JoinedPath::contribution`](super::JoinedPath::contribution) has it with G and scattering at both ends. The
//! density r of an end drawn from the other is q cos_s / π there · cos_g / d² here, and that of the vertex before it
//! does not depend on the other end. So the [`EndSums`] of each end become one number k, and the weight is
//!
//! w = n / (n + r_z k_z + r_y k_y).
//!
//! [`JoinedPath`](super::JoinedPath) and [`PathSums`](super::PathSums) are the specification, for every kind of
//! vertex; the two agree but for rounding.

use super::densities::factor;
use super::running::EndSums;
use super::segment::inverse;
use super::{MisHeuristic, PathContext, Scattering, Vertex};
use crate::bsdf::{Bsdf, TransportMode};
use crate::guide::Cell;
use crate::math::{INV_PI, Vec3};
use crate::spectrum::Spectrum;

/// A diffuse vertex of a walk, with all that its connections with other ones need: a line of memory.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct DiffuseEnd {
    point: Vec3,
    /// k.
    others: f32,
    /// The geometric normal on the side of the walk.
    n_g: Vec3,
    /// q / π, with q the roulette's part.
    density: f32,
    /// The shading normal on the side of the walk.
    n_s: Vec3,
    cell: Cell,
    is_diffuse: bool,
    /// β f, at a light vertex with the ratio of cosines.
    flux: Spectrum,
}

const _: () = assert!(size_of::<DiffuseEnd>() == 64);

impl DiffuseEnd {
    /// Any other vertex.
    const NONE: Self = Self {
        point: Vec3::ZERO,
        others: 0.0,
        n_g: Vec3::ZERO,
        density: 0.0,
        n_s: Vec3::ZERO,
        cell: Cell::FIRST,
        is_diffuse: false,
        flux: Spectrum::ZERO,
    };

    /// `vertex` of a walk of `mode`, with the sums there, which hold for all of its connections. [None](Self::NONE)
    /// where it is not diffuse, where nothing is scattered, where rays from it may go through media, or where weights are
    /// not those of the balance heuristic with one roulette for paths of any length.
    pub(super) fn new(
        context: &PathContext<'_>,
        vertex: &Vertex,
        sums: &EndSums,
        mode: TransportMode,
    ) -> Self {
        let settings = context.job.settings;
        let is_even = settings.roulette.density_start().unwrap_or(0) == 0;
        let is_balance = settings.mis == MisHeuristic::Balance;
        let is_clear = context.job.scene.is_clear_around(&vertex.locus);
        let [cos_s, cos_g] = [vertex.frame.z, vertex.locus.n_g].map(|n| n.dot(vertex.wo));
        match &vertex.scattering {
            Scattering::Surface(Bsdf::Diffuse(bsdf))
                if is_balance && is_even && is_clear && cos_s * cos_g > 0.0 =>
            {
                let rho = bsdf.reflectance;
                let roulette = |albedo: f32| factor(context, usize::MAX, || albedo);
                let before = cos_s.abs() * INV_PI * vertex.to_previous * roulette(rho.max_lane());
                let ratio = match mode {
                    TransportMode::Radiance => 1.0,
                    TransportMode::Importance => (cos_s / cos_g).abs(),
                };
                Self {
                    point: vertex.locus.point,
                    others: sums.per_density(before.into()).min(f64::from(f32::MAX)) as f32,
                    n_g: vertex.locus.n_g * 1f32.copysign(cos_g),
                    density: INV_PI * roulette(vertex.albedo_fwd),
                    n_s: vertex.frame.z * 1f32.copysign(cos_s),
                    cell: vertex.cell,
                    is_diffuse: true,
                    flux: vertex.beta * (rho * (INV_PI * ratio)),
                }
            }
            _ => Self::NONE,
        }
    }

    /// Itself, if it is one.
    #[inline]
    pub(super) fn get(&self) -> Option<&Self> {
        self.is_diffuse.then_some(self)
    }

    /// Its cell.
    #[inline]
    pub(crate) fn cell(&self) -> Cell {
        self.cell
    }

    /// C of the connection of the light vertex `self` with the camera vertex `y`, before visibility, and its weight,
    /// where its strategy takes `count` samples. None: C is zero.
    #[inline]
    pub fn connect(&self, y: &Self, count: f32) -> Option<(Spectrum, f32)> {
        let z = self;
        let across = y.point - z.point;
        let inverse2 = inverse(across.length_squared());
        let w = across * inverse2.sqrt();
        let [g_z, s_z] = [z.n_g.dot(w), z.n_s.dot(w)];
        let [g_y, s_y] = [-y.n_g.dot(w), -y.n_s.dot(w)];
        // Not true of a NaN.
        if [g_z, s_z, g_y, s_y].map(|cos| cos > 0.0) != [true; 4] {
            return None;
        }
        let contribution = z.flux * y.flux * (g_z * s_y * inverse2);
        let r_z = y.density * s_y * (g_z * inverse2);
        let r_y = z.density * s_z * (g_y * inverse2);
        let weight = count / (count + (r_z * z.others + r_y * y.others));
        (!contribution.is_black()).then_some((contribution, weight))
    }
}
