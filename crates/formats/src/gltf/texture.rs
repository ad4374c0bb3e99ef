//! Images, and their lookup by materials.

use super::container::Resource;
use super::document::{Context, Document};
use super::json::{self, Sampler, TextureInfo};
use super::mesh::UvMap;
use super::place::{GltfFault, Place};
use crate::error::ErrorKind;
use crate::image::{self, Encoding, Format, ImageData};
use crate::import::{Content, Images};
use crate::text::printable;
use bidir::math::sin_cos;
use bidir::texture::{
    self, Beyond, ColorTexture, FloatTexture, Image, ImageFilter, ImageMap, Wrap,
};
use std::collections::BTreeSet;
use std::sync::Arc;

/// A channel of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Red,
    Green,
    Blue,
    /// Alpha; 1 if the image has none.
    Alpha,
}

/// A change of the numbers in an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Change {
    /// A factor.
    Scale(f32),
    /// A threshold: 1 if the number times `factor` is at least `cutoff`, else 0.
    Cut { factor: f32, cutoff: f32 },
}

impl Change {
    pub(super) fn apply(self, value: f32) -> f32 {
        match self {
            Self::Scale(factor) => factor * value,
            Self::Cut { factor, cutoff } => f32::from(factor * value >= cutoff),
        }
    }
}

/// The decoded images of a file.
#[derive(Default)]
pub(super) struct Textures {
    colors: Images<(usize, bool), 3>,
    numbers: Images<(usize, String), 1>,
    decoder: Decoder,
}

/// Decodes images.
#[derive(Default)]
struct Decoder {
    /// The last decoded image, as its channels are often requested in sequence.
    last: Option<((usize, bool), ImageData)>,
    /// The indices of images that the log has.
    logged: BTreeSet<usize>,
}

/// A lookup of a texture on a mesh whose parameters contain a map of texture coordinates.
#[derive(Clone, Copy)]
pub(super) struct Lookup<'a> {
    pub(super) info: &'a TextureInfo,
    pub(super) place: &'a Place,
    /// The map that the parameters of the mesh contain.
    pub(super) baked: UvMap,
}

/// Returns the map of texture coordinates of a texture's use (KHR_texture_transform).
pub(super) fn uv_map(info: &TextureInfo) -> UvMap {
    let Some(transform) = &info.extensions.transform else {
        return UvMap {
            set: info.tex_coord,
            ..UvMap::IDENTITY
        };
    };
    let ([su, sv], [ou, ov]) = (
        transform.scale.unwrap_or([1.0; 2]),
        transform.offset.unwrap_or([0.0; 2]),
    );
    let (sin, cos) = sin_cos(transform.rotation);
    UvMap {
        set: transform.tex_coord.unwrap_or(info.tex_coord),
        rows: [[cos * su, sin * sv, ou], [-sin * su, cos * sv, ov]],
    }
}

impl Textures {
    /// Returns a texture of colours, stored in `encoding`.
    pub(super) fn color(
        &mut self,
        context: &mut Context<'_>,
        lookup: Lookup<'_>,
        encoding: Encoding,
    ) -> Result<ColorTexture, GltfFault> {
        let texture = Found::of(context.document, lookup)?;
        let source = texture.source;
        let key = (source, encoding == Encoding::Srgb);
        let place = Place::of("images", source);
        let image = self.colors.get(key, texture.filter(), &place, || {
            let data = self.decoder.decode(context, source, encoding)?;
            Ok((data.width, data.rgb().collect()))
        })?;
        let map = texture.map(context, image, lookup)?;
        Ok(ColorTexture::Image(Arc::new(map)))
    }

    /// Returns a texture of numbers: one channel of a linear image, with a change.
    pub(super) fn number(
        &mut self,
        context: &mut Context<'_>,
        lookup: Lookup<'_>,
        part: Part,
        change: Change,
    ) -> Result<FloatTexture, GltfFault> {
        let texture = Found::of(context.document, lookup)?;
        let source = texture.source;
        let key = (source, format!("{part:?} {change:?}"));
        let place = Place::of("images", source);
        let image = self.numbers.get(key, texture.filter(), &place, || {
            let data = self.decoder.decode(context, source, Encoding::Linear)?;
            let numbers = channel(data, part).map(|value| [change.apply(value)]);
            Ok((data.width, numbers.collect()))
        })?;
        let map = texture.map(context, image, lookup)?;
        Ok(FloatTexture::Image(Arc::new(map)))
    }
}

impl Decoder {
    fn decode(
        &mut self,
        context: &mut Context<'_>,
        source: usize,
        encoding: Encoding,
    ) -> Result<&ImageData, GltfFault> {
        let key = (source, encoding == Encoding::Srgb);
        let is_known = self.last.as_ref().is_some_and(|(known, _)| *known == key);
        if !is_known {
            let place = Place::of("images", source);
            let Resource { bytes, file } = resource(context, source, &place)?;
            if let Some(file) = file.filter(|_| self.logged.insert(source)) {
                context.log.add(Content::Image, &bytes, [file]);
            }
            let format = format_of(&bytes, &context.document.root.images[source], &place)?;
            let decoded = image::decode_stored(format, &bytes, encoding);
            let counted = decoded.and_then(|data| context.log.reading.image(data));
            let data = counted.map_err(|error| GltfFault::from_error(place, &error))?;
            self.last = Some((key, data));
        }
        let (_, data) = self.last.as_ref().expect("it was just stored");
        Ok(data)
    }
}

