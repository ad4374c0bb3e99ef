//! Numbers of records, by scene and method.

use crate::results::Record;
use crate::statistics::{Interval, ratio_interval};

/// A number of a record.
pub(super) type Quantity = fn(&Record) -> f64;

/// A metric of a record; NaN where it was not computed.
fn metric(record: &Record, name: &str) -> f64 {
    record.metrics.get(name).copied().unwrap_or(f64::NAN)
}

/// All rays but those of training, which are as many however long a render takes.
pub(super) fn rays(record: &Record) -> f64 {
    (record.rays.total() - record.rays.training) as f64
}

/// Time.
pub(super) fn seconds(record: &Record) -> f64 {
    record.seconds
}

/// Time for each ray.
pub(super) fn seconds_per_ray(record: &Record) -> f64 {
    record.seconds / rays(record)
}

/// The RMS error, at equal rays.
pub(super) fn error_by_rays(record: &Record) -> f64 {
    metric(record, "rmse") * rays(record).sqrt()
}

/// The RMS error without the worst pixels, at equal rays.
pub(super) fn trimmed_by_rays(record: &Record) -> f64 {
    metric(record, "rmse_trim") * rays(record).sqrt()
}

/// The RMS error without the worst pixels, in equal time.
pub(super) fn trimmed_by_seconds(record: &Record) -> f64 {
    metric(record, "rmse_trim") * record.seconds.sqrt()
}

/// The records of a scene.
#[derive(Clone, Copy)]
pub(super) struct Measured<'a> {
    pub(super) records: &'a [Record],
    pub(super) scene: &'a str,
}

impl Measured<'_> {
    /// A number of all records of a method, by seed.
    pub(super) fn values(&self, method: &str, quantity: Quantity) -> Vec<f64> {
        let mut records: Vec<_> = self
            .records
            .iter()
            .filter(|record| record.scene == self.scene && record.method == method)
            .collect();
        records.sort_by_key(|record| record.seed);
        records.into_iter().map(quantity).collect()
    }

    /// The mean over seeds; NaN where there are no records.
    pub(super) fn mean(&self, method: &str, quantity: Quantity) -> f64 {
        let values = self.values(method, quantity);
        values.iter().sum::<f64>() / values.len() as f64
    }

    /// By which factor one method has more than another. None: not enough was measured.
    pub(super) fn ratio(
        &self,
        [method, other]: [&str; 2],
        quantity: Quantity,
        confidence: f64,
    ) -> Option<Interval> {
        let values = [method, other].map(|method| self.values(method, quantity));
        ratio_interval(&values[0], &values[1], confidence)
    }

    /// The ratios of [`Self::ratio`], one for each seed.
    pub(super) fn ratios(&self, [method, other]: [&str; 2], quantity: Quantity) -> Vec<f64> {
        let [a, b] = [method, other].map(|method| self.values(method, quantity));
        a.iter().zip(&b).map(|(a, b)| a / b).collect()
    }
}

/// Records that somebody might have, for tests.
#[cfg(test)]
pub(super) mod made {
    use super::super::super::plans::method_name;
    use super::*;
    use crate::results::Rays;

    /// Records of ten seeds: for each rule its errors and seconds, each times 1 ± `spread`.
    pub(in super::super) fn records(
        scene: &str,
        weights: &str,
        rules: &[(&str, f64, f64)],
        spread: f64,
    ) -> Vec<Record> {
        let record = |rule: &str, error: f64, seconds: f64, seed: u64| {
            // No two rules vary alike.
            let name: u64 = rule.bytes().map(u64::from).sum();
            let phase = (seed * 7 + name) % 11;
            let factor = 1.0 + spread * (phase as f64 / 5.0 - 1.0);
            let metrics = ["rmse", "rmse_trim"].map(|name| (name.to_owned(), error * factor));
            Record {
                scene: scene.to_owned(),
                method: method_name(weights, rule),
                budget: String::new(),
                seed,
                spp: 8,
                seconds,
                rays: Rays {
                    camera: 1000,
                    ..Rays::default()
                },
                connections_blocked: 0,
                metrics: metrics.into_iter().collect(),
                efficiency_rays: 0.0,
                efficiency_seconds: 0.0,
                image: None,
            }
        };
        let of_rule = |(rule, error, seconds): &(&str, f64, f64)| {
            let seeds = (0..10).map(|seed| record(rule, *error, *seconds, seed));
            seeds.collect::<Vec<_>>()
        };
        rules.iter().flat_map(of_rule).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_at_equal_cost() {
        let mut records = made::records("A", "balance", &[("all", 2.0, 4.0)], 0.0);
        records[0].rays.training = 500;
        assert!((rays(&records[0]) - 1000.0).abs() < 1e-9);
        assert!((error_by_rays(&records[0]) - 2.0 * 1000f64.sqrt()).abs() < 1e-9);
        assert!((trimmed_by_seconds(&records[0]) - 4.0).abs() < 1e-9);
        records[0].metrics.clear();
        assert!(error_by_rays(&records[0]).is_nan());
        let measured = Measured {
            records: &records,
            scene: "A",
        };
        assert_eq!(measured.values("balance all", seconds).len(), 10);
        assert!(measured.mean("other", seconds).is_nan());
        let both = ["balance all", "balance all"];
        assert_eq!(measured.ratio(both, error_by_rays, 0.95), None);
        assert!((measured.ratio(both, seconds, 0.95).unwrap().value - 1.0).abs() < 1e-9);
    }
}
