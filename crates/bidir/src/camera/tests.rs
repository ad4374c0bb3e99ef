//! Cameras, scaled, turned and mirrored: rays, importance and the lens.

use super::{
    Camera, Orthographic, OrthographicSettings, Perspective, PerspectiveSettings, Spherical,
    SphericalMapping,
};
use crate::math::{Affine3A, Frame, Mat3, PI, Vec2, Vec3, sqr};
use crate::sampler::{Dimension, Purpose, SampleStream};
use crate::testing::{Battery, Domain, Grid, check_close, check_variants, samples};

const RESOLUTION: Vec2 = Vec2::new(40.0, 30.0);
const EYE: Vec3 = Vec3::new(1.0, 2.0, -3.0);

/// Returns the axis of every example.
fn forward() -> Vec3 {
    turn() * Vec3::Z
}

fn turn() -> Mat3 {
    Mat3::from_rotation_y(2.0) * Mat3::from_rotation_x(0.6)
}

/// A map that is neither square nor even.
const STRETCH: Mat3 = Mat3::from_cols(
    Vec3::new(1.4, 0.0, 0.0),
    Vec3::new(0.3, 0.8, 0.0),
    Vec3::new(0.1, -0.1, 1.1),
);

/// Returns the map of a camera that turns, after `stretch`.
fn placed(stretch: Mat3) -> Affine3A {
    Affine3A::from_mat3_translation(turn() * stretch, EYE)
}

fn perspective(stretch: Mat3, screen: [Vec2; 2], lens_radius: f32) -> Camera {
    let settings = PerspectiveSettings {
        world_from_camera: placed(stretch),
        resolution: RESOLUTION,
        screen,
        lens_radius,
        focal_distance: 4.0,
    };
    Camera::Perspective(Perspective::new(&settings).unwrap())
}

fn spherical(stretch: Mat3, mapping: SphericalMapping) -> Camera {
    Camera::Spherical(Spherical::new(&placed(stretch), RESOLUTION, mapping).unwrap())
}

const CENTRED: [Vec2; 2] = [Vec2::new(-0.8, 0.6), Vec2::new(0.8, -0.6)];
const MIRROR: Mat3 = Mat3::from_diagonal(Vec3::new(-1.5, 1.5, 1.5));
const TWICE: Mat3 = Mat3::from_diagonal(Vec3::splat(2.0));

