//! Every integrator with every choice of shadow rays, and `auto` with what it may choose besides, on
//! every scene: a part of it always, all of it at night.

use crate::case::{Case, PIXELS, QUARTERS, open};
use crate::statistics::{Replicates, agree, check_agree};
use bidir::integrator::{
    CandidateCount, Candidates, IntegratorKind, LvcSettings, SamplesPerSubpath,
};
use bidir::select::ShadowRays;

/// The rules of `--shadow-rays`.
const RULES: [&str; 6] = [
    "all",
    "per-light-vertex",
    "per-camera-vertex",
    "per-pair",
    "ray-roulette",
    "budget:2",
];

/// Plans of `auto` that are no integrator's default: candidates of a camera vertex, shadow rays of a
/// sample, and the binary logarithm of the samples for each light subpath.
const PLANS: [([u16; 2], u32, u32); 2] = [([20, 3], 8, 1), ([24, 4], 10, 0)];

/// A scene of `scenes/torture`.
struct World {
    name: &'static str,
    /// Of the bidirectional path tracer; the path tracer takes `effort` times as many twice.
    passes: u64,
    effort: u64,
    light: Light,
    /// Of what sizes blocks are compared where all shadow rays are traced.
    blocks: &'static [usize],
}

/// What the light tracer makes of a scene.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Light {
    /// All of the picture, with this many times the passes.
    Whole(u64),
    /// Not all of it: something is seen by Dirac lobes, or only the camera's own rays see it.
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
    /// The same compared by blocks alone: so few splats land in a pixel that its mean is skewed, and
    /// where none lands nothing varies.
    const fn by_blocks(self) -> Self {
        Self {
            blocks: QUARTERS,
            ..self
        }
    }
}

/// Those that no other test is about.
const WORLDS: [World; 8] = [
    world("picture-lamp", [512, 2], Light::Whole(2)),
    world("sky-alone", [512, 2], Light::Whole(32)).by_blocks(),
    world("within-glass", [512, 2], Light::Partial),
    world("bulb", [1024, 4], Light::Partial),
    world("narrow-spot", [768, 12], Light::Whole(2)),
    world("shapes", [768, 2], Light::Whole(2)),
    world("leaves", [512, 3], Light::Whole(2)),
    world("empty-sky", [256, 1], Light::Whole(12)),
];

/// Those that have tests of their own, and are in the matrix at night.
const OTHERS: [World; 13] = [
    world("conductor", [4608, 1], Light::Partial),
    world("crop", [9216, 1], Light::Whole(2)),
    world("glass", [4608, 1], Light::Partial),
    world("lens", [3072, 2], Light::Whole(16)),
    world("lights", [6912, 1], Light::Whole(2)),
    world("mirror", [1536, 1], Light::Whole(2)),
    world("parallel", [2304, 1], Light::Partial),
    world("around-longitude", [2304, 1], Light::Whole(2)),
    world("around-octahedron", [2304, 1], Light::Whole(2)),
    world("red-light-blue-surfaces", [768, 4], Light::Whole(2)),
    world("scale-tiny", [768, 2], Light::Whole(2)),
    world("shading-normal", [2304, 1], Light::Whole(2)),
    world("touching", [1024, 1], Light::Whole(2)),
];

/// An estimator of a scene, and how it is compared.
#[derive(Clone)]
struct Entrant {
    name: String,
    integrator: IntegratorKind,
    rays: ShadowRays,
    lvc: LvcSettings,
    /// It takes this many times the passes.
    effort: u64,
    blocks: &'static [usize],
}

impl World {
    /// Compares the bidirectional path tracers under each of `rules`, the light tracer where it sees
    /// all, and those of `others`, with the path tracer.
    #[track_caller]
    fn check(
        &self,
        rules: impl IntoIterator<Item = &'static str>,
        others: impl IntoIterator<Item = Entrant>,
    ) {
        let loaded = open(&format!("{}.pbrt", self.name));
        let case = Case::new(&loaded, self.passes);
        let reference = self.reference(case);
        for entrant in self.entrants(rules).into_iter().chain(others) {
            self.compare(case, &entrant, &reference);
        }
    }

    fn reference(&self, case: Case<'_>) -> Replicates {
        case.with_effort(self.effort).path()
    }

