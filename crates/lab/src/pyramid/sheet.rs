//! A contact sheet: a caption, then rows of tiles in the shape of a pyramid, each row as bright as
//! it takes to see it [Veach97, fig. 10.2].

use super::canvas::{Canvas, LINE, text_width};
use crate::image::{Pixels, resample};
use bidir::spectrum::luminance;

/// The most pixels of a tile's image from side to side, and from top to bottom.
pub(super) const TILE: usize = 180;
/// Between tiles, and around all.
const GAP: usize = 14;
/// Lines of a tile's label.
const LABEL: usize = 2 * LINE + 6;
/// The column in which rows are named.
const NAMES: usize = 150;
/// The least width, for the caption.
const LEAST_WIDTH: usize = 640;

const BACKGROUND: [f32; 3] = [0.015; 3];
const BRIGHT: [f32; 3] = [0.9, 0.9, 0.9];
const DIM: [f32; 3] = [0.35, 0.35, 0.35];
const EXPOSURE: [f32; 3] = [0.9, 0.55, 0.1];

/// An image with its name.
pub(super) struct Tile {
    pub(super) name: String,
    mean: f64,
    /// As small as it is shown.
    image: Pixels,
}

impl Tile {
    pub(super) fn new(name: String, image: &Pixels) -> Self {
        let luminances = image.data.iter().map(|pixel| f64::from(luminance(*pixel)));
        Self {
            name,
            mean: luminances.sum::<f64>() / image.data.len().max(1) as f64,
            image: resample(image, fitted(image.size)),
        }
    }

    /// The luminances of the pixels that are not black, from dim to bright.
    fn lit(&self) -> Vec<f32> {
        let values = self.image.data.iter().map(|pixel| luminance(*pixel));
        let mut lit: Vec<_> = values.filter(|value| *value > 0.0).collect();
        lit.sort_by(f32::total_cmp);
        lit
    }

    /// The second line of the label.
    fn number(&self) -> String {
        let mean = self.mean;
        match mean.abs() {
            0.0 => "no light".to_owned(),
            0.001..1000.0 => format!("mean {mean:.4}"),
            _ => format!("mean {mean:.2e}"),
        }
    }
}

/// Tiles that are shown equally bright.
pub(super) struct Row {
    /// The lines of its name.
    pub(super) name: Vec<String>,
    pub(super) tiles: Vec<Tile>,
}

impl Row {
    /// How many times the brightness is doubled, so that nine tenths of the lit pixels of the
    /// brightest tile are below white.
    ///
    /// A tile of few pixels, compared with others of its row, is noise: it has no say.
    fn stops(&self) -> i32 {
        let lit: Vec<_> = self.tiles.iter().map(Tile::lit).collect();
        let most = lit.iter().map(Vec::len).max().unwrap_or(0);
        let image = lit.iter().filter(|values| 2 * values.len() > most);
        let bright = image.map(|values| values[values.len() * 9 / 10]);
        let bright = bright.fold(0.0, f32::max);
        if bright > 0.0 {
            libm::log2f(0.9 / bright).floor().clamp(-30.0, 30.0) as i32
        } else {
            0
        }
    }
}

/// The brightness as text: `x8`, `/2`.
fn exposure(stops: i32) -> String {
    let factor = 1u32 << stops.unsigned_abs();
    match (stops, factor) {
        (0.., 1..10_000) => format!("x{factor}"),
        (0.., _) => format!("x2e{stops}"),
        (..0, 1..10_000) => format!("/{factor}"),
        (..0, _) => format!("/2e{}", -stops),
    }
}

/// The size in which an image is shown.
fn fitted([width, height]: [usize; 2]) -> [usize; 2] {
    let longest = width.max(height).max(1);
    [width, height].map(|side| (side * TILE / longest).max(1))
}

/// Where things are.
struct Layout {
    size: [usize; 2],
    /// Lines of the caption.
    caption: Vec<String>,
    /// The corners of the tiles, by row.
    tiles: Vec<Vec<[usize; 2]>>,
}

impl Layout {
    /// The layout of rows of so many tiles, whose images are `height` high.
    fn new(caption: &[String], rows: &[usize], height: usize) -> Self {
        let columns = rows.iter().copied().max().unwrap_or(0);
        let pitch = [TILE + GAP, height + LABEL + GAP];
        let width = (NAMES + columns * pitch[0] + GAP).max(LEAST_WIDTH);
        let lines = caption
            .iter()
            .flat_map(|text| wrapped(text, width - 2 * GAP));
        let caption: Vec<_> = lines.collect();
        let top = GAP + caption.len() * LINE + GAP;
        let place = |(row, &tiles): (usize, &usize)| {
            let left = NAMES + (columns - tiles) * pitch[0] / 2;
            let corner = |i| [left + i * pitch[0], top + row * pitch[1]];
            (0..tiles).map(corner).collect()
        };
        Self {
            size: [width, top + rows.len() * pitch[1]],
            caption,
            tiles: rows.iter().enumerate().map(place).collect(),
        }
    }
}

