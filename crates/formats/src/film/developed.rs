//! A developed film as an image file.

use crate::error::Result;
use crate::image::{self, ExrImage, ExrLayer, Format, MetadataValue};
use bidir::film::{Film, FilmSettings, LayerImage, Picture};
use std::path::Path;

/// A developed film: the picture and its layers.
#[derive(Clone, Debug)]
pub struct Developed {
    /// The picture.
    pub picture: Picture,
    /// The layers.
    pub layers: Vec<LayerImage>,
}

impl Developed {
    /// Develops the picture and all layers of `film`.
    pub fn new(film: &Film) -> Self {
        Self {
            picture: film.develop(),
            layers: film.develop_layers(),
        }
    }

    /// Writes an image in the format of its name's ending. Only EXR gets layers and attributes.
    ///
    /// Errors: the ending is of another format, or the file cannot be written.
    pub fn write(
        &self,
        path: &Path,
        film: &FilmSettings,
        metadata: &[(String, MetadataValue)],
    ) -> Result<()> {
        match Format::of(path) {
            Some(Format::Exr) => self.write_exr(path, film, metadata),
            Some(Format::Png) => self.write_png(path),
            _ => Err(image::no_output(path)),
        }
    }

    /// Writes an EXR with attributes.
    pub fn write_exr(
        &self,
        path: &Path,
        film: &FilmSettings,
        metadata: &[(String, MetadataValue)],
    ) -> Result<()> {
        image::write_exr(path, &Self::exr(film, &self.exr_layers(), metadata))
    }

    /// Writes the picture as PNG for the screen, without layers.
    pub fn write_png(&self, path: &Path) -> Result<()> {
        let size = [self.picture.width, self.picture.height];
        image::write_png(path, size, &self.picture.pixels)
    }

    /// Encodes the EXR that [`write_exr`](Self::write_exr) writes.
    pub fn encode_exr(
        &self,
        film: &FilmSettings,
        metadata: &[(String, MetadataValue)],
    ) -> Result<Vec<u8>> {
        image::encode_exr(&Self::exr(film, &self.exr_layers(), metadata))
    }

    fn exr<'a>(
        film: &FilmSettings,
        layers: &'a [ExrLayer<'a>],
        metadata: &'a [(String, MetadataValue)],
    ) -> ExrImage<'a> {
        let ([left, top], [right, bottom]) = (film.crop.min, film.crop.max);
        ExrImage {
            resolution: film.resolution.map(|side| side as usize),
            crop: [left, top, right, bottom].map(|edge| edge as usize),
            layers,
            metadata,
        }
    }

    fn exr_layers(&self) -> Vec<ExrLayer<'_>> {
        let picture = ExrLayer::rgb("", &self.picture.pixels);
        let others = self.layers.iter().map(|layer| ExrLayer {
            name: &layer.name,
            channels: layer.channels,
            data: &layer.data,
        });
        std::iter::once(picture).chain(others).collect()
    }
}
