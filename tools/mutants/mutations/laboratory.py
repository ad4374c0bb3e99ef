"""Faults in metrics, statistics, experiments and references."""

from .tests import experiment, lab

LABORATORY = [
    (
        "FLIP without features",
        "crates/lab/src/flip/mod.rs",
        "libm::powf(color, 1.0 - feature)",
        "libm::powf(color, 1.0 - 0.0 * feature)",
        lab("flip::tests"),
    ),
    (
        "the worst pixels rounded down",
        "crates/lab/src/metric/map.rs",
        "errors.len().div_ceil(1000)",
        "errors.len() / 1000",
        lab("metric"),
    ),
    (
        "the variance of a block as if it had one pixel",
        "crates/lab/src/statistics/welch.rs",
        "variance.sum / (variance.count * variance.count)",
        "variance.sum / variance.count",
        lab("statistics::welch"),
    ),
    (
        "bootstrap by plain percentiles",
        "crates/lab/src/statistics/bootstrap.rs",
        "normal_cdf(-(n / (n - 1.0)).sqrt() * t)",
        "(0.5 - 0.5 * confidence) * (t / t)",
        lab("statistics::bootstrap"),
    ),
    (
        "p-values without Sidak's correction",
        "crates/lab/src/statistics/welch.rs",
        "p: corrected(p, tests.len())",
        "p: corrected(p, 1)",
        lab("statistics::welch"),
    ),
    (
        "all replicates of an experiment with one seed",
        "crates/lab/src/experiment/run.rs",
        "settings.seed = self.seed;",
        "settings.seed = 0 * self.seed;",
        experiment("every_run"),
    ),
    (
        "equal rays with a pass too many",
        "crates/lab/src/experiment/run.rs",
        "(next - target).abs() < (now - target).abs()",
        "next.min(target) > 0.0 && now < target * 1.2",
        experiment("equal_rays"),
    ),
    (
        "training that costs no rays",
        "crates/lab/src/experiment/run.rs",
        "training.map_or(0, |training| training.rays.total())",
        "training.map_or(0, |training| 0 * training.rays.total())",
        experiment("rays_of_training"),
    ),
    (
        "records of another experiment gone on from",
        "crates/lab/src/experiment/identity.rs",
        "            loaded.digest,\n",
        "            0,\n",
        experiment("another_experiment"),
    ),
    (
        "ratios of other seeds",
        "crates/lab/src/experiment/claims/judge.rs",
        "Some((*seed, *value, *other.get(seed)?))",
        "Some((*seed, *value, *other.get(&(seed ^ 1))?))",
        lab("analysis"),
    ),
    (
        "both estimators of a reference with the same seeds",
        "crates/lab/src/reference/make.rs",
        "settings.seed.wrapping_mul(2).wrapping_add(index)",
        "settings.seed.wrapping_mul(2).wrapping_add(0 * index)",
        lab("reference::tests"),
    ),
    (
        "all replicates of a reference with the same seed",
        "crates/lab/src/reference/replicate.rs",
        "seed: self.settings.seed.wrapping_add(replicate),",
        "seed: self.settings.seed.wrapping_add(0 * replicate),",
        lab("reference::tests"),
    ),
    (
        "references whose estimators disagree are taken",
        "crates/lab/src/reference/provenance.rs",
        "if *agree && *p >= LEVEL {",
        "if *agree || *p < LEVEL {",
        lab("reference::tests"),
    ),
    (
        "a reference is that of any scene",
        "crates/lab/src/reference/provenance.rs",
        "if self.scene_digest != digest {",
        "if self.scene_digest.len() != digest.len() {",
        lab("reference::tests"),
    ),
]
