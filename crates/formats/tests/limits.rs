//! What a small file must not do: take memory or time that its bytes do not account for.

use bidir_formats::image::{self, Format};
use bidir_formats::pbrt::{LoadOptions, build, load, parse_text};
use bidir_formats::{Error, ErrorKind, ply};
use std::fs;

#[track_caller]
fn check(error: &Error, kind: ErrorKind, words: &str) {
    assert_eq!(error.kind(), kind, "{error}");
    assert!(error.to_string().contains(words), "{error}");
}

/// The limit that reading of this world runs into.
#[track_caller]
fn check_text(world: &str, words: &str) {
    let error = parse_text("s", &format!("WorldBegin\n{world}")).expect_err("too much");
    check(&error, ErrorKind::Limit, words);
}

/// The limit of a hundred primitives that building of this world runs into.
#[track_caller]
fn check_size(world: &str) {
    let options = LoadOptions {
        most_primitives: Some(100),
        ..LoadOptions::default()
    };
    let description = parse_text("s", &format!("WorldBegin\n{world}")).expect("it parses");
    let error = build(&description, &options).expect_err("too much");
    check(&error, ErrorKind::Limit, "more than 100 primitives");
}

#[track_caller]
fn check_image(format: Format, bytes: &[u8]) {
    let error = image::decode(format, bytes, None).expect_err("too short");
    check(&error, ErrorKind::Data, "too short for");
}

/// A PNG of 20000 × 20000 grey pixels, as far as its header goes.
fn large_png() -> Vec<u8> {
    let mut header = b"IHDR".to_vec();
    header.extend([20000_u32.to_be_bytes(); 2].concat());
    header.extend([8, 0, 0, 0, 0]);
    let mut crc = flate2::Crc::new();
    crc.update(&header);
    let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    png.extend(header);
    png.extend(crc.sum().to_be_bytes());
    png.extend(b"\0\0\0\x10IDAT");
    png
}

/// An EXR whose windows are larger than its pixels.
fn large_exr() -> Vec<u8> {
    let seed = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../fuzz/seeds/image/zip.exr"
    );
    let mut exr = fs::read(seed).expect("the seed is there").split_off(1);
    for window in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = exr.windows(window.len()).position(|bytes| bytes == window);
        let corner = at.expect("it has windows") + window.len() + 4 + 8;
        exr[corner..corner + 8].copy_from_slice(&[9999_u32.to_le_bytes(); 2].concat());
    }
    exr
}

#[test]
fn images_do_not_claim_what_they_cannot_hold() {
    check_image(Format::Png, &large_png());
    check_image(Format::Exr, &large_exr());
    let mut tga = [0; 18];
    (tga[2], tga[13], tga[15], tga[16]) = (10, 0x20, 0x20, 24);
    check_image(Format::Tga, &tga);
    let hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 9000 +X 9000\n";
    check_image(Format::Hdr, hdr);
}

/// Black pixels pack to a thousandth.
#[test]
fn images_that_pack_well_are_read() {
    let size = [2000, 2000];
    let png = image::encode_png(size, &vec![[0.0; 3]; 4_000_000]).unwrap();
    assert!(png.len() < 100_000, "{}", png.len());
    let image = image::decode(Format::Png, &png, None).unwrap();
    assert_eq!([image.width, image.height], [2000; 2]);
}

#[test]
fn meshes_have_indices_of_32_bits() {
    let header = "ply\nformat ascii 1.0\nelement vertex 4294967296\nelement face 1\nend_header\n";
    check(
        &ply::parse(header.as_bytes()).unwrap_err(),
        ErrorKind::Data,
        "more vertices",
    );
}

#[test]
fn attributes_are_few() {
    check_text(
        &"Attribute \"shape\" \"float radius\" 1 ".repeat(65),
        "more than 64 parameters",
    );
    let points = "0 ".repeat(4098);
    check_text(
        &format!("Attribute \"shape\" \"point3 P\" [{points}]"),
        "4096 values",
    );
}

#[test]
fn blocks_are_not_endless() {
    check_text(&"AttributeBegin ".repeat(65537), "more than 65536 deep");
}

#[test]
fn warnings_of_many_kinds_are_one() {
    let systems = (0..500).map(|i| format!("CoordSysTransform \"{i}\" "));
    let text = format!("WorldBegin {}", systems.collect::<String>());
    let warnings = parse_text("s", &text).unwrap().warnings;
    assert_eq!(warnings.len(), 201);
    assert_eq!(warnings[200].count, 300);
}

/// Three texts of which each includes the next a hundred times, by names that differ.
#[test]
fn texts_are_not_included_again_and_again() {
    let folder = tempfile::tempdir().unwrap();
    let including = |name: &str| {
        let names = (0..100).map(|i| format!("Include \"{}{name}\"\n", "./".repeat(i)));
        names.collect::<String>()
    };
    let comment = format!("#{}\n", "x".repeat(1 << 20));
    for (name, text) in [
        ("a.pbrt", format!("WorldBegin\n{}", including("b.pbrt"))),
        ("b.pbrt", including("c.pbrt")),
        ("c.pbrt", comment),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let error = load(&folder.path().join("a.pbrt"), &LoadOptions::default()).unwrap_err();
    check(&error, ErrorKind::Limit, "included repeatedly");
}

#[test]
fn primitives_and_vertices_are_counted_before_they_are_made() {
    let points = "0 0 1 ".repeat(60);
    check_size(&format!(
        "ObjectBegin \"o\" AreaLightSource \"diffuse\" Shape \"trianglemesh\" \"point3 P\" \
         [{points}] \"integer indices\" [0 1 2] ObjectEnd ObjectInstance \"o\" ObjectInstance \"o\""
    ));
    check_size(
        "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1] \"integer indices\" [0 1 2 3]",
    );
    check_size("Shape \"loopsubdiv\" \"integer levels\" 4 \"point3 P\" [0 0 0 1 0 0 0 1 0]");
}

#[test]
fn a_long_word_has_no_nearest_name() {
    let name = "n".repeat(1 << 20);
    let text = format!("WorldBegin MakeNamedMaterial \"{name}\" \"string type\" \"diffuse\" ");
    let error = parse_text("s", &format!("{text} NamedMaterial \"{name}m\"")).unwrap_err();
    assert!(error.hint().is_none());
    assert!(error.message().len() < 300);
}
