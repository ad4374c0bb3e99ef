//! The film in blocks, for each of which variance is estimated.

use super::super::spread;
use super::constants::BLOCKS_PER_SIDE as SIDE;
use super::survey::QUAD;
use crate::film::PixelRect;

/// The number of blocks.
pub(super) const BLOCKS: usize = SIDE * SIDE;

/// The division of a crop into 16 × 16 blocks, as equal as whole pixels allow. In a small crop some blocks have no
/// pixels.
#[derive(Clone, Debug)]
pub(super) struct Blocks {
    crop: PixelRect,
    /// The number of pixels of each block.
    sizes: Vec<f64>,
}

impl Blocks {
    pub(super) fn new(crop: PixelRect) -> Self {
        let [columns, rows] = [crop.width(), crop.height()].map(sizes);
        let sizes = rows
            .iter()
            .flat_map(|row| columns.map(|column| row * column));
        Self {
            crop,
            sizes: sizes.collect(),
        }
    }

    /// Returns the block of pixel number `index` of the crop.
    pub(super) fn of(&self, index: usize) -> usize {
        let [width, height] = [self.crop.width(), self.crop.height()].map(|size| size as usize);
        part(index / width, height) * SIDE + part(index % width, width)
    }

    /// Returns the number of pixels of block number `i`, at least 1.
    pub(super) fn size(&self, i: usize) -> f64 {
        self.sizes[i].max(1.0)
    }

    /// Returns the number of samples in each block, of the first `count` samples of the survey.
    pub(super) fn samples(&self, count: u64) -> Vec<f64> {
        let mut samples = vec![0.0; BLOCKS];
        for quad in 0..count / QUAD {
            let [x, y] = spread::point(&self.crop, quad).map(i64::from);
            if let Some(index) = self.crop.index(x, y) {
                samples[self.of(index)] += QUAD as f64;
            }
        }
        samples
    }
}

/// Returns the part, of [`SIDE`] equal parts of a side of `size` pixels, that pixel number `i` is in.
fn part(i: usize, size: usize) -> usize {
    i * SIDE / size
}

/// Returns the number of pixels in each part of a side of `size` pixels.
fn sizes(size: u32) -> [f64; SIDE] {
    let begin = |i: usize| (i * size as usize).div_ceil(SIDE);
    std::array::from_fn(|i| (begin(i + 1) - begin(i)) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(width: u32, height: u32) -> Blocks {
        let min = [3, 5];
        let max = [min[0] + width, min[1] + height];
        let blocks = Blocks::new(PixelRect { min, max });
        let mut counts = [0.0; BLOCKS];
        for index in 0..(width * height) as usize {
            counts[blocks.of(index)] += 1.0;
        }
        assert_eq!(counts.as_slice(), blocks.sizes);
        blocks
    }

    #[test]
    fn blocks_divide_the_crop() {
        let blocks = check(40, 20);
        assert!(blocks.sizes.iter().all(|size| (2.0..=6.0).contains(size)));
    }

    #[test]
    fn samples_are_spread_over_films_of_all_sizes() {
        for &max in &spread::tests::SIZES[..6] {
            let blocks = Blocks::new(PixelRect { min: [0; 2], max });
            let counts = blocks.samples(16 * BLOCKS as u64);
            for count in counts {
                assert!((8.0..=24.0).contains(&count), "{max:?}: {count}");
            }
        }
    }

    #[test]
    fn of_a_small_film_some_blocks_have_no_pixels() {
        let blocks = check(3, 1);
        let sizes = (0..BLOCKS).map(|i| blocks.size(i));
        assert!(sizes.into_iter().all(|size| (size - 1.0).abs() < 1e-9));
    }
}
