//! What each strategy (s, t) does, weighted and raw: contact sheets and figures of a film that keeps
//! images of strategies.
//!
//! A sheet has a row for each number n = s + t of vertices and a tile for each strategy, s growing
//! from left to right [Veach97, fig. 10.2]. Weighted tiles add up to the picture. A raw tile is C/π,
//! without the weight: all tiles of its row show the same light, as far as their strategies can make
//! its paths, each with the noise that it would have alone.

mod canvas;
mod figures;
mod font;
mod sheet;

pub use figures::{Figures, ImageFigures};

use crate::image::Pixels;
use bidir::film::{Film, Layers};
use bidir::path::Strategy;
use sheet::{Row, Tile};

/// The most vertices of the paths whose strategies are shown where nobody says it.
pub const VERTICES: u16 = 6;
/// The most pixels of a tile's image from side to side, and from top to bottom: images that are
/// larger are shown no better.
pub const TILE: usize = sheet::TILE;

/// What tiles show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// What strategies add to the picture.
    Weighted,
    /// What strategies show alone.
    Raw,
}

impl Kind {
    fn part(self, layers: &Layers, strategy: Strategy) -> Option<usize> {
        match self {
            Self::Weighted => layers.weighted_part(strategy),
            Self::Raw => layers.raw_part(strategy),
        }
    }

    /// What a newcomer has to know.
    fn caption(self, scene: &str, passes: u64) -> [String; 4] {
        let (name, meaning) = match self {
            Self::Weighted => (
                "weighted images of strategies (s, t)",
                "Each tile shows the contribution of its strategy; all tiles and longer paths \
                 add up to the image.",
            ),
            Self::Raw => (
                "raw images of strategies (s, t)",
                "Each tile shows its strategy alone, without its weight: the same light all \
                 along a row, as far as the strategy can make its paths. Dots and black parts \
                 are where the strategy is noisy, or makes no path.",
            ),
        };
        [
            format!("{scene}: {name}, {passes} spp"),
            "A path of s + t vertices has s from the light and t from the camera. A row has all \
             paths of one length: \
             to the right s grows, to the left t."
                .to_owned(),
            meaning.to_owned(),
            "x8, /8: shown 8 times as bright or as dark as it is, all of a row alike. mean: \
             luminance as it is."
                .to_owned(),
        ]
    }
}

/// The contact sheet of what `film` keeps of strategies; `scene` is what its caption calls it.
/// Range: linear colours for the screen.
pub fn sheet(film: &Film, kind: Kind, scene: &str) -> Pixels {
    let caption = kind.caption(scene, film.passes().len());
    sheet::draw(&caption, &rows(film, kind))
}

/// The rows of a sheet: the picture, then the strategies.
fn rows(film: &Film, kind: Kind) -> Vec<Row> {
    let longest = film.layers().strategy_vertices();
    let strategies = (2..=longest).map(|n| Row {
        name: row_name(n),
        tiles: (0..n)
            .filter_map(|s| strategy_tile(film, kind, Strategy::new(s, n - s)))
            .collect(),
    });
    std::iter::once(whole(film)).chain(strategies).collect()
}

fn row_name(n: usize) -> Vec<String> {
    let bounces = match n - 2 {
        1 => "1 bounce".to_owned(),
        bounces => format!("{bounces} bounces"),
    };
    vec![format!("{n} vertices"), bounces]
}

/// The picture, and what of it is in no row.
fn whole(film: &Film) -> Row {
    let longer =
        longer(film).map(|part| Tile::new("longer paths".to_owned(), &part_image(film, part)));
    let picture = pixels(film, film.develop().pixels);
    let picture = Tile::new("the picture".to_owned(), &picture);
    Row {
        name: vec!["all paths".to_owned()],
        tiles: std::iter::once(picture).chain(longer).collect(),
    }
}

/// The mean luminance of a film's picture.
pub fn mean(film: &Film) -> f64 {
    figures::mean_of(film, film.develop().pixels.into_iter())
}

/// The mean luminance of what paths add that are longer than those with images of their own.
pub fn mean_of_longer(film: &Film) -> f64 {
    longer(film).map_or(0.0, |part| figures::mean(film, part))
}

/// The part of paths that are longer than those with images of their own. None: there are no such images.
fn longer(film: &Film) -> Option<usize> {
    film.layers().part_names().position(|name| name == "longer")
}

/// The image of a strategy, as large as the film. None: the film keeps none.
pub fn strategy_image(film: &Film, kind: Kind, strategy: Strategy) -> Option<Pixels> {
    let part = kind.part(film.layers(), strategy)?;
    Some(part_image(film, part))
}

fn strategy_tile(film: &Film, kind: Kind, strategy: Strategy) -> Option<Tile> {
    let image = strategy_image(film, kind, strategy)?;
    let Strategy { s, t } = strategy;
    Some(Tile::new(format!("s={s} t={t}"), &image))
}

fn part_image(film: &Film, part: usize) -> Pixels {
    pixels(film, film.part_pixels(part).collect())
}

fn pixels(film: &Film, data: Vec<[f32; 3]>) -> Pixels {
    let crop = &film.settings().crop;
    let size = [crop.width() as usize, crop.height() as usize];
    Pixels { size, data }
}
