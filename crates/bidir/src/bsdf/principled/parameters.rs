//! The parameters of a principled surface, and the BSDF that they give.

use super::multiple::LEAST_REFLECTANCE;
use super::sheen::SHEEN_ALPHA;
use super::{Principled, under};
use crate::bsdf::microfacet::Ggx;
use crate::bsdf::multiple::{self, Sides};
use crate::math::{INV_PI, Vec2, sqr};
use crate::spectrum::Spectrum;

/// The medium behind a transparent surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Thickness {
    /// The medium before it: light goes straight on.
    ThinWalled,
    /// The inside of a solid.
    Solid,
}

/// A clear coat of index 1.5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat {
    /// The fraction of the surface that it covers. Range: `[0, 1]`.
    pub cover: f32,
    /// Its slope.
    pub alpha: f32,
}

/// A principled surface at one point, as glTF 2.0 describes it; all shares are in `[0, 1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipledParameters {
    /// The base colour.
    pub color: Spectrum,
    /// The share of metal.
    pub metallic: f32,
    /// The facets of the base, along its grain and across.
    pub ggx: Ggx,
    /// The angle from the tangent to the grain, as cosine and sine.
    pub grain: Vec2,
    /// The index of refraction of the dielectric; 0: it reflects all light.
    pub ior: f32,
    /// The factor of the dielectric's reflectance, at all angles.
    pub specular: f32,
    /// A further factor of the dielectric's reflectance along the normal.
    pub specular_color: Spectrum,
    /// The share of the dielectric that is transparent.
    pub transmission: f32,
    /// The medium behind the surface.
    pub thickness: Thickness,
    /// The share of the opaque rest that transmits light diffusely.
    pub diffuse_transmission: f32,
    /// The colour of diffuse transmission.
    pub diffuse_transmission_color: Spectrum,
    /// The coat.
    pub coat: Coat,
    /// The colour of the sheen; black: there is none.
    pub sheen: Spectrum,
    /// The slope of the sheen.
    pub sheen_alpha: f32,
}

impl PrincipledParameters {
    /// Makes a dielectric of index 1.5 over a diffuse base of `color`, with facets of `ggx`.
    pub const fn plain(color: Spectrum, ggx: Ggx) -> Self {
        Self {
            color,
            metallic: 0.0,
            ggx,
            grain: Vec2::X,
            ior: 1.5,
            specular: 1.0,
            specular_color: Spectrum::ONE,
            transmission: 0.0,
            thickness: Thickness::ThinWalled,
            diffuse_transmission: 0.0,
            diffuse_transmission_color: Spectrum::ONE,
            coat: Coat {
                cover: 0.0,
                alpha: 0.0,
            },
            sheen: Spectrum::ZERO,
            sheen_alpha: 1.0,
        }
    }
}

/// Returns the thickness of a surface of this relative index. An index closer to 1 bends nothing visibly: the surface
/// is thin-walled.
fn thickness(described: Thickness, eta: f32) -> Thickness {
    const LEAST_BEND: f32 = 1e-3;
    if (eta - 1.0).abs() > LEAST_BEND && eta > 0.0 {
        described
    } else {
        Thickness::ThinWalled
    }
}

impl Principled {
    /// Makes the BSDF that `parameters` describe.
    pub fn new(parameters: &PrincipledParameters) -> Self {
        let p = parameters;
        let dielectric = 1.0 - p.metallic;
        let normal = if p.ior > 0.0 {
            sqr((p.ior - 1.0) / (p.ior + 1.0))
        } else {
            1.0
        };
        let f0 = p
            .specular_color
            .map(|color| (normal * color).min(1.0) * p.specular);
        let opaque = dielectric * (1.0 - p.transmission);
        let cover = [f0.max_lane(), p.specular];
        let alpha = p.ggx.mean_alpha();
        let mean_cover = cover[0] + (cover[1] - cover[0]) * under::mean_facet_weight(alpha);
        // A base under a layer that reflects everything is invisible.
        let base = if mean_cover < 0.999 {
            opaque * INV_PI / (1.0 - mean_cover)
        } else {
            0.0
        };
        let glass = if p.ior > 0.0 {
            dielectric * p.transmission
        } else {
            0.0
        };
        let thickness = thickness(p.thickness, p.ior);
        let is_pane = glass > 0.0 && thickness == Thickness::ThinWalled;
        let f0 = f0 * opaque;
        let mirrors = p.metallic > 0.0 || f0.max_lane() > LEAST_REFLECTANCE || is_pane;
        let lost = (mirrors && !p.ggx.is_smooth()).then(|| multiple::mean_of_mirrors(p.ggx));
        Self {
            tint: p.color,
            metal: p.metallic,
            f0,
            f90: p.metallic + p.specular * opaque,
            glass,
            specular: (p.specular * p.specular_color.max_lane()).min(1.0),
            eta: p.ior.max(0.01),
            ggx: p.ggx,
            grain: p.grain,
            diffuse: base * (1.0 - p.diffuse_transmission),
            through: p.diffuse_transmission_color * (base * p.diffuse_transmission),
            cover,
            coat: p.coat.cover,
            coat_alpha: p.coat.alpha,
            sheen: p.sheen,
            sheen_alpha: p.sheen_alpha.clamp(SHEEN_ALPHA, 1.0),
            lost: lost.unwrap_or(0.0),
            lost_through: Sides::NONE,
            thickness,
            coat_normal: super::layers::UPRIGHT,
        }
        .with_lost_through()
    }

