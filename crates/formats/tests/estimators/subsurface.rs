//! The material `subsurface`: a ball of a reflectance under an even sky returns that part of the light that enters.

use crate::statistics::{Shown, WHOLE, check_agree, replicates};
use bidir::bsdf::fresnel::dielectric;
use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir_formats::pbrt::{LoadOptions, build, parse_text};
use std::f64::consts::FRAC_PI_4;

/// A ball as wide as the film, many free paths thick, of which parallel rays see every direction as often as light
/// leaves it there.
const BALL: &str = r#"
LookAt 0 0 -10  0 0 0  0 1 0
Camera "orthographic" "float screenwindow" [-1 1 -1 1]
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
PixelFilter "box"
WorldBegin
LightSource "infinite" "rgb L" [1 1 1]
Material "subsurface" "rgb reflectance" [0.2 0.5 0.8] "rgb mfp" [0.002 0.002 0.002]
Shape "sphere"
"#;

/// 2 ∫ F μ dμ.
fn diffuse_fresnel(eta: f32) -> f64 {
    let cosines = (0..1000).map(|i| (i as f32 + 0.5) / 1000.0);
    cosines
        .map(|cos| f64::from(dielectric(cos, eta) * cos))
        .sum::<f64>()
        / 500.0
}

#[test]
fn a_ball_reflects_the_part_that_was_asked_for() {
    let description = parse_text("s.pbrt", BALL).expect("it is valid");
    let loaded = build(&description, &LoadOptions::default()).expect("it is supported");
    let shown = Shown {
        scene: &loaded.scene,
        view: &loaded.view,
    };
    let surface = diffuse_fresnel(1.33);
    let expected = [0.2, 0.5, 0.8].map(|part| {
        let ball = surface + (1.0 - surface) * part;
        FRAC_PI_4 * ball + (1.0 - FRAC_PI_4)
    });
    let mut settings = Settings::new(IntegratorKind::Path);
    settings.path.max_depth = None;
    let result = replicates(shown, &settings, 256);
    check_agree("ball", &result, &result.exactly(expected), &[WHOLE]);
}
