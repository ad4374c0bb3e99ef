//! The page as a whole; a browser looks at it in `tests/report.rs`.

use super::*;
use crate::results::{
    Axis, BudgetInfo, BudgetKind, Cell, Claim, FORMAT, Machine, MethodInfo, PlotKind, Pyramid,
    Scale, SceneInfo, Series, StrategyInfo, Verdict,
};

/// What a name can be at worst.
const HOSTILE: &str = "</script><img src=x onerror=alert(1)>\"'&";

fn table(caption: &str) -> Table {
    Table {
        caption: caption.into(),
        columns: vec!["method".into(), "relmse".into()],
        rows: vec![vec![Cell::Text(HOSTILE.into()), Cell::Number(0.25)]],
    }
}

fn curve(caption: &str, kind: PlotKind, points: &[[f64; 2]]) -> Plot {
    let axis = |label: &str| Axis {
        label: label.into(),
        scale: Scale::Log,
    };
    Plot {
        caption: caption.into(),
        kind,
        x: axis("rays per pixel"),
        y: axis("error"),
        series: vec![Series {
            name: HOSTILE.into(),
            points: points.to_vec(),
            intervals: points.iter().map(|[_, y]| [0.9 * y, 1.1 * y]).collect(),
        }],
    }
}

fn claim(id: &str, verdict: Verdict) -> Claim {
    Claim {
        id: id.into(),
        claim: format!("What {id} says"),
        source: format!("source of {id}"),
        verdict,
        found: format!("found for {id}"),
        method: format!("test of {id}"),
        tables: vec![table(&format!("table of {id}"))],
        plots: vec![curve(
            &format!("plot of {id}"),
            PlotKind::Lines,
            &[[1.0, 2.0], [10.0, 0.2]],
        )],
    }
}

fn pyramid() -> Pyramid {
    let strategy = |s, t, rays| StrategyInfo {
        s,
        t,
        mean: 0.25,
        raw_mean: 0.5,
        variance: None,
        rays,
        blocked: rays / 4,
        raw_dropped: 0,
    };
    Pyramid {
        scene: HOSTILE.into(),
        method: HOSTILE.into(),
        seed: 3,
        spp: 2,
        size: [4, 2],
        vertices: 3,
        mean: 1.0,
        longer: 0.5,
        strategies: vec![strategy(0, 2, 0), strategy(1, 2, 8)],
        weighted: "images/weighted.png".into(),
        raw: "images/raw.png".into(),
    }
}

fn sheets() -> [Sheet; 2] {
    [("images/weighted.png", b"foo"), ("images/raw.png", b"bar")].map(|(name, png)| Sheet {
        name: name.into(),
        png: png.to_vec(),
    })
}

fn results() -> Results {
    let method = |name: &str, rays: &str| MethodInfo {
        name: name.into(),
        settings: [("mis", "power"), ("shadow-rays", rays)]
            .map(|(key, value)| (key.to_owned(), value.to_owned()))
            .into(),
    };
    Results {
        format: FORMAT,
        title: "Title & <b>".into(),
        description: "First.\n\nSecond.".into(),
        program: "bidir 7.8.9".into(),
        machine: Machine::default(),
        scenes: vec![SceneInfo {
            name: "room".into(),
            file: "room.pbrt".into(),
            digest: "abc123".into(),
            size: [2, 1],
            reference: "made with care".into(),
            reference_image: None,
            reference_mse: None,
        }],
        methods: vec![method("first", "all"), method(HOSTILE, "per-pair")],
        budgets: vec![BudgetInfo {
            name: "64 spp".into(),
            kind: BudgetKind::Samples,
            amount: 64.0,
        }],
        records: Vec::new(),
        pyramids: vec![pyramid()],
        contributions: Vec::new(),
        claims: vec![
            claim("one", Verdict::Reproduced),
            claim("two", Verdict::NotReproduced),
            claim("three", Verdict::Undecided),
        ],
    }
}

fn images() -> Vec<ReportImage> {
    let image = |kind, data: [[f32; 3]; 2]| ReportImage {
        scene: HOSTILE.into(),
        kind,
        pixels: Pixels {
            size: [2, 1],
            data: data.to_vec(),
        },
        flip: Some(ErrorMap {
            size: [2, 1],
            data: vec![0.0, 1.0],
        }),
    };
    let render = ImageKind::Render {
        method: HOSTILE.into(),
        budget: "64 spp".into(),
    };
    vec![
        image(ImageKind::Reference, [[1.0, 0.5, 0.0]; 2]),
        image(render, [[1.0, f32::NAN, f32::INFINITY]; 2]),
    ]
}

fn page(results: &Results) -> String {
    html(&Report {
        results,
        tables: &[table("a table of none")],
        plots: &[
            curve(
                "a plot of none",
                PlotKind::Histogram,
                &[[1.0, 3.0], [2.0, 0.0]],
            ),
            curve("a plot without points", PlotKind::Lines, &[[0.0, 1.0]]),
        ],
        images: &images(),
        sheets: &sheets(),
        command: "bidir experiment <file>",
    })
}

