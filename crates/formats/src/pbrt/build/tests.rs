use super::*;
use crate::pbrt::parse_text;
use bidir::integrator::IntegratorKind;
use bidir::light::Light;
use bidir::math::{Vec2, Vec3};
use bidir::sampler::SamplerKind;
use bidir::shape::{Orientation, Shape};
use bidir::spectrum::luminance;
use proptest::prelude::*;

const STRICT: LoadOptions = LoadOptions {
    lenient: false,
    resolution: None,
    crop: None,
    isa: None,
};
const LENIENT: LoadOptions = LoadOptions {
    lenient: true,
    ..STRICT
};

#[track_caller]
fn load_text(text: &str, options: &LoadOptions) -> Loaded {
    let description = parse_text("s.pbrt", text).unwrap_or_else(|error| panic!("{error}"));
    build(&description, options).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn world(text: &str) -> Scene {
    load_text(&format!("WorldBegin {text}"), &STRICT).scene
}

#[track_caller]
fn check(text: &str, expected: &str) {
    let description = parse_text("s.pbrt", text).unwrap_or_else(|error| panic!("{error}"));
    let error = build(&description, &STRICT).expect_err("the scene is wrong");
    assert_eq!(error.to_string(), expected);
}

#[track_caller]
fn check_world(text: &str, expected: &str) {
    check(&format!("WorldBegin\n{text}"), expected);
}

#[test]
fn wrong_parameters_are_told() {
    check(
        "Camera \"perspective\" \"float fvo\" 3 WorldBegin",
        "s.pbrt:1:22: unknown parameter `fvo` of `perspective`; did you mean `fov`?",
    );
    check(
        "Camera \"perspective\" \"integer fov\" 3 WorldBegin",
        "s.pbrt:1:22: `fov` is not of type `integer`; write `float fov`",
    );
    check(
        "Camera \"perspective\" \"float fov\" [3 4] WorldBegin",
        "s.pbrt:1:34: `fov` has one value, found 2",
    );
    check(
        "Camera \"perspective\" \"float fov\" 190 WorldBegin",
        "s.pbrt:1:34: `fov` is 190, but has to be between 0.001 and 179.999",
    );
    check(
        "Camera \"perspective\" \"float shutterclose\" 0 WorldBegin",
        "s.pbrt:1:8: the shutter closes before it opens",
    );
    check(
        "Film \"rgb\" \"integer xresolution\" -3 WorldBegin",
        "s.pbrt:1:34: `xresolution` is -3, but has to be at least 1",
    );
    check(
        "Film \"rgb\" \"integer xresolution\" 100000 WorldBegin",
        "s.pbrt:1:6: a film of 100000 × 720 pixels is empty or too large",
    );
    check(
        "Film \"rgb\" \"float cropwindow\" [0 1 0.5 0.5] WorldBegin",
        "s.pbrt:1:6: the crop leaves no pixels of the film",
    );
    check(
        "Film \"rgb\" \"integer pixelbounds\" [0 1 2] WorldBegin",
        "s.pbrt:1:34: `pixelbounds` is left, right, top and bottom of a part of the film",
    );
    check(
        "Scale 1 2 1 Camera \"perspective\" WorldBegin",
        "s.pbrt:1:20: the camera's screen is empty, or its transformation is sheared or uneven",
    );
    check(
        "Sampler \"sobol\" \"integer pixelsamples\" 0 WorldBegin",
        "s.pbrt:1:40: `pixelsamples` is 0, but has to be at least 1",
    );
}

#[test]
fn wrong_worlds_are_told() {
    check_world(
        "Material \"diffuse\" \"rgb reflectance\" [1 2 1]",
        "s.pbrt:2:38: the reflectance `reflectance` is above 1",
    );
    check_world(
        "Material \"diffuse\" \"rgb reflectance\" [0 -1 0]",
        "s.pbrt:2:38: the colour `reflectance` has a negative part",
    );
    check_world(
        "Texture \"wood\" \"spectrum\" \"constant\"\nMaterial \"diffuse\" \"texture reflectance\" \"wod\"",
        "s.pbrt:3:42: unknown spectrum texture `wod`; did you mean `wood`?",
    );
    check_world(
        "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"no.png\"",
        "s.pbrt:2:53: no.png: cannot open: no such file",
    );
    check_world(
        "Material \"conductor\" \"rgb reflectance\" [1 1 1] \"rgb k\" [1 1 1]",
        "s.pbrt:2:10: a conductor has `reflectance` or `eta` and `k`, not both",
    );
    check_world(
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 3]",
        "s.pbrt:2:71: index 3 is not that of a point: there are 3",
    );
    check_world(
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 1]",
        "s.pbrt:2:7: the mesh has 3 points, but 1 values of `N`",
    );
    check_world(
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0]",
        "s.pbrt:2:7: the parameter `integer indices` is missing",
    );
    check_world(
        "Shape \"plymesh\" \"string filename\" \"no.ply\"",
        "s.pbrt:2:35: no.ply: cannot open: no such file",
    );
    check_world(
        "LightSource \"distant\" \"point3 to\" [0 0 0]",
        "s.pbrt:2:13: `from` and `to` of the light are the same point",
    );
}