fn channel(data: &ImageData, part: Part) -> impl Iterator<Item = f32> + '_ {
    let channels = data.channels.max(1);
    data.data
        .chunks_exact(channels)
        .map(move |pixel| match part {
            Part::Red => pixel[0],
            Part::Green => *pixel.get(1).unwrap_or(&pixel[0]),
            Part::Blue => *pixel.get(2).unwrap_or(&pixel[0]),
            Part::Alpha => *pixel.get(3).unwrap_or(&1.0),
        })
}

/// The parts of a texture: the number of its image, and its sampler.
struct Found<'a> {
    source: usize,
    sampler: Option<&'a Sampler>,
}

impl<'a> Found<'a> {
    fn of(document: &'a Document, lookup: Lookup<'_>) -> Result<Self, GltfFault> {
        let root = &document.root;
        let index = lookup.info.index;
        let texture = lookup.place.find(&root.textures, index, "texture")?;
        let place = Place::of("textures", index);
        let extensions = &texture.extensions;
        let webp = extensions.webp.as_ref().and_then(|webp| webp.source);
        let Some(source) = texture.source.or(webp) else {
            let others = [
                (&extensions.basisu, "its only image is a KTX2 file"),
                (&extensions.avif, "its only image is an AVIF file"),
                (&extensions.dds, "its only image is a DDS file"),
            ];
            let other = others.iter().find(|(other, _)| other.is_some());
            let found = other.map_or("it has no image", |(_, found)| *found);
            let fault = place.fault(ErrorKind::Unsupported, found);
            return Err(fault.with_hint(IMAGES_TO_EXPORT));
        };
        place.key("source").find(&root.images, source, "image")?;
        let sampler = texture.sampler.map(|sampler| {
            place
                .key("sampler")
                .find(&root.samplers, sampler, "sampler")
        });
        Ok(Self {
            source,
            sampler: sampler.transpose()?,
        })
    }

    fn filter(&self) -> ImageFilter {
        match self.sampler.and_then(|sampler| sampler.mag_filter) {
            Some(9728) => ImageFilter::Point,
            _ => ImageFilter::Bilinear,
        }
    }

    /// Returns the texture that looks up an image by the parameters of the mesh.
    fn map<const N: usize>(
        &self,
        context: &mut Context<'_>,
        image: Arc<Image<N>>,
        lookup: Lookup<'_>,
    ) -> Result<ImageMap<N>, GltfFault> {
        let place = lookup.place;
        let beyond = |wrap: fn(&Sampler) -> Option<u32>| beyond(self.sampler.and_then(wrap), place);
        let wrap = Wrap::Axes([
            beyond(|sampler| sampler.wrap_s)?,
            beyond(|sampler| sampler.wrap_t)?,
        ]);
        let requested = uv_map(lookup.info);
        if requested.set != lookup.baked.set {
            let what = "a material with textures of several sets of coordinates";
            context.unsupported(place.clone(), what, "one set is used for all")?;
        }
        Ok(ImageMap {
            image,
            wrap,
            filter: self.filter(),
            change: texture::Change::Scale(1.0),
            mapping: requested.beyond(&lookup.baked),
        })
    }
}

/// Reads the bytes of an image.
fn resource(
    context: &mut Context<'_>,
    source: usize,
    place: &Place,
) -> Result<Resource, GltfFault> {
    let document = context.document;
    let image = &document.root.images[source];
    match (&image.uri, image.buffer_view) {
        (Some(uri), _) => document.resource(&mut context.log, uri, &place.key("uri")),
        (None, Some(view)) => {
            let (bytes, _) = document.view(view, &place.key("bufferView"))?;
            let bytes = bytes.to_vec();
            Ok(Resource { bytes, file: None })
        }
        (None, None) => Err(place.scene("it has neither `uri` nor `bufferView`")),
    }
}

/// Returns the format of an image by its first bytes.
fn format_of(bytes: &[u8], described: &json::Image, place: &Place) -> Result<Format, GltfFault> {
    Format::of_bytes(bytes).ok_or_else(|| {
        let is_file = |uri: &&String| !uri.starts_with("data:");
        let name = described.uri.as_ref().filter(is_file);
        let file = name.map_or("it".into(), |uri| format!("`{}`", printable(uri)));
        let found = match image::other_format(bytes) {
            Some(name) => format!("{file} is {name}, which is not read"),
            None => format!("{file} is neither png, jpg nor webp"),
        };
        let fault = place.fault(ErrorKind::Unsupported, found);
        fault.with_hint(IMAGES_TO_EXPORT)
    })
}

/// The hint for images in other formats.
pub(super) const IMAGES_TO_EXPORT: &str =
    "export its images as png, jpg or webp; `ktx extract` makes png of KTX2";

/// Returns the wrapping of a sampler in one coordinate.
fn beyond(wrap: Option<u32>, place: &Place) -> Result<Beyond, GltfFault> {
    match wrap.unwrap_or(10497) {
        33071 => Ok(Beyond::Clamp),
        33648 => Ok(Beyond::Mirror),
        10497 => Ok(Beyond::Repeat),
        other => Err(place.scene(format!("{other} is not a wrap mode"))),
    }
}
