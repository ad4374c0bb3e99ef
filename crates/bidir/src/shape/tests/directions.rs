use super::moved;
use crate::math::{DVec3, Frame, Vec2, Vec3};
use crate::sampler::{Dimension, Purpose};
use crate::shape::{Orientation, Shape, Sphere};
use crate::testing::{Battery, Domain, Grid, check_close, check_near, samples};
use std::f64::consts::PI;

/// The centre of the ball that these tests look at: binary fractions, so that the far view is exact.
const CENTRE: Vec3 = Vec3::new(1.0, -2.0, 0.5);
const RADIUS: f32 = 0.875;

/// The places they look from, by distance from the centre in radii.
const DISTANCES: [(&str, f32); 6] = [
    ("far", 32.0),
    ("very far", 32768.0),
    ("near", 2.0),
    ("very near", 1.02),
    ("inside", 0.6),
    ("just inside the middle", 0.001),
];

/// A ball looked at from a place at `distance`. Local space: the unit is the radius, the origin the
/// centre, and z points away from the place. All in double precision.
struct View {
    shape: Shape,
    reference: Vec3,
    axis: Frame,
    distance: f64,
}

/// A point of the unit sphere as it is seen.
struct Seen {
    point: DVec3,
    /// d²/|cosθ|. Unit: radii².
    area_per_solid_angle: f64,
}

impl View {
    fn new(distance: f32) -> Self {
        // A direction whose length is a whole number.
        let (away, length) = (Vec3::new(2.0, 3.0, 6.0), 7.0);
        let ball = Sphere::new(moved(CENTRE, 1.0), RADIUS, Orientation::Natural);
        Self {
            shape: Shape::Sphere(ball),
            reference: CENTRE - away * (distance * RADIUS / length),
            axis: Frame::from_z(away / length),
            distance: f64::from(distance),
        }
    }

    /// Returns 1 - cosθ of the cone that the ball fills.
    fn height(&self) -> f64 {
        let sin2 = 1.0 / (self.distance * self.distance);
        if sin2 < 1.0 {
            sin2 / (1.0 + (1.0 - sin2).sqrt())
        } else {
            2.0
        }
    }

    fn world(&self, local: DVec3) -> Vec3 {
        CENTRE + self.axis.to_world(local.as_vec3()) * RADIUS
    }

    /// Returns the point seen along (x, y) of the unit square: even in solid angle.
    fn look(&self, x: f64, y: f64) -> Seen {
        let drop = x * self.height();
        let (sin2, cos) = (drop * (2.0 - drop), 1.0 - drop);
        let (sin_phi, cos_phi) = libm::sincos(2.0 * PI * y);
        let root = (1.0 - self.distance * self.distance * sin2).max(0.0).sqrt();
        let t = self.distance * cos + if self.distance > 1.0 { -root } else { root };
        let rho = sin2.sqrt() * t;
        Seen {
            point: DVec3::new(rho * cos_phi, rho * sin_phi, cos * t - self.distance),
            area_per_solid_angle: t * t / root,
        }
    }

    /// Returns the (x, y) that a point of the surface is seen along. None: it is on the other side.
    fn project(&self, point: Vec3) -> Option<Vec3> {
        let local = self.axis.to_local((point - CENTRE) / RADIUS).as_dvec3();
        let z = local.z + self.distance;
        // The plane of the rim: n·(reference - n) = 0 with n on the unit sphere.
        if self.distance > 1.0 && -local.z * self.distance < 1.0 {
            return None;
        }
        let rho2 = local.truncate().length_squared();
        let cos = z / (rho2 + z * z).sqrt();
        let drop = if cos > 0.0 {
            rho2 / (rho2 + z * z) / (1.0 + cos)
        } else {
            1.0 - cos
        };
        let turn = (libm::atan2(local.y, local.x) / (2.0 * PI)).rem_euclid(1.0);
        Some(Vec2::new((drop / self.height()) as f32, turn as f32).extend(0.0))
    }

    /// Returns the density of drawing the point in `seen`. Measure: solid angle.
    fn pdf_direction(&self, seen: &Seen) -> f64 {
        let (normal, point) = (
            self.axis.to_world(seen.point.as_vec3()),
            self.world(seen.point),
        );
        let pdf = self.shape.pdf_from(0, self.reference, point, normal);
        f64::from(pdf) * seen.area_per_solid_angle * f64::from(RADIUS * RADIUS)
    }
}

/// Points drawn for a receiver follow the density, in solid angle around it.
#[test]
fn samples_for_a_receiver_follow_the_density() {
    let grid = Grid::new(Domain::Square, [20, 24]);
    let mut battery = Battery::new("directions to a sphere");
    for (name, distance) in DISTANCES {
        let view = View::new(distance);
        let draws = samples(name, 1 << 20).map(|sample| {
            let u = sample.get_2d(Dimension::at(1, Purpose::NextEventPosition));
            view.project(view.shape.sample_from(0, view.reference, u).surface.point)
        });
        let measure = 2.0 * PI * view.height();
        let pdf = |p: Vec3| {
            let seen = view.look(f64::from(p.x), f64::from(p.y));
            (view.pdf_direction(&seen) * measure) as f32
        };
        battery.chi2(name, &grid, pdf, draws);
    }
    battery.check();
}

/// If the ball is seen in a cone, every ray of the cone has the same density.
#[test]
fn rays_that_hit_a_sphere_have_the_density_of_its_cone() {
    let outside = DISTANCES
        .into_iter()
        .filter(|(_, distance)| *distance > 1.0);
    for (name, distance) in outside {
        let view = View::new(distance);
        let expected = 1.0 / (2.0 * PI * view.height());
        for sample in samples(name, 1000) {
            let u = sample.get_2d(Dimension::at(1, Purpose::Scatter));
            // Next to the rim the cosine has no digits left.
            let seen = view.look(f64::from(u.x) * 0.99, f64::from(u.y));
            let tolerance = 1e-3 + 3e-6 / f64::from(1.02 - u.x);
            check_close(view.pdf_direction(&seen), expected, tolerance, name);
        }
    }
}

#[test]
fn the_density_of_a_sample_is_that_of_its_point() {
    let others = [("touching", 1.0), ("within", 0.0)];
    for (name, distance) in DISTANCES.into_iter().chain(others) {
        let view = View::new(distance);
        for sample in samples(name, 1000) {
            let u = sample.get_2d(Dimension::at(1, Purpose::NextEventPosition));
            let drawn = view.shape.sample_from(0, view.reference, u);
            let at = &drawn.surface;
            let pdf = view.shape.pdf_from(0, view.reference, at.point, at.n_g);
            check_close(drawn.pdf, pdf, 1e-4, name);
            assert!(drawn.pdf >= 0.0 && drawn.pdf.is_finite(), "{name}");
            check_near(at.point.distance(CENTRE), RADIUS, 1e-5, name);
        }
    }
}
