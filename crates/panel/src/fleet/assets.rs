//! The fleet page: a fixed table of embedded files, as the panel's.

use axum::Router;
use axum::http::header::CONTENT_TYPE;
use axum::routing::get;

use crate::http::assets::{Asset, HTML, SCRIPT, STYLE, shared};

/// A file of the page under `/panel/fleet/`.
macro_rules! own {
    ($name:literal, $kind:expr) => {
        (
            concat!("/panel/fleet/", $name),
            $kind,
            include_str!(concat!("../../assets/fleet/", $name)),
        )
    };
}

/// What is served beside the files that both pages use.
const ASSETS: &[Asset] = &[
    ("/", HTML, include_str!("../../assets/fleet/index.html")),
    own!("fleet.css", STYLE),
    own!("main.js", SCRIPT),
    own!("stream.js", SCRIPT),
    own!("server.js", SCRIPT),
    own!("words.js", SCRIPT),
    own!("plant.js", SCRIPT),
    own!("wall.js", SCRIPT),
    own!("table.js", SCRIPT),
    own!("alarms.js", SCRIPT),
    own!("models.js", SCRIPT),
    own!("motor.js", SCRIPT),
    own!("trends.js", SCRIPT),
    own!("account.js", SCRIPT),
];

/// A route for each file.
pub(super) fn router() -> Router {
    let mut router = Router::new();
    for &(path, kind, content) in ASSETS.iter().chain(shared()) {
        router = router.route(path, get(async move || ([(CONTENT_TYPE, kind)], content)));
    }
    router
}
