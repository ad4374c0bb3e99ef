//! Queries about a picture: pixels, strategies, samples.

use super::Site;
use super::error::Refusal;
use super::query::{Asked, OfLane, OfPixel, OfSample};
use super::routes::json;
use crate::shared::{Lane, Request, SentFrame};
use crate::status::LaneId;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;
use bidir::driver::Session;
use lab::pyramid::{Figures, mean_of_longer};
use lab::sample::SampleReport;
use serde::Serialize;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::oneshot;
use tokio::time::timeout;

/// The time limit for an answer of the renderer, which answers between passes.
const PASS_TIME: Duration = Duration::from_secs(60);

impl Site {
    /// Returns the answer of `query` about a lane between two passes.
    pub(super) async fn query<T: Send + 'static>(
        &self,
        lane: LaneId,
        query: impl FnOnce(&Lane<'_>) -> T + Send + 'static,
    ) -> Result<T, Refusal> {
        let (send, receive) = oneshot::channel();
        let query = move |found: Option<&Lane<'_>>| {
            // A client that has left needs no answer.
            if !send.is_closed() {
                let _ = send.send(found.map(query));
            }
        };
        self.ask(Request::Query(lane, Box::new(query)))?;
        let busy = || {
            Refusal::new(
                StatusCode::SERVICE_UNAVAILABLE,
                "a pass takes long: try again",
            )
        };
        let received = timeout(PASS_TIME, receive).await.map_err(|_| busy())?;
        let answer = received.map_err(|_| Refusal::now("the render has ended"))?;
        answer.ok_or_else(|| Refusal::now("there is no such lane now"))
    }

    /// Returns the newest frame of a lane.
    pub(super) async fn frame(&self, lane: LaneId) -> Result<Arc<SentFrame>, Refusal> {
        let state = self.client.state();
        let status = state.status();
        let found = status.lanes.iter().find(|newest| newest.lane == lane);
        let newest = found.ok_or_else(|| Refusal::now("there is no such lane now"))?;
        let is_newest = |shown: &Arc<SentFrame>| {
            shown.generation == newest.generation && shown.frame.passes == newest.passes
        };
        if let Some(shown) = state.shown(lane).filter(is_newest) {
            return Ok(shown);
        }
        self.ask(Request::Show(lane))?;
        self.query(lane, |_| ()).await?;
        state
            .shown(lane)
            .ok_or_else(|| Refusal::now("no pass is done yet"))
    }

    fn ask(&self, request: Request) -> Result<(), Refusal> {
        let busy = |_| Refusal::busy("too many requests are waiting");
        self.client.ask(request).map_err(busy)
    }
}

/// The report of a pixel.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct PixelReport {
    x: u32,
    y: u32,
    mean: [f32; 3],
    /// The standard error of the mean; 0 after one pass, when it is not known.
    standard_error: [f32; 3],
    samples: u64,
    /// The rays of all samples of the pixel, including those of their light subpaths. None: the film does not keep
    /// them.
    rays: Option<f32>,
    passes: u64,
    generation: u32,
}

/// Answers with the report of a pixel. A smaller frame, as of a preview, has one pixel for several of the film.
pub(super) async fn pixel(
    State(site): State<Arc<Site>>,
    Asked(OfPixel { lane, x, y }): Asked<OfPixel>,
) -> Result<Response, Refusal> {
    let shown = site.frame(lane).await?;
    let [width, height] = site.client.state().status().film.resolution;
    let frame = &shown.frame;
    let [small_width, small_height] = frame.film.resolution;
    let scaled =
        |at: u32, side: u32, small: u32| i64::from(at) * i64::from(small) / i64::from(side.max(1));
    let place = [
        scaled(x, width, small_width),
        scaled(y, height, small_height),
    ];
    let index = frame.film.crop.index(place[0], place[1]);
    let of_pixel = |index: usize| {
        Some(PixelReport {
            x,
            y,
            mean: *frame.pixels.get(index)?,
            standard_error: frame.variance.get(index)?.map(f32::sqrt),
            samples: frame.passes,
            rays: shown
                .rays
                .as_ref()
                .and_then(|rays| rays.get(index).copied()),
            passes: frame.passes,
            generation: shown.generation,
        })
    };
    let report = index.and_then(of_pixel);
    json(&report.ok_or_else(|| not_rendered(x, y))?)
}

/// The report of a sample, with the lane and the generation of its render.
#[derive(Debug, Serialize)]
struct SampleOfLane {
    generation: u32,
    #[serde(flatten)]
    report: SampleReport,
}

/// Answers with the report of a sample, as `bidir render --replay --json` prints it.
pub(super) async fn sample(
    State(site): State<Arc<Site>>,
    Asked(OfSample { lane, x, y, pass }): Asked<OfSample>,
) -> Result<Response, Refusal> {
    let resolution = site.client.state().status().film.resolution;
    let report = site.query(lane, move |lane| {
        let session = &lane.render.session;
        if session.view().film().resolution != resolution {
            return Err(Refusal::now(
                "the camera is moving: try again when the image is complete",
            ));
        }
        let replayed = session.replay([x, y], pass);
        let replay = replayed.ok_or_else(|| not_rendered(x, y))?;
        json(&SampleOfLane {
            generation: lane.generation,
            report: SampleReport::new(session, [x, y], pass, &replay),
        })
    });
    report.await?
}

fn not_rendered(x: u32, y: u32) -> Refusal {
    Refusal::query(format!("the pixel {x},{y} is not rendered"))
}

/// The numbers of the strategies of a lane.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct StrategiesReport {
    generation: u32,
    passes: u64,
    vertices: usize,
    tiles: Vec<TileReport>,
    /// The mean luminance that paths without images of strategies add.
    longer_mean: f64,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct TileReport {
    s: u16,
    t: u16,
    name: String,
    /// The mean luminance of the weighted image.
    mean: f64,
    /// Traced shadow rays.
    traced: u64,
    blocked_share: Option<f64>,
    /// The variance of a pixel of the weighted image in one pass, averaged over pixels. None: it is not known.
    variance: Option<f64>,
}

pub(super) async fn strategies(
    State(site): State<Arc<Site>>,
    Asked(OfLane { lane }): Asked<OfLane>,
) -> Result<Response, Refusal> {
    let report = site.query(lane, |lane| {
        let session = &lane.render.session;
        check_strategies(session)?;
        Ok(StrategiesReport {
            generation: lane.generation,
            passes: session.film().passes().len(),
            vertices: session.film().layers().strategy_vertices(),
            tiles: tiles(session),
            longer_mean: mean_of_longer(session.film()),
        })
    });
    json(&report.await??)
}

/// Refuses queries about strategies if the film keeps no images of them.
pub(super) fn check_strategies(session: &Session<'_>) -> Result<(), Refusal> {
    if session.film().layers().strategy_vertices() > 0 {
        return Ok(());
    }
    let message = "the lane keeps no images of strategies: the command `strategies` makes it";
    Err(Refusal::now(message))
}

fn tiles(session: &Session<'_>) -> Vec<TileReport> {
    let figures = Figures::all(session).into_iter();
    let tiles = figures.filter_map(|figures| {
        let images = figures.images?;
        Some(TileReport {
            s: figures.strategy.s,
            t: figures.strategy.t,
            name: figures.strategy.to_string(),
            mean: images.mean,
            traced: figures.counts.traced,
            blocked_share: figures.blocked_share(),
            variance: images.variance,
        })
    });
    tiles.collect()
}
