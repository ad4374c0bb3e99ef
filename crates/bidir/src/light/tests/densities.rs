use super::{
    FIRE, Surroundings, ember, environment, examples, fire, fireplace, numbers, pole, receivers,
    turn,
};
use crate::light::{
    EmissionSides, InfiniteLight, Light, LightContext, LightPoint, Part, VolumeLight,
};
use crate::math::{Frame, PI, Vec2, Vec3, direction_to_square, sqr, square_to_direction, warp};
use crate::medium::{self, Glow, MediumId};
use crate::sampler::{Dimension, Purpose};
use crate::shape::{Mesh, Shape};
use crate::spectrum::luminance;
use crate::testing::{Battery, Domain, Grid, check_close, samples};

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
    if at.locus.n_g == Vec3::ZERO {
        Frame {
            x: Vec3::X,
            y: Vec3::Y,
            z: Vec3::Z,
        }
    } else {
        Frame::from_z(at.locus.n_g)
    }
}

/// Rays leave finite lights in directions that follow the density.
#[test]
fn directions_follow_the_density() {
    let surroundings = Surroundings::new();
    let context = surroundings.context();
    let mut battery = Battery::new("light directions");
    for (name, light) in examples(&surroundings)
        .into_iter()
        .filter(|(_, l)| !l.is_infinite())
    {
        let narrow = name == "spot, narrow";
        let domain = if narrow {
            Domain::Cone(pole(), 5.5e-5)
        } else {
            directions(&light)
        };
        let grid = Grid {
            domain,
            columns: 20,
            rows: 40,
        };
        let draws = samples(name, N).map(|sample| {
            let (u_position, u_depth, u_direction) = numbers(&sample);
            let drawn = light.sample_emission(&context, u_position, || u_depth, u_direction)?;
            Some(frame(&drawn.from.at).to_local(drawn.direction))
        });
        let at = light
            .sample_next_event(
                &context,
                Part::Whole,
                receivers()[0],
                Vec2::splat(0.3),
                || 0.3,
            )
            .unwrap()
            .at;
        let pdf = |w| light.pdf_direction(&context, &at, frame(&at).to_world(w));
        battery.chi2(name, &grid, pdf, draws);
    }
    battery.check();
}

/// Rays from infinity cross the scene's disk evenly.
#[test]
fn rays_from_infinity_cross_the_disk_by_the_density() {
    let surroundings = Surroundings::new();
    let context = surroundings.context();
    let grid = Grid {
        domain: Domain::Disk(context.radius),
        columns: 16,
        rows: 24,
    };
    let mut battery = Battery::new("rays from infinity");
    for (name, light) in examples(&surroundings)
        .into_iter()
        .filter(|(_, l)| l.is_infinite())
    {
        let draws = samples(name, N).map(|sample| {
            let (u_position, u_depth, u_direction) = numbers(&sample);
            let drawn = light.sample_emission(&context, u_position, || u_depth, u_direction)?;
            let local = Frame::from_z(drawn.direction).to_local(drawn.origin - context.centre);
            Some(local.with_z(0.0))
        });
        let at = LightPoint::at_infinity(Vec3::Z);
        battery.chi2(
            name,
            &grid,
            |_| light.pdf_direction(&context, &at, -Vec3::Z),
            draws,
        );
    }
    battery.check();
}

