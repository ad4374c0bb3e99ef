use crate::common::{Ran, Workplace};
use std::fs;
use std::process::Stdio;
use std::time::Duration;

impl Workplace {
    /// Renders a share of seven passes into a film file.
    fn render_share(&self, share: &str, film: &str) -> Ran {
        self.run(&format!(
            "render room.pbrt --passes {share} -q --checkpoint {film}"
        ))
        .expect(0)
    }

    #[track_caller]
    fn expect_same(&self, a: &str, b: &str) {
        self.run(&format!("compare {a} {b} --exact")).expect(0);
    }
}

#[test]
fn merged_shares_in_any_order_are_the_whole() {
    let place = Workplace::new();
    for estimator in ["path", "light", "bdpt", "bdpt --shadow-rays ray-roulette"] {
        let render = format!("render room.pbrt --integrator {estimator} --spp 7 -q");
        place.run(&format!("{render} -o whole.exr")).expect(0);
        for (parts, order) in [
            (1, vec![0]),
            (3, vec![2, 0, 1]),
            (7, vec![3, 6, 0, 5, 1, 4, 2]),
        ] {
            let mut films = String::new();
            for part in order {
                let film = format!("{parts}-{part}.film");
                let share = format!("{render} --part {part}/{parts} --checkpoint {film} --restart");
                place.run(&share).expect(0);
                films = films + " " + &film;
            }
            place
                .run(&format!("merge{films} -o all.film --image all.exr"))
                .expect(0);
            place.expect_same("all.exr", "whole.exr");
        }
    }
    // A share by itself writes no image that others would overwrite.
    assert!(!place.path("room.exr").exists());
}

#[test]
fn what_is_missing_is_told() {
    let place = Workplace::new();
    place.render_share("0..2", "a.film");
    place.render_share("3..5", "b.film");
    let missing = "missing a.film b.film --spp 8";
    place.run(missing).expect(6).prints("2..3\n5..8\n");
    place
        .run(&format!("{missing} --parts 4"))
        .expect(6)
        .prints("1/4\n2/4\n3/4\n");
    let json = place
        .run(&format!("{missing} --parts 4 --json"))
        .expect(6)
        .json();
    assert_eq!(json["passes"][1], "5..8");
    place.run("missing a.film --spp 2").expect(0);
    // A file that is not there has no passes; one that cannot be merged is refused.
    place
        .run("missing a.film none.film --spp 2")
        .expect(0)
        .says("none.film");
    place.render_share("2..4 --seed 5", "seed.film");
    place
        .run("missing a.film seed.film --spp 4")
        .expect(5)
        .says("seed is 5");
}

#[test]
fn films_that_do_not_belong_together_are_refused() {
    let place = Workplace::new();
    place.render_share("0..2", "a.film");
    place.render_share("1..3", "overlap.film");
    place.render_share("2..4 --seed 5", "seed.film");
    place.render_share("2..4 --crop 0,0,8,8", "crop.film");
    place.write(
        "room.pbrt",
        &place.read("room.pbrt").replace("[9 8 7]", "[9 8 6]"),
    );
    place.render_share("2..4", "scene.film");
    for (film, reason) in [
        ("a", "both have the passes 0..2"),
        ("overlap", "both have the passes 1..2"),
        ("seed", "seed is 5 here and 0 there"),
        ("crop", "crop is 0,0,8,8 here and 0,0,24,16 there"),
        ("scene", "scene-digest is "),
    ] {
        place
            .run(&format!("merge a.film {film}.film -o all.film"))
            .expect(5)
            .says(reason);
    }
    assert!(!place.path("all.film").exists());
    let resumed = "render room.pbrt --spp 8 --checkpoint a.film --resume";
    place
        .run(resumed)
        .expect(5)
        .says("the film of another render");
}

#[test]
fn damaged_files_are_told_and_the_one_before_is_named() {
    let place = Workplace::new();
    place.render_share("0..2", "a.film");
    let resume = "render room.pbrt -q --spp 4 --checkpoint a.film --resume -o a.exr";
    place.run(resume).expect(0);
    let whole = fs::read(place.path("a.film")).unwrap();
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 4;
    let foreign = fs::read(place.path("a.exr")).unwrap();
    for bytes in [&whole[..whole.len() - 9], &flipped, &foreign, &[]] {
        fs::write(place.path("a.film"), bytes).unwrap();
        place.run(resume).expect(4).says("a.film.previous");
        place.run("film verify a.film").expect(4);
        assert_eq!(fs::read(place.path("a.film")).unwrap(), bytes);
    }
    place
        .run("film verify a.film.previous")
        .expect(0)
        .says("passes 0..2");
    place.run("film develop a.film -o b.exr").expect(4);
}

