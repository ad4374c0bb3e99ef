//! The meaning of valid texts.

use crate::pbrt::{
    ColorSpace, ParameterType, SceneDescription, TextureKind, Values, parse_file, parse_text,
};
use flate2::{Compression, write::GzEncoder};
use glam::DVec3;
use std::io::Write;
use std::path::Path;

#[track_caller]
fn parse(text: &str) -> SceneDescription {
    parse_text("s.pbrt", text).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn world(text: &str) -> SceneDescription {
    parse(&format!("WorldBegin {text}"))
}

/// Returns the images of (1, 0, 0) under the transformations of the shapes.
fn places(scene: &SceneDescription) -> Vec<[f64; 3]> {
    let place = |p: DVec3| (p * 1e6).round() / 1e6 + 0.0;
    let shapes = scene.shapes.iter();
    shapes
        .map(|shape| place(shape.transforms.start.transform_point3(DVec3::X)).into())
        .collect()
}

#[test]
fn settings_are_kept_with_their_parameters() {
    let scene = parse(
        "Scale -1 1 1 LookAt 0 0 -5 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 45\n\
         ColorSpace \"REC2020\" Film \"rgb\" \"integer xresolution\" [ 640 ]\n\
         Sampler \"halton\" Sampler \"sobol\" Integrator \"bdpt\" PixelFilter \"box\" Accelerator \"bvh\"\n\
         Option \"disable-pixel_jitter\" true Option \"msereferenceimage\" \"a.exr\" WorldBegin",
    );
    let camera = scene.camera.unwrap();
    assert_eq!(
        camera.transforms.start.transform_point3(DVec3::X),
        DVec3::new(-1.0, 0.0, 5.0)
    );
    let fov = camera
        .entity
        .parameters
        .get(ParameterType::Float, "fov")
        .unwrap();
    assert_eq!(fov.values, Values::Floats(vec![45.0]));
    assert_eq!(scene.sources.line_and_column(fov.span), (1, 61));
    let film = scene.film.unwrap();
    assert_eq!(film.color_space, ColorSpace::Rec2020);
    let width = film
        .entity
        .parameters
        .get(ParameterType::Integer, "xresolution")
        .unwrap();
    assert_eq!(width.values, Values::Integers(vec![640]));
    assert_eq!(scene.sampler.unwrap().kind, "sobol");
    let options: Vec<_> = scene
        .options
        .iter()
        .map(|o| (o.name.as_str(), o.value.as_str()))
        .collect();
    assert_eq!(
        options,
        [
            ("disablepixeljitter", "true"),
            ("msereferenceimage", "a.exr")
        ]
    );
}

#[track_caller]
fn check_places(text: &str, expected: &[[f64; 3]]) {
    assert_eq!(places(&world(text)), expected);
}

#[test]
fn transformations_multiply_from_the_right_and_blocks_restore_them() {
    let shape = "Shape \"sphere\"";
    check_places(
        &format!("Translate 1 2 3 Scale 2 2 2 {shape}"),
        &[[3., 2., 3.]],
    );
    check_places(&format!("Rotate 90 0 0 1 {shape}"), &[[0., 1., 0.]]);
    check_places(
        &format!("AttributeBegin Scale 5 1 1 AttributeEnd {shape}"),
        &[[1., 0., 0.]],
    );
    check_places(
        &format!("TransformBegin Scale 5 1 1 {shape} TransformEnd"),
        &[[5., 0., 0.]],
    );
    check_places(
        &format!(
            "Scale 9 9 9 Transform [2 0 0 0 0 1 0 0 0 0 1 0 7 8 9 1] {shape} Identity {shape}"
        ),
        &[[9., 8., 9.], [1., 0., 0.]],
    );
    check_places(
        &format!("Scale 2 1 1 ConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 3 0 0 1] {shape}"),
        &[[8., 0., 0.]],
    );
    check_places(
        &format!("Translate 1 0 0 CoordinateSystem \"a\" Identity CoordSysTransform \"a\" {shape}"),
        &[[2., 0., 0.]],
    );
}

#[test]
fn world_begin_resets_the_transformation_but_names_the_camera() {
    let scene = parse(
        "Translate 0 0 5 Camera \"perspective\" WorldBegin Shape \"sphere\"\n\
         CoordSysTransform \"camera\" Shape \"sphere\" CoordSysTransform \"nowhere\"",
    );
    assert_eq!(places(&scene), [[1., 0., 0.], [1., 0., -5.]]);
    assert_eq!(
        scene.warnings[0].message,
        "unknown coordinate system `nowhere` is ignored"
    );
}

#[test]
fn active_transforms_move_one_end_of_the_interval() {
    let scene = parse(
        "TransformTimes 0 2 WorldBegin ActiveTransform EndTime Translate 4 0 0 Shape \"sphere\"\n\
         ActiveTransform All Translate 0 1 0 Shape \"sphere\"",
    );
    let [first, second] = [0, 1].map(|i| scene.shapes[i].transforms);
    assert!(first.is_animated());
    assert_eq!(first.times.map(f64::from).map(|t| t as i32), [0, 2]);
    assert_eq!(first.start.translation, DVec3::ZERO);
    assert_eq!(first.end.translation, DVec3::new(4.0, 0.0, 0.0));
    assert_eq!(second.start.translation, DVec3::Y);
    assert_eq!(second.end.translation, DVec3::new(4.0, 1.0, 0.0));
}

#[test]
fn shapes_have_the_current_state() {
    let scene = world(
        "Shape \"disk\" AttributeBegin ReverseOrientation NamedMaterial \"later\"\n\
         AreaLightSource \"diffuse\" \"float scale\" 2 MediumInterface \"fog\" \"\" Shape \"sphere\"\n\
         AreaLightSource \"\" Shape \"sphere\" AttributeEnd Shape \"disk\"\n\
         MakeNamedMaterial \"later\" \"string type\" \"diffuse\" Material \"conductor\" Shape \"disk\"",
    );
    let [first, lit, dark, restored, last] = [0, 1, 2, 3, 4].map(|i| &scene.shapes[i]);
    assert!(scene.materials[first.material].entity.is_none());
    assert_eq!(scene.materials[lit.material].name.as_deref(), Some("later"));
    assert_eq!(
        scene.materials[lit.material].entity.as_ref().unwrap().kind,
        "diffuse"
    );
    assert!(lit.reverse_orientation && !restored.reverse_orientation);
    assert!(lit.area_light.is_some() && dark.area_light.is_none() && first.area_light.is_none());
    assert_eq!(&*lit.medium.inside.as_ref().unwrap().name, "fog");
    assert!(lit.medium.outside.is_none());
    assert_eq!(restored.material, first.material);
    assert_eq!(
        scene.materials[last.material].entity.as_ref().unwrap().kind,
        "conductor"
    );
}

#[test]
fn objects_contain_shapes_and_instances_may_come_first() {
    let scene = world(
        "Translate 1 0 0 ObjectInstance \"o\" ObjectBegin \"o\" Scale 2 2 2 Shape \"sphere\" ObjectEnd\n\
         Shape \"disk\"",
    );
    assert_eq!(
        (
            scene.objects[0].name.as_str(),
            scene.objects[0].shapes.len()
        ),
        ("o", 1)
    );
    assert_eq!(scene.instances[0].object, 0);
    assert_eq!(scene.instances[0].transforms.start.translation, DVec3::X);
    assert_eq!(places(&scene), [[2., 0., 0.]]);
}

#[test]
fn the_last_parameter_counts_and_attributes_come_after_all_explicit_ones() {
    let scene = world(
        "Attribute \"shape\" \"float radius\" 1 Attribute \"shape\" \"float radius\" 2 \"float zmin\" 0\n\
         Shape \"sphere\" \"float radius\" 5 \"float radius\" 6 Shape \"sphere\"",
    );
    let value = |shape: usize, name: &str| {
        let parameters = &scene.shapes[shape].entity.parameters;
        parameters
            .get(ParameterType::Float, name)
            .map(|parameter| parameter.values.clone())
    };
    assert_eq!(value(0, "radius"), Some(Values::Floats(vec![6.0])));
    assert_eq!(value(0, "zmin"), Some(Values::Floats(vec![0.0])));
    assert_eq!(value(1, "radius"), Some(Values::Floats(vec![2.0])));
    assert_eq!(value(1, "zmax"), None);
}

#[test]
fn spectra_are_numbers_or_names_and_textures_have_two_name_spaces() {
    let scene = world(
        "Texture \"t\" \"float\" \"constant\" Texture \"t\" \"spectrum\" \"imagemap\"\n\
         Material \"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"spectrum k\" [400 1 700 2]",
    );
    assert_eq!(scene.textures[0].kind, TextureKind::Float);
    assert_eq!(scene.textures[1].kind, TextureKind::Spectrum);
    let parameters = &scene.materials[1].entity.as_ref().unwrap().parameters;
    let values = |name| {
        &parameters
            .get(ParameterType::Spectrum, name)
            .unwrap()
            .values
    };
    assert_eq!(*values("eta"), Values::Strings(vec!["metal-Cu-eta".into()]));
    assert_eq!(*values("k"), Values::Floats(vec![400.0, 1.0, 700.0, 2.0]));
}

#[test]
fn names_are_compared_in_normal_form() {
    let scene = world(
        "MakeNamedMaterial \"ü\" \"string type\" \"diffuse\" NamedMaterial \"u\u{308}\" Shape \"disk\"",
    );
    assert_eq!(scene.materials.len(), 2);
}

fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    folder
}