    fn entrants(&self, rules: impl IntoIterator<Item = &'static str>) -> Vec<Entrant> {
        let connected = rules.into_iter().flat_map(|rule| {
            [IntegratorKind::Bdpt, IntegratorKind::Lvc].map(|integrator| Entrant {
                name: format!("{}, {integrator:?}, {rule}", self.name),
                integrator,
                rays: rule.parse().expect("a rule"),
                lvc: LvcSettings::default(),
                effort: 1,
                blocks: if rule == "all" { self.blocks } else { QUARTERS },
            })
        });
        let light = match self.light {
            Light::Partial => None,
            Light::Whole(effort) => Some(Entrant {
                name: format!("{}, light", self.name),
                integrator: IntegratorKind::Light,
                rays: ShadowRays::All,
                lvc: LvcSettings::default(),
                effort,
                blocks: QUARTERS,
            }),
        };
        connected.chain(light).collect()
    }

    /// `auto`, and its plans that are no integrator's default.
    fn planned(&self) -> Vec<Entrant> {
        let auto = Entrant {
            name: format!("{}, auto", self.name),
            integrator: IntegratorKind::Auto,
            rays: ShadowRays::Suited,
            lvc: LvcSettings::default(),
            effort: 1,
            blocks: QUARTERS,
        };
        let plans = PLANS.map(|([first, deeper], rays, exponent)| Entrant {
            name: format!("{}, {first},{deeper} candidates, budget:{rays}", self.name),
            integrator: IntegratorKind::Lvc,
            rays: ShadowRays::Budget(rays),
            lvc: LvcSettings {
                candidates: Candidates::Of(CandidateCount::new(first, deeper)),
                samples_per_subpath: SamplesPerSubpath::power_of_two(exponent),
                ..LvcSettings::default()
            },
            ..auto.clone()
        });
        plans.into_iter().chain([auto]).collect()
    }

    /// Of hundreds of comparisons some look different by chance, or a rare bright path keeps them from seeing
    /// anything: these are made again, with other random numbers and more of them, by which chance goes away
    /// and a fault stays.
    #[track_caller]
    fn compare(&self, case: Case<'_>, entrant: &Entrant, reference: &Replicates) {
        let render = |case: Case<'_>| {
            let case = case.with_effort(entrant.effort);
            case.render(entrant.integrator, |settings| {
                settings.shadow_rays = entrant.rays;
                settings.lvc = entrant.lvc;
            })
        };
        let result = render(case);
        if agree(&result, reference, entrant.blocks) {
            check_agree(&entrant.name, &result, reference, entrant.blocks);
        } else {
            let again = case.again();
            let reference = self.reference(again);
            check_agree(&entrant.name, &render(again), &reference, entrant.blocks);
        }
    }
}

/// A scene with all shadow rays, with one of the other rules, and with `auto` or one of its plans.
#[track_caller]
fn check(name: &str) {
    let is_meant = |world: &World| world.name == name;
    let i = WORLDS.iter().position(is_meant).expect("a world");
    let rule = RULES[1 + i % (RULES.len() - 1)];
    let mut planned = WORLDS[i].planned();
    let one = i % planned.len();
    WORLDS[i].check(["all", rule], planned.drain(one..=one));
}

#[test]
fn lamps_that_are_pictures() {
    check("picture-lamp");
}

#[test]
fn a_picture_of_the_sky_alone() {
    check("sky-alone");
}

#[test]
fn a_camera_within_glass() {
    check("within-glass");
}

#[test]
fn a_lamp_within_glass_seen_in_a_mirror() {
    check("bulb");
}

#[test]
fn a_narrow_spot() {
    check("narrow-spot");
}

#[test]
fn shapes_of_all_kinds() {
    check("shapes");
}

#[test]
fn leaves_cut_out_and_placed_many_times() {
    check("leaves");
}

#[test]
fn a_sky_over_nothing() {
    check("empty-sky");
}

/// One test for each world, so that they run side by side and each tells of itself.
mod every_choice_of_shadow_rays {
    use super::{OTHERS, RULES, WORLDS};

    #[track_caller]
    fn check(name: &str) {
        let mut worlds = WORLDS.iter().chain(&OTHERS);
        let world = worlds.find(|world| world.name.replace('-', "_") == name);
        let world = world.expect("a world");
        world.check(RULES, world.planned());
    }

    /// A test with the name of each world.
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
            fn is_asked_of_every_world() {
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

/// Without light every estimator is exactly black.
#[test]
fn nothing_is_black() {
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
