//! Image files: the picture of the film, and images of strategies.

use super::Site;
use super::error::Refusal;
use super::inspect::check_strategies;
use super::query::{Asked, OfLane};
use crate::status::LaneId;
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use bidir::path::Strategy;
use formats::film::{Developed, metadata};
use formats::image::encode_png;
use lab::image::Pixels;
use lab::pyramid::{self, Kind};
use serde::Deserialize;
use std::fmt::Display;
use std::sync::Arc;
use tokio::task::spawn_blocking;

/// Maximum change of a tile's exposure, up or down. Unit: stops.
const MOST_STOPS: f32 = 40.0;

/// Answers with the picture of the film, as PNG like that of `bidir render`.
pub(super) async fn png(
    State(site): State<Arc<Site>>,
    Asked(OfLane { lane }): Asked<OfLane>,
) -> Result<Response, Refusal> {
    let shown = site.frame(lane).await?;
    encode("image/png", move || {
        let crop = shown.frame.film.crop;
        encode_png([crop.width(), crop.height()], &shown.frame.pixels)
    })
    .await
}

/// Answers with the picture of the film, as EXR like that of `bidir render`, with layers and attributes.
pub(super) async fn exr(
    State(site): State<Arc<Site>>,
    Asked(OfLane { lane }): Asked<OfLane>,
) -> Result<Response, Refusal> {
    // Held until it is encoded: each takes the memory of a whole film.
    let Ok(_place) = site.large.acquire().await else {
        return Err(Refusal::bug("no image is encoded any more"));
    };
    let developed = site.query(lane, |lane| {
        let film = lane.render.session.film();
        let is_empty = film.passes().is_empty();
        let file = || {
            (
                Developed::new(film),
                film.settings().clone(),
                lane.render.header(),
            )
        };
        (!is_empty).then(file)
    });
    let empty = || Refusal::now("no pass is done yet");
    let (developed, film, header) = developed.await?.ok_or_else(empty)?;
    let name = file_name(&header.scene_name());
    let mut response = encode("image/x-exr", move || {
        developed.encode_exr(&film, &metadata(&header))
    })
    .await?;
    let disposition = format!("attachment; filename=\"{name}.exr\"");
    if let Ok(value) = disposition.parse() {
        response
            .headers_mut()
            .insert(header::CONTENT_DISPOSITION, value);
    }
    Ok(response)
}

/// Returns a file name for the scene `name`, without characters that are special in a file system or header.
fn file_name(name: &str) -> String {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
    stem.chars()
        .map(|c| if is_plain(c) { c } else { '_' })
        .collect()
}

/// The query for an image of a strategy.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct OfStrategies {
    #[serde(default)]
    lane: LaneId,
    kind: Kind,
    s: u16,
    t: u16,
    /// The exposure of a strategy. Unit: stops.
    #[serde(default)]
    exposure: f32,
}

/// Answers with the image of a strategy, in the size of the film.
pub(super) async fn strategies(
    State(site): State<Arc<Site>>,
    Asked(asked): Asked<OfStrategies>,
) -> Result<Response, Refusal> {
    let strategy = Strategy {
        s: asked.s,
        t: asked.t,
    };
    if asked.exposure.is_nan() || asked.exposure.abs() > MOST_STOPS {
        let message = format!("the exposure is a number of stops up to {MOST_STOPS}");
        return Err(Refusal::query(message));
    }
    let pixels = site.query(asked.lane, move |lane| {
        check_strategies(&lane.render.session)?;
        let film = lane.render.session.film();
        let image = pyramid::strategy_image(film, asked.kind, strategy);
        image.ok_or_else(|| Refusal::query(format!("there is no image of {strategy}")))
    });
    let found = pixels.await??;
    encode("image/png", move || encode_pixels(found, asked.exposure)).await
}

/// Encodes a picture as PNG, `stops` stops brighter.
fn encode_pixels(mut pixels: Pixels, stops: f32) -> formats::Result<Vec<u8>> {
    let factor = libm::exp2f(stops);
    for channel in pixels.data.as_flattened_mut() {
        *channel *= factor;
    }
    encode_png(pixels.size.map(|side| side as u32), &pixels.data)
}

/// Answers with bytes of the media type `kind`. Calls `encode` in another thread, as it takes long.
async fn encode(
    kind: &'static str,
    encode: impl FnOnce() -> formats::Result<Vec<u8>> + Send + 'static,
) -> Result<Response, Refusal> {
    let bug = |error: &dyn Display| Refusal::bug(error.to_string());
    let encoded = spawn_blocking(encode).await.map_err(|error| bug(&error))?;
    let bytes = encoded.map_err(|error| bug(&error))?;
    Ok(([(header::CONTENT_TYPE, kind)], bytes).into_response())
}
