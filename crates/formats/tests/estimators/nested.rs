//! Volumes within each other: a liquid that overlaps the glass around it, with a bubble and a stone in it.

use crate::statistics::{Shown, WHOLE, check_agree, replicates};
use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir_formats::pbrt::{LoadOptions, Loaded, build, parse_text};

/// The camera and the sky.
const VIEW: &str = r#"
LookAt 0 0 -4  0 0 0  0 1 0
Camera "perspective" "float fov" 36
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
PixelFilter "box"
"#;

/// A hollow ball of glass; a liquid that fills it and half its wall; a bubble that touches both. `GLASS` and `LIQUID`
/// stand for media.
const VESSEL: &str = r#"
MakeNamedMaterial "glass" "string type" "dielectric" "float eta" 1.5 "integer priority" 2 ROUGH
MakeNamedMaterial "liquid" "string type" "dielectric" "float eta" 1.33 "integer priority" 1 ROUGH
MakeNamedMaterial "air" "string type" "dielectric" "float eta" 1 "integer priority" 3
NamedMaterial "glass"
MediumInterface "GLASS" ""
Shape "sphere" "float radius" 1
AttributeBegin
  ReverseOrientation
  Shape "sphere" "float radius" 0.8
AttributeEnd
NamedMaterial "liquid"
MediumInterface "LIQUID" ""
Shape "sphere" "float radius" 0.9
NamedMaterial "air"
MediumInterface "" ""
AttributeBegin
  Translate 0.3 0.5 0
  Shape "sphere" "float radius" 0.4
AttributeEnd
"#;

fn load(world: &str, [glass, liquid, rough]: [&str; 3]) -> Loaded {
    let vessel = VESSEL.replace("GLASS", glass).replace("LIQUID", liquid);
    let text = format!(
        "{VIEW} WorldBegin {world} {}",
        vessel.replace("ROUGH", rough)
    );
    let description = parse_text("s.pbrt", &text).expect("it is valid");
    build(&description, &LoadOptions::default()).expect("it is supported")
}

fn shown(loaded: &Loaded) -> Shown<'_> {
    Shown {
        scene: &loaded.scene,
        view: &loaded.view,
    }
}

/// Clear smooth glass keeps all light, whatever is in what.
#[test]
fn clear_volumes_are_not_seen_in_a_furnace() {
    let loaded = load(r#"LightSource "infinite" "rgb L" [1 1 1]"#, [""; 3]);
    for integrator in [IntegratorKind::Path, IntegratorKind::Bdpt] {
        let mut settings = Settings::new(integrator);
        settings.path.max_depth = None;
        let result = replicates(shown(&loaded), &settings, 512);
        check_agree("vessel", &result, &result.exactly([1.0; 3]), &[WHOLE]);
    }
}

/// Rough glass of index 1.5 around a scattering liquid and a stone, under a lamp.
#[test]
fn estimators_agree_about_nested_volumes() {
    let world = r#"
MakeNamedMedium "tint" "string type" "homogeneous" "rgb sigma_s" [0 0 0] "rgb sigma_a" [0.1 0.4 1]
MakeNamedMedium "milk" "string type" "homogeneous" "rgb sigma_s" [0.6 0.5 0.3] "rgb sigma_a" [0.2 0.1 0.1]
LightSource "infinite" "rgb L" [0.3 0.4 0.5]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [8 8 8]
  Material "diffuse"
  Translate 1.5 2 -1
  Shape "sphere" "float radius" 0.4
AttributeEnd
AttributeBegin
  Material "diffuse" "rgb reflectance" [0.8 0.6 0.2]
  Translate -0.2 -0.4 0
  Shape "sphere" "float radius" 0.3
AttributeEnd
"#;
    let rough = r#""float roughness" 0.25"#;
    let loaded = load(world, ["tint", "milk", rough]);
    let of = |integrator, passes| {
        let mut settings = Settings::new(integrator);
        settings.path.max_depth = Some(8);
        replicates(shown(&loaded), &settings, passes)
    };
    let path = of(IntegratorKind::Path, 8192);
    for (name, integrator) in [("bdpt", IntegratorKind::Bdpt), ("lvc", IntegratorKind::Lvc)] {
        check_agree(name, &of(integrator, 2048), &path, &[WHOLE, 4]);
    }
}
