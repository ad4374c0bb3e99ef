use super::{Surroundings, examples, numbers};
use crate::light::{Light, LightChoice, LightContext};
use crate::sampler::{Dimension, Purpose};
use crate::spectrum::luminance;
use crate::testing::{Battery, check_close, samples};

/// The power by which a light is chosen is the mean of the flux that its rays carry.
#[test]
fn power_is_the_flux_of_the_rays() {
    let surroundings = Surroundings::new();
    let context = surroundings.context();
    let mut battery = Battery::new("light power");
    for (name, light) in examples(&surroundings) {
        let flux = samples(name, 1 << 20).map(|sample| {
            let (u_position, u_depth, u_direction) = numbers(&sample);
            let drawn = light.sample_emission(&context, u_position, || u_depth, u_direction);
            drawn.map_or(0.0, |drawn| {
                let emitted = f64::from(luminance(drawn.emitted_cos));
                emitted / f64::from(drawn.pdf_direction * drawn.from.pdf)
            })
        });
        if name.starts_with("patterned") {
            // An estimate, by which lights are chosen and nothing else.
            let mean = flux.sum::<f64>() / f64::from(1 << 20);
            check_close(light.power(&context), mean as f32, 0.01, name);
        } else {
            battery.mean(name, flux, f64::from(light.power(&context)));
        }
    }
    battery.check();
}

#[test]
fn lights_are_chosen_with_their_share_of_the_power() {
    let surroundings = Surroundings::new();
    let context = surroundings.context();
    let lights: Vec<Light> = examples(&surroundings)
        .into_iter()
        .map(|(_, light)| light)
        .collect();
    let choice = LightChoice::new(&lights, &context);
    let total: f32 = lights.iter().map(|light| light.power(&context)).sum();
    let mut counts = vec![0; lights.len()];
    for sample in samples("choice", 1 << 20) {
        let u = sample.get_1d(Dimension::at(0, Purpose::Light));
        let (light, prob) = choice.sample(|| u).unwrap();
        assert!((prob - choice.prob(light)).abs() <= 0.0);
        counts[light] += 1;
    }
    for (i, light) in lights.iter().enumerate() {
        check_close(choice.prob(i), light.power(&context) / total, 1e-4, "share");
    }
    let expected: Vec<f64> = (0..lights.len())
        .map(|i| f64::from(choice.prob(i)))
        .collect();
    let mut battery = Battery::new("light choice");
    battery.counts("all kinds", &counts, &expected);
    battery.check();
}

#[test]
fn nothing_is_chosen_among_no_lights() {
    let context = LightContext {
        shapes: &[],
        media: &[],
        centre: crate::math::Vec3::ZERO,
        radius: 1.0,
    };
    assert!(LightChoice::new(&[], &context).sample(|| 0.5).is_none());
}
