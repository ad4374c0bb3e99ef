//! Compares every integrator with every choice of shadow rays, and `auto` with its possible plans, on every
//! scene: a part always, more in the long statistics, and everything in nightly runs.

use crate::case::{Case, PIXELS, QUARTERS, open};
use crate::statistics::{BIAS, Comparison, Replicates};
use bidir::integrator::{CandidateCount, IntegratorKind, LvcSettings, SamplesPerSubpath};
use bidir::select::ShadowRays;

/// The rules of `--shadow-rays` but `all`.
const RULES: [&str; 5] = [
    "per-light-vertex",
    "per-camera-vertex",
    "per-pair",
    "ray-roulette",
    "budget:2",
];

/// Paired comparisons take this fraction of the passes, as the correlated noise of the estimators cancels.
const PART_OF_PAIRS: u64 = 4;

/// Settings of `lvc`, of which the first are those of a plan of `auto`: candidates of a camera vertex, shadow rays per
/// sample, and the binary logarithm of the samples per light subpath.
const PLANS: [([u16; 2], u32, u32); 2] = [([24, 1], 6, 1), ([24, 4], 10, 0)];

/// A scene of `scenes/torture`.
struct World {
    name: &'static str,
    /// The passes of the bidirectional path tracer; the path tracer takes twice `effort` times as many.
    passes: u64,
    effort: u64,
    light: Light,
    /// The sizes of compared blocks, if all shadow rays are traced.
    blocks: &'static [usize],
}

/// The part of a scene that the light tracer renders.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Light {
    /// The whole picture, with this many times the passes.
    Whole(u64),
    /// Not everything: something is visible only by Dirac lobes, or only to camera rays.
    Partial,
}

const fn world(name: &'static str, [passes, effort]: [u64; 2], light: Light) -> World {
    World {
        name,
        passes,
        effort,
        light,
        blocks: PIXELS,
    }
}

impl World {
    /// Returns the same scene, compared only by blocks: pixels get so few splats that their means are skewed,
    /// or no splats, which leaves no variance.
    const fn by_blocks(self) -> Self {
        Self {
            blocks: QUARTERS,
            ..self
        }
    }
}

/// The scenes without tests of their own. All but three take so long that they are only in the long
/// statistics.
const WORLDS: [World; 8] = [
    world("picture-lamp", [512, 2], Light::Whole(2)),
    world("sky-alone", [256, 2], Light::Whole(32)).by_blocks(),
    world("within-glass", [256, 2], Light::Partial),
    world("bulb", [640, 4], Light::Partial),
    world("narrow-spot", [512, 12], Light::Whole(2)),
    world("shapes", [768, 2], Light::Whole(2)),
    world("leaves", [320, 3], Light::Whole(3)),
    world("empty-sky", [128, 1], Light::Whole(12)).by_blocks(),
];

/// The scenes with tests of their own, which are in the matrix of nightly runs.
const OTHERS: [World; 13] = [
    world("conductor", [2880, 1], Light::Partial),
    world("crop", [1536, 1], Light::Whole(10)).by_blocks(),
    world("glass", [2048, 1], Light::Partial),
    world("lens", [2048, 1], Light::Whole(18)),
    world("lights", [768, 1], Light::Whole(4)).by_blocks(),
    world("mirror", [512, 1], Light::Whole(2)),
    world("parallel", [1024, 1], Light::Partial).by_blocks(),
    world("around-longitude", [1024, 1], Light::Whole(2)).by_blocks(),
    world("around-octahedron", [1024, 1], Light::Whole(2)).by_blocks(),
    world("red-light-blue-surfaces", [512, 4], Light::Whole(2)),
    world("scale-tiny", [512, 2], Light::Whole(2)),
    world("shading-normal", [768, 1], Light::Whole(6)),
    world("touching", [768, 1], Light::Whole(2)),
];

