//! Means over blocks of pixels.

use crate::image::Pixels;

/// A division of images into square blocks. Blocks at the right and lower border may be smaller.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blocks {
    size: [usize; 2],
    block: usize,
}

/// Sums of the values of a channel in a block.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) count: f64,
    pub(crate) sum: f64,
    pub(crate) squares: f64,
}

impl Tally {
    pub(crate) fn mean(self) -> f64 {
        self.sum / self.count
    }
}

impl Blocks {
    /// Divides images into blocks of `block` × `block` pixels; 0 counts as 1.
    pub(crate) fn new(size: [usize; 2], block: usize) -> Self {
        let largest = size[0].max(size[1]);
        let block = block.clamp(1, largest.max(1));
        Self { size, block }
    }

    fn columns(self) -> usize {
        self.size[0].div_ceil(self.block)
    }

    /// Computes the sums of every block, row by row. Shape: `blocks · 3`, channels side by side.
    pub(crate) fn sums(self, pixels: &Pixels) -> Vec<Tally> {
        let rows = self.size[1].div_ceil(self.block);
        let mut sums = vec![Tally::default(); self.columns() * rows * 3];
        for (i, pixel) in pixels.data.iter().enumerate() {
            let block = self.of(i);
            for (channel, &value) in pixel.iter().enumerate() {
                let sum = &mut sums[block * 3 + channel];
                let value = f64::from(value);
                sum.count += 1.0;
                sum.sum += value;
                sum.squares += value * value;
            }
        }
        sums
    }

    /// Returns the index of a pixel's block, both row by row from the top left.
    pub(crate) fn of(self, pixel: usize) -> usize {
        let [x, y] = [pixel % self.size[0], pixel / self.size[0]];
        y / self.block * self.columns() + x / self.block
    }

    /// Returns left, top, right and bottom (exclusive) of the block of sum `index`. Unit: pixels.
    pub(crate) fn place(self, index: usize) -> [usize; 4] {
        let (x, y) = (index / 3 % self.columns(), index / 3 / self.columns());
        let [left, top] = [x * self.block, y * self.block];
        let right = (left + self.block).min(self.size[0]);
        let bottom = (top + self.block).min(self.size[1]);
        [left, top, right, bottom]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_at_the_border_are_smaller() {
        let pixels = Pixels {
            size: [3, 2],
            data: (0..6).map(|i| [i as f32, 1.0, 0.0]).collect(),
        };
        let blocks = Blocks::new(pixels.size, 2);
        let sums = blocks.sums(&pixels);
        assert_eq!(sums.len(), 6);
        assert!((sums[0].mean() - 2.0).abs() < 1e-12 && (sums[0].squares - 26.0).abs() < 1e-12);
        assert!((sums[3].mean() - 3.5).abs() < 1e-12 && (sums[3].count - 2.0).abs() < 1e-12);
        assert_eq!(blocks.place(1), [0, 0, 2, 2]);
        assert_eq!(blocks.place(5), [2, 0, 3, 2]);
        assert_eq!(Blocks::new([3, 2], usize::MAX).place(2), [0, 0, 3, 2]);
    }
}
