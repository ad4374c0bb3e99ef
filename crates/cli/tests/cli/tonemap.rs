use crate::common::Workplace;
use formats::image::Encoding;
use std::fs;

/// Writes an image of one row.
fn write_image(place: &Workplace, name: &str, colors: &[[f32; 3]]) {
    let mut bytes = format!("PF\n{} 1\n-1.0\n", colors.len()).into_bytes();
    bytes.extend(
        colors
            .iter()
            .flatten()
            .flat_map(|channel| channel.to_le_bytes()),
    );
    fs::write(place.path(name), bytes).unwrap();
}

/// Reads the bytes of a picture.
fn read_picture(place: &Workplace, name: &str) -> Vec<[u8; 3]> {
    let image = formats::image::read(&place.path(name), Some(Encoding::Linear)).unwrap();
    let byte = |channel: f32| (channel * 255.0).round() as u8;
    image.rgb().map(|color| color.map(byte)).collect()
}

/// Tone maps colours.
fn tonemap(colors: &[[f32; 3]], arguments: &str) -> Vec<[u8; 3]> {
    let place = Workplace::new();
    write_image(&place, "in.pfm", colors);
    place
        .run(&format!("tonemap in.pfm -o out.png {arguments}"))
        .expect(0)
        .says("wrote out.png");
    read_picture(&place, "out.png")
}

#[test]
fn the_default_picture_equals_that_of_the_render() {
    let place = Workplace::new();
    place.run("render room.pbrt -q -o room.exr").expect(0);
    place.run("tonemap room.exr -o same.png").expect(0);
    fs::create_dir(place.path("out")).unwrap();
    fs::copy(place.path("room.exr"), place.path("out/copy.exr")).unwrap();
    place
        .run("tonemap out/copy.exr")
        .expect(0)
        .says("wrote copy.png");
    place.run("compare copy.png room.png --exact").expect(0);
    // The default of a PNG would replace it.
    place.run("tonemap copy.png").expect(4).says("copy.png");
    place.run("compare same.png room.png --exact").expect(0);
    place
        .run("tonemap room.exr -o other.png --operator agx")
        .expect(0);
    place.run("compare other.png room.png --exact").expect(6);
}

#[test]
fn a_ramp_of_greys_stays_grey_and_in_order() {
    let grey = |step| [libm::exp2f(step as f32 / 16.0); 3];
    let ramp: Vec<_> = std::iter::once([0.0; 3])
        .chain((-160..=96).map(grey))
        .collect();
    for operator in ["srgb", "agx", "neutral"] {
        let shown = tonemap(&ramp, &format!("--operator {operator}"));
        assert_eq!(shown.len(), ramp.len());
        assert_eq!(shown[0], [0; 3], "{operator}: black stays black");
        assert!(shown[256][0] > 240, "{operator}: {:?}", shown[256]);
        let in_order = shown.is_sorted_by(|before, after| before[0] <= after[0]);
        assert!(in_order, "{operator}: {shown:?}");
        // The matrices of AgX have sums that are not quite 1.
        let spread = |[r, g, b]: &[u8; 3]| r.max(g).max(b) - r.min(g).min(b);
        assert!(shown.iter().all(|color| spread(color) <= 1), "{operator}");
    }
}

#[test]
fn a_stop_is_twice_the_light() {
    let colors = [
        [0.01, 0.1, 0.2],
        [0.4, 0.18, 0.02],
        [3.0, 0.5, 0.05],
        [0.0, -1.0, 0.3],
    ];
    for operator in ["srgb", "agx", "neutral"] {
        let operator = format!("--operator {operator}");
        for (stops, factor) in [("1", 2.0), ("-2", 0.25), ("3.0", 8.0)] {
            let scaled = colors.map(|color| color.map(|channel| channel * factor));
            let exposed = tonemap(&colors, &format!("{operator} --exposure {stops}"));
            assert_eq!(exposed, tonemap(&scaled, &operator), "{operator} {stops}");
        }
    }
}

#[test]
fn known_values_are_mapped_as_specified() {
    let coded = |operator: &str, color| tonemap(&[color], &format!("--operator {operator}"))[0];
    // 0.18 in sRGB is 117.6 of 255.
    assert_eq!(coded("srgb", [0.18, 0.0, 7.0]), [118, 0, 255]);
    // 0.14 = 0.18 - 0.04 in sRGB: PBR Neutral subtracts only the reflection.
    assert_eq!(coded("neutral", [0.18; 3]), [105; 3]);
    // The middle of the screen of exponent 2.2, coded for sRGB.
    assert!(
        coded("agx", [0.18; 3])
            .iter()
            .all(|value| (126..=129).contains(value))
    );
}

#[test]
fn invalid_light_is_black_and_infinite_light_bright() {
    let infinite = [f32::INFINITY; 3];
    let colors = [[f32::NAN; 3], [-1.0; 3], [f32::NEG_INFINITY; 3], infinite];
    for operator in ["srgb", "agx", "neutral"] {
        let shown = tonemap(&colors, &format!("--operator {operator}"));
        assert_eq!(shown[..3], [[0; 3]; 3], "{operator}");
        assert!(shown[3].iter().all(|channel| *channel >= 254), "{operator}");
    }
}

#[test]
fn wrong_input_is_an_error() {
    let place = Workplace::new();
    write_image(&place, "in.pfm", &[[1.0; 3]]);
    for (arguments, code, says) in [
        ("", 2, "`bidir tonemap` needs IMAGE"),
        ("in.pfm -o out.jpg", 2, "output images are .png"),
        (
            "in.pfm -o out.png --operator aces",
            2,
            "`aces` is not one of srgb, agx, neutral",
        ),
        (
            "in.pfm -o out.png --exposure bright",
            2,
            "a number of stops",
        ),
        ("in.pfm -o out.png --exposure inf", 2, "a number of stops"),
        ("missing.exr -o out.png", 4, "missing.exr"),
        ("room.pbrt -o out.png", 4, "room.pbrt"),
        (
            "in.pfm -o missing/out.png",
            4,
            "hint: make the folder `missing`, or",
        ),
    ] {
        place
            .run(&format!("tonemap {arguments}"))
            .expect(code)
            .says(says);
    }
    assert!(!place.path("out.png").exists());
}
