//! What is rendered: the three experiments, small and large.

use super::room::{Lamp, Room};
use super::{Effort, Result, setting};
use crate::experiment::{
    BudgetSpec, Experiment, ExperimentError, MethodSpec, PyramidSpec, ReferenceSpec, SceneSpec,
    Seeds,
};
use crate::metric::Metric;
use crate::results::{BudgetKind, Results};
use crate::scenes;
use bidir::settings::Request;
use std::path::{Path, PathBuf};

/// Weights that need no densities.
pub(super) const UNIFORM: &str = "uniform";
/// The names of all weights.
pub(super) const WEIGHTS: [&str; 3] = [UNIFORM, "balance", "power"];
/// What was there before, and the optimisations 1, 2 and 3 of the paper.
pub(super) const RULES: [&str; 4] = ["all", "per-light-vertex", "per-camera-vertex", "per-pair"];
/// Rules that the paper does not have.
pub(super) const BEYOND: [&str; 5] = [
    "ray-roulette:0.1",
    "budget:1",
    "budget:2",
    "budget:3",
    "budget:4",
];
/// The scenes of the paper, and ours for them.
pub(super) const ROOMS: [(&str, &str); 2] = [("A", "room-direct"), ("B", "room-indirect")];
/// Rooms each with lighting of their own.
pub(super) const APARTMENT: &str = "apartment";
/// Albedos of the sweep.
pub(super) const ALBEDOS: [f32; 4] = [0.3, 0.5, 0.7, 0.8];
/// Width and height of small images.
pub(super) const SMALL: [u32; 2] = [64, 48];

/// How much is rendered of what.
#[derive(Clone, Copy, Debug)]
pub(super) struct Amounts {
    /// Walks from each end in a closed room.
    pub(super) walks: u64,
    /// Width and height of the images of table 1. Unit: pixels.
    size: [u32; 2],
    /// Seeds of all renders.
    seeds: u64,
    /// Samples per pixel of references, of each of their two estimators.
    spp: u64,
    /// Rays per pixel of table 1.
    rays: f64,
    /// The largest power of ten of triangles.
    largest: u32,
    /// Samples per pixel of the sweep of triangles.
    samples: f64,
    /// Samples per pixel of images of strategies.
    strategies: u64,
}

impl Amounts {
    fn seeds(&self) -> Seeds {
        Seeds {
            first: 1,
            count: self.seeds,
        }
    }

    /// Rays per pixel of the sweep of albedo: the brightest rooms need many for a sample.
    fn albedo_rays(&self) -> f64 {
        2.0 * self.rays
    }

    /// Width and height of the images of the sweep of triangles, whose references are few.
    fn sweep_size(&self) -> [u32; 2] {
        [0, 1].map(|axis| self.size[axis].min(SMALL[axis]))
    }
}

impl Effort {
    pub(super) fn amounts(self) -> Amounts {
        match self {
            Self::Trial => Amounts {
                walks: 4000,
                size: [8, 6],
                seeds: 2,
                spp: 16,
                rays: 40.0,
                largest: 3,
                samples: 1.0,
                strategies: 2,
            },
            Self::Quick => Amounts {
                walks: 400_000,
                size: SMALL,
                seeds: 8,
                spp: 512,
                rays: 100.0,
                largest: 5,
                samples: 8.0,
                strategies: 32,
            },
            Self::Full => Amounts {
                walks: 4_000_000,
                size: [96, 72],
                seeds: 20,
                spp: 2048,
                rays: 200.0,
                largest: 6,
                samples: 16.0,
                strategies: 128,
            },
        }
    }
}

/// The name of a method.
pub(super) fn method_name(weights: &str, rule: &str) -> String {
    format!("{weights} {rule}")
}

/// The name of a scene of the sweep of complexity.
pub(super) fn complexity_name(lamp: &str, triangles: usize) -> String {
    format!("{lamp} {triangles}")
}

/// The name of a scene of the sweep of albedo.
pub(super) fn albedo_name(albedo: f32) -> String {
    format!("albedo {}", (albedo * 100.0).round() / 100.0)
}

