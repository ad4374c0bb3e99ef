//! Job files, run with imitations of the schedulers.

use crate::common::{Ran, Workplace};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A scene whose name has special characters of shells and YAML.
const SCENE: &str = "it's \"my\" $(HOME) {{parts}} room.pbrt";
/// The prefix of its film files.
const NAME: &str = "it's \"my\" $(HOME) {{parts}} room";

/// Prints a job file for that scene, and writes it to `job`.
fn job(place: &Workplace, farm: &str) -> String {
    place.write(SCENE, crate::common::SCENE);
    let mut command = place.command(&format!("farm {farm} --parts 3 --spp 8"));
    let text = Ran::of(command.arg(SCENE)).expect(0).stdout;
    place.write("job", &text);
    text
}

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
    for name in ["SLURM_ARRAY_TASK_ID", "HQ_TASK_ID", "BIDIR_SPP"] {
        command.env_remove(name);
    }
    command
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
fn a_shell_renders_all_parts_or_some_and_makes_the_image() {
    let place = Workplace::new();
    job(&place, "shell");
    Ran::of(&mut shell(&place, &["job", "2", "0"])).expect(0);
    assert!(!place.path(&format!("{NAME}.part-1-of-3.film")).exists());
    // Film files of other jobs or other divisions, with similar names.
    for other in ["-2.part-0-of-3", "-2", ".part-old", ".part-0-of-2", "-old"] {
        place.write(&format!("{NAME}{other}.film"), "");
    }
    let ran = Ran::of(&mut shell(&place, &["job"])).expect(0);
    ran.says("passes 0..8 of 3 files");
    check_image(&place);
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
  echo "$@" >second
  shift 2
  SLURM_ARRAY_TASK_ID=0 sh "$@"
fi
"#;

#[test]
fn slurm_makes_the_image() {
    let place = Workplace::new();
    let text = job(&place, "slurm");
    // Slurm ignores directives after the first command.
    let end = text.find("\nparts=").unwrap();
    assert!(!text[end..].contains("\n#SBATCH"), "{text}");
    install(&place, "sbatch", SBATCH);
    Ran::of(&mut shell(&place, &["job"])).expect(0);
    assert_eq!(
        place.read("second"),
        "--array=0 --dependency=afterok:42 job merge\n"
    );
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

#[test]
fn a_part_of_slurm_is_requeued_when_its_time_is_over_but_not_when_it_is_cancelled() {
    for (signal, is_requeued) in [("USR1", true), ("TERM", false)] {
        let place = Workplace::new();
        job(&place, "slurm");
        install(&place, "bidir", ENDLESS);
        install(&place, "scontrol", r#"echo "$@" >requeued"#);
        let mut part = shell(&place, &["job"]);
        part.env("SLURM_ARRAY_TASK_ID", "1")
            .env("SLURM_JOB_ID", "43");
        let mut part = part.stderr(Stdio::null()).spawn().unwrap();
        let begin = Instant::now();
        while !place.path("started").exists() {
            assert!(begin.elapsed() < Duration::from_secs(20), "no start");
            std::thread::sleep(Duration::from_millis(20));
        }
        // The shell sets its traps after that.
        std::thread::sleep(Duration::from_millis(300));
        let mut ids = vec![part.id().to_string()];
        if signal == "TERM" {
            // Slurm signals every process.
            ids.push(place.read("started").trim().to_owned());
        }
        Ran::of(Command::new("kill").args(["-s", signal]).args(ids)).expect(0);
        assert_eq!(part.wait().unwrap().code(), Some(75));
        assert_eq!(place.read("heard"), "stopped\n");
        assert_eq!(place.path("requeued").exists(), is_requeued, "{signal}");
    }
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
fn hyperqueue_makes_the_image_of_all_parts() {
    let place = Workplace::new();
    job(&place, "hyperqueue");
    install(&place, "hq", HQ);
    let part = format!("{NAME}.part-1-of-3.film");
    place.write(&part, "this is no film");
    let ran = Ran::of(&mut shell(&place, &["job"])).expect(1);
    ran.says("parts 1 of job 7 are not done");
    for file in [&part, "failed"] {
        fs::remove_file(place.path(file)).unwrap();
    }
    Ran::of(&mut shell(&place, &["job"])).expect(0);
    check_image(&place);
}

#[test]
fn kubernetes_makes_the_image() {
    let place = Workplace::new();
    let text = job(&place, "k8s");
    let (_, script) = text.split_once("            - |\n").unwrap();
    let script: String = script.split("          resources:").take(1).collect();
    for index in ["0", "1", "2"] {
        let mut part = shell(&place, &["-c", &script]);
        Ran::of(part.env("JOB_COMPLETION_INDEX", index)).expect(0);
    }
    let last = text
        .lines()
        .filter_map(|line| line.strip_prefix("#   bidir "));
    let last: Vec<_> = last.map(|command| format!("bidir {command}")).collect();
    Ran::of(&mut shell(&place, &["-c", &last.join(" && ")])).expect(0);
    check_image(&place);
}
