//! Pictures of a failed comparison: both means and their difference in standard deviations.

use super::Replicates;
use super::t_test::Moments;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes the maps of a comparison, and says where they are.
pub(super) fn write(name: &str, a: &Replicates, b: &Replicates) -> String {
    let slug = name.replace(|c: char| !c.is_ascii_alphanumeric() && c != '.', "-");
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(slug);
    let pairs: Vec<_> = a.moments(1).into_iter().zip(b.moments(1)).collect();
    let maps: [(&str, Value); 3] = [
        ("a", |a, _| a.mean),
        ("b", |_, b| b.mean),
        ("z", |a, b| {
            (a.mean - b.mean) / (a.variance + b.variance).sqrt().max(f64::MIN_POSITIVE)
        }),
    ];
    let written = std::fs::create_dir_all(&folder).and_then(|()| {
        maps.iter().try_for_each(|(map, value)| {
            let values: Vec<f64> = pairs.iter().map(|(a, b)| value(*a, *b)).collect();
            write_pfm(&folder.join(format!("{map}.pfm")), a.width, &values)
        })
    });
    match written {
        Ok(()) => format!("maps a, b and z in {}", folder.display()),
        Err(error) => format!("no maps in {}: {error}", folder.display()),
    }
}

/// A number of a map from the moments of both estimators.
type Value = fn(Moments, Moments) -> f64;

/// Writes rows of three channels, of which a PFM file has the lowest first.
fn write_pfm(path: &Path, width: usize, values: &[f64]) -> std::io::Result<()> {
    let rows = values.chunks_exact(3 * width);
    let mut bytes = format!("PF\n{width} {}\n-1.0\n", rows.len()).into_bytes();
    for value in rows.rev().flatten() {
        bytes.write_all(&(*value as f32).to_le_bytes())?;
    }
    std::fs::write(path, bytes)
}
