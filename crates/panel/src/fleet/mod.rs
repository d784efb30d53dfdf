//! The page of a plant of many motors, and its HTTP API.
//!
//! It reads the store beside the gateway, in a program of its own. What people do to alarms is written down beside the store
//! ([`fleet::people`]), and the gateway does it: so the store has one writer, and an action outlives a crash of either.

mod access;
mod actions;
mod answers;
mod assets;
mod convert;
mod overviews;
mod plant;
mod questions;
mod routes;
mod stream;
mod wall;
mod words;

use std::net::{IpAddr, SocketAddr};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::DefaultBodyLimit;
use axum::{Router, middleware};
use fleet::people::PeopleError;
use tokio::net::TcpListener;
use tokio::runtime::Builder;
use tokio_rustls::TlsAcceptor;

use crate::http::assets::nowhere;
use crate::http::connections::{self, Connections};
use crate::http::guard::{self, Guard};
use crate::http::server::Options;
use crate::http::tls::TlsError;

use plant::{Plant, Settings};

pub use overviews::month::{CalendarMonth, Month, NoMonth, month_page};
pub use plant::{DueRule, PlantError};
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
    /// It cannot encrypt.
    #[error(transparent)]
    Tls(#[from] TlsError),
    /// What is sent could be read.
    #[error(
        "--host {0}: tokens and data would cross the network without encryption; give --tls-cert and --tls-key, or add \
         --allow-plain where something else encrypts or nobody else listens"
    )]
    Plain(IpAddr),
    /// The store or its people.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// The system gives no server.
    #[error("no server can be started: {0}")]
    System(#[from] std::io::Error),
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
struct Running {
    listener: TcpListener,
    address: SocketAddr,
    scheme: &'static str,
    tls: Option<TlsAcceptor>,
    plant: Arc<Plant>,
    router: Router,
}

/// For a question that is being answered when the server ends.
const LAST_WORK: Duration = Duration::from_secs(1);

/// What the page makes of what is stored.
#[derive(Clone, Debug)]
pub struct Look {
    /// A motor without data for so long is grey, ms.
    pub stale_ms: i64,
    /// When a calibration is due.
    pub due: DueRule,
}

/// Shows a plant until `end`; `told` hears the address that a browser opens.
///
/// # Errors
/// The store cannot be read, the address cannot be bound, or others could reach it without a token.
pub fn show(
    store: &Path,
    look: Look,
    options: &Options,
    told: impl FnOnce(&str),
    end: impl Future<Output = ()>,
) -> Result<(), FleetError> {
    let open = options.host.is_loopback();
    let Look { stale_ms, due } = look;
    let settings = Settings {
        stale_ms,
        open,
        due,
    };
    let plant = Plant::open(store, settings)?;
    let runtime = Builder::new_current_thread().enable_all().build()?;
    let served = runtime.block_on(async {
        let running = bind(options, plant).await?;
        told(&running.url());
        running.serve(end).await;
        Ok(())
    });
    runtime.shutdown_timeout(LAST_WORK);
    served
}

/// Binds the address and puts everything behind guard and roles. Needs a tokio runtime.
///
/// # Errors
/// An address that others can reach without `allow_network`, without encryption or without users, or one that cannot be bound.
async fn bind(options: &Options, plant: Arc<Plant>) -> Result<Running, FleetError> {
    if !options.host.is_loopback() && !options.allow_network {
        return Err(FleetError::Network(options.host));
    }
    if !options.host.is_loopback() && options.tls.is_none() && !options.allow_plain {
        return Err(FleetError::Plain(options.host));
    }
    let tls = options.acceptor()?;
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
    let guard = Guard::new(address, &options.allow_hosts, None).encrypted(tls.is_some());
    let guard = Arc::new(guard);
    let cookie = access::Cookie {
        name: format!("drivemon-fleet-{}", address.port()),
        encrypted: tls.is_some(),
    };
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
        scheme: options.scheme(),
        tls,
        plant,
        router,
    })
}

impl Running {
    /// The address that a browser opens.
    fn url(&self) -> String {
        let mut address = self.address;
        if address.ip().is_unspecified() {
            address.set_ip(IpAddr::from([127, 0, 0, 1]));
        }
        format!("{}://{address}/", self.scheme)
    }

    /// Answers until `end`; connections that are open then are cut.
    async fn serve(self, end: impl Future<Output = ()>) {
        let connections = Connections::default();
        tokio::select! {
            () = connections::serve(&self.listener, self.tls.as_ref(), &self.router, &connections) => {}
            () = end => {}
        }
        self.plant.end();
    }
}