#[test]
fn what_is_not_built_is_refused_by_name() {
    check_world(
        "Material \"coateddiffuse\" Shape \"sphere\"",
        "s.pbrt:2:10: the material `coateddiffuse` is recognised but not supported yet; \
         with --lenient: `diffuse` of its reflectance stands in",
    );
    check_world(
        "Shape \"cylinder\"",
        "s.pbrt:2:7: the shape `cylinder` is recognised but not supported yet; \
         with --lenient: it is left out",
    );
    check_world(
        "Shape \"sphere\" \"float alpha\" 0.5",
        "s.pbrt:2:7: the parameter `float alpha` is recognised but not supported yet; \
         with --lenient: the shape is opaque",
    );
    check_world(
        "LightSource \"point\" \"blackbody I\" 5000",
        "s.pbrt:2:21: a blackbody spectrum is recognised but not supported yet; \
         with --lenient: white stands in",
    );
    check(
        "Integrator \"mlt\" \"integer chains\" 3 WorldBegin",
        "s.pbrt:1:12: the integrator `mlt` is recognised but not supported yet; \
         with --lenient: `bdpt` stands in",
    );
    check_world(
        "MediumInterface \"fog\" Shape \"sphere\"",
        "s.pbrt:2:17: a participating medium is recognised but not supported yet; \
         with --lenient: vacuum stands in",
    );
}

#[test]
fn with_leniency_something_stands_in_and_is_counted() {
    let loaded = load_text(
        "Integrator \"sppm\" WorldBegin\nMaterial \"coateddiffuse\" \"rgb reflectance\" [1 0 0]\n\
         Shape \"sphere\" Shape \"cylinder\" Shape \"cylinder\"\nMaterial \"interface\" Shape \"sphere\"",
        &LENIENT,
    );
    assert_eq!((loaded.summary.shapes, loaded.summary.materials), (1, 2));
    assert_eq!(
        loaded.warnings,
        [
            "s.pbrt:1:12: the integrator `sppm` is not supported yet: `bdpt` stands in",
            "s.pbrt:2:10: the material `coateddiffuse` is not supported yet: \
             `diffuse` of its reflectance stands in",
            "s.pbrt:4:10: the material `interface` is not supported yet: its shapes are left out",
            "s.pbrt:3:22: the shape `cylinder` is not supported yet: it is left out (2 times)",
        ]
    );
}

