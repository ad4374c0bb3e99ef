//! Every example of README.md runs, with a smaller image and less time.

use crate::common::{Ran, Workplace, scenes};
use crate::signals::send;
use std::fs;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::symlink;
use std::process::Stdio;

/// Returns the commands in the code below the heading `## Examples`, without comments.
fn examples(page: &str) -> Vec<String> {
    let below = page.split("\n## Examples\n").nth(1).unwrap();
    let section = below.split("\n## ").next().unwrap();
    let lines = section
        .lines()
        .filter_map(|line| line.strip_prefix("    bidir "));
    let commands = lines.map(|line| line.split(" #").next().unwrap().trim_end());
    commands.map(str::to_owned).collect()
}

/// Returns the same command with few samples of few pixels.
fn shrunk(command: &str) -> String {
    let mut words: Vec<_> = command.split_whitespace().collect();
    for i in 1..words.len() {
        match words[i - 1] {
            "--spp" if words[0] != "farm" => words[i] = "16",
            "--time" => words[i] = "1s",
            "--size" => words[i] = "16x16",
            _ => (),
        }
    }
    let fewer = match words[0] {
        _ if words.contains(&"--size") => "",
        // In a smaller image, the pixel would be another one.
        "render" if !words.contains(&"--replay") => "--size 16x16",
        "reference" => "--size 16x16",
        "view" => "--port 0 --size 16x16",
        _ => "",
    };
    words.extend(fewer.split_whitespace());
    words.join(" ")
}

/// Returns the experiment of the examples with fewer samples, pixels and seeds.
fn small_experiment() -> String {
    let file = scenes().join("../experiments/shadow-rays.toml");
    let mut text = fs::read_to_string(file).unwrap();
    for (large, small) in [
        ("size = \"64x48\"", "size = \"16x12\""),
        ("seeds = 8", "seeds = 2"),
        ("reference-spp = 512", "reference-spp = 32"),
        ("rays = 200", "rays = 20"),
    ] {
        assert!(text.contains(large), "{large}");
        text = text.replace(large, small);
    }
    text
}

/// Returns a binary glTF file of one triangle.
fn triangle() -> Vec<u8> {
    let mut json = br#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36}]}"#
        .to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let corners = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let binary: Vec<u8> = corners.into_iter().flat_map(f32::to_le_bytes).collect();
    let mut file = b"glTF\x02\0\0\0".to_vec();
    let length = 12 + 8 + json.len() + 8 + binary.len();
    file.extend((length as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &binary)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

/// Runs a server until it has printed its URL.
fn serve(place: &Workplace, command: &str) {
    let mut command = place.command(command);
    let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
    let mut url = String::new();
    let mut stdout = BufReader::new(child.stdout.take().unwrap());
    stdout.read_line(&mut url).unwrap();
    assert!(url.starts_with("http://"), "{url}");
    send("INT", &child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

/// Runs one example, without the denoiser where it is not installed.
fn run(place: &Workplace, command: &str) -> Ran {
    if command.contains("--denoise") && place.denoising(command).is_none() {
        return place.run(&command.replace("--denoise", ""));
    }
    place.run(command)
}

#[test]
fn every_example_of_the_readme_runs() {
    let place = Workplace::new();
    let root = scenes().parent().unwrap();
    symlink(root.join("scenes"), place.path("scenes")).unwrap();
    fs::create_dir(place.path("experiments")).unwrap();
    place.write("experiments/shadow-rays.toml", &small_experiment());
    fs::write(place.path("room.glb"), triangle()).unwrap();
    // The `mkdir` of the page.
    fs::create_dir(place.path("out")).unwrap();
    let examples = examples(&fs::read_to_string(root.join("README.md")).unwrap());
    assert!(examples.len() >= 10, "{examples:?}");
    for command in examples.iter().map(|command| shrunk(command)) {
        if command.starts_with("view") {
            serve(&place, &command);
        } else {
            let ran = run(&place, &command);
            assert_eq!(ran.code, Some(0), "bidir {command}: {}", ran.stderr);
        }
    }
    for file in [
        "out/room.exr",
        "out/room.png",
        "out/cornell.exr",
        "out/sample.svg",
        "out/shadow-rays/report.html",
    ] {
        assert!(place.path(file).exists(), "{file}");
    }
}