#[test]
fn includes_leak_state_and_imports_do_not() {
    let folder = folder(&[
        (
            "top.pbrt",
            "WorldBegin Include \"geometry/a.pbrt\" Shape \"disk\" Import \"i.pbrt\" Shape \"disk\"",
        ),
        (
            "geometry/a.pbrt",
            "Translate 1 0 0 Include \"geometry/b.pbrt\"",
        ),
        ("geometry/b.pbrt", "Translate 0 1 0"),
        (
            "i.pbrt",
            "Translate 0 0 1 Shape \"sphere\" Material \"conductor\"",
        ),
    ]);
    let scene = parse_file(&folder.path().join("top.pbrt")).unwrap();
    assert_eq!(places(&scene), [[2., 1., 0.], [2., 1., 1.], [2., 1., 0.]]);
    assert_eq!(scene.shapes[2].material, 0);
}

#[test]
fn errors_in_included_files_name_them_and_cycles_are_refused() {
    let folder = folder(&[
        ("top.pbrt", "WorldBegin Include \"a.pbrt\""),
        ("cycle.pbrt", "WorldBegin\nInclude \"cycle.pbrt\""),
        ("import.pbrt", "WorldBegin\nImport \"open.pbrt\""),
        ("a.pbrt", "\nShape \"spher\""),
        ("open.pbrt", "AttributeBegin"),
    ]);
    let message = |name: &str| {
        let error = parse_file(&folder.path().join(name))
            .unwrap_err()
            .to_string();
        error.replace(&format!("{}/", folder.path().display()), "")
    };
    assert_eq!(
        message("top.pbrt"),
        "a.pbrt:2:7: unknown shape `spher`; did you mean `sphere`?"
    );
    assert_eq!(
        message("cycle.pbrt"),
        "cycle.pbrt:2:9: `cycle.pbrt` includes itself"
    );
    let expected = "open.pbrt:1:1: `AttributeBegin` is never closed; `AttributeEnd` is missing";
    assert_eq!(message("import.pbrt"), expected);
    assert_eq!(
        message("none.pbrt"),
        "cannot open `none.pbrt`: no such file"
    );
}

