use super::{Example, examples};
use crate::math::Vec3;
use crate::sampler::{Dimension, Purpose};
use crate::shape::SurfacePoint;
use crate::testing::{Battery, Domain, Grid, check_close, samples};

/// Area per area of the parameter square at (x, y), by differences.
fn stretch(example: &Example, x: f64, y: f64) -> f64 {
    let h = 1e-4;
    let (x, y) = (x.clamp(h, 1.0 - h), y.clamp(h, 1.0 - h));
    let point = &example.point;
    let dx = (point(x + h, y) - point(x - h, y)) / (2.0 * h);
    let dy = (point(x, y + h) - point(x, y - h)) / (2.0 * h);
    dx.cross(dy).length()
}

fn point(example: &Example, p: Vec3) -> Vec3 {
    (example.point)(f64::from(p.x), f64::from(p.y)).as_vec3()
}

/// Drawn points follow the density, and it integrates to one over the area.
#[test]
fn samples_follow_the_density() {
    let grid = Grid::new(Domain::Square, [20, 24]);
    let mut battery = Battery::new("shape densities");
    for example in examples() {
        let shape = &example.shape;
        let draws = samples(example.name, 1 << 20).map(|sample| {
            let u = sample.get_2d(Dimension::at(0, Purpose::LightPosition));
            Some((example.square)(shape.sample(0, u).surface.point).extend(0.0))
        });
        let pdf = |p: Vec3| {
            let stretch = stretch(&example, f64::from(p.x), f64::from(p.y));
            shape.pdf(0, point(&example, p)) * stretch as f32
        };
        battery.chi2(example.name, &grid, pdf, draws);
    }
    battery.check();
}

#[test]
fn areas_are_those_of_a_fine_grid() {
    for example in examples() {
        let n = 400;
        let midpoint = |i: i32| (f64::from(i) + 0.5) / f64::from(n);
        let cells = (0..n * n).map(|i| stretch(&example, midpoint(i % n), midpoint(i / n)));
        let area = cells.sum::<f64>() / f64::from(n * n);
        let found = example.shape.primitive_area(0);
        check_close(found, area, 2e-4, example.name);
    }
}

#[test]
fn the_density_of_a_sample_is_that_of_its_point() {
    let receiver = Vec3::new(5.0, -3.0, 4.0);
    for Example { name, shape, .. } in examples() {
        for sample in samples(name, 1000) {
            let drawn = shape.sample(0, sample.get_2d(Dimension::at(0, Purpose::LightPosition)));
            check_close(drawn.pdf, shape.pdf(0, drawn.surface.point), 1e-4, name);
            let u = sample.get_2d(Dimension::at(1, Purpose::NextEventPosition));
            let drawn = shape.sample_from(0, receiver, u);
            let SurfacePoint { point, n_g, .. } = drawn.surface;
            let pdf = shape.pdf_from(0, receiver, point, n_g);
            check_close(drawn.pdf, pdf, 1e-4, name);
        }
    }
}
