//! Maps of FLIP: the difference that an observer sees between each render and the reference of its scene.

use super::ReportImage;
use crate::image::Pair;
use crate::metric::Metric;
use rayon::iter::{IntoParallelRefMutIterator, ParallelIterator};

/// Maximum number of pixels of all maps of a page, as half a million take about a second of one core for
/// images of rooms.
pub(super) const MOST_PIXELS: usize = 1 << 22;

/// Adds a map to each render whose scene has a reference of the same size: the largest difference over all
/// exposures. Proceeds in order, and leaves out images that would exceed `MOST_PIXELS`.
pub fn add_flip(images: &mut [ReportImage]) {
    let (mut left, mut wanted) = (MOST_PIXELS, Vec::new());
    let (references, renders): (Vec<_>, Vec<_>) =
        images.iter_mut().partition(|image| image.is_reference);
    for render in renders {
        let reference = references.iter().find(|other| other.scene == render.scene);
        let count = render.pixels.data.len();
        if let (Some(reference), true) = (reference, count <= left) {
            left -= count;
            wanted.push((render, &reference.pixels));
        }
    }
    wanted.par_iter_mut().for_each(|(image, reference)| {
        let pair = Pair::new(&image.pixels, reference);
        image.flip = pair.map(|pair| Metric::FlipHdr.errors(&pair));
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Pixels;

    fn image(scene: &str, is_reference: bool, size: [usize; 2], value: f32) -> ReportImage {
        ReportImage {
            scene: scene.to_owned(),
            name: String::new(),
            is_reference,
            pixels: Pixels {
                size,
                data: vec![[value; 3]; size[0] * size[1]],
            },
            flip: None,
        }
    }

    #[test]
    fn renders_have_the_map_against_their_own_reference() {
        let reference = |scene, value| image(scene, true, [4, 3], value);
        let mut images = [
            reference("a", 0.5),
            image("a", false, [4, 3], 0.5),
            image("b", false, [4, 3], 0.5),
            reference("b", 0.05),
            image("b", false, [5, 3], 0.5),
            image("c", false, [4, 3], 0.5),
        ];
        add_flip(&mut images);
        let has: Vec<_> = images.iter().map(|image| image.flip.is_some()).collect();
        assert_eq!(has, [false, true, true, false, false, false]);
        let mean = |index: usize| Metric::FlipHdr.pool(images[index].flip.as_ref().unwrap());
        assert!(mean(1).abs() < 1e-12 && mean(2) > 0.1);
    }

    /// The one that is too large is left out; what fits behind it is not.
    #[test]
    fn large_images_are_bounded() {
        let side = 1 << 11;
        let mut images = [
            image("a", true, [side, side + 1], 0.5),
            image("a", false, [side, side + 1], 0.4),
            image("b", true, [4, 3], 0.5),
            image("b", false, [4, 3], 0.4),
        ];
        add_flip(&mut images);
        let has: Vec<_> = images.iter().map(|image| image.flip.is_some()).collect();
        assert_eq!(has, [false, false, false, true]);
    }
}
