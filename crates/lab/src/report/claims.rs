//! Claims: what others said, and what was found.

use super::overview::badge;
use super::{definitions, plot, table};
use crate::markup::{Element, element};
use crate::results::Claim;

/// All claims, one after the other.
pub(super) fn section(claims: &[Claim]) -> Element {
    let section = super::section("claims", "Claims");
    if claims.is_empty() {
        return section.child(element("p").text("This experiment examines no claim."));
    }
    let claims = claims.iter().zip(1..);
    section.children(claims.map(|(claim, number)| article(claim, number)))
}

fn article(claim: &Claim, number: usize) -> Element {
    let pairs = [
        ("Claimed in", &claim.source),
        ("Found", &claim.found),
        ("How sure", &claim.method),
    ];
    let pairs = pairs.map(|(word, meaning)| (word.to_owned(), meaning.clone()));
    let heading = element("h3")
        .text(format!("{number}. {} ", claim.claim))
        .child(badge(claim.verdict));
    let plots = claim.plots.iter().enumerate();
    element("article")
        .with("id", format!("claim-{number}"))
        .child(heading)
        .child(definitions(pairs))
        .children(claim.tables.iter().map(table::table))
        .children(
            plots.map(|(index, plot)| plot::figure(plot, &format!("claim-{number}-plot-{index}"))),
        )
        .child(
            element("p")
                .class("note")
                .text(format!("In results.json: {}", claim.id)),
        )
}
