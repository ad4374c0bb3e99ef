//! Renders whose training and first pass take far more rays than their budget.

use super::records_of;
use crate::results::{BudgetInfo, BudgetKind, Results, SceneInfo};

/// The multiple of the budget above which there is a warning.
const LARGE: f64 = 1.25;

/// Returns warnings about methods whose first pass takes far more rays than their budget.
pub fn overruns(results: &Results) -> Vec<String> {
    let all = results.budgets.iter();
    let budgets = all.filter(|budget| budget.kind == BudgetKind::Rays);
    let mut warnings = Vec::new();
    for budget in budgets {
        for scene in &results.scenes {
            let names = results.methods.iter().map(|method| method.name.as_str());
            warnings.extend(names.filter_map(|method| overrun(results, scene, budget, method)));
        }
    }
    warnings
}

/// Returns the warning about one method. None: it has no records, or keeps to the budget.
fn overrun(
    results: &Results,
    scene: &SceneInfo,
    budget: &BudgetInfo,
    method: &str,
) -> Option<String> {
    let records = records_of(results, &scene.name, &budget.name, method);
    let of_one_pass = records.iter().filter(|record| record.spp == 1);
    let most = of_one_pass.map(|record| record.rays.total()).max()?;
    let [width, height] = scene.size;
    let rays = most as f64 / (width * height) as f64;
    let name = &scene.name;
    let text = format!(
        "scene `{name}`: `{method}` takes {rays:.0} rays per pixel for training and its first pass, and \
         the budget is {}: these results are not at equal rays",
        budget.amount
    );
    (rays > LARGE * budget.amount).then_some(text)
}
