//! The frames by which a surface is seen: shading normals turn towards a camera that they would face away from.
//!
//! With o the direction from a vertex towards the camera's end of its path, N and S the geometric and the shading
//! normal on the side of o, and κ = min(¾ o·N, 0.15), a layer scatters by the normal S',
//!
//! - S where that is near enough: where o·S ≥ κ_d if it scatters diffusely, and elsewhere where r·N ≥ κ, with
//!   r = 2 (o·S) S - o the mirrored direction;
//! - else the nearest to S that has o·S' = κ_d, or the one that mirrors o to r, lifted until r·N = κ.
//!
//! κ_d = κ + g (o·N - κ) / 2 with the gloss g of facets over what is diffuse: the smoother they are, the nearer to the
//! horizon r may come at most, and the less of it they mirror.
//!
//! S' depends on the path alone, and so does its value, whichever end a walk came from. Walks from a light do not know
//! o, and draw by S (docs/derivations/mis-weights.md#shading-normals).

use super::Vertex;
use super::scatter::Side;
use crate::bsdf::{Bsdf, BsdfSample, BsdfValue, Layer, Lobes, TransportMode};
use crate::math::{Frame, Vec2, Vec3};
use crate::spectrum::Spectrum;

/// The greatest κ.
pub(super) const MOST_LEAST: f32 = 0.15;
/// The greatest part of o·N that κ is.
pub(super) const LEAST_PART: f32 = 0.75;

/// Returns the least cosine between o and S', or between the mirrored direction and N, where o·N is `cos`.
#[inline]
pub(super) fn least_cosine(cos: f32) -> f32 {
    (LEAST_PART * cos).min(MOST_LEAST)
}

/// Returns κ_d: the least cosine between o and S' of a diffuse layer under facets of this gloss.
#[inline]
fn least_diffuse_cosine(cos: f32, gloss: f32) -> f32 {
    let least = least_cosine(cos);
    least + 0.5 * gloss * (cos - least)
}

/// Returns S' of a layer with `lobes` for the unit direction `o`, on the side of `n_s`; o·N > 0. None: it is `n_s`.
fn turned(n_s: Vec3, n_g: Vec3, o: Vec3, lobes: Lobes) -> Option<Vec3> {
    let side = 1f32.copysign(n_g.dot(o));
    let (n_s, n_g) = (n_s * side, n_g * side);
    let (cos, along) = (n_g.dot(o), n_s.dot(o));
    let least = least_cosine(cos);
    let within = |height: f32| (1.0 - height * height).max(0.0).sqrt();
    let normal = match lobes {
        Lobes::Diffuse(gloss) => {
            let least = least_diffuse_cosine(cos, gloss);
            if along >= least {
                return None;
            }
            o * least + (n_s - o * along).normalize_or_zero() * within(least)
        }
        Lobes::Glossy => {
            let mirrored = n_s * (2.0 * along.max(0.0)) - o;
            let height = mirrored.dot(n_g);
            if height >= least {
                return None;
            }
            let flat = (mirrored - n_g * height).normalize_or_zero();
            o + n_g * least + flat * within(least)
        }
    };
    let normal = normal.normalize_or(n_g);
    let is_in_front = normal.dot(n_g) > 0.0;
    Some(if is_in_front { normal } else { n_g } * side)
}

/// The frames of a surface's layers: of its base, and of a clear coat with a normal of its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frames {
    base: Frame,
    coat: Option<Frame>,
}

impl Frames {
    /// Returns a direction in each frame.
    fn to_local(self, w: Vec3) -> [Vec3; 2] {
        let base = self.base.to_local(w);
        [base, self.coat.map_or(base, |coat| coat.to_local(w))]
    }

