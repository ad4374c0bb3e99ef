use super::{STRICT, load_text, world};
use crate::error::ErrorKind;
use crate::pbrt::load;
use bidir::light::{Light, LightPoint};
use bidir::math::Vec3;
use bidir::shape::{Orientation, Shape};
use bidir::spectrum::Lanes;
use std::fs;

/// The light of a given power.
const POWERED: &str = "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"float power\" 3\n";
/// Four corners of a square and one beside it.
const CORNERS: &str = "\"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0 9 9 9]";

/// Checks the number of lights of shapes after a given power, each of which has it, and whether there is a
/// warning.
#[track_caller]
fn check_power(shapes: &str, lights: usize, warns: bool) {
    let loaded = load_text(&format!("WorldBegin\n{POWERED}{shapes}"), &STRICT);
    let scene = &loaded.scene;
    assert_eq!(scene.lights().len(), lights, "{shapes}");
    for light in scene.lights() {
        let power = light.power(&scene.light_context());
        assert!((power - 3.0).abs() < 1e-3, "{power}: {shapes}");
    }
    let mut warnings = loaded.warnings.iter();
    let is_warned = warnings.any(|warning| warning.starts_with("s.pbrt:2:57: `power` is that of"));
    assert_eq!(is_warned, warns, "{:?}", loaded.warnings);
}

#[test]
fn power_goes_to_every_face_of_a_mesh_with_a_warning() {
    let mesh = |kind: &str, indices: &str| {
        format!("Shape \"{kind}\" {CORNERS} \"integer indices\" [{indices}]\n")
    };
    let one = mesh("trianglemesh", "0 1 2");
    check_power(&one, 1, false);
    check_power(&one.repeat(2), 2, false);
    check_power(&mesh("trianglemesh", "0 1 2 1 3 2"), 2, true);
    // A patch is one face, whether it is flat or not.
    check_power(&mesh("bilinearmesh", "0 1 2 3"), 1, false);
    check_power(&mesh("bilinearmesh", "0 1 2 4"), 1, false);
    check_power(&mesh("bilinearmesh", "0 1 2 3 0 1 2 4"), 2, true);
    check_power(
        "Shape \"loopsubdiv\" \"integer levels\" 1 \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]",
        4,
        true,
    );
    check_power("Shape \"sphere\" Shape \"disk\"", 2, false);
    let object = format!("ObjectBegin \"o\" {one} ObjectEnd ");
    let instance = "ObjectInstance \"o\" Translate 3 0 0 ";
    check_power(&(object + &instance.repeat(2)), 2, false);
}

#[test]
fn power_goes_to_every_face_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    for (faces, lights, warns) in [
        ("4 0 1 3 2\n", 1, false),
        ("3 0 1 2\n", 1, false),
        ("3 0 1 2\n4 0 1 3 2\n3 1 3 2\n", 3, true),
    ] {
        let count = faces.lines().count();
        let header = format!(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
             property float z\nelement face {count}\nproperty list uchar int vertex_indices\nend_header\n"
        );
        let path = folder.path().join(format!("{lights}{count}.ply"));
        fs::write(&path, header + "0 0 0\n1 0 0\n0 1 0\n1 1 0\n" + faces).unwrap();
        let shape = format!(
            "Shape \"plymesh\" \"string filename\" \"{}\"",
            path.display()
        );
        check_power(&shape, lights, warns);
    }
}

#[test]
fn parts_of_a_mesh_keep_its_orientation() {
    let triangles = format!("Shape \"trianglemesh\" {CORNERS} \"integer indices\" [0 1 2 1 3 2]");
    let scene = world(&format!("{POWERED}{triangles}"));
    let Shape::Mesh(mesh) = &scene.shapes()[1] else {
        panic!("a mesh stays a mesh")
    };
    assert_eq!(
        (mesh.positions.len(), mesh.orientation),
        (3, Orientation::Natural)
    );
}

#[test]
fn lights_have_their_transformations() {
    let scene = world(
        "Translate 1 0 0 LightSource \"point\" \"rgb I\" [1 2 3] \"float scale\" 2 \"point3 \
         from\" [0 1 0]\n\
         LightSource \"spot\" \"float power\" 10\n\
         LightSource \"distant\" \"rgb L\" [4 4 4] \"point3 from\" [0 5 0] \"point3 to\" [0 0 0]\n\
         LightSource \"infinite\" \"rgb L\" [1 1 1] \"float illuminance\" 2",
    );
    let [
        Light::Point(point),
        spot @ Light::Spot(_),
        Light::Distant(distant),
        infinite,
    ] = scene.lights()
    else {
        panic!("the lights are in the order of the file");
    };
    assert_eq!(
        (point.position, point.intensity.color()),
        (Vec3::new(1.0, 1.0, 0.0), [2.0, 4.0, 6.0])
    );
    assert!((spot.power(&scene.light_context()) - 10.0).abs() < 1e-3);
    assert_eq!(
        (distant.to_light, distant.irradiance.color()),
        (Vec3::Y, [4.0; 3])
    );
    let at = LightPoint::at_infinity(Vec3::Z);
    let radiance = infinite.emitted(&scene.light_context(), &at, -Vec3::Z, Lanes::Rgb);
    let luminance = Lanes::Rgb.luminance(radiance);
    assert!((luminance * std::f32::consts::PI - 2.0).abs() < 1e-5);
}

