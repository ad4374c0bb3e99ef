use super::*;
use crate::cases;
use expect_test::expect_file;
use proptest::prelude::*;
use std::sync::LazyLock;

fn gradient(width: usize, height: usize) -> Vec<f32> {
    (0..width * height * 3)
        .map(|i| i as f32 * 0.125 - 1.0)
        .collect()
}

fn written(image: &ExrImage<'_>) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.exr");
    write_exr(&path, image).unwrap();
    std::fs::read(path).unwrap()
}

fn example(data: &[f32]) -> Vec<u8> {
    let metadata = [
        (
            "bidir/version".to_owned(),
            MetadataValue::Text("1.0".into()),
        ),
        ("bidir/seed".to_owned(), MetadataValue::Integer(7)),
        ("samplesPerPixel".to_owned(), MetadataValue::Integer(64)),
        ("renderTimeSeconds".to_owned(), MetadataValue::Float(1.5)),
    ];
    let variance: Vec<f32> = data.iter().map(|value| value.abs()).collect();
    let layers = [
        ExrLayer {
            name: "",
            channels: &["R", "G", "B"],
            data,
        },
        ExrLayer {
            name: "Variance",
            channels: &["R", "G", "B"],
            data: &variance,
        },
    ];
    written(&ExrImage {
        resolution: [20, 10],
        crop: [3, 2, 10, 7],
        layers: &layers,
        metadata: &metadata,
    })
}

#[test]
fn exr_survives_the_round_trip_and_always_has_the_same_bytes() {
    let data = gradient(7, 5);
    let bytes = example(&data);
    assert!((0..8).all(|_| example(&data) == bytes));
    let image = decode(Format::Exr, &bytes, None).unwrap();
    assert_eq!(
        image,
        ImageData {
            width: 7,
            height: 5,
            channels: 3,
            data
        }
    );
}

#[test]
fn exr_keeps_windows_attributes_and_primaries() {
    let bytes = example(&gradient(7, 5));
    let meta = ::exr::meta::MetaData::read_from_buffered(bytes.as_slice(), true).unwrap();
    let header = &meta.headers[0];
    let window = header.shared_attributes.display_window;
    assert_eq!((window.size.0, window.size.1), (20, 10));
    let position = header.own_attributes.layer_position;
    assert_eq!((position.0, position.1), (3, 2));
    let red = header.shared_attributes.chromaticities.unwrap().red;
    assert!((red.0 - 0.64).abs() < 1e-6);
    let names = header.own_attributes.other.keys();
    let mut names: Vec<_> = names.map(ToString::to_string).collect();
    names.sort();
    let expected = "bidir/seed bidir/version renderTimeSeconds samplesPerPixel";
    assert_eq!(names.join(" "), expected);
    let channels = header.channels.list.iter();
    let channels: Vec<_> = channels.map(|it| it.name.to_string()).collect();
    let expected = "B G R Variance.B Variance.G Variance.R";
    assert_eq!(channels.join(" "), expected);
}

#[test]
fn a_layer_of_the_wrong_size_is_refused() {
    let layers = [ExrLayer {
        name: "N",
        channels: &["X"],
        data: &[1.0],
    }];
    let image = ExrImage {
        resolution: [2, 2],
        crop: [0, 0, 2, 2],
        layers: &layers,
        metadata: &[],
    };
    let error = write_exr(Path::new("never.exr"), &image).unwrap_err();
    let expected = "never.exr: cannot write: the layer `N` does not have the size of the image";
    assert_eq!(error.to_string(), expected);
}

fn png(color: ::image::ExtendedColorType, stored: &[u8], size: [u32; 2]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let encoder = ::image::codecs::png::PngEncoder::new(&mut bytes);
    ::image::ImageEncoder::write_image(encoder, stored, size[0], size[1], color).unwrap();
    bytes
}

#[track_caller]
fn check_close(values: &[f32], expected: &[f32]) {
    assert_eq!(values.len(), expected.len());
    for (value, expected) in values.iter().zip(expected) {
        assert!((value - expected).abs() < 1e-6, "{value} is not {expected}");
    }
}

