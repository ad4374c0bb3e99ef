//! `bidir render --pyramid DIR`: what each strategy (s, t) does, weighted and raw, as layers of one
//! EXR and as contact sheets.
//!
//! A sheet has a row for each number n = s + t of vertices and a tile for each strategy, s growing
//! from left to right [Veach97, fig. 10.2]. Weighted tiles add up to the picture. A raw tile is C/π,
//! without the weight: all tiles of its row show the same light, as far as their strategies can make
//! its paths, each with the noise that it would have alone.

mod canvas;
mod font;
mod sheet;

use crate::exit::{Exit, Failure};
use crate::film_header;
use crate::scene_io::{self, Developed, FilmHeader};
use bidir::film::{Film, LayerImage, Layers};
use bidir::path::Strategy;
use lab::image::Pixels;
use sheet::{Row, Tile};
use std::path::{Path, PathBuf};

/// The files of a pyramid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Files {
    exr: PathBuf,
    weighted: PathBuf,
    raw: PathBuf,
}

impl Files {
    /// The files in `folder`.
    pub(crate) fn new(folder: &Path) -> Self {
        let [exr, weighted, raw] =
            ["pyramid.exr", "weighted.png", "raw.png"].map(|name| folder.join(name));
        Self { exr, weighted, raw }
    }

    /// All of them.
    pub(crate) fn all(&self) -> [&PathBuf; 3] {
        [&self.exr, &self.weighted, &self.raw]
    }
}

/// Makes the folder of a pyramid where there is none; the one that it is in has to be there.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    if folder.is_dir() {
        return Ok(());
    }
    std::fs::create_dir(folder).map_err(|error| {
        let message = format!("{}: cannot make the folder: {error}", folder.display());
        Failure::new(Exit::InputOutput, message)
    })
}

/// What tiles show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Weighted,
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
                "A tile is what its strategy adds to the picture; all tiles and longer paths together are the picture.",
            ),
            Self::Raw => (
                "raw images of strategies (s, t)",
                "A tile is what its strategy shows alone, without its weight: the same light all along a row, as far as \
                 the strategy can make its paths. Dots and black parts are where it is bad at it, or cannot.",
            ),
        };
        [
            format!("{scene}: {name}, {passes} spp"),
            "A path of s + t vertices has s from the light and t from the camera. A row has all paths of one length: \
             to the right s grows, to the left t."
                .to_owned(),
            meaning.to_owned(),
            "x8, /8: shown 8 times as bright or as dark as it is, all of a row alike. mean: luminance as it is."
                .to_owned(),
        ]
    }
}

/// Writes what `film`, which has this header, keeps of strategies.
pub(crate) fn write(files: &Files, film: &Film, header: &FilmHeader) -> Result<(), Failure> {
    let metadata = film_header::metadata(header);
    scene_io::write_exr(&files.exr, film.settings(), &developed(film), &metadata)?;
    let scene = header.scene_name();
    for (path, kind) in [(&files.weighted, Kind::Weighted), (&files.raw, Kind::Raw)] {
        let caption = kind.caption(&scene, film.passes().len());
        scene_io::write_screen(path, &sheet::draw(&caption, &rows(film, kind)))?;
    }
    Ok(())
}

/// The picture with the images of strategies alone.
fn developed(film: &Film) -> Developed {
    let layers = film.layers();
    let names = layers.part_names().enumerate();
    let images = names.skip(layers.light_groups().len());
    let images = images.map(|(part, name)| LayerImage {
        name,
        channels: &["R", "G", "B"],
        data: film.part_pixels(part).flatten().collect(),
    });
    Developed {
        picture: film.develop(),
        layers: images.collect(),
    }
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
    let layers = film.layers();
    let longer = layers.part_names().position(|name| name == "longer");
    let longer = longer.map(|part| Tile::new("longer paths".to_owned(), &part_image(film, part)));
    let picture = pixels(film, film.develop().pixels);
    let picture = Tile::new("the picture".to_owned(), &picture);
    Row {
        name: vec!["all paths".to_owned()],
        tiles: std::iter::once(picture).chain(longer).collect(),
    }
}

fn strategy_tile(film: &Film, kind: Kind, strategy: Strategy) -> Option<Tile> {
    let part = kind.part(film.layers(), strategy)?;
    let Strategy { s, t } = strategy;
    Some(Tile::new(format!("s={s} t={t}"), &part_image(film, part)))
}

fn part_image(film: &Film, part: usize) -> Pixels {
    pixels(film, film.part_pixels(part).collect())
}

fn pixels(film: &Film, data: Vec<[f32; 3]>) -> Pixels {
    let crop = &film.settings().crop;
    let size = [crop.width() as usize, crop.height() as usize];
    Pixels { size, data }
}
