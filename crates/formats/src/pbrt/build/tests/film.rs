use super::refusals::outcome;
use super::{LoadOptions, STRICT, load_text};
use crate::error::ErrorKind;
use crate::pbrt::Crop;

#[test]
fn the_caller_may_choose_size_and_crop() {
    let text = "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 20\n\
        \"integer pixelbounds\" [10 20 0 10] WorldBegin";
    let options = LoadOptions {
        resolution: Some([80, 40]),
        ..STRICT
    };
    let film = load_text(text, &options).view.film().clone();
    assert_eq!((film.crop.min, film.crop.max), ([20, 0], [40, 20]));
    let options = LoadOptions {
        crop: Some(Crop::Pixels([1, 3, 2, 900])),
        ..STRICT
    };
    let film = load_text(text, &options).view.film().clone();
    assert_eq!((film.crop.min, film.crop.max), ([1, 2], [3, 20]));
}

#[test]
fn the_callers_size_and_crop_are_checked_with_and_without_a_film() {
    let small = "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 20 WorldBegin";
    let crop = |crop| LoadOptions {
        crop: Some(crop),
        ..STRICT
    };
    let size = |resolution| LoadOptions {
        resolution: Some(resolution),
        ..STRICT
    };
    let outside = "Options: s.pbrt:1:1: the crop lies outside the film of 1280 × 720 pixels";
    for (text, options, expected) in [
        (
            small,
            crop(Crop::Pixels([40, 50, 0, 10])),
            "Options: s.pbrt:1:6: the crop lies outside the film of 40 × 20 pixels",
        ),
        (
            "WorldBegin",
            crop(Crop::Pixels([1300, 1400, 0, 10])),
            outside,
        ),
        (
            "WorldBegin",
            crop(Crop::Fractions([0.0, 1.0, 0.5, 0.5])),
            outside,
        ),
        (
            "WorldBegin",
            size([0, 4]),
            "Limit: s.pbrt:1:1: the film has 0 × 4 pixels; each side can have 1 to 65536",
        ),
        (
            "WorldBegin",
            size([4, 65537]),
            "Limit: s.pbrt:1:1: the film has 4 × 65537 pixels; each side can have 1 to 65536",
        ),
        (
            "WorldBegin",
            size([20, 20]),
            "s.pbrt:1:1: the scene's film has another aspect ratio, 1280 × 720: the image is stretched, as pixels are 1.778",
        ),
    ] {
        let found = outcome(text, &options);
        assert!(found.starts_with(expected), "{found}");
    }
}

#[test]
fn the_size_of_a_film_has_its_place() {
    let place = |text: &str, options: &LoadOptions| {
        let found = load_text(text, options).film_place?;
        Some(found.error(ErrorKind::Memory, "large").to_string())
    };
    let sized = LoadOptions {
        resolution: Some([8, 8]),
        ..STRICT
    };
    for (film, at) in [
        ("", "1:1"),
        ("Film \"rgb\"", "1:6"),
        ("Film \"rgb\" \"integer xresolution\" 4000", "1:34"),
        ("Film \"rgb\" \"integer yresolution\" 4", "1:34"),
        (
            "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 20",
            "1:34",
        ),
        (
            "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 50",
            "1:59",
        ),
    ] {
        let text = format!("{film} WorldBegin");
        let expected = format!("s.pbrt:{at}: large");
        assert_eq!(place(&text, &STRICT), Some(expected), "{film}");
        assert_eq!(place(&text, &sized), None, "{film}");
    }
}
