//! `bidir farm`: prints a job file with which a scheduler starts the parts of a render.
//!
//! Part I of N renders its passes into a film file NAME.part-I-of-N.film, and continues from it when it
//! is started again; the last step merges the film files and develops the image. There is no protocol and
//! no server of our own: the job file is a text that users read and change.
//!
//! The last step finds the parts by a pattern, which matches no file of another job: names of jobs
//! cannot contain `.part-` and a digit.
//!
//! The templates are job files with placeholders `{{…}}`, which [`Job::value`] replaces:
//!
//! * `slurm.sh` has three roles: directives for `sbatch`, a part, and a script that submits both steps. Two
//!   minutes before its time is over, Slurm sends USR1 to the shell alone, which stops the render with
//!   TERM and then requeues the part. Slurm's own TERM, at the end of the time, before preemption and by
//!   scancel, reaches every process: the shell only has to wait, and must not requeue a cancelled part.
//! * `hyperqueue.sh` is a part, and a script that submits all parts and runs the last step. HyperQueue
//!   itself repeats tasks whose worker was lost, but not those that failed.
//! * `k8s.yaml` has no shell between the pod and the program: Kubernetes puts the index into the
//!   arguments, and its TERM reaches the render itself.
//! * `shell.sh` is for one machine, or several that share a folder.

mod check;
mod quote;

use crate::args::{FarmArgs, FarmCommand};
use crate::console::print;
use crate::exit::{Exit, Failure};
use quote::{arguments, items, quote, yaml};
use std::path::Path;

/// Prints a job file.
pub(crate) fn run(command: &FarmCommand) -> Result<Exit, Failure> {
    let (args, template) = match command {
        FarmCommand::Slurm(args) => (args, include_str!("farm/slurm.sh")),
        FarmCommand::Hyperqueue(args) => (args, include_str!("farm/hyperqueue.sh")),
        FarmCommand::K8s(args) => (args, include_str!("farm/k8s.yaml")),
        FarmCommand::Shell(args) => (args, include_str!("farm/shell.sh")),
    };
    let job = Job::new(args);
    check::check(&job)?;
    print(&job.fill(template))
}

/// The contents of a job file.
struct Job<'a> {
    args: &'a FarmArgs,
    image: String,
}

impl<'a> Job<'a> {
    fn new(args: &'a FarmArgs) -> Self {
        let output = args.output.clone();
        let image = output.unwrap_or_else(|| format!("{}.exr", stem(&args.scene)));
        // With a folder, commands do not read the name as a flag.
        let folder = if image.starts_with('-') { "./" } else { "" };
        let image = format!("{folder}{image}");
        Self { args, image }
    }

    /// Fills in the placeholders of a template in one pass, so that braces in a name are not replaced.
    fn fill(&self, template: &str) -> String {
        let mut pieces = template.split("{{");
        let start = pieces.next().unwrap_or_default().to_owned();
        pieces.fold(start, |text, piece| {
            let (name, after) = piece.split_once("}}").expect("a placeholder has an end");
            text + &self.value(name) + after
        })
    }

    /// Returns the value of a placeholder, quoted for shells, or escaped for the quotes of YAML.
    fn value(&self, placeholder: &str) -> String {
        let FarmArgs { scene, parts, .. } = self.args;
        match placeholder {
            "title" => format!("{scene} in {parts} parts of its passes"),
            "job" => self.job(),
            "label" => label(&self.job()),
            "parts" => parts.to_string(),
            "last" => (parts - 1).to_string(),
            "scene" => quote(scene),
            "spp" => arguments(&self.spp()),
            "flags" => arguments(&self.args.flags),
            "share" => quote(&format!("{}.part-", self.name())),
            "film" => quote(&format!("{}.film", self.name())),
            "image" => quote(&self.image),
            "merge" => self.fill("bidir merge {{share}}[0-9]*-of-{{parts}}.film -o {{film}}"),
            "develop" => self.fill("bidir film develop {{film}} -o {{image}}"),
            "wrap" => quote(&self.fill("{{merge}} && {{develop}}")),
            "yaml-scene" => yaml(scene),
            "yaml-spp" => items(&self.spp()),
            "yaml-flags" => items(&self.args.flags),
            "yaml-name" => yaml(self.name()),
            _ => unreachable!("no template has the placeholder {placeholder}"),
        }
    }

    /// Returns the samples per pixel as a flag of `bidir render`.
    fn spp(&self) -> Vec<String> {
        let spp = self.args.spp.iter();
        spp.flat_map(|spp| ["--spp".into(), spp.to_string()])
            .collect()
    }

    /// Returns the image's name without .exr, which the names of film files begin with.
    fn name(&self) -> &str {
        &self.image[..self.image.len() - ".exr".len()]
    }

    /// Returns a name for the job: letters, digits, dashes, underscores and dots.
    fn job(&self) -> String {
        let file = Path::new(&self.image).file_stem().unwrap_or_default();
        let is_plain = |c: char| c.is_ascii_alphanumeric() || ".-_".contains(c);
        let name = file.to_string_lossy().replace(|c| !is_plain(c), "-");
        or_bidir(name.trim_start_matches(['-', '.']))
    }
}

/// Returns a name of a Kubernetes object: lower-case letters, digits and dashes, with room for the suffix
/// of pods.
fn label(job: &str) -> String {
    let small = job.to_ascii_lowercase().replace(['.', '_'], "-");
    or_bidir(small.get(..40).unwrap_or(&small).trim_matches('-'))
}

fn or_bidir(name: &str) -> String {
    let name = if name.is_empty() { "bidir" } else { name };
    name.to_owned()
}

/// Returns the scene's name without folder and endings.
fn stem(scene: &str) -> String {
    let name = Path::new(scene)
        .file_name()
        .map_or(scene.into(), |name| name.to_string_lossy());
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.strip_suffix(".pbrt").unwrap_or(name).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check_names(scene: &str, output: Option<&str>, expected: [&str; 3]) {
        let args = FarmArgs {
            scene: scene.into(),
            parts: 4,
            spp: None,
            output: output.map(Into::into),
            flags: Vec::new(),
        };
        let job = Job::new(&args);
        assert_eq!([job.name(), &job.image, &job.job()], expected);
        check::check(&job).unwrap();
    }

    #[test]
    fn names_come_from_the_image_then_the_scene() {
        for scene in ["a/room.pbrt", "a/room.pbrt.gz", "a/room"] {
            check_names(scene, None, ["room", "room.exr", "room"]);
        }
        for (image, expected) in [
            (
                "out/my room.exr",
                ["out/my room", "out/my room.exr", "my-room"],
            ),
            ("-x.exr", ["./-x", "./-x.exr", "x"]),
            ("é.exr", ["é", "é.exr", "bidir"]),
            ("room-2.exr", ["room-2", "room-2.exr", "room-2"]),
            ("r.part-.exr", ["r.part-", "r.part-.exr", "r.part-"]),
            ("a.part-b.exr", ["a.part-b", "a.part-b.exr", "a.part-b"]),
        ] {
            check_names("r.pbrt", Some(image), expected);
        }
    }

    #[test]
    fn names_of_kubernetes_objects_are_valid_labels() {
        assert_eq!(label("Room_1.final"), "room-1-final");
        assert_eq!(label("-.-"), "bidir");
        assert_eq!(
            label(&"a-".repeat(50)),
            "a-".repeat(20).trim_end_matches('-')
        );
    }
}
