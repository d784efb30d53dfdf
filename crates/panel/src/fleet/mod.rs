//! The page of a plant of many motors, and its HTTP API.
//!
//! It reads the store beside the gateway, in a program of its own. What people do to alarms is written down beside the store
//! ([`fleet::people`]), and the gateway does it: so the store has one writer, and an action outlives a crash of either.

mod access;
mod actions;
mod answers;
mod assets;
mod convert;
mod plant;
mod questions;
mod routes;
mod stream;
mod wall;
mod words;

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;

use axum::extract::DefaultBodyLimit;
use axum::{Router, middleware};
use fleet::people::PeopleError;
use tokio::net::TcpListener;
use tokio::sync::watch;

use crate::http::assets::nowhere;
use crate::http::connections::{self, Connections};
use crate::http::guard::{self, Guard};
use crate::http::server::Options;

pub use plant::{Plant, PlantError, Settings};
pub use routes::document;

/// Largest body of a request: a reason is far smaller.
const MOST_BODY_BYTES: usize = 16 * 1024;

/// Why there is no server.
#[derive(Debug, thiserror::Error)]
pub enum FleetError {
    /// Others could reach it.
    #[error(
        "--host {0}: others on that network could reach this page; add --allow-network if that is meant (it then asks \
         everybody for a token), or leave --host out"
    )]
    Network(IpAddr),
    /// Nobody could sign in.
    #[error(
        "nobody has a token yet: make one with `drivemon fleet user add NAME --role see --fleet CONFIG`"
    )]
    NoUsers,
    /// The people cannot be read.
    #[error(transparent)]
    People(#[from] PeopleError),
    /// The system refuses.
    #[error("{address}: {error}; choose another --port, or --port 0 for any that is free")]
    Bind {
        /// Where.
        address: SocketAddr,
        /// What it says.
        error: std::io::Error,
    },
}

/// A server that listens and does not answer yet.
pub struct Running {
    listener: TcpListener,
    address: SocketAddr,
    plant: Arc<Plant>,
    router: Router,
}

/// Whether the page may be seen without a token: where nobody else can reach it.
pub fn is_open(options: &Options) -> bool {
    options.host.is_loopback()
}

/// Binds the address and puts everything behind guard and roles. Needs a tokio runtime.
///
/// # Errors
/// An address that others can reach without `allow_network` or without users, or one that cannot be bound.
pub async fn bind(options: &Options, plant: Arc<Plant>) -> Result<Running, FleetError> {
    if !options.host.is_loopback() && !options.allow_network {
        return Err(FleetError::Network(options.host));
    }
    if !plant.settings.open && plant.people.users()?.is_empty() {
        return Err(FleetError::NoUsers);
    }
    let wanted = SocketAddr::new(options.host, options.port);
    let refused = |error| FleetError::Bind {
        address: wanted,
        error,
    };
    let listener = TcpListener::bind(wanted).await.map_err(refused)?;
    let address = listener.local_addr().map_err(refused)?;
    // Tokens belong to people here: the guard asks for none.
    let guard = Arc::new(Guard::new(address, &options.allow_hosts, None));
    let cookie = access::CookieName(format!("drivemon-fleet-{}", address.port()));
    let router = Router::new()
        .merge(routes::router(&plant, &cookie))
        .layer(DefaultBodyLimit::max(MOST_BODY_BYTES))
        .merge(assets::router())
        .fallback(nowhere)
        .layer(middleware::map_request(connections::not_for_ever))
        .layer(middleware::from_fn_with_state(guard, guard::check))
        .layer(middleware::from_fn_with_state(
            plant.clone(),
            access::count_foreign,
        ));
    Ok(Running {
        listener,
        address,
        plant,
        router,
    })
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
    pub async fn serve(self, mut end: watch::Receiver<bool>) {
        let connections = Connections::default();
        tokio::select! {
            () = connections::serve(&self.listener, &self.router, &connections) => {}
            _ = end.wait_for(|end| *end) => {}
        }
        self.plant.end();
    }
}