#[test]
fn everything_is_in_the_page() {
    let page = page(&results());
    let parts = [
        "Title &amp; &lt;b&gt;",
        "First.",
        "Second.",
        "bidir 7.8.9",
        "room.pbrt",
        "abc123",
        "made with care",
        "2 × 1",
        "64 spp",
        "shadow-rays",
        "per-pair",
        "✔ reproduced",
        "✘ not reproduced",
        "? undecided",
        "a table of none",
        "a plot of none",
        "a plot without points",
        "No point of this plot can be drawn",
        "bidir experiment &lt;file&gt;",
        "1 reproduced, 1 not reproduced, 1 undecided",
    ];
    for part in parts {
        assert!(page.contains(part), "{part}");
    }
    for id in ["one", "two", "three"] {
        for part in [
            "What",
            "source of",
            "found for",
            "test of",
            "table of",
            "plot of",
        ] {
            let says = if part == "What" { " says" } else { "" };
            assert!(page.contains(&format!("{part} {id}{says}")), "{part} {id}");
        }
    }
    for (name, _) in crate::metric::Metric::NAMES {
        assert!(page.contains(&format!("<dt>{name}</dt>")), "{name}");
    }
    assert_eq!(page.matches("<svg").count(), 4);
}

#[test]
fn nothing_in_a_text_is_markup() {
    let page = page(&results());
    // The two sheets alone.
    assert_eq!(page.matches("<img").count(), 2);
    assert!(!page.contains("<img src=x"));
    // The pixels and the scripts: one end each.
    assert_eq!(page.matches("</script>").count(), 2);
    assert_eq!(page.matches("<script").count(), 2);
    let handler = [" onclick=", " onload=", " onerror=\"", " style=\""];
    for attribute in handler {
        assert!(!page.contains(attribute), "{attribute}");
    }
}

#[test]
fn nothing_is_elsewhere() {
    let page = page(&results()).replace("src=\"data:image/png;base64,", "");
    for scheme in [
        "http:", "https:", "//cdn", "url(", "@import", "src=\"", "import(",
    ] {
        assert!(!page.contains(scheme), "{scheme}");
    }
    assert!(page.contains("default-src &#39;none&#39;"));
    assert!(page.contains("img-src data:;"));
}

#[test]
fn pixels_are_in_the_page_as_they_are() {
    let page = page(&results());
    let start = page.find("id=\"images\">").unwrap() + "id=\"images\">".len();
    let json = &page[start..start + page[start..].find("</script>").unwrap()];
    let scenes: serde_json::Value = serde_json::from_str(json).unwrap();
    assert_eq!(scenes[0]["name"], HOSTILE);
    assert_eq!(scenes[0]["images"][0]["is_reference"], true);
    // 1.0, 0.5, 0.0 twice: 00 3c 00 38 00 00.
    assert_eq!(scenes[0]["images"][0]["halves"], "ADwAOAAAADwAOAAA");
    assert_eq!(
        scenes[0]["images"][1]["name"],
        format!("{HOSTILE} · 64 spp")
    );
    assert_eq!(scenes[0]["images"][1]["flip"], "AP4=");
}

#[test]
fn strategies_have_sheets_and_numbers() {
    let page = page(&results());
    let start = page.find("<section id=\"strategies\">").unwrap();
    let section = &page[start..start + page[start..].find("</section>").unwrap()];
    for part in [
        "src=\"data:image/png;base64,Zm9v\"",
        "src=\"data:image/png;base64,YmFy\"",
        "alt=\"Raw images of the strategies of ",
        "s=1 t=2 contributes most, 25 % of the image.",
        "2 samples per pixel, seed 3, 4 × 2 pixels",
        "Nothing was counted for s=1 t=1, s=0 t=3, s=2 t=1:",
        "longer paths",
    ] {
        assert!(section.contains(part), "{part}: {section}");
    }
    // Half a ray for each sample, a quarter of them blocked; s = 0 has none.
    let rows: Vec<_> = section.split("<tr>").collect();
    let row = |name: &str| rows.iter().find(|row| row.contains(name)).unwrap();
    let numbers = |row: &str| row.matches("class=\"number\"").count();
    assert!(row("s=1 t=2</td>").contains(">0.5<") && row("s=1 t=2</td>").contains(">25<"));
    assert_eq!(numbers(row("s=0 t=2</td>")), 6);
    assert_eq!(row("s=0 t=2</td>").matches('–').count(), 3);
}

#[test]
fn the_page_knows_its_size() {
    let page = page(&results());
    let size = number::with_decimals(page.len() as f64, 0);
    assert!(page.contains(&format!("This page has {size} bytes")));
}

#[test]
fn a_page_of_nothing_is_a_page() {
    let empty = Results {
        scenes: Vec::new(),
        methods: Vec::new(),
        budgets: Vec::new(),
        claims: Vec::new(),
        pyramids: Vec::new(),
        ..results()
    };
    let page = html(&Report {
        results: &empty,
        tables: &[],
        plots: &[],
        images: &[],
        sheets: &[],
        command: "",
    });
    assert!(page.contains("This experiment examines no claim."));
    assert!(page.contains("No images were kept."));
    assert!(page.contains("pyramid = &quot;METHOD&quot;"));
}

#[test]
fn points_without_a_place_are_told() {
    let some = curve(
        "p",
        PlotKind::Lines,
        &[[1.0, 2.0], [2.0, 0.0], [f64::NAN, 1.0]],
    );
    let figure = plot::figure(&some, "p").to_string();
    assert!(figure.contains("left out: 2."), "{figure}");
    assert_eq!(figure.matches("<tr>").count(), 4);
}

/// The classes and ids that scripts and styles name are those of the page.
#[test]
fn scripts_find_their_elements() {
    let page = page(&results());
    let named = SCRIPT.split("byId(\"").skip(1);
    let mut ids: Vec<_> = named.map(|rest| rest.split('"').next().unwrap()).collect();
    ids.sort_unstable();
    ids.dedup();
    assert!(ids.len() > 15, "{ids:?}");
    for id in ids {
        assert!(page.contains(&format!("id=\"{id}\"")), "{id}");
    }
}
