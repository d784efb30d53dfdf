//! The workbench: load recordings, compare, explain, adopt. It brings its own routes and state.

use axum::Router;

/// Its routes, all under `/api/workbench/`; the server merges them behind its guard.
pub fn router() -> Router {
    Router::new()
}