#[test]
fn settings_come_from_the_file_or_the_format() {
    let defaults = load_text("WorldBegin", &STRICT);
    assert_eq!(defaults.scene.film().resolution, [1280, 720]);
    assert_eq!(defaults.scene.film().filter.radius(), Vec2::splat(1.5));
    let expected = SceneSettings {
        integrator: IntegratorKind::Path,
        max_depth: 5,
        sampler: SamplerKind::Sobol,
        samples_per_pixel: 16,
        seed: None,
        output: None,
    };
    assert_eq!(defaults.settings, expected);
    let loaded = load_text(
        "Integrator \"bdpt\" \"integer maxdepth\" 7 Sampler \"independent\" \"integer seed\" 3\n\
         Film \"rgb\" \"string filename\" \"a.exr\" \"integer xresolution\" 40 \"integer yresolution\" 30\n\
         \"float iso\" 200 \"float cropwindow\" [0.5 1 0 0.25]\n\
         Camera \"perspective\" \"float shutterclose\" 3 WorldBegin",
        &STRICT,
    );
    let expected = SceneSettings {
        integrator: IntegratorKind::Bdpt,
        max_depth: 7,
        sampler: SamplerKind::Independent,
        samples_per_pixel: 4,
        seed: Some(3),
        output: Some("a.exr".into()),
    };
    assert_eq!(loaded.settings, expected);
    let film = loaded.scene.film();
    assert_eq!((film.crop.min, film.crop.max), ([20, 0], [40, 8]));
    assert!((film.exposure - 6.0).abs() < 1e-6);
}

#[test]
fn the_caller_may_choose_size_and_crop() {
    let text = "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 20\n\
        \"integer pixelbounds\" [10 20 0 10] WorldBegin";
    let options = LoadOptions {
        resolution: Some([80, 40]),
        ..STRICT
    };
    let film = load_text(text, &options).scene.film().clone();
    assert_eq!((film.crop.min, film.crop.max), ([20, 0], [40, 20]));
    let options = LoadOptions {
        crop: Some(Crop::Pixels([1, 3, 2, 900])),
        ..STRICT
    };
    let film = load_text(text, &options).scene.film().clone();
    assert_eq!((film.crop.min, film.crop.max), ([1, 2], [3, 20]));
}

#[test]
fn the_camera_looks_along_z_and_fov_spans_the_shorter_side() {
    let text = "LookAt 1 2 3 1 2 9 0 1 0 Camera \"perspective\" \"float fov\" 90\n\
        Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100 WorldBegin";
    let scene = load_text(text, &STRICT).scene;
    let toward = |x: f32, y: f32| {
        scene
            .camera()
            .sample_ray(Vec2::new(x, y), Vec2::splat(0.5))
            .direction
    };
    let near = |direction: Vec3, expected: Vec3| direction.distance(expected.normalize()) < 1e-5;
    assert!(near(toward(100.0, 50.0), Vec3::Z));
    // The top of the picture is up, its right is +x of the left-handed camera.
    assert!(near(toward(100.0, 0.0), Vec3::new(0.0, 1.0, 1.0)));
    assert!(near(toward(200.0, 50.0), Vec3::new(2.0, 0.0, 1.0)));
}

/// The normal at the first corner of the only mesh.
#[track_caller]
fn front(text: &str) -> Vec3 {
    let scene = world(text);
    scene.shapes()[0]
        .surface_point(0, Vec2::ZERO, Vec3::ZERO)
        .n_g
}

#[test]
fn the_front_follows_winding_mirrors_reversal_and_normals() {
    let triangle = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]";
    assert_eq!(front(triangle), Vec3::Z);
    assert_eq!(front(&format!("ReverseOrientation {triangle}")), -Vec3::Z);
    // Mirrored in x, the triangle is seen from the same side as before.
    assert_eq!(front(&format!("Scale -1 1 1 {triangle}")), Vec3::Z);
    assert_eq!(front(&format!("Scale 1 1 -1 {triangle}")), -Vec3::Z);
    let normals = "\"normal N\" [0 0 -1 0 0 -1 0 0 -1]";
    assert_eq!(front(&format!("{triangle} {normals}")), -Vec3::Z);
    assert_eq!(
        front(&format!("ReverseOrientation {triangle} {normals}")),
        Vec3::Z
    );
    assert_eq!(
        front(&format!("Scale -1 1 1 {triangle} {normals}")),
        -Vec3::Z
    );
}

