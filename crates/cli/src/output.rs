//! Which files a render writes, and whether they can be written.

use crate::args::OutputArgs;
use crate::exit::{Exit, Failure};
use crate::scene_io::{self, MetadataValue};
use bidir::film::{FilmSettings, Picture};
use std::path::{Path, PathBuf};

/// The files that a render writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Outputs {
    exr: Option<PathBuf>,
    png: PathBuf,
    /// The counts, as JSON.
    pub(crate) stats: Option<PathBuf>,
}

impl Outputs {
    /// The files of a render; `scene` is the scene file, `film` the name it gives its image.
    pub(crate) fn new(
        args: &OutputArgs,
        scene: &Path,
        film: Option<&Path>,
    ) -> Result<Self, Failure> {
        let image = match &args.output {
            Some(path) => path.clone(),
            None => default_image(scene, film),
        };
        let extension = image.extension().and_then(|extension| extension.to_str());
        let (exr, png) = match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("exr") => (Some(image.clone()), image.with_extension("png")),
            Some("png") => (None, image),
            _ => {
                let message = format!("{}: not the name of an image", image.display());
                return Err(Failure::usage(message).with_hint("end it with .exr or .png"));
            }
        };
        Ok(Self {
            exr,
            png,
            stats: args.stats.clone(),
        })
    }

    fn files(&self) -> impl Iterator<Item = &Path> {
        self.exr
            .iter()
            .chain([&self.png])
            .chain(&self.stats)
            .map(PathBuf::as_path)
    }

    /// Fails now rather than after hours where a file could not be written.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        for file in self.files() {
            if file.is_dir() {
                let message = format!("{}: cannot write: it is a folder", file.display());
                return Err(Failure::new(Exit::InputOutput, message));
            }
            let folder = folder_of(file);
            // The file vanishes as it is closed.
            tempfile::tempfile_in(folder)
                .map_err(|error| Failure::io(file, "write", &error).with_hint(hint(folder)))?;
        }
        Ok(())
    }

    /// Writes the image.
    pub(crate) fn write_image(
        &self,
        film: &FilmSettings,
        picture: &Picture,
        metadata: &[(String, MetadataValue)],
    ) -> Result<(), Failure> {
        if let Some(exr) = &self.exr {
            scene_io::write_exr(exr, film, picture, metadata)?;
        }
        scene_io::write_png(&self.png, picture)
    }

    /// The names of the files.
    pub(crate) fn names(&self) -> String {
        let names: Vec<_> = self
            .files()
            .map(|file| file.display().to_string())
            .collect();
        names.join(", ")
    }
}

/// The image that the scene names, as EXR; else one with the name of the scene.
fn default_image(scene: &Path, film: Option<&Path>) -> PathBuf {
    let name = film
        .filter(|film| film.file_stem().is_some())
        .or_else(|| Some(Path::new(scene.file_stem()?)).filter(|stem| *stem != Path::new("-")));
    name.unwrap_or(Path::new("bidir")).with_extension("exr")
}

fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn hint(folder: &Path) -> String {
    let folder_name = folder.display();
    if folder.is_dir() {
        format!("files cannot be made in `{folder_name}`: check its permissions and free space")
    } else {
        format!("there is no folder `{folder_name}`: make it, or write elsewhere with --output")
    }
}

/// Writes a text file so that its name stands for the whole of it, or for what was there before.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    let write = || {
        let mut file = tempfile::Builder::new()
            .prefix(".bidir-")
            .tempfile_in(folder_of(path))?;
        make_public(file.as_file())?;
        std::io::Write::write_all(&mut file, text.as_bytes())?;
        file.persist(path)?;
        Ok(())
    };
    write().map_err(|error: std::io::Error| Failure::io(path, "write", &error))
}

/// A temporary file is private unless told otherwise.
#[cfg(unix)]
fn make_public(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn make_public(_file: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outputs(output: Option<&str>, film: Option<&str>) -> Result<Outputs, Failure> {
        let args = OutputArgs {
            output: output.map(Into::into),
            stats: None,
            quiet: false,
        };
        Outputs::new(&args, Path::new("scenes/room.pbrt"), film.map(Path::new))
    }

    #[track_caller]
    fn check(output: Option<&str>, film: Option<&str>, names: &str) {
        assert_eq!(outputs(output, film).unwrap().names(), names);
    }

    #[test]
    fn names_come_from_the_flag_then_the_film_then_the_scene() {
        check(Some("a/b.exr"), Some("film.exr"), "a/b.exr, a/b.png");
        check(Some("b.PNG"), None, "b.PNG");
        check(None, Some("film.png"), "film.exr, film.png");
        check(None, Some(""), "room.exr, room.png");
        check(None, None, "room.exr, room.png");
    }

    #[test]
    fn other_endings_are_a_fault_of_the_command_line() {
        assert_eq!(
            outputs(Some("a.jpg"), None).unwrap_err().exit(),
            Exit::Usage
        );
        assert_eq!(outputs(Some("a"), None).unwrap_err().exit(), Exit::Usage);
    }
}
