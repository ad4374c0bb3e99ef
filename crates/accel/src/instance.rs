//! Objects that stand in several places: a tree of their own, shared, and an affine map each.
//!
//! A ray is taken to the object's space and meets the object's tree there, so that all triangles of an
//! instance see one and the same local ray: edges between them stay as tight as without the map.
//! With `M` the map to the object's space, the local ray is
//!
//! ```text
//!     o' = M(o + t₀·d),   d' = M d   (no translation),   t = t₀ + t'
//! ```
//!
//! `t₀ ≥ 0` is where the ray enters a ball around the instance, 0 if it starts inside. It is what a
//! distant origin costs in digits. The direction is not normalised, so that `t'` has the unit of `t`.
//! All of it is computed in `f64`, in one order, without FMA; `o'` and `d'` are then rounded, to the
//! `f32` numbers that the exact test of edges asks for.
//!
//! **Boxes.** Rounding moves the local line. Let `ε` be half of `f32::EPSILON`, `R` the radius of the ball
//! and `c'` its local center. Per local axis, `ρ = R·|row of M|` bounds the distance from `c'` in the
//! ball, and `m = |c'| + ρ` all coordinates there. Within the ball the line is moved by at most `εm`
//! (origin) and `2ερ` (direction); a leaf moves its vertices by `2ερ` (translation) and rounds
//! `t'`, which is another `2ερ` along the line. That is less than `e = 2ε(m + 8ρ)`, of which the
//! second half is room for the `f64` arithmetic, for origins up to 2²⁶ radii away.
//! The world box of an instance is that of the mapped local box, widened by `|M⁻¹|·e`: whatever the
//! local line hits is in a box that the world ray meets.
//!
//! **Limits.** `t` is rounded once, from `t₀ + t'`. The local limits are those of the world less `t₀`,
//! rounded outward by one unit before and after, so that nothing is culled that would tie.

use glam::{DAffine3, DVec3};

use crate::aabb::Aabb;
use crate::primitive::outward;
use crate::ray::{Hit, Ray};

/// A place of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// Index of the object.
    pub object: u32,
    /// Any invertible affine map, mirroring ones included.
    pub world_from_object: DAffine3,
}

/// An [`Instance`] made ready for rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    object_from_world: DAffine3,
    /// A ball around the instance, in world space.
    center: DVec3,
    radius: f32,
    pub(crate) object: u32,
}

/// The most that a map may stretch in either direction: directions stay in the range of `f32`.
const MOST_SCALE: f64 = 1e18;

// What memory estimates count on.
const _: () = assert!(size_of::<Placement>() <= 128);

impl Placement {
    /// Places an object with these bounds, and tells the bounds of the place.
    ///
    /// None: the map has no inverse, or is so close to having none that the rounding of rays exceeds
    /// the instance, or something overflows.
    pub(crate) fn new(instance: &Instance, object: &Aabb) -> Option<(Self, Aabb)> {
        let world_from_object = instance.world_from_object;
        let object_from_world = world_from_object.inverse();
        let (low, high) = (object.min.as_dvec3(), object.max.as_dvec3());
        let local_center = 0.5 * (low + high);
        let center = world_from_object.transform_point3(local_center);
        let half = abs_times(&world_from_object, 0.5 * (high - low));
        // The rounding error depends on the ball, and the ball on the error: begin with room.
        let offset = abs_times(&world_from_object, local_center.abs());
        let cancelled = 2.0_f64.powi(-48) * (center.abs() + offset);
        let radius = 2.0 * half.length() + 1e-5 * offset.length() + 1e3 * cancelled.length();
        let error = local_error(&object_from_world, local_center, radius);
        let reach = half + abs_times(&world_from_object, error) + cancelled;
        let is_moderate = |map: &DAffine3| {
            let columns = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
            columns.iter().all(|column| column.length() <= MOST_SCALE)
        };
        // Also false for the NaN and the infinities of a singular map.
        if !(reach.length() <= radius
            && is_moderate(&world_from_object)
            && is_moderate(&object_from_world))
        {
            return None;
        }
        let bounds = Aabb {
            min: (center - reach).to_array().map(|x| outward(x, -1.0)).into(),
            max: (center + reach).to_array().map(|x| outward(x, 1.0)).into(),
        };
        let placement = Self {
            object_from_world,
            center,
            radius: outward(reach.length(), 1.0),
            object: instance.object,
        };
        bounds.is_valid().then_some((placement, bounds))
    }

    pub(crate) fn object_from_world(&self) -> &DAffine3 {
        &self.object_from_world
    }

    /// Where the ray, already cleaned, enters the ball: `t₀`.
    fn entry(&self, ray: &Ray) -> f64 {
        let direction = ray.direction.as_dvec3();
        let to_center = self.center - ray.origin.as_dvec3();
        let square = direction.length_squared();
        let entry =
            to_center.dot(direction) / square - 1.001 * f64::from(self.radius) / square.sqrt();
        entry.max(0.0)
    }

