use super::{Surroundings, emission_of, for_each_light, point_for, receivers};
use crate::light::{
    AreaLight, DistantLight, EmissionSample, EmissionSides, InfiniteLight, Light, LightContext,
    Part, PointLight, SpotLight, VolumeLight,
};
use crate::math::sin_cos;
use crate::medium::{Glow, MediumId};
use crate::spectrum::permuted::Order as LaneOrder;
use crate::spectrum::{Beyond, Curve, Illuminant, LUMINANCE_OF_ONE, Lanes};
use crate::testing::prelude::*;
use accel::Aabb;

/// Checks that the densities and the value in a sample are those of the functions for it.
#[track_caller]
fn check_emission(light: &Light, context: &LightContext<'_>, drawn: &EmissionSample, case: &str) {
    let at = &drawn.from.at;
    assert!((drawn.direction.length() - 1.0).abs() < 1e-4, "{case}");
    for pdf in [drawn.pdf_direction, drawn.from.pdf] {
        assert!(pdf > 0.0 && pdf.is_finite(), "{case}");
    }
    check_close(drawn.from.pdf, light.pdf_position(context, at), 1e-4, case);
    let pdf = light.pdf_direction(context, at, drawn.direction);
    check_close(drawn.pdf_direction, pdf, 1e-4, case);
    let has_surface = at.locus.n_g.length_squared() > 0.5;
    assert_eq!(has_surface, matches!(light, Light::Area(_)), "{case}");
    assert_eq!(at.locus.is_infinite(), light.is_infinite(), "{case}");
    let cos = if has_surface {
        at.locus.n_g.dot(drawn.direction).abs()
    } else {
        1.0
    };
    let emitted = light.emitted(context, at, drawn.direction, Lanes::Rgb);
    for (with_cos, emitted) in drawn.emitted_cos.0.into_iter().zip(emitted.0) {
        check_close(with_cos, emitted * cos, 1e-4, case);
    }
    let start = drawn.origin;
    if light.is_infinite() {
        // Outside the scene, from where the ray crosses the disk perpendicular to it.
        let offset = start - context.centre;
        assert!((drawn.direction + at.locus.point).length() < 1e-5, "{case}");
        check_near(offset.dot(drawn.direction), -context.radius, 1e-4, case);
        assert!(offset.length() > context.radius * 0.9999, "{case}");
    } else {
        assert!(start.distance(at.locus.point) <= 0.0, "{case}: {start}");
    }
}

#[test]
fn rays_have_the_densities_and_the_light_that_the_light_says() {
    for_each_light(|name, light, context| {
        let drawn = samples(name, 2000).filter_map(|it| emission_of(light, context, &it));
        let checked = drawn.inspect(|drawn| check_emission(light, context, drawn, name));
        let count = checked.count();
        assert!(count > 1990, "{name}: {count} rays");
    });
}

#[test]
fn points_for_a_receiver_have_the_density_that_the_light_says() {
    for_each_light(|name, light, context| {
        for (sample, i) in samples(name, 2000).zip(0..) {
            let receiver = receivers()[i % 3];
            let u = sample.get_2d(Dimension::at(0, Purpose::NextEventPosition));
            let drawn = light.sample_next_event(context, Part::Whole, receiver, u, || u.y);
            let drawn = drawn.unwrap();
            assert!(drawn.pdf > 0.0 && drawn.pdf.is_finite(), "{name}");
            let pdf = light.pdf_next_event(context, Part::Whole, receiver, &drawn.at);
            check_close(drawn.pdf, pdf, 1e-3, name);
        }
    });
}

