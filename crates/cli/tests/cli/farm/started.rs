//! Runs jobs with imitations of the schedulers.

use super::{NAME, check_lines, job};
use crate::common::{Ran, Workplace};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Puts a program into the folder `bin`.
fn install(place: &Workplace, name: &str, script: &str) {
    let folder = place.path("bin");
    fs::create_dir_all(&folder).unwrap();
    let file = folder.join(name);
    fs::write(&file, format!("#!/bin/sh\n{script}")).unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o755)).unwrap();
}

/// Returns a shell that finds the programs in `bin`, then the real `bidir`.
fn shell(place: &Workplace, arguments: &[&str]) -> Command {
    let bidir = Path::new(env!("CARGO_BIN_EXE_bidir")).parent().unwrap();
    let path = std::env::var_os("PATH").unwrap();
    let folders = [place.path("bin"), bidir.to_owned()].into_iter();
    let folders = folders.chain(std::env::split_paths(&path));
    let mut command = Command::new("sh");
    command.args(arguments).current_dir(place.path(""));
    command.env("PATH", std::env::join_paths(folders).unwrap());
    let foreign = ["BIDIR_", "SLURM_", "HQ_", "JOB_"];
    for (name, _) in std::env::vars_os() {
        let text = name.to_string_lossy();
        if foreign.iter().any(|start| text.starts_with(start)) {
            command.env_remove(&name);
        }
    }
    command
}

/// Writes a job of three parts, and checks its syntax.
fn job_of_three(place: &Workplace, farm: &str) {
    job(place, farm, "--parts 3 --spp 8");
    Ran::of(&mut shell(place, &["-n", "job"])).expect(0);
}

/// Checks that the image has the bits of an undivided render.
#[track_caller]
fn check_image(place: &Workplace) {
    place
        .run("render room.pbrt --spp 8 -q -o whole.exr")
        .expect(0);
    let mut compare = place.command("compare whole.exr");
    Ran::of(compare.arg(format!("{NAME}.exr")).arg("--exact")).expect(0);
}

#[test]
fn a_shell_makes_the_image() {
    let place = Workplace::new();
    job_of_three(&place, "shell");
    Ran::of(&mut shell(&place, &["job"]))
        .expect(0)
        .says("passes 0..8 of 3 files");
    check_image(&place);
}

#[test]
fn several_machines_render_parts_by_number() {
    let place = Workplace::new();
    job_of_three(&place, "shell");
    Ran::of(&mut shell(&place, &["job", "2", "0"])).expect(0);
    assert!(!place.path(&format!("{NAME}.part-1-of-3.film")).exists());
    // Film files of other jobs or other divisions, with similar names.
    for other in ["-2.part-0-of-3", "-2", ".part-old", ".part-0-of-2", "-old"] {
        place.write(&format!("{NAME}{other}.film"), "");
    }
    Ran::of(&mut shell(&place, &["job", "1", "merge"])).expect(0);
    check_image(&place);
    Ran::of(&mut shell(&place, &["job", "9"]))
        .expect(2)
        .says("--part");
}

/// Imitates Slurm with an array of three, and with a job of one command.
const SBATCH: &str = r#"
if [ "$1" = --parsable ]; then
  export SLURM_ARRAY_TASK_MIN=0 SLURM_ARRAY_TASK_COUNT=3
  for SLURM_ARRAY_TASK_ID in 0 1 2; do
    export SLURM_ARRAY_TASK_ID
    sh "$2" || exit
  done
  echo '42;cluster'
else
  printf '%s\n' "$@" >second
  for word; do command=$word; done
  sh -c "${command#--wrap=}"
fi
"#;

#[test]
fn slurm_makes_the_image() {
    let place = Workplace::new();
    job_of_three(&place, "slurm");
    install(&place, "sbatch", SBATCH);
    Ran::of(&mut shell(&place, &["job"])).expect(0);
    check_lines(&place.read("second"), &["--dependency=afterok:42"]);
    check_image(&place);
    let mut part = shell(&place, &["job"]);
    part.env("SLURM_ARRAY_TASK_ID", "2")
        .env("SLURM_ARRAY_TASK_COUNT", "1");
    Ran::of(&mut part).expect(2).says("submit the whole array");
}

/// An endless render, which a signal stops with a film file.
const ENDLESS: &str = r"
trap 'echo stopped >>heard; exit 75' TERM
echo $$ >started.part
mv started.part started
while :; do sleep 0.02; done
";

