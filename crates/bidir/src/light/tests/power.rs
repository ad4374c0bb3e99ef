use super::{Surroundings, emission_of, examples, for_each_light};
use crate::light::{Light, LightChoice, LightContext};
use crate::spectrum::Lanes;
use crate::testing::prelude::*;

/// The power by which a light is chosen is the mean of the flux that its rays carry.
#[test]
fn power_is_the_flux_of_the_rays() {
    let mut battery = Battery::new("light power");
    for_each_light(|name, light, context| {
        let flux = samples(name, 1 << 20).map(|sample| {
            emission_of(light, context, &sample).map_or(0.0, |drawn| {
                let emitted = f64::from(Lanes::Rgb.luminance(drawn.emitted_cos));
                emitted / f64::from(drawn.pdf_direction * drawn.from.pdf)
            })
        });
        let power = light.power(context);
        if name.starts_with("patterned") {
            // An estimate, by which lights are chosen and nothing else.
            let mean = flux.sum::<f64>() / f64::from(1 << 20);
            check_close(power, mean, 0.01, name);
        } else {
            battery.mean(name, flux, f64::from(power));
        }
    });
    battery.check();
}

#[test]
fn lights_are_chosen_with_their_share_of_the_power() {
    let surroundings = Surroundings::new();
    let context = surroundings.context();
    let examples = examples(&surroundings).into_iter();
    let lights: Vec<Light> = examples.map(|(_, light)| light).collect();
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
    let probs = (0..lights.len()).map(|i| f64::from(choice.prob(i)));
    let expected: Vec<f64> = probs.collect();
    let mut battery = Battery::new("light choice");
    battery.counts("all kinds", &counts, &expected);
    battery.check();
}

#[test]
fn nothing_is_chosen_among_no_lights() {
    let context = LightContext {
        shapes: &[],
        media: &[],
        centre: Vec3::ZERO,
        radius: 1.0,
    };
    assert!(LightChoice::new(&[], &context).sample(|| 0.5).is_none());
}