/// Environments are drawn by their density, for rays and for receivers alike. The directions are
/// counted on the octahedral square, which has even measure and the texels' borders for lines.
#[test]
fn environments_are_drawn_by_the_density() {
    let surroundings = Surroundings::new();
    let context = surroundings.context();
    let grid = Grid {
        domain: Domain::Square,
        columns: 24,
        rows: 24,
    };
    let mut battery = Battery::new("environments");
    let to_square =
        |at: &LightPoint| direction_to_square(turn().transpose() * at.locus.point).extend(0.0);
    let direction = |p: Vec3| LightPoint::at_infinity(turn() * square_to_direction(p.truncate()));
    let lights = [
        ("image", environment()),
        ("constant", InfiniteLight::constant([1.0; 3])),
    ];
    for (name, light) in lights.map(|(name, light)| (name, Light::Infinite(light))) {
        let rays = samples(name, N).map(|sample| {
            let (u_position, u_depth, u_direction) = numbers(&sample);
            let drawn = light.sample_emission(&context, u_position, || u_depth, u_direction)?;
            Some(to_square(&drawn.from.at))
        });
        let pdf = |p| light.pdf_position(&context, &direction(p)) * 4.0 * PI;
        battery.chi2(&format!("{name}, rays"), &grid, pdf, rays);
        let points = samples(name, N).map(|sample| {
            let u = sample.get_2d(Dimension::at(0, Purpose::NextEventPosition));
            Some(to_square(
                &light
                    .sample_next_event(&context, Part::Whole, receivers()[0], u, || 0.3)?
                    .at,
            ))
        });
        let pdf = |p| {
            light.pdf_next_event(&context, Part::Whole, receivers()[0], &direction(p)) * 4.0 * PI
        };
        battery.chi2(&format!("{name}, receivers"), &grid, pdf, points);
    }
    battery.check();
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
        let at = [
            i % counts[0],
            i / counts[0] % counts[1],
            i / (counts[0] * counts[1]),
        ];
        let at: [f32; 3] = std::array::from_fn(|k| (at[k] as f32 + 0.5) / counts[k] as f32);
        fireplace().transform_point3(Vec3::from_array(at))
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
        let expected = luminance(light.emitted(&context, &at, -at.locus.point)) * cross_section;
        let power = light.power(&context);
        check_close(
            light.pdf_position(&context, &at),
            expected / power,
            1e-4,
            "luminance",
        );
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
    let barycentric =
        |edge: Vec3| normal.dot(edge.cross(at.locus.point - a)) / normal.length_squared();
    let (b1, b2) = (-barycentric(c - a), barycentric(b - a));
    let x = (b1 + b2).clamp(0.0, 1.0);
    let y = if x > 0.0 { b2 / x } else { 0.0 };
    let within = (x * x).min(0.999_999);
    Vec3::new(
        (at.primitive as f32 + within) / mesh.triangle_count() as f32,
        y,
        0.0,
    )
}

/// Points of a mesh of unlike triangles are drawn by the density, for rays and for receivers.
#[test]
fn points_of_a_mesh_follow_the_density() {
    let surroundings = Surroundings::new();
    let context = surroundings.context();
    let Shape::Mesh(mesh) = &surroundings.shapes[0] else {
        panic!("the first shape is the mesh")
    };
    let light = super::AreaLight::new(0, &surroundings.shapes[0], [1.0; 3], EmissionSides::Front);
    let light = Light::Area(light);
    let grid = Grid {
        domain: Domain::Square,
        columns: 30,
        rows: 16,
    };
    let over_square = |pdf: &dyn Fn(&LightContext<'_>, &LightPoint) -> f32, p: Vec3| {
        let (at, area) = on_mesh(mesh, p);
        if area > 0.0 {
            pdf(&context, &at) * area
        } else {
            0.0
        }
    };
    let mut battery = Battery::new("points of a mesh");
    let rays = samples("mesh, rays", N).map(|sample| {
        let (u_position, u_depth, u_direction) = numbers(&sample);
        Some(on_square(
            mesh,
            &light
                .sample_emission(&context, u_position, || u_depth, u_direction)?
                .from
                .at,
        ))
    });
    let position = |p| over_square(&|context, at| light.pdf_position(context, at), p);
    battery.chi2("rays", &grid, position, rays);
    let receiver = receivers()[0];
    let points = samples("mesh, receivers", N).map(|sample| {
        let u = sample.get_2d(Dimension::at(0, Purpose::NextEventPosition));
        Some(on_square(
            mesh,
            &light
                .sample_next_event(&context, Part::Whole, receiver, u, || 0.3)?
                .at,
        ))
    });
    let pdf = |p| {
        over_square(
            &|context, at| light.pdf_next_event(context, Part::Whole, receiver, at),
            p,
        )
    };
    battery.chi2("receivers", &grid, pdf, points);
    battery.check();
}
