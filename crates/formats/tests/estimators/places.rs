//! Every estimator renders a scene alike at any place and of any size in its world: the same paths, drawn
//! with the same random numbers, carry the same light.

use super::QUARTERS;
use super::case::{Case, RESOLUTION};
use super::statistics::{Replicates, check_paired};
use bidir::integrator::IntegratorKind;
use bidir_formats::scene::{Files, LoadOptions, Loaded, load_from};
use std::path::Path;
use std::sync::Arc;

/// The place of the room of `scale-unit.pbrt`, and the length of its unit.
#[derive(Clone, Copy, Debug)]
struct Site {
    offset: f64,
    unit: f64,
}

const HOME: Site = Site {
    offset: 0.0,
    unit: 1.0,
};

impl Site {
    const fn shifted(offset: f64) -> Self {
        Self { offset, ..HOME }
    }

    const fn scaled(unit: f64) -> Self {
        Self { unit, ..HOME }
    }

    /// Returns the text of the room at this place. The camera's inverse transformation follows its `LookAt`.
    fn text(self) -> String {
        let Self { offset, unit } = self;
        let room = include_str!("../../../../scenes/torture/scale-unit.pbrt");
        let [back, away] = [1.0 / unit, unit].map(|s| format!("Scale {s} {s} {s}\n"));
        let [home, there] = [-1.0, 1.0].map(|sign| {
            let [x, y, z] = [1.0, -0.75, 0.5].map(|part| sign * part * offset);
            format!("Translate {x} {y} {z}\n")
        });
        let room = room.replacen("Camera", &format!("{back}{home}Camera"), 1);
        room.replacen("WorldBegin", &format!("WorldBegin\n{there}{away}"), 1)
    }

    fn open(self) -> Loaded {
        let name = Path::new("room.pbrt");
        let text = Arc::from(self.text().as_bytes());
        let options = LoadOptions {
            resolution: Some(RESOLUTION),
            ..LoadOptions::default()
        };
        let loaded = load_from(name, &options, &Files::only([(name.into(), text)].into()));
        loaded.expect("the room is a scene")
    }

    fn render(self, passes: u64) -> Vec<(&'static str, Replicates)> {
        let loaded = self.open();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        let case = Case::new(&loaded, passes);
        let named = IntegratorKind::NAMES.into_iter();
        let estimators = named.filter(|(_, kind)| *kind != IntegratorKind::Auto);
        estimators
            .map(|(name, kind)| (name, case.render(kind, |_| ())))
            .collect()
    }
}

#[track_caller]
fn check(sites: &[Site], passes: u64) {
    let home = HOME.render(passes);
    for site in sites {
        for ((name, actual), (_, expected)) in site.render(passes).iter().zip(&home) {
            check_paired(&format!("{name}, {site:?}"), actual, expected, QUARTERS);
        }
    }
}

#[test]
fn far_away_tiny_and_huge() {
    let sites = [
        Site::shifted(1e7),
        Site {
            offset: 1e-3,
            unit: 1e-12,
        },
        Site::scaled(1e10),
    ];
    check(&sites, 64);
}

mod decades {
    use super::{Site, check};

    #[test]
    #[ignore = "minutes: just nightly"]
    fn every_decade_of_distance_and_size() {
        let shifts = (1..=9).map(|decade| Site::shifted(libm::pow(10.0, f64::from(decade))));
        let scales = (-12..=10).map(|decade| Site::scaled(libm::pow(10.0, f64::from(decade))));
        let sites: Vec<Site> = shifts.chain(scales).collect();
        check(&sites, 384);
    }
}
