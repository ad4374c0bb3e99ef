//! Images beside the picture: in EXR files by name, in film files, and denoised.

use crate::common::Workplace;

const ROOM: &str = "render room.pbrt --size 24x18";
const LAYERS: &str = "--aov albedo,depth,variance,rays --light-groups --strategy-layers 3";

/// A workplace with a room whose two lights are in groups.
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
fn layers_are_named_and_are_what_film_files_hold() {
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
fn shares_with_layers_are_the_whole() {
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
fn a_film_of_other_layers_is_not_gone_on_from() {
    let workplace = workplace();
    let render = format!("{ROOM} --spp 2 -o a.exr --checkpoint a.film --resume");
    workplace.run(&format!("{render} --aov depth")).expect(0);
    let ran = workplace.run(&format!("{render} --aov albedo"));
    ran.expect(5).says("aov");
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

#[test]
fn what_cannot_be_kept_is_told() {
    let workplace = workplace();
    let ran = workplace.run(&format!("{ROOM} --aov depth -o a.png"));
    ran.expect(2).says("a PNG has no room for layers");
    let ran = workplace.run(&format!("{ROOM} --aov depht"));
    ran.expect(2).says("depth");
    workplace
        .run(&format!("{ROOM} --strategy-layers 17"))
        .expect(2);
    workplace.write(
        "bad.pbrt",
        "WorldBegin LightSource \"point\" \"string lightgroup\" \"a.b\"",
    );
    workplace
        .run("render bad.pbrt")
        .expect(3)
        .says("bad.pbrt:1:");
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
