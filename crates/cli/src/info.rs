//! `bidir info`: the contents of a scene.

use crate::args::{InfoArgs, SceneArgs};
use crate::console::{Console, print, print_json};
use crate::exit::{Exit, Failure};
use crate::scene_io::{self, LoadedScene};
use bidir::analysis::{BlindSpot, blind_spots};
use bidir::film::{Film, Layers};
use bidir::integrator::IntegratorKind;
use bidir::light::Light;
use bidir::material::Material;
use bidir::medium::Medium;
use bidir::scene::Scene;
use bidir::shape::Shape;
use bidir::view::View;
use formats::film::SettingsText;
use formats::{number, printable};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::{Display, Write};

/// The number of items of each kind.
type Counts = BTreeMap<&'static str, usize>;

/// The contents of a scene.
#[derive(Debug, Serialize)]
struct Info {
    scene: String,
    film: FilmInfo,
    camera: &'static str,
    settings: SettingsText,
    spp: u64,
    shapes: Counts,
    triangles: usize,
    /// Primitives; those of shared objects count once.
    primitives: u64,
    /// Primitives; those of shared objects count once per instance.
    placed_primitives: u64,
    instances: usize,
    /// Instances whose object is shared.
    shared_instances: usize,
    materials: Counts,
    /// Participating media, without the vacuum.
    media: Counts,
    lights: Counts,
    /// The number of lights in each group.
    light_groups: BTreeMap<String, usize>,
    textures: usize,
    /// The two corners of a box around all surfaces. None: the scene has none.
    bounds: Option<[[f32; 3]; 2]>,
    bvh_bytes: usize,
    isa: String,
    /// The light paths that integrators miss or sample badly, by integrator.
    blind_spots: BTreeMap<&'static str, Vec<BlindSpotInfo>>,
    /// Unsupported features, and their replacements with `--lenient`.
    refused: Vec<String>,
    warnings: Vec<String>,
}

/// Light paths that an integrator misses or samples badly.
#[derive(Debug, PartialEq, Serialize)]
struct BlindSpotInfo {
    /// True if the paths are missing from images; false if they are only noisy.
    missing: bool,
    paths: &'static str,
}

#[derive(Debug, Serialize)]
struct FilmInfo {
    resolution: [u32; 2],
    /// Left, top, right and bottom (exclusive).
    crop: [u32; 4],
    /// Half widths of the pixel filter.
    filter_radius: [f32; 2],
    exposure: f32,
    /// The name that the scene gives its image.
    output: Option<String>,
    bytes: u64,
}

/// Prints the contents of a scene.
pub(crate) fn run(args: &InfoArgs, console: Console) -> Result<Exit, Failure> {
    // List everything that a render would refuse, instead of failing at the first.
    let scene = SceneArgs {
        lenient: true,
        ..args.scene.clone()
    };
    let loaded = scene_io::load(&scene, None)?;
    let info = Info::new(args.scene.scene.display().to_string(), &loaded);
    if args.json {
        loaded.check_strict(&args.scene, 0)?;
        return print_json(&info);
    }
    // The text has the refused features, and stderr all other warnings.
    let is_other = |warning: &&String| !info.refused.contains(warning);
    for warning in info.warnings.iter().filter(is_other) {
        console.warning(warning);
    }
    loaded.check_strict(&args.scene, 0)?;
    print(&info.text())
}

impl Info {
    fn new(name: String, loaded: &LoadedScene) -> Self {
        let scene = &loaded.subject.scene;
        let bounds = scene.bvh().bounds();
        let corners = [bounds.min, bounds.max];
        let corners = corners.map(|p| scene.space().world_point(p).as_vec3().to_array());
        let triangles = scene.shapes().iter().map(|shape| match shape {
            Shape::Mesh(mesh) => mesh.triangle_count(),
            _ => 0,
        });
        Self {
            scene: name,
            film: FilmInfo::new(&loaded.subject.view, loaded.output.as_deref()),
            camera: loaded.subject.view.camera().kind(),
            settings: SettingsText::from(&loaded.settings),
            spp: loaded.spp,
            shapes: count(scene.shapes(), Shape::kind),
            triangles: triangles.sum(),
            primitives: scene.unique_primitives(),
            placed_primitives: scene.placed_primitives(),
            instances: loaded.summary.instances,
            shared_instances: scene.instance_count(),
            materials: count(scene.materials(), Material::kind),
            media: count(scene.media(), Medium::kind),
            lights: count(scene.lights(), Light::kind),
            light_groups: light_groups(scene),
            textures: loaded.summary.textures,
            bounds: (scene.placed_primitives() > 0).then_some(corners),
            bvh_bytes: scene.bvh().memory_bytes(),
            isa: scene.bvh().isa().to_string(),
            blind_spots: IntegratorKind::NAMES
                .map(|(name, integrator)| (name, blind_spots_of(loaded, integrator)))
                .into(),
            refused: loaded.refused.clone(),
            warnings: loaded.warnings.clone(),
        }
    }