/// An estimator of a scene, with the parameters of its comparison.
#[derive(Clone)]
struct Entrant {
    name: String,
    integrator: IntegratorKind,
    /// The choice of shadow rays. None: the default of the estimator.
    rays: Option<ShadowRays>,
    lvc: LvcSettings,
    /// The factor on the number of passes.
    effort: u64,
    blocks: &'static [usize],
}

impl Entrant {
    /// Returns an estimator with default settings and a choice of shadow rays.
    fn new(integrator: IntegratorKind, rays: ShadowRays) -> Self {
        Self {
            name: format!("{integrator:?}, {rays}"),
            integrator,
            rays: Some(rays),
            lvc: LvcSettings::default(),
            effort: 1,
            blocks: QUARTERS,
        }
    }

    fn render(&self, case: Case<'_>) -> Replicates {
        let case = case.with_effort(self.effort);
        case.render(self.integrator, |settings| {
            settings.shadow_rays = self.rays.unwrap_or(settings.shadow_rays);
            settings.lvc = self.lvc;
        })
    }
}

/// A reference image and its estimator.
struct Reference<'a> {
    entrant: &'a Entrant,
    image: Replicates,
}

impl<'a> Reference<'a> {
    fn new(entrant: &'a Entrant, case: Case<'_>) -> Self {
        let image = entrant.render(case);
        Self { entrant, image }
    }

    /// Compares an image with this one, in pairs if both estimators make the same subpaths.
    fn comparison<'b>(&'b self, entrant: &Entrant, image: &'b Replicates) -> Comparison<'b> {
        let comparison = Comparison::new(image, &self.image, entrant.blocks);
        if entrant.integrator == self.entrant.integrator {
            comparison.paired()
        } else {
            comparison
        }
    }
}

impl World {
    /// Compares the bidirectional path tracers with all shadow rays, the light tracer if it renders the whole
    /// picture, and `others` with the path tracer. Estimators with `rules` make the same subpaths, so they are
    /// compared in pairs with all shadow rays.
    #[track_caller]
    fn check(&self, rules: &[&str], others: impl IntoIterator<Item = Entrant>) {
        let loaded = open(&format!("{}.pbrt", self.name));
        let case = Case::new(&loaded, self.passes);
        let path = Entrant {
            effort: self.effort,
            ..Entrant::new(IntegratorKind::Path, ShadowRays::All)
        };
        let path = Reference::new(&path, case);
        for integrator in [IntegratorKind::Bdpt, IntegratorKind::Lvc] {
            let all = Entrant {
                blocks: self.blocks,
                ..Entrant::new(integrator, ShadowRays::All)
            };
            self.compare(case, &all, &path);
            let case = case.with_part(PART_OF_PAIRS);
            let all = Reference::new(&all, case);
            for rule in rules {
                let entrant = Entrant::new(integrator, rule.parse().expect("a rule"));
                self.compare(case, &entrant, &all);
            }
        }
        for entrant in self.light().into_iter().chain(others) {
            self.compare(case, &entrant, &path);
        }
    }

    /// Returns the light tracer, if it renders the whole picture.
    fn light(&self) -> Option<Entrant> {
        match self.light {
            Light::Partial => None,
            Light::Whole(effort) => Some(Entrant {
                effort,
                ..Entrant::new(IntegratorKind::Light, ShadowRays::All)
            }),
        }
    }

    /// Compares an estimator with the reference, and repeats a comparison that fails or cannot detect a bias,
    /// with another seed and more passes.
    ///
    /// Of hundreds of comparisons, some fail by chance, or have no power because of a rare bright path. Repeated
    /// with more samples, chance disappears and a fault stays.
    #[track_caller]
    fn compare(&self, case: Case<'_>, entrant: &Entrant, reference: &Reference<'_>) {
        let name = format!("{}, {}", self.name, entrant.name);
        let image = entrant.render(case);
        let first = reference.comparison(entrant, &image);
        if first.agrees() {
            first.check(&name, BIAS);
        } else {
            let case = case.again();
            let reference = Reference::new(reference.entrant, case);
            let image = entrant.render(case);
            reference.comparison(entrant, &image).check(&name, BIAS);
        }
    }
}