#[test]
fn instances_are_copies_at_their_places() {
    let scene = world(
        "ObjectBegin \"o\" Translate 0 1 0 Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] ObjectEnd\n\
         ObjectBegin \"unused\" Shape \"sphere\" ObjectEnd\n\
         ObjectInstance \"o\" Scale 2 2 2 ObjectInstance \"o\"",
    );
    let corners: Vec<Vec3> = scene
        .shapes()
        .iter()
        .map(|shape| match shape {
            Shape::Mesh(mesh) => mesh.positions[1],
            _ => panic!("only meshes are placed"),
        })
        .collect();
    assert_eq!(
        corners,
        [Vec3::new(1.0, 1.0, 0.0), Vec3::new(2.0, 2.0, 0.0)]
    );
}

#[test]
fn power_goes_to_every_triangle_of_a_mesh() {
    let scene = world(
        "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"float power\" 3\n\
         Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 9 0] \"integer indices\" [0 1 2 0 2 3]",
    );
    assert_eq!(scene.lights().len(), 2);
    for light in scene.lights() {
        assert!((light.power(&scene.light_context()) - 3.0).abs() < 1e-4);
    }
    let Shape::Mesh(mesh) = &scene.shapes()[1] else {
        panic!("a mesh stays a mesh")
    };
    assert_eq!(
        (mesh.positions.len(), mesh.orientation),
        (3, Orientation::Natural)
    );
}

#[test]
fn lights_stand_where_they_are_put() {
    let scene = world(
        "Translate 1 0 0 LightSource \"point\" \"rgb I\" [1 2 3] \"float scale\" 2 \"point3 from\" [0 1 0]\n\
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
        (point.position, point.intensity),
        (Vec3::new(1.0, 1.0, 0.0), [2.0, 4.0, 6.0])
    );
    assert!((spot.power(&scene.light_context()) - 10.0).abs() < 1e-3);
    assert_eq!((distant.to_light, distant.irradiance), (Vec3::Y, [4.0; 3]));
    let at = bidir::light::LightPoint::at_infinity(Vec3::Z);
    let radiance = luminance(infinite.emitted(&at, -Vec3::Z));
    assert!((radiance * std::f32::consts::PI - 2.0).abs() < 1e-5);
}

/// A folder with a scene and an image of two rows: red above, green below.
fn textured(parameters: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("t.png");
    crate::image::write_png(&image, [1, 2], &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
    let text = format!(
        "WorldBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.png\"\n\
         \"string filter\" \"point\" {parameters}\n\
         Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\""
    );
    let path = folder.path().join("s.pbrt");
    std::fs::write(&path, text).unwrap();
    load(&path, &STRICT)
        .unwrap_or_else(|error| panic!("{error}"))
        .scene
}

#[track_caller]
fn check_texture(parameters: &str, uv: Vec2, expected: [f32; 3]) {
    let scene = textured(parameters);
    let bidir::material::Material::Diffuse { reflectance } = &scene.materials()[1] else {
        panic!("the material is diffuse");
    };
    assert_eq!(Vec3::from(reflectance.eval(uv)), Vec3::from(expected));
}

#[test]
fn images_stand_upright_and_are_scaled_before_they_are_inverted() {
    let (low, high) = (Vec2::new(0.5, 0.25), Vec2::new(0.5, 0.75));
    check_texture("", high, [1.0, 0.0, 0.0]);
    check_texture("", low, [0.0, 1.0, 0.0]);
    check_texture(
        "\"float scale\" 0.25 \"bool invert\" true",
        high,
        [0.75, 1.0, 1.0],
    );
    check_texture("\"float vdelta\" 0.5", low, [1.0, 0.0, 0.0]);
    check_texture("\"string wrap\" \"black\"", high + Vec2::Y, [0.0; 3]);
    check_texture("\"string wrap\" \"clamp\"", high + Vec2::Y, [1.0, 0.0, 0.0]);
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
        std::fs::write(&path, text).unwrap();
        load(&path, &STRICT)
    };
    let error = load("wide.exr").unwrap_err();
    assert_eq!(
        error.message(),
        "an environment is a square image, this one has 2 × 1 pixels"
    );
    let loaded = load("square.exr").unwrap();
    let at = bidir::light::LightPoint::at_infinity(Vec3::X);
    let radiance = Vec3::from(loaded.scene.lights()[0].emitted(&at, -Vec3::X));
    assert_eq!(radiance, Vec3::new(2.0, 0.0, 0.0));
    assert!(loaded.warnings[0].ends_with("2 numbers of the image are no radiance and taken as 0"));
}

