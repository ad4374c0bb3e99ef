//! The routes of requests, and the checks and headers that all answers share.

use super::error::Refusal;
use super::{Site, assets, images, inspect, live};
use axum::Router;
use axum::extract::{Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use std::sync::Arc;

/// The content security policy: the page loads only scripts and styles of this server.
const POLICY: &str = "default-src 'self'; base-uri 'none'; form-action 'none'; \
                      frame-ancestors 'none'; object-src 'none'";

/// Returns the router of all pages and data that the viewer serves.
pub(super) fn router(site: &Arc<Site>) -> Router {
    Router::new()
        .route("/", get(assets::index))
        .route("/assets/{name}", get(assets::asset))
        .route("/status", get(status))
        .route("/log", get(log))
        .route("/live", get(live::live))
        .route("/render.png", get(images::png))
        .route("/render.exr", get(images::exr))
        .route("/pixel", get(inspect::pixel))
        .route("/sample", get(inspect::sample))
        .route("/strategies", get(inspect::strategies))
        .route("/strategies.png", get(images::strategies))
        .fallback(|| async { Refusal::new(StatusCode::NOT_FOUND, "there is no such page") })
        .method_not_allowed_fallback(|| async {
            Refusal::new(StatusCode::METHOD_NOT_ALLOWED, "only GET is allowed")
        })
        .layer(from_fn_with_state(Arc::clone(site), guard))
        .layer(from_fn(dress))
        .with_state(Arc::clone(site))
}

/// Refuses requests without access.
async fn guard(State(site): State<Arc<Site>>, request: Request, next: Next) -> Response {
    match site.access.check(request.uri(), request.headers()) {
        Ok(()) => next.run(request).await,
        Err(refusal) => refusal.into_response(),
    }
}

/// Adds the headers that all answers share.
async fn dress(request: Request, next: Next) -> Response {
    let mut response = next.run(request).await;
    let headers = [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        // The URL may have the token.
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
    ];
    for (name, value) in headers {
        response
            .headers_mut()
            .insert(name, HeaderValue::from_static(value));
    }
    response
}

async fn status(State(site): State<Arc<Site>>) -> Result<Response, Refusal> {
    json(&*site.client.state().status())
}

async fn log(State(site): State<Arc<Site>>) -> Response {
    let kind = [(header::CONTENT_TYPE, "text/plain; charset=utf-8")];
    (kind, site.client.state().log_text()).into_response()
}

/// Returns an answer in JSON.
pub(super) fn json(value: &impl serde::Serialize) -> Result<Response, Refusal> {
    let body = serde_json::to_string(value).map_err(|error| Refusal::bug(error.to_string()))?;
    Ok(([(header::CONTENT_TYPE, "application/json")], body).into_response())
}
