//! Writers that are killed, that compete with another, or whose disk is full.

use crate::common::Workplace;
use std::fs;
use std::process::Stdio;
use std::time::{Duration, Instant, SystemTime};

#[test]
fn leftovers_of_killed_writers_are_removed() {
    let place = Workplace::new();
    // Nobody else writes a film whose lock a writer has; an image has none, and its leftovers show by age.
    let old = SystemTime::now() - Duration::from_secs(2 * 60 * 60);
    for name in ["a.film", "a.film.previous", "b.film", "b.exr", "b.png"] {
        let left = fs::File::create(place.path(&format!(".{name}.bidir-aB3dE6.tmp"))).unwrap();
        if !name.contains("film") {
            left.set_modified(old).unwrap();
        }
    }
    place.render_share("0..1", "a.film");
    place.run("film develop a.film -o b.exr").expect(0);
    place.run("film develop a.film -o b.png").expect(0);
    place.run("merge a.film -o c.film").expect(0);
    place.run("merge a.film -o /dev/null").expect(0);
    let other = ".b.film.bidir-aB3dE6.tmp";
    let names = [other, "a.film", "b.exr", "b.png", "c.film", "room.pbrt"];
    assert_eq!(place.names(), names);
}

#[cfg(unix)]
#[test]
fn a_file_that_grows_beyond_its_limit_is_an_error() {
    let place = Workplace::new();
    let program = env!("CARGO_BIN_EXE_bidir");
    let limited = |arguments: &str| {
        let script = format!("ulimit -f 1; exec {program} {arguments}");
        let mut shell = std::process::Command::new("sh");
        let shell = shell.args(["-c", &script]).current_dir(place.path(""));
        crate::common::Ran::of(shell)
    };
    let says = "larger than the system allows";
    let render = "render room.pbrt -q --spp 1 -o";
    limited(&format!("{render} a.exr")).expect(4).says(says);
    let film = format!("{render} a.png --size 4x4 --checkpoint a.film");
    limited(&film).expect(4).says("a.film").says(says);
    place.render_share("0..1", "b.film");
    let before = fs::read(place.path("b.film")).unwrap();
    limited("merge b.film -o b.film").expect(4).says("b.film");
    assert_eq!(fs::read(place.path("b.film")).unwrap(), before);
    assert_eq!(place.names(), ["a.png", "b.film", "room.pbrt"]);
}

#[test]
fn two_writers_of_one_film_are_kept_apart() {
    let place = Workplace::new();
    let render = "render room.pbrt -q --time 20s --threads 1 --checkpoint a.film";
    let mut first = place.command(render).stderr(Stdio::null()).spawn().unwrap();
    let lock = place.path("a.film.lock");
    while !lock.exists() {
        std::thread::sleep(Duration::from_millis(5));
    }
    // The lock is taken right after the file is created.
    std::thread::sleep(Duration::from_millis(200));
    place
        .run(render)
        .expect(4)
        .says("another process is writing this file");
    place.render_share("0..1", "b.film");
    place
        .run("merge b.film -o a.film")
        .expect(4)
        .says("another process is writing this file");
    first.kill().unwrap();
    first.wait().unwrap();
    // A killed process holds no lock.
    place
        .run("render room.pbrt -q --spp 1 --checkpoint a.film --restart")
        .expect(0);
}

/// Number of times that a render is killed; `tools/attack` kills many more.
const KILLS: u64 = 3;

#[test]
fn a_killed_render_continues_to_the_same_bits() {
    let place = Workplace::new();
    let passes = 50 * KILLS;
    let render = format!("render room.pbrt -q --size 96x64 --spp {passes}");
    let start = Instant::now();
    place.run(&format!("{render} -o whole.exr")).expect(0);
    // All killed runs together take about half as long, whatever the load of the machine.
    let share = start.elapsed().div_f64(KILLS as f64);
    let resumed = format!("{render} --checkpoint a.film --resume -o a.exr");
    let often = format!("{resumed} --checkpoint-every 0.001s");
    for kill in 0..KILLS {
        let mut child = place.command(&often).spawn().unwrap();
        let moment = 0.2 + 0.6 * (kill * 7919 % 140) as f64 / 140.0;
        std::thread::sleep(share.mul_f64(moment));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    // The last run renders only the passes that the killed ones did not.
    let info = place.run("film info a.film --json").expect(0).json();
    let before = info["counts"]["samples"].as_u64().unwrap();
    assert!(before > 0 && before < passes * 96 * 64, "{before} samples");
    place.run(&format!("{resumed} --stats a.json")).expect(0);
    let stats: serde_json::Value = serde_json::from_str(&place.read("a.json")).unwrap();
    assert_eq!(
        stats["samples"].as_u64().unwrap() + before,
        passes * 96 * 64
    );
    place.expect_same("a.exr", "whole.exr");
    // The last run removed the leftovers of killed writers.
    let names = "a.exr a.film a.film.previous a.json a.png room.pbrt whole.exr whole.png";
    assert_eq!(place.names().join(" "), names);
}

/// A disk of limited size, unmounted at the end. None: this process may not mount one.
#[cfg(target_os = "linux")]
struct SmallDisk(std::path::PathBuf);

#[cfg(target_os = "linux")]
impl SmallDisk {
    fn new(place: &Workplace, kibibytes: u32) -> Option<Self> {
        let folder = place.path("disk");
        fs::create_dir(&folder).unwrap();
        let size = format!("size={kibibytes}k");
        let mut mount = std::process::Command::new("mount");
        mount
            .args(["-t", "tmpfs", "-o", &size, "tmpfs"])
            .arg(&folder)
            .stderr(Stdio::null());
        let mounted = mount.status().is_ok_and(|status| status.success());
        mounted.then_some(Self(folder))
    }
}

#[cfg(target_os = "linux")]
impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = std::process::Command::new("umount").arg(&self.0).status();
    }
}

#[cfg(target_os = "linux")]
#[test]
#[allow(clippy::print_stderr, reason = "a skipped test says so")]
fn a_full_disk_loses_nothing() {
    let place = Workplace::new();
    let Some(_disk) = SmallDisk::new(&place, 64) else {
        eprintln!("skipped: a small disk cannot be mounted here");
        return;
    };
    place.render_share("0..1", "disk/a.film");
    place
        .run("render room.pbrt -q --spp 2 --checkpoint disk/a.film --resume")
        .expect(0);
    let before = fs::read(place.path("disk/a.film")).unwrap();
    fs::write(place.path("disk/filler"), vec![1; 60 << 10]).unwrap_err();
    let previous = fs::read(place.path("disk/a.film.previous")).unwrap();
    let resume = "render room.pbrt -q --spp 4 --checkpoint disk/a.film --resume";
    place.run(resume).expect(4).says("disk/a.film");
    assert_eq!(fs::read(place.path("disk/a.film")).unwrap(), before);
    assert_eq!(
        fs::read(place.path("disk/a.film.previous")).unwrap(),
        previous
    );
    fs::remove_file(place.path("disk/filler")).unwrap();
    place.run(resume).expect(0);
}