    /// Returns one line per property.
    fn text(&self) -> String {
        let mut text = String::new();
        for (name, value) in self.lines() {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name:<12} {}", printable(&value));
        }
        self.write_blind_spots(&mut text);
        for refused in &self.refused {
            let _ = writeln!(text, "refused      {}", printable(refused));
        }
        text
    }

    /// Returns the properties with their names.
    fn lines(&self) -> [(&'static str, String); 17] {
        let film = &self.film;
        let ([width, height], [x0, y0, x1, y1]) = (film.resolution, film.crop);
        let settings = self.settings.by_flag();
        let depth = match &*settings["max-depth"] {
            "0" => "no limit".to_owned(),
            depth => format!("at most {depth} bounces"),
        };
        [
            ("scene", self.scene.clone()),
            (
                "film",
                format!("{width}x{height}, pixels {x0},{y0} to {x1},{y1}"),
            ),
            (
                "output",
                film.output.clone().unwrap_or_else(|| "not named".into()),
            ),
            ("camera", self.camera.to_owned()),
            ("integrator", format!("{}, {depth}", settings["integrator"])),
            (
                "sampler",
                format!(
                    "{}, {} spp, seed {}",
                    settings["sampler"], self.spp, settings["seed"]
                ),
            ),
            ("shapes", list(&self.shapes)),
            ("triangles", self.triangles.to_string()),
            ("instances", self.instances_text()),
            ("materials", list(&self.materials)),
            ("media", list(&self.media)),
            ("lights", list(&self.lights)),
            ("light groups", self.groups_text()),
            ("textures", self.textures.to_string()),
            ("bounds", self.bounds_text()),
            ("film memory", bytes(film.bytes)),
            (
                "BVH memory",
                format!("{} ({})", bytes(self.bvh_bytes as u64), self.isa),
            ),
        ]
    }

    /// Writes a line for each blind spot, those of the scene's integrator first. Integrators with the same blind
    /// spots share their lines.
    fn write_blind_spots(&self, text: &mut String) {
        let integrator = self.settings.request.integrator.map(IntegratorKind::name);
        let mut integrators: Vec<_> = self.blind_spots.iter().collect();
        integrators.sort_by_key(|(name, _)| Some(**name) != integrator);
        let mut groups: Vec<(Vec<&str>, &[BlindSpotInfo])> = Vec::new();
        for (name, spots) in integrators {
            match groups.iter_mut().find(|(_, known)| known == spots) {
                Some((names, _)) => names.push(*name),
                None => groups.push((vec![*name], spots.as_slice())),
            }
        }
        for (names, spots) in groups {
            let name = names.join(", ");
            let [find, miss, undersample] = match names.len() {
                1 => ["finds", "misses", "is noisy for"],
                _ => ["find", "miss", "are noisy for"],
            };
            if spots.is_empty() {
                let _ = writeln!(text, "{name:<12} {find} all light paths");
            }
            for spot in spots {
                let how = if spot.missing { miss } else { undersample };
                let _ = writeln!(text, "{name:<12} {how} {}", spot.paths);
            }
        }
    }

    /// Returns the light groups with their numbers of lights, such as `2: desk (1 light), default (3 lights)`.
    fn groups_text(&self) -> String {
        let lights = |count| if count == 1 { "light" } else { "lights" };
        let groups = self.light_groups.iter();
        let groups = groups.map(|(name, &count)| format!("{name} ({count} {})", lights(count)));
        let groups: Vec<_> = groups.collect();
        match groups.len() {
            0 => "none".to_owned(),
            count => format!("{count}: {}", groups.join(", ")),
        }
    }

    fn instances_text(&self) -> String {
        match self.shared_instances {
            0 => self.instances.to_string(),
            shared => format!(
                "{}, {shared} of shared objects: {} primitives kept, {} placed",
                self.instances, self.primitives, self.placed_primitives
            ),
        }
    }

    fn bounds_text(&self) -> String {
        self.bounds.map_or_else(
            || "no surfaces".into(),
            |corners| {
                let corner = |corner: [f32; 3]| corner.map(number).join(", ");
                let [low, high] = corners.map(corner);
                format!("({low}) to ({high})")
            },
        )
    }
}

impl FilmInfo {
    fn new(view: &View, output: Option<&std::path::Path>) -> Self {
        let film = view.film();
        Self {
            resolution: film.resolution,
            crop: [
                film.crop.min[0],
                film.crop.min[1],
                film.crop.max[0],
                film.crop.max[1],
            ],
            filter_radius: film.filter.radius().to_array(),
            exposure: film.exposure,
            output: output.map(|output| output.display().to_string()),
            bytes: Film::memory(film, &Layers::default()),
        }
    }
}

fn blind_spots_of(loaded: &LoadedScene, integrator: IntegratorKind) -> Vec<BlindSpotInfo> {
    let spots = blind_spots(&loaded.subject.scene, &loaded.subject.view, integrator).into_iter();
    let info = |spot: BlindSpot| BlindSpotInfo {
        missing: spot.is_missing(),
        paths: spot.description(),
    };
    spots.map(info).collect()
}

fn light_groups(scene: &Scene) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for light in 0..scene.lights().len() as u32 {
        let name = &scene.group_names()[scene.light_group(light) as usize];
        *counts.entry(name.clone()).or_default() += 1;
    }
    counts
}

fn count<T>(items: &[T], kind: impl Fn(&T) -> &'static str) -> Counts {
    let mut counts = Counts::new();
    for item in items {
        *counts.entry(kind(item)).or_default() += 1;
    }
    counts
}

/// Returns counts as text, such as `3: 2 disk, 1 mesh`.
fn list<K: Display>(counts: &BTreeMap<K, usize>) -> String {
    let kinds: Vec<_> = counts
        .iter()
        .map(|(kind, count)| format!("{count} {kind}"))
        .collect();
    match counts.values().sum::<usize>() {
        0 => "none".to_owned(),
        total => format!("{total}: {}", kinds.join(", ")),
    }
}

fn bytes(count: u64) -> String {
    let units = [(1u64 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB")];
    match units.into_iter().find(|(unit, _)| count >= *unit) {
        Some((unit, name)) => format!("{:.1} {name}", count as f64 / unit as f64),
        None => format!("{count} bytes"),
    }
}
