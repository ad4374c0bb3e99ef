//! The page with its style and scripts, embedded when the program is built. It shares modules with the
//! report of an experiment.

use super::error::Refusal;
use axum::extract::Path;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use rust_embed::{Embed, EmbeddedFile};

#[derive(Embed)]
#[folder = "page"]
struct Page;

/// Returns true for the path of an embedded style or script.
pub(super) fn is_asset(path: &str) -> bool {
    path.starts_with("/assets/")
}

/// Answers with the page.
pub(super) async fn index() -> Result<Response, Refusal> {
    answer("index.html")
}

/// Answers with the style or a script of the page.
pub(super) async fn asset(Path(name): Path<String>) -> Result<Response, Refusal> {
    answer(&name)
}

fn answer(name: &str) -> Result<Response, Refusal> {
    let kind = [(header::CONTENT_TYPE, content_type(name))];
    if let Some(module) = lab::report::module(name) {
        return Ok((kind, module).into_response());
    }
    let missing = || Refusal::new(StatusCode::NOT_FOUND, "there is no such page");
    let EmbeddedFile { data, .. } = Page::get(name).ok_or_else(missing)?;
    Ok((kind, data).into_response())
}

/// Returns the media type of a file by the ending of its name.
fn content_type(name: &str) -> &'static str {
    match name.rsplit_once('.').map(|(_, end)| end) {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("svg") => "image/svg+xml",
        _ => "application/octet-stream",
    }
}
