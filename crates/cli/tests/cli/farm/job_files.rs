//! What job files say.

use super::{check_lines, job};
use crate::common::{Ran, Workplace};

const ENV_RENDER: &str = "bidir render scenes/room.pbrt --part env/8 --spp 64 --checkpoint ";
const FLAGS: &str = "scenes/room.pbrt --parts 8 --spp 64 -o out/room.exr -- --mis power";

/// What every job ends with.
const LAST: [&str; 2] = [
    "bidir merge out/room.part-[0-9]*-of-8.film -o out/room.film",
    "bidir film develop out/room.film -o out/room.exr",
];

/// The job file of a room in eight shares.
fn room(farm: &str) -> String {
    let run = Workplace::new().run(&format!("farm {farm} {FLAGS}"));
    run.expect(0).stdout
}

#[test]
fn a_job_file_for_slurm_says_what_is_started() {
    let text = room("slurm");
    let render = format!("{ENV_RENDER}out/room.part-\"$part\"-of-8.film --resume --mis power &");
    let wrap = format!("    --wrap='{} && {}'", LAST[0], LAST[1]);
    check_lines(&text, &[&render, &wrap]);
    for directive in [
        "--job-name=room",
        "--array=0-7",
        "--requeue",
        "--signal=B:USR1@120",
    ] {
        check_lines(&text, &[&format!("#SBATCH {directive}")]);
    }
    // Slurm reads no further than to the first command.
    let is_directive = |line: &&str| line.starts_with("#SBATCH");
    let head = text
        .lines()
        .take_while(|line| line.is_empty() || line.starts_with('#'));
    let all = text.lines().filter(is_directive).count();
    assert_eq!(head.filter(is_directive).count(), all, "{text}");
}

#[test]
fn a_job_file_for_hyperqueue_says_what_is_started() {
    let text = room("hyperqueue");
    let render =
        format!("exec {ENV_RENDER}out/room.part-\"$HQ_TASK_ID\"-of-8.film --resume --mis power");
    let submit = "  job=$(hq --output-mode=quiet submit --name=room --array=0-7 -- sh \"$0\")";
    let [merge, develop] = LAST.map(|command| format!("  {command}"));
    check_lines(&text, &[&render, submit, &merge, &develop]);
}

#[test]
fn a_job_file_for_kubernetes_says_what_is_started() {
    let [merge, develop] = LAST.map(|command| format!("#   {command}"));
    check_lines(
        &room("k8s"),
        &[
            "  completions: 8",
            "  parallelism: 8",
            "  completionMode: Indexed",
            "  name: room",
            "            - \"env/8\"",
            "            - \"out/room.part-$(JOB_COMPLETION_INDEX)-of-8.film\"",
            &merge,
            &develop,
        ],
    );
}

#[test]
fn a_job_file_for_a_shell_says_what_is_started() {
    let render = "  bidir render scenes/room.pbrt --part \"$part\"/8 --spp 64 \
                  --checkpoint out/room.part-\"$part\"-of-8.film --resume --mis power";
    let [merge, develop] = LAST.map(|command| format!("  {command}"));
    check_lines(
        &room("shell"),
        &[render, &merge, &develop, "  while [ \"$share\" -lt 8 ]; do"],
    );
}

/// Arguments, and what is said of them.
const FAULTS: [(&str, &str); 19] = [
    ("", "slurm"),
    ("slurm room.pbrt", "--parts"),
    (
        "slurm room.pbrt --parts 0",
        "`0` is not a whole number from 1 to 100000",
    ),
    ("slurm room.pbrt --parts 8 --spp 4", "some would have none"),
    ("pbs room.pbrt --parts 8", "pbs"),
    ("shell - --parts 8", "standard input cannot be shared"),
    (
        "shell room.pbrt --parts 8 -o room.png",
        "output images are .exr",
    ),
    (
        "shell room.pbrt --parts 8 -- --display-server host",
        "--display-server cannot be given after `--`",
    ),
    (
        "shell room.pbrt --parts 8 -- --integrator photon",
        "[possible values: path, light, bdpt, lvc, auto]",
    ),
    (
        "shell room.pbrt --parts 8 -o room.part-2.exr",
        "named like a part",
    ),
    (
        "shell room.pbrt --parts 8 -- --spp 4",
        "--spp cannot be given after `--`: give it before",
    ),
    (
        "shell room.pbrt --parts 8 --spp 64 -- --mis power --spp=4",
        "--spp cannot be given",
    ),
    (
        "shell room.pbrt --parts 8 -- --passes 0..4",
        "--passes cannot be given",
    ),
    (
        "shell room.pbrt --parts 8 -- --part 0/4",
        "--part cannot be given",
    ),
    (
        "shell room.pbrt --parts 8 -- --checkpoint a.film",
        "--checkpoint cannot be given",
    ),
    (
        "shell room.pbrt --parts 8 -- --restart",
        "--restart cannot be given",
    ),
    (
        "shell room.pbrt --parts 8 -- -o a.exr",
        "--output cannot be given",
    ),
    (
        "shell room.pbrt --parts 8 -- --stats a.json",
        "--stats cannot be given",
    ),
    (
        "shell room.pbrt --parts 8 -- --replay 1,1,1",
        "--replay cannot be given",
    ),
];

#[test]
fn faults_are_told_before_anything_is_printed() {
    let place = Workplace::new();
    for (arguments, says) in FAULTS {
        let ran = place.run(&format!("farm {arguments}")).expect(2).says(says);
        assert_eq!(ran.stdout, "", "{arguments}");
    }
}

#[test]
fn variables_here_are_no_flags_of_the_job() {
    let place = Workplace::new();
    let mut command =
        place.command("farm shell room.pbrt --parts 8 -- --mis power --checkpoint-every 1m");
    command.env("BIDIR_SPP", "4").env("BIDIR_TIME", "1h");
    let text = Ran::of(&mut command).expect(0).stdout;
    assert!(text.contains("--mis power --checkpoint-every 1m") && !text.contains("--spp"));
}

#[test]
fn strings_of_yaml_are_quoted() {
    let place = Workplace::new();
    let text = job(&place, "k8s", "--parts 5");
    check_lines(
        &text,
        &[
            "  completions: 5",
            "  name: it-s--my----home--room",
            r#"            - "it's \"my\" $$(HOME) room.pbrt""#,
            r#"            - "it's \"my\" $$(HOME) room.part-$(JOB_COMPLETION_INDEX)-of-5.film""#,
        ],
    );
}
