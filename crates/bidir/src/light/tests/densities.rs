use super::{
    AreaLight, FIRE, Surroundings, ember, emission_of, environment, fire, fireplace,
    for_each_light, numbers, point_for, pole, receivers, turn,
};
use crate::light::{EmissionSides, InfiniteLight, Light, LightPoint, Part, VolumeLight};
use crate::math::{Frame, PI, direction_to_square, sqr, square_to_direction, warp};
use crate::medium::{self, Glow, MediumId};
use crate::sampler::SampleStream;
use crate::shape::{Mesh, Shape};
use crate::spectrum::Lanes;
use crate::testing::{Domain, Grid, prelude::*};

const N: u64 = 1 << 20;

/// Returns the directions that a light may send rays to, around its normal or axis.
fn directions(light: &Light) -> Domain {
    match light {
        Light::Spot(_) => Domain::Cone(pole(), 2.0),
        _ => Domain::sphere(),
    }
}

/// Local directions around the normal of a surface; world directions where there is none.
fn frame(at: &LightPoint) -> Frame {
    let [x, y, z] = Vec3::AXES;
    match at.locus.n_g {
        n if n == Vec3::ZERO => Frame { x, y, z },
        n => Frame::from_z(n),
    }
}

/// Rays leave finite lights in directions that follow the density.
#[test]
fn directions_follow_the_density() {
    let mut battery = Battery::new("light directions");
    for_each_light(|name, light, context| {
        if light.is_infinite() {
            return;
        }
        let domain = match name {
            "spot, narrow" => Domain::Cone(pole(), 5.5e-5),
            _ => directions(light),
        };
        let draws = samples(name, N).map(|sample| {
            let drawn = emission_of(light, context, &sample)?;
            Some(frame(&drawn.from.at).to_local(drawn.direction))
        });
        let at = point_for(light, context, receivers()[0], Vec2::splat(0.3));
        let at = at.unwrap().at;
        let pdf = |w| light.pdf_direction(context, &at, frame(&at).to_world(w));
        battery.chi2(name, &Grid::new(domain, [20, 40]), pdf, draws);
    });
    battery.check();
}

/// Rays from infinity cross the scene's disk evenly.
#[test]
fn rays_from_infinity_cross_the_disk_by_the_density() {
    let mut battery = Battery::new("rays from infinity");
    for_each_light(|name, light, context| {
        if !light.is_infinite() {
            return;
        }
        let grid = Grid::new(Domain::Disk(context.radius), [16, 24]);
        let draws = samples(name, N).map(|sample| {
            let drawn = emission_of(light, context, &sample)?;
            let local = Frame::from_z(drawn.direction).to_local(drawn.origin - context.centre);
            Some(local.with_z(0.0))
        });
        let pdf = light.pdf_direction(context, &LightPoint::at_infinity(Vec3::Z), -Vec3::Z);
        battery.chi2(name, &grid, |_| pdf, draws);
    });
    battery.check();
}

/// Checks that points of a light are drawn by the density, for rays and for a receiver alike, counted on a square of which
/// a point has `area` in the light's measure.
#[track_caller]
fn check_points(
    light: &Light,
    grid: &Grid,
    to_square: impl Fn(&LightPoint) -> Vec3,
    to_light: impl Fn(Vec3) -> (LightPoint, f32),
) {
    let surroundings = Surroundings::new();
    let (context, receiver) = (surroundings.context(), receivers()[0]);
    let u = |sample: SampleStream| sample.get_2d(Dimension::at(0, Purpose::NextEventPosition));
    let density = |pdf: &dyn Fn(&LightPoint) -> f32, p: Vec3| match to_light(p) {
        (at, area) if area > 0.0 => pdf(&at) * area,
        _ => 0.0,
    };
    let mut battery = Battery::new("points of a light");
    let rays = samples("rays", N)
        .map(|sample| Some(to_square(&emission_of(light, &context, &sample)?.from.at)));
    let pdf = |p| density(&|at| light.pdf_position(&context, at), p);
    battery.chi2("rays", grid, pdf, rays);
    let points = samples("receivers", N).map(|sample| {
        Some(to_square(
            &point_for(light, &context, receiver, u(sample))?.at,
        ))
    });
    let of_point = |at: &LightPoint| light.pdf_next_event(&context, Part::Whole, receiver, at);
    battery.chi2("receivers", grid, |p| density(&of_point, p), points);
    battery.check();
}

/// Environments are drawn by their density, for rays and for receivers alike. The directions are
/// counted on the octahedral square, which has even measure and the texels' borders for lines.
#[test]
fn environments_are_drawn_by_the_density() {
    let to_square =
        |at: &LightPoint| direction_to_square(turn().transpose() * at.locus.point).extend(0.0);
    let to_light = |p: Vec3| {
        let w = turn() * square_to_direction(p.truncate());
        (LightPoint::at_infinity(w), 4.0 * PI)
    };
    for light in [environment(), InfiniteLight::constant([1.0; 3])] {
        let grid = Grid::new(Domain::Square, [24, 24]);
        check_points(&Light::Infinite(light), &grid, to_square, to_light);
    }
}

