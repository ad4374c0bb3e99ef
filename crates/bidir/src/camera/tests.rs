//! Pinholes and lenses, scaled, turned and mirrored: rays, importance and the lens.

use super::{Camera, Perspective, PerspectiveSettings};
use crate::math::{Affine3A, Frame, Mat3, PI, Vec2, Vec3, sqr};
use crate::sampler::{Dimension, Purpose};
use crate::testing::{Battery, Domain, Grid, check_close, samples};

const RESOLUTION: Vec2 = Vec2::new(40.0, 30.0);
const EYE: Vec3 = Vec3::new(1.0, 2.0, -3.0);

/// The axis of every example.
fn forward() -> Vec3 {
    turn() * Vec3::Z
}

fn turn() -> Mat3 {
    Mat3::from_rotation_y(2.0) * Mat3::from_rotation_x(0.6)
}

fn camera(scale: Vec3, screen: [Vec2; 2], lens_radius: f32) -> Camera {
    let map = Affine3A::from_mat3_translation(turn() * Mat3::from_diagonal(scale), EYE);
    let settings = PerspectiveSettings {
        world_from_camera: map,
        resolution: RESOLUTION,
        screen,
        lens_radius,
        focal_distance: 4.0,
    };
    Camera::Perspective(Perspective::new(&settings).unwrap())
}