#[test]
fn a_material_that_nobody_uses_is_no_reason_to_refuse() {
    let scene = world("Material \"hair\" Material \"diffuse\" Shape \"sphere\"");
    assert_eq!(scene.materials().len(), 2);
}

/// Pieces of scenes; `#` stands for a number.
const PIECES: &[&str] = &[
    "Material \"diffuse\" \"rgb reflectance\" [# # #]",
    "Material \"conductor\" \"float roughness\" # \"rgb eta\" [# # #]",
    "Material \"dielectric\" \"float eta\" # \"float uroughness\" #",
    "Shape \"sphere\" \"float radius\" #",
    "Shape \"sphere\" \"float zmin\" # \"float zmax\" # \"float phimax\" #",
    "Shape \"disk\" \"float radius\" # \"float innerradius\" # \"float height\" #",
    "Shape \"trianglemesh\" \"point3 P\" [# # # # # # # # #]",
    "Shape \"trianglemesh\" \"point3 P\" [# # # # # # # # #] \"normal N\" [# # # # # # # # #]",
    "AreaLightSource \"diffuse\" \"rgb L\" [# # #] \"float scale\" #",
    "AreaLightSource \"diffuse\" \"float power\" # \"bool twosided\" true",
    "LightSource \"point\" \"rgb I\" [# # #] \"float power\" # \"point3 from\" [# # #]",
    "LightSource \"spot\" \"float coneangle\" # \"float conedeltaangle\" # \"float power\" #",
    "LightSource \"distant\" \"point3 from\" [# # #] \"float scale\" #",
    "LightSource \"infinite\" \"rgb L\" [# # #] \"float illuminance\" #",
    "Translate # # #",
    "Scale # # #",
    "Rotate # # # #",
    "ObjectBegin \"o\" Shape \"sphere\" ObjectEnd ObjectInstance \"o\"",
];

const NUMBERS: &[&str] = &[
    "0", "1", "-1", "0.5", "3", "1e-38", "1e-44", "1e20", "3e38", "-3e38", "90",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn scenes_of_any_numbers_never_panic(
        pieces in proptest::collection::vec(proptest::sample::select(PIECES), 0..8),
        numbers in proptest::collection::vec(proptest::sample::select(NUMBERS), 64),
        ordinary in 0usize..64,
    ) {
        let mut text = String::from("WorldBegin\n");
        let mut numbers = numbers.into_iter().enumerate().cycle();
        for piece in pieces.join("\n").split('#') {
            let (i, number) = numbers.next().unwrap();
            text.push_str(piece);
            text.push_str(if i < ordinary { "1" } else { number });
        }
        if let Ok(description) = parse_text("s", &text) {
            let _ = build(&description, &LENIENT).map_err(|error| error.to_string());
        }
    }
}

/// Scenes made by others, in `pbrt-v4/` of the folder that `BIDIR_SCENES` names.
#[test]
fn real_scenes_are_built() {
    let Some(scenes) = std::env::var_os("BIDIR_SCENES") else {
        println!("skipped: BIDIR_SCENES is not set");
        return;
    };
    let scenes = Path::new(&scenes).join("pbrt-v4");
    for (name, options) in [
        ("veach-bidir/veach-bidir.pbrt", STRICT),
        ("veach-ajar/veach-ajar.pbrt", STRICT),
        ("veach-mis/veach-mis.pbrt", STRICT),
        ("cornell-box-w3ntao/cornell-box.pbrt", STRICT),
        ("cornell-box-w3ntao/smallpt.pbrt", STRICT),
        ("coffee/coffee.pbrt", LENIENT),
        ("living-room/living-room.pbrt", LENIENT),
    ] {
        let path = scenes.join(name);
        let loaded = load(&path, &options).unwrap_or_else(|error| panic!("{error}"));
        println!(
            "{name}: {:?}\n{}",
            loaded.summary,
            loaded.warnings.join("\n")
        );
        assert!(
            loaded.summary.primitives > 10 && !loaded.scene.lights().is_empty(),
            "{name}"
        );
    }
}