#[test]
fn environments_are_square_and_their_numbers_checked() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, size: [usize; 2], data: &[f32]| {
        let layers = [crate::image::ExrLayer {
            name: "",
            channels: &["R", "G", "B"],
            data,
        }];
        let crop = [0, 0, size[0], size[1]];
        let image = crate::image::ExrImage {
            resolution: size,
            crop,
            layers: &layers,
            metadata: &[],
        };
        crate::image::write_exr(&folder.path().join(name), &image).unwrap();
    };
    write("wide.exr", [2, 1], &[1.0; 6]);
    write("square.exr", [1, 1], &[2.0, f32::NAN, -1.0]);
    let load = |name: &str| {
        let text = format!("WorldBegin LightSource \"infinite\" \"string filename\" \"{name}\"");
        let path = folder.path().join("s.pbrt");
        fs::write(&path, text).unwrap();
        load(&path, &STRICT)
    };
    let error = load("wide.exr").unwrap_err();
    assert_eq!(
        error.message(),
        "the image of an environment is square; this one has 2 × 1 pixels"
    );
    let loaded = load("square.exr").unwrap();
    let at = LightPoint::at_infinity(Vec3::X);
    let scene = &loaded.scene;
    let radiance = scene.lights()[0].emitted(&scene.light_context(), &at, -Vec3::X, Lanes::Rgb);
    assert_eq!(Vec3::from(Lanes::Rgb.to_rgb(radiance)), Vec3::X * 2.0);
    assert!(loaded.warnings[0].ends_with("2 values of the image are not radiances and count as 0"));
}

#[test]
fn lights_are_grouped_by_name() {
    let scene = world(
        "Attribute \"light\" \"string lightgroup\" \"lamps\"\n\
         LightSource \"point\"\n\
         AttributeBegin AreaLightSource \"diffuse\" Shape \"sphere\" AttributeEnd\n\
         LightSource \"infinite\" \"string lightgroup\" \"sky-1\"\n\
         LightSource \"distant\" \"string lightgroup\" \"lamps\"",
    );
    assert_eq!(scene.group_names(), ["lamps", "sky-1"]);
    // Shapes come first.
    let groups: Vec<_> = (0..4).map(|light| scene.light_group(light)).collect();
    assert_eq!(groups, [0, 0, 1, 0]);
}

#[test]
fn any_number_of_lights_names_its_group_in_one_block() {
    let light = |i: usize| {
        format!("Attribute \"light\" \"string lightgroup\" \"g{i}\" LightSource \"point\"\n")
    };
    let lights: String = (0..100).map(light).collect();
    let scene = world(&lights);
    assert_eq!(scene.group_names().len(), 100);
    assert_eq!((scene.light_group(0), scene.light_group(99)), (0, 99));
    // The number of parameters with different names is limited.
    let odd = (0..65).fold(String::new(), |text, i| {
        text + &format!("\"float p{i}\" 1 ")
    });
    let text = format!("WorldBegin\nAttribute \"light\" {odd}");
    let error = crate::pbrt::parse_text("s.pbrt", &text).unwrap_err();
    assert_eq!((error.line(), error.kind()), (Some(2), ErrorKind::Limit));
}

#[test]
fn lights_without_a_group_are_grouped_by_kind() {
    let scene = world("LightSource \"distant\" LightSource \"point\" LightSource \"infinite\"");
    assert_eq!(scene.group_names(), ["environment", "default"]);
}

#[test]
fn lamps_without_triangles_are_no_lights() {
    let mesh = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 1 1 2 2 2] \"integer indices\" []";
    let lamp = format!("AttributeBegin AreaLightSource \"diffuse\" {mesh} AttributeEnd");
    let scene = load_text(&format!("WorldBegin {lamp}"), &STRICT).scene;
    assert!(scene.lights().is_empty());
}

#[test]
fn lamps_that_no_ray_hits_have_a_place() {
    let lights = "AttributeBegin AreaLightSource \"diffuse\" Shape \"sphere\" AttributeEnd\n\
                  LightSource \"infinite\"\n  LightSource \"spot\"\nLightSource \"distant\"\n\
                  LightSource \"point\"\nLightSource \"point\"";
    let loaded = load_text(&format!("WorldBegin {lights}"), &STRICT);
    let lamps: Vec<_> = loaded
        .lamps
        .iter()
        .map(|lamp| (&*lamp.place, lamp.light))
        .collect();
    assert_eq!(
        lamps,
        [("s.pbrt:3:15", 2), ("s.pbrt:4:13", 3), ("s.pbrt:5:13", 4)]
    );
}
