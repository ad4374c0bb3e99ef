//! Participating media: coefficients, boundaries, the medium around everything, and what is refused.

use super::refusals::outcome;
use super::*;
use bidir::light::Light;
use bidir::math::Vec3;
use bidir::medium::MediumId;
use bidir::spectrum::Lanes;

const FOG: &str = "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"";

/// Returns σ_t at a point of the only medium of a scene.
#[track_caller]
fn extinction(scene: &Scene, point: Vec3) -> [f32; 3] {
    let [medium] = scene.media() else {
        panic!("{} media", scene.media().len())
    };
    let lanes = medium.extinction(point, Lanes::Rgb);
    [0, 1, 2].map(|i| lanes[i])
}

#[track_caller]
fn check_extinction(parameters: &str, expected: [f32; 3]) {
    let text = format!("{FOG} {parameters} MediumInterface \"fog\" \"\" Shape \"sphere\"");
    let scene = world(&format!("Material \"interface\" {text}"));
    let found = extinction(&scene, Vec3::ZERO);
    let close = |(a, b): (&f32, f32)| (a - b).abs() <= 1e-5 * b;
    let are_close = found.iter().zip(expected).all(close);
    assert!(are_close, "{parameters}: {found:?}");
}

#[test]
fn coefficients_are_read() {
    check_extinction("", [2.0; 3]);
    let both = "\"rgb sigma_a\" [.1 .2 .3] \"rgb sigma_s\" [1 2 3]";
    check_extinction(both, [1.1, 2.2, 3.3]);
    check_extinction(&format!("{both} \"float scale\" 2"), [2.2, 4.4, 6.6]);
    let preset = "\"string preset\" \"Ketchup\"";
    check_extinction(preset, [0.241, 1.04, 1.48]);
    check_extinction(
        &format!("{preset} \"rgb sigma_a\" [0 0 0]"),
        [0.241, 1.04, 1.48],
    );
}

#[test]
fn coefficients_follow_the_unit_of_a_small_scene() {
    // A thousandth of everything: lengths are kept in another unit, optical depths stay.
    let text = "LookAt 0 0 -3e-6 0 0 0 0 1 0 Camera \"perspective\" WorldBegin \
                MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"float scale\" 1e6 \
                Material \"interface\" MediumInterface \"fog\" \"\" \
                Shape \"sphere\" \"float radius\" 1e-6";
    let scene = load_text(text, &STRICT).scene;
    let unit = scene.space().unit as f32;
    let [found, ..] = extinction(&scene, Vec3::ZERO);
    let ratio = found / (2e6 * unit);
    assert!((ratio - 1.0).abs() < 1e-5, "{found}, unit {unit}");
}

#[test]
fn boundaries_enclose_media() {
    let scene = world(&format!(
        "{FOG} MediumInterface \"fog\" \"\" Material \"interface\" Shape \"sphere\""
    ));
    assert_ne!(scene.medium_at(Vec3::ZERO), MediumId::VACUUM);
    assert_eq!(scene.medium_at(Vec3::splat(2.0)), MediumId::VACUUM);
    assert_eq!(scene.around(), MediumId::VACUUM);
}

#[test]
fn an_interface_between_equal_media_is_nothing() {
    let scene = world(&format!(
        "{FOG} MediumInterface \"fog\" \"fog\" Material \"interface\" Shape \"sphere\""
    ));
    assert_eq!(scene.unique_primitives(), 0);
}

#[test]
fn the_medium_of_a_camera_outside_all_boundaries_is_around_everything() {
    let scene = |shape: &str| {
        let text = format!(
            "{FOG} MediumInterface \"\" \"fog\" Camera \"perspective\" WorldBegin \
             LightSource \"infinite\" Material \"interface\" {shape}"
        );
        load_text(&text, &STRICT)
    };
    let open = scene("MediumInterface \"\" \"\" Shape \"disk\"");
    assert_ne!(open.scene.around(), MediumId::VACUUM);
    let closed = scene("MediumInterface \"fog\" \"\" Shape \"sphere\"");
    assert_eq!(closed.scene.around(), MediumId::VACUUM);
}