fn method(weights: &str, rule: &str) -> MethodSpec {
    let mut changes = setting();
    for (name, value) in [("mis", weights), ("shadow-rays", rule)] {
        let set = changes.set(name, value);
        debug_assert!(set.is_ok(), "{name} {value}: {set:?}");
    }
    MethodSpec {
        name: method_name(weights, rule),
        changes,
    }
}

/// A scene whose reference is rendered.
fn scene(name: &str, path: PathBuf, spp: u64) -> SceneSpec {
    let reference = ReferenceSpec::Make {
        spp,
        changes: Box::new(reference_changes()),
        witness: None,
    };
    scenes::spec(name, path, reference)
}

/// What decides the expectation, and no more: references may be rendered in a better way.
fn reference_changes() -> Request {
    let Request {
        strategies,
        max_depth,
        ..
    } = setting();
    Request {
        strategies,
        max_depth,
        ..Request::default()
    }
}

fn experiment(title: &str, description: &str) -> Experiment {
    Experiment {
        title: title.to_owned(),
        description: description.to_owned(),
        size: Some(SMALL),
        seeds: Seeds { first: 0, count: 1 },
        threads: 0,
        metrics: vec![
            Metric::Rmse,
            Metric::RmseTrimmed,
            Metric::Relmse,
            Metric::RelmseTrimmed,
        ],
        scenes: Vec::new(),
        methods: Vec::new(),
        budgets: Vec::new(),
        pyramid: None,
    }
}

/// Scenes A, B and the apartment; all weights, all rules; equal rays.
pub(super) fn table_1(amounts: &Amounts, folder: &Path) -> Experiment {
    let files = ROOMS.iter().copied().chain([(APARTMENT, APARTMENT)]);
    let rules = RULES.into_iter().chain(BEYOND);
    Experiment {
        size: Some(amounts.size),
        seeds: amounts.seeds(),
        scenes: files
            .map(|(name, file)| scene(name, scenes::path(folder, file), amounts.spp))
            .collect(),
        methods: rules
            .flat_map(|rule| WEIGHTS.map(|weights| method(weights, rule)))
            .collect(),
        budgets: vec![BudgetSpec::new(BudgetKind::Rays, amounts.rays)],
        pyramid: Some(PyramidSpec {
            method: method_name("balance", "all"),
            spp: amounts.strategies,
        }),
        ..experiment(
            "Table 1",
            "RMS errors at equal total rays, under three kinds of weights.",
        )
    }
}

/// The sweep of geometric complexity: rooms that are there as files.
pub(super) struct Complexity {
    /// Lamp, triangles and file.
    rooms: Vec<(Lamp, usize, PathBuf)>,
    spp: u64,
    size: [u32; 2],
}

impl Complexity {
    /// Writes the rooms.
    pub(super) fn write(amounts: &Amounts, folder: &Path) -> Result<Self> {
        let mut rooms = Vec::new();
        for power in 2..=amounts.largest {
            for lamp in Lamp::ALL {
                let room = Room {
                    lamp,
                    albedo: 0.7,
                    triangles: 10usize.pow(power),
                };
                let name = format!("complexity-{}-{}", lamp.name(), room.count());
                let path = write(room, folder, &name)?;
                rooms.push((lamp, room.count(), path));
            }
        }
        Ok(Self {
            rooms,
            spp: amounts.spp,
            size: amounts.sweep_size(),
        })
    }

    /// The rooms' numbers of triangles, ascending.
    pub(super) fn levels(&self) -> Vec<usize> {
        let mut levels: Vec<usize> = self.rooms.iter().map(|room| room.1).collect();
        levels.dedup();
        levels
    }

    /// Renders the references, in the rooms of the fewest triangles: they are the same in all.
    pub(super) fn references(&self) -> Experiment {
        let few = &self.rooms[..Lamp::ALL.len()];
        Experiment {
            size: Some(self.size),
            scenes: few
                .iter()
                .map(|(lamp, _, path)| scene(lamp.name(), path.clone(), self.spp))
                .collect(),
            methods: vec![method("balance", "per-pair")],
            budgets: vec![BudgetSpec::new(BudgetKind::Samples, 1.0)],
            ..experiment("References", "For the sweep of geometric complexity.")
        }
    }

