//! How to make the report again, and what its words mean.

use super::{Report, definitions};
use crate::markup::{Element, element};
use crate::metric::Metric;
use crate::statistics::RATIOS;

/// How to make all of it again.
pub(super) fn again(report: &Report<'_>) -> Element {
    let command = element("pre").child(element("code").text(report.command));
    super::section("again", "How to reproduce it")
        .child(element("p").text(format!(
            "With {} this command renders everything again and writes this page:",
            report.results.program
        )))
        .child(command)
        .child(element("p").text(
            "Images are the same bits on every machine, for any number of threads, as far as their \
             budget is in samples. Times are those of the machine above. The scenes are the same \
             if their digests are.",
        ))
}

/// Metrics and other words.
pub(super) fn section() -> Element {
    let metrics = Metric::NAMES.map(|(name, metric)| (name, meaning(metric)));
    let pairs = metrics.into_iter().chain(WORDS);
    let pairs = pairs.map(|(word, meaning)| (word.to_owned(), meaning.to_owned()));
    super::section("glossary", "Glossary")
        .child(element("p").text(
            "Each metric compares an image with its reference, channel by channel in linear \
             light; 0 is equality, and less is better.",
        ))
        .child(definitions(pairs))
}

fn meaning(metric: Metric) -> &'static str {
    match metric {
        Metric::Rmse => {
            "Root of the mean square error: the root of the mean, over all pixels and channels, of \
             (image − reference)²."
        }
        Metric::Relmse => {
            "Relative mean square error: the mean, over all pixels and channels, of \
             (image − reference)² / (reference² + 0.01). Dark and bright regions count alike."
        }
        Metric::RmseTrimmed => {
            "rmse without the 0.1 % of pixels that have the largest error: what is left when a few \
             very bright pixels are set aside. Biased downwards."
        }
        Metric::RelmseTrimmed => "relmse without the 0.1 % of pixels that have the largest error.",
        Metric::RelmseBlock => {
            "relmse of the means over blocks of 16 × 16 pixels: the error that is left where \
             noise of \
             single pixels averages out, such as that which neighbours share."
        }
        Metric::Mape => {
            "Mean absolute relative error: the mean, over all pixels and channels, of \
             |image − reference| / (|reference| + 0.01)."
        }
        Metric::Flip => {
            "The difference that an observer sees when image and reference alternate at the same \
             place on a screen that shows 0 to 1: 0 is none, 1 is black for white. The mean over \
             all pixels."
        }
        Metric::FlipHdr => {
            "The same for light of any strength: each pixel at the exposure at which the \
             difference \
             is seen best."
        }
    }
}

const WORDS: [(&str, &str); 13] = [
    (
        "efficiency",
        "1 / (mean square error · cost), with the cost in rays or in seconds. Twice the efficiency \
         gives the same error for half the cost. Training is part of both costs.",
    ),
    (
        "interval [low, high]",
        "Such intervals contain the true value in the stated share of repetitions of the whole \
         experiment; 95 of 100 where nothing else is said. They are taken over independent \
         seeds; those of means are Student's.",
    ),
    ("ratio", RATIOS),
    (
        "reproduced, not reproduced, undecided",
        "The results confirm the claim, or contradict it, and the intervals leave no doubt; \
         otherwise it is undecided.",
    ),
    (
        "met, not met, not measured",
        "The target is reached, or is missed, and the interval leaves no doubt; or it was not \
         measured.",
    ),
    (
        "processor seconds",
        "The processor time of all threads, as user and as system, training included: on a busy \
         machine the same work takes more seconds, but hardly more processor seconds.",
    ),
    (
        "reference",
        "An image that is nearly exact: rendered with far more samples than what is compared \
         with it, as described for each scene. Its own noise is in all errors.",
    ),
    (
        "samples per pixel, spp",
        "For each sample of a pixel one path is walked from the camera and one from a light.",
    ),
    (
        "rays",
        "Rays of all kinds: those of both walks, shadow rays between them, shadow rays to the \
         camera, and those of training, which the claims on the 1995 paper leave out.",
    ),
    (
        "strategy (s, t)",
        "A way to make a path: s vertices are walked from a light and t from the camera, and the \
         two \
         ends are joined. A path of n vertices has n strategies, from s = 0 to t = 1.",
    ),
    (
        "weighted, raw",
        "Of a contribution, with the weight by which strategies share the paths that several of \
         them \
         can make, and without it.",
    ),
    (
        "seed",
        "It selects the random numbers. Renders with different seeds are independent.",
    ),
    (
        "log-log plot",
        "Equal distances are equal factors. The error of an unbiased method falls along a straight \
         line: its mean square by a factor of ten for ten times the cost.",
    ),
];