/// Lines of a text, none of them wider than `width` unless one word is.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().expect("there is a first line");
        if line.is_empty() {
            line.push_str(word);
        } else if text_width(line) + text_width(word) + text_width(" ") <= width {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

/// Draws a sheet. Range: what the screen cannot show is cut.
pub(super) fn draw(caption: &[String], rows: &[Row]) -> Pixels {
    let tiles = rows.iter().flat_map(|row| &row.tiles);
    let height = tiles.map(|tile| tile.image.size[1]).max().unwrap_or(1);
    let counts: Vec<_> = rows.iter().map(|row| row.tiles.len()).collect();
    let layout = Layout::new(caption, &counts, height);
    let mut canvas = Canvas::new(layout.size, BACKGROUND);
    for (i, line) in layout.caption.iter().enumerate() {
        let color = if i == 0 { BRIGHT } else { DIM };
        canvas.text([GAP, GAP + i * LINE], line, color);
    }
    for (row, corners) in rows.iter().zip(&layout.tiles) {
        let Some([_, y]) = corners.first() else {
            continue;
        };
        for (i, line) in row.name.iter().enumerate() {
            canvas.text([GAP, y + i * LINE], line, BRIGHT);
        }
        let stops = row.stops();
        for (tile, corner) in row.tiles.iter().zip(corners) {
            draw_tile(&mut canvas, *corner, tile, (stops, height));
        }
    }
    canvas.pixels
}

/// Draws an image of a row of that brightness and height, with its label below.
fn draw_tile(canvas: &mut Canvas, [x, y]: [usize; 2], tile: &Tile, (stops, height): (i32, usize)) {
    let [width, own_height] = tile.image.size;
    let corner = [x + (TILE - width) / 2, y + (height - own_height) / 2];
    canvas.image(corner, &tile.image, libm::exp2f(stops as f32));
    let below = y + height + 6;
    canvas.text([x, below], &tile.name, BRIGHT);
    let exposure = exposure(stops);
    let right = x + TILE - text_width(&exposure).min(TILE);
    canvas.text([right, below], &exposure, EXPOSURE);
    canvas.text([x, below + LINE], &tile.number(), DIM);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(size: [usize; 2], value: f32) -> Pixels {
        let data = vec![[value; 3]; size[0] * size[1]];
        Pixels { size, data }
    }

    #[test]
    fn labels_fit_their_tiles() {
        let gap = text_width(" ");
        for stops in -30..=30 {
            let first = text_width("s=16 t=16") + gap + text_width(&exposure(stops));
            assert!(first <= TILE, "{}", exposure(stops));
        }
        for value in [0.0, 1e-38, 1e-3, 999.99, -999.99, 1e30, -1e-30] {
            let tile = Tile::new(String::new(), &image([3, 2], value));
            assert!(text_width(&tile.number()) <= TILE, "{}", tile.number());
        }
        assert!(GAP + text_width("16 vertices") <= NAMES);
    }

    #[test]
    fn tiles_are_inside_and_apart() {
        let rows: Vec<_> = (2..=16).collect();
        let caption = ["a caption that is not short, but of many words".to_owned()];
        let layout = Layout::new(&caption, &rows, 90);
        let corners: Vec<_> = layout.tiles.iter().flatten().collect();
        let [width, height] = [TILE, 90 + LABEL];
        for (i, [x, y]) in corners.iter().enumerate() {
            assert!(x + width <= layout.size[0] && y + height <= layout.size[1]);
            let apart = |[a, b]: [usize; 2]| x.abs_diff(a) >= width || y.abs_diff(b) >= height;
            assert!(corners[..i].iter().all(|other| apart(**other)));
        }
        // Each row is centred below the one before.
        let middle = |row: &[[usize; 2]]| row[0][0] + row[row.len() - 1][0];
        assert_eq!(middle(&layout.tiles[0]), middle(&layout.tiles[14]));
    }

    #[test]
    fn images_keep_their_shape() {
        assert_eq!(fitted([400, 300]), [180, 135]);
        assert_eq!(fitted([4, 8]), [90, 180]);
        assert_eq!(fitted([1, 100_000]), [1, 180]);
    }

    #[test]
    fn rows_are_as_bright_as_it_takes() {
        let row = |values: &[f32]| Row {
            name: Vec::new(),
            tiles: values
                .iter()
                .map(|value| Tile::new(String::new(), &image([2, 2], *value)))
                .collect(),
        };
        assert_eq!(row(&[0.1, 0.02]).stops(), 3);
        assert_eq!(row(&[4.0]).stops(), -3);
        assert_eq!(row(&[0.0]).stops(), 0);
        let mut noisy = row(&[0.1, 0.0, 0.0]);
        noisy.tiles[1].image.data[7] = [9.0; 3];
        assert_eq!(noisy.stops(), 3);
        assert_eq!(exposure(3), "x8");
        assert_eq!(exposure(-3), "/8");
    }

    #[test]
    fn captions_are_broken_between_words() {
        let lines = wrapped("one two three", text_width("one two"));
        assert_eq!(lines, ["one two", "three"]);
    }
}
