//! The whole experiment, small: nothing can be concluded, but everything has to work.

use super::*;
use crate::experiment::{Event, Start};
use crate::results::{Cell, Machine};
use std::cell::Cell as Counter;
use std::collections::BTreeSet;

/// A clock that goes on when it is looked at, and counts renders.
#[derive(Default)]
struct Host {
    looks: Counter<u32>,
    renders: usize,
}

impl Observer for Host {
    fn tell(&mut self, event: Event<'_>) {
        self.renders += usize::from(matches!(event, Event::Record(_)));
    }

    fn seconds(&self) -> f64 {
        self.looks.set(self.looks.get() + 1);
        f64::from(self.looks.get())
    }
}

#[test]
fn every_claim_is_judged_and_nothing_is_done_twice() {
    let folder = tempfile::tempdir().unwrap();
    let setup = Setup {
        folder: folder.path().to_owned(),
        start: Start::Resume,
        program: "test".to_owned(),
        machine: Machine::default(),
    };
    let options = Options {
        effort: Effort::Trial,
        threads: 2,
    };
    let mut host = Host::default();
    let mut go = || run(options, &setup, &mut host).unwrap().results.unwrap();
    let results = go();
    let again = go();
    assert_eq!(results, again);
    assert_eq!(host.renders, results.records.len() + 2);
    let ids: BTreeSet<_> = results.claims.iter().map(|claim| &claim.id).collect();
    assert_eq!(ids.len(), results.claims.len());
    assert_eq!(ids.len(), 2 + 2 + 18 + 2 + 2 + 3 + 3 + 9);
    for table in results.claims.iter().flat_map(|claim| &claim.tables) {
        assert!(
            table
                .rows
                .iter()
                .all(|row| row.len() == table.columns.len())
        );
        // All that should have been rendered was.
        let empty = Cell::Text(String::new());
        assert!(
            !table.rows.iter().flatten().any(|cell| *cell == empty),
            "{table:#?}"
        );
    }
    let shown: Vec<_> = results.pyramids.iter().map(|found| &*found.scene).collect();
    assert_eq!(shown, ["A", "B", "apartment"]);
    let mut pyramids = results.pyramids.iter();
    assert!(pyramids.all(|found| folder.path().join(&found.images).exists()));
    let images = results
        .records
        .iter()
        .filter_map(|record| record.image.as_ref());
    let references = results.scenes.iter();
    let references = references.filter_map(|scene| scene.reference_image.as_ref());
    let images: Vec<_> = images.chain(references).collect();
    assert!(images.len() > 81);
    assert!(
        images
            .iter()
            .all(|image| folder.path().join(image).exists())
    );
    assert!(folder.path().join("results.json").exists());
}