    /// Returns the surface of a solid with `index` around it in place of air.
    pub(in crate::bsdf) fn within(self, index: f32) -> Self {
        let eta = self.eta / index;
        Self {
            eta,
            thickness: thickness(Thickness::Solid, eta),
            ..self
        }
        .with_lost_through()
    }

    /// Adds the light that facets of the transparent part lose at this index.
    fn with_lost_through(self) -> Self {
        let is_solid =
            self.glass > 0.0 && self.thickness == Thickness::Solid && !self.ggx.is_smooth();
        Self {
            lost_through: if is_solid {
                Sides::new(self.ggx, self.eta)
            } else {
                Sides::NONE
            },
            ..self
        }
    }

    pub(in crate::bsdf) fn examples() -> impl Iterator<Item = (&'static str, Self)> {
        let color = Spectrum([0.8, 0.5, 0.1, 0.9]);
        let plain = |x, y| PrincipledParameters::plain(color, Ggx::new(x, y));
        let glass = |alpha, thickness| PrincipledParameters {
            transmission: 1.0,
            thickness,
            ..plain(alpha, alpha)
        };
        let coated = |alpha: f32, coat: f32| PrincipledParameters {
            coat: Coat {
                cover: 0.8,
                alpha: coat,
            },
            ..plain(alpha, alpha)
        };
        let white = PrincipledParameters {
            color: Spectrum::ONE,
            ..coated(0.3, 0.2)
        };
        let metal = PrincipledParameters {
            metallic: 1.0,
            grain: Vec2::new(0.8, 0.6),
            ..plain(0.6, 0.2)
        };
        let cloth = PrincipledParameters {
            sheen: Spectrum([0.3, 0.6, 0.9, 0.0]),
            sheen_alpha: 0.3,
            ..coated(0.8, 0.1)
        };
        let leaf = PrincipledParameters {
            diffuse_transmission: 0.4,
            diffuse_transmission_color: Spectrum([0.2, 0.9, 0.3, 0.1]),
            metallic: 0.2,
            ..plain(0.0, 0.0)
        };
        let half = PrincipledParameters {
            transmission: 0.5,
            metallic: 0.2,
            specular: 0.7,
            ior: 1.8,
            ..glass(0.4, Thickness::Solid)
        };
        let lacquered = PrincipledParameters {
            metallic: 1.0,
            ..coated(0.0, 0.0)
        };
        let mixed = PrincipledParameters {
            transmission: 0.6,
            thickness: Thickness::Solid,
            ..coated(0.0, 0.0)
        };
        [
            ("principled plastic", plain(0.25, 0.25)),
            ("principled plastic, smooth", plain(0.0, 0.0)),
            ("principled metal, brushed", metal),
            ("principled white, coated", white),
            ("principled, smooth coat", coated(0.4, 0.0)),
            ("principled metal, smooth under smooth coat", lacquered),
            ("principled cloth", cloth),
            ("principled leaf", leaf),
            ("principled pane, rough", glass(0.3, Thickness::ThinWalled)),
            ("principled pane", glass(0.0, Thickness::ThinWalled)),
            ("principled glass, rough", glass(0.3, Thickness::Solid)),
            ("principled glass", glass(0.0, Thickness::Solid)),
            ("principled, half of glass", half),
            (
                "principled, smooth and part of glass under smooth coat",
                mixed,
            ),
        ]
        .into_iter()
        .map(|(name, parameters)| (name, Self::new(&parameters)))
    }
}
