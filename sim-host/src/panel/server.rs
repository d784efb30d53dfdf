//! The server: where it listens, what it serves, how it ends.

use std::future::IntoFuture;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;

use axum::extract::DefaultBodyLimit;
use axum::serve::ListenerExt;
use axum::{Router, middleware};
use socket2::SockRef;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;

use super::guard::{Guard, check};
use super::session::Session;
use super::{api, assets, workbench};

/// A request of the live page is far smaller; the workbench sets its own limit for recordings.
const MOST_BODY_BYTES: usize = 64 * 1024;

/// What the system may hold back for one page, bytes: a second of windows. With more, a page that cannot follow would
/// show what is long past instead of losing it.
const SEND_BUFFER_BYTES: usize = 64 * 1024;

/// Windows go out at once. A system that knows neither option serves all the same.
fn prepare(stream: &mut TcpStream) {
    let _ = stream.set_nodelay(true);
    let _ = SockRef::from(&*stream).set_send_buffer_size(SEND_BUFFER_BYTES);
}

/// Where to listen and who may come.
#[derive(Clone, Debug)]
pub struct Options {
    /// Address to listen on.
    pub host: IpAddr,
    /// Port; 0 for any that is free.
    pub port: u16,
    /// Whether an address that others can reach is meant.
    pub allow_network: bool,
    /// Further names that the server may be called by.
    pub allow_hosts: Vec<String>,
}

/// Why there is no server.
#[derive(Debug, thiserror::Error)]
pub enum PanelError {
    /// Others could reach it.
    #[error(
        "--host {0}: everybody on that network could switch and read this panel, and there is no password; \
         add --allow-network if that is meant, or leave --host out"
    )]
    Network(IpAddr),
    /// The system refuses.
    #[error("{address}: {error}; choose another --port, or --port 0 for any that is free")]
    Bind {
        /// Where.
        address: SocketAddr,
        /// What it says.
        error: std::io::Error,
    },
    /// The server broke down.
    #[error("the server ended: {0}")]
    Ended(std::io::Error),
}

/// A server that listens and does not answer yet.
#[derive(Debug)]
pub struct Running {
    listener: TcpListener,
    address: SocketAddr,
    router: Router,
}

/// Binds the address and puts everything behind the guard. Needs a tokio runtime.
///
/// # Errors
/// An address that others can reach without `allow_network`, or one that cannot be bound.
pub async fn bind(options: &Options, session: Arc<Session>) -> Result<Running, PanelError> {
    if !options.host.is_loopback() && !options.allow_network {
        return Err(PanelError::Network(options.host));
    }
    let wanted = SocketAddr::new(options.host, options.port);
    let refused = |error| PanelError::Bind {
        address: wanted,
        error,
    };
    let listener = TcpListener::bind(wanted).await.map_err(refused)?;
    let address = listener.local_addr().map_err(refused)?;
    let guard = Arc::new(Guard::new(address, &options.allow_hosts));
    Ok(Running {
        listener,
        address,
        router: router(session, guard),
    })
}

fn router(session: Arc<Session>, guard: Arc<Guard>) -> Router {
    Router::new()
        .merge(api::router(session.clone()))
        .layer(DefaultBodyLimit::max(MOST_BODY_BYTES))
        .merge(workbench::router(session))
        .merge(assets::router())
        .fallback(assets::nowhere)
        .layer(middleware::from_fn_with_state(guard, check))
}

impl Running {
    /// The address that a browser opens.
    pub fn url(&self) -> String {
        let mut address = self.address;
        if address.ip().is_unspecified() {
            address.set_ip(IpAddr::from([127, 0, 0, 1]));
        }
        format!("http://{address}/")
    }

    /// Answers until `end` turns true; connections that are open then are cut.
    ///
    /// # Errors
    /// The listener broke down.
    pub async fn serve(self, mut end: watch::Receiver<bool>) -> Result<(), PanelError> {
        tokio::select! {
            served = axum::serve(self.listener.tap_io(prepare), self.router).into_future() => served.map_err(PanelError::Ended),
            _ = end.wait_for(|end| *end) => Ok(()),
        }
    }
}