#[test]
fn glass_in_a_medium_without_end_does_not_end_it() {
    let ball = |at: &str| {
        format!(
            "AttributeBegin Translate {at} MediumInterface \"juice\" \"fog\" \
             Material \"dielectric\" Shape \"sphere\" \"float radius\" 2 AttributeEnd "
        )
    };
    let balls = ["1.8 2.4 4", "-3 3.2 -2.4", "1.4 -4.8 0"].map(ball);
    let text = format!(
        "{FOG} MakeNamedMedium \"juice\" \"string type\" \"homogeneous\" \
         MediumInterface \"\" \"fog\" Camera \"perspective\" WorldBegin {}",
        balls.concat()
    );
    let scene = load_text(&text, &STRICT).scene;
    assert_ne!(scene.around(), MediumId::VACUUM);
    assert_eq!(scene.medium_at(Vec3::ZERO), scene.around());
}

/// The lanes of σ_t at points of the only medium of a scene, which a sphere encloses.
fn extinctions<const N: usize>(medium: &str, points: [[f32; 3]; N]) -> [[f32; 3]; N] {
    let text = format!(
        "{medium} MediumInterface \"smoke\" \"\" Material \"interface\" \
         Shape \"sphere\" \"float radius\" 9"
    );
    let scene = world(&text);
    points.map(|point| {
        let lanes = extinction(&scene, Vec3::from_array(point));
        lanes.map(|lane| (lane * 1e4).round() / 1e4)
    })
}

fn smoke(kind: &str, parameters: &str) -> String {
    format!("MakeNamedMedium \"smoke\" \"string type\" \"{kind}\" {parameters} ")
}

#[test]
fn grids_of_densities_are_read_x_first() {
    let parameters = "\"integer nx\" 2 \"integer ny\" 1 \"integer nz\" 3 \"point3 p1\" [4 2 6] \
         \"float density\" [1 2  3 4  5 6] \"rgb sigma_a\" [1 0 0] \"rgb sigma_s\" [1 1 0]";
    let placed = format!("Translate 1 0 0 {}", smoke("uniformgrid", parameters));
    let centres = [[2.0, 1.0, 1.0], [4.0, 1.0, 1.0], [2.0, 1.0, 5.0]];
    let found = extinctions(&placed, centres);
    assert_eq!(found, [[2.0, 1.0, 0.0], [4.0, 2.0, 0.0], [10.0, 5.0, 0.0]]);
    let between = extinctions(&placed, [[3.0, 1.0, 1.0], [1.1, 0.1, 0.1]]);
    assert_eq!(between, [[3.0, 1.5, 0.0], [2.0, 1.0, 0.0]]);
}

#[test]
fn grids_of_colours_have_coefficients_of_their_own() {
    let both = "\"integer nx\" 2 \"rgb sigma_a\" [1 2 3 4 5 6] \"rgb sigma_s\" [1 1 1 2 2 2]";
    let points = [[0.25, 0.5, 0.5], [0.75, 0.5, 0.5]];
    let found = extinctions(&smoke("rgbgrid", both), points);
    assert_eq!(found, [[2.0, 3.0, 4.0], [6.0, 7.0, 8.0]]);
    let one = "\"rgb sigma_s\" [0 1 2] \"float scale\" 2";
    let found = extinctions(&smoke("rgbgrid", one), [[0.5; 3]]);
    assert_eq!(found, [[2.0, 4.0, 6.0]]);
}

#[test]
fn clouds_are_denser_the_lower() {
    let cloud = smoke("cloud", "\"float density\" 3");
    let layer = |y: f32| {
        let at = |i: usize| [i % 8, i / 8].map(|n| (n as f32 + 0.5) / 8.0);
        std::array::from_fn::<_, 64, _>(|i| [at(i)[0], y, at(i)[1]])
    };
    let mean = |y: f32| {
        let found = extinctions(&cloud, layer(y));
        found.iter().map(|[r, ..]| r).sum::<f32>() / 64.0
    };
    let [low, middle, high] = [0.01, 0.6, 0.98].map(mean);
    assert!(
        low > 1.8 && low > middle && middle > high + 0.1,
        "{low} {middle} {high}"
    );
}