/// Pinholes and lenses with the radius of the lens in the world. All see nothing beyond
/// 1 - cosθ = 0.45.
fn examples() -> [(&'static str, Camera, f32); 6] {
    let shifted = [Vec2::new(-0.2, 0.9), Vec2::new(0.9, 0.1)];
    [
        ("pinhole", Mat3::IDENTITY, CENTRED, 0.0, 0.0),
        ("pinhole, shifted", TWICE, shifted, 0.0, 0.0),
        ("pinhole, mirrored", MIRROR, CENTRED, 0.0, 0.0),
        ("pinhole, stretched", STRETCH, CENTRED, 0.0, 0.0),
        ("lens", TWICE, CENTRED, 0.3, 0.6),
        ("lens, shifted and mirrored", MIRROR, shifted, 0.4, 0.6),
    ]
    .map(|(name, map, screen, lens, radius)| (name, perspective(map, screen, lens), radius))
}

/// Those with a lens.
fn lenses() -> impl Iterator<Item = (&'static str, Camera, f32)> {
    examples()
        .into_iter()
        .filter(|(_, _, radius)| *radius > 0.0)
}

/// Cameras without a lens: of parallel rays, and of all directions.
fn others() -> [(&'static str, Camera); 5] {
    let parallel = |stretch| {
        let settings = OrthographicSettings {
            world_from_camera: placed(stretch),
            resolution: RESOLUTION,
            screen: [Vec2::new(-0.8, 0.6), Vec2::new(0.9, -0.4)],
        };
        Camera::Orthographic(Orthographic::new(&settings).unwrap())
    };
    let (across, even) = (
        SphericalMapping::Equirectangular,
        SphericalMapping::EqualArea,
    );
    [
        ("parallel", parallel(TWICE)),
        ("parallel, mirrored", parallel(MIRROR)),
        ("parallel, stretched", parallel(STRETCH)),
        ("longitude and latitude", spherical(MIRROR, across)),
        ("equal areas", spherical(TWICE, even)),
    ]
}

fn all() -> impl Iterator<Item = (&'static str, Camera)> {
    let examples = examples().map(|(name, camera, _)| (name, camera));
    examples.into_iter().chain(others())
}

#[test]
fn every_variant_has_an_example() {
    let cameras = all().map(|(_, camera)| camera);
    check_variants!(cameras, Camera: Perspective Orthographic Spherical);
}

fn on_film(raster: Vec2) -> bool {
    raster.cmpge(Vec2::ZERO).all() && raster.cmple(RESOLUTION).all()
}

/// Even raster positions over the film give rays of the density, from any point of the lens.
#[test]
fn rays_follow_the_density() {
    let grid = Grid::new(Domain::Cone(Frame::from_z(forward()), 0.45), [20, 40]);
    let pixels = RESOLUTION.x * RESOLUTION.y;
    let mut battery = Battery::new("camera rays");
    for (name, camera, _) in examples() {
        for (place, u_lens) in [("centre", Vec2::splat(0.5)), ("rim", Vec2::new(0.02, 0.3))] {
            let name = format!("{name}, {place}");
            let point = camera.sample_lens(|| u_lens).locus.point;
            let draws = samples(&name, 1 << 20).map(|sample| {
                let raster = sample.get_2d(Dimension::at(0, Purpose::Film)) * RESOLUTION;
                Some(camera.sample_ray(raster, || u_lens).direction)
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
    for (name, camera, radius) in lenses() {
        let grid = Grid::new(Domain::Disk(radius), [16, 24]);
        let draws = samples(name, 1 << 20).map(|sample| {
            let lens = camera.sample_lens(|| sample.get_2d(Dimension::at(0, Purpose::Lens)));
            let local = frame.to_local(lens.locus.point - EYE);
            let turned = lens.locus.n_g.distance(frame.z);
            assert!(local.z.abs().max(turned) < 1e-5, "{name}");
            Some(local.with_z(0.0))
        });
        let pdf = camera.sample_lens(|| Vec2::splat(0.3)).pdf;
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
            let ray = camera.sample_ray(raster, || u_lens);
            let cos = ray.lens.locus.n_g.dot(ray.direction);
            let importance = camera.importance(ray.direction);
            let pdf = camera.pdf_direction(ray.direction);
            check_close(importance * cos * area, pdf, 1e-4, name);
            check_close(ray.lens.pdf * area, 1.0, 1e-4, name);
            let lens = ray.lens.locus.point;
            check_raster(&camera, lens, ray.direction, raster, name);
            assert!(camera.raster(lens, -ray.direction).is_none(), "{name}");
            assert!(camera.importance(-ray.direction) <= 0.0, "{name}");
            assert!(camera.pdf_direction(-ray.direction) <= 0.0, "{name}");
        }
    }
}

/// Checks where on the film the camera sees a point along a direction.
#[track_caller]
fn check_raster(camera: &Camera, p: Vec3, w: Vec3, expected: Vec2, case: &str) {
    let raster = camera.raster(p, w).unwrap();
    let distance = raster.distance(expected);
    assert!(distance < 2e-3, "{case}: {raster} instead of {expected}");
}

/// Solid angle per raster area around `raster`, by differences.
fn solid_angle(camera: &Camera, raster: Vec2, u_lens: Vec2) -> f32 {
    let ray = |raster| camera.sample_ray(raster, || u_lens);
    let at = |x: f32, y: f32| ray(raster + Vec2::new(x, y)).direction;
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
            let value = |sample: SampleStream| {
                let raster = pixel + sample.get_2d(Dimension::at(0, Purpose::Film));
                let u_lens = sample.get_2d(Dimension::at(0, Purpose::Lens));
                let ray = camera.sample_ray(raster, || u_lens);
                let cos = ray.lens.locus.n_g.dot(ray.direction);
                let measure = solid_angle(&camera, raster, u_lens) / ray.lens.pdf;
                f64::from(camera.importance(ray.direction) * cos * measure)
            };
            let sum: f64 = samples(name, n).map(value).sum();
            check_close(sum / n as f64, 1.0, 1e-3, name);
        }
    }
}

/// The rays of one raster position meet in the plane of focus.
#[test]
fn a_lens_is_sharp_at_its_focal_distance() {
    for (name, camera, radius) in lenses() {
        let scale = radius / if name == "lens" { 0.3 } else { 0.4 };
        let meet = |u_lens| {
            let ray = camera.sample_ray(Vec2::new(7.0, 22.0), || u_lens);
            let depth = forward().dot(ray.direction);
            ray.lens.locus.point + ray.direction * (4.0 * scale / depth)
        };
        let focus = meet(Vec2::splat(0.5));
        for u_lens in [Vec2::ZERO, Vec2::new(0.9, 0.2), Vec2::new(0.1, 0.7)] {
            assert!((meet(u_lens) - focus).length() < 1e-4, "{name}");
        }
    }
}

/// A ray of any camera leads back to its raster position, and what it sees has the depth of its way.
#[test]
fn rays_without_a_lens_lead_back_to_the_film() {
    for (name, camera) in others() {
        for sample in samples(name, 1000) {
            let raster = sample.get_2d(Dimension::at(0, Purpose::Film)) * RESOLUTION;
            let ray = camera.sample_ray(raster, || Vec2::splat(0.5));
            let seen = ray.origin + ray.direction * 7.0;
            check_raster(&camera, seen, ray.direction, raster, name);
            check_close(camera.depth(seen), 7.0, 1e-5, name);
            let pdf = camera.pdf_direction(ray.direction) * ray.lens.pdf;
            check_close(camera.importance(ray.direction), pdf, 1e-6, name);
        }
    }
}

/// Places off the edges of the octahedron's faces, where the map has kinks.
const OFF_EDGES: [Vec2; 3] = [
    Vec2::new(33.3, 7.2),
    Vec2::new(3.1, 22.6),
    Vec2::new(21.7, 16.4),
];

/// dx/dω of all directions, dx/dA of parallel rays: a pixel's extent by differences.
#[test]
fn the_density_of_rays_without_a_lens_is_the_jacobian() {
    for (name, camera) in others() {
        for raster in OFF_EDGES {
            let at = |x: f32, y: f32| {
                let ray = camera.sample_ray(raster + Vec2::new(x, y), || Vec2::splat(0.5));
                // One of the two is the same for all.
                ray.origin + ray.direction
            };
            let h = 0.02;
            let (dx, dy) = (at(h, 0.0) - at(-h, 0.0), at(0.0, h) - at(0.0, -h));
            let extent = dx.cross(dy).length() / sqr(2.0 * h);
            let w = camera.sample_ray(raster, || Vec2::splat(0.5)).direction;
            check_close(extent * camera.pdf_direction(w), 1.0, 5e-3, name);
        }
    }
}

/// A stretched camera sees through each point of the film what its map takes the point of camera space to.
#[test]
fn stretched_cameras_see_what_their_map_says() {
    let map = placed(STRETCH);
    let raster = Vec2::new(31.0, 4.5);
    let at = CENTRED[0] + (CENTRED[1] - CENTRED[0]) * raster / RESOLUTION;
    for u_lens in [Vec2::splat(0.5), Vec2::new(0.02, 0.3)] {
        // The plane of focus of camera space is at a distance of 4.
        let focus = map.transform_point3((at * 4.0).extend(4.0));
        let camera = perspective(STRETCH, CENTRED, 0.2);
        let ray = camera.sample_ray(raster, || u_lens);
        let towards = (focus - ray.origin).normalize();
        assert!(ray.direction.distance(towards) < 1e-5);
        let lens = map.inverse().transform_point3(ray.origin);
        assert!(lens.z.abs() < 1e-5 && lens.length() < 0.2 + 1e-5, "{lens}");
        let area = camera.pdf_direction(ray.direction) / camera.importance(ray.direction);
        let cos = ray.lens.locus.n_g.dot(ray.direction);
        let expected = PI * sqr(0.2) * 1.4 * 0.8;
        check_close(area / cos, expected, 1e-4, "area of the lens");
    }
    let (_, parallel) = others()[2];
    let ray = parallel.sample_ray(Vec2::ZERO, || Vec2::ZERO);
    let corner = map.transform_point3(Vec3::new(-0.8, 0.6, 0.0));
    let along = map.transform_vector3(Vec3::Z).normalize();
    assert!(ray.direction.distance(along) < 1e-5);
    assert!((corner - ray.origin).cross(ray.direction).length() < 1e-4);
}

#[test]
fn a_stretched_picture_of_all_directions_has_the_density_of_its_rays() {
    for mapping in [
        SphericalMapping::Equirectangular,
        SphericalMapping::EqualArea,
    ] {
        let camera = spherical(STRETCH, mapping);
        for raster in OFF_EDGES {
            let w = camera.sample_ray(raster, || Vec2::splat(0.5)).direction;
            check_raster(&camera, EYE + w, w, raster, "stretched");
            let extent = solid_angle(&camera, raster, Vec2::splat(0.5));
            check_close(extent * camera.pdf_direction(w), 1.0, 2e-2, "stretched");
        }
    }
}

#[test]
fn pictures_of_all_directions_have_the_camera_upright() {
    let (across, even) = (
        SphericalMapping::Equirectangular,
        SphericalMapping::EqualArea,
    );
    for (mapping, w, expected) in [
        (across, Vec3::Z, Vec2::new(10.0, 10.0)),
        (across, -Vec3::X, Vec2::new(20.0, 10.0)),
        (across, -Vec3::Z, Vec2::new(30.0, 10.0)),
        (across, Vec3::new(0.0, 0.6, 0.6), Vec2::new(10.0, 5.0)),
        (even, Vec3::Y, Vec2::new(20.0, 10.0)),
        (even, Vec3::X, Vec2::new(40.0, 10.0)),
        (even, Vec3::Z, Vec2::new(20.0, 20.0)),
    ] {
        let camera = Spherical::new(&Affine3A::IDENTITY, Vec2::new(40.0, 20.0), mapping);
        let raster = camera.unwrap().raster(w.normalize());
        let is_near = raster.distance(expected) < 1e-3;
        assert!(is_near, "{mapping:?} {w}: {raster}");
    }
}

#[test]
fn maps_that_are_flat_are_refused() {
    let flat = Mat3::from_cols(Vec3::X, Vec3::new(0.5, 0.0, 1.0), Vec3::Z);
    let settings = PerspectiveSettings {
        world_from_camera: Affine3A::from_mat3(flat),
        resolution: RESOLUTION,
        screen: CENTRED,
        lens_radius: 0.0,
        focal_distance: 1.0,
    };
    assert!(Perspective::new(&settings).is_none());
}

#[test]
fn parallel_rays_see_nothing_behind_their_plane() {
    let (_, camera) = others()[0];
    assert!(camera.raster(EYE - forward(), forward()).is_none());
    assert!(camera.importance(-forward()) <= 0.0 && camera.pdf_direction(-forward()) <= 0.0);
}

/// The width of a pixel is that of the widest on the film, by differences of rays, at any distance.
#[test]
fn pixels_are_as_wide_as_their_rays_are_apart() {
    for (name, camera) in all() {
        let distance = 7.0;
        let at = |raster: Vec2| {
            let ray = camera.sample_ray(raster, || Vec2::splat(0.5));
            ray.origin + ray.direction * distance
        };
        let h = 0.05;
        let width = |raster: Vec2| {
            let along = |axis: Vec2| (at(raster + axis * h) - at(raster - axis * h)) / (2.0 * h);
            along(Vec2::X).cross(along(Vec2::Y)).length().sqrt()
        };
        let middles = (0..1200).map(|i| Vec2::new((i % 40) as f32, (i / 40) as f32) + 0.5);
        let ratios = middles.map(|raster| width(raster) / camera.pixel_width(at(raster)));
        let widest = ratios.fold(0.0, f32::max);
        assert!((0.9..1.02).contains(&widest), "{name}: {widest}");
    }
}

#[test]
fn a_resized_camera_sees_the_same() {
    for (name, camera) in all() {
        let factor = Vec2::new(0.25, 0.5);
        let small = camera.resized(factor);
        for raster in [Vec2::new(3.0, 4.0), Vec2::new(31.5, 12.25)] {
            let u = || Vec2::new(0.3, 0.8);
            let ray = camera.sample_ray(raster, u);
            let of_small = small.sample_ray(raster * factor, u);
            assert!(ray.direction.distance(of_small.direction) < 1e-5, "{name}");
            assert!(ray.origin.distance(of_small.origin) < 1e-5, "{name}");
            let expected = camera.pdf_direction(ray.direction) * factor.x * factor.y;
            check_close(small.pdf_direction(ray.direction), expected, 1e-5, name);
        }
    }
}

#[test]
fn a_camera_moves_with_its_pose() {
    for (name, camera) in all() {
        let by = Vec3::new(1.0, -2.0, 0.5);
        let moved = camera.with_pose(camera.pose().shifted(by));
        let (raster, u) = (Vec2::new(3.0, 4.0), || Vec2::new(0.3, 0.8));
        let (before, after) = (camera.sample_ray(raster, u), moved.sample_ray(raster, u));
        assert!((after.origin - before.origin).distance(by) < 1e-5, "{name}");
        assert!(after.direction.distance(before.direction) < 1e-5, "{name}");
        assert_eq!(moved.pose(), camera.pose().shifted(by));
    }
}
