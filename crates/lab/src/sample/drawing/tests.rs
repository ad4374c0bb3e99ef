use super::super::tests::{CAMERAS, load, reports, scene, session};
use super::SampleReport;
use bidir::integrator::IntegratorKind;
use bidir::scene::Scene;
use roxmltree::{Document, Node};

/// Elements of `document` with this name.
fn all<'a, 'i>(document: &'a Document<'i>, name: &'a str) -> impl Iterator<Item = Node<'a, 'i>> {
    let elements = document.descendants();
    elements.filter(move |node| node.has_tag_name(name))
}

fn texts<'a>(document: &'a Document<'_>) -> Vec<&'a str> {
    all(document, "text")
        .filter_map(|node| node.text())
        .collect()
}

/// The lines of rays with the texts that name them.
fn rays<'a>(document: &'a Document<'_>) -> Vec<(&'a str, Node<'a, 'a>)> {
    let groups = all(document, "g");
    let rays = groups.filter_map(|group| {
        let title = group.first_element_child()?;
        let line = title.next_sibling_element()?;
        (title.has_tag_name("title") && line.has_tag_name("line")).then_some((title.text()?, line))
    });
    rays.collect()
}

/// What every drawing has; returns how many rays are solid, dashed and dotted.
#[track_caller]
fn check(report: &SampleReport, scene: &Scene) -> [usize; 3] {
    let drawing = report.drawing(scene, "a <b> & \"c\"\u{1}");
    assert_eq!(
        drawing,
        report.drawing(scene, "a <b> & \"c\"\u{1}"),
        "other bytes"
    );
    let document = Document::parse(&drawing).expect("well-formed XML");
    let root = document.root_element();
    assert!(root.has_tag_name(("http://www.w3.org/2000/svg", "svg")));
    for name in ["title", "desc"] {
        let first = root.children().find(|node| node.has_tag_name(name));
        assert!(!first.unwrap().text().unwrap().is_empty());
    }
    let of_scene = all(&document, "title").next().unwrap().text().unwrap();
    assert!(of_scene.ends_with("a <b> & \"c\"\u{fffd}"), "{of_scene}");
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
    check_terms(report, &document)
}

/// Every term is in the table and, where both its ends are somewhere, in both views.
#[track_caller]
fn check_terms(report: &SampleReport, document: &Document<'_>) -> [usize; 3] {
    let (texts, rays) = (texts(document), rays(document));
    let mut counts = [0; 3];
    for candidate in &report.candidates {
        let name = format!("s{}t{}", candidate.term.s, candidate.term.t);
        assert!(texts.contains(&&*name), "{name} is not in the table");
        let own = rays
            .iter()
            .filter(|(title, _)| title.starts_with(&format!("{name} (")));
        let own: Vec<_> = own
            .map(|(_, line)| line.attribute("stroke-dasharray"))
            .collect();
        let kind = match (candidate.is_chosen, candidate.is_visible) {
            (true, true) => (0, None),
            (true, false) => (1, Some("6 4")),
            (false, _) => (2, Some("1 3.5")),
        };
        let count = own.iter().filter(|dashes| **dashes == kind.1).count();
        assert!(count >= 2 && count % 2 == 0, "{name}: {own:?}");
        counts[kind.0] += 1;
    }
    let traced = rays.iter().filter(|(_, line)| {
        let class = line.attribute("class").unwrap();
        ["ray arrives", "ray blocked"].contains(&class)
    });
    assert_eq!(traced.count(), 2 * (counts[0] + counts[1]));
    for hit in &report.hits {
        assert!(texts.contains(&&*format!("s0t{}", hit.t)));
    }
    for (i, _) in report.camera.vertices.iter().enumerate() {
        let name = format!("y{i}");
        let named = texts
            .iter()
            .filter(|text| text.split(' ').next() == Some(&name));
        assert!(named.count() >= 2, "{name} is not in both views");
    }
    counts
}

#[test]
fn every_candidate_is_drawn_as_what_became_of_it() {
    let mut counts = [0; 3];
    for camera in CAMERAS {
        let scene = scene(camera);
        for rule in ["all", "per-pair"] {
            let session = session(&scene, IntegratorKind::Bdpt, rule);
            let reports = reports(&session, 2);
            let several = reports.iter().filter(|r| r.candidates.len() > 1);
            for report in several.step_by(3).take(6) {
                let found = check(report, &scene);
                (0..3).for_each(|i| counts[i] += found[i]);
            }
        }
    }
    assert!(counts.iter().all(|count| *count > 5), "{counts:?}");
}

#[test]
fn all_integrators_have_drawings() {
    let scene = scene(CAMERAS[0]);
    for (_, integrator) in IntegratorKind::NAMES {
        let session = session(&scene, integrator, "all");
        for report in reports(&session, 1).iter().step_by(47) {
            check(report, &scene);
        }
    }
}

#[test]
fn a_walk_into_the_sky_is_told() {
    let text = r#"Film "rgb" "integer xresolution" 2 "integer yresolution" 2
        WorldBegin LightSource "infinite""#;
    let scene = load(text);
    let session = session(&scene, IntegratorKind::Bdpt, "all");
    for report in reports(&session, 2) {
        check(&report, &scene);
        let drawing = report.drawing(&scene, "sky");
        let document = Document::parse(&drawing).unwrap();
        let texts = texts(&document);
        for told in ["escapes", "s0t2", "escape", "found"] {
            assert!(texts.contains(&told), "{told}: {texts:?}");
        }
        assert!(
            texts.iter().any(|text| text.ends_with('\u{221e}')),
            "z0 is far away"
        );
    }
}

#[test]
fn what_has_no_extent_is_drawn() {
    // Nothing to see, nothing that shines: a camera alone.
    let empty = load("Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1 WorldBegin");
    let session = session(&empty, IntegratorKind::Bdpt, "all");
    for report in reports(&session, 1) {
        assert!(report.light.vertices.is_empty() && report.candidates.is_empty());
        check(&report, &empty);
    }
}

#[test]
fn a_lamp_that_is_hit_is_a_row_of_its_own() {
    let text = r#"Camera "perspective" "float fov" 5
        Film "rgb" "integer xresolution" 1 "integer yresolution" 1
        WorldBegin AreaLightSource "diffuse" Translate 0 0 4 Shape "sphere""#;
    let scene = load(text);
    let session = session(&scene, IntegratorKind::Path, "all");
    let report = &reports(&session, 1)[0];
    assert_eq!((report.hits.len(), report.candidates.len()), (1, 0));
    check(report, &scene);
}
