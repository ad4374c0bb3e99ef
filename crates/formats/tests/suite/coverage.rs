//! Partially covered surfaces: walks decide randomly, shadow rays compute transmittance exactly, and all
//! estimators agree.

use crate::statistics::{Replicates, Shown, WHOLE, check_agree, replicates};
use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::locus::Locus;
use bidir::math::Vec3;
use bidir::path::PathSettings;
use bidir_formats::pbrt::{LoadOptions, Loaded, build, load, parse_text};

const CAMERA: &str = r#"
LookAt 0 1 -4  0 1 0  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
PixelFilter "box"
WorldBegin
"#;

fn scene(world: &str) -> Loaded {
    let description = parse_text("s.pbrt", &format!("{CAMERA}{world}")).expect("it is valid");
    let loaded = build(&description, &LoadOptions::default());
    loaded.expect("it is supported")
}

fn render(loaded: &Loaded, integrator: IntegratorKind, passes: u64) -> Replicates {
    let settings = Settings {
        path: PathSettings {
            max_depth: Some(3),
            ..PathSettings::default()
        },
        ..Settings::new(integrator)
    };
    let shown = Shown {
        scene: &loaded.scene,
        view: &loaded.view,
    };
    replicates(shown, &settings, passes)
}

/// Describes a black wall across the view with coverage `alpha`.
fn wall(z: f32, alpha: f32) -> String {
    format!(
        "Material \"diffuse\" \"rgb reflectance\" [0 0 0]\n\
         Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"float alpha\" {alpha}\n\
         \"point3 P\" [-9 -9 {z} -9.5 9 {z} 9 9.5 {z} 9 -9 {z}]\n"
    )
}

/// Checks that transmittances are equal to the last bit.
#[track_caller]
fn same(actual: f32, expected: f32) {
    assert_eq!(actual.to_bits(), expected.to_bits(), "{actual} {expected}");
}

#[test]
fn transmittances_of_walls_multiply() {
    let walls = [wall(0.0, 0.5), wall(1.0, 0.3), wall(2.0, 0.0)].concat();
    let light = "LightSource \"infinite\" \"rgb L\" [1 1 1]\n";
    let sphere = "Shape \"sphere\" \"float alpha\" 0.2\n";
    let scene = scene(&format!("{walls}{light}{sphere}")).scene;
    let behind = Vec3::new(3.1, 1.2, 9.0);
    let seen =
        |from: Vec3, to: Vec3| scene.transmittance(&Locus::in_space(from), &Locus::in_space(to));
    let eye = Vec3::new(3.0, 1.0, -4.0);
    // 1 - α of the file's numbers, rounded once.
    let factors = [0.5_f32, 0.3].map(|alpha| f64::from(1.0 - alpha));
    same(seen(eye, behind), (factors[0] * factors[1]) as f32);
    same(seen(behind, eye), seen(eye, behind));
    same(seen(eye, Vec3::new(3.0, 1.0, -2.0)), 1.0);
    // Into and out of the sphere, between the walls.
    let clear = f64::from(1.0_f32 - 0.2);
    let (left, right) = (Vec3::new(-2.0, 0.1, -0.1), Vec3::new(2.0, 0.1, -0.1));
    same(seen(left, right), (clear * clear) as f32);

    let open = scene_of_walls_and_light();
    let expected = 0.5 * 0.7;
    let picture = render(&open, IntegratorKind::Path, 4096);
    let exact = picture.exactly([expected; 3]);
    check_agree("walls", &picture, &exact, &[WHOLE]);
    check_agree(
        "walls, bdpt",
        &render(&open, IntegratorKind::Bdpt, 4096),
        &exact,
        &[WHOLE],
    );
}

fn scene_of_walls_and_light() -> Loaded {
    let walls = [wall(0.0, 0.5), wall(1.0, 0.3)].concat();
    scene(&format!(
        "{walls}LightSource \"infinite\" \"rgb L\" [1 1 1]\n"
    ))
}

/// A floor and a wall; each test adds a light.
const ROOM: &str = r#"
Material "diffuse" "rgb reflectance" [0.6 0.5 0.4]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-3 0 -3 -3 0 3 3 0 3 3 0 -3]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-3 0 2 -3 3 2 3 3 2 3 0 2]
"#;

const LAMP: &str = r#"
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [6 7 8]
  Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-1 3 -1 1 3 -1 1 3 1 -1 3 1]
