//! Orders of pixels in which consecutive pixels lie far apart on the film.

use crate::film::PixelRect;
use rayon::prelude::*;

/// Steps of the additive recurrence by 1/ρ and 1/ρ², ρ being the root of ρ³ = ρ + 1 \[Roberts18\]. Its points are
/// even along both sides, whatever their lengths. Unit: 2⁻⁶⁴ of a side.
const STEPS: [u64; 2] = [0xc13f_a9a9_02a6_328f, 0x91e1_0da5_c79e_7b1d];

/// Returns the pixel of point number `i` of the endless sequence. Its first points fill the film evenly, however many
/// they are.
pub(super) fn point(crop: &PixelRect, i: u64) -> [u32; 2] {
    let along = |step: u64, size: u32| {
        let part = i.wrapping_mul(step) >> 32;
        ((part * u64::from(size)) >> 32) as u32
    };
    let [x, y] = [
        along(STEPS[0], crop.width()),
        along(STEPS[1], crop.height()),
    ];
    [crop.min[0] + x, crop.min[1] + y]
}

/// Returns the indices of all pixels of a crop in row order, sorted by the fraction of x/ρ + y/ρ².
///
/// A run of 1/n of the pixels lies on the film like the points of a lattice. The fractions of pixels that are at most
/// two columns and two rows apart differ by 0.06 or more, so that no two of them are in the same run if n is at least
/// 18. It is not 17, because the fractions of few pixels are not quite even. The crop has at most 2³² - 1 pixels.
pub(super) fn permutation(crop: &PixelRect) -> Vec<u32> {
    let fraction = |i: u32| {
        let [x, y] = crop.pixel(i as usize).map(u64::from);
        let [x, y] = [x - u64::from(crop.min[0]), y - u64::from(crop.min[1])];
        x.wrapping_mul(STEPS[0])
            .wrapping_add(y.wrapping_mul(STEPS[1]))
    };
    let mut pixels: Vec<u32> = (0..crop.area() as u32).collect();
    pixels.par_sort_by_cached_key(|&i| fraction(i));
    pixels
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::integrator::group_size;

    /// Sizes of films; those from the seventh on are small, narrow, or near a number of pixels at which groups double.
    pub(in crate::driver) const SIZES: [[u32; 2]; 14] = [
        [2560, 1440],
        [920, 680],
        [720, 480],
        [1920, 1080],
        [320, 240],
        [4096, 64],
        [64, 48],
        [37, 31],
        [1024, 5],
        [3, 2000],
        [36, 32],
        [64, 72],
        [64, 65],
        [220, 150],
    ];

    /// Returns the group of each pixel, in row order.
    fn groups(crop: &PixelRect) -> Vec<u64> {
        let (pixels, size) = (permutation(crop), group_size(crop.area()));
        let mut groups = vec![u64::MAX; pixels.len()];
        for (position, &pixel) in pixels.iter().enumerate() {
            groups[pixel as usize] = position as u64 / size;
        }
        groups
    }

    #[test]
    fn neighbours_and_pixels_two_apart_share_no_light_subpath() {
        let crops = SIZES.map(|max| ([0; 2], max));
        let moved = SIZES.map(|[w, h]| ([101, 7], [101 + w, 7 + h]));
        for (min, max) in crops.into_iter().chain(moved) {
            let crop = PixelRect { min, max };
            let groups = groups(&crop);
            assert!(!groups.contains(&u64::MAX), "every pixel has a place");
            let group = |x: i64, y: i64| crop.index(x, y).map(|i| groups[i]);
            for (i, &own) in groups.iter().enumerate() {
                let [x, y] = crop.pixel(i).map(i64::from);
                for (dx, dy) in [-2, -1, 0, 1, 2]
                    .into_iter()
                    .flat_map(|dx| [(dx, 1), (dx, 2)])
                {
                    let other = group(x + dx, y + dy);
                    assert_ne!(other, Some(own), "{crop:?} {x} {y} {dx} {dy}");
                }
                for dx in [1, 2] {
                    assert_ne!(group(x + dx, y), Some(own), "{crop:?} {x} {y} {dx}");
                }
            }
        }
    }
}