#[test]
fn a_film_of_passes_that_are_not_asked_for_is_not_gone_on_from() {
    let place = Workplace::new();
    place.render_share("0..4", "a.film");
    let before = fs::read(place.path("a.film")).unwrap();
    let resume = "render room.pbrt -q --checkpoint a.film --resume";
    for fewer in ["--spp 2", "--passes 4..6", "--part 1/2 --spp 8"] {
        let ran = place.run(&format!("{resume} {fewer}")).expect(5);
        ran.says("which are not asked for");
    }
    // Where nothing is left to do the file stays as it is.
    place.run(&format!("{resume} --spp 4")).expect(0);
    assert_eq!(fs::read(place.path("a.film")).unwrap(), before);
}

#[test]
fn files_that_are_no_films_are_not_replaced_by_one() {
    let place = Workplace::new();
    let scene = place.read("room.pbrt");
    let render = "render room.pbrt -q --spp 1 --restart --checkpoint";
    place
        .run(&format!("{render} room.pbrt"))
        .expect(2)
        .says("two files of this name");
    place.run(&format!("{render} a.exr -o a.exr")).expect(2);
    fs::write(place.path("copy.pbrt"), &scene).unwrap();
    place
        .run(&format!("{render} copy.pbrt"))
        .expect(2)
        .says("not a film file");
    assert_eq!(place.read("copy.pbrt"), scene);
    assert_eq!(place.read("room.pbrt"), scene);
}

#[test]
fn the_file_before_is_never_pushed_out_by_a_damaged_one() {
    let place = Workplace::new();
    place.render_share("0..1", "a.film");
    place
        .run("render room.pbrt -q --spp 2 --checkpoint a.film --resume")
        .expect(0);
    let previous = fs::read(place.path("a.film.previous")).unwrap();
    fs::write(place.path("a.film"), b"BIDIRFLM and then nothing").unwrap();
    place
        .run("render room.pbrt -q --spp 2 --checkpoint a.film --restart")
        .expect(0);
    assert_eq!(fs::read(place.path("a.film.previous")).unwrap(), previous);
    fs::remove_file(place.path("a.film")).unwrap();
    let ran = place
        .run("render room.pbrt -q --spp 2 --checkpoint a.film --resume")
        .expect(2);
    ran.says("rename a.film.previous").says("--restart");
}

#[test]
fn a_film_file_is_not_replaced_unasked() {
    let place = Workplace::new();
    place.render_share("0..1", "a.film");
    let render = "render room.pbrt -q --spp 2 --checkpoint a.film";
    place.run(render).expect(2).says("--resume");
    place.run(&format!("{render} --restart")).expect(0);
    let info = place.run("film info a.film --json").expect(0).json();
    assert_eq!(info["passes"], "0..2");
    assert_eq!(info["stopping"], "fixed");
    assert_eq!(info["counts"]["samples"], 2 * 24 * 16);
    place.run("film develop a.film -o a.exr").expect(0);
    place.expect_same("a.exr", "room.exr");
}

#[test]
fn an_image_says_the_same_of_all_runs_whoever_writes_it() {
    let place = Workplace::new();
    let render = "render room.pbrt -q --shadow-rays ray-roulette --checkpoint a.film --resume";
    let seconds = || {
        let info = place.run("film info a.film --json").expect(0).json();
        info["seconds"].as_f64().unwrap()
    };
    place.run(&format!("{render} --spp 2 -o a.exr")).expect(0);
    let first = (place.attributes("a.exr"), seconds());
    place.run(&format!("{render} --spp 5 -o a.exr")).expect(0);
    let attributes = place.attributes("a.exr");
    assert!(seconds() > first.1);
    assert_eq!(
        attributes["renderTimeSeconds"],
        (seconds() as f32).to_string()
    );
    let number = |name: &str| attributes[name].parse::<u64>().unwrap();
    assert_eq!(number("bidir/samples"), 5 * 24 * 16);
    // Both runs were trained.
    let training: u64 = first.0["bidir/rays.training"].parse().unwrap();
    assert_eq!(number("bidir/rays.training"), 2 * training);
    assert!(attributes.contains_key("bidir/trained-mean"));

    let image = fs::read(place.path("a.exr")).unwrap();
    place.run("film develop a.film -o b.exr").expect(0);
    assert!(fs::read(place.path("b.exr")).unwrap() == image);
    place.run("merge a.film -o c.film --image c.exr").expect(0);
    assert!(fs::read(place.path("c.exr")).unwrap() == image);
    // Where nothing is left to do the image is that of the film file, too.
    place.run(&format!("{render} --spp 5 -o d.exr")).expect(0);
    assert!(fs::read(place.path("d.exr")).unwrap() == image);
}

