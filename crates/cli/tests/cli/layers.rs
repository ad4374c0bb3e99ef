//! Layers: in EXR files by name, in film files, and denoised.

use crate::common::Workplace;

const ROOM: &str = "render room.pbrt --size 24x18";
const LAYERS: &str = "--aov albedo,depth,variance,rays --light-groups --strategy-layers 3";

/// Returns a workplace with a room whose two lights are in groups.
fn workplace() -> Workplace {
    let workplace = Workplace::new();
    workplace.write(
        "room.pbrt",
        "LookAt 0 0 -3  0 0 0  0 1 0  Camera \"perspective\" \"float fov\" 60\n\
         Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 18\n\
         WorldBegin\n\
         LightSource \"infinite\" \"rgb L\" [0.1 0.2 0.3]\n\
         AttributeBegin\n\
         Attribute \"light\" \"string lightgroup\" \"lamp\"\n\
         AreaLightSource \"diffuse\" \"rgb L\" [9 8 7]\n\
         Translate 1 1 0 Shape \"sphere\" \"float radius\" 0.2\n\
         AttributeEnd\n\
         Material \"diffuse\" \"rgb reflectance\" [0.8 0.4 0.2]\n\
         Shape \"sphere\"\n",
    );
    workplace
}

#[test]
fn layers_have_names_and_equal_those_of_film_files() {
    let workplace = workplace();
    let render = format!("{ROOM} {LAYERS} --spp 4 -o a.exr --checkpoint a.film");
    workplace.run(&render).expect(0);
    workplace.run("film develop a.film -o b.exr").expect(0);
    let (a, b) = (workplace.layers("a.exr"), workplace.layers("b.exr"));
    let names: Vec<_> = a.names().collect();
    assert_eq!(names, b.names().collect::<Vec<_>>());
    for name in [
        "R",
        "Albedo.R",
        "Z",
        "Coverage",
        "Variance.G",
        "RelativeVariance.B",
        "Rays",
        "lightgroup.lamp.R",
        "lightgroup.environment.B",
        "s0t2.R",
        "s2t1.G",
        "longer.B",
    ] {
        assert!(
            names.iter().any(|known| known == name),
            "{name} of {names:?}"
        );
    }
    for name in &names {
        assert_eq!(a.channel(name), b.channel(name), "{name}");
    }
    let info = workplace.run("film info a.film").expect(0).stdout;
    assert!(
        info.contains("environment,lamp") || info.contains("lamp,environment"),
        "{info}"
    );
}

#[test]
fn parts_with_layers_equal_the_whole() {
    let workplace = workplace();
    let render = format!("{ROOM} {LAYERS} --spp 5");
    workplace.run(&format!("{render} -o whole.exr")).expect(0);
    for part in 0..3 {
        workplace
            .run(&format!(
                "{render} --part {part}/3 --checkpoint {part}.film"
            ))
            .expect(0);
    }
    workplace
        .run("merge 2.film 0.film 1.film -o all.film --image all.exr")
        .expect(0);
    let (whole, all) = (workplace.layers("whole.exr"), workplace.layers("all.exr"));
    for name in whole.names() {
        assert_eq!(whole.channel(&name), all.channel(&name), "{name}");
    }
}

#[test]
fn the_picture_does_not_depend_on_layers() {
    let workplace = workplace();
    workplace
        .run(&format!("{ROOM} --spp 3 -o plain.exr"))
        .expect(0);
    workplace
        .run(&format!(
            "{ROOM} --spp 3 -o kept.exr --aov all --light-groups"
        ))
        .expect(0);
    workplace
        .run("compare plain.exr kept.exr --exact")
        .expect(0);
}

/// Flags for a pyramid of paths of up to four vertices.
const PYRAMID: &str = "--pyramid p --strategy-layers 4 --spp 4";

#[test]
fn a_pyramid_is_an_exr() {
    let workplace = workplace();
    let render = format!("{ROOM} {PYRAMID} -o a.png --stats a.json");
    let ran = workplace.run(&render).expect(0);
    ran.says("p/pyramid.exr").says("rays/sample").says("s1t2");
    let layers = workplace.layers("p/pyramid.exr");
    let mut names: Vec<_> = layers.names().filter(|name| name.ends_with('R')).collect();
    names.sort();
    let mut expected = vec!["R".to_owned(), "longer.R".to_owned()];
    for n in 2..=4 {
        for s in 0..n {
            expected.push(format!("s{s}t{}.R", n - s));
            expected.push(format!("raw.s{s}t{}.R", n - s));
        }
    }
    expected.sort();
    assert_eq!(names, expected);
    // Weighted layers add up to the picture, and raw ones are the same without weights.
    let channel = |name: &str| layers.channel(name).unwrap();
    let parts = expected
        .iter()
        .filter(|name| *name != "R" && !name.starts_with("raw"));
    let parts: Vec<_> = parts.map(|name| channel(name)).collect();
    for (i, pixel) in channel("R").iter().enumerate() {
        let sum: f32 = parts.iter().map(|part| part[i]).sum();
        assert!((sum - pixel).abs() <= 1e-5 * pixel + 1e-9);
    }
    let (weighted, raw) = (channel("s1t2.R"), channel("raw.s1t2.R"));
    assert!(weighted.iter().zip(&raw).all(|(w, raw)| *w <= raw * 1.0001));
    assert!(weighted.iter().zip(&raw).any(|(w, raw)| w < raw));
    let stats: serde_json::Value = serde_json::from_str(&workplace.read("a.json")).unwrap();
    let rows = stats["strategies"].as_array().unwrap();
    let row = rows
        .iter()
        .find(|row| row["s"] == 1 && row["t"] == 2)
        .unwrap();
    for number in ["blocked_share", "mean", "variance", "raw_dropped"] {
        assert!(row[number].is_number(), "{number}: {row}");
    }
}

#[test]
fn a_pyramid_is_continued() {
    let workplace = workplace();
    let render = format!("{ROOM} {PYRAMID} -o a.exr");
    workplace.run(&render).expect(0);
    let whole = workplace.layers("p/pyramid.exr");
    let render = format!("{ROOM} --strategy-layers 4 -o b.exr --checkpoint b.film --resume");
    let film = format!("{render} --pyramid q");
    workplace.run(&format!("{film} --spp 2")).expect(0);
    workplace
        .run(&format!("{render} --spp 4"))
        .expect(5)
        .says("raw-strategies");
    workplace.run(&format!("{film} --spp 4")).expect(0);
    let resumed = workplace.layers("q/pyramid.exr");
    for name in whole.names() {
        assert_eq!(whole.channel(&name), resumed.channel(&name), "{name}");
    }
}

#[test]
fn a_denoised_render_keeps_its_noise() {
    let workplace = workplace();
    let Some(ran) = workplace.denoising(&format!("{ROOM} --spp 2 --denoise -o a.exr")) else {
        return;
    };
    ran.expect(0);
    workplace
        .run(&format!("{ROOM} --spp 2 -o plain.exr"))
        .expect(0);
    let (denoised, plain) = (workplace.layers("a.exr"), workplace.layers("plain.exr"));
    for channel in ["R", "G", "B"] {
        assert_eq!(
            denoised.channel(&format!("Noisy.{channel}")),
            plain.channel(channel)
        );
        assert_ne!(denoised.channel(channel), plain.channel(channel));
    }
    assert!(denoised.channel("Ns.X").is_some());
    assert!(denoised.text("bidir/denoiser").is_some());
}
