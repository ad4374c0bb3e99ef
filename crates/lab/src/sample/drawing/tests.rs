use super::super::tests::{CAMERAS, load, reports, scene, session};
use super::{Figure, KINDS, SampleReport};
use bidir::driver::Session;
use bidir::integrator::IntegratorKind;
use expect_test::expect_file;
use roxmltree::Document;

const HOSTILE: &str = "a <b> & \"c\"\u{1}";
const PIXEL: &str = r#"Film "rgb" "integer xresolution" 1 "integer yresolution" 1 "#;

/// Returns a drawing, which is well-formed, loads nothing, and has no number that is none.
#[track_caller]
fn drawing(report: &SampleReport, session: &Session<'_>) -> String {
    let drawing = report.drawing(session, HOSTILE);
    let document = Document::parse(&drawing).expect("well-formed XML");
    let root = document.root_element();
    assert!(root.has_tag_name(("http://www.w3.org/2000/svg", "svg")));
    let title = root
        .first_element_child()
        .and_then(|title| title.text())
        .unwrap();
    assert!(
        title.ends_with(&HOSTILE.replace('\u{1}', "\u{fffd}")),
        "{title}"
    );
    for node in document.descendants() {
        assert!(!["script", "image", "a", "foreignObject"].contains(&node.tag_name().name()));
        for attribute in node.attributes() {
            let (name, value) = (attribute.name(), attribute.value());
            assert!(!name.starts_with("on") && name != "href", "{name}");
            assert!(
                !value.contains("NaN") && !value.contains("inf"),
                "{name}: {value}"
            );
        }
    }
    drawing
}

/// Returns a drawing with only the number of the edges of the scene, which are thousands.
fn without_edges(drawing: &str) -> String {
    let line = |line: &str| match line.split_once(" d=\"") {
        Some((begin, edges)) => format!("{begin}> {} edges\n", edges.matches('M').count()),
        None => format!("{line}\n"),
    };
    drawing.lines().map(line).collect()
}

/// The first sample with a line of each kind.
#[test]
fn drawings_are_as_expected() {
    let scene = scene(CAMERAS[0]);
    let session = session(&scene, IntegratorKind::Bdpt, "per-pair");
    let reports = reports(&session, 16);
    let drawings = KINDS.map(|[class, _]| {
        let has_one = |report: &&SampleReport| Figure::new(report).of_class(class).next().is_some();
        let report = reports.iter().find(has_one).expect(class);
        without_edges(&drawing(report, &session))
    });
    expect_file!["golden.txt"].assert_eq(&drawings.join("\n"));
}

#[test]
fn all_cameras_and_integrators_have_drawings() {
    for camera in CAMERAS {
        let scene = scene(camera);
        for (_, integrator) in IntegratorKind::NAMES {
            let session = session(&scene, integrator, "all");
            for report in reports(&session, 1).iter().step_by(47) {
                drawing(report, &session);
            }
        }
    }
}

/// A camera alone, which sees nothing; a sky alone, where walks end in an arrow; a lamp that is hit.
#[test]
fn what_has_no_extent_is_drawn() {
    let lamp = r#"AreaLightSource "diffuse" Translate 0 0 4 Shape "sphere""#;
    for (camera, world, parts) in [
        ("", "", &[", 0 hits of lights", "y0"][..]),
        (
            "",
            r#"LightSource "infinite""#,
            &["track escape", "z0 \u{221e}"],
        ),
        (
            r#"Camera "perspective" "float fov" 5 "#,
            lamp,
            &[", 1 hits of lights"],
        ),
    ] {
        let scene = load(&format!("{camera}{PIXEL}WorldBegin {world}"));
        for integrator in [IntegratorKind::Bdpt, IntegratorKind::Path] {
            let session = session(&scene, integrator, "all");
            for report in reports(&session, 2) {
                let drawing = drawing(&report, &session);
                for part in parts {
                    let is_of_light = part.starts_with('z') && integrator == IntegratorKind::Path;
                    assert!(is_of_light || drawing.contains(part), "{part}: {drawing}");
                }
            }
        }
    }
}

#[test]
fn edges_of_the_scene_are_drawn() {
    let scene = scene(CAMERAS[0]);
    let session = session(&scene, IntegratorKind::Bdpt, "all");
    let reports = reports(&session, 1);
    // Of a sample that is as large as the scene both views show the whole scene.
    let largest = reports.iter().max_by_key(|report| report.candidates.len());
    let drawing = without_edges(&drawing(largest.unwrap(), &session));
    let edges = drawing
        .lines()
        .filter_map(|line| line.strip_suffix(" edges"));
    let edges: Vec<u32> = edges
        .map(|line| line.rsplit(' ').next().unwrap().parse().unwrap())
        .collect();
    assert!(
        edges.len() == 2 && edges.iter().all(|count| *count > 50),
        "{edges:?}"
    );
}
