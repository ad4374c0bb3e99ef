//! Images as arrays: reading, writing, and metrics.

use crate::error::raise;
use crate::film::bytes;
use crate::wait::{beside, try_beside};
use formats::image::{self, ExrImage, ExrLayer, Format, write_exr, write_png};
use lab::image::{Pair, Pixels};
use lab::metric::Metric;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;

/// Converts bytes to pixels of the given width and height.
pub(crate) fn pixels(py: Python<'_>, size: [usize; 2], data: &[u8]) -> PyResult<Pixels> {
    let channel = |bytes: &[u8]| bytes.try_into().map_or(f32::NAN, f32::from_le_bytes);
    let pixel = |bytes: &[u8]| std::array::from_fn(|i| channel(&bytes[4 * i..4 * i + 4]));
    let is_whole = size[0].checked_mul(size[1]).and_then(|n| n.checked_mul(12));
    if is_whole != Some(data.len()) {
        let message = "an image needs three values for each pixel";
        return Err(raise(py, "SettingsError", message));
    }
    Ok(Pixels {
        size,
        data: data.chunks_exact(12).map(pixel).collect(),
    })
}

/// Encodes linear pixels as PNG, clipped to [0, 1].
#[pyfunction]
pub(crate) fn encode_png<'py>(
    py: Python<'py>,
    size: [usize; 2],
    data: &[u8],
) -> PyResult<Bound<'py, PyBytes>> {
    let pixels = pixels(py, size, data)?;
    let size = size.map(|side| side as u32);
    let encoded = try_beside(py, || image::encode_png(size, &pixels.data))?;
    Ok(PyBytes::new(py, &encoded))
}

/// Writes pixels as linear EXR, or as PNG for the screen.
#[pyfunction]
pub(crate) fn write_image(
    py: Python<'_>,
    path: PathBuf,
    size: [usize; 2],
    data: &[u8],
) -> PyResult<()> {
    let pixels = pixels(py, size, data)?;
    try_beside(py, || match Format::of(&path) {
        Some(Format::Exr) => {
            let layers = [ExrLayer::rgb("", &pixels.data)];
            write_exr(&path, &ExrImage::whole(size, &layers))
        }
        Some(Format::Png) => write_png(&path, size, &pixels.data),
        _ => Err(image::no_output(&path)),
    })
}

/// Reads width, height and pixels of an image file.
#[pyfunction]
pub(crate) fn read_image(
    py: Python<'_>,
    path: PathBuf,
) -> PyResult<([usize; 2], Bound<'_, PyBytes>)> {
    let read = try_beside(py, || {
        image::read(&path, None).map(|image| Pixels::from(&image))
    })?;
    Ok((read.size, bytes(py, read.data.as_flattened())?))
}

/// The channels of an EXR by name.
type Channels<'py> = Vec<(String, Bound<'py, PyBytes>)>;

/// Reads width, height and all channels of an EXR.
#[pyfunction]
pub(crate) fn read_layers(py: Python<'_>, path: PathBuf) -> PyResult<([usize; 2], Channels<'_>)> {
    let layers = try_beside(py, || image::read_layers(&path))?;
    let channels = layers.names().map(|name| {
        let data = layers.channel(&name).unwrap_or_default();
        Ok((name, bytes(py, &data)?))
    });
    Ok((layers.size(), channels.collect::<PyResult<_>>()?))
}

fn named(py: Python<'_>, name: &str) -> PyResult<Metric> {
    let found = Metric::NAMES.iter().find(|(known, _)| *known == name);
    found.map(|(_, metric)| *metric).ok_or_else(|| {
        let names = Metric::NAMES.map(|(name, _)| name).join(", ");
        let message = format!("there is no metric `{name}`: expected {names}");
        raise(py, "SettingsError", &message)
    })
}

/// Computes the metric of an image against a reference of the same size.
#[pyfunction]
pub(crate) fn metric(
    py: Python<'_>,
    name: &str,
    size: [usize; 2],
    a: &[u8],
    b: &[u8],
) -> PyResult<f64> {
    let metric = named(py, name)?;
    let (a, b) = (pixels(py, size, a)?, pixels(py, size, b)?);
    Ok(beside(py, || {
        Pair::new(&a, &b).map_or(f64::NAN, |pair| metric.value(&pair))
    }))
}

/// Computes the error of every pixel.
#[pyfunction]
pub(crate) fn error_map<'py>(
    py: Python<'py>,
    name: &str,
    size: [usize; 2],
    a: &[u8],
    b: &[u8],
) -> PyResult<Bound<'py, PyBytes>> {
    let metric = named(py, name)?;
    let (a, b) = (pixels(py, size, a)?, pixels(py, size, b)?);
    let errors = beside(py, || {
        let pair = Pair::new(&a, &b)?;
        let errors = metric.errors(&pair).data;
        Some(errors.iter().map(|&error| error as f32).collect::<Vec<_>>())
    });
    bytes(py, &errors.unwrap_or_default())
}
