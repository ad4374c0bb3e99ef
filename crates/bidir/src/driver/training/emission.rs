//! q_l, the probability that a light subpath begins on light l. It is lower for lights whose subpaths contribute
//! little to the picture, such as lights of other rooms.
//!
//! With probabilities p_l, connections of the subpaths that begin on l have the second moment p_l m_l; with q_l it is
//! (p_l² / q_l) m_l, and the sum over lights is least for q_l ∝ p_l √m_l. m_l is relative to the second moment of all
//! connections in the same cell of camera vertices: a dark corner counts as much as a bright one.

use super::constants::{LIGHT_PRIOR, POWER_FRACTION};
use crate::guide::{Cell, Cells};
use crate::light::LightChoice;

/// A connection of two cells.
#[derive(Clone, Copy)]
pub(super) struct Connection {
    /// The light that its light subpath begins on. None: its light vertex is a light point of next-event estimation.
    pub(super) light: Option<u32>,
    /// The cells of its light vertex and of its camera vertex.
    pub(super) cells: [Cell; 2],
    pub(super) evidence: Evidence,
}

/// Knowledge of a connection.
#[derive(Clone, Copy, Debug)]
pub(super) enum Evidence {
    /// It was traced; true if it is visible.
    Traced(bool),
    /// It could have made a path; holds its part of the path's squared value.
    Square(f64),
}

/// Returns the choice of lights learned from the connections `found`, of `subpaths` light subpaths that began on
/// lights by `power`. None: nothing is learned, and `power` remains.
pub(super) fn learned(
    power: &LightChoice,
    found: &[Connection],
    subpaths: f64,
) -> Option<LightChoice> {
    let moments = relative_moments(power.count(), found);
    let all: f64 = moments.iter().sum();
    if power.count() < 2 || all == 0.0 {
        return None;
    }
    let wanted = |(light, moment): (usize, &f64)| {
        let prob = f64::from(power.prob(light));
        let mean = (moment + LIGHT_PRIOR * all / subpaths) / (prob * subpaths + LIGHT_PRIOR);
        prob * mean.sqrt()
    };
    let wanted: Vec<f64> = moments.iter().enumerate().map(wanted).collect();
    let sum: f64 = wanted.iter().sum();
    let weight = |(light, wanted): (usize, &f64)| {
        let prob = f64::from(power.prob(light));
        (POWER_FRACTION * prob + (1.0 - POWER_FRACTION) * wanted / sum) as f32
    };
    Some(LightChoice::with_weights(
        wanted.iter().enumerate().map(weight),
    ))
}

/// Returns the factor by which subpaths begin on a light more often than by `power`.
pub(super) fn gain(power: &LightChoice, learned: Option<&LightChoice>, light: u32) -> f64 {
    let light = light as usize;
    learned.map_or(1.0, |learned| {
        f64::from(learned.prob(light)) / f64::from(power.prob(light))
    })
}

/// Returns, for each light, the sum of the squares of its connections, each divided by the mean square in its cell of
/// camera vertices.
fn relative_moments(lights: usize, found: &[Connection]) -> Vec<f64> {
    let walked = || (found.iter()).filter_map(|found| Some((found, found.light? as usize)));
    let mut of_cells = vec![[0.0, 0.0]; Cells::COUNT];
    for (connection, _) in walked() {
        let [sum, count] = &mut of_cells[connection.cells[1].index()];
        match connection.evidence {
            Evidence::Traced(_) => *count += 1.0,
            Evidence::Square(square) => *sum += square,
        }
    }
    let mut moments = vec![0.0; lights];
    for (connection, light) in walked() {
        let [sum, count] = of_cells[connection.cells[1].index()];
        if let Evidence::Square(square) = connection.evidence
            && square > 0.0
        {
            moments[light] += square * count / sum;
        }
    }
    moments
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUBPATHS: f64 = 16_384.0;

    fn by_power(weights: &[f32]) -> LightChoice {
        LightChoice::with_weights(weights.iter().copied())
    }

    /// Returns a connection, by the square of what arrived. None: it was blocked.
    fn connection(light: u32, camera: usize, square: Option<f64>) -> [Connection; 2] {
        let traced = Evidence::Traced(square.is_some());
        [traced, Evidence::Square(square.unwrap_or(0.0))].map(|evidence| Connection {
            light: Some(light),
            cells: [0, camera].map(Cells::cell),
            evidence,
        })
    }

    fn probs(power: &LightChoice, found: &[Connection]) -> Vec<f64> {
        let learned = learned(power, found, SUBPATHS).expect("there is something to learn");
        (0..power.count())
            .map(|light| f64::from(learned.prob(light)))
            .collect()
    }

    #[test]
    fn lights_in_other_rooms_begin_few_subpaths() {
        let power = by_power(&[1.0, 1.0]);
        let seen = [
            connection(0, 3, Some(2.0)),
            connection(1, 3, None),
            connection(1, 3, Some(0.0)),
        ]
        .concat();
        let probs = probs(&power, &seen);
        // Of 8192 subpaths none brought anything: as if 16 of all had.
        let hidden = libm::sqrt(16.0 / (16384.0 + 16.0));
        let expected = 0.05 + 0.9 * hidden / (1.0 + hidden);
        assert!((probs[1] - expected).abs() < 1e-4, "{probs:?}");
        let gain = gain(&power, learned(&power, &seen, SUBPATHS).as_ref(), 1);
        assert!((gain - 2.0 * expected).abs() < 2e-4);
    }

    #[test]
    fn a_dark_corner_counts_as_much_as_what_is_bright() {
        let power = by_power(&[1.0, 1.0]);
        let seen = [connection(0, 3, Some(1e6)), connection(1, 5, Some(1e-6))].concat();
        assert!((probs(&power, &seen)[0] - 0.5).abs() < 1e-6);
    }

    #[test]
    fn of_a_light_that_hardly_began_a_subpath_nothing_is_known() {
        let power = by_power(&[1.0, 1e-4]);
        let probs = probs(&power, &connection(0, 3, Some(1.0)));
        assert!((0.9e-4..1.0e-4).contains(&probs[1]), "{probs:?}");
    }

    #[test]
    fn where_there_is_no_choice_nothing_is_learned() {
        assert!(learned(&by_power(&[1.0]), &connection(0, 3, Some(1.0)), SUBPATHS).is_none());
        assert!(learned(&by_power(&[1.0, 1.0]), &connection(0, 3, None), SUBPATHS).is_none());
        assert!((gain(&by_power(&[1.0]), None, 0) - 1.0).abs() < 1e-12);
    }
}
