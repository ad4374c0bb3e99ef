use crate::common::Workplace;
use std::collections::BTreeSet;

/// The flags that a command's help describes: the words at the head of its lines.
fn flags(help: &str) -> BTreeSet<&str> {
    let heads = help.lines().filter_map(|line| {
        let line = line.trim_start();
        let line = line
            .split_once(", ")
            .filter(|(short, _)| short.len() == 2)
            .map_or(line, |l| l.1);
        line.starts_with("--")
            .then(|| line.split_whitespace().next())?
    });
    heads.collect()
}

#[track_caller]
fn check_flags(command: &str, expected: &str) {
    let help = Workplace::new()
        .run(&format!("{command} --help"))
        .expect(0)
        .stdout;
    let expected: BTreeSet<_> = expected.split_whitespace().collect();
    assert_eq!(flags(&help), expected, "{command}");
}

#[test]
fn every_flag_is_described() {
    check_flags("", "--help --no-color --version");
    check_flags(
        "render",
        "--aov --candidates --checkpoint --checkpoint-every --crop --cropwindow --denoise --display-server --help --integrator \
         --isa --json --lenient --light-choice --light-groups --light-point --max-depth --mis --mis-count --no-color --noise \
         --output --part --passes --path-roulette --pixelbounds --progress --proposal --pyramid --quiet --replay --restart \
         --resume --sampler --samples-per-subpath --seed --serve --shadow-rays --size --spp --stats --strategies --strategy-layers \
         --strict --svg --threads --time --version",
    );
    check_flags(
        "view",
        "--bind --candidates --crop --cropwindow --help --integrator --isa --lenient --light-choice --light-point \
         --max-depth --mis --mis-count --no-color --path-roulette --pixelbounds --port --proposal --quiet --sampler \
         --samples-per-subpath --seed --shadow-rays --size --spp --strategies --strict --threads --version",
    );
    check_flags(
        "info",
        "--help --isa --json --lenient --no-color --strict --version",
    );
    check_flags(
        "reference",
        "--against --crop --cropwindow --estimator --extend --help --isa --lenient --no-color --output \
         --pixelbounds --progress --quiet --restart --size --spp --strict --threads --version",
    );
    check_flags(
        "compare",
        "--error-map --error-max --exact --flip --help --json --metric --no-color --reference --resample \
         --version",
    );
    check_flags(
        "experiment",
        "--help --no-color --output --quick --quiet --ray --rays --reference-spp --restart --scenes --seconds --seeds --size \
         --threads --version",
    );
    check_flags(
        "tonemap",
        "--exposure --help --no-color --operator --output --version",
    );
    check_flags("denoise", "--help --no-color --output --threads --version");
    for farm in ["slurm", "hyperqueue", "k8s", "shell"] {
        let flags = "--help --no-color --output --parts --spp --version";
        check_flags(&format!("farm {farm}"), flags);
    }
}

#[test]
fn help_tells_exit_codes_defaults_environment_and_other_spellings() {
    let place = Workplace::new();
    place
        .run("--help")
        .expect(0)
        .prints("75  stopped early")
        .prints("143  stopped by SIGTERM");
    let mut render = place.run("render --help").expect(0);
    for part in [
        "BIDIR_THREADS",
        "BIDIR_SEED",
        "BIDIR_ISA",
        "outfile",
        "nthreads",
        "Examples:",
    ] {
        render = render.prints(part);
    }
    render
        .prints("[default: fresh]")
        .prints("[possible values: path, light, bdpt, lvc, auto]");
}

#[test]
fn version_completions_and_manual_are_printed() {
    let place = Workplace::new();
    place
        .run("--version")
        .expect(0)
        .prints(env!("CARGO_PKG_VERSION"));
    for shell in ["bash", "zsh", "fish"] {
        place
            .run(&format!("completions {shell}"))
            .expect(0)
            .prints("shadow-rays");
    }
    place.run("man").expect(0).prints(".TH bidir");
    place.run("man render").expect(0).prints("shadow\\-rays");
    place.run("man nothing").expect(2);
}
