//! The channels of an EXR by name, to read, change and write again.

use super::exr::{ENCODING, OnePart, check_headers, not_written, read_part, subsampled};
use super::exr::{text, to_bytes};
use super::{Format, broken, catch_silently};
use crate::error::{Error, ErrorKind, Result};
use crate::{bytes, file, limits};
use exr::image::{AnyChannel, AnyChannels, FlatSamples};
use exr::meta::attribute::AttributeValue;
use std::path::Path;

/// The channels of an EXR, and its header.
///
/// Everything that is not changed is written as it was read: channels of any type, both windows, and all
/// attributes.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    image: OnePart,
}

impl Layers {
    /// Returns width and height of the data window. Unit: pixels.
    pub fn size(&self) -> [usize; 2] {
        let size = self.image.layer_data.size;
        [size.0, size.1]
    }

    /// Returns the names of all channels, such as `R` or `Albedo.R`, in the order of the file, which is
    /// alphabetical.
    pub fn names(&self) -> impl Iterator<Item = String> + '_ {
        let channels = self.image.layer_data.channel_data.list.iter();
        channels.map(|channel| channel.name.to_string())
    }

    /// Returns the numbers of a channel, row by row from the top left. None: there is no such channel.
    ///
    /// Shape: the product of [`size`](Self::size).
    pub fn channel(&self, name: &str) -> Option<Vec<f32>> {
        let mut channels = self.image.layer_data.channel_data.list.iter();
        let channel = channels.find(|channel| channel.name.eq(name))?;
        Some(channel.sample_data.values_as_f32().collect())
    }

    /// Returns the interleaved numbers of three channels. None: one of them is missing.
    ///
    /// Shape: the product of [`size`](Self::size).
    pub fn triples(&self, names: [&str; 3]) -> Option<Vec<[f32; 3]>> {
        let [x, y, z] = names.map(|name| self.channel(name));
        let pairs = x?.into_iter().zip(y?).zip(z?);
        Some(pairs.map(|((x, y), z)| [x, y, z]).collect())
    }

    /// Sets three channels of 32 bits, which replace those of the same names.
    ///
    /// Errors: the number of pixels is not that of the image; a name cannot be written.
    pub fn set_triples(&mut self, names: [&str; 3], data: &[[f32; 3]]) -> Result<()> {
        for (index, name) in names.into_iter().enumerate() {
            self.set_channel(name, data.iter().map(|triple| triple[index]).collect())?;
        }
        Ok(())
    }

    fn set_channel(&mut self, name: &str, data: Vec<f32>) -> Result<()> {
        let [width, height] = self.size();
        if data.len() != width * height {
            let message = format!("the channel `{name}` does not have the size of the image");
            return Err(not_written(message));
        }
        let channel = AnyChannel::new(text(name), FlatSamples::F32(data));
        let channels = &mut self.image.layer_data.channel_data;
        let mut list = std::mem::take(&mut channels.list);
        list.retain(|other| other.name != channel.name);
        list.push(channel);
        *channels = AnyChannels::sort(list);
        Ok(())
    }

    /// Returns the text of a non-standard attribute. None: it does not exist, or is not a text.
    pub fn text(&self, name: &str) -> Option<String> {
        let others = &self.image.layer_data.attributes.other;
        match others.get(&text(name))? {
            AttributeValue::Text(text) => Some(text.to_string()),
            _ => None,
        }
    }

    /// Sets an attribute to a text.
    pub fn set_text(&mut self, name: &str, value: &str) {
        let others = &mut self.image.layer_data.attributes.other;
        others.insert(text(name), AttributeValue::Text(text(value)));
    }
}

/// Reads all channels of an EXR.
///
/// Errors: the file cannot be read, is not an EXR, is broken, or has several parts or subsampled channels,
/// which cannot be written again.
pub fn read_layers(path: &Path) -> Result<Layers> {
    let bytes = bytes::read(path, limits::LARGEST_IMAGE)?.bytes;
    let of_bytes = Format::of_bytes(&bytes);
    if of_bytes.or(Format::of(path)) != Some(Format::Exr) {
        let error = Error::new(ErrorKind::Unsupported, "an image without named channels");
        return Err(error.with_hint("name an OpenEXR image").in_file(path));
    }
    decode_layers(&bytes).map_err(|error| error.in_file(path))
}

/// Decodes all channels of an EXR in memory; see [`read_layers`].
pub fn decode_layers(bytes: &[u8]) -> Result<Layers> {
    let decoded = catch_silently(|| decode(bytes));
    decoded.unwrap_or_else(|_| Err(broken("the decoder failed")))
}

fn decode(bytes: &[u8]) -> Result<Layers> {
    if check_headers(bytes)?.headers.len() > 1 {
        let error = Error::new(ErrorKind::Unsupported, "an EXR of several parts");
        return Err(error.with_hint("write its layers as channels of one part"));
    }
    let mut image = read_part(bytes)?;
    let layer = &mut image.layer_data;
    let pixels = layer.size.0 * layer.size.1;
    let mut channels = layer.channel_data.list.iter();
    if channels.any(|channel| channel.sample_data.len() != pixels) {
        return Err(subsampled());
    }
    layer.encoding = ENCODING;
    Ok(Layers { image })
}

/// Writes an EXR. Equal layers give equal bytes.
pub fn write_layers(path: &Path, layers: &Layers) -> Result<()> {
    let encoded = to_bytes(&layers.image).map_err(|error| error.in_file(path))?;
    file::replace(path, &encoded)
}

#[cfg(test)]
mod tests;
