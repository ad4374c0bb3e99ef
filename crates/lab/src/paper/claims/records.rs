//! Numbers of records, by scene and method, and which of them decide.

use super::super::plans::{UNIFORM, method_name};
use crate::results::Record;
use crate::statistics::{Interval, ratio_interval};
use std::collections::BTreeMap;

/// A number of a record.
pub(super) type Quantity = fn(&Record) -> f64;

/// Numbers by seed.
pub(super) type BySeed = BTreeMap<u64, f64>;

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

/// The RMS error, in equal time.
fn error_by_seconds(record: &Record) -> f64 {
    metric(record, "rmse") * record.seconds.sqrt()
}

/// The RMS error without the worst pixels, in equal time.
fn trimmed_by_seconds(record: &Record) -> f64 {
    metric(record, "rmse_trim") * record.seconds.sqrt()
}

/// The error that decides.
#[derive(Clone, Copy)]
pub(super) struct Judged {
    /// At equal rays.
    pub(super) by_rays: Quantity,
    /// In equal time.
    pub(super) by_seconds: Quantity,
    /// Its name.
    pub(super) name: &'static str,
}

/// Which error decides under these weights: the plain one where there is an expectation for it to
/// approach.
///
/// Uniform weights leave contributions of connections of length d as they are, C ~ 1/d², whose variance
/// is infinite near edges: the plain error is then that of a few pixels, and differs from seed to seed.
pub(super) fn judged(weights: &str) -> Judged {
    if weights == UNIFORM {
        return Judged {
            by_rays: trimmed_by_rays,
            by_seconds: trimmed_by_seconds,
            name: "RMS error without the worst 0.1 % of pixels",
        };
    }
    Judged {
        by_rays: error_by_rays,
        by_seconds: error_by_seconds,
        name: "RMS error",
    }
}

/// The records of a scene.
#[derive(Clone, Copy)]
pub(super) struct Measured<'a> {
    pub(super) records: &'a [Record],
    pub(super) scene: &'a str,
}

impl Measured<'_> {
    /// A number of all records of a rule under these weights.
    pub(super) fn values(&self, weights: &str, rule: &str, quantity: Quantity) -> BySeed {
        let method = method_name(weights, rule);
        let is_of = |record: &&Record| record.scene == self.scene && record.method == method;
        let records = self.records.iter().filter(is_of);
        records
            .map(|record| (record.seed, quantity(record)))
            .collect()
    }

    /// The mean over seeds; NaN where there are no records.
    pub(super) fn mean(&self, weights: &str, rule: &str, quantity: Quantity) -> f64 {
        let values = self.values(weights, rule, quantity);
        values.values().sum::<f64>() / values.len() as f64
    }

    /// By which factor one rule has more than another, under these weights. None: not enough was
    /// measured.
    pub(super) fn ratio(
        &self,
        weights: &str,
        rules: [&str; 2],
        quantity: Quantity,
        confidence: f64,
    ) -> Option<Interval> {
        let [a, b] = rules.map(|rule| self.values(weights, rule, quantity));
        ratio_of(&a, &b, confidence)
    }

    /// The ratios of [`Self::ratio`], over the seeds that both rules have.
    pub(super) fn ratios(&self, weights: &str, rules: [&str; 2], quantity: Quantity) -> BySeed {
        let [a, b] = rules.map(|rule| self.values(weights, rule, quantity));
        let pairs = a
            .iter()
            .filter_map(|(seed, a)| Some((*seed, a / b.get(seed)?)));
        pairs.collect()
    }
}

/// By which factor numbers are more than others, over the seeds that both have. None: those are not
/// enough.
pub(super) fn ratio_of(a: &BySeed, b: &BySeed, confidence: f64) -> Option<Interval> {
    let pairs = a.iter().filter_map(|(seed, a)| Some((*a, *b.get(seed)?)));
    let (a, b): (Vec<_>, Vec<_>) = pairs.unzip();
    ratio_interval(&a, &b, confidence)
}

/// Records that somebody might have, for tests.
#[cfg(test)]
pub(super) mod made {
    use super::*;
    use crate::results::Rays;

