//! The beginning and the end of the page: what it is about, all verdicts at a glance, its size.

use super::number::with_decimals;
use super::{Report, paragraphs, section};
use crate::markup::{Element, element};
use crate::results::{Claim, Verdict};

/// Title, description and the way around the page.
pub(super) fn header(report: &Report<'_>) -> Element {
    let link = |(id, words): (&str, &str)| {
        let link = element("a").with("href", format!("#{id}")).text(words);
        element("li").child(link)
    };
    let links = [
        ("verdicts", "Verdicts"),
        ("setting", "Comparison"),
        ("claims", "Claims"),
        ("more", "More"),
        ("strategies", "Strategies"),
        ("viewer", "Images"),
        ("again", "Again"),
        ("glossary", "Glossary"),
    ];
    let navigation = element("nav")
        .with("aria-label", "Sections")
        .child(element("ul").children(links.into_iter().map(link)));
    element("header")
        .child(element("h1").text(&report.results.title))
        .children(paragraphs(&report.results.description))
        .child(navigation)
}

/// All claims with their verdicts.
pub(super) fn verdicts(claims: &[Claim]) -> Element {
    let section = section("verdicts", "Verdicts");
    if claims.is_empty() {
        return section.child(element("p").text("This experiment examines no claim."));
    }
    let row = |(index, claim): (usize, &Claim)| {
        let link = element("a").with("href", format!("#claim-{}", index + 1));
        element("tr")
            .child(element("td").child(badge(claim.verdict)))
            .child(element("td").child(link.text(&claim.claim)))
            .child(element("td").text(&claim.found))
    };
    let heads = ["verdict", "claim", "what was found"];
    let heads = heads.map(|head| element("th").with("scope", "col").text(head));
    let table = element("table")
        .child(element("thead").child(element("tr").children(heads)))
        .child(element("tbody").children(claims.iter().enumerate().map(row)));
    section
        .child(element("p").text(counts(claims)))
        .child(element("div").class("scroll").child(table))
}

/// How many claims have which verdict.
fn counts(claims: &[Claim]) -> String {
    let count = |(verdict, words): (Verdict, &str)| {
        let of = claims.iter().filter(|claim| claim.verdict == verdict);
        let count = of.count();
        (count > 0).then(|| format!("{count} {words}"))
    };
    let verdicts = [
        (Verdict::Reproduced, "reproduced"),
        (Verdict::NotReproduced, "not reproduced"),
        (Verdict::Met, "met"),
        (Verdict::NotMet, "not met"),
        (Verdict::Undecided, "undecided"),
        (Verdict::NotMeasured, "not measured"),
    ];
    let counts: Vec<_> = verdicts.into_iter().filter_map(count).collect();
    let claims = if claims.len() == 1 {
        "1 claim".into()
    } else {
        format!("{} claims", claims.len())
    };
    format!("{claims}: {}.", counts.join(", "))
}

/// A verdict as a symbol and in words; the colour says it once more.
pub(super) fn badge(verdict: Verdict) -> Element {
    let (class, words) = match verdict {
        Verdict::Reproduced => ("verdict reproduced", "✔ reproduced"),
        Verdict::NotReproduced => ("verdict not-reproduced", "✘ not reproduced"),
        Verdict::Undecided => ("verdict undecided", "? undecided"),
        Verdict::Met => ("verdict reproduced", "✔ met"),
        Verdict::NotMet => ("verdict not-reproduced", "✘ not met"),
        Verdict::NotMeasured => ("verdict undecided", "– not measured"),
    };
    element("span").class(class).text(words)
}

/// The size of the page.
pub(super) fn footer(bytes: usize) -> Element {
    element("footer").child(element("p").text(format!(
        "This page has {} bytes and loads nothing: all it shows is in it.",
        with_decimals(bytes as f64, 0)
    )))
}
