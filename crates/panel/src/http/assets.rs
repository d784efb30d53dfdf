//! The page: a fixed table of embedded files. There is no folder that a path could lead out of.

use axum::Router;
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use axum::routing::get;

/// Kinds of files.
pub(crate) const HTML: &str = "text/html; charset=utf-8";
pub(crate) const SCRIPT: &str = "text/javascript; charset=utf-8";
pub(crate) const STYLE: &str = "text/css; charset=utf-8";

/// Path, kind and content.
pub(crate) type Asset = (&'static str, &'static str, &'static str);

/// A file of the panel under `/panel/`.
macro_rules! own {
    ($name:literal, $kind:expr) => {
        (
            concat!("/panel/", $name),
            $kind,
            include_str!(concat!("../../assets/", $name)),
        )
    };
}

/// Everything that is served.
const ASSETS: &[Asset] = &[
    ("/", HTML, include_str!("../../assets/index.html")),
    own!("panel.css", STYLE),
    own!("main.js", SCRIPT),
    own!("stream.js", SCRIPT),
    own!("series.js", SCRIPT),
    own!("format.js", SCRIPT),
    own!("freshness.js", SCRIPT),
    own!("lamps.js", SCRIPT),
    own!("causes.js", SCRIPT),
    own!("charts.js", SCRIPT),
    own!("vectors.js", SCRIPT),
    own!("controls.js", SCRIPT),
    own!("parameters.js", SCRIPT),
    own!("events.js", SCRIPT),
    own!("dom.js", SCRIPT),
    own!("workbench.js", SCRIPT),
    own!("workbench/recordings.js", SCRIPT),
    own!("workbench/columns.js", SCRIPT),
    own!("workbench/motor.js", SCRIPT),
    own!("workbench/results.js", SCRIPT),
    own!("workbench/regions.js", SCRIPT),
    own!("workbench/server.js", SCRIPT),
    own!("workbench.css", STYLE),
    own!("first.js", SCRIPT),
    own!("first/plate.js", SCRIPT),
    own!("first/recording.js", SCRIPT),
    own!("first/answer.js", SCRIPT),
    own!("first.css", STYLE),
    (
        "/report.js",
        SCRIPT,
        include_str!("../../../report/assets/report.js"),
    ),
    (
        "/report.css",
        STYLE,
        include_str!("../../../report/assets/report.css"),
    ),
    (
        "/uplot.css",
        STYLE,
        include_str!("../../../report/assets/uplot/uPlot.min.css"),
    ),
    (
        "/uplot.js",
        SCRIPT,
        include_str!("../../../report/assets/uplot/uPlot.iife.min.js"),
    ),
    (
        "/uplot.LICENSE",
        "text/plain; charset=utf-8",
        include_str!("../../../report/assets/uplot/LICENSE"),
    ),
    (
        "/favicon.svg",
        "image/svg+xml",
        include_str!("../../assets/favicon.svg"),
    ),
];

/// Files that other pages of this server use too: styles, charts, what is general of the scripts.
pub(crate) fn shared() -> impl Iterator<Item = &'static Asset> {
    const NAMES: [&str; 10] = [
        "/panel/panel.css",
        "/panel/charts.js",
        "/panel/dom.js",
        "/panel/format.js",
        "/report.js",
        "/report.css",
        "/uplot.css",
        "/uplot.js",
        "/uplot.LICENSE",
        "/favicon.svg",
    ];
    ASSETS.iter().filter(|(path, ..)| NAMES.contains(path))
}

/// A route for each file.
pub fn router() -> Router {
    let mut router = Router::new();
    for &(path, kind, content) in ASSETS {
        router = router.route(path, get(async move || ([(CONTENT_TYPE, kind)], content)));
    }
    router
}

/// For every other path.
pub async fn nowhere() -> Response {
    (
        StatusCode::NOT_FOUND,
        "there is nothing here; the panel is at /\n",
    )
        .into_response()
}
