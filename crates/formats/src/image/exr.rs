//! OpenEXR: reads every kind of flat image, writes 32-bit scan lines.

use super::{ImageData, broken, check_size};
use crate::error::{Error, ErrorKind, Result};
use crate::file;
use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer};
use exr::meta::attribute::{AttributeValue, Chromaticities, IntegerBounds, LineOrder, Text};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::{Blocks, Compression, ReadChannels, ReadLayers, Vec2, WritableImage};
use std::io::Cursor;
use std::path::Path;

/// Channels named `layer.channel`, or only `channel` for the layer without a name.
#[derive(Clone, Copy, Debug)]
pub struct ExrLayer<'a> {
    /// The layer's name; empty for the picture itself.
    pub name: &'a str,
    /// The channels' names, such as `R`, `G`, `B`.
    pub channels: &'a [&'a str],
    /// The pixels row by row from the top left, with interleaved channels.
    pub data: &'a [f32],
}

impl<'a> ExrLayer<'a> {
    /// Makes a layer of colours, row by row from the top left.
    pub fn rgb(name: &'a str, pixels: &'a [[f32; 3]]) -> Self {
        Self {
            name,
            channels: &["R", "G", "B"],
            data: pixels.as_flattened(),
        }
    }
}

/// The value of an attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum MetadataValue {
    /// Text.
    Text(String),
    /// A number.
    Float(f32),
    /// A whole number.
    Integer(i32),
}

/// An image for [`write_exr`].
#[derive(Clone, Copy, Debug)]
pub struct ExrImage<'a> {
    /// Width and height of the whole picture: the display window. Unit: pixels.
    pub resolution: [usize; 2],
    /// Left, top, right and bottom (exclusive) of the stored pixels: the data window.
    pub crop: [usize; 4],
    /// The layers; no two channels have the same full name.
    pub layers: &'a [ExrLayer<'a>],
    /// Further attributes by name.
    pub metadata: &'a [(String, MetadataValue)],
}

impl<'a> ExrImage<'a> {
    /// Makes a whole picture of this width and height without attributes.
    pub fn whole(size: [usize; 2], layers: &'a [ExrLayer<'a>]) -> Self {
        Self {
            resolution: size,
            crop: [0, 0, size[0], size[1]],
            layers,
            metadata: &[],
        }
    }
}

/// Writes an EXR of 32-bit numbers with Rec. 709 primaries. Equal images give equal bytes.
pub fn write_exr(path: &Path, image: &ExrImage<'_>) -> Result<()> {
    let encoded = encode_exr(image).map_err(|error| error.in_file(path))?;
    file::replace(path, &encoded)
}

/// A file with one part and all of its channels.
pub(super) type OnePart = Image<Layer<AnyChannels<FlatSamples>>>;

/// The encoding of every written file.
pub(super) const ENCODING: Encoding = Encoding {
    compression: Compression::ZIP16,
    blocks: Blocks::ScanLines,
    line_order: LineOrder::Increasing,
};

/// Encodes the bytes that [`write_exr`] writes.
pub fn encode_exr(image: &ExrImage<'_>) -> Result<Vec<u8>> {
    let [left, top, right, bottom] = image.crop;
    let size = (right.saturating_sub(left), bottom.saturating_sub(top));
    let channels = channels(image.layers, size.0 * size.1)?;
    let mut attributes = LayerAttributes {
        layer_position: Vec2(left as i32, top as i32),
        software_name: None,
        ..LayerAttributes::default()
    };
    for (name, value) in image.metadata {
        let value = match value {
            MetadataValue::Text(value) => AttributeValue::Text(text(value)),
            MetadataValue::Float(value) => AttributeValue::F32(*value),
            MetadataValue::Integer(value) => AttributeValue::I32(*value),
        };
        attributes.other.insert(text(name), value);
    }
    let layer = Layer::new(size, attributes, ENCODING, channels);
    let [width, height] = image.resolution;
    let mut attributes = ImageAttributes::new(IntegerBounds::from_dimensions((width, height)));
    attributes.chromaticities = Some(REC709);
    to_bytes(&Image::new(attributes, layer))
}

/// Encodes a file with one part.
pub(super) fn to_bytes(image: &OnePart) -> Result<Vec<u8>> {
    let mut encoded = Vec::new();
    image
        .write()
        .to_buffered(Cursor::new(&mut encoded))
        .map_err(not_written)?;
    sort_attributes(&mut encoded);
    Ok(encoded)
}

pub(super) fn not_written(message: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::Data, format!("cannot write: {message}"))
}

/// Converts a text to bytes: Latin-1 if it has all characters, as the crate reads it, else UTF-8, as most
/// programs do. It never fails, so that no image is lost because of a name.
pub(super) fn text(text: &str) -> Text {
    Text::new_or_none(text).unwrap_or_else(|| Text::from_slice_unchecked(text.as_bytes()))
}

