//! The training before the first pass.

use bidir::driver::Session;
use bidir::stats::RayCounts;
use serde::Serialize;

/// The report of training. Numbers that are not finite are null in JSON.
#[derive(Clone, Debug, Serialize)]
pub struct TrainingReport {
    /// The number of samples.
    pub samples: u64,
    /// The mean luminance of the image.
    pub mean_luminance: f32,
    /// The score from which on a candidate is certainly traced. None: the selection has no such score.
    pub threshold: Option<f32>,
    /// The rays of training.
    pub rays: RayCounts,
    /// The plan of `auto`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plan: Option<String>,
}

impl TrainingReport {
    /// Returns the report of a session's training. None: there was no training.
    pub fn new(session: &Session<'_>) -> Option<Self> {
        let training = session.training()?;
        let rule = session.settings().shadow_rays;
        Some(Self {
            samples: training.samples,
            mean_luminance: training.mean_luminance,
            threshold: rule.threshold(training.mean_luminance),
            rays: training.rays,
            plan: training.plan.map(|plan| plan.to_string()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_are_not_finite_are_null() {
        let report = TrainingReport {
            samples: 1,
            mean_luminance: f32::NAN,
            threshold: Some(f32::INFINITY),
            rays: RayCounts::default(),
            plan: None,
        };
        let json = serde_json::to_value(report).unwrap();
        assert!(json["mean_luminance"].is_null() && json["threshold"].is_null());
    }
}
