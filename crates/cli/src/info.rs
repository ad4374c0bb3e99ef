//! `bidir info`: the contents of a scene.

use crate::args::{InfoArgs, SceneArgs};
use crate::console::{Console, print, print_json};
use crate::exit::{Exit, Failure};
use crate::scene_io::{self, Loaded};
use bidir::analysis::blind_spots;
use bidir::film::{Film, Layers};
use bidir::integrator::IntegratorKind;
use bidir::light::Light;
use bidir::material::Material;
use bidir::medium::Medium;
use bidir::scene::Scene;
use bidir::shape::Shape;
use formats::film::SettingsText;
use formats::{number, printable};
use indicatif::BinaryBytes;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Prints the contents of a scene.
pub(crate) fn run(args: &InfoArgs, console: Console) -> Result<Exit, Failure> {
    // List everything that a render would refuse, instead of failing at the first.
    let scene = SceneArgs {
        lenient: true,
        ..args.scene.clone()
    };
    let loaded = scene_io::load(&scene, None)?;
    let info = contents(&loaded);
    if args.json {
        scene_io::check_strict(&args.scene, loaded.warnings.len())?;
        return print_json(&info);
    }
    // The text has the refused features, and stderr all other warnings.
    let is_other = |warning: &&String| !loaded.refused.contains(warning);
    for warning in loaded.warnings.iter().filter(is_other) {
        console.warning(warning);
    }
    scene_io::check_strict(&args.scene, loaded.warnings.len())?;
    let pairs = lines(&info, &loaded).into_iter();
    let lines = pairs.map(|(name, value)| format!("{name:<12} {}\n", printable(&value)));
    print(&lines.collect::<String>())
}

/// Returns the contents of a scene as JSON.
fn contents(loaded: &Loaded) -> Value {
    let (scene, view) = (&loaded.scene, &loaded.view);
    let (film, bvh) = (view.film(), scene.bvh());
    let ([left, top], [right, bottom]) = (film.crop.min, film.crop.max);
    let triangles = scene.shapes().iter().map(|shape| match shape {
        Shape::Mesh(mesh) => mesh.triangle_count(),
        _ => 0,
    });
    let blind_spots = IntegratorKind::NAMES.map(|(name, integrator)| {
        let found = blind_spots(scene, view, integrator).into_iter();
        // Paths that are not missing are only noisy.
        let spots =
            found.map(|spot| json!({"missing": spot.is_missing(), "paths": spot.description()}));
        (name, spots.collect::<Vec<_>>())
    });
    json!({
        "scene": loaded.name,
        "film": {
            "resolution": film.resolution,
            "crop": [left, top, right, bottom],
            "filter_radius": film.filter.radius().to_array().map(short),
            "exposure": short(film.exposure),
            "output": loaded.settings.output,
            "bytes": Film::memory(film, &Layers::default()),
        },
        "camera": view.camera().kind(),
        "settings": SettingsText::from(&loaded.settings.render_settings()),
        "spp": loaded.settings.samples_per_pixel,
        "shapes": count(scene.shapes().iter().map(Shape::kind)),
        "triangles": triangles.sum::<usize>(),
        // A shared object counts once here, and once per instance below.
        "primitives": scene.unique_primitives(),
        "placed_primitives": scene.placed_primitives(),
        "instances": loaded.summary.instances,
        "shared_instances": scene.instance_count(),
        "materials": count(scene.materials().iter().map(Material::kind)),
        "media": count(scene.media().iter().map(Medium::kind)),
        "lights": count(scene.lights().iter().map(Light::kind)),
        "light_groups": count((0..scene.lights().len() as u32).map(|light| {
            &*scene.group_names()[scene.light_group(light) as usize]
        })),
        "textures": loaded.summary.textures,
        "bounds": bounds(scene).map(|corners| corners.map(|corner| corner.map(short))),
        "bvh_bytes": bvh.memory_bytes(),
        "isa": bvh.isa().to_string(),
        "blind_spots": BTreeMap::from(blind_spots),
        "refused": loaded.refused,
        "warnings": loaded.warnings,
    })
}

/// Returns a JSON number with the shortest digits of the 32-bit number, not of its 64-bit value.
fn short(number: f32) -> Value {
    serde_json::from_str(&format!("{number:?}")).unwrap_or_default()
}

/// Returns the lowest and highest corner of a box around all surfaces. None: the scene has no surface.
fn bounds(scene: &Scene) -> Option<[[f32; 3]; 2]> {
    let bounds = scene.bvh().bounds();
    let ends = [bounds.min, bounds.max];
    let corners = ends.map(|p| scene.space().world_point(p).as_vec3().to_array());
    (scene.placed_primitives() > 0).then_some(corners)
}

/// Returns the number of occurrences of each name.
fn count<'a>(names: impl Iterator<Item = &'a str>) -> BTreeMap<&'a str, usize> {
    let mut counts = BTreeMap::new();
    for name in names {
        *counts.entry(name).or_default() += 1;
    }
    counts
}

/// Returns the contents of a scene as lines of name and text.
fn lines(info: &Value, loaded: &Loaded) -> Vec<(String, String)> {
    let properties = properties(info, loaded).map(|(name, text)| (name.to_owned(), text));
    let listed = info["blind_spots"].as_object();
    let spots =
        listed.map(|spots| blind_spot_lines(spots, loaded.settings.render_settings().integrator));
    let features = loaded.refused.iter();
    let refused = features.map(|text| ("refused".to_owned(), text.clone()));
    let lines = properties.into_iter().chain(spots.unwrap_or_default());
    lines.chain(refused).collect()
}

