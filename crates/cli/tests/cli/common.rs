use formats::image::{Layers, read_layers};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A floor, a wall, a small light and a point light, in 24 x 16 pixels.
pub(crate) const SCENE: &str = include_str!("room.pbrt");

/// A temporary folder with a scene in it.
pub(crate) struct Workplace {
    folder: TempDir,
}

impl Workplace {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("room.pbrt"), SCENE).unwrap();
        Self { folder }
    }

    /// Writes `dark.pbrt`, the same place without light.
    pub(crate) fn write_dark(&self) {
        let lights = ["LightSource", "AreaLightSource"];
        let lines = SCENE.lines();
        let dark = lines.filter(|line| !lights.iter().any(|light| line.starts_with(light)));
        self.write("dark.pbrt", &dark.collect::<Vec<_>>().join("\n"));
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Returns the sorted names of all files but locks, which stay.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<_> = names
            .filter(|name| name.strip_suffix(".lock").is_none())
            .collect();
        names.sort();
        names
    }

    /// Returns the bytes of all files but locks.
    pub(crate) fn contents(&self) -> BTreeMap<String, Vec<u8>> {
        let names = self.names().into_iter();
        let files = names.filter_map(|name| Some((fs::read(self.path(&name)).ok()?, name)));
        files.map(|(bytes, name)| (name, bytes)).collect()
    }

    /// Returns the attributes of an image as texts by name.
    pub(crate) fn attributes(&self, image: &str) -> BTreeMap<String, String> {
        let bytes = fs::read(self.path(image)).unwrap();
        let mut rest = &bytes[8..];
        let mut attributes = BTreeMap::new();
        loop {
            let name = take_text(&mut rest);
            if name.is_empty() {
                return attributes;
            }
            let kind = take_text(&mut rest);
            let (length, after) = rest.split_first_chunk().unwrap();
            let (value, after) = after.split_at(u32::from_le_bytes(*length) as usize);
            rest = after;
            let number = || value.try_into().unwrap();
            let value = match &*kind {
                "int" => i32::from_le_bytes(number()).to_string(),
                "float" => f32::from_le_bytes(number()).to_string(),
                _ => String::from_utf8_lossy(value).into_owned(),
            };
            attributes.insert(name, value);
        }
    }

    /// Returns the command with these arguments, in this folder, without settings from the environment.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_bidir"));
        command
            .args(arguments.split_whitespace())
            .current_dir(self.folder.path());
        for (name, _) in std::env::vars_os() {
            if name.to_string_lossy().starts_with("BIDIR_") {
                command.env_remove(name);
            }
        }
        command
    }

    pub(crate) fn run(&self, arguments: &str) -> Ran {
        Ran::of(&mut self.command(arguments))
    }

    /// Runs a command that denoises, with the library of the system or of `BIDIR_OIDN`. None: there is none,
    /// and the test is skipped.
    #[allow(clippy::print_stderr, reason = "a skipped test says so")]
    pub(crate) fn denoising(&self, arguments: &str) -> Option<Ran> {
        let mut command = self.command(arguments);
        if let Some(library) = std::env::var_os("BIDIR_OIDN") {
            command.env("BIDIR_OIDN", library);
        }
        let ran = Ran::of(&mut command);
        if ran.stderr.contains("Open Image Denoise was not found") {
            eprintln!("skipped: Open Image Denoise is not installed");
            ran.expect(4).says("hint: `pip install pyoidn`");
            return None;
        }
        Some(ran)
    }

    /// Reads all channels of an image.
    pub(crate) fn layers(&self, name: &str) -> Layers {
        read_layers(&self.path(name)).unwrap()
    }
}

/// Takes the text up to a zero byte, and that byte.
fn take_text(bytes: &mut &[u8]) -> String {
    let end = bytes.iter().position(|byte| *byte == 0).unwrap();
    let text = String::from_utf8(bytes[..end].to_vec()).unwrap();
    *bytes = &bytes[end + 1..];
    text
}

/// The exit code and the output of a command.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Ran {
    pub(crate) fn of(command: &mut Command) -> Self {
        Self::from(command.output().unwrap())
    }

    #[track_caller]
    pub(crate) fn expect(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{}{}", self.stdout, self.stderr);
        self
    }

    #[track_caller]
    pub(crate) fn says(self, part: &str) -> Self {
        assert!(
            self.stderr.contains(part),
            "{part:?} is missing in: {}",
            self.stderr
        );
        self
    }

    #[track_caller]
    pub(crate) fn prints(self, part: &str) -> Self {
        assert!(
            self.stdout.contains(part),
            "{part:?} is missing in: {}",
            self.stdout
        );
        self
    }

    /// Checks that one place of both outputs has a text.
    #[track_caller]
    pub(crate) fn once(self, part: &str) -> Self {
        let both = format!("{}{}", self.stdout, self.stderr);
        assert_eq!(both.matches(part).count(), 1, "{part:?} in: {both}");
        self
    }

    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap()
    }
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

/// The scenes of the project.
pub(crate) fn scenes() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes"))
}
