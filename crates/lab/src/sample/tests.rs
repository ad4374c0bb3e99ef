use super::SampleReport;
use bidir::driver::{Resources, Session, Settings};
use bidir::integrator::IntegratorKind;
use formats::scene::{Files, LoadOptions, Loaded, load_from};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scene in 12 x 8 pixels: a floor, a wall, a sphere, a lamp and a sky.
pub(super) fn scene(camera: &str) -> Loaded {
    scene_at(camera, 0.0)
}

/// The same moved along x.
fn scene_at(camera: &str, x: f64) -> Loaded {
    let text = format!(
        r#"
LookAt 0 1 -4  0 1 0  0 1 0
Translate -{x} 0 0
Camera {camera}
Film "rgb" "integer xresolution" 12 "integer yresolution" 8
PixelFilter "box"
WorldBegin
Translate {x} 0 0
LightSource "infinite" "rgb L" [0.3 0.3 0.3]
Material "diffuse" "rgb reflectance" [0.7 0.6 0.5]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-2 0 -2 -2 0 2 2 0 2 2 0 -2]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-2 0 2 -2 3 2 2 3 2 2 0 2]
Shape "sphere" "float radius" 0.7
AttributeBegin
AreaLightSource "diffuse" "rgb L" [9 8 7]
Shape "trianglemesh" "integer indices" [0 2 1 0 3 2]
  "point3 P" [-0.3 2.5 0 -0.3 2.5 0.6 0.3 2.5 0.6 0.3 2.5 0]
AttributeEnd
"#
    );
    load(&text)
}

/// The scene that is written as `text`.
pub(super) fn load(text: &str) -> Loaded {
    let files = Files::only([(PathBuf::from("s.pbrt"), Arc::from(text.as_bytes()))].into());
    let loaded = load_from(Path::new("s.pbrt"), &LoadOptions::default(), &files);
    loaded.expect("the scene is valid")
}

pub(super) fn session<'a>(
    loaded: &'a Loaded,
    integrator: IntegratorKind,
    rule: &str,
) -> Session<'a> {
    let settings = Settings {
        shadow_rays: rule.parse().expect("a rule"),
        ..Settings::new(integrator)
    };
    let resources = Resources {
        threads: 1,
        ..Resources::default()
    };
    Session::new(&loaded.scene, &loaded.view, settings, &resources).expect("the film is small")
}

/// The reports of every pixel of the first passes.
pub(super) fn reports(session: &Session<'_>, passes: u64) -> Vec<SampleReport> {
    let [width, height] = session.view().film().resolution;
    let pixels = (0..width).flat_map(|x| (0..height).map(move |y| [x, y]));
    let samples = pixels.flat_map(|pixel| (0..passes).map(move |pass| (pixel, pass)));
    let report = |(pixel, pass)| {
        let replay = session.replay(pixel, pass).expect("the pixel is rendered");
        SampleReport::new(session, pixel, pass, &replay)
    };
    samples.map(report).collect()
}

pub(super) const CAMERAS: [&str; 5] = [
    r#""perspective" "float fov" 50"#,
    r#""perspective" "float fov" 50 "float lensradius" 0.2 "float focaldistance" 3"#,
    r#""orthographic" "float screenwindow" [-2 2 -1.3 1.3]"#,
    r#""spherical" "string mapping" "equirectangular""#,
    r#""spherical" "string mapping" "equalarea""#,
];

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

#[test]
fn the_first_hit_is_seen_in_the_pixel() {
    for camera in CAMERAS {
        let scene = scene(camera);
        let session = session(&scene, IntegratorKind::Bdpt, "all");
        let mut hits = 0;
        for report in reports(&session, 2) {
            let json = serde_json::to_value(&report).unwrap();
            let vertices = json["camera"]["vertices"].as_array().unwrap();
            assert!(vertices[0]["raster"].is_null(), "{camera}");
            let Some(y1) = vertices.get(1) else { continue };
            for (axis, pixel) in report.pixel.into_iter().enumerate() {
                let offset = number(&y1["raster"][axis]) - f64::from(pixel);
                assert!((-1e-3..1.001).contains(&offset), "{camera}: {offset}");
            }
            hits += 1;
        }
        assert!(hits > 5, "{camera}: {hits}");
    }
}

/// Also far away, where the scene is rendered around another origin.
#[test]
fn positions_are_those_of_the_world() {
    let x = 1_048_576.0;
    let scene = scene_at(CAMERAS[0], x);
    assert_eq!(scene.scene.space().origin.x.to_bits(), x.to_bits());
    let session = session(&scene, IntegratorKind::Bdpt, "all");
    let mut count = 0;
    for report in reports(&session, 1) {
        let all = report.camera.vertices.iter().chain(&report.light.vertices);
        for vertex in all.filter(|vertex| !vertex.place.is_infinite) {
            let [found, y, _] = vertex.place.position;
            assert!((f64::from(found) - x).abs() < 2.5 && y < 4.0, "{found} {y}");
            count += 1;
        }
        assert!(report.drawing(&session, "s.pbrt").contains("<svg"));
    }
    assert!(count > 96, "{count}");
}

#[test]
fn splats_land_where_their_vertex_is_seen() {
    // With a lens splats have lens points of their own.
    for camera in CAMERAS.into_iter().filter(|c| !c.contains("lens")) {
        let scene = scene(camera);
        let session = session(&scene, IntegratorKind::Light, "all");
        let reports = reports(&session, 2);
        let splats = reports.iter().flat_map(|report| &report.light_image);
        let mut count = 0;
        for splat in splats {
            let ray = splat.ray.as_ref().unwrap();
            let seen = ray.light_end.raster.expect("it is in front");
            for (a, b) in seen.into_iter().zip(ray.landing.unwrap().raster) {
                assert!((a - b).abs() < 1e-3, "{camera}: {a} {b}");
            }
            count += 1;
        }
        assert!(count > 20, "{camera}: {count}");
    }
}

#[test]
fn what_is_behind_the_camera_is_on_no_film() {
    let scene = scene(CAMERAS[0]);
    let session = session(&scene, IntegratorKind::Bdpt, "all");
    let reports = reports(&session, 2);
    let lights = reports.iter().filter_map(|r| r.light.vertices.first());
    let of_sky: Vec<_> = lights.filter(|z0| z0.place.is_infinite).collect();
    assert!(!of_sky.is_empty());
    for z0 in of_sky {
        let is_in_front = z0.place.position[2] > 0.0;
        assert_eq!(z0.place.raster.is_some(), is_in_front);
    }
}

#[test]
fn connections_end_at_vertices_of_the_light_subpath() {
    let scene = scene(CAMERAS[0]);
    let session = session(&scene, IntegratorKind::Bdpt, "per-pair");
    let (mut own, mut fresh) = (0, 0);
    for report in reports(&session, 2) {
        for candidate in &report.candidates {
            let s = usize::from(candidate.s);
            let is_own =
                candidate.ray.as_ref().unwrap().light_end == report.light.vertices[s - 1].place;
            own += usize::from(is_own);
            // Next-event estimation draws a light point for each camera vertex.
            fresh += usize::from(!is_own);
            assert!(is_own || s == 1, "s = {s}");
        }
    }
    assert!(own > 5 && fresh > 5, "{own} {fresh}");
}
