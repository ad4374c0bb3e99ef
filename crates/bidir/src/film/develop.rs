//! Turns sums into values: mean = camera / passes + light / (passes · pixels), times exposure.

use super::layers::{Aov, AovKind, PART_SUMS, PICTURE_SUMS};
use super::{CAMERA, Film, LIGHT, MOMENT};
use crate::math::fixed::{self, MOMENT_SCALE, VALUE_SCALE};
use crate::spectrum::{Rgb, luminance};

/// A developed film: one colour and its variance per pixel, row by row from the top left of the
/// crop.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The number of pixels in a row.
    pub width: usize,
    /// The number of rows.
    pub height: usize,
    /// The mean of each pixel, in linear Rec. 709. Shape: `width · height`.
    pub pixels: Vec<Rgb>,
    /// The estimated variance of each pixel's mean; zero after a single pass.
    /// Shape: `width · height`.
    pub variance: Vec<Rgb>,
}

impl Picture {
    /// Returns the noise that is left: the root mean square of the pixels' standard errors, divided by the
    /// mean of the picture, both of luminance. Infinite for a black picture.
    ///
    /// The errors of a pixel's channels are treated as fully correlated, and stratified passes as independent, so
    /// that the result is rather too large than too small.
    pub fn relative_error(&self) -> f64 {
        let n = self.pixels.len().max(1) as f64;
        let luminances = self.pixels.iter().map(|rgb| f64::from(luminance(*rgb)));
        let mean = luminances.sum::<f64>() / n;
        let squares = self.variance.iter().map(|variance| {
            let error = f64::from(luminance(variance.map(f32::sqrt)));
            error * error
        });
        let error = libm::sqrt(squares.sum::<f64>() / n);
        if mean > 0.0 {
            error / mean
        } else {
            f64::INFINITY
        }
    }
}

/// A developed image beside the picture, with the same pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerImage {
    /// Its name; empty for channels that stand alone.
    pub name: String,
    /// The channels' names.
    pub channels: &'static [&'static str],
    /// The values, row by row from the top left of the crop; the channels of a pixel are side by side. Shape: `width
    /// · height · channels`.
    pub data: Vec<f32>,
}

impl Film {
    /// Returns the mean of all passes and the variance of this mean, both with exposure.
    pub fn develop(&self) -> Picture {
        let developed = self.pixels().map(|sums| self.develop_pixel(sums));
        let (pixels, variance) = developed.unzip();
        Picture {
            width: self.settings.crop.width() as usize,
            height: self.settings.crop.height() as usize,
            pixels,
            variance,
        }
    }

    /// Returns the images beside the picture: those of [`Layers::aovs`](super::Layers::aovs) in that order,
    /// then the parts of the picture.
    ///
    /// Parts have exposure applied. The values of an [`Aov`] are the mean or the sum that its [`AovKind`] describes.
    pub fn develop_layers(&self) -> Vec<LayerImage> {
        let aovs = self.layers.aovs().iter().flat_map(|&aov| self.aov(aov));
        let names = self.layers.part_names().enumerate();
        let parts = names.map(|(part, name)| LayerImage {
            name,
            channels: &["R", "G", "B"],
            data: self.part_pixels(part).flatten().collect(),
        });
        aovs.chain(parts).collect()
    }

    /// Returns the number of camera samples of a pixel, at least 1.
    fn samples(&self) -> f64 {
        self.passes.len().max(1) as f64
    }

    /// Returns the mean of camera samples plus the mean of splats, without exposure.
    fn mean(&self, camera: i128, light: i128) -> f64 {
        let all_pixels = self.samples() * self.settings.pixel_count().max(1) as f64;
        fixed::to_f64(camera, VALUE_SCALE) / self.samples()
            + fixed::to_f64(light, VALUE_SCALE) / all_pixels
    }

