//! The server: where it listens, what it serves, how it ends.

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;

use axum::extract::DefaultBodyLimit;
use axum::{Router, middleware};
use tokio::net::TcpListener;
use tokio::sync::watch;
use tokio_rustls::TlsAcceptor;

use crate::http::connections::{self, Connections};
use crate::http::guard::{Guard, Token, check};
use crate::http::tls::{TlsError, TlsFiles, acceptor};
use crate::http::{api, assets};
use crate::running::session::Session;
use crate::workbench;
use crate::workbench::Bench;

/// A request of the live page is far smaller; the workbench sets its own limit for recordings.
const MOST_BODY_BYTES: usize = 64 * 1024;

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
    /// Encrypts, where it is given.
    pub tls: Option<TlsFiles>,
    /// Whether others may reach the page of a plant without encryption.
    pub allow_plain: bool,
}

impl Options {
    /// What answers TLS.
    ///
    /// # Errors
    /// Files that cannot be used.
    pub(crate) fn acceptor(&self) -> Result<Option<TlsAcceptor>, TlsError> {
        self.tls.as_ref().map(acceptor).transpose()
    }

    /// The scheme of its links.
    pub(crate) fn scheme(&self) -> &'static str {
        match self.tls {
            Some(_) => "https",
            None => "http",
        }
    }
}

/// Why there is no server.
#[derive(Debug, thiserror::Error)]
pub enum PanelError {
    /// Others could reach it.
    #[error(
        "--host {0}: others on that network could reach this panel; add --allow-network if that is meant (it then asks for \
         the token of the link that is printed), or leave --host out"
    )]
    Network(IpAddr),
    /// No token could be made.
    #[error("the system gives no random numbers for the token of --allow-network: {0}")]
    Random(getrandom::Error),
    /// It cannot encrypt.
    #[error(transparent)]
    Tls(#[from] TlsError),
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
    scheme: &'static str,
    tls: Option<TlsAcceptor>,
    guard: Arc<Guard>,
    bench: Arc<Bench>,
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
    let tls = options.acceptor()?;
    let token = options.allow_network.then(Token::random).transpose();
    let token = token.map_err(PanelError::Random)?;
    let listener = TcpListener::bind(wanted).await.map_err(refused)?;
    let address = listener.local_addr().map_err(refused)?;
    let guard = Guard::new(address, &options.allow_hosts, token).encrypted(tls.is_some());
    let guard = Arc::new(guard);
    let bench = workbench::bench(session.clone());
    Ok(Running {
        listener,
        address,
        scheme: options.scheme(),
        tls,
        router: router(session, bench.clone(), guard.clone()),
        guard,
        bench,
    })
}

fn router(session: Arc<Session>, bench: Arc<Bench>, guard: Arc<Guard>) -> Router {
    Router::new()
        .merge(api::router(session))
        .layer(DefaultBodyLimit::max(MOST_BODY_BYTES))
        .merge(workbench::router(bench))
        .merge(assets::router())
        .fallback(assets::nowhere)
        .layer(middleware::map_request(connections::not_for_ever))
        .layer(middleware::from_fn_with_state(guard, check))
}

impl Running {
    /// The address that a browser opens, with the token where one is asked for.
    pub fn url(&self) -> String {
        let mut address = self.address;
        if address.ip().is_unspecified() {
            address.set_ip(IpAddr::from([127, 0, 0, 1]));
        }
        format!("{}://{address}/{}", self.scheme, self.guard.query())
    }

    /// Whether other computers can reach it under their own name for this one.
    pub fn is_on_all_addresses(&self) -> bool {
        self.address.ip().is_unspecified()
    }

    /// Answers until `end` turns true; connections that are open then are cut, and what was uploaded is removed.
    pub async fn serve(self, mut end: watch::Receiver<bool>) {
        let connections = Connections::default();
        tokio::select! {
            () = connections::serve(&self.listener, self.tls.as_ref(), &self.router, &connections) => {}
            _ = end.wait_for(|end| *end) => {}
        }
        self.bench.clear();
    }
}
