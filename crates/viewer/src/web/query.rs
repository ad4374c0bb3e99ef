//! The query of a request: the part of its URL after the question mark.

use super::error::Refusal;
use crate::status::LaneId;
use axum::extract::{FromRequestParts, Query};
use axum::http::request::Parts;
use serde::Deserialize;
use serde::de::DeserializeOwned;

/// A query. If it is wrong, the answer is a refusal as JSON.
pub(super) struct Asked<T>(pub(super) T);

impl<S: Sync, T: DeserializeOwned> FromRequestParts<S> for Asked<T> {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Refusal> {
        match Query::try_from_uri(&parts.uri) {
            Ok(Query(asked)) => Ok(Self(asked)),
            Err(rejection) => Err(Refusal::query(rejection.body_text())),
        }
    }
}

/// The query for a lane.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct OfLane {
    #[serde(default)]
    pub(super) lane: LaneId,
}

/// The query for a pixel of the whole film.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct OfPixel {
    #[serde(default)]
    pub(super) lane: LaneId,
    pub(super) x: u32,
    pub(super) y: u32,
}

/// The query for a sample of a pixel.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct OfSample {
    #[serde(default)]
    pub(super) lane: LaneId,
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) pass: u64,
}
