//! The text of job files.

use super::{check_lines, job};
use crate::common::{Ran, Workplace};

#[test]
fn job_files_have_the_commands_of_all_steps() {
    let place = Workplace::new();
    let arguments = "scenes/room.pbrt --parts 8 --spp 64 -o out/room.exr -- --mis power";
    let share = |number: &str| format!("--checkpoint out/room.part-{number}-of-8.film --resume");
    let item = |word: &str| format!("            - \"{word}\"\n");
    let words = "--part env/8 --spp 64 --checkpoint out/room.part-$(JOB_COMPLETION_INDEX)-of-8.film \
                 --resume --mis power";
    for (farm, part, share) in [
        ("slurm", "env", share("\"$part\"")),
        ("hyperqueue", "env", share("\"$HQ_TASK_ID\"")),
        ("shell", "\"$part\"", share("\"$part\"")),
    ] {
        let render =
            format!("bidir render scenes/room.pbrt --part {part}/8 --spp 64 {share} --mis power");
        place
            .run(&format!("farm {farm} {arguments}"))
            .prints(&render);
    }
    let items: String = words.split(' ').map(item).collect();
    place.run(&format!("farm k8s {arguments}")).prints(&items);
}

#[test]
fn all_directives_of_slurm_precede_the_first_command() {
    let ran = Workplace::new().run("farm slurm room.pbrt --parts 8");
    let text = ran.expect(0).stdout;
    check_lines(&text, &["#SBATCH --job-name=room", "#SBATCH --array=0-7"]);
    // Slurm ignores directives after the first command.
    let is_directive = |line: &&str| line.starts_with("#SBATCH");
    let is_comment = |line: &&str| line.is_empty() || line.starts_with('#');
    let head = text.lines().take_while(is_comment);
    let all = text.lines().filter(is_directive).count();
    assert_eq!(head.filter(is_directive).count(), all, "{text}");
}

/// Wrong arguments, and a part of the message after `=>`.
const WRONG: &str = "\
slurm room.pbrt => --parts
slurm room.pbrt --parts 0 => `0` is not a whole number from 1 to 100000
slurm room.pbrt --parts 8 --spp 4 => some would have none
pbs room.pbrt --parts 8 => pbs
shell - --parts 8 => standard input cannot be shared
shell room.pbrt --parts 8 -o room.png => output images are .exr
shell room.pbrt --parts 8 -o .exr => output images are .exr
shell room.pbrt --parts 8 -o room.part-2.exr => named like a part
shell room.pbrt --parts 8 -o a.part-x.part-0-of-8.exr => named like a part
shell room.pbrt --parts 8 -o a\u{7}.exr => has control characters
shell room.pbrt --parts 8 -- --integrator photon => `photon` is not one of path, light, bdpt, lvc, auto
shell room.pbrt --parts 8 -- --bogus => see `bidir render --help`
shell room.pbrt --parts 8 -- --spp 4 => --spp cannot be given after `--`: give it before
shell room.pbrt --parts 8 --spp 64 -- --mis power --spp=4 => --spp cannot be given
shell room.pbrt --parts 8 -- --display-server host => --display-server cannot be given after `--`
shell room.pbrt --parts 8 -- --passes 0..4 => --passes cannot be given
shell room.pbrt --parts 8 -- --part 0/4 => --part cannot be given
shell room.pbrt --parts 8 -- --checkpoint a.film => --checkpoint cannot be given
shell room.pbrt --parts 8 -- --resume => --resume cannot be given
shell room.pbrt --parts 8 -- --restart => --restart cannot be given
shell room.pbrt --parts 8 -- -o a.exr => --output cannot be given
shell room.pbrt --parts 8 -- --stats a.json => --stats cannot be given
shell room.pbrt --parts 8 -- --pyramid=pyx --size 8x8 => --pyramid cannot be given after `--`: all parts would
slurm room.pbrt --parts 8 -- --pyramid pyx => --pyramid cannot be given
k8s room.pbrt --parts 8 -- --replay 1,1,1 --svg a.svg => cannot be given after `--`: all parts would write it
hyperqueue room.pbrt --parts 8 -- --denoise => --denoise cannot be given after `--`: parts write film files
shell room.pbrt --parts 8 -- --outfile a.exr => --output cannot be given
shell room.pbrt --parts 8 -- --json => --json cannot be given
shell room.pbrt --parts 8 -- --help => parts cannot print texts instead of rendering
shell room.pbrt --parts 8 -- other.pbrt => unexpected argument `other.pbrt`
shell room.pbrt --parts 8 -- --spp4 => there is no flag `--spp4`
shell room.pbrt --parts 8 -- --serve 80 => --serve cannot be given
shell room.pbrt --parts 8 -- --replay 1,1,1 => --replay cannot be given
shell room.pbrt --parts 8 -- --time 1h => --time cannot be given
shell room.pbrt --parts 8 -- --noise 0.1 => --noise cannot be given";

#[test]
fn wrong_input_is_refused_before_anything_is_printed() {
    let place = Workplace::new();
    for line in WRONG.lines() {
        let (arguments, says) = line.split_once(" => ").unwrap();
        let ran = place.run(&format!("farm {arguments}")).expect(2).says(says);
        assert_eq!(ran.stdout, "", "{arguments}");
    }
}

#[test]
fn variables_of_this_machine_do_not_affect_the_job() {
    let place = Workplace::new();
    let mut command =
        place.command("farm shell room.pbrt --parts 8 -- --mis power --checkpoint-every 1m");
    command.env("BIDIR_SPP", "4").env("BIDIR_TIME", "1h");
    let text = Ran::of(&mut command).expect(0).stdout;
    assert!(text.contains("--mis power --checkpoint-every 1m") && !text.contains("--spp"));
}

#[test]
fn braces_in_a_name_are_no_placeholders() {
    let place = Workplace::new();
    let ran = place.run("farm shell {{parts}}.pbrt --parts 8");
    ran.prints(
        "bidir render '{{parts}}.pbrt' --part \"$part\"/8 --checkpoint '{{parts}}.part-'\"$part\"",
    );
}

#[test]
fn names_of_kubernetes_objects_are_valid_labels() {
    let text = job(&Workplace::new(), "k8s", "--parts 5");
    check_lines(
        &text,
        &["  completions: 5", "  name: it-s--my----home--room"],
    );
}
