//! Commands to which the system refuses threads or memory.

use crate::common::{Ran, Workplace};
use std::fs;
use std::process::Command;

/// A size of stacks beyond the address space, so that no thread can start.
const NO_THREAD: (&str, &str) = ("RUST_MIN_STACK", "1152921504606846976");

impl Workplace {
    /// Runs a command that cannot start threads.
    fn alone(&self, arguments: &str) -> Ran {
        let mut command = self.command(arguments);
        Ran::of(command.env(NO_THREAD.0, NO_THREAD.1))
    }

    /// Runs a command with limited memory. Unit: KiB.
    fn within(&self, kib: u32, arguments: &str) -> Ran {
        let command = self.command(arguments);
        let mut limited = Command::new("sh");
        limited
            .args(["-c", &format!("ulimit -v {kib}; exec \"$0\" \"$@\"")])
            .arg(command.get_program())
            .args(command.get_args())
            .current_dir(self.path(""));
        Ran::of(&mut limited)
    }
}

#[test]
#[cfg(target_os = "linux")]
fn without_threads_the_calling_thread_does_all() {
    let place = Workplace::new();
    place
        .run("render room.pbrt -o a.exr --checkpoint a.film --seed 3")
        .expect(0);
    let warning = "warning: the system starts no thread (";
    let render = "render room.pbrt -o b.exr --checkpoint b.film --progress bar --seed 3";
    let ran = place.alone(render).expect(0).says(warning);
    assert_eq!(ran.stderr.matches("warning").count(), 1, "{}", ran.stderr);
    let pixels = |name| fs::read(place.path(name)).unwrap();
    place.run("compare a.exr b.exr --exact").expect(0);
    assert!(!pixels("b.film").is_empty());
    for command in [
        "info room.pbrt",
        "film verify b.film",
        "film develop b.film -o c.exr",
        "merge a.film -o d.film",
        "missing a.film --spp 2",
        "compare a.exr b.exr --flip",
        "tonemap a.exr -o a.png",
        "reference room.pbrt -o folder --spp 32",
    ] {
        place.alone(command).expect(0).says(warning);
    }
    let view = place.alone("view room.pbrt --port 0").expect(1);
    view.says("the server cannot start: ");
    let shown = "render room.pbrt -o b.exr --display-server 127.0.0.1:1";
    let shown = place.alone(shown).expect(1);
    shown.says("--display-server cannot start: ");
}

#[test]
fn threads_beyond_four_per_processor_are_not_started() {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let most = 4 * processors;
    if most >= 1024 {
        return;
    }
    let place = Workplace::new();
    let warning = format!("warning: {most} threads instead of 1024: ");
    let render = "render room.pbrt -o a.exr --stats a.json --spp 1";
    place
        .run(&format!("{render} --threads 1024"))
        .expect(0)
        .says(&warning);
    let stats: serde_json::Value = serde_json::from_str(&place.read("a.json")).unwrap();
    assert_eq!(stats["threads"], most, "{stats}");
    let mut command = place.command(render);
    Ran::of(command.env("BIDIR_THREADS", "1024"))
        .expect(0)
        .says(&warning);
    let few = place.run(&format!("{render} --threads {most}")).expect(0);
    assert!(!few.stderr.contains("warning"), "{}", few.stderr);
    place.write("a.toml", &DESCRIPTION.replace("THREADS", "1024"));
    let ran = place.run("experiment a.toml -o out").expect(0);
    ran.says(&warning);
    let results: serde_json::Value = serde_json::from_str(&place.read("out/results.json")).unwrap();
    assert_eq!(results["machine"]["threads"], most, "{results}");
}

/// An experiment that takes no time.
const DESCRIPTION: &str = r#"
title = "t"
size = "4x3"
seeds = 2
threads = THREADS
[[scene]]
file = "room.pbrt"
reference-spp = 32
[[method]]
name = "a"
integrator = "bdpt"
[[budget]]
samples = 1
"#;

#[test]
#[cfg(target_os = "linux")]
fn errors_of_memory_have_the_number_of_bytes() {
    let place = Workplace::new();
    let large = place
        .within(400_000, "render room.pbrt --size 4000x4000 -o a.exr")
        .expect(3);
    let bytes = 4000_u64 * 4000 * 9 * 16;
    large.says(&format!(
        "a film of 4000 x 4000 pixels is too large: the system does not have the {bytes} bytes of memory \
         that it needs"
    ));
    assert!(!place.path("a.exr").exists());
}
