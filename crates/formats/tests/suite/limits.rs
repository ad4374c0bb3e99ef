//! Small files do not take memory or time out of proportion to their size.

use bidir_formats::image::{self, Format};
use bidir_formats::pbrt::{LoadOptions, build, load, parse_text};
use bidir_formats::{Error, ErrorKind, ply};
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use std::fs;
use std::io::Write;
use std::path::Path;

#[track_caller]
fn check(error: &Error, kind: ErrorKind, words: &str) {
    assert_eq!(error.kind(), kind, "{error}");
    assert!(error.to_string().contains(words), "{error}");
}

/// Checks the limit that parsing this world exceeds.
#[track_caller]
fn check_text(world: &str, words: &str) {
    let error = parse_text("s", &format!("WorldBegin\n{world}")).expect_err("too much");
    check(&error, ErrorKind::Limit, words);
}

/// Checks that building this world exceeds a limit of a hundred primitives.
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
    let error = image::decode(format, bytes, None).expect_err("too large");
    check(&error, ErrorKind::Limit, "too large for a file of");
}

/// Returns a chunk of a PNG.
fn chunk(name: [u8; 4], data: &[u8]) -> Vec<u8> {
    let named = [&name[..], data].concat();
    let mut crc = flate2::Crc::new();
    crc.update(&named);
    let length = (data.len() as u32).to_be_bytes();
    [&length[..], &named, &crc.sum().to_be_bytes()].concat()
}

/// Returns the header and the first rows of a black PNG.
fn black_png([width, height]: [u32; 2], [depth, color]: [u8; 2], rows: usize) -> Vec<u8> {
    let size = [width.to_be_bytes(), height.to_be_bytes()].concat();
    let header = [&size[..], &[depth, color, 0, 0, 0]].concat();
    let channels = if color == 2 { 3 } else { 1 };
    let row = 1 + (width as usize * channels * usize::from(depth)).div_ceil(8);
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder
        .write_all(&vec![0; rows * row])
        .expect("memory takes it");
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    png.extend(chunk(*b"IHDR", &header));
    png.extend(chunk(*b"PLTE", &[0, 0, 0, 255, 255, 255]));
    png.extend(chunk(*b"IDAT", &encoder.finish().expect("memory takes it")));
    png.extend(chunk(*b"IEND", &[]));
    png
}

/// Returns a lossless WebP of equal pixels, which take no bits.
fn grey_webp([width, height]: [u32; 2]) -> Vec<u8> {
    let size = (width - 1) | (height - 1) << 14;
    // No transformation, no cache, and for each channel a code of one symbol.
    let codes = [0x28, 0x59, 0xc9, 0x4a, 0xd6, 0xff, 0];
    let pixels = [&[0x2f][..], &size.to_le_bytes(), &codes].concat();
    let mut webp = b"RIFF\x18\0\0\0WEBPVP8L\x0c\0\0\0".to_vec();
    webp.extend(pixels);
    webp
}

/// Returns the EXR of a seed with windows that end at `corner`, outside its pixels.
fn large_exr(seed: &str, corner: [u32; 2]) -> Vec<u8> {
    let seeds = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/seeds/image");
    let mut exr = fs::read(Path::new(seeds).join(seed))
        .expect("the seed is there")
        .split_off(1);
    let last = corner.map(u32::to_le_bytes).concat();
    for window in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = exr.windows(window.len()).position(|bytes| bytes == window);
        let at = at.expect("it has windows") + window.len() + 4 + 8;
        exr[at..at + 8].copy_from_slice(&last);
    }
    exr
}

