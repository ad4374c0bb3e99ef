//! Mappings from points of a surface to the plane or space in which a texture is defined.
//!
//! Texture space is the space of the `Texture` directive in a scene file; the map to it from the world is here.
//! Points of objects are mapped from their position in the world.

use super::{Footprint, RequiredInputs, TexturePoint};
use crate::math::{Affine2, Affine3A, PI, Vec2, Vec3, sqr};

/// The space of a texture.
#[derive(Clone, Copy, Debug)]
pub struct TextureSpace {
    from_world: Affine3A,
    /// The largest factor by which lengths along an axis of the world grow.
    stretch: f32,
}

impl TextureSpace {
    /// The world's own space.
    pub const WORLD: Self = Self {
        from_world: Affine3A::IDENTITY,
        stretch: 1.0,
    };

    /// Makes the space with the map `from_world`.
    pub fn new(from_world: Affine3A) -> Self {
        let m = from_world.matrix3;
        let columns = [m.x_axis, m.y_axis, m.z_axis].map(|axis| Vec3::from(axis).length());
        Self {
            from_world,
            stretch: columns.into_iter().fold(0.0, f32::max),
        }
    }

    /// Returns the point in this space.
    #[inline]
    pub fn point(&self, at: &TexturePoint) -> Vec3 {
        self.from_world.transform_point3(at.point)
    }

    /// Returns an upper bound of the width of a pixel in this space.
    #[inline]
    pub fn width(&self, at: &TexturePoint) -> f32 {
        self.stretch * at.footprint.width
    }

    /// Converts a gradient in this space to the world.
    #[inline]
    fn gradient(&self, local: Vec3) -> Vec3 {
        self.from_world.matrix3.transpose() * local
    }
}

/// A mapping from a surface to the (s, t) of a texture.
#[derive(Clone, Copy, Debug)]
pub enum Mapping {
    /// `scale`·(u, v) + `offset`.
    Parameters {
        /// Factors of u and v.
        scale: Vec2,
        /// Offsets of s and t.
        offset: Vec2,
    },
    /// An affine map of (u, v), possibly with a rotation.
    Affine(Affine2),
    /// s = θ/π from +z, t = φ/2π from +x toward +y, as seen from the origin of texture space.
    Spherical(TextureSpace),
    /// s = ½ + φ/2π with φ in (-π, π], t = z.
    Cylindrical(TextureSpace),
    /// (p·s, p·t) + `offset`, in the world.
    Planar {
        /// The gradient of s. Unit: 1/m.
        s: Vec3,
        /// The gradient of t.
        t: Vec3,
        /// (s, t) at the world's origin.
        offset: Vec2,
    },
}

impl Mapping {
    /// The mapping (s, t) = (u, v).
    pub const IDENTITY: Self = Self::Parameters {
        scale: Vec2::ONE,
        offset: Vec2::ZERO,
    };

    /// Makes the mapping (p·`s`, p·`t`) + `offset`, with p in the space with the map `from_world`.
    pub fn planar(from_world: &Affine3A, [s, t]: [Vec3; 2], offset: Vec2) -> Self {
        let space = TextureSpace::new(*from_world);
        let origin = Vec3::from(from_world.translation);
        Self::Planar {
            s: space.gradient(s),
            t: space.gradient(t),
            offset: offset + Vec2::new(origin.dot(s), origin.dot(t)),
        }
    }

    pub(super) fn needs(&self) -> RequiredInputs {
        match self {
            Self::Parameters { .. } | Self::Affine(_) => RequiredInputs::NOTHING,
            Self::Spherical(_) | Self::Cylindrical(_) | Self::Planar { .. } => {
                RequiredInputs::SURFACE
            }
        }
    }

    /// Returns (s, t) of a point.
    #[inline]
    pub fn st(&self, at: &TexturePoint) -> Vec2 {
        match self {
            Self::Parameters { scale, offset } => at.uv * *scale + *offset,
            Self::Affine(map) => map.transform_point2(at.uv),
            Self::Spherical(space) => {
                let p = space.point(at);
                let rho = (sqr(p.x) + sqr(p.y)).sqrt();
                let theta = libm::atan2f(rho, p.z);
                let turn = libm::atan2f(p.y, p.x) / (2.0 * PI);
                Vec2::new(theta / PI, if turn < 0.0 { turn + 1.0 } else { turn })
            }
            Self::Cylindrical(space) => {
                let p = space.point(at);
                Vec2::new(0.5 + libm::atan2f(p.y, p.x) / (2.0 * PI), p.z)
            }
            Self::Planar { s, t, offset } => {
                Vec2::new(at.point.dot(*s), at.point.dot(*t)) + *offset
            }
        }
    }

    /// Returns ∇s and ∇t over the surface, zero if they are unknown. Unit: 1/m.
    pub(super) fn gradients(&self, at: &TexturePoint) -> [Vec3; 2] {
        let Footprint {
            gradient_u,
            gradient_v,
            ..
        } = at.footprint;
        let along = |gradient: Vec3| gradient - at.normal * at.normal.dot(gradient);
        match self {
            Self::Parameters { scale, .. } => [gradient_u * scale.x, gradient_v * scale.y],
            Self::Affine(map) => {
                let [of_u, of_v] = [map.matrix2.x_axis, map.matrix2.y_axis];
                [0, 1].map(|axis| gradient_u * of_u[axis] + gradient_v * of_v[axis])
            }
            Self::Spherical(space) => {
                let p = space.point(at);
                let (rho2, r2) = (sqr(p.x) + sqr(p.y), p.length_squared());
                let rho = rho2.sqrt();
                let theta = Vec3::new(p.x * p.z / rho, p.y * p.z / rho, -rho) / r2;
                let phi = Vec3::new(-p.y, p.x, 0.0) / rho2;
                [theta / PI, phi / (2.0 * PI)].map(|local| along(space.gradient(local)))
            }
            Self::Cylindrical(space) => {
                let p = space.point(at);
                let phi = Vec3::new(-p.y, p.x, 0.0) / (sqr(p.x) + sqr(p.y));
                [phi / (2.0 * PI), Vec3::Z].map(|local| along(space.gradient(local)))
            }
            Self::Planar { s, t, .. } => [along(*s), along(*t)],
        }
    }
}