/// Points of a fire lie in its cells, and in eighths of them, as their density says.
#[test]
fn points_of_a_fire_follow_the_density() {
    let radiance = (0..60).map(|i| [ember(i / 2), 0.3 * ember(i), 0.0]);
    let radiance = medium::Grid::new(FIRE, radiance.collect(), fireplace()).unwrap();
    let fire = fire(Glow::Grid(radiance));
    let light = VolumeLight::new(MediumId::default(), &fire, None);
    let counts = FIRE.map(|n| 2 * n);
    let count: usize = counts.iter().product();
    let volume = fireplace().matrix3.determinant().abs() / count as f32;
    let part = |i: usize| {
        let [nx, ny, _] = counts;
        let at = Vec3::from([i % nx, i / nx % ny, i / (nx * ny)].map(|k| k as f32 + 0.5));
        fireplace().transform_point3(at / Vec3::from(counts.map(|n| n as f32)))
    };
    let in_fire = |point| LightPoint::in_medium(point, MediumId::default());
    let probs = (0..count).map(|i| f64::from(light.pdf(&in_fire(part(i))) * volume));
    let probs: Vec<f64> = probs.collect();
    let mut found = vec![0; count];
    let cube_from_world = fireplace().inverse();
    for sample in samples("fire", N) {
        let (u_position, u_depth, _) = numbers(&sample);
        let drawn = light.sample(u_position.extend(u_depth)).unwrap();
        let p = cube_from_world.transform_point3(drawn.at.locus.point);
        let [x, y, z] =
            std::array::from_fn(|k| ((p[k] * counts[k] as f32) as usize).min(counts[k] - 1));
        found[(z * counts[1] + y) * counts[0] + x] += 1;
    }
    let mut battery = Battery::new("fire");
    battery.counts("parts of cells", &found, &probs);
    battery.check();
}

/// The density of an environment is its luminance, in all directions.
#[test]
fn environments_are_drawn_by_luminance() {
    let surroundings = Surroundings::new();
    let context = surroundings.context();
    let light = Light::Infinite(environment());
    let cross_section = PI * sqr(context.radius);
    for sample in samples("luminance", 2000) {
        let at = LightPoint::at_infinity(warp::uniform_sphere(numbers(&sample).0));
        let expected =
            Lanes::Rgb.luminance(light.emitted(&context, &at, -at.locus.point, Lanes::Rgb))
                * cross_section;
        let power = light.power(&context);
        let pdf = light.pdf_position(&context, &at);
        check_close(pdf, expected / power, 1e-4, "luminance");
    }
}

/// Returns the point of the mesh for one of the square, whose x also chooses the triangle: of even area
/// within each.
fn on_mesh(mesh: &Mesh, p: Vec3) -> (LightPoint, f32) {
    let count = mesh.triangle_count();
    let scaled = p.x * count as f32;
    let triangle = (scaled as usize).min(count - 1);
    let (x, y) = ((scaled - triangle as f32).clamp(0.0, 1.0).sqrt(), p.y);
    let [a, b, c] = mesh.triangle(triangle);
    let point = a + (b - a) * (x * (1.0 - y)) + (c - a) * (x * y);
    let at = LightPoint {
        primitive: triangle as u32,
        ..LightPoint::in_space(point)
    };
    (at, mesh.triangle_area(triangle) * count as f32)
}

/// Returns the inverse of [`on_mesh`].
fn on_square(mesh: &Mesh, at: &LightPoint) -> Vec3 {
    let [a, b, c] = mesh.triangle(at.primitive as usize);
    let normal = (b - a).cross(c - a);
    let offset = at.locus.point - a;
    let barycentric = |edge: Vec3| normal.dot(edge.cross(offset)) / normal.length_squared();
    let (b1, b2) = (-barycentric(c - a), barycentric(b - a));
    let x = (b1 + b2).clamp(0.0, 1.0);
    let y = if x > 0.0 { b2 / x } else { 0.0 };
    let within = (x * x).min(0.999_999);
    let column = (at.primitive as f32 + within) / mesh.triangle_count() as f32;
    Vec3::new(column, y, 0.0)
}

/// Points of a mesh of unlike triangles are drawn by the density, for rays and for receivers.
#[test]
fn points_of_a_mesh_follow_the_density() {
    let shapes = Surroundings::new().shapes;
    let Shape::Mesh(mesh) = &shapes[0] else {
        panic!("the first shape is the mesh")
    };
    let light = AreaLight::new(0, &shapes[0], [1.0; 3], EmissionSides::Front);
    let grid = Grid::new(Domain::Square, [30, 16]);
    let (to_square, to_light) = (|at: &_| on_square(mesh, at), |p| on_mesh(mesh, p));
    check_points(&Light::Area(light), &grid, to_square, to_light);
}
