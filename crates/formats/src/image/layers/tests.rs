use super::*;
use crate::image::{ExrImage, ExrLayer, MetadataValue, write_exr};
use ::exr::prelude::WritableImage;
use proptest::prelude::*;
use std::sync::LazyLock;
use tempfile::TempDir;

const SIZE: [usize; 2] = [4, 3];

fn ramp(step: f32) -> Vec<[f32; 3]> {
    let pixels = (0..SIZE[0] * SIZE[1]).map(|pixel| pixel as f32);
    pixels.map(|pixel| [pixel, pixel * step, -pixel]).collect()
}

/// Writes a crop of a picture, with albedo, to `a.exr`.
fn example() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let layer = |name, data| ExrLayer {
        name,
        channels: &["R", "G", "B"],
        data,
    };
    let [color, albedo] = [ramp(0.5), ramp(0.25)];
    let metadata = [
        ("bidir/seed".to_owned(), MetadataValue::Integer(7)),
        ("bidir/version".to_owned(), MetadataValue::Text("µ".into())),
    ];
    let image = ExrImage {
        resolution: [20, 10],
        crop: [3, 2, 7, 5],
        layers: &[
            layer("", color.as_flattened()),
            layer("Albedo", albedo.as_flattened()),
        ],
        metadata: &metadata,
    };
    write_exr(&folder.path().join("a.exr"), &image).unwrap();
    folder
}

static BYTES: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let folder = example();
    std::fs::read(folder.path().join("a.exr")).unwrap()
});

#[test]
fn channels_have_names_and_numbers() {
    let folder = example();
    let layers = read_layers(&folder.path().join("a.exr")).unwrap();
    assert_eq!(layers.size(), SIZE);
    let names: Vec<_> = layers.names().collect();
    let expected = ["Albedo.B", "Albedo.G", "Albedo.R", "B", "G", "R"];
    assert_eq!(names, expected);
    assert_eq!(layers.triples(["R", "G", "B"]).unwrap(), ramp(0.5));
    let albedo = layers.triples(["Albedo.R", "Albedo.G", "Albedo.B"]);
    assert_eq!(albedo.unwrap(), ramp(0.25));
    let green: Vec<_> = ramp(0.25).iter().map(|triple| triple[1]).collect();
    assert_eq!(layers.channel("Albedo.G").unwrap(), green);
    assert_eq!(layers.channel("Albedo"), None);
    assert_eq!(layers.triples(["R", "G", "A"]), None);
    assert_eq!(layers.text("bidir/version").unwrap(), "µ");
    assert_eq!(layers.text("bidir/seed"), None);
}

#[test]
fn everything_that_is_not_changed_is_written_as_it_was() {
    let folder = example();
    let [from, to] = ["a.exr", "b.exr"].map(|name| folder.path().join(name));
    let mut layers = read_layers(&from).unwrap();
    write_layers(&to, &layers).unwrap();
    assert_eq!(std::fs::read(&to).unwrap(), *BYTES);
    let color = ramp(2.0);
    layers.set_triples(["R", "G", "B"], &color).unwrap();
    layers
        .set_triples(["Noisy.R", "Noisy.G", "Noisy.B"], &ramp(0.5))
        .unwrap();
    layers.set_text("bidir/denoiser", "none");
    write_layers(&to, &layers).unwrap();
    let written = read_layers(&to).unwrap();
    assert_eq!(written, layers);
    assert_eq!(written.names().count(), 9);
    assert_eq!(written.text("bidir/denoiser").unwrap(), "none");
    assert_eq!(
        written.channel("Albedo.B"),
        read_layers(&from).unwrap().channel("Albedo.B")
    );
    let picture = crate::image::read(&to, None).unwrap();
    assert_eq!(picture.rgb().collect::<Vec<_>>(), color);
}

#[test]
fn numbers_of_16_bits_and_standard_attributes_are_kept() {
    let mut layers = decode(&BYTES).unwrap();
    for channel in &mut layers.image.layer_data.channel_data.list {
        let halves = channel
            .sample_data
            .values_as_f32()
            .map(::exr::prelude::f16::from_f32);
        channel.sample_data = FlatSamples::F16(halves.collect());
    }
    // Standard attributes are kept as well.
    layers.image.layer_data.attributes.owner = Some("none".into());
    let again = decode(&to_bytes(&layers.image).unwrap()).unwrap();
    assert_eq!(again, layers);
    assert_eq!(again.triples(["R", "G", "B"]).unwrap(), ramp(0.5));
}

#[test]
fn other_sizes_are_refused() {
    let mut layers = decode(&BYTES).unwrap();
    let error = layers
        .set_triples(["X", "Y", "Z"], &ramp(1.0)[1..])
        .unwrap_err();
    let expected = "cannot write: the channel `X` does not have the size of the image";
    assert_eq!(error.to_string(), expected);
    layers.set_text("bidir/denoiser", "☃");
    assert_eq!(layers.names().count(), 6);
}

#[test]
fn files_other_than_an_exr_of_one_part_are_refused() {
    let folder = example();
    let missing = read_layers(&folder.path().join("b.exr")).unwrap_err();
    assert_eq!(missing.kind(), ErrorKind::MissingFile);
    let named = folder.path().join("a.png");
    crate::image::write_png(&named, [1, 1], &[[0.5; 3]]).unwrap();
    let error = read_layers(&named).unwrap_err().to_string();
    let expected = "a.png: an image without named channels; name an OpenEXR image";
    assert!(error.ends_with(expected), "{error}");
    // The bytes decide.
    std::fs::write(&named, BYTES.as_slice()).unwrap();
    assert!(read_layers(&named).is_ok());
    let broken = folder.path().join("broken.exr");
    std::fs::write(&broken, &BYTES[..BYTES.len() / 2]).unwrap();
    let error = read_layers(&broken).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Data);
    assert_eq!(error.file(), Some(broken.as_path()));
    let expected = "an EXR of several parts; write its layers as channels of one part";
    assert_eq!(decode(&two_parts()).unwrap_err().to_string(), expected);
}

/// Returns a file with two parts.
fn two_parts() -> Vec<u8> {
    let layers = decode(&BYTES).unwrap();
    let parts = ["one", "two"].map(|name| {
        let mut part = layers.image.layer_data.clone();
        part.attributes.layer_name = Some(name.into());
        part
    });
    let image = ::exr::image::Image::from_layers(layers.image.attributes, parts.to_vec());
    let mut bytes = Vec::new();
    image
        .write()
        .to_buffered(std::io::Cursor::new(&mut bytes))
        .unwrap();
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn mutated_files_never_panic(at in any::<proptest::sample::Index>(), byte in any::<u8>()) {
        let mut bytes = BYTES.clone();
        let index = at.index(bytes.len());
        bytes[index] = byte;
        if let Ok(Ok(layers)) = catch_silently(|| decode(&bytes)) {
            let [width, height] = layers.size();
            for name in layers.names() {
                let channel = layers.channel(&name);
                prop_assert_eq!(channel.map(|channel| channel.len()), Some(width * height));
            }
        }
    }
}