/// Returns `auto`, and `lvc` with the settings of [`PLANS`].
fn planned() -> Vec<Entrant> {
    let plans = PLANS.map(|([first, deeper], rays, exponent)| Entrant {
        name: format!("{first},{deeper} candidates, budget:{rays}"),
        lvc: LvcSettings {
            candidates: CandidateCount::new(first, deeper),
            samples_per_subpath: SamplesPerSubpath::power_of_two(exponent),
            ..LvcSettings::default()
        },
        ..Entrant::new(IntegratorKind::Lvc, ShadowRays::Budget(rays))
    });
    let auto = Entrant {
        name: "auto".to_owned(),
        rays: None,
        ..Entrant::new(IntegratorKind::Auto, ShadowRays::All)
    };
    plans.into_iter().chain([auto]).collect()
}

/// Checks a scene with all shadow rays, one of the other rules, and `auto` or one of its plans.
#[track_caller]
fn check(name: &str) {
    let has_name = |world: &World| world.name == name;
    let i = WORLDS.iter().position(has_name).expect("a world");
    let rule = RULES[i % RULES.len()];
    let mut plans = planned();
    let one = i % plans.len();
    WORLDS[i].check(&[rule], plans.drain(one..=one));
}

#[test]
fn a_camera_within_glass() {
    check("within-glass");
}

#[test]
fn a_narrow_spot() {
    check("narrow-spot");
}

#[test]
fn a_sky_over_nothing() {
    check("empty-sky");
}

mod long_statistics {
    use super::check;

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn lamps_that_are_pictures() {
        check("picture-lamp");
    }

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn a_picture_of_the_sky_alone() {
        check("sky-alone");
    }

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn a_lamp_within_glass_seen_in_a_mirror() {
        check("bulb");
    }

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn shapes_of_all_kinds() {
        check("shapes");
    }

    #[test]
    #[ignore = "long statistics: .ci/run statistics"]
    fn leaves_cut_out_and_placed_many_times() {
        check("leaves");
    }
}

/// One test for each world, so that they run in parallel and have separate results.
mod every_choice_of_shadow_rays {
    use super::{OTHERS, RULES, WORLDS, planned};

    #[track_caller]
    fn check(name: &str) {
        let mut worlds = WORLDS.iter().chain(&OTHERS);
        let world = worlds.find(|world| world.name.replace('-', "_") == name);
        let world = world.expect("a world");
        world.check(&RULES, planned());
    }

    /// Defines a test for each world.
    macro_rules! worlds {
        ($($name:ident)*) => {
            $(
                #[test]
                #[ignore = "takes long: just nightly"]
                fn $name() {
                    check(stringify!($name));
                }
            )*

            #[test]
            fn have_every_world() {
                let names = [$(stringify!($name)),*];
                let worlds = WORLDS.iter().chain(&OTHERS).map(|world| world.name.replace('-', "_"));
                assert_eq!(worlds.collect::<Vec<_>>(), names);
            }
        };
    }

    worlds! {
        picture_lamp sky_alone within_glass bulb narrow_spot shapes leaves empty_sky
        conductor crop glass lens lights mirror parallel around_longitude around_octahedron
        red_light_blue_surfaces scale_tiny shading_normal touching
    }
}

/// Every estimator of a scene without light is exactly black.
#[test]
fn a_scene_without_light_is_black() {
    let loaded = open("empty.pbrt");
    let case = Case::new(&loaded, 64);
    for integrator in [
        IntegratorKind::Path,
        IntegratorKind::Light,
        IntegratorKind::Bdpt,
        IntegratorKind::Lvc,
    ] {
        let picture = case.render(integrator, |_| ());
        assert!(picture.mean().abs() <= 0.0, "{integrator:?}");
    }
}
