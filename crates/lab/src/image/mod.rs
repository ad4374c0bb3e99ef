//! Linear images in memory.
//!
//! [`Pixels`] holds linear Rec. 709 of any range. A [`Pair`] is an image and a reference of the same size, so
//! that no metric has to compare sizes.

mod resample;

pub use resample::resample;

use formats::image::{ImageData, Layers};
use sha2::{Digest, Sha256};

/// Linear colours, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Width and height.
    pub size: [usize; 2],
    /// Red, green and blue. Shape: `width · height`.
    pub data: Vec<[f32; 3]>,
}

impl Pixels {
    /// Returns the channels `R`, `G` and `B` behind `prefix`. None: one is missing.
    pub fn layer(layers: &Layers, prefix: &str) -> Option<Self> {
        let names = ["R", "G", "B"].map(|channel| format!("{prefix}{channel}"));
        let data = layers.triples(names.each_ref().map(String::as_str))?;
        let size = layers.size();
        Some(Self { size, data })
    }

    /// Iterates over all channels of all pixels.
    pub fn channels(&self) -> impl Iterator<Item = f64> + '_ {
        let channels = self.data.iter().flatten();
        channels.map(|&channel| f64::from(channel))
    }

    /// Computes the mean over pixels and channels. None: there are no pixels.
    pub fn mean(&self) -> Option<f64> {
        let count = 3 * self.data.len();
        (count > 0).then(|| self.channels().sum::<f64>() / count as f64)
    }
}

impl From<&ImageData> for Pixels {
    fn from(image: &ImageData) -> Self {
        Self {
            size: [image.width, image.height],
            data: image.rgb().collect(),
        }
    }
}

/// An image and its reference, of the same size.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    image: &'a Pixels,
    reference: &'a Pixels,
}

impl<'a> Pair<'a> {
    /// Pairs an image with its reference. None: their sizes differ.
    pub fn new(image: &'a Pixels, reference: &'a Pixels) -> Option<Self> {
        let same = image.size == reference.size && image.data.len() == reference.data.len();
        same.then_some(Self { image, reference })
    }

    /// Returns the image.
    pub fn image(&self) -> &'a Pixels {
        self.image
    }

    /// Returns the reference.
    pub fn reference(&self) -> &'a Pixels {
        self.reference
    }

    /// Returns width and height of both.
    pub fn size(&self) -> [usize; 2] {
        self.reference.size
    }
}

/// Computes the SHA-256 of the sizes and numbers of images, in hexadecimal.
pub fn digest(images: &[&Pixels]) -> String {
    let mut hash = Sha256::new();
    for pixels in images {
        for side in pixels.size {
            hash.update((side as u64).to_le_bytes());
        }
        for channel in pixels.data.iter().flatten() {
            hash.update(channel.to_le_bytes());
        }
    }
    let bytes = hash.finalize();
    let digits = bytes.iter().map(|byte| format!("{byte:02x}"));
    digits.collect()
}

/// Returns true if both have the same size, and the same bits in every channel.
pub fn identical(a: &Pixels, b: &Pixels) -> bool {
    let bits = |pixel: &[f32; 3]| pixel.map(f32::to_bits);
    a.size == b.size && a.data.iter().map(bits).eq(b.data.iter().map(bits))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Makes an image of one row.
    pub(crate) fn image(data: &[[f32; 3]]) -> Pixels {
        Pixels {
            size: [data.len(), 1],
            data: data.to_vec(),
        }
    }

    #[test]
    fn identical_images_have_the_same_size_and_bits() {
        let nan = image(&[[f32::NAN, 0.0, 1.0]]);
        assert!(identical(&nan, &nan));
        assert!(!identical(&image(&[[0.0; 3]]), &image(&[[-0.0, 0.0, 0.0]])));
        let mut turned = image(&[[0.0; 3], [0.0; 3]]);
        turned.size = [1, 2];
        assert!(!identical(&turned, &image(&[[0.0; 3], [0.0; 3]])));
    }

    #[test]
    fn digests_depend_on_sizes_and_bits() {
        let (one, two) = (image(&[[1.0; 3]]), image(&[[1.0; 3]; 2]));
        assert_eq!(digest(&[&one]), digest(&[&one.clone()]));
        let others = [
            digest(&[&two]),
            digest(&[&one, &one]),
            digest(&[&image(&[[-0.0; 3]])]),
        ];
        assert!(others.iter().all(|other| *other != digest(&[&one])));
        assert_ne!(digest(&[&image(&[[0.0; 3]])]), others[2]);
    }

    #[test]
    fn images_of_different_sizes_make_no_pair() {
        let (one, two) = (image(&[[1.0; 3]]), image(&[[1.0; 3]; 2]));
        assert!(Pair::new(&one, &two).is_none());
        assert_eq!(Pair::new(&two, &two).unwrap().size(), [2, 1]);
    }
}
