//! The parsers of `lab`.

use lab::experiment::Experiment;
use lab::report::{self, Report};
use lab::results::Results;
use std::path::Path;

/// The description of an experiment; or, where it begins with a brace, results as a report shows them.
pub fn experiment(bytes: &[u8]) {
    if bytes.starts_with(b"{") {
        results(bytes);
    } else if let Ok(text) = std::str::from_utf8(bytes) {
        description(text);
    }
}

fn description(text: &str) {
    match Experiment::read(text, Path::new("experiment.toml")) {
        Ok(experiment) => {
            let _ = (experiment.run_count(), experiment.quick().run_count());
        }
        Err(error) => drop(error.to_string()),
    }
}

fn results(bytes: &[u8]) {
    let Ok(results) = serde_json::from_slice::<Results>(bytes) else {
        return;
    };
    let text = "[[scene]]\nfile = \"a.pbrt\"\nreference-spp = 1\n[[method]]\nname = \"a\"\n[[budget]]\nrays = 9\n";
    let experiment = Experiment::read(text, Path::new("a.toml"));
    let _ = experiment.map(|experiment| experiment.sections(&results));
    let _ = report::html(&Report {
        results: &results,
        tables: &[],
        plots: &[],
        images: &[],
        layers: &[],
        command: "",
    });
}