/// σ_a L_e at a point of the only medium of a scene, which a sphere encloses.
#[track_caller]
fn check_emission(medium: &str, point: [f32; 3], expected: [f32; 3]) {
    let text = format!(
        "{medium} MediumInterface \"smoke\" \"\" Material \"interface\" \
         Shape \"sphere\" \"float radius\" 9"
    );
    let scene = world(&text);
    let kinds: Vec<_> = scene.lights().iter().map(Light::kind).collect();
    assert_eq!(kinds, ["volume"]);
    let emission = scene.media()[0].emission(Vec3::from_array(point), Lanes::Rgb);
    let found = Lanes::Rgb.to_rgb(emission);
    let close = |(a, b): (&f32, f32)| (a - b).abs() <= 1e-4 * b;
    assert!(found.iter().zip(expected).all(close), "{found:?}");
}

#[test]
fn light_of_media_is_read() {
    let even = smoke(
        "homogeneous",
        "\"rgb Le\" [1 2 3] \"float Lescale\" 2 \"float scale\" .5",
    );
    check_emission(&even, [0.0; 3], [1.0, 2.0, 3.0]);
    let cells = "\"integer nx\" 2 \"float density\" [1 2]";
    let light = smoke("uniformgrid", &format!("{cells} \"rgb Le\" [1 2 3]"));
    check_emission(&light, [0.75, 0.5, 0.5], [2.0, 4.0, 6.0]);
    let factors = smoke(
        "uniformgrid",
        &format!("{cells} \"rgb Le\" [1 2 3] \"float Lescale\" [0 4]"),
    );
    check_emission(&factors, [0.75, 0.5, 0.5], [8.0, 16.0, 24.0]);
    // Between centres, density is 1.5 and the factor 2.
    check_emission(&factors, [0.5; 3], [3.0, 6.0, 9.0]);
    let colors = smoke(
        "rgbgrid",
        "\"integer nx\" 2 \"rgb sigma_a\" [1 1 1 2 2 2] \"rgb Le\" [1 1 1 0 1 2] \"float Lescale\" .5",
    );
    let white = 106.856_9;
    check_emission(&colors, [0.75, 0.5, 0.5], [0.0, white, 2.0 * white]);
}

/// ∫ ȳ S dλ of Planck's law relative to its peak, at 3000 K and 6500 K, with ȳ by the fit of Wyman, Sloan and Shirley
/// (2013), which is right to 1 %.
const HOT: [f32; 2] = [44.52, 94.72];

#[test]
fn hot_cells_glow() {
    let luminance_of = |parameters: &str, x: f32| {
        let medium = smoke(
            "uniformgrid",
            &format!("\"integer nx\" 2 \"float density\" [1 1] {parameters}"),
        );
        let text = format!(
            "{medium} MediumInterface \"smoke\" \"\" Material \"interface\" Shape \"sphere\""
        );
        let at = Vec3::new(x, 0.5, 0.5);
        Lanes::Rgb.luminance(world(&text).media()[0].emission(at, Lanes::Rgb))
    };
    let check = |parameters: &str, expected: f32| {
        let found = luminance_of(parameters, 0.75);
        assert!(
            (found / expected - 1.0).abs() < 0.01,
            "{parameters}: {found}"
        );
    };
    check("\"float temperature\" [90 3000]", HOT[0]);
    check("\"float temperature\" [90 6500]", HOT[1]);
    let moved = "\"float temperature\" [300 1600] \"float temperaturescale\" 2";
    check(&format!("{moved} \"float temperatureoffset\" 100"), HOT[0]);
    check(&format!("{moved} \"float temperaturecutoff\" 100"), HOT[0]);
    let celsius = "\"float temperature\" [-20 2726.85] \"float temperatureoffset\" -273.15";
    check(celsius, HOT[0]);
    let cold = luminance_of("\"float temperature\" [90 3000]", 0.25);
    assert!(cold <= 0.0, "{cold}");
}

