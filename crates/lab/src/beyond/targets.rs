//! What is aimed at: a line adds a target.

use super::measure::View;
use super::variants::{BASELINE, PATH};

/// A gain that is aimed at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    pub(super) scene: &'static str,
    /// The name of the variant that it is over.
    pub(super) over: &'static str,
    pub(super) view: View,
    /// The least gain.
    pub(super) gain: f64,
}

const fn target(view: View, scene: &'static str, over: &'static str, gain: f64) -> Target {
    Target {
        scene,
        over,
        view,
        gain,
    }
}

/// All targets.
pub(super) const TARGETS: [Target; 10] = [
    target(View::EqualTime, "apartment", BASELINE, 8.0),
    target(View::EqualTime, "apartment-dark", BASELINE, 6.0),
    target(View::EqualTime, "veach-ajar", BASELINE, 5.0),
    target(View::EqualTime, "room-indirect", BASELINE, 4.0),
    target(View::EqualTime, "room-direct", BASELINE, 1.5),
    target(View::EqualTime, "room-indirect", PATH, 15.0),
    target(View::EqualTime, "apartment-dark", PATH, 4.0),
    target(View::EqualTime, "apartment", PATH, 1.8),
    target(View::EqualRays, "apartment", BASELINE, 20.0),
    target(View::EqualRays, "apartment-dark", BASELINE, 12.0),
];

/// How much more than the better of `path` and bidirectional path tracing `auto` may cost.
pub(super) const BEHIND: f64 = 1.1;
