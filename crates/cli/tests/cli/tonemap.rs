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
    place.run("compare same.png room.png --exact").expect(0);
    place
        .run("tonemap room.exr -o other.png --operator agx")
        .expect(0);
    place.run("compare other.png room.png --exact").expect(6);
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
