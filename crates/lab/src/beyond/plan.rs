//! What is rendered: scenes, sizes, budgets.

use super::variants::{self, Role};
use super::{Absent, Options};
use crate::experiment::{BudgetSpec, Experiment, MethodSpec, ReferenceSpec, SceneSpec, Seeds};
use crate::metric::Metric;
use crate::results::BudgetKind;
use crate::scenes;
use bidir::integrator::IntegratorKind;
use bidir::settings::Request;
use std::path::{Path, PathBuf};

/// How much is rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct Amounts {
    /// Width and height of all images. None: each scene has its own shape. Unit: pixels.
    pub size: Option<[u32; 2]>,
    /// The factor by which sides are longer than those of a quick run, where each scene has its own.
    pub scale: u32,
    /// Equal time that is rendered. Unit: seconds, those of training included.
    pub seconds: f64,
    /// Equal rays that are rendered, those of training included. Unit: rays per pixel.
    pub rays: f64,
    /// The budgets that training is weighed by: those of a whole run, which a quick one stands for.
    pub judged: Judged,
    /// How many seeds there are, from 1 on.
    pub seeds: u64,
    /// Samples per pixel of references, of each of their two estimators.
    pub reference_spp: u64,
}

/// The budgets that training is a part of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Unit: seconds of the clock.
    pub seconds: f64,
    /// Unit: rays for each pixel of the images that are rendered.
    pub rays: f64,
}

impl Amounts {
    /// All of it: ten seeds, a minute for each estimator; about a day on two cores.
    pub fn full() -> Self {
        Self {
            size: None,
            scale: 2,
            seconds: 60.0,
            rays: 500.0,
            judged: Judged {
                seconds: 60.0,
                rays: 500.0,
            },
            seeds: 10,
            reference_spp: 4096,
        }
    }

    /// Small pictures, short budgets, three seeds: about three minutes a scene on two cores.
    pub fn quick() -> Self {
        Self {
            size: None,
            scale: 1,
            seconds: 2.0,
            rays: 100.0,
            // A whole run has four times the pixels.
            judged: Judged {
                seconds: 60.0,
                rays: 2000.0,
            },
            seeds: 3,
            reference_spp: 1024,
        }
    }
}

/// Where a scene comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// The project: it is in the program.
    Own,
    /// Others: it is a file in a folder that somebody has.
    Others,
}

/// Whether light tracing makes all light paths of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LightTracing {
    Complete,
    /// It misses what is seen in mirrors or through clear glass.
    Incomplete,
}

/// A scene of the experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Scene {
    pub(super) name: &'static str,
    pub(super) origin: Origin,
    /// Width and height of small images, of the scene's own shape. Unit: pixels.
    pub(super) size: [u32; 2],
    pub(super) light: LightTracing,
    /// Of the reference. None: path tracing.
    pub(super) witness: Option<IntegratorKind>,
}

impl Scene {
    const fn own(name: &'static str) -> Self {
        Self {
            name,
            origin: Origin::Own,
            size: [160, 120],
            light: LightTracing::Incomplete,
            witness: None,
        }
    }

    const fn of_others(name: &'static str, size: [u32; 2]) -> Self {
        Self {
            name,
            origin: Origin::Others,
            size,
            light: LightTracing::Incomplete,
            witness: None,
        }
    }
}

/// All scenes; images of all have about as many pixels.
pub(super) const SCENES: [Scene; 9] = [
    Scene::own("room-direct"),
    Scene::own("room-indirect"),
    Scene::own("apartment"),
    Scene::own("apartment-dark"),
    // What comes through the glass egg are so few paths of path tracing, and so bright, that its mean is
    // skewed with any number of samples that is worth the while.
    Scene {
        witness: Some(IntegratorKind::Lvc),
        ..Scene::of_others("veach-bidir", [144, 144])
    },
    Scene::of_others("veach-ajar", [176, 99]),
    Scene {
        light: LightTracing::Complete,
        ..Scene::of_others("veach-mis", [176, 99])
    },
    Scene::of_others("coffee", [120, 150]),
    Scene::of_others("living-room", [176, 99]),
];

/// The names of all scenes.
pub fn scene_names() -> [&'static str; SCENES.len()] {
    SCENES.map(|scene| scene.name)
}

/// A scene that is there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) scene: Scene,
    pub(super) path: PathBuf,
}

/// The scenes that are asked for: those that are there, and those that are not. Those of the project
/// are in the folder `own`.
pub(super) fn places(options: &Options, own: &Path) -> (Vec<Place>, Vec<Absent>) {
    let (mut there, mut absent) = (Vec::new(), Vec::new());
    for scene in SCENES {
        let is_asked = |name: &String| name == scene.name;
        if !options.scenes.is_empty() && !options.scenes.iter().any(is_asked) {
            continue;
        }
        match path(scene, options, own) {
            Ok(path) => there.push(Place { scene, path }),
            Err(reason) => absent.push(Absent {
                name: scene.name,
                reason,
            }),
        }
    }
    (there, absent)
}

/// Where a scene is, or why it is nowhere.
fn path(scene: Scene, options: &Options, own: &Path) -> Result<PathBuf, String> {
    if scene.origin == Origin::Own {
        return Ok(scenes::path(own, scene.name));
    }
    let Some(folder) = &options.others else {
        return Err("BIDIR_SCENES is not set".to_owned());
    };
    let path = scenes::path_of_others(folder, scene.name);
    if path.is_file() {
        Ok(path)
    } else {
        Err(format!(
            "BIDIR_SCENES has no pbrt-v4/{0}/{0}.pbrt",
            scene.name
        ))
    }
}

/// The experiment of one scene.
pub(super) fn experiment(options: &Options, place: &Place) -> Experiment {
    let amounts = &options.amounts;
    let size = place.scene.size.map(|side| side * amounts.scale);
    let reference = ReferenceSpec::Make {
        spp: amounts.reference_spp,
        changes: Box::new(Request::default()),
        witness: place.scene.witness,
    };
    Experiment {
        title: place.scene.name.to_owned(),
        description: String::new(),
        size: None,
        seeds: Seeds {
            first: 1,
            count: amounts.seeds,
        },
        threads: options.threads,
        metrics: vec![Metric::Relmse, Metric::RelmseTrimmed, Metric::RelmseBlock],
        scenes: vec![SceneSpec {
            size: Some(amounts.size.unwrap_or(size)),
            ..scenes::spec(place.scene.name, place.path.clone(), reference)
        }],
        methods: methods(place.scene),
        budgets: budgets(amounts, place.scene),
        pyramid: None,
    }
}

/// What is rendered of a scene, the one that gains are relative to first.
fn methods(scene: Scene) -> Vec<MethodSpec> {
    let rendered = variants::rendered(scene.light);
    let methods = rendered.map(|variant| MethodSpec {
        name: variant.name.to_owned(),
        changes: variant.changes(),
    });
    methods.collect()
}

/// Equal time for estimators, equal rays for all.
fn budgets(amounts: &Amounts, scene: Scene) -> Vec<BudgetSpec> {
    let estimators = variants::rendered(scene.light);
    let estimators = estimators.filter(|variant| variant.role == Role::Estimator);
    let time = BudgetSpec {
        methods: estimators.map(|variant| variant.name.to_owned()).collect(),
        ..BudgetSpec::new(BudgetKind::Seconds, amounts.seconds)
    };
    vec![time, BudgetSpec::new(BudgetKind::Rays, amounts.rays)]
}
