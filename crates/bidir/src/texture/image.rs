//! Images: rectangles of linear texels, with smaller copies for pixels that cover many texels.

/// A rectangle of texels with `N` linear channels; row 0 is the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image<const N: usize> {
    width: usize,
    height: usize,
    texels: Vec<[f32; N]>,
    /// The smallest and the largest value of each channel.
    bounds: [[f32; N]; 2],
    /// The smaller copies, each about half as wide and high as the one before, down to one texel; empty unless asked
    /// for.
    smaller: Vec<Self>,
}

impl<const N: usize> Image<N> {
    /// Makes an image of `texels.len() / width` rows. None: it is empty, or the last row is not complete.
    pub fn new(width: usize, texels: Vec<[f32; N]>) -> Option<Self> {
        let whole = width > 0 && !texels.is_empty() && texels.len().is_multiple_of(width);
        whole.then(|| Self {
            width,
            height: texels.len() / width,
            bounds: bounds(&texels),
            texels,
            smaller: Vec::new(),
        })
    }

    /// Adds smaller copies of the image, which take a third of its memory.
    ///
    /// A texel of a copy is the mean of the texels that it covers, weighted by the covered area: every copy has the
    /// mean of the image.
    #[must_use]
    pub fn with_copies(mut self) -> Self {
        self.smaller.clear();
        loop {
            let last = self.smaller.last().unwrap_or(&self);
            if last.width == 1 && last.height == 1 {
                return self;
            }
            let next = last.halved();
            self.smaller.push(next);
        }
    }

    /// Returns the number of smaller copies.
    #[inline]
    pub fn copies(&self) -> usize {
        self.smaller.len()
    }

    /// Returns copy `level`; 0 is the image itself.
    #[inline]
    pub fn copy(&self, level: usize) -> &Self {
        match level.checked_sub(1) {
            None => self,
            Some(i) => &self.smaller[i],
        }
    }

    /// Returns the number of texels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns the texels, row by row from the top.
    pub fn texels(&self) -> &[[f32; N]] {
        &self.texels
    }

    /// Returns the smallest and the largest value of each channel.
    pub fn bounds(&self) -> [[f32; N]; 2] {
        self.bounds
    }

    /// Returns the texel at column `x` of row `y`.
    #[inline]
    pub fn texel(&self, x: usize, y: usize) -> [f32; N] {
        self.texels[y * self.width + x]
    }

    fn halved(&self) -> Self {
        let (columns, rows) = (shares(self.width), shares(self.height));
        let mean = |x: &Shares, y: &Shares| -> [f32; N] {
            let mut sum = [0.0; N];
            for (j, row_weight) in y.iter() {
                for (i, weight) in x.iter() {
                    let texel = self.texel(i, j);
                    for (sum, value) in sum.iter_mut().zip(texel) {
                        *sum += f64::from(value) * weight * row_weight;
                    }
                }
            }
            sum.map(|sum| sum as f32)
        };
        let texels: Vec<_> = (rows.iter())
            .flat_map(|y| columns.iter().map(move |x| mean(x, y)))
            .collect();
        Self {
            width: columns.len(),
            height: rows.len(),
            bounds: bounds(&texels),
            texels,
            smaller: Vec::new(),
        }
    }
}

/// Returns the smallest and the largest value of each channel. A NaN makes both unbounded, because later operations
/// may turn it into any number.
fn bounds<const N: usize>(texels: &[[f32; N]]) -> [[f32; N]; 2] {
    let empty = [[f32::INFINITY; N], [f32::NEG_INFINITY; N]];
    let or = |value: f32, bound: f32| if value.is_nan() { bound } else { value };
    texels.iter().fold(empty, |[least, most], texel| {
        [
            std::array::from_fn(|i| least[i].min(or(texel[i], f32::MIN))),
            std::array::from_fn(|i| most[i].max(or(texel[i], f32::MAX))),
        ]
    })
}

/// The texels of a row that are averaged for one texel of a row half as long: the first index, and the weights of
/// this texel and the next two.
struct Shares {
    first: usize,
    weights: [f64; 3],
}

impl Shares {
    fn iter(&self) -> impl Iterator<Item = (usize, f64)> {
        let all = (self.first..).zip(self.weights);
        all.filter(|&(_, weight)| weight > 0.0)
    }
}

/// Returns the shares of each texel of a row half as long as one of `n` texels, rounded up.
fn shares(n: usize) -> Vec<Shares> {
    let short = n.div_ceil(2);
    // Lengths are in units of 1 / (n · short) of the row: all borders are whole numbers.
    let share = |i: usize| {
        let (begin, end) = (i * n, (i + 1) * n);
        let first = begin / short;
        let weights = [0, 1, 2].map(|k| {
            let (left, right) = ((first + k) * short, (first + k + 1) * short);
            let shared = right.min(end).saturating_sub(left.max(begin));
            shared as f64 / n as f64
        });
        Shares { first, weights }
    };
    (0..short).map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ragged_and_empty_images_are_refused() {
        assert!(Image::<1>::new(2, vec![[0.0]; 3]).is_none());
        assert!(Image::<1>::new(0, vec![]).is_none());
    }

    /// Every texel of every copy is the mean of the part of the image that it covers, computed
    /// from the image alone, texel by texel.
    #[test]
    fn copies_are_means_by_area() {
        for [width, height] in [[8, 8], [7, 5], [1, 9], [2, 1], [13, 6]] {
            let texels = (0..width * height).map(|i| [((i * 37 + 11) % 101) as f32]);
            let image = Image::new(width, texels.collect()).unwrap().with_copies();
            let last = image.copy(image.copies());
            assert_eq!([last.width(), last.height()], [1, 1]);
            let mean = |image: &Image<1>| {
                let sum: f64 = image.texels().iter().map(|texel| f64::from(texel[0])).sum();
                sum / image.texels().len() as f64
            };
            for level in 1..=image.copies() {
                let copy = image.copy(level);
                assert!((mean(copy) - mean(&image)).abs() < 1e-4, "{width}x{height}");
            }
            let half = image.copy(1);
            for y in 0..half.height() {
                for x in 0..half.width() {
                    let expected = mean_of(&image, [x, y], [half.width(), half.height()]);
                    let value = f64::from(half.texel(x, y)[0]);
                    assert!((value - expected).abs() < 1e-4, "{value} and {expected}");
                }
            }
        }
    }

    /// Returns the mean over cell (x, y) of `cells`, by summing over a grid that divides both evenly.
    fn mean_of(image: &Image<1>, [x, y]: [usize; 2], [columns, rows]: [usize; 2]) -> f64 {
        let (width, height) = (image.width(), image.height());
        let mut sum = 0.0;
        for j in 0..height {
            for i in 0..width {
                let (fine_x, fine_y) = (x * width + i, y * height + j);
                sum += f64::from(image.texel(fine_x / columns, fine_y / rows)[0]);
            }
        }
        sum / (width * height) as f64
    }
}