fn properties(info: &Value, loaded: &Loaded) -> [(&'static str, String); 17] {
    let memory = |bytes: &Value| BinaryBytes(bytes.as_u64().unwrap_or_default()).to_string();
    let text = |key: &str| match &info[key] {
        Value::String(text) => text.clone(),
        Value::Object(counts) => list(counts),
        number => number.to_string(),
    };
    let [integrator, sampler] = settings(loaded);
    let output = info["film"]["output"].as_str().unwrap_or("not named");
    let bvh = format!("{} ({})", memory(&info["bvh_bytes"]), text("isa"));
    [
        ("scene", text("scene")),
        ("film", film(loaded)),
        ("output", output.to_owned()),
        ("camera", text("camera")),
        ("integrator", integrator),
        ("sampler", sampler),
        ("shapes", text("shapes")),
        ("triangles", text("triangles")),
        ("instances", instances(&loaded.scene, text("instances"))),
        ("materials", text("materials")),
        ("media", text("media")),
        ("lights", text("lights")),
        ("light groups", groups(&info["light_groups"])),
        ("textures", text("textures")),
        ("bounds", extent(&loaded.scene)),
        ("film memory", memory(&info["film"]["bytes"])),
        ("BVH memory", bvh),
    ]
}

fn film(loaded: &Loaded) -> String {
    let film = loaded.view.film();
    let ([width, height], [x0, y0], [x1, y1]) = (film.resolution, film.crop.min, film.crop.max);
    format!("{width}x{height}, pixels {x0},{y0} to {x1},{y1}")
}

/// Returns the lines of integrator and sampler.
fn settings(loaded: &Loaded) -> [String; 2] {
    let settings = SettingsText::from(&loaded.settings.render_settings()).by_flag();
    let depth = match &*settings["max-depth"] {
        "0" => "no limit".to_owned(),
        depth => format!("at most {depth} bounces"),
    };
    let (sampler, seed) = (&settings["sampler"], &settings["seed"]);
    let sampler = format!(
        "{sampler}, {} spp, seed {seed}",
        loaded.settings.samples_per_pixel
    );
    [format!("{}, {depth}", settings["integrator"]), sampler]
}

/// Returns the number of groups, and each with its number of lights.
fn groups(counts: &Value) -> String {
    let pairs = counts.as_object().into_iter().flatten();
    let groups = pairs.map(|(name, count)| {
        let lights = if *count == 1 { "light" } else { "lights" };
        format!("{name} ({count} {lights})")
    });
    let texts: Vec<_> = groups.collect();
    match texts.len() {
        0 => "none".to_owned(),
        count => format!("{count}: {}", texts.join(", ")),
    }
}

fn extent(scene: &Scene) -> String {
    let corner = |corner: [f32; 3]| corner.map(number).join(", ");
    match bounds(scene).map(|corners| corners.map(corner)) {
        Some([low, high]) => format!("({low}) to ({high})"),
        None => "no surfaces".to_owned(),
    }
}

/// Returns a line for each blind spot, with the scene's integrator first. Integrators with the same blind spots share
/// lines.
fn blind_spot_lines(spots: &Map<String, Value>, own: IntegratorKind) -> Vec<(String, String)> {
    let mut integrators: Vec<_> = spots.iter().collect();
    integrators.sort_by_key(|(name, _)| **name != own.name());
    let mut groups: Vec<(Vec<&str>, &Value)> = Vec::new();
    for (name, spots) in integrators {
        match groups.iter_mut().find(|(_, known)| *known == spots) {
            Some((names, _)) => names.push(name),
            None => groups.push((vec![name], spots)),
        }
    }
    let lines = groups.into_iter().flat_map(|(names, spots)| {
        let [find, miss, undersample] = match names.len() {
            1 => ["finds", "misses", "is noisy for"],
            _ => ["find", "miss", "are noisy for"],
        };
        let spots = spots.as_array().into_iter().flatten().map(|spot| {
            let how = if spot["missing"] == true {
                miss
            } else {
                undersample
            };
            format!("{how} {}", spot["paths"].as_str().unwrap_or_default())
        });
        let mut texts: Vec<_> = spots.collect();
        if texts.is_empty() {
            texts.push(format!("{find} all light paths"));
        }
        texts.into_iter().map(move |text| (names.join(", "), text))
    });
    lines.collect()
}

fn instances(scene: &Scene, all: String) -> String {
    match scene.instance_count() {
        0 => all,
        shared => format!(
            "{all}, {shared} of shared objects: {} primitives kept, {} placed",
            scene.unique_primitives(),
            scene.placed_primitives()
        ),
    }
}

/// Returns counts as text, such as `3: 2 disk, 1 mesh`.
fn list(counts: &Map<String, Value>) -> String {
    let texts: Vec<_> = counts
        .iter()
        .map(|(kind, count)| format!("{count} {kind}"))
        .collect();
    match counts.values().filter_map(Value::as_u64).sum::<u64>() {
        0 => "none".to_owned(),
        total => format!("{total}: {}", texts.join(", ")),
    }
}
