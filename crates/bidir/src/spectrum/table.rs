//! The tables of the crate's `data/spectra`: columns of numbers over wavelength, read once.

use super::{Beyond, Curve};
use std::sync::LazyLock;

/// Columns of numbers over wavelength.
pub(super) struct Table {
    names: Vec<&'static str>,
    columns: Vec<Vec<[f64; 2]>>,
}

pub(super) static OBSERVER: LazyLock<Table> =
    LazyLock::new(|| Table::read(include_str!("../../data/spectra/cie1931.csv")));
pub(super) static DAYLIGHT: LazyLock<Table> =
    LazyLock::new(|| Table::read(include_str!("../../data/spectra/daylight.csv")));
pub(super) static FLUORESCENT: LazyLock<Table> =
    LazyLock::new(|| Table::read(include_str!("../../data/spectra/fluorescent.csv")));
pub(super) static METALS: LazyLock<Table> =
    LazyLock::new(|| Table::read(include_str!("../../data/spectra/metals.csv")));

impl Table {
    /// Reads comma-separated values; fields without a number are omitted.
    fn read(text: &'static str) -> Self {
        let mut lines = text.lines();
        let header = lines.next().unwrap_or_default();
        let names: Vec<_> = header.split(',').skip(1).collect();
        let mut columns = vec![Vec::new(); names.len()];
        for line in lines {
            let mut fields = line.split(',').map(|field| field.parse().ok());
            let Some(Some(nm)) = fields.next() else {
                continue;
            };
            for (column, value) in columns.iter_mut().zip(fields) {
                column.extend(value.map(|value: f64| [nm, value]));
            }
        }
        Self { names, columns }
    }

    /// Returns the names of the columns.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.names.iter().copied()
    }

    /// Returns the column of this name; beyond its ends, the spectrum has the value at the end.
    pub(super) fn column(&self, name: &str) -> Option<Curve> {
        let index = self.names.iter().position(|known| *known == name)?;
        Curve::new(self.columns[index].clone(), Beyond::Last).ok()
    }
}

/// Returns the Sellmeier coefficients B1, C1, B2, C2, B3, C3 of a glass. Unit of C: µm².
pub(super) fn glass(name: &str) -> Option<[f64; 6]> {
    let (_, numbers) = glasses().find(|(known, _)| *known == name)?;
    let numbers: Vec<f64> = numbers.split(',').filter_map(|n| n.parse().ok()).collect();
    numbers.try_into().ok()
}

/// Returns the names of all glasses, each with the text of its coefficients.
pub(super) fn glasses() -> impl Iterator<Item = (&'static str, &'static str)> {
    let text = include_str!("../../data/spectra/glasses.csv");
    text.lines().skip(1).filter_map(|line| line.split_once(','))
}
