use crate::common::Workplace;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Returns the flags that a command's help describes: the first words of its lines.
fn flags(help: &str) -> BTreeSet<&str> {
    let heads = help.lines().filter_map(|line| {
        let line = line.trim_start();
        let line = line
            .split_once(", ")
            .filter(|(short, _)| short.len() == 2)
            .map_or(line, |l| l.1);
        // A wrapped line may begin with a flag in the middle of a sentence.
        let flag = line.split_whitespace().next()?;
        let flag = flag.trim_end_matches(|end: char| !end.is_alphanumeric());
        flag.starts_with("--").then_some(flag)
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
         --isa --json --lenient --light-choice --light-groups --light-point --light-start --max-depth --mis --next-events --no-color --noise \
         --output --part --passes --path-roulette --pixelbounds --progress --proposal --pyramid --quiet --replay --restart \
         --resume --sampler --samples-per-subpath --seed --serve --shadow-rays --size --spp --stats --strategies --strategy-layers \
         --strict --svg --threads --time --version",
    );
    check_flags(
        "view",
        "--bind --candidates --crop --cropwindow --help --integrator --isa --lenient --light-choice --light-point \
         --light-start --max-depth --mis --next-events --no-color --path-roulette --pixelbounds --port --proposal --quiet --sampler \
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
fn help_has_exit_codes_defaults_environment_and_other_spellings() {
    let place = Workplace::new();
    place
        .run("--help")
        .expect(0)
        .prints("Renders pbrt-v4 and glTF scenes with path tracing")
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
fn short_help_has_the_common_flags() {
    let place = Workplace::new();
    let render = place
        .run("render -h")
        .expect(0)
        .prints("Examples:\n")
        .stdout;
    let common = "--aov --checkpoint --denoise --help --integrator --lenient --noise --output --resume --seed --serve --size \
        --spp --threads --time --version";
    assert_eq!(flags(&render), common.split_whitespace().collect());
    assert!(render.lines().count() <= 40, "{render}");
    assert!(!render.contains("[env"), "{render}");
    let all = place.run("-h").expect(0).prints("Commands:").stdout;
    assert!(!all.contains("Exit codes"), "{all}");
    for command in ["view", "reference", "experiment"] {
        let help = |flag| place.run(&format!("{command} {flag}")).expect(0).stdout;
        assert!(
            flags(&help("-h")).len() < flags(&help("--help")).len(),
            "{command}"
        );
    }
}

#[test]
fn the_headings_of_render_are_in_order() {
    let help = Workplace::new().run("render --help").expect(0).stdout;
    let topics = "Arguments Options Output Image Stopping Integrator|Shadow rays|Shared light subpaths|Layers|\
        Checkpoints and parts|Scene and machine|Debugging Examples";
    let heads = help.lines().filter_map(|line| line.strip_suffix(':'));
    let heads: Vec<_> = heads.filter(|head| !head.starts_with(' ')).collect();
    let of_one_word = |text: &str| text.replace(['|', ' '], "");
    assert_eq!(of_one_word(&heads.concat()), of_one_word(topics));
}

/// The help has no words that readers would have to translate.
#[test]
fn help_is_plain_english() {
    let place = Workplace::new();
    for command in known_flags().keys() {
        for flag in ["-h", "--help"] {
            let help = place.run(&format!("{command} {flag}")).expect(0).stdout;
            for word in [
                "suited",
                "witness",
                "told",
                "tells",
                "shall ",
                "picture ",
                "go on from",
                "gone on",
            ] {
                assert!(!help.contains(word), "{command} {flag} has {word:?}");
            }
            let mut starts = help.lines().map(str::trim_start);
            let has = starts.any(|line| line.starts_with("What ") || line.starts_with("Who "));
            assert!(!has, "{command} {flag}: {help}");
        }
    }
}

#[test]
fn the_page_of_all_flags_is_current() {
    let page = Workplace::new().run("man --markdown").expect(0).stdout;
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/cli.md");
    let written = fs::read_to_string(file).unwrap_or_default();
    assert!(
        page == written,
        "docs/reference/cli.md is out of date: run `just docs`"
    );
    for part in [
        "## bidir farm slurm",
        "| `-o`, `--output <FILE>` |",
        "`BIDIR_SHADOW_RAYS`",
        "`BIDIR_OIDN`",
        "| 143 |",
        "all for bdpt, budget:6 for lvc",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn version_completions_and_manual_are_printed() {
    let place = Workplace::new();
    let version = format!("bidir {} (estimator version ", env!("CARGO_PKG_VERSION"));
    for command in ["", "render", "film info", "farm slurm"] {
        let ran = place.run(&format!("{command} --version")).expect(0);
        assert!(ran.stdout.starts_with(&version), "{}", ran.stdout);
        let number = format!("version {}", bidir::ESTIMATOR_VERSION);
        assert!(ran.stdout.contains(&number), "{}", ran.stdout);
    }
    for shell in ["bash", "zsh", "fish"] {
        place
            .run(&format!("completions {shell}"))
            .expect(0)
            .prints("shadow-rays");
    }
    place.run("man").expect(0).prints(".TH bidir");
    place
        .run("man render")
        .expect(0)
        .prints("shadow\\-rays")
        .prints("BIDIR_TIME")
        .prints(".SH NOTES\n.nf");
    place
        .run("man film info")
        .expect(0)
        .prints("bidir\\-film\\-info");
    place.run("man nothing").expect(2);
}

/// Returns the commands in the code of a page: lines that run bidir, with continued lines joined and
/// comments removed.
fn commands(page: &str) -> Vec<String> {
    let page = page.replace("\\\n", " ");
    let mut fenced = false;
    let mut found = Vec::new();
    for line in page.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
            continue;
        }
        if !fenced && !line.starts_with("    ") {
            continue;
        }
        let line = line.split(" #").next().unwrap_or_default();
        for part in line.split([';', '|']) {
            let words = part.split_whitespace();
            let words: Vec<_> = words
                .skip_while(|word| word.starts_with("BIDIR_"))
                .collect();
            let part = words.join(" ");
            let arguments = ["bidir ", "cargo run --release -- "]
                .iter()
                .find_map(|start| part.strip_prefix(start));
            found.extend(arguments.map(str::to_owned));
        }
    }
    found
}

/// Returns the flags of every command that a page may name, such as `render` or `film info`.
fn known_flags() -> BTreeMap<String, BTreeSet<String>> {
    let place = Workplace::new();
    let mut known = BTreeMap::new();
    let mut open = vec![String::new()];
    while let Some(command) = open.pop() {
        let help = place.run(&format!("{command} --help")).expect(0).stdout;
        let names = help.split("\nCommands:\n").nth(1).unwrap_or_default();
        let names = names.lines().take_while(|line| !line.is_empty());
        let names = names.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
        let names = names.filter_map(|line| line.split_whitespace().next());
        let names = names.filter(|name| *name != "help");
        open.extend(names.map(|name| format!("{command} {name}").trim().to_owned()));
        known.insert(
            command,
            flags(&help).into_iter().map(str::to_owned).collect(),
        );
    }
    known
}

/// Returns the error of a command line of a page. None: its command and flags exist.
fn fault(line: &str, known: &BTreeMap<String, BTreeSet<String>>) -> Option<String> {
    let mut words = line.split_whitespace().peekable();
    let mut command = String::new();
    while let Some(word) = words.peek() {
        let longer = format!("{command} {word}").trim().to_owned();
        if !known.contains_key(&longer) {
            break;
        }
        command = longer;
        words.next();
    }
    let takes_none = ["", "film", "farm"].contains(&&*command);
    if takes_none && words.peek().is_some_and(|word| !word.starts_with('-')) {
        return Some(format!("there is no command `{line}`"));
    }
    // Flags in quotes or behind `--` are for `bidir render`.
    let mut flags = &known[&command];
    for word in words {
        if word == "--" || word.starts_with('\'') {
            flags = &known["render"];
        }
        let flag = word
            .trim_matches('\'')
            .split('=')
            .next()
            .unwrap_or_default();
        if flag.len() > 2 && flag.starts_with("--") && !flags.contains(flag) {
            return Some(format!("`{flag}` is no flag of `{command}`, in `{line}`"));
        }
        if word.ends_with('\'') {
            flags = &known[&command];
        }
    }
    None
}

#[test]
fn pages_name_existing_commands_and_flags() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut pages = vec![root.join("README.md")];
    for folder in ["docs", "docs/guide", "docs/reference"] {
        let entries = fs::read_dir(root.join(folder)).unwrap();
        pages.extend(entries.map(|entry| entry.unwrap().path()));
    }
    pages.retain(|page| page.extension().is_some_and(|ending| ending == "md"));
    let known = known_flags();
    let mut count = 0;
    for page in pages {
        for line in commands(&fs::read_to_string(&page).unwrap()) {
            count += 1;
            assert_eq!(fault(&line, &known), None, "{}", page.display());
        }
    }
    assert!(count > 50, "only {count} commands: the search is broken");
    for wrong in [
        "rendr a.pbrt",
        "render a.pbrt --sppp 4",
        "farm sluurm a.pbrt",
        "merge a --spp 4",
    ] {
        assert!(fault(wrong, &known).is_some(), "{wrong}");
    }
}