/// Cameras with the radius of their lens in the world. All see nothing beyond 1 - cosθ = 0.45.
fn examples() -> [(&'static str, Camera, f32); 5] {
    let centred = [Vec2::new(-0.8, 0.6), Vec2::new(0.8, -0.6)];
    let shifted = [Vec2::new(-0.2, 0.9), Vec2::new(0.9, 0.1)];
    let mirror = Vec3::new(-1.5, 1.5, 1.5);
    [
        ("pinhole", camera(Vec3::ONE, centred, 0.0), 0.0),
        (
            "pinhole, shifted",
            camera(Vec3::splat(2.0), shifted, 0.0),
            0.0,
        ),
        ("pinhole, mirrored", camera(mirror, centred, 0.0), 0.0),
        ("lens", camera(Vec3::splat(2.0), centred, 0.3), 0.6),
        (
            "lens, shifted and mirrored",
            camera(mirror, shifted, 0.4),
            0.6,
        ),
    ]
}

const VARIANTS: usize = 1;

/// A new variant does not compile before it has a number here.
fn variant(camera: &Camera) -> usize {
    match camera {
        Camera::Perspective(_) => 0,
    }
}

#[test]
fn every_variant_has_an_example() {
    let mut seen = [false; VARIANTS];
    for (_, camera, _) in examples() {
        seen[variant(&camera)] = true;
    }
    assert_eq!(seen, [true; VARIANTS]);
}

fn on_film(raster: Vec2) -> bool {
    raster.cmpge(Vec2::ZERO).all() && raster.cmple(RESOLUTION).all()
}

/// Even raster positions over the film give rays of the density, from any point of the lens.
#[test]
fn rays_follow_the_density() {
    let domain = Domain::Cone(Frame::from_z(forward()), 0.45);
    let grid = Grid {
        domain,
        columns: 20,
        rows: 40,
    };
    let pixels = RESOLUTION.x * RESOLUTION.y;
    let mut battery = Battery::new("camera rays");
    for (name, camera, _) in examples() {
        for (place, u_lens) in [("centre", Vec2::splat(0.5)), ("rim", Vec2::new(0.02, 0.3))] {
            let name = format!("{name}, {place}");
            let point = camera.sample_lens(u_lens).point;
            let draws = samples(&name, 1 << 20).map(|sample| {
                let raster = sample.get_2d(Dimension::at(0, Purpose::Film)) * RESOLUTION;
                Some(camera.sample_ray(raster, u_lens).direction)
            });
            let pdf = |w| match camera.raster(point, w) {
                Some(raster) if on_film(raster) => camera.pdf_direction(w) / pixels,
                _ => 0.0,
            };
            battery.chi2(&name, &grid, pdf, draws);
        }
    }
    battery.check();
}

/// Lens points cover the lens evenly and lie across the axis.
#[test]
fn lens_points_follow_the_density() {
    let mut battery = Battery::new("lens points");
    let frame = Frame::from_z(forward());
    for (name, camera, radius) in examples()
        .into_iter()
        .filter(|&(_, _, radius)| radius > 0.0)
    {
        let grid = Grid {
            domain: Domain::Disk(radius),
            columns: 16,
            rows: 24,
        };
        let draws = samples(name, 1 << 20).map(|sample| {
            let lens = camera.sample_lens(sample.get_2d(Dimension::at(0, Purpose::Lens)));
            let local = frame.to_local(lens.point - EYE);
            assert!(
                local.z.abs() < 1e-5 && (lens.n_g - frame.z).length() < 1e-5,
                "{name}"
            );
            Some(local.with_z(0.0))
        });
        let pdf = camera.sample_lens(Vec2::splat(0.3)).pdf;
        battery.chi2(name, &grid, |_| pdf, draws);
    }
    battery.check();
}

#[test]
fn importance_is_the_density_of_rays_by_lens_area_and_cosine() {
    for (name, camera, radius) in examples() {
        let area = if radius > 0.0 { PI * sqr(radius) } else { 1.0 };
        for sample in samples(name, 1000) {
            let raster = sample.get_2d(Dimension::at(0, Purpose::Film)) * RESOLUTION;
            let u_lens = sample.get_2d(Dimension::at(0, Purpose::Lens));
            let ray = camera.sample_ray(raster, u_lens);
            let cos = ray.lens.n_g.dot(ray.direction);
            let importance = camera.importance(ray.direction);
            check_close(
                importance * cos * area,
                camera.pdf_direction(ray.direction),
                1e-4,
                name,
            );
            check_close(ray.lens.pdf * area, 1.0, 1e-4, name);
            let back = camera.raster(ray.lens.point, ray.direction).unwrap();
            assert!(
                (back - raster).length() < 2e-3,
                "{name}: {back} instead of {raster}"
            );
            assert!(camera.importance(-ray.direction) <= 0.0, "{name}");
            assert!(camera.pdf_direction(-ray.direction) <= 0.0, "{name}");
        }
    }
}

/// Solid angle per raster area around `raster`, by differences.
fn solid_angle(camera: &Camera, raster: Vec2, u_lens: Vec2) -> f32 {
    let at = |x: f32, y: f32| {
        camera
            .sample_ray(raster + Vec2::new(x, y), u_lens)
            .direction
    };
    let h = 0.05;
    let (dx, dy) = (at(h, 0.0) - at(-h, 0.0), at(0.0, h) - at(0.0, -h));
    dx.cross(dy).length() / sqr(2.0 * h)
}

/// ∫∫ `W_e` cosθ dω dA over the lens and the directions of one pixel is 1.
#[test]
fn the_importance_of_a_pixel_is_one() {
    for (name, camera, _) in examples() {
        for pixel in [Vec2::ZERO, Vec2::new(20.0, 15.0), Vec2::new(39.0, 3.0)] {
            let n = 1000;
            let sum: f64 = samples(name, n)
                .map(|sample| {
                    let raster = pixel + sample.get_2d(Dimension::at(0, Purpose::Film));
                    let u_lens = sample.get_2d(Dimension::at(0, Purpose::Lens));
                    let ray = camera.sample_ray(raster, u_lens);
                    let value = camera.importance(ray.direction) * ray.lens.n_g.dot(ray.direction);
                    let measure = solid_angle(&camera, raster, u_lens) / ray.lens.pdf;
                    f64::from(value * measure)
                })
                .sum();
            check_close((sum / n as f64) as f32, 1.0, 1e-3, name);
        }
    }
}

/// The rays of one raster position meet in the plane of focus.
#[test]
fn a_lens_is_sharp_at_its_focal_distance() {
    for (name, camera, radius) in examples()
        .into_iter()
        .filter(|&(_, _, radius)| radius > 0.0)
    {
        let scale = radius / if name == "lens" { 0.3 } else { 0.4 };
        let meet = |u_lens| {
            let ray = camera.sample_ray(Vec2::new(7.0, 22.0), u_lens);
            let depth = forward().dot(ray.direction);
            ray.lens.point + ray.direction * (4.0 * scale / depth)
        };
        let focus = meet(Vec2::splat(0.5));
        for u_lens in [Vec2::ZERO, Vec2::new(0.9, 0.2), Vec2::new(0.1, 0.7)] {
            assert!((meet(u_lens) - focus).length() < 1e-4, "{name}");
        }
    }
}
