use super::{LoadOptions, STRICT, check, load_text, refusal};
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

/// Checks the error of a scene with `options`, and its kind.
#[track_caller]
fn check_error(text: &str, options: &LoadOptions, kind: ErrorKind, expected: &str) {
    let error = refusal(text, options);
    assert_eq!((error.kind(), &*error.to_string()), (kind, expected));
}

#[test]
fn the_callers_size_and_crop_are_checked_with_and_without_a_film() {
    let small = "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 20 WorldBegin";
    let crop = |crop| LoadOptions {
        crop: Some(crop),
        ..STRICT
    };
    check_error(
        small,
        &crop(Crop::Pixels([40, 50, 0, 10])),
        ErrorKind::Options,
        "s.pbrt:1:6: the crop lies outside the film of 40 × 20 pixels",
    );
    check_error(
        "WorldBegin",
        &crop(Crop::Pixels([1300, 1400, 0, 10])),
        ErrorKind::Options,
        "s.pbrt:1:1: the crop lies outside the film of 1280 × 720 pixels",
    );
    check_error(
        "WorldBegin",
        &crop(Crop::Fractions([0.0, 1.0, 0.5, 0.5])),
        ErrorKind::Options,
        "s.pbrt:1:1: the crop lies outside the film of 1280 × 720 pixels",
    );
    let size = |resolution| LoadOptions {
        resolution: Some(resolution),
        ..STRICT
    };
    for (resolution, name) in [([0, 4], "0 × 4"), ([4, 65537], "4 × 65537")] {
        let expected =
            format!("s.pbrt:1:1: the film has {name} pixels; each side can have 1 to 65536");
        check_error("WorldBegin", &size(resolution), ErrorKind::Limit, &expected);
    }
    let [warning] = &load_text("WorldBegin", &size([20, 20])).warnings[..] else {
        panic!("the pixels are not square");
    };
    let expected = "s.pbrt:1:1: the scene's film has another aspect ratio, 1280 × 720: \
                    the image is stretched, as pixels are 1.778";
    assert!(warning.starts_with(expected), "{warning}");
}

/// Checks the radius in the warning of a filter. None: there is no warning.
#[track_caller]
fn check_narrow(filter: &str, radius: Option<&str>) {
    let loaded = load_text(&format!("PixelFilter {filter} WorldBegin"), &STRICT);
    let expected = radius.map(|radius| {
        format!(
            "s.pbrt:1:13: the filter is as narrow as a box with a radius of {radius} pixels: \
             light subpaths rarely hit it, so `bdpt` and `light` will be noisy"
        )
    });
    assert_eq!(loaded.warnings, Vec::from_iter(expected), "{filter}");
}

#[test]
fn filters_much_narrower_than_a_pixel_cause_warnings() {
    for kind in ["box", "triangle", "gaussian", "mitchell", "sinc"] {
        check_narrow(&format!("\"{kind}\""), None);
        let narrow = format!("\"{kind}\" \"float xradius\" 0.001");
        let [warning] =
            &load_text(&format!("PixelFilter {narrow} WorldBegin"), &STRICT).warnings[..]
        else {
            panic!("{kind} is narrow");
        };
        assert!(warning.starts_with("s.pbrt:1:13: the filter is as narrow"));
    }
    check_narrow("\"box\" \"float xradius\" 0.25", None);
    check_narrow("\"box\" \"float yradius\" 0.24", Some("0.240"));
    check_narrow("\"triangle\" \"float xradius\" 0.4", Some("0.200"));
    // A wide filter may have a narrow peak.
    check_narrow("\"gaussian\" \"float sigma\" 0.05", Some("0.063"));
}

#[test]
fn an_infinite_exposure_is_refused_with_its_place() {
    check(
        "Camera \"perspective\" \"float shutterclose\" 1e30\nFilm \"rgb\" \"float iso\" \
         1e10\nWorldBegin",
        "s.pbrt:2:24: the exposure is not a finite number: 1e30 seconds · iso 1e10 / 100",
    );
    check(
        "Camera \"perspective\" \"float shutteropen\" -3e38 \"float shutterclose\" \
         3e38\nWorldBegin",
        "s.pbrt:1:8: the exposure is not a finite number: inf seconds · iso 1e2 / 100",
    );
    let text = "Film \"rgb\" \"float iso\" 3e38 WorldBegin";
    assert!(load_text(text, &STRICT).view.film().exposure.is_finite());
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
