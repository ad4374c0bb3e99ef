//! What building knows throughout: the description, what the caller wants, warnings, what was read.

use super::LoadOptions;
use crate::bytes::FileBytes;
use crate::error::{Error, ErrorKind};
use crate::image::{self, Encoding, ImageData};
use crate::limits;
use crate::pbrt::digest::{Content, DigestBuilder};
use crate::pbrt::scene::{SceneDescription, Warning, warn};
use crate::pbrt::transform::Transforms;
use crate::ply::{self, PlyMesh};
use crate::reading::Reading;
use crate::source::{Fault, Span};
use crate::space::Layout;
use crate::spectra::Spectrum;
use glam::DAffine3;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const INSTANCES_SHARE: &str = "instances share the memory of their object, unless it emits";

/// Whether something simpler may replace what is not supported yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StandIns {
    Accepted,
    Refused,
}

pub(super) struct Context<'a> {
    pub(super) description: &'a SceneDescription,
    pub(super) options: &'a LoadOptions,
    /// Where everything goes.
    pub(super) layout: Layout,
    stand_ins: StandIns,
    pub(super) warnings: Vec<Warning>,
    /// The messages of those warnings that tell of stand-ins.
    pub(super) refused: BTreeSet<String>,
    /// Of the texts and of every file that was read since.
    pub(super) digest: DigestBuilder,
    /// Their names.
    pub(super) files: Vec<PathBuf>,
    reading: Reading,
}

impl<'a> Context<'a> {
    pub(super) fn new(
        description: &'a SceneDescription,
        options: &'a LoadOptions,
        layout: Layout,
    ) -> Self {
        let stand_ins = if options.lenient {
            StandIns::Accepted
        } else {
            StandIns::Refused
        };
        let mut digest = DigestBuilder::new();
        for text in description.sources.texts() {
            digest.add(Content::Text, text.as_bytes());
        }
        Self {
            description,
            options,
            layout,
            stand_ins,
            warnings: description.warnings.clone(),
            refused: BTreeSet::new(),
            digest,
            files: description.texts.clone(),
            reading: Reading::new(description.stored),
        }
    }

    /// The map from the space of something in the world, at the first time, to where it goes.
    pub(super) fn place(&self, world_from_local: &Transforms) -> DAffine3 {
        self.layout.render_from_world() * world_from_local.start
    }

    /// Reads a mesh, which `span` names.
    pub(super) fn read_mesh(&mut self, path: &Path, span: Span) -> Result<PlyMesh, Fault> {
        let bytes = self.read(path, limits::LARGEST_MESH, Content::Mesh, span)?;
        let parsed = ply::parse(&bytes).map_err(|error| error.in_file(path));
        parsed.map_err(|error| Fault::from_error(span, &error))
    }

    /// Reads an image, which `span` names.
    pub(super) fn read_image(
        &mut self,
        path: &Path,
        encoding: Option<Encoding>,
        span: Span,
    ) -> Result<ImageData, Fault> {
        let refuse = |error: Error| Fault::from_error(span, &error);
        let format = image::named_format(path).map_err(refuse)?;
        let bytes = self.read(path, limits::LARGEST_IMAGE, Content::Image, span)?;
        let decoded = image::decode(format, &bytes, encoding);
        let decoded = decoded.and_then(|image| self.reading.image(image));
        decoded.map_err(|error| refuse(error.in_file(path)))
    }

    /// Reads a file of the scene.
    fn read(
        &mut self,
        path: &Path,
        limit: u64,
        content: Content,
        span: Span,
    ) -> Result<Vec<u8>, Fault> {
        let refuse = |error: Error| Fault::from_error(span, &error);
        let files = &self.description.files;
        let FileBytes { bytes, stored } = files.read(path, limit).map_err(refuse)?;
        let length = bytes.len() as u64;
        let counted = self.reading.file(files.identity(path), stored, length);
        counted.map_err(|error| refuse(error.in_file(path)))?;
        self.digest.add(content, &bytes);
        self.files.push(path.to_owned());
        Ok(bytes)
    }

    /// Reads a spectrum, which `span` names.
    pub(super) fn read_spectrum(&mut self, path: &Path, span: Span) -> Result<Spectrum, Fault> {
        let bytes = self.read(path, limits::LARGEST_SPECTRUM, Content::Spectrum, span)?;
        let refuse = |message: String| {
            let message = format!("{}: {message}", path.display());
            Fault::scene(span, message)
        };
        let text =
            std::str::from_utf8(&bytes).map_err(|_| refuse("the file is not text".into()))?;
        Spectrum::parse(text).map_err(|error| refuse(error.to_string()))
    }

    pub(super) fn warn(&mut self, span: Span, message: impl Into<String>) {
        warn(&mut self.warnings, span, message);
    }

    /// Something that the format has and the renderer has not: an error, or a warning that says
    /// what stands in.
    pub(super) fn unsupported(
        &mut self,
        span: Span,
        what: &str,
        stand_in: &str,
    ) -> Result<(), Fault> {
        if self.stand_ins == StandIns::Accepted {
            let message = format!("{what} is not supported: {stand_in}");
            self.refused.insert(message.clone());
            self.warn(span, message);
            return Ok(());
        }
        let message = format!("{what} is not supported");
        let fault = Fault::new(ErrorKind::Unsupported, span, message);
        Err(fault.with_hint(format!("with --lenient, {stand_in}")))
    }

    /// Refuses more primitives, or vertices of meshes, than the caller wants, or than the files have
    /// the bytes for.
    pub(super) fn check_size(&self, count: u64, span: Span) -> Result<(), Fault> {
        let most = self.options.most_primitives(self.reading.stored());
        if count <= most {
            return Ok(());
        }
        let message = format!("the scene has more than {most} primitives or vertices");
        let fault = Fault::new(ErrorKind::Limit, span, message);
        Err(fault.with_hint(INSTANCES_SHARE))
    }

    /// Refuses more shapes than the files have the bytes for: those that emit are kept at each place.
    pub(super) fn check_shapes(&self, count: u64, span: Span) -> Result<(), Fault> {
        let most = limits::SHAPES.of(self.reading.stored());
        if count <= most {
            return Ok(());
        }
        let message = format!("the scene has more than {most} shapes, counted at each place");
        let fault = Fault::new(ErrorKind::Limit, span, message);
        Err(fault.with_hint(INSTANCES_SHARE))
    }

    /// Builds something that nobody uses: it must not be wrong, but what is not supported is no
    /// reason to refuse a scene, and nothing has to stand in for it. None: it is not supported.
    pub(super) fn unused<T>(
        &mut self,
        build: impl FnOnce(&mut Self) -> Result<T, Fault>,
    ) -> Result<Option<T>, Fault> {
        let stand_ins = std::mem::replace(&mut self.stand_ins, StandIns::Refused);
        let built = build(self);
        self.stand_ins = stand_ins;
        match built {
            Err(fault) if fault.kind == ErrorKind::Unsupported => Ok(None),
            built => built.map(Some),
        }
    }
}