AttributeEnd
"#;

#[track_caller]
fn check_estimators(loaded: &Loaded) -> Replicates {
    let path = render(loaded, IntegratorKind::Path, 3072);
    let bdpt = render(loaded, IntegratorKind::Bdpt, 2048);
    check_agree("bdpt", &bdpt, &path, &[WHOLE, 1]);
    let light = render(loaded, IntegratorKind::Light, 6144);
    check_agree("light", &light, &path, &[WHOLE, 4]);
    path
}

#[test]
fn a_half_transparent_plane() {
    let veil = "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"float alpha\" 0.5\n\
                \"point3 P\" [-1.5 1.2 -1 -1.5 1.4 1 1.5 1.4 1 1.5 1.2 -1]\n";
    check_estimators(&scene(&format!("{ROOM}{LAMP}{veil}")));
}

/// Loads a file with `world` beside a mask of four by four numbers.
fn masked(world: &str) -> (tempfile::TempDir, Loaded) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut mask = b"PF\n4 4\n-1.0\n".to_vec();
    for i in 0..16_u32 {
        // Holes, partial coverage, and full coverage.
        let alpha = [0.0_f32, 1.0, 0.25, 1.0, 0.6][(i * 3 % 5) as usize];
        mask.extend([alpha; 3].iter().flat_map(|x| x.to_le_bytes()));
    }
    std::fs::write(folder.path().join("mask.pfm"), mask).expect("it is written");
    let texture = "Texture \"mask\" \"float\" \"imagemap\" \"string filename\" \"mask.pfm\" \
                   \"string filter\" \"point\"\n";
    let file = folder.path().join("s.pbrt");
    std::fs::write(&file, format!("{CAMERA}{texture}{world}")).expect("it is written");
    let loaded = load(&file, &LoadOptions::default()).expect("it is supported");
    (folder, loaded)
}

const MASKED: &str = "\"texture alpha\" \"mask\" \"point2 uv\" [0 0 1 0 1 1 0 1]";

#[test]
fn leaves_cut_out_by_a_texture_and_shared() {
    let leaves = format!(
        "ObjectBegin \"o\" Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] {MASKED}\n\
         \"point3 P\" [-0.8 0 -0.6 -0.8 0.3 0.6 0.8 0.2 0.6 0.8 0 -0.6] ObjectEnd\n\
         AttributeBegin Translate -0.7 1 0 ObjectInstance \"o\" AttributeEnd\n\
         AttributeBegin Translate 0.5 1.6 0.3 Scale -1 1 1 ObjectInstance \"o\" AttributeEnd\n"
    );
    let (_folder, loaded) = masked(&format!("{ROOM}{LAMP}{leaves}"));
    assert_eq!(loaded.scene.instance_count(), 2);
    check_estimators(&loaded);
}

#[test]
fn lamps_cut_out_by_a_texture_and_by_a_number() {
    let lamps = format!(
        "AreaLightSource \"diffuse\" \"rgb L\" [6 7 8]\n\
         Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] {MASKED}\n\
         \"point3 P\" [-1 2.2 -1 1 2.2 -1 1 1.8 1 -1 1.8 1]\n\
         Translate 0.6 0.7 -0.2 Shape \"sphere\" \"float radius\" 0.3 \"float alpha\" 0.4\n"
    );
    let (_folder, loaded) = masked(&format!("{ROOM}{lamps}"));
    check_estimators(&loaded);
}

#[test]
fn an_invisible_lamp_still_emits() {
    let lamp = "AreaLightSource \"diffuse\" \"rgb L\" [6 7 8] \"float scale\" 3\n\
                Translate 0 1.3 0 Shape \"sphere\" \"float radius\" 0.3 \"float alpha\" 0\n";
    let loaded = scene(&format!("{ROOM}{lamp}"));
    let scene = &loaded.scene;
    assert_eq!((scene.lights().len(), scene.placed_primitives()), (1, 4));
    let path = check_estimators(&loaded);
    assert!(path.mean() > 0.05, "{}", path.mean());
    let (front, back) = (Vec3::new(0.0, 1.3, -2.0), Vec3::new(0.0, 1.3, 1.5));
    same(
        scene.transmittance(&Locus::in_space(front), &Locus::in_space(back)),
        1.0,
    );
}
