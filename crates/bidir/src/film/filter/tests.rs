use super::*;
use crate::testing::check_near;

fn examples() -> Vec<(FilterKind, Filter)> {
    [
        (FilterKind::Box, 0.5),
        (FilterKind::Box, 1.3),
        (FilterKind::Triangle, 2.0),
        (FilterKind::Gaussian { sigma: 0.5 }, 1.5),
        (FilterKind::Gaussian { sigma: 100.0 }, 1e-3),
        (MITCHELL, 2.0),
        (FilterKind::Sinc { tau: 3.0 }, 4.0),
    ]
    .map(|(kind, radius)| (kind, Filter::new(kind, Vec2::new(radius, radius * 0.8))))
    .into()
}

const MITCHELL: FilterKind = FilterKind::Mitchell {
    b: 1.0 / 3.0,
    c: 1.0 / 3.0,
};

/// Returns ∫ g(x) h(x) dx over both axes for the test function g.
fn integral(filter: &Filter, g: impl Fn(Vec2) -> f64) -> f64 {
    let (n, r) = (800, filter.radius());
    let mut sum = 0.0;
    for i in 0..n {
        for j in 0..n {
            let p = (Vec2::new(i as f32 + 0.5, j as f32 + 0.5) * (2.0 / n as f32) - 1.0) * r;
            sum += f64::from(filter.eval(p)) * g(p);
        }
    }
    sum * f64::from(4.0 * r.x * r.y) / f64::from(n * n)
}

fn test_function(p: Vec2) -> f64 {
    1.0 + f64::from(p.x) + 0.5 * f64::from(p.y * p.y) + 0.3 * f64::from(p.x * p.x)
}

/// Checks h along an axis against its `shape` over [-r, r], which is not normalised.
#[track_caller]
fn check_formula(kind: FilterKind, radius: f32, shape: impl Fn(f64) -> f64) {
    let axis = Axis::new(kind, radius);
    let n = 100_000;
    let place = |i: usize| (i as f64 + 0.5) / n as f64 * f64::from(radius);
    let sum: f64 = (0..n).map(|i| shape(place(i))).sum();
    let integral = 2.0 * f64::from(radius) * sum / n as f64;
    for x in (0..n).step_by(7).map(place) {
        let expected = shape(x) / integral;
        let error = f64::from(axis.eval(x as f32)) - expected;
        let peak = shape(0.0) / integral;
        assert!(error.abs() < 1e-5 * peak, "{kind:?} at {x}: {error}");
    }
    assert!(axis.eval(radius * 1.001) < f32::MIN_POSITIVE);
}

#[test]
fn tables_follow_their_formulas() {
    check_formula(FilterKind::Box, 1.3, |_| 1.0);
    check_formula(FilterKind::Triangle, 2.0, |x| 2.0 - x);
    let bell = |x: f64| libm::exp(-2.0 * x * x);
    let gaussian = FilterKind::Gaussian { sigma: 0.5 };
    check_formula(gaussian, 1.5, |x| bell(x) - bell(1.5));
    // So wide a bell is a parabola.
    let wide = FilterKind::Gaussian { sigma: 100.0 };
    check_formula(wide, 0.5, |x| 0.25 - x * x);
    // Both pieces for B = C = 1/3, radius 2.
    check_formula(MITCHELL, 2.0, |x| {
        if x < 1.0 {
            (7.0 * x - 12.0) * x * x + 16.0 / 3.0
        } else {
            ((-7.0 / 3.0 * x + 12.0) * x - 20.0) * x + 32.0 / 3.0
        }
    });
    let sinc = |x: f64| libm::sin(x) / x;
    let pi = std::f64::consts::PI;
    let windowed = |x: f64| sinc(pi * x.max(1e-9)) * sinc(pi * x.max(1e-9) / 3.0);
    check_formula(FilterKind::Sinc { tau: 3.0 }, 4.0, windowed);
}

#[test]
fn drawn_offsets_reproduce_the_filter() {
    for (kind, filter) in examples() {
        // At sign changes of h, a grid of numbers errs by 1/n.
        let n = 2048;
        let mut sum = 0.0;
        for i in 0..n * n {
            let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            let (p, weight) = filter.sample(u);
            sum += test_function(p) * f64::from(weight);
        }
        let (mean, expected) = (sum / f64::from(n * n), integral(&filter, test_function));
        check_near(mean, expected, 5e-3, format!("{kind:?}"));
    }
}

#[test]
fn picked_pixels_reproduce_the_filter() {
    let g = |x: f32| f64::from(1.0 + x + 0.3 * x * x);
    let both = |(kind, Filter { x, y })| [(kind, x), (kind, y)];
    for (kind, axis) in examples().into_iter().flat_map(both) {
        let (raster, n) = (10.3f32, 100_000);
        let mut mean = 0.0;
        for i in 0..n {
            let Some((x, weight)) = axis.pick(raster, (i as f32 + 0.5) / n as f32) else {
                continue;
            };
            mean += f64::from(weight) * g(raster - x as f32 - 0.5) / f64::from(n);
        }
        let offsets = (0..20).map(|x| raster - x as f32 - 0.5);
        let expected: f64 = offsets.map(|x| f64::from(axis.eval(x)) * g(x)).sum();
        check_near(mean, expected, 1e-3, format!("{kind:?}"));
    }
}

#[test]
fn the_box_of_one_pixel_picks_the_pixel_under_the_point() {
    let filter = Filter::default();
    for (x, expected) in [(3.0, 3), (3.999, 3), (3.5, 3), (4.0, 4), (-0.25, -1)] {
        let picked = filter.pick_pixel(Vec2::new(x, 0.5), Vec2::splat(0.7));
        let (picked, _, weight) = picked.unwrap();
        assert_eq!(picked, expected, "{x}");
        assert!((weight - 1.0).abs() < 1e-6);
    }
}

#[test]
fn floor_is_that_of_the_standard_library() {
    let numbers = [0.0, 0.5, 1.0, 3.999, 8_388_607.5, 1e10, 1e30];
    for x in numbers.into_iter().flat_map(|x: f32| [x, -x]) {
        assert_eq!(floor(x), x.floor() as i64, "{x}");
    }
    for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(floor(x), x.floor() as i64, "{x}");
    }
}