/// Returns the channels of all layers, each of `pixels` numbers.
fn channels(layers: &[ExrLayer<'_>], pixels: usize) -> Result<AnyChannels<FlatSamples>> {
    let mut channels = Vec::new();
    for layer in layers {
        let stride = layer.channels.len();
        if layer.data.len() != pixels * stride {
            let message = format!(
                "the layer `{}` does not have the size of the image",
                layer.name
            );
            return Err(not_written(message));
        }
        for (offset, channel) in layer.channels.iter().enumerate() {
            let name = match layer.name {
                "" => (*channel).to_owned(),
                layer => format!("{layer}.{channel}"),
            };
            let samples = layer
                .data
                .iter()
                .skip(offset)
                .step_by(stride)
                .copied()
                .collect();
            channels.push(AnyChannel::new(text(&name), FlatSamples::F32(samples)));
        }
    }
    Ok(AnyChannels::sort(channels.into_iter().collect()))
}

const REC709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

/// Sorts the attributes of a file with one part by name.
///
/// The crate writes them in the order of a hash map, which differs from run to run; their order
/// means nothing, and no offset in the file depends on it.
fn sort_attributes(encoded: &mut [u8]) {
    const MAGIC_AND_VERSION: usize = 8;
    let mut records = Vec::new();
    let mut at = MAGIC_AND_VERSION;
    while let Some(length) = attribute_length(&encoded[at..]) {
        records.push(encoded[at..at + length].to_vec());
        at += length;
    }
    records.sort();
    encoded[MAGIC_AND_VERSION..at].copy_from_slice(&records.concat());
}

/// Returns the length of an attribute: name, zero, type, zero, size, value. None: the header ends here.
fn attribute_length(bytes: &[u8]) -> Option<usize> {
    let zero_after = |from: usize| Some(from + bytes.get(from..)?.iter().position(|&b| b == 0)?);
    let name_end = zero_after(0).filter(|&end| end > 0)?;
    let type_end = zero_after(name_end + 1)?;
    let (size, _) = bytes.get(type_end + 1..)?.split_first_chunk::<4>()?;
    let length = type_end + 5 + u32::from_le_bytes(*size) as usize;
    (length <= bytes.len()).then_some(length)
}

/// Reads the headers, before memory is reserved. Errors: sizes are zero or too large.
pub(super) fn check_headers(bytes: &[u8]) -> Result<MetaData> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(broken)?;
    for header in &meta.headers {
        let channels = header.channels.list.len() as u64;
        let check =
            |Vec2(width, height)| check_size([width as u64, height as u64], channels, bytes);
        check(header.layer_size)?;
        // Blocks may be larger than the image, and memory is reserved for one.
        check(match header.blocks {
            BlockDescription::Tiles(tiles) => tiles.tile_size,
            BlockDescription::ScanLines => {
                let lines = header.compression.scan_lines_per_block();
                Vec2(header.layer_size.width(), lines)
            }
        })?;
    }
    Ok(meta)
}

/// Reads all channels of the first readable part.
pub(super) fn read_part(bytes: &[u8]) -> Result<OnePart> {
    // Not in parallel: a panic in a thread of the crate would end the process.
    exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(broken)
}

pub(super) fn decode(bytes: &[u8]) -> Result<ImageData> {
    check_headers(bytes)?;
    let layer = read_part(bytes)?.layer_data;
    let picked = pick_channels(&layer.channel_data.list)
        .ok_or_else(|| broken("it has neither the channels R, G, B nor Y"))?;
    let Vec2(width, height) = layer.size;
    let pixels = width * height;
    let channels = picked.len();
    let mut data = vec![0.0; pixels * channels];
    for (offset, channel) in picked.into_iter().enumerate() {
        if channel.sample_data.len() != pixels {
            return Err(subsampled());
        }
        let places = data.iter_mut().skip(offset).step_by(channels);
        for (place, value) in places.zip(channel.sample_data.values_as_f32()) {
            *place = value;
        }
    }
    Ok(ImageData {
        width,
        height,
        channels,
        data,
    })
}

/// Returns the error for channels with fewer numbers than pixels.
pub(super) fn subsampled() -> Error {
    broken("it has subsampled channels")
}

/// Returns the channels R, G, B and, if it exists, A; or else Y. Takes the unnamed layer, or if it has none of
/// them, the first layer that does.
fn pick_channels(list: &[AnyChannel<FlatSamples>]) -> Option<Vec<&AnyChannel<FlatSamples>>> {
    let find = |name: &str| list.iter().find(|channel| channel.name.eq(name));
    let colours = |prefix: &str| {
        let named = |channel: &str| find(&format!("{prefix}{channel}"));
        let rgb = [named("R")?, named("G")?, named("B")?];
        Some(rgb.into_iter().chain(named("A")).collect())
    };
    let prefix_of = |channel: &AnyChannel<FlatSamples>| {
        channel
            .name
            .to_string()
            .strip_suffix(".R")
            .map(|prefix| format!("{prefix}."))
    };
    colours("")
        .or_else(|| find("Y").map(|grey| vec![grey]))
        .or_else(|| {
            list.iter()
                .filter_map(prefix_of)
                .find_map(|prefix| colours(&prefix))
        })
}
