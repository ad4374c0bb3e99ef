use crate::common::{Ran, Workplace};
use formats::image::{ExrImage, ExrLayer, MetadataValue, write_exr};

const RGB: [&str; 3] = ["R", "G", "B"];
const NOISY: [&str; 3] = ["Noisy.R", "Noisy.G", "Noisy.B"];
const SIZE: [usize; 2] = [40, 30];

impl Workplace {
    /// Writes an image of noise with these guides, each a name and its channels.
    fn write_noise(&self, name: &str, guides: &[(&str, [&str; 3])]) {
        let noise: Vec<f32> = (0..SIZE[0] * SIZE[1] * 3)
            .map(|index| (index * index % 97) as f32 / 97.0)
            .collect();
        let guide = vec![0.5; noise.len()];
        let mut layers = vec![ExrLayer {
            name: "",
            channels: &RGB,
            data: &noise,
        }];
        layers.extend(guides.iter().map(|(name, channels)| ExrLayer {
            name,
            channels,
            data: &guide,
        }));
        let image = ExrImage {
            resolution: [100, 90],
            crop: [7, 5, 47, 35],
            layers: &layers,
            metadata: &[("bidir/seed".to_owned(), MetadataValue::Integer(3))],
        };
        write_exr(&self.path(name), &image).unwrap();
    }
}

/// Returns the mean square difference of neighbours.
fn roughness(pixels: &[[f32; 3]]) -> f32 {
    let steps = pixels.windows(2).map(|pair| pair[1][1] - pair[0][1]);
    steps.map(|step| step * step).sum::<f32>() / pixels.len() as f32
}

#[test]
fn a_render_loses_its_noise_and_keeps_its_attributes() {
    let place = Workplace::new();
    place.run("render room.pbrt -q -o noisy.exr").expect(0);
    let Some(ran) = place.denoising("denoise noisy.exr -o clean.exr") else {
        return;
    };
    let default = place.denoising("denoise noisy.exr").unwrap();
    default.expect(0).says("wrote noisy-clean.exr");
    place
        .run("compare noisy-clean.exr clean.exr --exact")
        .expect(0);
    ran.expect(0)
        .says("note: `bidir render --aov albedo,shading-normal`")
        .says("Open Image Denoise 2.")
        .says("guides: none; wrote clean.exr");
    let [noisy, clean] = ["noisy.exr", "clean.exr"].map(|name| place.layers(name));
    assert_eq!(clean.triples(NOISY), noisy.triples(RGB));
    let [before, after] =
        [noisy, clean.clone()].map(|layers| roughness(&layers.triples(RGB).unwrap()));
    assert!(after < before / 2.0, "{before} {after}");
    let denoiser = clean.text("bidir/denoiser").unwrap();
    assert!(denoiser.starts_with("Open Image Denoise 2.") && denoiser.ends_with("guides: none"));
    for name in ["bidir/version", "bidir/integrator"] {
        assert!(clean.text(name).is_some(), "{name}");
        assert_eq!(clean.text(name), place.layers("noisy.exr").text(name));
    }
}

#[test]
fn a_denoised_image_is_denoised_again_from_its_noisy_layer() {
    let place = Workplace::new();
    place.write_noise("noisy.exr", &[]);
    let Some(ran) = place.denoising("denoise noisy.exr -o clean.exr --threads 1") else {
        return;
    };
    ran.expect(0);
    place
        .denoising("denoise clean.exr -o again.exr")
        .unwrap()
        .expect(0);
    let read = |name| std::fs::read(place.path(name)).unwrap();
    assert_eq!(read("clean.exr"), read("again.exr"));
    place
        .denoising("denoise again.exr -o again.exr")
        .unwrap()
        .expect(0);
    assert_eq!(read("clean.exr"), read("again.exr"));
    place
        .denoising("denoise noisy.exr -o clean.png")
        .unwrap()
        .expect(0);
    place.run("tonemap clean.exr -o same.png").expect(0);
    place.run("compare clean.png same.png --exact").expect(0);
}

#[test]
fn complete_layers_guide_the_filter() {
    let place = Workplace::new();
    let albedo = ("Albedo", RGB);
    let [ns, n] = ["Ns", "N"].map(|name| (name, ["X", "Y", "Z"]));
    for (guides, message, is_noted) in [
        (vec![albedo, ns, n], "guides: Albedo, Ns;", false),
        (vec![albedo, n], "guides: Albedo, N;", false),
        (vec![albedo], "guides: Albedo;", true),
        (vec![ns], "guides: none;", true),
        (vec![("Albedo", ["R", "G", "Z"])], "guides: none;", true),
    ] {
        place.write_noise("noisy.exr", &guides);
        let Some(ran) = place.denoising("denoise noisy.exr -o clean.exr") else {
            return;
        };
        let ran = ran.expect(0).says(message);
        assert_eq!(ran.stderr.contains("note: "), is_noted, "{}", ran.stderr);
        let names = place.layers("noisy.exr").names().count();
        assert_eq!(place.layers("clean.exr").names().count(), names + 3);
    }
}

#[test]
fn an_image_without_colours_is_an_error() {
    let place = Workplace::new();
    let layers = [ExrLayer {
        name: "",
        channels: &["Y"],
        data: &[1.0],
    }];
    let image = ExrImage {
        resolution: [1, 1],
        crop: [0, 0, 1, 1],
        layers: &layers,
        metadata: &[],
    };
    write_exr(&place.path("grey.exr"), &image).unwrap();
    let grey = place.run("denoise grey.exr -o out.exr").expect(4);
    grey.says("grey.exr: it has no channels R, G, B");
    assert!(!place.path("out.exr").exists());
}

#[test]
fn a_missing_library_is_an_error() {
    let place = Workplace::new();
    place.write_noise("noisy.exr", &[]);
    place.write("text.so", "no library");
    for name in ["nothing.so", "text.so", "."] {
        let mut command = place.command("denoise noisy.exr -o out.exr");
        Ran::of(command.env("BIDIR_OIDN", name))
            .expect(4)
            .says(&format!(
                "error: {name}: cannot be used as Open Image Denoise"
            ))
            .says("hint: set BIDIR_OIDN")
            .says("pip install pyoidn");
    }
    assert!(!place.path("out.exr").exists());
}