/// A surface emits to its front, or to both sides; nothing is drawn where nothing is emitted.
#[test]
fn sides_that_do_not_emit_are_dark() {
    for_each_light(|name, light, context| {
        if !matches!(light, Light::Area(_)) {
            return;
        }
        let at = &point_for(light, context, Vec3::ZERO, Vec2::splat(0.3))
            .unwrap()
            .at;
        let bright = |w: Vec3| light.emitted(context, at, w, Lanes::Rgb)[1] > 0.0;
        let drawable = |w: Vec3| light.pdf_direction(context, at, w) > 0.0;
        let n = at.locus.n_g;
        assert!(bright(n) && drawable(n), "{name}");
        let behind = [bright(-n), drawable(-n)];
        assert_eq!(behind, [name.ends_with("both sides"); 2], "{name}");
    });
}

#[test]
fn a_spot_falls_off_smoothly_and_ends() {
    let [full, end] = [0.4, 0.6];
    let spot = SpotLight::new(Vec3::ZERO, Vec3::Z, [1.0; 3], [full, end]);
    let at = |angle: f32| {
        let (sin, cos) = sin_cos(angle);
        Vec3::new(sin, 0.0, cos)
    };
    let intensity = |angle| spot.intensity(at(angle), Lanes::Rgb)[0];
    let step = 1e-3;
    for i in 0..1000u16 {
        let angle = step * f32::from(i);
        let (here, next) = (intensity(angle), intensity(angle + step));
        assert!(next <= here && here - next < 0.01, "a jump at {angle}");
        let is_drawn = here <= 0.0 || spot.pdf_direction(at(angle)) > 0.0;
        assert!(is_drawn, "nothing drawn at {angle}");
    }
    assert!((intensity(full - step) - 1.0).abs() < 1e-6 && intensity(end + step) <= 0.0);
    assert!(spot.pdf_direction(at(end + step)) <= 0.0);
}

/// Lights of a known spectrum emit its values where lanes are wavelengths.
#[test]
fn lights_emit_their_spectra() {
    const LUMINANCE: f32 = 3.0;
    let line = Curve::from_pairs(&[300.0, 1.0, 900.0, 7.0], Beyond::Zero).unwrap();
    let unit = Illuminant::of_curve(line.clone()).unwrap();
    let light = unit.map(|channel| channel * LUMINANCE);
    // The line's value at the centroid of ȳ, times ∫ ȳ dλ.
    let luminance = f64::from(LUMINANCE_OF_ONE) * line.at(559.9);
    let value = |nm| LUMINANCE * (line.at(nm) / luminance) as f32;
    let expected = [value(465.0), value(610.0), 0.0, value(550.0)];
    let glow = medium([1.0; 3], [0.0; 3], 0.0).glowing(Glow::Even(light.clone()));
    let surroundings = Surroundings {
        media: vec![glow.unwrap()],
        ..Surroundings::new()
    };
    let (context, front) = (surroundings.context(), EmissionSides::Front);
    let area = AreaLight::new(0, &surroundings.shapes[0], light.clone(), front);
    let gas = VolumeLight::new(
        MediumId::new(0).unwrap(),
        &surroundings.media[0],
        Some(Aabb::around(&[Vec3::ZERO, Vec3::ONE])),
    );
    let distant = DistantLight {
        to_light: Vec3::Z,
        irradiance: light.clone(),
    };
    let point = PointLight {
        position: Vec3::ONE,
        intensity: light.clone(),
    };
    let spot = SpotLight::new(Vec3::ONE, Vec3::Z, light.clone(), [1.0, 1.0]);
    for light in [
        Light::Area(area),
        Light::Point(point),
        Light::Spot(spot),
        Light::Distant(distant),
        Light::Infinite(InfiniteLight::constant(light)),
        Light::Volume(gas),
    ] {
        let name = light.kind();
        let drawn = samples(name, 9).find_map(|it| emission_of(&light, &context, &it));
        let EmissionSample {
            from, direction, ..
        } = drawn.expect("the light emits");
        let lanes = Lanes::Permuted(LaneOrder([2, 0, 3, 1]));
        let emitted = light.emitted(&context, &from.at, direction, lanes);
        for (lane, expected) in emitted.0.into_iter().zip(expected) {
            check_near(lane, expected, 1e-3 * f64::from(expected), name);
        }
    }
}