#[test]
fn png_is_decoded_by_its_encoding() {
    let bytes = png(::image::ExtendedColorType::Rgb8, &[0, 128, 255], [1, 1]);
    let half = 128.0 / 255.0;
    for (encoding, middle) in [
        (None, 0.215_860_5),
        (Some(Encoding::Srgb), 0.215_860_5),
        (Some(Encoding::Linear), half),
        (Some(Encoding::Gamma(2.0)), half * half),
    ] {
        let image = decode(Format::Png, &bytes, encoding).unwrap();
        assert_eq!(image.channels, 3);
        check_close(&image.data, &[0.0, middle, 1.0]);
    }
}

#[test]
fn sixteen_bits_grey_and_alpha_are_read() {
    use ::image::ExtendedColorType as Color;
    let check = |color, stored: &[u8], expected: &[f32]| {
        let bytes = png(color, stored, [1, 1]);
        let image = decode(Format::Png, &bytes, Some(Encoding::Linear)).unwrap();
        assert_eq!(image.channels, expected.len());
        check_close(&image.data, expected);
        image
    };
    check(Color::L16, &32768u16.to_ne_bytes(), &[32768.0 / 65535.0]);
    let grey = check(Color::La8, &[51, 7], &[0.2]);
    assert_eq!(grey.rgb().collect::<Vec<_>>(), [[0.2; 3]]);
    check(Color::Rgba8, &[51, 0, 255, 102], &[0.2, 0.0, 1.0, 0.4]);
}

#[test]
fn png_is_written_clamped_in_srgb() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.png");
    let pixels = [
        [0.0, 0.5, 1.0],
        [-1.0, f32::NAN, f32::INFINITY],
        [0.0031, 0.2158605, 2.0],
    ];
    write_png(&path, [3, 1], &pixels).unwrap();
    let image = ::image::open(&path).unwrap().into_rgb8();
    assert_eq!(image.into_raw(), [0, 188, 255, 0, 0, 255, 10, 128, 255]);
    assert!(write_png(&path, [2, 2], &pixels).is_err());
}

fn pfm(scale: &str, numbers: &[f32]) -> Vec<u8> {
    let order = if scale.starts_with('-') {
        f32::to_le_bytes
    } else {
        f32::to_be_bytes
    };
    let header = format!("PF\n1 2\n{scale}\n").into_bytes();
    [header, numbers.iter().flat_map(|&n| order(n)).collect()].concat()
}

#[test]
fn pfm_is_read_from_the_bottom_in_either_byte_order() {
    let numbers = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    for scale in ["1.0", "-1.0"] {
        let image = decode(Format::Pfm, &pfm(scale, &numbers), None).unwrap();
        assert_eq!((image.width, image.height, image.channels), (1, 2, 3));
        assert_eq!(image.data, [4.0, 5.0, 6.0, 1.0, 2.0, 3.0]);
    }
}

#[test]
fn broken_and_unknown_images_are_errors() {
    cases::check(&expect_file!["./cases.txt"], |input| {
        let (name, content) = cases::file(input);
        let decoded = decode_file(Path::new(name), &content, None);
        decoded.unwrap_err().to_string()
    });
    assert!(decode(Format::Exr, b"not exr", None).is_err());
    let missing = read(Path::new("nowhere/a.bmp"), None).unwrap_err();
    assert_eq!(missing.kind(), ErrorKind::MissingFile);
}

/// The seeds of the fuzz target have a letter for their format before the file.
fn seed(name: &str) -> Vec<u8> {
    let seeds = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/seeds/image");
    let seed = std::fs::read(Path::new(seeds).join(name)).unwrap();
    seed[1..].to_vec()
}

/// The first bytes decide, whatever the name says; Targa has no mark, and is known by its name.
#[test]
fn images_are_read_by_their_first_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let names = "rgb.bmp palette.gif rgb.qoi rgb.tiff packed.tiff rgb8.png rgb.jpg rgb.webp \
        rgb.hdr rgb.pfm zip.exr";
    for name in names.split(' ') {
        let bytes = seed(name);
        let format = Format::of_bytes(&bytes);
        assert_eq!(format, Format::of(Path::new(name)), "{name}");
        let expected = decode(format.unwrap(), &bytes, None).unwrap();
        for other in ["a.png", "a.jpg", "a.tga", "a.unknown", "without"] {
            let path = folder.path().join(other);
            std::fs::write(&path, &bytes).unwrap();
            assert_eq!(read(&path, None).unwrap(), expected, "{name} as {other}");
        }
    }
    let tga = seed("rgb.tga");
    assert_eq!(Format::of_bytes(&tga), None);
    std::fs::write(folder.path().join("a.TGA"), &tga).unwrap();
    assert!(read(&folder.path().join("a.TGA"), None).is_ok());
}

