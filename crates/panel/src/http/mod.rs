//! The server: connections, requests, the page, the stream of windows.

pub(crate) mod api;
pub(crate) mod assets;
pub(crate) mod connections;
pub(crate) mod export;
pub(crate) mod guard;
pub(crate) mod server;
pub(crate) mod stream;
pub(crate) mod tls;