    /// Records of ten seeds: for each rule its errors at equal rays and seconds, each times
    /// 1 ± `spread`. Renders have more rays under later seeds, and the error that does not decide
    /// is the inverse of the other.
    pub(in super::super) fn records(
        scene: &str,
        weights: &str,
        rules: &[(&str, f64, f64)],
        spread: f64,
    ) -> Vec<Record> {
        let of_rule = |(rule, error, seconds): &(&str, f64, f64)| {
            let seeds = (0..10).map(|seed| {
                // No two rules vary alike.
                let name: u64 = rule.bytes().map(u64::from).sum();
                let phase = (seed * 7 + name) % 11;
                let factor = 1.0 + spread * (phase as f64 / 5.0 - 1.0);
                record(scene, [weights, rule], error * factor, *seconds, seed)
            });
            seeds.collect::<Vec<_>>()
        };
        rules.iter().flat_map(of_rule).collect()
    }

    fn record(
        scene: &str,
        [weights, rule]: [&str; 2],
        error: f64,
        seconds: f64,
        seed: u64,
    ) -> Record {
        let cost = (1 + seed) as f64;
        let [decides, other] = [error, 1.0 / error].map(|error| error / cost.sqrt());
        let names = match weights {
            UNIFORM => ["rmse_trim", "rmse"],
            _ => ["rmse", "rmse_trim"],
        };
        let metrics = names.map(str::to_owned).into_iter().zip([decides, other]);
        Record {
            scene: scene.to_owned(),
            method: method_name(weights, rule),
            budget: String::new(),
            seed,
            spp: 8,
            seconds: seconds * cost,
            processor_seconds: None,
            training_seconds: None,
            training_processor_seconds: None,
            rays: Rays {
                camera: 1000 * (1 + seed),
                ..Rays::default()
            },
            connections_blocked: 0,
            metrics: metrics.collect(),
            efficiency_rays: 0.0,
            efficiency_seconds: 0.0,
            image: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(records: &[Record]) -> Measured<'_> {
        Measured {
            records,
            scene: "A",
        }
    }

    #[test]
    fn numbers_are_at_equal_cost() {
        let mut records = made::records("A", "balance", &[("all", 2.0, 4.0)], 0.0);
        records[0].rays.training = 500;
        assert!((rays(&records[0]) - 1000.0).abs() < 1e-9);
        for record in &records {
            assert!((error_by_rays(record) - 2.0 * 1000f64.sqrt()).abs() < 1e-9);
            assert!((trimmed_by_rays(record) - 0.5 * 1000f64.sqrt()).abs() < 1e-9);
            assert!((error_by_seconds(record) - 4.0).abs() < 1e-9);
            assert!((trimmed_by_seconds(record) - 1.0).abs() < 1e-9);
        }
        records[0].metrics.clear();
        assert!(error_by_rays(&records[0]).is_nan());
    }

    #[test]
    fn the_plain_error_decides_where_it_can() {
        for weights in ["balance", "power"] {
            assert_eq!(judged(weights).name, "RMS error");
        }
        for weights in [UNIFORM, "balance"] {
            let records = made::records("A", weights, &[("all", 2.0, 4.0)], 0.0);
            let Judged {
                by_rays,
                by_seconds,
                ..
            } = judged(weights);
            assert!((by_rays(&records[3]) - 2.0 * 1000f64.sqrt()).abs() < 1e-9);
            assert!((by_seconds(&records[3]) - 4.0).abs() < 1e-9);
        }
    }

    #[test]
    fn rules_are_paired_by_seed() {
        let rules = [("all", 1.0, 1.0), ("per-pair", 3.0, 1.0)];
        let mut records = made::records("A", "balance", &rules, 0.0);
        records.retain(|record| record.seed != 3 || record.method != "balance all");
        records.reverse();
        let measured = measured(&records);
        assert_eq!(measured.values("balance", "all", seconds).len(), 9);
        let both = ["per-pair", "all"];
        // Seconds grow with the seed: only those of one seed are in the ratio of 1.
        let ratios = measured.ratios("balance", both, seconds);
        assert_eq!(ratios.len(), 9);
        assert!(ratios.values().all(|ratio| (ratio - 1.0).abs() < 1e-12));
        let interval = measured.ratio("balance", both, seconds, 0.95).unwrap();
        assert!((interval.high - 1.0).abs() < 1e-9, "{interval:?}");
    }

    #[test]
    fn what_is_not_there_decides_nothing() {
        let mut records = made::records("A", "balance", &[("all", 2.0, 4.0)], 0.0);
        assert!(measured(&records).mean("power", "all", seconds).is_nan());
        records[0].metrics.clear();
        let both = ["all", "all"];
        assert_eq!(
            measured(&records).ratio("balance", both, error_by_rays, 0.95),
            None
        );
    }
}