    /// Draws a direction for `wo` as `Bsdf::sample` does. None: nothing is scattered.
    fn sample(
        &self,
        bsdf: &Bsdf,
        wo: Vec3,
        mode: TransportMode,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<Drawn> {
        let local = self.to_local(wo);
        if let (Bsdf::Principled(layers), Some(coat)) = (bsdf, &self.coat) {
            let (layer, wi) = layers.sample_layers(local, u_lobe, u)?;
            let frame = match layer {
                Layer::Base => &self.base,
                Layer::Coat => coat,
            };
            return Some(Drawn::Finite(frame.to_world(wi), wi.z));
        }
        let sample = bsdf.sample(local[0], mode, || u_lobe, u)?;
        let wi = self.base.to_world(sample.wi);
        Some(if sample.is_delta {
            Drawn::Dirac(BsdfSample { wi, ..sample })
        } else {
            Drawn::Finite(wi, sample.wi.z)
        })
    }
}

/// Returns `w` or its opposite, by the sign of `agreement`: walks from a light that draw a direction which the normals
/// see on different sides take its opposite. These two parts of the sphere are images of each other.
pub(super) fn on_side(w: Vec3, agreement: f32) -> Vec3 {
    if agreement < 0.0 { -w } else { w }
}

/// A direction drawn in world space.
enum Drawn {
    /// From the lobes that are not Dirac, with its cosine in the frame of its layer.
    Finite(Vec3, f32),
    /// From a Dirac lobe, with its weight and coefficients.
    Dirac(BsdfSample),
}

impl Vertex {
    /// Returns true if the base scatters between `o`, towards the camera, and any other direction by the frame of the
    /// vertex, and so does all else.
    #[inline]
    pub(super) fn is_seen_plainly(&self, bsdf: &Bsdf, o: &Side) -> bool {
        let (along, cos) = (o.local.z * 1f32.copysign(o.cos_g), o.cos_g.abs());
        // What mirrors above the surface is seen by diffuse layers, too: then o·S ≥ (o·N + κ) / 2 ≥ κ_d.
        let height = 2.0 * along * self.frame.z.dot(self.locus.n_g) - cos;
        let is_near = cos > 0.0 && height >= least_cosine(cos);
        (is_near || self.is_near_enough(bsdf, o.world)) && bsdf.coat_normal().is_none()
    }

    #[cold]
    #[inline(never)]
    fn is_near_enough(&self, bsdf: &Bsdf, o: Vec3) -> bool {
        turned(self.frame.z, self.locus.n_g, o, bsdf.lobes()).is_none()
    }

    /// Returns the frames of the layers, none of them turned.
    pub(super) fn frames(&self, bsdf: &Bsdf) -> Frames {
        let coat = bsdf.coat_normal().map(|n| self.frame.to_world(n));
        Frames {
            base: self.frame,
            coat: coat.map(Frame::from_z),
        }
    }

    /// Returns the frames, turned towards the direction `o` to the camera. None: no layer has to turn.
    pub(super) fn frames_toward(&self, bsdf: &Bsdf, o: Vec3) -> Option<Frames> {
        let plain = self.frames(bsdf);
        let turn = |frame: &Frame, lobes: Lobes| {
            let z = turned(frame.z, self.locus.n_g, o, lobes)?;
            Some(Frame::from_z_and_tangent(z, frame.x))
        };
        let base = turn(&plain.base, bsdf.lobes());
        let coat = plain.coat.and_then(|coat| turn(&coat, Lobes::Glossy));
        (base.is_some() || coat.is_some()).then(|| Frames {
            base: base.unwrap_or(plain.base),
            coat: coat.or(plain.coat),
        })
    }

    /// Returns value and densities between two directions of a walk, as
    /// [`ScatteringEvent`](super::ScatteringEvent) does, where frames turn. The value is that of the turned frames, by
    /// which camera walks draw, too; light walks do not know the camera, and draw by the frames that have not turned.
    #[cold]
    #[inline(never)]
    pub(super) fn value_by_frames(
        &self,
        bsdf: &Bsdf,
        [wo, wi]: [Vec3; 2],
        mode: TransportMode,
    ) -> BsdfValue {
        let camera = match mode {
            TransportMode::Radiance => wo,
            TransportMode::Importance => wi,
        };
        let plain = self.frames(bsdf);
        let Some(seen) = self.frames_toward(bsdf, camera) else {
            return self.value_in(
                bsdf,
                &plain,
                [wo, wi].map(|w| plain.to_local(w)),
                [wo, wi],
                mode,
            );
        };
        let locals = [wo, wi].map(|w| seen.to_local(w));
        let by_camera = self.value_in(bsdf, &seen, locals, [wo, wi], mode);
        let cos_g = self.locus.n_g.dot(camera);
        let drawn = plain
            .to_local(camera)
            .map(|local| on_side(local, local.z * cos_g));
        let light = |w: Vec3| if self.faces(&plain, w) { 1.0 } else { 0.0 };
        let [pdf, pdf_reverse] = match mode {
            TransportMode::Radiance => {
                let locals = [drawn, plain.to_local(wi)];
                let by_light = self.value_in(bsdf, &plain, locals, [wo, wi], mode);
                [by_camera.pdf, by_light.pdf_reverse * light(wi)]
            }
            TransportMode::Importance => {
                let locals = [plain.to_local(wo), drawn];
                let by_light = self.value_in(bsdf, &plain, locals, [wo, wi], mode);
                [by_light.pdf * light(wo), by_camera.pdf_reverse]
            }
        };
        BsdfValue {
            pdf,
            pdf_reverse,
            ..by_camera
        }
    }

