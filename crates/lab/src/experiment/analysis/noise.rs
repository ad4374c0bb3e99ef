//! The share of the reference's noise in measured errors.
//!
//! An image and its reference are independent, so the measured mean square error is the sum of two: the
//! image's own, and the reference's, which is the mean variance of the reference's pixels. Errors are not
//! corrected for it; a large share gives a warning.

use super::records_of;
use crate::results::{Record, Results, SceneInfo};
use serde::Serialize;

/// The share above which there is a warning.
const LARGE: f64 = 0.1;

/// The noise of a reference relative to the smallest error measured against it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReferenceNoise<'a> {
    /// The scene.
    pub scene: &'a str,
    /// The method with the smallest mean square error, averaged over seeds.
    pub method: &'a str,
    /// The budget of that error.
    pub budget: &'a str,
    /// The share of the reference in that error. Range: [0, 1].
    pub share: f64,
}

impl ReferenceNoise<'_> {
    /// Returns true if the share is more than a tenth.
    pub fn is_large(&self) -> bool {
        self.share > LARGE
    }

    /// Returns the text of the warning.
    pub fn warning(&self) -> String {
        let Self {
            scene,
            method,
            budget,
            share,
        } = self;
        format!(
            "scene `{scene}`: errors are up to {:.0} % noise of the reference (mean square error of \
             `{method}`, {budget}), which brings all ratios nearer to 1; give it more samples",
            100.0 * share
        )
    }
}

/// Computes the noise share of each scene whose reference has a known error and whose records have errors.
pub fn reference_noise(results: &Results) -> impl Iterator<Item = ReferenceNoise<'_>> {
    let scenes = results.scenes.iter();
    scenes.filter_map(|scene| noise_of(results, scene))
}

fn noise_of<'a>(results: &'a Results, scene: &'a SceneInfo) -> Option<ReferenceNoise<'a>> {
    let own = scene.reference_mse?;
    let cells = results.budgets.iter().flat_map(|budget| {
        let methods = results.methods.iter();
        methods.map(move |method| (&*budget.name, &*method.name))
    });
    let errors = cells.filter_map(|(budget, method)| {
        let mse = mse(&records_of(results, &scene.name, budget, method))?;
        Some((mse, budget, method))
    });
    let (least, budget, method) = errors.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(ReferenceNoise {
        scene: &scene.name,
        method,
        budget,
        share: if own > 0.0 {
            (own / least).min(1.0)
        } else {
            0.0
        },
    })
}

/// Computes the mean square error over seeds. None: no record has one.
fn mse(records: &[&Record]) -> Option<f64> {
    let errors = records
        .iter()
        .filter_map(|record| record.metrics.get("rmse"));
    let squares: Vec<f64> = errors.map(|rmse| rmse * rmse).collect();
    (!squares.is_empty()).then(|| squares.iter().sum::<f64>() / squares.len() as f64)
}
