use super::{Surroundings, examples, numbers, receivers};
use crate::light::{EmissionSample, Light, LightContext, Part, SpotLight};
use crate::math::{Vec2, Vec3, sin_cos};
use crate::sampler::{Dimension, Purpose};
use crate::testing::{check_close, samples};

/// Checks that the densities and the value in a sample are those of the functions for it.
#[track_caller]
fn check_emission(light: &Light, context: &LightContext<'_>, drawn: &EmissionSample, case: &str) {
    let at = &drawn.from.at;
    assert!((drawn.direction.length() - 1.0).abs() < 1e-4, "{case}");
    assert!(
        drawn.pdf_direction > 0.0 && drawn.pdf_direction.is_finite(),
        "{case}"
    );
    assert!(drawn.from.pdf > 0.0 && drawn.from.pdf.is_finite(), "{case}");
    check_close(drawn.from.pdf, light.pdf_position(context, at), 1e-4, case);
    check_close(
        drawn.pdf_direction,
        light.pdf_direction(context, at, drawn.direction),
        1e-4,
        case,
    );
    let has_surface = at.locus.n_g.length_squared() > 0.5;
    assert_eq!(has_surface, matches!(light, Light::Area(_)), "{case}");
    assert_eq!(at.locus.is_infinite(), light.is_infinite(), "{case}");
    let cos = if has_surface {
        at.locus.n_g.dot(drawn.direction).abs()
    } else {
        1.0
    };
    for (with_cos, emitted) in
        drawn
            .emitted_cos
            .iter()
            .zip(light.emitted(context, at, drawn.direction))
    {
        check_close(*with_cos, emitted * cos, 1e-4, case);
    }
    if !light.is_infinite() {
        assert!(
            (drawn.origin - at.locus.point).length() <= 0.0,
            "{case}: leaves somewhere else"
        );
    }
}

#[test]
fn rays_have_the_densities_and_the_light_that_the_light_says() {
    let surroundings = Surroundings::new();
    let context = surroundings.context();
    for (name, light) in examples(&surroundings) {
        let mut count = 0;
        for sample in samples(name, 2000) {
            let (u_position, u_depth, u_direction) = numbers(&sample);
            if let Some(drawn) =
                light.sample_emission(&context, u_position, || u_depth, u_direction)
            {
                check_emission(&light, &context, &drawn, name);
                count += 1;
            }
        }
        assert!(count > 1990, "{name}: {count} rays");
    }
}

#[test]
fn points_for_a_receiver_have_the_density_that_the_light_says() {
    let surroundings = Surroundings::new();
    let context = surroundings.context();
    for (name, light) in examples(&surroundings) {
        for (sample, i) in samples(name, 2000).zip(0..) {
            let receiver = receivers()[i % 3];
            let u = sample.get_2d(Dimension::at(0, Purpose::NextEventPosition));
            let drawn = light
                .sample_next_event(&context, Part::Whole, receiver, u, || u.y)
                .unwrap();
            assert!(drawn.pdf > 0.0 && drawn.pdf.is_finite(), "{name}");
            let pdf = light.pdf_next_event(&context, Part::Whole, receiver, &drawn.at);
            check_close(drawn.pdf, pdf, 1e-3, name);
        }
    }
}

/// Rays of lights at infinity start outside the scene and cross the disk perpendicular to them.
#[test]
fn rays_from_infinity_start_outside_the_scene() {
    let surroundings = Surroundings::new();
    let context = surroundings.context();
    for (name, light) in examples(&surroundings)
        .into_iter()
        .filter(|(_, l)| l.is_infinite())
    {
        for sample in samples(name, 1000) {
            let (u_position, u_depth, u_direction) = numbers(&sample);
            let drawn = light
                .sample_emission(&context, u_position, || u_depth, u_direction)
                .unwrap();
            assert!(
                (drawn.direction + drawn.from.at.locus.point).length() < 1e-5,
                "{name}"
            );
            let offset = drawn.origin - context.centre;
            assert!(
                (offset.dot(drawn.direction) + context.radius).abs() < 1e-4,
                "{name}"
            );
            assert!(offset.length() > context.radius * 0.9999, "{name}");
        }
    }
}

/// A surface emits to its front, or to both sides; nothing is drawn where nothing is emitted.
#[test]
fn sides_that_do_not_emit_are_dark() {
    let surroundings = Surroundings::new();
    let context = surroundings.context();
    for (name, light) in examples(&surroundings) {
        if !matches!(light, Light::Area(_)) {
            continue;
        }
        let drawn = light
            .sample_next_event(&context, Part::Whole, Vec3::ZERO, Vec2::splat(0.3), || 0.3)
            .unwrap();
        let at = &drawn.at;
        let bright = |w: Vec3| light.emitted(&context, at, w)[1] > 0.0;
        let drawable = |w: Vec3| light.pdf_direction(&context, at, w) > 0.0;
        assert!(bright(at.locus.n_g) && drawable(at.locus.n_g), "{name}");
        let both = name.ends_with("both sides");
        assert_eq!(
            (bright(-at.locus.n_g), drawable(-at.locus.n_g)),
            (both, both),
            "{name}"
        );
    }
}

#[test]
fn a_spot_falls_off_smoothly_and_ends() {
    let [full, end] = [0.4, 0.6];
    let spot = SpotLight::new(Vec3::ZERO, Vec3::Z, [1.0; 3], [full, end]);
    let at = |angle: f32| {
        let (sin, cos) = sin_cos(angle);
        Vec3::new(sin, 0.0, cos)
    };
    let intensity = |angle| spot.intensity(at(angle))[0];
    let step = 1e-3;
    for i in 0..1000u16 {
        let angle = step * f32::from(i);
        let (here, next) = (intensity(angle), intensity(angle + step));
        assert!(next <= here && here - next < 0.01, "a jump at {angle}");
        assert!(
            here <= 0.0 || spot.pdf_direction(at(angle)) > 0.0,
            "nothing drawn at {angle}"
        );
    }
    assert!((intensity(full - step) - 1.0).abs() < 1e-6 && intensity(end + step) <= 0.0);
    assert!(spot.pdf_direction(at(end + step)) <= 0.0);
}
