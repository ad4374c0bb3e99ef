//! The context of building: reads the files that parameters name.

use super::spectral;
use crate::error::Error;
use crate::files::Files;
use crate::image::{self, Encoding, ImageData};
use crate::import::{self, Content, Document};
use crate::limits;
use crate::pbrt::scene::SceneDescription;
use crate::pbrt::transform::Transforms;
use crate::ply::{self, PlyMesh};
use crate::source::{Fault, SourceMap, Span};
use bidir::spectrum::Curve;
use glam::DAffine3;
use std::path::{Path, PathBuf};

pub(super) type Context<'a> = import::Context<'a, SceneDescription>;
pub(super) type Log = import::Log<Span>;

impl Document for SceneDescription {
    type Place = Span;
    const TOP: Span = SourceMap::BEGINNING;

    fn files(&self) -> &Files {
        &self.files
    }

    fn named_files(&self) -> Vec<PathBuf> {
        self.inputs()
    }

    fn text(&self, span: &Span) -> String {
        let (line, column) = self.sources.line_and_column(*span);
        let file = self.sources.name(span.file).display();
        format!("{file}:{line}:{column}")
    }

    fn error(&self, fault: Fault) -> Error {
        self.sources.error(fault)
    }
}

/// Returns the log that begins with the texts of `description`.
pub(super) fn log(description: &SceneDescription, options: &import::LoadOptions) -> Log {
    let mut log = Log::new(options, description.texts.clone(), description.stored);
    log.warnings.clone_from(&description.warnings);
    for text in description.sources.texts() {
        log.add(Content::Text, text.as_bytes(), []);
    }
    log
}

impl Context<'_> {
    /// Returns the map from a local space to the render space, at the first time.
    pub(super) fn place(&self, world_from_local: &Transforms) -> DAffine3 {
        self.layout.render_from_world() * world_from_local.start
    }

    /// Reads a mesh, which `span` names.
    pub(super) fn read_mesh(&mut self, path: &Path, span: Span) -> Result<PlyMesh, Fault> {
        let bytes = self.read(path, limits::LARGEST_MESH, Content::Mesh, span)?;
        let parsed = ply::parse(&bytes);
        parsed.map_err(|error| Fault::from_error(span, &error.in_file(path)))
    }

    /// Reads an image, which `span` names.
    pub(super) fn read_image(
        &mut self,
        path: &Path,
        encoding: Option<Encoding>,
        span: Span,
    ) -> Result<ImageData, Fault> {
        let bytes = self.read(path, limits::LARGEST_IMAGE, Content::Image, span)?;
        let decoded = image::decode_file(path, &bytes, encoding);
        let counted = decoded.and_then(|image| self.log.reading.image(image));
        counted.map_err(|error| Fault::from_error(span, &error.in_file(path)))
    }

    /// Reads a spectrum, which `span` names.
    pub(super) fn read_spectrum(&mut self, path: &Path, span: Span) -> Result<Curve, Fault> {
        let bytes = self.read(path, limits::LARGEST_SPECTRUM, Content::Spectrum, span)?;
        // Comments may be in any encoding.
        let text = String::from_utf8_lossy(&bytes);
        let refuse = |error| Fault::scene(span, format!("{}: {error}", path.display()));
        spectral::parse(&text).map_err(refuse)
    }

    /// Reads a file of the scene, which `span` names.
    pub(super) fn read(
        &mut self,
        path: &Path,
        limit: u64,
        content: Content,
        span: Span,
    ) -> Result<Vec<u8>, Fault> {
        let read = self.log.read(&self.document.files, path, limit);
        let bytes = read.map_err(|error| Fault::from_error(span, &error))?;
        self.log.add(content, &bytes, [path.to_owned()]);
        Ok(bytes)
    }
}
