//! The page as a whole; `crates/viewer/browser/live/report.test.js` looks at one in a browser.

use super::*;
use serde::Deserialize;

/// The worst that a name can be; names in `page.json` are like it.
const HOSTILE: &str = "</script><img src=x onerror=alert(1)>\"'&";

/// Results with tables and plots that belong to no claim.
#[derive(Deserialize)]
struct Made {
    results: Results,
    tables: Vec<Table>,
    plots: Vec<Plot>,
}

fn made() -> Made {
    serde_json::from_str(include_str!("tests/page.json")).unwrap()
}

fn results() -> Results {
    made().results
}

fn layers() -> [BTreeMap<String, Pixels>; 1] {
    let pixels = Pixels {
        size: [1, 1],
        data: vec![[1.0, 0.5, 0.0]],
    };
    [["", "longer", "raw.s1t2"]
        .map(|name| (name.to_owned(), pixels.clone()))
        .into()]
}

fn images() -> Vec<ReportImage> {
    let image = |name: &str, is_reference, data: [[f32; 3]; 2]| ReportImage {
        scene: HOSTILE.into(),
        name: name.into(),
        is_reference,
        pixels: Pixels {
            size: [2, 1],
            data: data.to_vec(),
        },
        flip: Some(ErrorMap {
            size: [2, 1],
            data: vec![0.0, 1.0],
        }),
    };
    vec![
        image("reference", true, [[1.0, 0.5, 0.0]; 2]),
        image(HOSTILE, false, [[1.0, f32::NAN, f32::INFINITY]; 2]),
    ]
}

fn page(results: &Results) -> String {
    html(&Report {
        results,
        tables: &made().tables,
        plots: &made().plots,
        images: &images(),
        layers: &layers(),
        command: "bidir experiment <file>",
    })
}

/// The text of the element that begins with `start`.
fn inside<'a>(page: &'a str, start: &str, end: &str) -> &'a str {
    let (_, rest) = page.split_once(start).unwrap();
    rest.split_once(end).unwrap().0
}

fn data(page: &str) -> Value {
    serde_json::from_str(inside(page, "id=\"data\">", "</script>")).unwrap()
}

#[test]
fn the_data_come_back_as_they_were() {
    let results = results();
    let first = page(&results);
    let data = data(&first);
    let back: Results = serde_json::from_value(data["results"].clone()).unwrap();
    assert_eq!(back, results);
    let tables: Vec<Table> = serde_json::from_value(data["tables"].clone()).unwrap();
    assert_eq!(tables, made().tables);
    let plots: Vec<Plot> = serde_json::from_value(data["plots"].clone()).unwrap();
    assert_eq!(plots, made().plots);
    assert_eq!(data["command"], "bidir experiment <file>");
    assert_eq!(data["ratios"], RATIOS);
    assert!(first.contains("<title>Title &amp; &lt;b&gt;</title>"));
    assert_eq!(page(&results), first, "the same report has the same bytes");
}

#[test]
fn pixels_are_in_the_page_as_they_are() {
    let data = data(&page(&results()));
    let [reference, render] = [0, 1].map(|index| &data["images"][index]);
    assert_eq!(
        (&reference["scene"], &reference["name"]),
        (&HOSTILE.into(), &"reference".into())
    );
    assert_eq!(reference["is_reference"], true);
    // 1.0, 0.5, 0.0 twice: 00 3c 00 38 00 00.
    assert_eq!(reference["halves"], "ADwAOAAAADwAOAAA");
    assert_eq!(render["name"], HOSTILE);
    assert_eq!(render["size"], json!([2, 1]));
    assert_eq!(render["flip"], "AP4=");
    let layers = data["layers"][0].as_object().unwrap();
    let names: Vec<_> = layers.keys().map(String::as_str).collect();
    assert_eq!(names, ["", "longer", "raw.s1t2"]);
    assert_eq!(layers["raw.s1t2"], "ADwAOAAA");
}

#[test]
fn no_text_is_markup_or_ends_the_script() {
    let mut results = results();
    results.title = HOSTILE.to_owned();
    results.description = "<!-- <script> \0\u{1b}[31m\u{2028}]]>".to_owned();
    results.claims[0].found = HOSTILE.to_owned();
    let page = page(&results);
    assert_eq!(page.matches("<script").count(), 2);
    assert_eq!(page.matches("</script>").count(), 2);
    assert!(!page.contains("<img") && !page.contains("<!--"));
    let json = inside(&page, "id=\"data\">", "</script>");
    assert!(!json.contains('<') && !json.chars().any(char::is_control));
    let back: Results = serde_json::from_value(data(&page)["results"].clone()).unwrap();
    assert_eq!(back, results);
}

#[test]
fn the_policy_has_the_hashes_of_the_style_and_the_script_and_allows_nothing_else() {
    let page = page(&results());
    let hash = |code: &str| base64(&Sha256::digest(code.as_bytes()));
    let style = hash(inside(&page, "<style>", "</style>"));
    let script = hash(inside(&page, "<script type=\"module\">", "</script>"));
    let policy = inside(&page, "Content-Security-Policy\" content=\"", "\"");
    let expected = format!(
        "default-src 'none'; style-src 'sha256-{style}'; script-src 'sha256-{script}'; \
         base-uri 'none'; form-action 'none'"
    );
    assert_eq!(policy.replace("&#39;", "'"), expected);
    let attributes = [" style=\"", " onclick=", " src=\"", " href=\""];
    for attribute in attributes {
        assert!(!page.contains(attribute), "{attribute}");
    }
}

#[test]
fn without_a_script_the_page_has_the_verdicts() {
    let page = page(&results());
    let text = inside(&page, "<noscript>", "</noscript>");
    assert!(text.contains("This page needs JavaScript."));
    for verdict in ["reproduced", "not reproduced", "undecided"] {
        assert!(text.contains(&format!("<b>{verdict}</b>")), "{verdict}");
    }
    assert!(text.contains("What two says found for two"));
}

#[test]
fn every_metric_has_a_meaning() {
    let glossary = module("glossary.js").unwrap();
    for (name, _) in crate::metric::Metric::NAMES {
        assert!(glossary.contains(&format!("\"{name}\",")), "{name}");
    }
}

#[test]
fn a_page_of_nothing_is_a_page() {
    let page = html(&Report {
        results: &Results::default(),
        tables: &[],
        plots: &[],
        images: &[],
        layers: &[],
        command: "",
    });
    assert_eq!(data(&page)["images"], json!([]));
}
