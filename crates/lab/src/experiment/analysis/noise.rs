//! How much of what is compared is noise of the reference.
//!
//! An image and its reference are independent, so that the mean square error is the sum of the image's
//! own and of the reference's: the mean variance of its pixels. Errors are left as they are, and what
//! part of them it is, is told.

use super::records_of;
use crate::results::{Record, Results, SceneInfo};

/// From this part on, the noise is told of as a warning.
const MUCH: f64 = 0.1;

/// The noise of a reference, in the smallest error that was measured against it.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceNoise<'a> {
    /// The scene.
    pub scene: &'a str,
    /// The method that has the smallest mean square error, as the mean over seeds.
    pub method: &'a str,
    /// The budget under which it has it.
    pub budget: &'a str,
    /// The part of that error that is the reference's. Range: [0, 1].
    pub share: f64,
}

impl ReferenceNoise<'_> {
    /// True where it should be told of: it is more than a tenth.
    pub fn is_large(&self) -> bool {
        self.share > MUCH
    }

    /// What there is to say about it.
    pub fn words(&self) -> String {
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

/// The noise of each scene's reference, where it is known and something was compared with it.
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

/// The mean square error over seeds. None: there is none.
fn mse(records: &[&Record]) -> Option<f64> {
    let errors = records
        .iter()
        .filter_map(|record| record.metrics.get("rmse"));
    let squares: Vec<f64> = errors.map(|rmse| rmse * rmse).collect();
    (!squares.is_empty()).then(|| squares.iter().sum::<f64>() / squares.len() as f64)
}
