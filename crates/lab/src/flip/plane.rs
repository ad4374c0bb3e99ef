//! A channel of an image, and separable filters.

use rayon::prelude::*;

/// A channel: numbers row by row from the top left.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    size: [usize; 2],
    /// Shape: `width · height`.
    pub(super) data: Vec<f32>,
}

/// A one-dimensional filter: weights at the offsets -radius to radius.
#[derive(Clone, Debug)]
pub(super) struct Kernel {
    weights: Vec<f32>,
}

impl Kernel {
    /// Makes the filter with the weights `value(-radius)` to `value(radius)`. Unit of offsets: pixels.
    pub(super) fn new(radius: usize, value: impl Fn(f64) -> f64) -> Self {
        let radius = radius as i64;
        let weights = (-radius..=radius).map(|x| value(x as f64) as f32);
        Self {
            weights: weights.collect(),
        }
    }

    /// Normalises the positive weights to sum 1, and the negative ones to sum -1.
    pub(super) fn normalised(self) -> Self {
        let sum_of = |sign: f32| -> f64 {
            let part = self.weights.iter().filter(|weight| **weight * sign > 0.0);
            part.map(|weight| f64::from(weight.abs())).sum()
        };
        let (positive, negative) = (sum_of(1.0), sum_of(-1.0));
        let weights = self.weights.iter().map(|&weight| {
            let sum = if weight < 0.0 { negative } else { positive };
            (f64::from(weight) / sum) as f32
        });
        Self {
            weights: weights.collect(),
        }
    }

    fn radius(&self) -> usize {
        self.weights.len() / 2
    }
}

impl Plane {
    pub(super) fn new(size: [usize; 2], data: Vec<f32>) -> Self {
        Self { size, data }
    }

    pub(super) fn scaled(mut self, factor: f32) -> Self {
        for value in &mut self.data {
            *value *= factor;
        }
        self
    }

    pub(super) fn plus(mut self, other: &Self) -> Self {
        add(&mut self.data, 1.0, &other.data);
        self
    }

    /// Computes Σ_k w_k · p(x + k, y), repeating the border pixels.
    pub(super) fn along_rows(&self, kernel: &Kernel) -> Self {
        let [width, _] = self.size;
        let radius = kernel.radius();
        let filter = |(out, row): (&mut [f32], &[f32])| {
            let mut padded = vec![row[0]; radius];
            padded.extend_from_slice(row);
            padded.resize(width + 2 * radius, row[width - 1]);
            for (k, &weight) in kernel.weights.iter().enumerate() {
                add(out, weight, &padded[k..k + width]);
            }
        };
        let mut data = vec![0.0; self.data.len()];
        data.par_chunks_mut(width.max(1))
            .zip(self.data.par_chunks(width.max(1)))
            .for_each(filter);
        Self { data, ..*self }
    }

    /// Computes Σ_k w_k · p(x, y + k), repeating the border pixels.
    pub(super) fn along_columns(&self, kernel: &Kernel) -> Self {
        let [width, height] = self.size;
        let radius = kernel.radius();
        let filter = |(y, out): (usize, &mut [f32])| {
            for (k, &weight) in kernel.weights.iter().enumerate() {
                let from = (y + k).saturating_sub(radius).min(height - 1);
                add(out, weight, &self.data[from * width..][..width]);
            }
        };
        let mut data = vec![0.0; self.data.len()];
        data.par_chunks_mut(width.max(1))
            .enumerate()
            .for_each(filter);
        Self { data, ..*self }
    }
}

/// Adds `weight` · `row` to `out`.
fn add(out: &mut [f32], weight: f32, row: &[f32]) {
    for (out, value) in out.iter_mut().zip(row) {
        *out += weight * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_repeat_the_border_pixels() {
        let plane = Plane::new([3, 2], vec![1.0, 2.0, 4.0, 8.0, 16.0, 32.0]);
        let kernel = Kernel {
            weights: vec![1.0, 10.0, 100.0],
        };
        let rows = plane.along_rows(&kernel).data;
        assert_eq!(rows, [211.0, 421.0, 442.0, 1688.0, 3368.0, 3536.0]);
        let columns = plane.along_columns(&kernel).data;
        assert_eq!(columns, [811.0, 1622.0, 3244.0, 881.0, 1762.0, 3524.0]);
    }

    #[test]
    fn weights_of_each_sign_are_normalised() {
        let kernel = Kernel::new(2, |x| x * x * x).normalised();
        assert_eq!(
            kernel.weights,
            [-8.0 / 9.0, -1.0 / 9.0, 0.0, 1.0 / 9.0, 8.0 / 9.0]
        );
    }
}