    fn develop_pixel(&self, sums: &[i128]) -> (Rgb, Rgb) {
        let passes = self.samples();
        let exposure = f64::from(self.settings.exposure);
        let (mut value, mut variance) = ([0.0; 3], [0.0; 3]);
        for channel in 0..3 {
            let mean = self.mean(sums[CAMERA + channel], sums[LIGHT + channel]);
            let square = fixed::to_f64(sums[MOMENT + channel], MOMENT_SCALE) / passes;
            value[channel] = (mean * exposure) as f32;
            let of_mean = (square - mean * mean).max(0.0) / (passes - 1.0).max(1.0);
            variance[channel] = (of_mean * exposure * exposure) as f32;
        }
        (value, variance)
    }

    /// Returns the pixels of part number `part` of [`Layers`](super::Layers), with exposure.
    pub fn part_pixels(&self, part: usize) -> impl Iterator<Item = Rgb> {
        self.pixels().map(move |sums| self.part(sums, part))
    }

    /// Returns a pixel of part number `part`, with exposure.
    fn part(&self, sums: &[i128], part: usize) -> Rgb {
        let begin = PICTURE_SUMS + self.layers.features() + PART_SUMS * part;
        let exposure = f64::from(self.settings.exposure);
        std::array::from_fn(|channel| {
            let (camera, light) = (sums[begin + channel], sums[begin + 3 + channel]);
            (self.mean(camera, light) * exposure) as f32
        })
    }

    /// Returns the cost of each pixel, time or rays, row by row from the top left of the crop. None: the film does
    /// not keep `aov`.
    pub fn cost(&self, aov: Aov) -> Option<Vec<f32>> {
        let is_kept = aov.kind() == AovKind::Cost && self.layers.aovs().contains(&aov);
        is_kept.then(|| self.feature(aov))
    }

    /// Returns the images that `aov` develops into.
    fn aov(&self, aov: Aov) -> Vec<LayerImage> {
        let channels = aov.channels();
        let data = match aov {
            Aov::Variance => self.variances().into(),
            Aov::Samples => vec![vec![self.passes.len() as f32; self.pixels().len()]],
            _ => vec![self.feature(aov)],
        };
        (channels.iter().zip(data))
            .map(|(channels, data)| LayerImage {
                name: channels.layer.to_owned(),
                channels: channels.names,
                data,
            })
            .collect()
    }

    /// Returns the variance of the mean of each channel, and this variance divided by the square of the mean, or 0 if
    /// the mean is 0.
    fn variances(&self) -> [Vec<f32>; 2] {
        let Picture {
            pixels, variance, ..
        } = self.develop();
        let absolute: Vec<_> = variance.into_iter().flatten().collect();
        let relative = (pixels.into_iter().flatten().zip(&absolute))
            .map(|(mean, variance)| {
                let square = mean * mean;
                if square > 0.0 { variance / square } else { 0.0 }
            })
            .collect();
        [absolute, relative]
    }

    /// Returns the developed values of a feature of camera samples. They are empty if the film does not keep it.
    fn feature(&self, aov: Aov) -> Vec<f32> {
        let of = |aov| Some(PICTURE_SUMS + self.layers.feature(aov)?);
        let Some(begin) = of(aov) else {
            return Vec::new();
        };
        let coverage = of(Aov::Coverage).filter(|_| aov.kind() == AovKind::Surface);
        let count = |sums: &[i128]| match (aov.kind(), coverage) {
            (AovKind::Cost, _) => 1.0,
            (_, Some(coverage)) => fixed::to_f64(sums[coverage], VALUE_SCALE),
            (_, None) => self.samples(),
        };
        let values = self.pixels().flat_map(|sums| {
            let count = count(sums);
            let scale = if count > 0.0 { 1.0 / count } else { 0.0 };
            let sums = &sums[begin..begin + aov.sums()];
            sums.iter()
                .map(move |&sum| (fixed::to_f64(sum, VALUE_SCALE) * scale) as f32)
        });
        values.collect()
    }
}