#[test]
fn a_film_says_which_estimates_it_has() {
    let place = Workplace::new();
    place.render_share("0..1", "a.film");
    let version = bidir::ESTIMATOR_VERSION.to_string();
    let info = place.run("film info a.film --json").expect(0).json();
    assert_eq!(info["settings"]["estimator-version"], *version);
    place
        .run("film info a.film")
        .expect(0)
        .prints(&format!("  estimator-version    {version}\n"))
        .prints("  rays.connection      ");
}

#[test]
fn what_needs_no_scene_is_told_before_one_is_read() {
    let place = Workplace::new();
    place.render_share("0..1", "a.film");
    let render = "render no-such-scene.pbrt --checkpoint";
    place
        .run(&format!("{render} a.film"))
        .expect(2)
        .says("there is a film file already");
    place.write("b.film", "BIDIRFLM and then nothing");
    place
        .run(&format!("{render} b.film --resume"))
        .expect(4)
        .says("b.film");
    place.run(&format!("{render} c.film -o a.jpg")).expect(2);
    place
        .run(&format!("{render} c.film -o no/such/folder.exr"))
        .expect(4)
        .says("folder");
    place.run(&format!("{render} c.film")).expect(4);
    assert_eq!(place.names(), ["a.film", "b.film", "room.pbrt"]);
}

#[cfg(target_os = "linux")]
#[test]
fn what_killed_writers_left_behind_is_removed() {
    let place = Workplace::new();
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap();
    let host = host
        .trim()
        .replace(|c: char| !c.is_ascii_alphanumeric() && c != '-', "");
    for name in ["a.film", "a.film.previous", "b.film"] {
        place.write(&format!(".{name}.bidir-{host}-1-aB3dE6.tmp"), "part of");
    }
    place.write("a.film.lock", "");
    place.render_share("0..1", "a.film");
    place.run("merge a.film -o c.film").expect(0);
    place.run("merge a.film -o /dev/null").expect(0);
    let other = format!(".b.film.bidir-{host}-1-aB3dE6.tmp");
    assert_eq!(place.names(), [&*other, "a.film", "c.film", "room.pbrt"]);
}

#[test]
fn two_writers_of_one_film_are_kept_apart() {
    let place = Workplace::new();
    let render = "render room.pbrt -q --time 20s --checkpoint a.film";
    let mut first = place.command(render).stderr(Stdio::null()).spawn().unwrap();
    let lock = place.path("a.film.lock");
    while !lock.exists() {
        std::thread::sleep(Duration::from_millis(5));
    }
    // The lock is taken right after the file is made.
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
    // What was killed holds nothing.
    place
        .run("render room.pbrt -q --spp 1 --checkpoint a.film --restart")
        .expect(0);
}

#[test]
fn the_picture_decides_when_it_is_done() {
    let place = Workplace::new();
    let render = "render room.pbrt -q --noise 0.1 --checkpoint a.film";
    place.run(render).expect(0);
    let info = place.run("film info a.film --json").expect(0).json();
    assert_eq!(info["stopping"], "noise");
    // Interrupted somewhere and gone on, it is done after the same passes.
    place
        .run("render room.pbrt -q --spp 5 --checkpoint b.film")
        .expect(0);
    place
        .run("render room.pbrt -q --noise 0.1 --checkpoint b.film --resume")
        .expect(0);
    let again = place.run("film info b.film --json").expect(0).json();
    assert_eq!(info["passes"], again["passes"]);
}

/// How often a render is killed: the variable BIDIR_TEST_KILLS, else 3 times.
fn kills() -> u64 {
    let text = std::env::var("BIDIR_TEST_KILLS").ok();
    text.map_or(3, |text| {
        text.parse().expect("BIDIR_TEST_KILLS is a whole number")
    })
}

#[test]
fn a_killed_render_goes_on_to_the_same_bits() {
    let place = Workplace::new();
    // More passes than all runs that are killed can do.
    let passes = 50 * kills();
    let render = format!("render room.pbrt -q --size 96x64 --spp {passes}");
    place.run(&format!("{render} -o whole.exr")).expect(0);
    let resumed = format!("{render} --checkpoint a.film --resume -o a.exr");
    let often = format!("{resumed} --checkpoint-every 0.001s");
    for kill in 0..kills() {
        let mut child = place.command(&often).spawn().unwrap();
        // Other moments each time, spread over the first passes of a run.
        std::thread::sleep(Duration::from_millis(30 + kill * 7919 % 140));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    // The last run renders what the killed ones did not, and no more.
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
    // What was killed while it wrote left files behind; the last run removed them.
    let names = "a.exr a.film a.film.previous a.json a.png room.pbrt whole.exr whole.png";
    assert_eq!(place.names().join(" "), names);
}

/// A disk of so many KiB, taken away at the end. None: this process may not make one.
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
