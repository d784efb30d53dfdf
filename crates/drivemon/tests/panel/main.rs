//! The panel as others meet it: over a socket, and in a browser.

mod browser;
mod http;
mod life;
#[cfg(feature = "gateway")]
mod plant;
mod server;
mod slow;
mod strangers;
mod workbench;