    /// The ray in the object's space, with how it is seen from the world. `instance` is the number
    /// that hits get.
    pub(crate) fn view(&self, ray: &Ray, instance: u32) -> (Ray, Object) {
        let start = self.entry(ray);
        let origin = ray.origin.as_dvec3() + start * ray.direction.as_dvec3();
        let object = Object {
            instance,
            start,
            t_min: ray.t_min,
            t_max: ray.t_max,
        };
        let local = Ray {
            origin: self.object_from_world.transform_point3(origin).as_vec3(),
            direction: self
                .object_from_world
                .transform_vector3(ray.direction.as_dvec3())
                .as_vec3(),
            t_min: ((f64::from(ray.t_min.next_down()) - start) as f32).next_down(),
            t_max: object.local_t_max(),
        };
        (local, object)
    }
}

/// A bound of `|M p|` for `|p| ≤ extent`, without the translation.
fn abs_times(map: &DAffine3, extent: DVec3) -> DVec3 {
    let m = map.matrix3;
    m.x_axis.abs() * extent.x + m.y_axis.abs() * extent.y + m.z_axis.abs() * extent.z
}

/// How far rounding moves a local line within the ball: `e` of the module's page.
fn local_error(object_from_world: &DAffine3, local_center: DVec3, radius: f64) -> DVec3 {
    let rows = object_from_world.matrix3.transpose();
    let lengths = DVec3::new(
        rows.x_axis.length(),
        rows.y_axis.length(),
        rows.z_axis.length(),
    );
    let rho = radius * lengths;
    f64::from(f32::EPSILON) * (local_center.abs() + rho + 8.0 * rho)
}

/// What hits in the space of a tree are in the world.
pub(crate) trait Space {
    /// The world's hit for a local one. None: it is beyond the limits.
    fn world_hit(&self, local: Hit) -> Option<Hit>;

    /// The limit of world hits, as queries shorten it, with that of local ones.
    fn limit<R>(&mut self, ray: &mut Ray, shorten: impl FnOnce(&mut f32) -> R) -> R;
}

/// The tree's own primitives: nothing is changed.
pub(crate) struct World;

impl Space for World {
    #[inline(always)]
    fn world_hit(&self, local: Hit) -> Option<Hit> {
        Some(local)
    }

    #[inline(always)]
    fn limit<R>(&mut self, ray: &mut Ray, shorten: impl FnOnce(&mut f32) -> R) -> R {
        shorten(&mut ray.t_max)
    }
}

/// The primitives of one instance.
pub(crate) struct Object {
    instance: u32,
    /// `t₀`.
    start: f64,
    /// The limits in the world.
    t_min: f32,
    pub(crate) t_max: f32,
}

impl Object {
    fn local_t_max(&self) -> f32 {
        let world = f64::from(self.t_max.next_up());
        ((world - self.start) as f32).next_up().min(f32::MAX)
    }
}

impl Space for Object {
    #[inline(always)]
    fn world_hit(&self, local: Hit) -> Option<Hit> {
        let t = (self.start + f64::from(local.t)) as f32;
        (t >= self.t_min && t <= self.t_max).then_some(Hit {
            t,
            instance: self.instance,
            ..local
        })
    }

    #[inline(always)]
    fn limit<R>(&mut self, ray: &mut Ray, shorten: impl FnOnce(&mut f32) -> R) -> R {
        let result = shorten(&mut self.t_max);
        ray.t_max = self.local_t_max();
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BuildOptions, Bvh, Primitive, accept_all};
    use glam::{DMat3, Vec3};
    use std::sync::Arc;

    const UNIT: Aabb = Aabb {
        min: Vec3::NEG_ONE,
        max: Vec3::ONE,
    };

    fn place(world_from_object: DAffine3) -> Option<(Placement, Aabb)> {
        let instance = Instance {
            object: 3,
            world_from_object,
        };
        Placement::new(&instance, &UNIT)
    }

    #[test]
    fn bounds_are_wider_than_the_mapped_box_but_hardly() {
        let map = DAffine3::from_translation(DVec3::new(10.0, 0.0, 0.0));
        let (placement, bounds) = place(map).expect("a translation");
        let exact = Aabb {
            min: Vec3::new(9.0, -1.0, -1.0),
            max: Vec3::new(11.0, 1.0, 1.0),
        };
        assert!(bounds.contains(&exact) && bounds != exact);
        assert!((bounds.extent() - exact.extent()).max_element() < 3e-5);
        assert_eq!(placement.object, 3);
    }

    #[test]
    fn maps_without_inverse_are_refused() {
        for scale in [
            DVec3::new(1.0, 0.0, 1.0),
            DVec3::ZERO,
            DVec3::new(f64::NAN, 1.0, 1.0),
            DVec3::splat(1e-300),
            DVec3::splat(1e300),
        ] {
            assert_eq!(place(DAffine3::from_scale(scale)), None, "{scale}");
        }
        let far = DAffine3::from_translation(DVec3::splat(1e300));
        assert_eq!(place(far), None);
        // Two columns that are nearly the same direction.
        let mut shear = DAffine3::IDENTITY;
        shear.matrix3.y_axis = DVec3::new(1.0, 1e-9, 0.0);
        assert_eq!(place(shear), None);
        let flat = DAffine3::from_scale(DVec3::new(1.0, -1e-12, 1.0));
        assert!(place(flat).is_some(), "flat along an axis is well-conditioned");
    }

