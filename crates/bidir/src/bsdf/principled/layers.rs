//! A clear coat whose normal differs from that of the base: lobes in two frames, chosen together.
//!
//! Each factor that depends on the coat and one direction, its lobe and the light that it leaves, is a function of
//! the direction in the coat's frame; all other factors are functions of the direction in the base's frame. The
//! mirrored directions of the two do not coincide. Hence smooth facets become slightly rough ones, hardly visibly,
//! and no lobe is Dirac.

use super::{Lobe, Principled};
use crate::bsdf::Lobes;
use crate::bsdf::microfacet::{Ggx, SMOOTH_ALPHA};
use crate::math::{Vec2, Vec3};

/// The slope of facets that would otherwise be smooth.
const LEAST_ALPHA: f32 = 2.0 * SMOOTH_ALPHA;

/// The normal of a coat, in the frame of its base, if both have one frame.
pub(super) const UPRIGHT: [i16; 3] = [0, 0, i16::MAX];

/// A layer with a frame of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// All but the coat.
    Base,
    /// The clear coat.
    Coat,
}

impl Principled {
    /// Returns the kinds of lobes of its base.
    pub(in crate::bsdf) fn lobes(&self) -> Lobes {
        let is_glossy = self.diffuse <= 0.0 && self.through.is_black() && self.sheen.is_black();
        if is_glossy {
            Lobes::Glossy
        } else {
            let facets = (self.f90 + self.glass).min(1.0);
            Lobes::Diffuse(facets * self.ggx.gloss())
        }
    }

    /// Returns the normal of the coat, in the frame of the base. None: they have one frame.
    #[inline]
    pub(in crate::bsdf) fn coat_normal(&self) -> Option<Vec3> {
        let normal = || Vec3::from(self.coat_normal.map(f32::from)).normalize();
        (self.coat_normal != UPRIGHT).then(normal)
    }

    /// Sets the normal `n` of the coat, if there is one.
    pub(in crate::bsdf) fn put_coat_normal(&mut self, n: Vec3) {
        let steps = (n * f32::from(i16::MAX)).round().to_array();
        let coat_normal = steps.map(|step| step as i16);
        if self.coat <= 0.0 || coat_normal == UPRIGHT {
            return;
        }
        self.coat_normal = coat_normal;
        self.coat_alpha = self.coat_alpha.max(LEAST_ALPHA);
        if self.ggx.is_smooth() {
            self.ggx = Ggx::new(LEAST_ALPHA, LEAST_ALPHA);
        }
    }

    /// Draws a direction like `sample`, for `wo` in the frames of base and coat. The result is in the frame of the
    /// returned layer. None: nothing is scattered.
    pub(crate) fn sample_layers(
        &self,
        [base, coat]: [Vec3; 2],
        u_lobe: f32,
        u: Vec2,
    ) -> Option<(Layer, Vec3)> {
        let base = self.along_grain(base);
        let shares = self.shares(base, &self.layers_between([base, coat]));
        let (lobe, rest) = self.probs_of(&shares)?.choose(u_lobe);
        if lobe == Lobe::Coat {
            let wi = self.coat_ggx().sample_mirror(coat, u)?;
            return Some((Layer::Coat, wi));
        }
        let wi = self.sample_lobe(lobe, base, rest, u)?;
        Some((Layer::Base, self.off_grain(wi)))
    }
}