/// Starts a part by Slurm, and waits until it renders.
fn start_part(place: &Workplace) -> Child {
    job(place, "slurm", "--parts 3");
    install(place, "bidir", ENDLESS);
    install(place, "scontrol", r#"echo "$@" >requeued"#);
    let mut part = shell(place, &["job"]);
    part.env("SLURM_ARRAY_TASK_ID", "1")
        .env("SLURM_JOB_ID", "43");
    let child = part.stderr(Stdio::null()).spawn().unwrap();
    let begin = Instant::now();
    while !place.path("started").exists() {
        assert!(begin.elapsed() < Duration::from_secs(20), "no start");
        std::thread::sleep(Duration::from_millis(20));
    }
    // The shell sets its traps after that.
    std::thread::sleep(Duration::from_millis(300));
    child
}

fn send(signal: &str, id: &str) {
    Ran::of(Command::new("kill").args(["-s", signal, id])).expect(0);
}

#[test]
fn a_part_of_slurm_is_requeued_when_its_time_is_over() {
    let place = Workplace::new();
    let mut part = start_part(&place);
    send("USR1", &part.id().to_string());
    assert_eq!(part.wait().unwrap().code(), Some(75));
    assert_eq!(place.read("heard"), "stopped\n");
    assert_eq!(place.read("requeued"), "requeue 43\n");
}

#[test]
fn a_cancelled_part_of_slurm_is_not_requeued() {
    let place = Workplace::new();
    let mut part = start_part(&place);
    // Slurm signals every process.
    send("TERM", &part.id().to_string());
    send("TERM", place.read("started").trim());
    assert_eq!(part.wait().unwrap().code(), Some(75));
    assert_eq!(place.read("heard"), "stopped\n");
    assert!(!place.path("requeued").exists());
}

/// Imitates HyperQueue with a task array of three.
const HQ: &str = r#"
case "$*" in
  --output-mode=quiet\ submit*)
    while [ "$1" != -- ]; do shift; done
    shift
    for HQ_TASK_ID in 0 1 2; do
      export HQ_TASK_ID
      "$@" || echo "$HQ_TASK_ID" >>failed
    done
    echo 7
    ;;
  "job wait 7") ;;
  "job task-ids 7 --filter=failed,canceled") cat failed 2>/dev/null || : ;;
  *) exit 1 ;;
esac
"#;

#[test]
fn hyperqueue_makes_the_image() {
    let place = Workplace::new();
    job_of_three(&place, "hyperqueue");
    install(&place, "hq", HQ);
    Ran::of(&mut shell(&place, &["job"])).expect(0);
    check_image(&place);
}

#[test]
fn hyperqueue_makes_no_image_without_all_parts() {
    let place = Workplace::new();
    job_of_three(&place, "hyperqueue");
    install(&place, "hq", HQ);
    place.write(&format!("{NAME}.part-1-of-3.film"), "this is no film");
    let ran = Ran::of(&mut shell(&place, &["job"])).expect(1);
    ran.says("parts 1 of job 7 are not done");
    assert!(!place.path(&format!("{NAME}.exr")).exists());
}

/// Expands a string of a command as Kubernetes does.
fn expanded(line: &str, index: &str) -> String {
    let text: String = serde_json::from_str(line).unwrap();
    let parts = text
        .split("$$")
        .map(|part| part.replace("$(JOB_COMPLETION_INDEX)", index));
    parts.collect::<Vec<_>>().join("$")
}

#[test]
fn kubernetes_makes_the_image() {
    let place = Workplace::new();
    let text = job(&place, "k8s", "--parts 3 --spp 8");
    let words = text
        .lines()
        .filter_map(|line| line.strip_prefix("            - \""));
    let words: Vec<_> = words.map(|word| format!("\"{word}")).collect();
    for index in ["0", "1", "2"] {
        let words: Vec<_> = words.iter().map(|word| expanded(word, index)).collect();
        assert_eq!(words[0], "bidir");
        let mut command = place.command("");
        command.args(&words[1..]).env("JOB_COMPLETION_INDEX", index);
        Ran::of(&mut command).expect(0);
    }
    let last: Vec<_> = text
        .lines()
        .filter_map(|line| line.strip_prefix("#   bidir "))
        .collect();
    let last = format!("bidir {} && bidir {}", last[0], last[1]);
    Ran::of(&mut shell(&place, &["-c", &last])).expect(0);
    check_image(&place);
}