#[test]
fn deep_includes_end() {
    let names: Vec<String> = (0..70).map(|i| format!("{i}.pbrt")).collect();
    let texts: Vec<String> = (0..70)
        .map(|i| format!("Include \"{}.pbrt\"", i + 1))
        .collect();
    let files: Vec<(&str, &str)> = names
        .iter()
        .map(String::as_str)
        .zip(texts.iter().map(String::as_str))
        .collect();
    let folder = folder(&files);
    let error = parse_file(&folder.path().join("0.pbrt")).unwrap_err();
    assert_eq!(error.message(), "files include files more than 64 deep");
}

#[test]
fn packed_and_wrongly_encoded_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.pbrt.gz");
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(b"WorldBegin Shape \"disk\"").unwrap();
    std::fs::write(&path, encoder.finish().unwrap()).unwrap();
    assert_eq!(parse_file(&path).unwrap().shapes.len(), 1);
    let message = |bytes: &[u8]| {
        let path = folder.path().join("s.pbrt");
        std::fs::write(&path, bytes).unwrap();
        let error = parse_file(&path).unwrap_err().to_string();
        error.replace(&format!("{}/", folder.path().display()), "")
    };
    assert_eq!(
        message(b"\xff\xfeW\0"),
        "s.pbrt: the text is UTF-16; save it as UTF-8"
    );
    assert_eq!(
        message(b"# \xb5\nA \xb5"),
        "s.pbrt:2:3: the text is not UTF-8; save it as UTF-8"
    );
}

/// Scenes made by others, in `pbrt-v4/` of the folder that `BIDIR_SCENES` names.
#[test]
fn real_scenes_are_parsed() {
    let Some(scenes) = std::env::var_os("BIDIR_SCENES") else {
        println!("skipped: BIDIR_SCENES is not set");
        return;
    };
    let scenes = Path::new(&scenes).join("pbrt-v4");
    for (name, shapes) in [
        ("veach-bidir/veach-bidir.pbrt", 14),
        ("veach-ajar/veach-ajar.pbrt", 22),
        ("veach-mis/veach-mis.pbrt", 9),
        ("cornell-box-w3ntao/cornell-box.pbrt", 8),
        ("coffee/coffee.pbrt", 23),
    ] {
        let path = scenes.join(name);
        let scene = parse_file(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.shapes.len(), shapes, "{name}");
    }
}
