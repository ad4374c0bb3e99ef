//! The film's sensor, which converts light to pixel values.

use super::reader::Reader;
use crate::pbrt::known::SENSORS;
use crate::source::Fault;
use crate::text::number;
use bidir::film::Sensor;
use bidir::spectrum;

/// The range of temperatures of the white balance. Unit: K.
const WHITES: [f32; 2] = [1000.0, 25000.0];
/// Temperature from which white is daylight; below it, white is a blackbody. Unit: K.
const COOLEST_DAYLIGHT: f32 = 4000.0;

/// Reads the sensor parameters that all films have. `exposure` is applied after the sensor.
pub(super) fn build(reader: &mut Reader<'_, '_>, exposure: f32) -> Result<Sensor, Fault> {
    if let Some((name, span)) = reader.string("sensor")? {
        SENSORS.check(name, span)?;
        if name != "cie1931" {
            let what = format!("the sensor `{name}`");
            (reader.context).unsupported(span, &what, "`cie1931` is used instead")?;
        }
    }
    Ok(Sensor {
        balance: balance(reader)?,
        limit: limit(reader, exposure)?,
    })
}

/// Returns the matrix that maps light of the file's colour temperature to white.
fn balance(reader: &mut Reader<'_, '_>) -> Result<Option<bidir::math::Mat3>, Fault> {
    if reader.float("whitebalance", 0.0)? == 0.0 {
        return Ok(None);
    }
    let kelvin = reader.float_within("whitebalance", 0.0, WHITES)?;
    let white = if kelvin < COOLEST_DAYLIGHT {
        spectrum::planckian_white(f64::from(kelvin))
    } else {
        spectrum::daylight_white(f64::from(kelvin))
    };
    Ok(Some(spectrum::adapted(white).as_mat3()))
}

/// Returns the largest value of a sample. None: there is no limit.
fn limit(reader: &mut Reader<'_, '_>, exposure: f32) -> Result<Option<f32>, Fault> {
    let Some(most) = reader.optional_float("maxcomponentvalue")? else {
        return Ok(None);
    };
    reader.float_within("maxcomponentvalue", most, [f32::MIN_POSITIVE, f32::MAX])?;
    if exposure == 0.0 || !(most / exposure).is_finite() {
        return Ok(None);
    }
    let message = format!(
        "samples are clamped at {}: the image is darker than the scene, by an amount that depends on \
         the integrator",
        number(most)
    );
    reader.context.warn(reader.span(), message);
    Ok(Some(most / exposure))
}