/// Formats without loss give the same six colours.
#[test]
fn every_format_has_the_same_colours() {
    let colors = decode(Format::Bmp, &seed("rgb.bmp"), None).unwrap();
    assert_eq!([colors.width, colors.height, colors.channels], [3, 2, 3]);
    assert_eq!(colors.data[..3], [1.0, 0.0, 0.0]);
    assert!((colors.data[9] - 0.2158).abs() < 1e-3, "{}", colors.data[9]);
    for (format, name) in [
        (Format::Gif, "palette.gif"),
        (Format::Qoi, "rgb.qoi"),
        (Format::Tiff, "rgb.tiff"),
    ] {
        assert_eq!(decode(format, &seed(name), None).unwrap(), colors, "{name}");
    }
    let mut linear = seed("rgb.qoi");
    linear[13] = 1;
    let linear = decode(Format::Qoi, &linear, None).unwrap();
    assert!((linear.data[9] - 128.0 / 255.0).abs() < 1e-6);
}

const FORMATS: [Format; 11] = [
    Format::Bmp,
    Format::Gif,
    Format::Qoi,
    Format::Tiff,
    Format::Png,
    Format::Jpeg,
    Format::WebP,
    Format::Tga,
    Format::Hdr,
    Format::Pfm,
    Format::Exr,
];

static VALID: LazyLock<[(Format, Vec<u8>); 3]> = LazyLock::new(|| {
    [
        (Format::Exr, example(&gradient(7, 5))),
        (
            Format::Png,
            png(::image::ExtendedColorType::Rgb8, &[7; 12], [2, 2]),
        ),
        (Format::Pfm, pfm("-1", &[1.0; 6])),
    ]
});

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        for format in FORMATS {
            let _ = decode(format, &bytes, None);
        }
        let _ = decode(Format::Hdr, &[b"#?RADIANCE\n".as_slice(), &bytes].concat(), None);
    }

    #[test]
    fn mutated_files_never_panic(at in any::<proptest::sample::Index>(), byte in any::<u8>()) {
        for (format, mut bytes) in VALID.clone() {
            let index = at.index(bytes.len());
            bytes[index] = byte;
            if let Ok(image) = decode(format, &bytes, None) {
                prop_assert_eq!(image.data.len(), image.width * image.height * image.channels);
            }
        }
    }
}

/// Returns an image of 2 x 2 pixels in tiles of 4 by `rows`.
fn tiled(rows: u32) -> Vec<u8> {
    use ::exr::prelude::*;
    let encoding = Encoding {
        compression: Compression::Uncompressed,
        blocks: Blocks::Tiles(Vec2(4, 4)),
        line_order: LineOrder::Increasing,
    };
    let channels = SpecificChannels::rgb(|_| (1.0_f32, 2.0_f32, 3.0_f32));
    let layer = Layer::new((2, 2), LayerAttributes::named("tiled"), encoding, channels);
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = Image::from_layer(layer);
    image
        .write()
        .non_parallel()
        .to_buffered(&mut bytes)
        .unwrap();
    let mut bytes = bytes.into_inner();
    let name = b"tiledesc\0";
    let at = bytes
        .windows(name.len())
        .position(|part| part == name)
        .unwrap();
    // After the size of the attribute, and the columns.
    let at = at + name.len() + 8;
    assert_eq!(bytes[at..at + 4], 4_u32.to_le_bytes());
    bytes[at..at + 4].copy_from_slice(&rows.to_le_bytes());
    bytes
}

#[test]
fn no_memory_is_reserved_for_tiles_without_bytes_in_the_file() {
    let decode = |rows| decode(Format::Exr, &tiled(rows), None);
    let image = decode(4).unwrap();
    assert_eq!(image.data[..3], [1.0, 2.0, 3.0]);
    let error = decode(1 << 26).unwrap_err().to_string();
    assert_eq!(error, "an image of 4 × 67108864 pixels is too large");
}

#[test]
fn texts_beyond_latin_1_are_written_as_utf_8() {
    assert_eq!(exr::text("µ").as_slice(), [0xb5]);
    assert_eq!(exr::text("部屋.pbrt").as_slice(), "部屋.pbrt".as_bytes());
}
