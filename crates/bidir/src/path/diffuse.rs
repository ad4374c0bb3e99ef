//! Connections of diffuse vertices, from what each of them knows beforehand: four at a time with each other, one by
//! one with light points and lens points.
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
//! With a light point x_0 that was drawn with density e, or a lens point x, half of that remains: with W its emission
//! or importance, r the density of the vertex drawn from there, r_0 that of x_0 drawn from the vertex, a_0 that of x_0
//! as the start of a light walk, and k' the number k where the rest of the path is one vertex,
//!
//! C = (β W)_x (β f)_y (n_s·w)_y cos_g(x) / d²,    w = n / (n + r_0 / e + (a_0 / e) r k),
//! C = (β W)_x (β f …)_z (n_g·w)_z cos_g(x) / d²,    w = n / (n + r k').
//!
//! r_0 / e is absent for a light that no ray can hit; an end at infinity has neither d² nor a cosine.
//!
//! Where the camera's direction turns the shading normal (`visible`), a camera vertex is none of these, and connections
//! of a light vertex are [general](DiffuseConnections::get).
//!
//! [`JoinedPath`](super::JoinedPath) and [`PathSums`](super::PathSums) are the specification, for every kind of
//! vertex; the two agree but for rounding. No lane depends on the other lanes.

use super::densities::factor;
use super::running::EndSums;
use super::strategy_class::{Bounce, PathStart};
use super::visible::{LEAST_PART, MOST_LEAST, least_cosine};
use super::{Job, MisHeuristic, Scattering, Segment, Vertex};
use crate::bsdf::{Bsdf, TransportMode};
use crate::guide::Cell;
use crate::math::lanes::{Vec3x4, dot, dot_each, gather, offset};
use crate::math::{INV_PI, Vec3};
use crate::spectrum::{FourSpectra, Spectrum};
use glam::Vec4;

