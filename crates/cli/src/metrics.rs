//! How far an image is from a reference, in numbers; over all pixels and channels alike.

/// Linear colours, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pixels {
    /// Width and height.
    pub(crate) size: [usize; 2],
    /// Red, green and blue. Shape: `width · height`.
    pub(crate) data: Vec<[f32; 3]>,
}

impl Pixels {
    fn channels(&self) -> impl Iterator<Item = f64> + '_ {
        self.data
            .iter()
            .flatten()
            .map(|&channel| f64::from(channel))
    }

    /// The mean channel.
    fn mean(&self) -> f64 {
        mean(self.channels())
    }
}

/// The mean of all numbers; NaN where there are none.
fn mean(numbers: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = numbers.fold((0u64, 0.0), |(count, sum), number| {
        (count + 1, sum + number)
    });
    sum / count as f64
}

/// Pairs of channels of images of the same size.
fn pairs<'a>(a: &'a Pixels, b: &'a Pixels) -> impl Iterator<Item = (f64, f64)> + 'a {
    a.channels().zip(b.channels())
}

/// √mean (a - b)².
pub(crate) fn rmse(a: &Pixels, b: &Pixels) -> f64 {
    mean(pairs(a, b).map(|(a, b)| (a - b) * (a - b))).sqrt()
}

/// mean (a - b)² / (b² + ε), with the ε of the field: 0.01.
pub(crate) fn relmse(a: &Pixels, b: &Pixels) -> f64 {
    const EPSILON: f64 = 0.01;
    mean(pairs(a, b).map(|(a, b)| (a - b) * (a - b) / (b * b + EPSILON)))
}

/// The mean of `a` divided by the mean of `b`; 1 where both are black.
pub(crate) fn mean_ratio(a: &Pixels, b: &Pixels) -> f64 {
    let (a, b) = (a.mean(), b.mean());
    if a == 0.0 && b == 0.0 { 1.0 } else { a / b }
}

/// True where both have the same size, and the same bits in every channel.
pub(crate) fn identical(a: &Pixels, b: &Pixels) -> bool {
    let bits = |pixel: &[f32; 3]| pixel.map(f32::to_bits);
    a.size == b.size && a.data.iter().map(bits).eq(b.data.iter().map(bits))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(data: &[[f32; 3]]) -> Pixels {
        Pixels {
            size: [data.len(), 1],
            data: data.to_vec(),
        }
    }

    #[track_caller]
    fn check(computed: f64, expected: f64) {
        assert!(
            (computed - expected).abs() < 1e-9,
            "{computed} is not {expected}"
        );
    }

    #[test]
    fn errors_are_as_defined() {
        let a = image(&[[1.0, 2.0, 3.0], [0.0, 0.0, 0.0]]);
        let b = image(&[[1.0, 1.0, 1.0], [0.0, 0.0, 0.0]]);
        check(rmse(&a, &b), (5.0f64 / 6.0).sqrt());
        check(relmse(&a, &b), 5.0 / 1.01 / 6.0);
        check(mean_ratio(&a, &b), 2.0);
        check(mean_ratio(&image(&[[0.0; 3]]), &image(&[[0.0; 3]])), 1.0);
    }

    #[test]
    fn identity_is_of_bits() {
        let nan = image(&[[f32::NAN, 0.0, 1.0]]);
        assert!(identical(&nan, &nan));
        assert!(!identical(&image(&[[0.0; 3]]), &image(&[[-0.0, 0.0, 0.0]])));
        let mut turned = image(&[[0.0; 3], [0.0; 3]]);
        turned.size = [1, 2];
        assert!(!identical(&turned, &image(&[[0.0; 3], [0.0; 3]])));
    }
}
