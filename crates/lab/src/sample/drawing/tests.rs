use super::super::tests::{CAMERAS, load, reports, scene, session};
use super::SampleReport;
use bidir::driver::Session;
use bidir::integrator::IntegratorKind;
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
    let rays = all(document, "polyline").filter_map(|line| {
        let title = line.first_element_child()?;
        Some((title.text()?, line))
    });
    rays.collect()
}

/// Checks the parts that every drawing has; returns the numbers of solid, dashed and dotted rays.
#[track_caller]
fn check(report: &SampleReport, session: &Session<'_>) -> [usize; 3] {
    let drawing = report.drawing(session, "a <b> & \"c\"\u{1}");
    assert_eq!(
        drawing,
        report.drawing(session, "a <b> & \"c\"\u{1}"),
        "other bytes"
    );
    let document = Document::parse(&drawing).expect("well-formed XML");
    let root = document.root_element();
    assert!(root.has_tag_name(("http://www.w3.org/2000/svg", "svg")));
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

/// Every candidate and splat is a line in both views, the legend counts them, and all vertices have
/// names.
#[track_caller]
fn check_terms(report: &SampleReport, document: &Document<'_>) -> [usize; 3] {
    let (texts, rays) = (texts(document), rays(document));
    let count = |class| {
        let own = rays
            .iter()
            .filter(|(_, line)| line.attribute("class") == Some(class));
        own.count()
    };
    let mut counts = [0; 3];
    for candidate in &report.candidates {
        let name = format!("s{}t{}: ", candidate.term.s, candidate.term.t);
        let kind = match (candidate.is_chosen, candidate.is_visible) {
            (true, true) => 0,
            (true, false) => 1,
            (false, _) => 2,
        };
        let class = ["arrives", "blocked", "untraced"][kind];
        let mut own = rays.iter().filter(|(title, _)| title.starts_with(&name));
        assert!(
            own.any(|(_, line)| line.attribute("class") == Some(class)),
            "{name}"
        );
        counts[kind] += 1;
    }
    assert_eq!(
        counts.map(|count| 2 * count),
        ["arrives", "blocked", "untraced"].map(count)
    );
    for (meaning, count) in [
        "shadow rays that arrive",
        "shadow rays, blocked",
        "candidates, not traced",
    ]
    .into_iter()
    .zip(counts)
    {
        assert!(
            texts.contains(&&*format!("{meaning}: {count}")),
            "{meaning}"
        );
    }
    let visible = report
        .light_image
        .iter()
        .filter(|splat| splat.is_visible)
        .count();
    assert_eq!(count("splat"), 2 * visible);
    assert_eq!(
        count("splat hidden"),
        2 * (report.light_image.len() - visible)
    );
    for (letter, subpath) in [('y', &report.camera), ('z', &report.light)] {
        for i in 0..subpath.vertices.len() {
            let name = format!("{letter}{i}");
            let named = texts
                .iter()
                .filter(|text| text.split(' ').next() == Some(&name));
            assert_eq!(named.count(), 2, "{name}");
        }
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
                let found = check(report, &session);
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
            check(report, &session);
        }
    }
}

#[test]
fn a_walk_into_the_sky_ends_in_an_arrow() {
    let text = r#"Film "rgb" "integer xresolution" 2 "integer yresolution" 2
        WorldBegin LightSource "infinite""#;
    let scene = load(text);
    let session = session(&scene, IntegratorKind::Bdpt, "all");
    for report in reports(&session, 2) {
        check(&report, &session);
        let drawing = report.drawing(&session, "sky");
        let document = Document::parse(&drawing).unwrap();
        let lines = all(&document, "polyline");
        let arrows = lines.filter(|line| line.attribute("class") == Some("track escape"));
        assert!(arrows.count() >= 2);
        let texts = texts(&document);
        assert!(texts.contains(&"z0 \u{221e}"), "{texts:?}");
    }
}

#[test]
fn what_has_no_extent_is_drawn() {
    // Nothing to see, nothing that shines: a camera alone.
    let empty = load("Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1 WorldBegin");
    let session = session(&empty, IntegratorKind::Bdpt, "all");
    for report in reports(&session, 1) {
        assert!(report.light.vertices.is_empty() && report.candidates.is_empty());
        check(&report, &session);
    }
}

#[test]
fn a_lamp_that_is_hit_is_counted() {
    let text = r#"Camera "perspective" "float fov" 5
        Film "rgb" "integer xresolution" 1 "integer yresolution" 1
        WorldBegin AreaLightSource "diffuse" Translate 0 0 4 Shape "sphere""#;
    let scene = load(text);
    let session = session(&scene, IntegratorKind::Path, "all");
    let report = &reports(&session, 1)[0];
    assert_eq!((report.hits.len(), report.candidates.len()), (1, 0));
    check(report, &session);
    assert!(
        report
            .drawing(&session, "lamp")
            .contains("1 hits of lights")
    );
}

#[test]
fn edges_of_the_scene_are_drawn() {
    let scene = scene(CAMERAS[0]);
    let session = session(&scene, IntegratorKind::Bdpt, "all");
    let reports = reports(&session, 1);
    // Of a sample that is as large as the scene both views show the whole scene.
    let largest = reports.iter().max_by_key(|report| report.candidates.len());
    let drawing = largest.unwrap().drawing(&session, "scene");
    let document = Document::parse(&drawing).unwrap();
    let edges: Vec<_> = all(&document, "path")
        .map(|path| path.attribute("d").unwrap())
        .collect();
    assert_eq!(edges.len(), 2);
    assert!(
        edges.iter().all(|edges| edges.matches('M').count() > 50),
        "{edges:?}"
    );
}