/// Smoke of a file has the densities of cells around their numbers, where its map and the scene's put them.
#[test]
fn files_of_smoke_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("smoke.nvdb");
    std::fs::write(&path, crate::nanovdb::tests::smoke_and_heat()).unwrap();
    let medium = |parameters: &str| {
        let file = format!("\"string filename\" \"{}\" {parameters}", path.display());
        let text = smoke("nanovdb", &file);
        format!(
            "Translate 0 0 3 {text} MediumInterface \"smoke\" \"\" \
                 Material \"interface\" Shape \"sphere\" \"float radius\" 200"
        )
    };
    let scene = world(&medium("\"rgb sigma_a\" [0 1 2] \"rgb sigma_s\" [1 1 1]"));
    let kinds: Vec<_> = scene.lights().iter().map(Light::kind).collect();
    assert_eq!(kinds, ["volume"]);
    // Cell (2, 3, 4) of the leaf, along y, z and x of the world.
    let at = Vec3::new(10.0 + 0.5 * 4.0, 0.5 * -6.0, 3.0 + 0.5 * 123.0);
    let lanes = extinction(&scene, at);
    assert_eq!(lanes.map(|lane| lane.round() as i32), [282, 564, 846]);
    let hot = scene.media()[0].emission(at, Lanes::Rgb);
    assert!(hot[0] <= 0.0 && hot[1] > 100.0 * hot[2], "{hot:?}");
    let cold = world(&medium("\"string temperaturename\" \"none\""));
    assert!(cold.lights().is_empty());
}

/// σ_t within a ball of the material `subsurface`, in thousandths.
fn subsurface(parameters: &str) -> [i32; 3] {
    let text = format!("Material \"subsurface\" {parameters} Shape \"sphere\"");
    let scene = world(&text);
    assert_ne!(scene.medium_at(Vec3::ZERO), MediumId::VACUUM);
    extinction(&scene, Vec3::ZERO).map(|lane| (lane * 1e3).round() as i32)
}

#[test]
fn subsurface_has_a_medium_within() {
    assert_eq!(subsurface(""), [2551, 3212, 3784]);
    let named = "\"string name\" \"Ketchup\" \"float scale\" 10";
    assert_eq!(subsurface(named), [2410, 10400, 14800]);
    let both = "\"rgb sigma_a\" [1 2 3] \"rgb sigma_s\" [1 1 1] \"float scale\" 2";
    assert_eq!(subsurface(both), [4000, 6000, 8000]);
    // Of paths, it is the length that is scaled.
    let path = "\"rgb reflectance\" [.2 .5 .8] \"rgb mfp\" [.1 .2 .4] \"float scale\" .5";
    assert_eq!(subsurface(path), [20000, 10000, 5000]);
}

#[test]
fn shapes_of_equal_subsurface_share_a_medium() {
    let ball = "Material \"subsurface\" \"rgb reflectance\" [.2 .5 .8] Shape \"sphere\" ";
    let scene = world(&ball.repeat(300));
    assert_eq!(scene.media().len(), 1);
}

#[test]
fn grids_too_long_are_refused() {
    let values = "1 ".repeat(16385);
    for (size, cells) in [
        ("nx", "16385 · 1 · 1"),
        ("ny", "1 · 16385 · 1"),
        ("nz", "1 · 1 · 16385"),
    ] {
        let parameters = format!("\"float density\" [{values}] \"integer {size}\" 16385");
        let grid = smoke("uniformgrid", &parameters);
        let text = format!("WorldBegin\n{grid} MediumInterface \"smoke\" \"\" Shape \"sphere\"");
        let expected = format!(
            "Limit: s.pbrt:2:69: the grid has {cells} cells, but may have only 16384 along an axis; \
             make it coarser, or cut it into media side by side"
        );
        assert_eq!(outcome(&text, &STRICT), expected);
    }
}
