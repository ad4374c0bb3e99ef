//! What strategies do: contact sheets, which the page has as PNG, and their numbers.

use super::Sheet;
use super::half::base64;
use super::number::number;
use super::table::{NOTHING, table};
use crate::markup::{Element, element};
use crate::results::{Cell, Pyramid, Results, SceneInfo, StrategyInfo, Table};

/// The section: for each scene its sheets and a table.
pub(super) fn section(results: &Results, sheets: &[Sheet]) -> Element {
    let section = super::section("strategies", "Strategies");
    if results.pyramids.is_empty() {
        return section.child(element("p").text(
            "None are shown. In a description, pyramid = \"METHOD\" shows those of a method.",
        ));
    }
    let scene = |pyramid: &Pyramid| {
        let info = results
            .scenes
            .iter()
            .find(|scene| scene.name == pyramid.scene);
        one(pyramid, info, sheets)
    };
    section
        .child(element("p").text(
            "A path of s + t vertices can be made by s from the light and t from the camera. \
             Weighted images show the contribution of each strategy (s, t) to the image, raw \
             ones the strategy alone: all images of a row estimate the same light, and where one \
             is noisy its weight should be small.",
        ))
        .children(results.pyramids.iter().map(scene))
}

/// What there is of a scene.
fn one(pyramid: &Pyramid, scene: Option<&SceneInfo>, sheets: &[Sheet]) -> Element {
    let Pyramid {
        method, seed, spp, ..
    } = pyramid;
    let [width, height] = pyramid.size;
    let is_smaller = scene.is_some_and(|scene| scene.size != pyramid.size);
    let smaller = if is_smaller {
        ", smaller than the renders"
    } else {
        ""
    };
    let figures = [
        (
            "Weighted",
            "the contribution of each strategy to the image",
            &pyramid.weighted,
        ),
        (
            "Raw",
            "each strategy alone, without its weight",
            &pyramid.raw,
        ),
    ];
    let figures = figures.map(|(word, meaning, name)| {
        let sheet = sheets.iter().find(|sheet| sheet.name == *name);
        sheet.map(|sheet| figure(pyramid, [word, meaning], sheet))
    });
    let mut article = element("article")
        .class("strategies")
        .child(element("h3").text(format!("{}: {method}", pyramid.scene)))
        .child(element("p").text(format!(
            "{} samples per pixel, seed {seed}, {width} × {height} pixels{smaller}; paths of up \
             to {} \
             vertices. No time or ray of it counts elsewhere in this page.",
            number(*spp as f64),
            pyramid.vertices
        )))
        .children(figures.into_iter().flatten())
        .child(table(&numbers(pyramid)));
    if let Some(words) = absent(pyramid) {
        article = article.child(element("p").class("note").text(words));
    }
    article
}

fn figure(pyramid: &Pyramid, [word, meaning]: [&str; 2], sheet: &Sheet) -> Element {
    let image = element("img")
        .class("sheet")
        .with("alt", description(pyramid, word))
        .with(
            "src",
            format!("data:image/png;base64,{}", base64(&sheet.png)),
        );
    let scroll = element("div")
        .class("scroll")
        .with("tabindex", 0)
        .with("role", "group")
        .with("aria-label", format!("{word} images of {}", pyramid.scene));
    element("details")
        .with("open", "")
        .child(element("summary").text(format!("{word}: {meaning}")))
        .child(element("figure").child(scroll.child(image)))
}

/// The sheet in words.
fn description(pyramid: &Pyramid, word: &str) -> String {
    let most = pyramid.strategies.iter();
    let most = most.max_by(|a, b| a.mean.total_cmp(&b.mean));
    let most = most.map_or(String::new(), |most| {
        let share = 100.0 * most.mean / pyramid.mean;
        format!(
            " {} contributes most, {share:.0} % of the image.",
            name(most)
        )
    });
    format!(
        "{word} images of the strategies of {} in {}, in a pyramid: a row for each number of \
         vertices \
         from 2 to {}, s growing from left to right.{most} The table below has all numbers.",
        pyramid.method, pyramid.scene, pyramid.vertices
    )
}

fn name(strategy: &StrategyInfo) -> String {
    format!("s={} t={}", strategy.s, strategy.t)
}

fn numbers(pyramid: &Pyramid) -> Table {
    let columns = [
        "strategy",
        "mean",
        "% of the image",
        "raw mean",
        "variance",
        "rays / sample",
        "blocked %",
    ];
    let nothing = || Cell::Text(NOTHING.to_owned());
    let share = |mean: f64| Cell::Number(100.0 * mean / pyramid.mean);
    let rest = [
        ("longer paths", pyramid.longer),
        ("the picture", pyramid.mean),
    ];
    let rest = rest.into_iter().map(|(words, mean)| {
        let cells = [
            Cell::Text(words.to_owned()),
            Cell::Number(mean),
            share(mean),
        ];
        let empty = (cells.len()..columns.len()).map(|_| nothing());
        cells.into_iter().chain(empty).collect()
    });
    let strategies = pyramid.strategies.iter();
    let strategies = strategies.map(|strategy| row(strategy, pyramid, share(strategy.mean)));
    Table {
        caption:
            "Luminances are means over the image. Variance: of what one sample per pixel adds to a \
                  pixel of the weighted image, in the mean pixel."
                .to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: strategies.chain(rest).collect(),
    }
}

fn row(strategy: &StrategyInfo, pyramid: &Pyramid, share: Cell) -> Vec<Cell> {
    let samples = pyramid.spp as f64 * pyramid.size.map(|side| side as f64).iter().product::<f64>();
    let rays = strategy.rays as f64;
    let blocked = 100.0 * strategy.blocked as f64 / rays;
    let known = |number: f64, is_known: bool| {
        if is_known {
            Cell::Number(number)
        } else {
            Cell::Text(NOTHING.to_owned())
        }
    };
    vec![
        Cell::Text(name(strategy)),
        Cell::Number(strategy.mean),
        share,
        Cell::Number(strategy.raw_mean),
        known(
            strategy.variance.unwrap_or_default(),
            strategy.variance.is_some(),
        ),
        known(rays / samples, strategy.rays > 0),
        known(blocked, strategy.rays > 0),
    ]
}

/// The strategies that are not in the table. None: all are.
fn absent(pyramid: &Pyramid) -> Option<String> {
    let is_there = |s, t| {
        let mut known = pyramid.strategies.iter();
        known.any(|known| (known.s, known.t) == (s, t))
    };
    let all = (2..=pyramid.vertices).flat_map(|n| (0..n).map(move |s| (s, n - s)));
    let absent = all.filter(|&(s, t)| !is_there(s, t));
    let absent: Vec<_> = absent.map(|(s, t)| format!("s={s} t={t}")).collect();
    (!absent.is_empty()).then(|| {
        format!(
            "Nothing was counted for {}: the method leaves them out, or they make no path of \
             this scene.",
            absent.join(", ")
        )
    })
}
