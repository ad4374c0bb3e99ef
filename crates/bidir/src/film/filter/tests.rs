use super::*;

fn examples() -> Vec<Filter> {
    [
        (FilterKind::Box, 0.5),
        (FilterKind::Box, 1.3),
        (FilterKind::Triangle, 2.0),
        (FilterKind::Gaussian { sigma: 0.5 }, 1.5),
        (
            FilterKind::Mitchell {
                b: 1.0 / 3.0,
                c: 1.0 / 3.0,
            },
            2.0,
        ),
        (FilterKind::Sinc { tau: 3.0 }, 4.0),
    ]
    .map(|(kind, radius)| Filter::new(kind, Vec2::new(radius, radius * 0.8)))
    .into()
}

/// ∫ g(x) h(x) dx over both axes for the test function g.
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

#[test]
fn filters_are_normalised() {
    for filter in examples() {
        assert!(
            (integral(&filter, |_| 1.0) - 1.0).abs() < 2e-3,
            "{filter:?}"
        );
    }
}

#[test]
fn a_table_follows_its_formula() {
    let (sigma, radius) = (0.5, 1.5);
    let axis = Axis::new(FilterKind::Gaussian { sigma }, radius);
    let formula = |x: f32| gaussian(x, sigma) - gaussian(radius, sigma);
    // ∫ exp(-x² / 2σ²) is √(2π) σ erf(r / √2 σ).
    let integral = 2.506_628_3 * sigma * 0.997_300_2 - 2.0 * radius * gaussian(radius, sigma);
    for i in 0..=10_000 {
        let x = i as f32 / 10_000.0 * radius;
        let error = (axis.eval(x) - formula(x) / integral).abs();
        assert!(error < 3e-6, "{x}: {error}");
    }
    assert!(axis.eval(radius * 1.001) < f32::MIN_POSITIVE);
}

#[test]
fn drawn_offsets_reproduce_the_filter() {
    for filter in examples() {
        // At sign changes of h, a grid of numbers errs by 1/n.
        let n = 2048;
        let mut sum = 0.0;
        for i in 0..n * n {
            let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            let (p, weight) = filter.sample(u);
            sum += test_function(p) * f64::from(weight);
        }
        let (mean, expected) = (sum / f64::from(n * n), integral(&filter, test_function));
        assert!(
            (mean - expected).abs() < 5e-3,
            "{filter:?}: {mean} {expected}"
        );
    }
}

#[test]
fn picked_pixels_reproduce_the_filter() {
    let g = |x: f32| f64::from(1.0 + x + 0.3 * x * x);
    for axis in examples()
        .into_iter()
        .flat_map(|filter| [filter.x, filter.y])
    {
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
        assert!(
            (mean - expected).abs() < 1e-3,
            "{axis:?}: {mean} {expected}"
        );
    }
}

#[test]
fn the_box_of_one_pixel_picks_the_pixel_under_the_point() {
    let filter = Filter::default();
    for (x, expected) in [(3.0, 3), (3.999, 3), (3.5, 3), (4.0, 4), (-0.25, -1)] {
        let (picked, _, weight) = filter
            .pick_pixel(Vec2::new(x, 0.5), Vec2::splat(0.7))
            .unwrap();
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