/// A diffuse vertex of a walk, with all that its connections with other ones need, in one cache line.
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
    /// Any other vertex, whose connections are zero.
    pub const NONE: Self = Self {
        point: Vec3::ZERO,
        others: 0.0,
        n_g: Vec3::ZERO,
        density: 0.0,
        n_s: Vec3::ZERO,
        cell: Cell::FIRST,
        is_diffuse: false,
        flux: Spectrum::ZERO,
    };

    /// Returns `vertex` of a walk of `mode`, with the sums there, which hold for all of its connections.
    /// [None](Self::NONE) where it is not diffuse, where nothing is scattered, where the camera sees another shading
    /// normal, where rays from it may go through media, or where weights are not those of the balance heuristic with
    /// one roulette for paths of any length.
    pub(super) fn new(job: &Job<'_>, vertex: &Vertex, sums: &EndSums, mode: TransportMode) -> Self {
        let settings = job.settings;
        let is_even = settings.roulette.density_start().unwrap_or(0) == 0;
        let is_balance = settings.mis == MisHeuristic::Balance;
        let is_clear = job.scene.is_clear_around(&vertex.locus);
        let [cos_s, cos_g] = [vertex.frame.z, vertex.locus.n_g].map(|n| n.dot(vertex.wo));
        let least = match mode {
            TransportMode::Radiance => least_cosine(cos_g.abs()),
            TransportMode::Importance => 0.0,
        };
        let is_facing = cos_s * cos_g > 0.0 && cos_s.abs() >= least;
        match &vertex.scattering {
            Scattering::Surface(Bsdf::Diffuse(bsdf))
                if is_balance && is_even && is_clear && is_facing =>
            {
                let ratio = match mode {
                    TransportMode::Radiance => 1.0,
                    TransportMode::Importance => (cos_s / cos_g).abs(),
                };
                let end = Self {
                    point: vertex.locus.point,
                    others: 0.0,
                    n_g: vertex.locus.n_g * 1f32.copysign(cos_g),
                    density: INV_PI * factor(job, usize::MAX, || vertex.albedo_fwd),
                    n_s: vertex.frame.z * 1f32.copysign(cos_s),
                    cell: vertex.cell,
                    is_diffuse: true,
                    flux: vertex.beta * (bsdf.reflectance * (INV_PI * ratio)),
                };
                let others = sums.per_density(Bounce::Deeper, end.before(vertex));
                Self {
                    others: others.min(f64::from(f32::MAX)) as f32,
                    ..end
                }
            }
            _ => Self::NONE,
        }
    }

    /// Returns r', the density of the vertex before `vertex`, of which this was made, drawn from here by a walk that
    /// arrives from the other end. It is the same for all directions of arrival.
    #[inline]
    fn before(&self, vertex: &Vertex) -> f64 {
        f64::from(self.n_s.dot(vertex.wo) * self.density * vertex.to_previous)
    }

    /// Itself, if it is one.
    #[inline]
    pub(super) fn get(&self) -> Option<&Self> {
        self.is_diffuse.then_some(self)
    }

    /// Returns its cell.
    #[inline]
    pub(crate) fn cell(&self) -> Cell {
        self.cell
    }

    /// Returns C and the weight of next-event estimation at this vertex, number `t` of a camera subpath: `x0` was drawn
    /// for it with density `e`, and `segment` leads there. None: C is zero.
    #[inline]
    pub fn next_event(
        &self,
        job: &Job<'_>,
        t: usize,
        x0: &Vertex,
        e: f32,
        segment: &Segment,
    ) -> Option<(Spectrum, f32)> {
        let cos_s = self.n_s.dot(segment.w);
        let contribution = self.contribution(job, x0, segment, cos_s)?;
        let start = PathStart::new(job, x0, e);
        let to_light = f64::from(self.density * cos_s * segment.to_b);
        // r_0 / e, and (a_0 / e) r.
        let hit = start.is_hit * (to_light / start.e);
        let a1 = f64::from(x0.pdf_leaving(job, -segment.w) * segment.to_a);
        let drawn = start.a0 / start.e * a1;
        let n = job.count(1, t, [x0.cell, self.cell]);
        let others = hit + drawn * f64::from(self.others);
        Some((contribution, (n / (n + others)) as f32))
    }

    /// Returns true where the direction `w` from this light vertex towards the camera sees another shading normal.
    #[inline]
    pub fn is_turned(&self, w: Vec3) -> bool {
        let cos_g = self.n_g.dot(w);
        cos_g > 0.0 && self.n_s.dot(w) < least_cosine(cos_g)
    }

    /// Returns C and the weight of the light image of `vertex`, which this is, number `s` of a light subpath with these
    /// `sums`: `segment` leads to the lens point, by whose direction nothing [turns](Self::is_turned). None: C is zero.
    #[inline]
    pub fn light_image(
        &self,
        job: &Job<'_>,
        s: usize,
        vertex: &Vertex,
        sums: &EndSums,
        lens: &Vertex,
        segment: &Segment,
    ) -> Option<(Spectrum, f32)> {
        let cos_g = self.n_g.dot(segment.w);
        let contribution = self.contribution(job, lens, segment, cos_g)?;
        let drawn = f64::from(lens.pdf_leaving(job, -segment.w) * segment.to_a);
        let n = job.count(s, 1, [self.cell, lens.cell]);
        let others = drawn * sums.per_density(Bounce::First, self.before(vertex));
        Some((contribution, (n / (n + others)) as f32))
    }

    /// Returns C of a connection with the `end` of a path, to which `segment` leads, where `cos` is that to n_s at a
    /// camera vertex, to n_g at a light vertex. None: it is zero.
    #[inline]
    fn contribution(
        &self,
        job: &Job<'_>,
        end: &Vertex,
        segment: &Segment,
        cos: f32,
    ) -> Option<Spectrum> {
        let Segment { w, to_b, .. } = *segment;
        let is_ahead = self.n_g.dot(w) > 0.0 && self.n_s.dot(w) > 0.0 && to_b > 0.0;
        if !is_ahead {
            return None;
        }
        let contribution = end.leaving(job, -w) * end.beta * self.flux * (cos * to_b);
        (!contribution.is_black()).then_some(contribution)
    }

    /// Returns the connections of the camera vertex `self` with four light vertices, before visibility, where the
    /// strategy of each takes so many samples.
    #[inline]
    pub fn connect(&self, z: [&Self; 4], counts: [f32; 4]) -> DiffuseConnections {
        let (y, lanes, counts) = (self, DiffuseLanes::of(z), Vec4::from(counts));
        let across = offset(y.point, &lanes.point);
        let inverse2 = inverse(dot(&across, &across));
        let w = across.map(|lanes| lanes * inverse2.sqrt());
        let [g_z, s_z] = [dot(&lanes.n_g, &w), dot(&lanes.n_s, &w)];
        let [g_y, s_y] = [-dot_each(y.n_g, &w), -dot_each(y.n_s, &w)];
        // Not true of a NaN.
        let [a, c, d] = [g_z, g_y, s_y].map(|cos| cos.cmpgt(Vec4::ZERO));
        let least = (g_z * LEAST_PART).min(Vec4::splat(MOST_LEAST));
        let b = s_z.cmpge(least);
        let turned = a & c & !b;
        let factors = g_z * s_y * inverse2;
        let r_z = y.density * s_y * (g_z * inverse2);
        let r_y = lanes.density * s_z * (g_y * inverse2);
        let weights = counts / (counts + (r_z * lanes.others + r_y * y.others));
        let factors = Vec4::select(a & b & c & d, factors, Vec4::ZERO);
        DiffuseConnections {
            contributions: FourSpectra::of(z.map(|z| z.flux)) * y.flux * factors,
            weights,
            turned: turned.bitmask(),
        }
    }
}

/// Connections of a diffuse camera vertex with four diffuse light vertices, before visibility.
pub struct DiffuseConnections {
    /// C, which may be zero: where either end scatters nothing to the other, it is.
    pub(crate) contributions: FourSpectra,
    pub(crate) weights: Vec4,
    /// A bit for each connection that has to be found as that of any two vertices: it sees another shading normal at z.
    pub(crate) turned: u32,
}

impl DiffuseConnections {
    /// Returns C and the weight of number `lane`. None: it has to be found as that of any two vertices.
    #[inline]
    pub fn get(&self, lane: usize) -> Option<(Spectrum, f32)> {
        let is_turned = self.turned >> lane & 1 == 1;
        (!is_turned).then(|| (self.contributions.each()[lane], self.weights[lane]))
    }
}

/// Four vertices.
struct DiffuseLanes {
    point: Vec3x4,
    others: Vec4,
    n_g: Vec3x4,
    density: Vec4,
    n_s: Vec3x4,
}

impl DiffuseLanes {
    #[inline]
    fn of(ends: [&DiffuseEnd; 4]) -> Self {
        let (point, others) = gather(ends.map(|end| (end.point, end.others)));
        let (n_g, density) = gather(ends.map(|end| (end.n_g, end.density)));
        let (n_s, _) = gather(ends.map(|end| (end.n_s, 0.0)));
        Self {
            point,
            others,
            n_g,
            density,
            n_s,
        }
    }
}

/// Returns 1 / `x` lane by lane; 0 where that is infinite or no number.
#[inline]
fn inverse(x: Vec4) -> Vec4 {
    let inverse = Vec4::ONE / x;
    Vec4::select(inverse.cmplt(Vec4::INFINITY), inverse, Vec4::ZERO)
}