    #[test]
    fn local_rays_begin_at_the_ball() {
        let (placement, _) = place(DAffine3::from_scale(DVec3::splat(2.0))).expect("a scale");
        let near = Ray::new(Vec3::ZERO, Vec3::X);
        let (local, object) = placement.view(&near, 1);
        assert!(object.start <= 0.0 && local.t_min <= 0.0);
        assert_eq!((local.origin, local.direction), (Vec3::ZERO, Vec3::X / 2.0));
        let far = Ray::new(Vec3::X * -1e6, Vec3::X);
        let (local, object) = placement.view(&far, 1);
        assert!((object.start - 1e6 + 2.0 * 3.0_f64.sqrt()).abs() < 0.1);
        let hit = Hit {
            t: -2.0 * local.origin.x,
            instance: 0,
            primitive: 7,
            u: 0.0,
            v: 0.0,
        };
        let world = object.world_hit(hit).expect("no limits");
        assert_eq!((world.t, world.instance, world.primitive), (1e6, 1, 7));
    }

    /// Numbers in [-1, 1).
    fn random(state: &mut u64) -> f64 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*state >> 40) as f64 / f64::from(1 << 23) - 1.0
    }

    fn vector(state: &mut u64) -> DVec3 {
        DVec3::new(random(state), random(state), random(state))
    }

    /// The answer without the box in the world that might cull it.
    fn unculled(bvh: &Bvh, ray: &Ray) -> Option<f32> {
        let (local, space) = bvh.placements[0].view(ray, 1);
        let hit = bvh.objects[0].closest(&local, accept_all)?;
        space.world_hit(hit).map(|hit| hit.t)
    }

    #[test]
    fn no_hit_is_culled_by_the_world_box() {
        let mut state = 5;
        let mut hits = 0;
        for round in 0..400 {
            // Triangles that end at the box, so that silhouettes are on it; some far from their origin.
            let offset = [0.0, 1.0, 300.0][round % 3] * vector(&mut state);
            let corner = |state: &mut u64| (vector(state) + offset).as_vec3();
            let primitives: Vec<_> = (0..6)
                .map(|_| [(); 3].map(|()| corner(&mut state)))
                .map(Primitive::Triangle)
                .collect();
            let mut linear = DMat3::from_cols(
                vector(&mut state),
                vector(&mut state),
                vector(&mut state),
            );
            linear.y_axis *= [1.0, 1e-3, 30.0][round / 3 % 3];
            let world_from_object =
                DAffine3::from_mat3_translation(linear, 10.0 * vector(&mut state));
            let options = BuildOptions::default();
            let object = Arc::new(Bvh::build(&primitives, &options).expect("finite"));
            let instance = Instance {
                object: 0,
                world_from_object,
            };
            let bvh = Bvh::with_instances(&[], vec![object], &[instance], &options);
            // Nearly singular, by chance.
            let Ok(bvh) = bvh else { continue };
            assert_eq!(bvh.validate(), Ok(()));
            for i in 0..300 {
                // At a corner of a triangle, from near and far: half of the rays pass just beside.
                let Primitive::Triangle(triangle) = primitives[i % 6] else {
                    unreachable!("only triangles")
                };
                let target = world_from_object.transform_point3(triangle[i / 6 % 3].as_dvec3());
                let far = [0.0, 1.0, 100.0, 1e5][i % 4];
                let origin = (target + far * vector(&mut state)).as_vec3();
                let ray = Ray::new(origin, target.as_vec3() - origin);
                let expected = unculled(&bvh, &ray);
                hits += u32::from(expected.is_some());
                let found = bvh.closest(&ray, accept_all).map(|hit| hit.t);
                assert_eq!(found.map(f32::to_bits), expected.map(f32::to_bits), "{ray:?}");
                // The hit as the limit, where it ties with itself.
                let limited = Ray {
                    t_max: expected.unwrap_or(0.0),
                    ..ray
                };
                assert_eq!(bvh.occluded(&limited, accept_all), expected.is_some());
            }
        }
        assert!(hits > 20_000, "{hits} hits do not say much");
    }

    #[test]
    fn corrupted_places_are_refused() {
        let options = BuildOptions::default();
        let triangle = Primitive::Triangle([Vec3::ZERO, Vec3::X, Vec3::Y]);
        let object = Arc::new(Bvh::build(&[triangle], &options).expect("finite"));
        let instance = Instance {
            object: 0,
            world_from_object: DAffine3::IDENTITY,
        };
        let mut bvh =
            Bvh::with_instances(&[], vec![object], &[instance; 2], &options).expect("valid");
        assert_eq!(bvh.validate(), Ok(()));
        bvh.placements[1].object_from_world.translation.x += 1.0;
        assert!(bvh.validate().expect_err("moved").contains("instance 1"));
        bvh.placements.push(bvh.placements[0]);
        bvh.placements.swap(1, 2);
        let error = bvh.validate().expect_err("not in the tree");
        assert!(error.contains("instance 2"), "{error}");
    }
}
