//! A picture that images and text are drawn on. Linear colours; what is outside is cut.

use super::font;
use crate::image::Pixels;

/// A dot of a letter is a square of so many pixels.
const DOT: usize = 2;
/// The width of a letter with the gap to the next. Unit: pixels.
pub(super) const LETTER: usize = (font::WIDTH + 1) * DOT;
/// The height of a line with the gap to the next. Unit: pixels.
pub(super) const LINE: usize = (font::HEIGHT + 2) * DOT;

/// A picture to draw on.
pub(super) struct Canvas {
    pub(super) pixels: Pixels,
}

/// How wide a text is. Unit: pixels.
pub(super) fn text_width(text: &str) -> usize {
    text.chars().count() * LETTER
}

impl Canvas {
    /// An empty picture.
    pub(super) fn new(size: [usize; 2], color: [f32; 3]) -> Self {
        let data = vec![color; size[0] * size[1]];
        Self {
            pixels: Pixels { size, data },
        }
    }

    /// Draws an image with its top left corner at `at`, `scale` times as bright.
    pub(super) fn image(&mut self, [x, y]: [usize; 2], image: &Pixels, scale: f32) {
        let rows = image.data.chunks_exact(image.size[0].max(1));
        for (row, pixels) in rows.enumerate() {
            for (column, pixel) in pixels.iter().enumerate() {
                let color = pixel.map(|channel| channel * scale);
                self.set([x + column, y + row], color);
            }
        }
    }

    /// Writes a line of text with its top left corner at `at`.
    pub(super) fn text(&mut self, [x, y]: [usize; 2], text: &str, color: [f32; 3]) {
        for (i, letter) in text.chars().enumerate() {
            for (column, row) in font::dots(letter) {
                let [left, top] = [x + i * LETTER + column * DOT, y + row * DOT];
                for dot in 0..DOT * DOT {
                    self.set([left + dot % DOT, top + dot / DOT], color);
                }
            }
        }
    }

    fn set(&mut self, [x, y]: [usize; 2], color: [f32; 3]) {
        let [width, height] = self.pixels.size;
        if x < width && y < height {
            self.pixels.data[y * width + x] = color;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_stays_in_its_box_and_images_in_the_picture() {
        let mut canvas = Canvas::new([60, LINE], [0.0; 3]);
        canvas.text([0, 0], "Mg4", [1.0; 3]);
        let lit = canvas.pixels.data.iter().enumerate();
        let lit = lit.filter(|(_, color)| color[0] > 0.0);
        let right = lit.map(|(i, _)| i % 60).max();
        assert!(right.is_some_and(|right| right < text_width("Mg4")));
        let image = Pixels {
            size: [2, 1],
            data: vec![[0.5, 1.0, 2.0]; 2],
        };
        canvas.image([59, 3], &image, 2.0);
        let bits = |i: usize| canvas.pixels.data[i].map(f32::to_bits);
        assert_eq!(bits(3 * 60 + 59), [1.0f32, 2.0, 4.0].map(f32::to_bits));
        assert_eq!(bits(20 * 60), [0; 3]);
    }
}
