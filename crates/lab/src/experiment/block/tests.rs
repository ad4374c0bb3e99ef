use super::*;
use crate::experiment::{Event, Start, run};
use crate::results::{Machine, Results};
use std::path::Path;

const DESCRIPTION: &str = "seeds = 2\nsize = \"8x8\"\nthreads = 1\nmetrics = [\"relmse\"]\n\
    [[scene]]\nfile = \"s.pbrt\"\nreference-spp = 64\n\
    [[method]]\nname = \"a\"\nintegrator = \"bdpt\"\n\
    [[method]]\nname = \"b\"\nintegrator = \"path\"\n\
    [[budget]]\nsamples = 2\n[[budget]]\nsamples = 4\n";
const SCENE: &str = "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n\
    WorldBegin\nLightSource \"infinite\"\nTranslate 0 0 3\nShape \"sphere\"\n";

struct Silent;

impl Observer for Silent {
    fn notify(&mut self, _event: Event<'_>) {}

    fn seconds(&self) -> f64 {
        0.0
    }
}

fn setup(folder: PathBuf) -> Setup {
    Setup {
        folder,
        start: Start::Resume,
        program: "bidir test".into(),
        machine: Machine::default(),
    }
}

fn read(folder: &Path) -> Experiment {
    std::fs::write(folder.join("s.pbrt"), SCENE).unwrap();
    Experiment::read(DESCRIPTION, &folder.join("e.toml")).unwrap()
}

fn results(experiment: &Experiment, setup: &Setup) -> Results {
    let outcome = run(experiment, setup, &mut Silent).unwrap();
    outcome.results.unwrap()
}

#[test]
fn blocks_in_any_order_give_the_results_of_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let experiment = read(folder.path());
    let whole = results(&experiment, &setup(folder.path().join("whole")));
    let parts = setup(folder.path().join("parts"));
    let prepared = prepare(&experiment, &parts, &mut Silent).unwrap().unwrap();
    assert_eq!(prepared.blocks.len(), 4);
    assert_eq!(prepared.blocks[0].methods, ["a", "b"]);
    assert_eq!(prepared.scenes[0].files, [folder.path().join("s.pbrt")]);
    let render = |block: &Block| {
        let reference = &prepared.scenes[0].reference;
        render_block(
            &experiment,
            block,
            &Files::default(),
            reference,
            &mut Silent,
        )
        .unwrap()
        .unwrap()
    };
    for block in prepared.blocks.iter().rev().take(3) {
        prepared.add(render(block)).unwrap();
    }
    // A second start leaves out finished blocks; a block that is added twice counts once.
    let again = prepare(&experiment, &parts, &mut Silent).unwrap().unwrap();
    assert_eq!(again.blocks, prepared.blocks[..1]);
    for block in &prepared.blocks[..2] {
        again.add(render(block)).unwrap();
    }
    assert_eq!(results(&experiment, &parts), whole);
    let image = whole.records[0].image.as_ref().unwrap();
    let bytes = |name: &str| std::fs::read(folder.path().join(name).join(image)).unwrap();
    assert_eq!(bytes("parts"), bytes("whole"));
}

#[test]
fn blocks_of_unknown_scenes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let experiment = read(folder.path());
    let block = Block {
        scene: "other".into(),
        budget: "2 spp".into(),
        seed: 0,
        methods: vec!["a".into()],
    };
    let pixels = Pixels {
        size: [8, 8],
        data: vec![[1.0; 3]; 64],
    };
    let rendered = render_block(&experiment, &block, &Files::default(), &pixels, &mut Silent);
    let error = rendered.unwrap_err();
    assert!(matches!(error, ExperimentError::Mismatch(_)));
}