    /// Returns true where the normals of surface and frame agree on the side of `w`, for some layer.
    pub(super) fn faces(&self, frames: &Frames, w: Vec3) -> bool {
        let cos_g = self.locus.n_g.dot(w);
        frames.to_local(w).iter().any(|local| local.z * cos_g > 0.0)
    }

    /// Returns the value by these frames, where both directions are `locals`, f with the ratio of cosines of each layer
    /// that sees the light.
    fn value_in(
        &self,
        bsdf: &Bsdf,
        frames: &Frames,
        [o, i]: [[Vec3; 2]; 2],
        [wo, wi]: [Vec3; 2],
        mode: TransportMode,
    ) -> BsdfValue {
        let (light, locals) = match mode {
            TransportMode::Radiance => (wi, i),
            TransportMode::Importance => (wo, o),
        };
        let cos_g = self.locus.n_g.dot(light);
        let ratios = locals.map(|local| (local.z / cos_g).max(0.0));
        let value = if let (Bsdf::Principled(layers), Some(_)) = (bsdf, frames.coat) {
            layers.eval_layers([o, i], ratios, mode)
        } else {
            let value = bsdf.eval(o[0], i[0], mode);
            let f = value.f * ratios[0];
            BsdfValue { f, ..value }
        };
        let is_on_edge = self.locus.n_g.dot(wo) == 0.0 || cos_g == 0.0;
        BsdfValue {
            f: if is_on_edge { Spectrum::ZERO } else { value.f },
            albedo_reverse: self.albedo(wi).max_lane(),
            ..value
        }
    }

    /// Draws the next direction of a walk, as [`sample_scatter`](Self::sample_scatter) does, where layers are not seen by
    /// the frame of the vertex.
    #[cold]
    #[inline(never)]
    pub(super) fn sample_by_frames(
        &self,
        bsdf: &Bsdf,
        mode: TransportMode,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let plain = self.frames(bsdf);
        let frames = match mode {
            TransportMode::Radiance => self.frames_toward(bsdf, self.wo).unwrap_or(plain),
            TransportMode::Importance if self.faces(&plain, self.wo) => plain,
            TransportMode::Importance => return None,
        };
        let sample = match frames.sample(bsdf, self.wo, mode, u_lobe, u)? {
            Drawn::Finite(wi, _) if mode == TransportMode::Radiance => {
                return self.finite_scattered(bsdf, wi, mode);
            }
            Drawn::Finite(wi, cos) => {
                let wi = on_side(wi, cos * self.locus.n_g.dot(wi));
                return self.finite_scattered(bsdf, wi, mode);
            }
            Drawn::Dirac(sample) => sample,
        };
        // Walks from a light draw no Dirac lobe by a frame that they do not know.
        (mode == TransportMode::Radiance && self.faces(&frames, sample.wi)).then(|| BsdfSample {
            pdf_reverse: 0.0,
            albedo_reverse: self.albedo(sample.wi).max_lane(),
            ..sample
        })
    }

    /// Returns the direction `wi`, drawn from the lobes that are not Dirac, where frames depend on the camera. None:
    /// nothing is scattered there.
    #[cold]
    #[inline(never)]
    pub(super) fn finite_scattered(
        &self,
        bsdf: &Bsdf,
        wi: Vec3,
        mode: TransportMode,
    ) -> Option<BsdfSample> {
        let value = self.value_by_frames(bsdf, [self.wo, wi], mode);
        let cos_g = self.locus.n_g.dot(wi).abs();
        (value.pdf > 0.0 && !value.f.is_black()).then(|| BsdfSample {
            wi,
            weight: value.f * (cos_g / value.pdf),
            pdf: value.pdf,
            pdf_reverse: value.pdf_reverse,
            albedo_reverse: value.albedo_reverse,
            is_delta: false,
        })
    }
}

#[cfg(test)]
mod tests;