    /// All rooms, with the references that lie in the folder `at`.
    pub(super) fn plan(&self, amounts: &Amounts, references: &Results, at: &Path) -> Experiment {
        let reference = |lamp: Lamp| {
            let mut scenes = references.scenes.iter();
            let scene = scenes.find(|scene| scene.name == lamp.name());
            let image = scene.and_then(|scene| scene.reference_image.as_ref());
            at.join(image.map_or("", |image| image))
        };
        let scenes = self.rooms.iter().map(|(lamp, triangles, path)| SceneSpec {
            reference: ReferenceSpec::There(reference(*lamp)),
            ..scene(
                &complexity_name(lamp.name(), *triangles),
                path.clone(),
                self.spp,
            )
        });
        Experiment {
            size: Some(self.size),
            seeds: amounts.seeds(),
            scenes: scenes.collect(),
            methods: methods(&["balance"]),
            budgets: vec![BudgetSpec::new(BudgetKind::Samples, amounts.samples)],
            ..experiment(
                "Geometric complexity",
                "The same light in rooms whose faces are divided ever finer.",
            )
        }
    }
}

/// The paper's rules under these weights; the first rule first.
fn methods(weights: &[&str]) -> Vec<MethodSpec> {
    let of_rule = |rule| weights.iter().map(move |weights| method(weights, rule));
    RULES.into_iter().flat_map(of_rule).collect()
}

/// The sweep of albedo: the same room, ever brighter.
pub(super) fn albedo(amounts: &Amounts, folder: &Path) -> Result<Experiment> {
    let mut scenes = Vec::new();
    for albedo in ALBEDOS {
        let room = Room {
            lamp: Lamp::Panel,
            albedo,
            triangles: 100,
        };
        let name = albedo_name(albedo);
        let path = write(room, folder, &name.replace(' ', "-"))?;
        scenes.push(scene(&name, path, amounts.spp));
    }
    Ok(Experiment {
        size: Some(amounts.size.map(|side| side / 2)),
        seeds: amounts.seeds(),
        scenes,
        methods: methods(&WEIGHTS),
        budgets: vec![BudgetSpec::new(BudgetKind::Rays, amounts.albedo_rays())],
        ..experiment("Albedo", "The same room with ever brighter surfaces.")
    })
}

fn write(room: Room, folder: &Path, name: &str) -> Result<PathBuf> {
    room.write(folder, name)
        .map_err(|error| ExperimentError::Folder {
            path: folder.join(name),
            error,
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_setting_is_that_of_the_paper() {
        let changes = setting();
        assert_eq!(changes.max_depth, Some(0));
        assert_eq!(changes.strategies.unwrap().to_string(), "all,-s0,-t1");
        let method = method("uniform", "budget:3");
        assert_eq!(method.name, "uniform budget:3");
        assert!(method.changes.mis.is_some() && method.changes.shadow_rays.is_some());
    }

    #[test]
    fn quick_experiments_keep_all_methods() {
        let folder = Path::new("");
        let [quick, full] =
            [Effort::Quick, Effort::Full].map(|effort| table_1(&effort.amounts(), folder));
        assert_eq!(quick.methods, full.methods);
        assert_eq!(quick.methods.len(), 27);
        assert_eq!(quick.scenes.len(), full.scenes.len());
        assert!(quick.seeds.count >= 4 && full.seeds.count >= 10);
    }

    /// The description that people begin from renders what the program does.
    #[test]
    fn the_description_beside_is_the_same() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments/paper.toml");
        let text = std::fs::read_to_string(&file).unwrap();
        let mut written = Experiment::read(&text, &file).unwrap();
        let mut own = table_1(&Effort::Full.amounts(), Path::new(""));
        own.metrics.retain(|metric| *metric != Metric::Rmse);
        written.metrics.retain(|metric| *metric != Metric::Rmse);
        assert_eq!(written.scenes.len(), own.scenes.len());
        for (scene, own) in written.scenes.iter_mut().zip(&own.scenes) {
            assert_eq!(scene.path.file_name(), own.path.file_name());
            (scene.path, scene.file) = (own.path.clone(), own.file.clone());
            scene.places = own.places.clone();
            // It may say more than what decides the expectation.
            if let ReferenceSpec::Make { changes, .. } = &mut scene.reference {
                assert_eq!(changes.strategies, setting().strategies);
                **changes = reference_changes();
            }
        }
        assert_eq!(written, own);
    }
}
