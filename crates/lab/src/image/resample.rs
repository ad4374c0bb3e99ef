//! Resampling with a box filter.

use super::Pixels;

/// Resamples an image: each pixel is the mean of the area that it covers in `image`.
pub fn resample(image: &Pixels, size: [usize; 2]) -> Pixels {
    let [width, height] = image.size;
    let columns = overlaps(width, size[0]);
    let rows = overlaps(height, size[1]);
    let mut data = Vec::with_capacity(size[0] * size[1]);
    for row in &rows {
        for column in &columns {
            let mut sum = [0.0; 3];
            for &(y, in_row) in row {
                for &(x, in_column) in column {
                    let pixel = image.data[y * width + x];
                    for (total, channel) in sum.iter_mut().zip(pixel) {
                        *total += f64::from(channel) * in_row * in_column;
                    }
                }
            }
            data.push(sum.map(|channel| channel as f32));
        }
    }
    Pixels { size, data }
}

/// Divides a line into `to` and into `from` equal parts. For each of the `to` parts, returns the `from` parts
/// that overlap it, each with the fraction of the `to` part that it covers.
fn overlaps(from: usize, to: usize) -> Vec<Vec<(usize, f64)>> {
    let part = |i: usize| {
        // In units of 1 / (from · to), all ends are whole numbers.
        let (begin, end) = (i * from, (i + 1) * from);
        let meets = begin / to..end.div_ceil(to);
        let share = |k: usize| (end.min((k + 1) * to) - begin.max(k * to)) as f64 / from as f64;
        meets.map(|k| (k, share(k))).collect()
    };
    (0..to).map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(size: [usize; 2], values: &[f32]) -> Pixels {
        Pixels {
            size,
            data: values.iter().map(|&value| [value; 3]).collect(),
        }
    }

    #[test]
    fn whole_blocks_are_averaged() {
        let image = grey([4, 2], &[1.0, 3.0, 5.0, 5.0, 1.0, 3.0, 7.0, 7.0]);
        assert_eq!(resample(&image, [2, 1]), grey([2, 1], &[2.0, 6.0]));
    }

    #[test]
    fn broken_blocks_count_by_area() {
        let image = grey([3, 1], &[0.0, 3.0, 6.0]);
        assert_eq!(resample(&image, [2, 1]), grey([2, 1], &[1.0, 5.0]));
    }

    #[test]
    fn the_same_size_and_larger_ones_keep_values() {
        let image = grey([2, 1], &[1.0, 2.0]);
        assert_eq!(resample(&image, [2, 1]), image);
        assert_eq!(
            resample(&image, [4, 1]),
            grey([4, 1], &[1.0, 1.0, 2.0, 2.0])
        );
    }
}
