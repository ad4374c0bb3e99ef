//! `bidir denoise` and `bidir render --denoise`: removes the noise of an image, guided by its layers.
//!
//! The filter is Open Image Denoise, which the `denoise` crate loads. The file keeps the noisy image, so
//! that it can be denoised again.

use crate::args::{DenoiseArgs, ThreadsArgs};
use crate::console::say;
use crate::exit::{Exit, Failure};
use crate::output;
use crate::scene_io::{Developed, Format, IMAGES, Layers};
use bidir::driver::Threads;
use bidir::film::LayerImage;
use denoise::{DenoiseError, Denoiser, Input};
use std::path::Path;

const COLOR: [&str; 3] = ["R", "G", "B"];
const NOISY: [&str; 3] = ["Noisy.R", "Noisy.G", "Noisy.B"];
const ALBEDO: [&str; 3] = ["Albedo.R", "Albedo.G", "Albedo.B"];
/// The layers of normals, the preferred one first: shading normals, then geometric normals.
const NORMALS: [(&str, [&str; 3]); 2] = [
    ("Ns", ["Ns.X", "Ns.Y", "Ns.Z"]),
    ("N", ["N.X", "N.Y", "N.Z"]),
];

/// The loaded filter.
pub(crate) struct Filter(Denoiser);

impl Filter {
    /// Loads the library with at most this number of threads; for 0 the library chooses.
    pub(crate) fn load(threads: ThreadsArgs) -> Result<Self, Failure> {
        let threads = match usize::from(threads.count) {
            0 => 0,
            requested => Threads::new(requested).count(),
        };
        let denoiser = Denoiser::load(threads);
        denoiser.map(Self).map_err(|error| failure(&error))
    }

    /// Denoises a picture with guides of the same size. The library uses normals only together with albedo.
    fn apply(
        &self,
        size: [usize; 2],
        color: &[[f32; 3]],
        albedo: Option<&[[f32; 3]]>,
        normal: Option<&[[f32; 3]]>,
    ) -> Result<Vec<[f32; 3]>, Failure> {
        let input = Input {
            size,
            color,
            albedo,
            normal: normal.filter(|_| albedo.is_some()),
        };
        self.0.denoise(&input).map_err(|error| failure(&error))
    }

    /// Describes the denoiser: its name and version, and the names of the guides.
    fn description(&self, guides: &[&str]) -> String {
        let guides = match guides {
            [] => "none".to_owned(),
            guides => guides.join(", "),
        };
        format!("Open Image Denoise {}, guides: {guides}", self.0.version())
    }

    /// Denoises a developed film, and keeps the noisy picture as a layer. Returns the description of the
    /// denoiser.
    pub(crate) fn clean(&self, developed: &mut Developed) -> Result<String, Failure> {
        let guide = |name| {
            let layer = developed.layers.iter().find(|layer| layer.name == name)?;
            Some(layer.data.as_chunks::<3>().0)
        };
        let picture = &developed.picture;
        let size = [picture.width, picture.height];
        let clean = self.apply(size, &picture.pixels, guide("Albedo"), guide("Ns"))?;
        let noisy = std::mem::replace(&mut developed.picture.pixels, clean);
        developed.layers.push(LayerImage {
            name: "Noisy".to_owned(),
            channels: &COLOR,
            data: noisy.into_flattened(),
        });
        Ok(self.description(&["Albedo", "Ns"]))
    }
}

/// Returns the failure of the denoiser. A missing library counts as a file that cannot be read.
fn failure(error: &DenoiseError) -> Failure {
    let exit = if error.is_missing() {
        Exit::InputOutput
    } else {
        Exit::RenderFailed
    };
    let failure = Failure::new(exit, error.to_string());
    match error.hint() {
        Some(hint) => failure.with_hint(hint),
        None => failure,
    }
}

/// Denoises an image file.
pub(crate) fn run(args: &DenoiseArgs) -> Result<Exit, Failure> {
    let default = || output::named_after(&args.image, "-clean.exr");
    let written = &args.output.clone().unwrap_or_else(default);
    let format = output::check_image("--output", written, IMAGES, [&args.image])?;
    let mut layers = formats::image::read_layers(&args.image)?;
    let noisy = noisy(&layers, &args.image)?;
    let albedo = layers.triples(ALBEDO);
    let mut normals = NORMALS
        .iter()
        .filter_map(|(name, channels)| Some((*name, layers.triples(*channels)?)));
    let named_normal = normals.next().filter(|_| albedo.is_some());
    let albedo_name = albedo.iter().map(|_| "Albedo");
    let names: Vec<_> = albedo_name
        .chain(named_normal.iter().map(|(name, _)| *name))
        .collect();
    if names.len() < 2 {
        say(format_args!(
            "note: `bidir render --aov albedo,shading-normal` gives an image the layers Albedo and Ns, which \
             keep textures and edges sharp"
        ));
    }
    let filter = Filter::load(args.threads)?;
    let normal = named_normal.as_ref().map(|(_, normal)| normal.as_slice());
    let clean = filter.apply(layers.size(), &noisy, albedo.as_deref(), normal)?;
    let by = filter.description(&names);
    if format == Format::Png {
        formats::image::write_png(written, layers.size(), &clean)?;
    } else {
        layers.set_triples(COLOR, &clean)?;
        layers.set_triples(NOISY, &noisy)?;
        layers.set_text("bidir/denoiser", &by);
        formats::image::write_layers(written, &layers)?;
    }
    say(format_args!("{by}; wrote {}", written.display()));
    Ok(Exit::Done)
}

/// Returns the noisy picture of an image: its layer Noisy if it was denoised before.
fn noisy(layers: &Layers, path: &Path) -> Result<Vec<[f32; 3]>, Failure> {
    let noisy = layers.triples(NOISY).or_else(|| layers.triples(COLOR));
    noisy.ok_or_else(|| {
        let message = format!("{}: it has no channels R, G, B", path.display());
        Failure::new(Exit::InputOutput, message)
    })
}
