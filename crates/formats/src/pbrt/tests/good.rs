//! The meaning of valid texts.

use crate::cases;
use crate::pbrt::scene::{Entity, MaterialDescription, MediumReference};
use crate::pbrt::transform::Transforms;
use crate::pbrt::{SceneDescription, parse_file, parse_text};
use bidir::shape::Orientation;
use expect_test::expect_file;
use flate2::{Compression, write::GzEncoder};
use glam::DVec3;
use std::collections::BTreeSet;
use std::io::Write;

#[test]
fn texts_and_their_meaning() {
    cases::check(&expect_file!["good.txt"], |text| {
        let scene = parse_text("s.pbrt", text).unwrap_or_else(|error| panic!("{error}"));
        meaning(&scene)
    });
}

fn meaning(scene: &SceneDescription) -> String {
    let mut lines = Vec::new();
    if let Some(camera) = &scene.camera {
        lines.push(format!(
            "camera {}{}",
            named(&camera.entity),
            place(&camera.transforms)
        ));
    }
    if let Some(film) = &scene.film {
        lines.push(format!(
            "film {}, {:?}",
            named(&film.entity),
            film.color_space
        ));
    }
    let settings = [
        &scene.sampler,
        &scene.integrator,
        &scene.filter,
        &scene.accelerator,
    ];
    lines.extend(settings.into_iter().flatten().map(named));
    for option in &scene.options {
        lines.push(format!("option {} = {}", option.name, option.value));
    }
    for texture in &scene.textures {
        lines.push(format!(
            "{:?} texture {}: {}",
            texture.kind,
            texture.name,
            named(&texture.entity)
        ));
    }
    let instances = scene.instances.iter();
    lines.extend(instances.map(|it| {
        format!(
            "instance of {}{}",
            scene.objects[it.object].name,
            place(&it.transforms)
        )
    }));
    let of_objects = scene.objects.iter().flat_map(|object| {
        object
            .shapes
            .iter()
            .map(|shape| (format!("{}: ", object.name), shape))
    });
    let shapes = scene.shapes.iter().map(|shape| (String::new(), shape));
    for (owner, shape) in of_objects.chain(shapes) {
        let material = material(&scene.materials[shape.material]);
        let side = |medium: &Option<MediumReference>| medium.as_ref().map(|it| it.name.to_string());
        let media = [side(&shape.medium.inside), side(&shape.medium.outside)];
        let reversed = match shape.orientation {
            Orientation::Natural => "",
            Orientation::Reversed => ", reversed",
        };
        let light = shape
            .area_light
            .as_ref()
            .map_or(String::new(), |light| format!(", emits: {}", named(light)));
        let media = if media == [None, None] {
            String::new()
        } else {
            format!(", {media:?}")
        };
        let (entity, place) = (named(&shape.entity), place(&shape.transforms));
        lines.push(format!(
            "{owner}{entity}{place}, {material}{reversed}{light}{media}"
        ));
    }
    lines.extend(scene.warnings.iter().map(|warning| warning.message.clone()));
    lines.join("\n")
}

fn material(material: &MaterialDescription) -> String {
    let name = material
        .name
        .as_ref()
        .map_or(String::new(), |name| format!("{name}: "));
    name + &material.entity.as_ref().map_or("default".into(), named)
}

/// Returns the type word of an entity, and its parameters as they count.
fn named(entity: &Entity) -> String {
    let list = &entity.parameters;
    let all = list.explicit.iter().chain(&*list.defaults);
    let names: BTreeSet<_> = all.map(|it| (it.kind.word(), it.name.clone())).collect();
    let found = names.iter().map(|(word, name)| {
        let mut all = list.explicit.iter().rev().chain(list.defaults.iter().rev());
        let kind = all
            .find(|it| it.kind.word() == *word && it.name == *name)
            .expect("it is there")
            .kind;
        let counts = list.get(kind, name).expect("it is there");
        format!(" {word} {name} {:?}", counts.values)
    });
    entity.kind.clone() + &found.collect::<String>()
}

/// Returns where a transformation takes (1, 0, 0), at both times if it moves.
fn place(transforms: &Transforms) -> String {
    let rounded = |p: DVec3| ((p * 1e6).round() / 1e6 + 0.0).to_string();
    let [start, end] =
        [transforms.start, transforms.end].map(|map| rounded(map.transform_point3(DVec3::X)));
    if transforms.is_animated() {
        format!(" from {start} to {end} within {:?}", transforms.times)
    } else {
        format!(" at {start}")
    }
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
    let expected =
        "disk at [2, 1, 0], default\nsphere at [2, 1, 1], default\ndisk at [2, 1, 0], default";
    assert_eq!(meaning(&scene), expected);
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
    for (name, expected) in [
        (
            "top.pbrt",
            "a.pbrt:2:7: unknown shape `spher`; did you mean `sphere`?",
        ),
        ("cycle.pbrt", "cycle.pbrt:2:9: `cycle.pbrt` includes itself"),
        (
            "import.pbrt",
            "open.pbrt:1:1: `AttributeBegin` is never closed; `AttributeEnd` is missing",
        ),
        ("none.pbrt", "cannot open `none.pbrt`: no such file"),
    ] {
        let error = parse_file(&folder.path().join(name))
            .unwrap_err()
            .to_string();
        assert_eq!(
            error.replace(&format!("{}/", folder.path().display()), ""),
            expected
        );
    }
}

#[test]
fn deep_includes_end() {
    let folder = tempfile::tempdir().unwrap();
    for i in 0..70 {
        let text = format!("Include \"{}.pbrt\"", i + 1);
        std::fs::write(folder.path().join(format!("{i}.pbrt")), text).unwrap();
    }
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