#[test]
fn image_sizes_are_limited_by_the_size_of_the_file() {
    check_image(Format::Png, &black_png([12000, 12000], [8, 2], 1));
    check_image(Format::Exr, &large_exr("zip.exr", [9999; 2]));
    // A block of B44 has 32 lines, also in an image of 5.
    check_image(Format::Exr, &large_exr("b44.exr", [3_997_704, 4]));
    check_image(Format::WebP, &grey_webp([8000; 2]));
    let small = image::decode(Format::WebP, &grey_webp([640, 480]), None).unwrap();
    assert_eq!([small.width, small.height], [640, 480]);
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

/// A row of 1-bit pixels takes an eighth of the bytes that it is decoded to.
#[test]
fn small_files_of_few_colours_are_read_and_truncated_ones_refused() {
    let png = black_png([1024, 1024], [1, 3], 1024);
    assert!(png.len() < 400, "{}", png.len());
    let image = image::decode(Format::Png, &png, None).unwrap();
    assert_eq!([image.width, image.height, image.channels], [1024, 1024, 3]);
    let cut = black_png([1024, 1024], [1, 3], 1000);
    let error = image::decode(Format::Png, &cut, None).unwrap_err();
    check(&error, ErrorKind::Data, "broken image");
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
fn the_number_of_attributes_is_limited() {
    check_text(
        &(0..65).fold(String::new(), |text, i| {
            text + &format!("Attribute \"shape\" \"float r{i}\" 1 ")
        }),
        "more than 64 parameters",
    );
    let points = "0 ".repeat(4098);
    check_text(
        &format!("Attribute \"shape\" \"point3 P\" [{points}]"),
        "4096 values",
    );
}

#[test]
fn the_depth_of_blocks_is_limited() {
    check_text(&"AttributeBegin ".repeat(65537), "more than 65536 deep");
}

#[test]
fn the_number_of_warnings_is_limited() {
    let systems = (0..500).map(|i| format!("CoordSysTransform \"{i}\" "));
    let text = format!("WorldBegin {}", systems.collect::<String>());
    let warnings = parse_text("s", &text).unwrap().warnings;
    assert_eq!(warnings.len(), 201);
    assert_eq!(warnings[200].count, 300);
}

/// Checks the limit that a text exceeds which includes a second text a number of times, which in turn
/// includes a third.
#[track_caller]
fn check_inclusions(times: [usize; 2], leaf: &str, words: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let including = |name: &str, times: usize| {
        let names = (0..times).map(|i| format!("Include \"{}{name}\"\n", "./".repeat(i % 100)));
        names.collect::<String>()
    };
    let top = format!("WorldBegin\n{}", including("b.pbrt", times[0]));
    let middle = including("c.pbrt", times[1]);
    for (name, text) in [("a.pbrt", &*top), ("b.pbrt", &middle), ("c.pbrt", leaf)] {
        fs::write(folder.path().join(name), text).expect("the folder is there");
    }
    let loaded = load(&folder.path().join("a.pbrt"), &LoadOptions::default());
    let error = loaded.expect_err("too much");
    check(&error, ErrorKind::Limit, words);
    assert!(error.line().is_some());
}

#[test]
fn repeated_inclusion_is_limited() {
    let comment = format!("#{}\n", "x".repeat(1 << 20));
    check_inclusions([100, 100], &comment, "bytes that are included again");
    check_inclusions([257, 257], "", "included more than 65536 times");
    let directives = "ReverseOrientation\n".repeat(1000);
    check_inclusions([20, 20], &directives, "stand for more than");
    let parameters = "\"bool b\"true".repeat(1000);
    let light = format!("AreaLightSource \"\" {parameters}\n");
    check_inclusions([40, 30], &light, "parameters");
}

#[test]
fn the_size_of_packed_texts_is_limited() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pbrt.gz");
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(b"WorldBegin\n").unwrap();
    encoder.write_all(&vec![b' '; 20 << 20]).unwrap();
    fs::write(&path, encoder.finish().unwrap()).unwrap();
    let error = load(&path, &LoadOptions::default()).unwrap_err();
    check(&error, ErrorKind::Limit, "unpack to more than");
    assert!(error.hint().is_some());
}

/// Subdivision, patches and instances make many triangles of few bytes.
#[test]
fn the_number_of_primitives_is_limited_by_the_size_of_the_file() {
    let check_built = |world: &str, words: &str| {
        let description = parse_text("s", &format!("WorldBegin\n{world}")).expect("it parses");
        let error = build(&description, &LoadOptions::default()).expect_err("too much");
        check(&error, ErrorKind::Limit, words);
    };
    let fan = "\"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0 -1 1 0 -1 0 0 -1 -1 0] \
        \"integer indices\" [0 1 2 0 2 3 0 3 4 0 4 5 0 5 6]";
    let levels = format!("Shape \"loopsubdiv\" \"integer levels\" 10 {fan}");
    check_built(&levels, "more than 41");
    let patches = "0 1 2 3 ".repeat(12_000);
    check_built(
        &format!(
            "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1] \
             \"integer indices\" [{patches}]"
        ),
        "primitives or vertices",
    );
    let places = "ObjectInstance \"o\" ".repeat(4);
    let lamp = format!(
        "AreaLightSource \"diffuse\" \"float power\" 1 \
         Shape \"loopsubdiv\" \"integer levels\" 7 {fan}"
    );
    check_built(
        &format!("ObjectBegin \"o\" {lamp} ObjectEnd {places}"),
        "shapes, counted at each place",
    );
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
