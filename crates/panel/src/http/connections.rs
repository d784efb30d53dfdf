//! Connections: how many, and for how long one may say nothing.
//!
//! A client that holds connections open without asking anything must not keep others out: a connection whose request head does
//! not come is closed, a body that stops coming is given up, and when all places are taken the oldest connection that has
//! not yet asked for anything makes room.

use std::collections::VecDeque;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use axum::body::Body;
use axum::extract::Request;
use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use socket2::SockRef;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Notify;
use tokio_rustls::TlsAcceptor;
use tokio_stream::StreamExt;

use crate::running::shared::locked;

/// Connections at a time: a page takes one for its stream and a few for its files. Below half of the usual smallest limit
/// of open files, 128.
const MOST: usize = 60;
/// For the whole head of a request, and between two requests.
const HEAD: Duration = Duration::from_secs(10);
/// Between two pieces of a body.
const PIECE: Duration = Duration::from_secs(20);
/// After this time without a sign from the other end what was sent to it is given up.
const UNHEARD: Duration = Duration::from_secs(30);
/// Bytes of a head.
const MOST_HEAD_BYTES: usize = 32 * 1024;
/// The system is out of files or memory: before it is tried again.
const BREATH: Duration = Duration::from_millis(100);

/// What the system may hold back for one page, bytes: a second of windows. With more, a page that cannot follow would
/// show what is long past instead of losing it.
const SEND_BUFFER_BYTES: usize = 64 * 1024;

/// One connection.
#[derive(Clone, Debug, Default)]
pub struct Connection {
    /// Has asked for something that it may have.
    known: Arc<AtomicBool>,
    cut: Arc<Notify>,
}

impl Connection {
    /// It has asked for something that it may have: it does not make room for others.
    pub fn is_known(&self) {
        self.known.store(true, Relaxed);
    }
}

/// All that are open, the oldest first.
#[derive(Debug, Default)]
pub struct Connections(Arc<Mutex<VecDeque<Connection>>>);

impl Connections {
    /// A place for another one; `None` where all are taken by connections that have asked for something.
    fn place(&self) -> Option<Connection> {
        let mut open = locked(&self.0);
        if open.len() >= MOST {
            let stranger = open.iter().position(|one| !one.known.load(Relaxed))?;
            let stranger = open.remove(stranger)?;
            stranger.cut.notify_one();
        }
        let connection = Connection::default();
        open.push_back(connection.clone());
        Some(connection)
    }

    fn closed(open: &Mutex<VecDeque<Connection>>, connection: &Connection) {
        locked(open).retain(|one| !Arc::ptr_eq(&one.cut, &connection.cut));
    }
}

/// Windows go out at once, and nothing waits for ever for a reader that is gone. A system that does not know one of the
/// options serves all the same.
fn prepare(stream: &TcpStream) {
    let _ = stream.set_nodelay(true);
    let socket = SockRef::from(stream);
    let _ = socket.set_send_buffer_size(SEND_BUFFER_BYTES);
    #[cfg(target_os = "linux")]
    let _ = socket.set_tcp_user_timeout(Some(UNHEARD));
}

/// Answers for ever, through TLS where there is an acceptor.
pub async fn serve(
    listener: &TcpListener,
    tls: Option<&TlsAcceptor>,
    router: &Router,
    connections: &Connections,
) {
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // Out of files, or the other end gave up already.
            tokio::time::sleep(BREATH).await;
            continue;
        };
        // All places are taken by pages that are in use: the next one is told nothing but closed.
        let Some(connection) = connections.place() else {
            continue;
        };
        prepare(&stream);
        let (router, open, tls) = (router.clone(), connections.0.clone(), tls.cloned());
        tokio::spawn(async move {
            tokio::select! {
                () = greet(stream, tls, router, connection.clone()) => {}
                () = connection.cut.notified() => {}
            }
            Connections::closed(&open, &connection);
        });
    }
}

/// A handshake that does not come to its end in the time of a head is given up.
async fn greet(
    stream: TcpStream,
    tls: Option<TlsAcceptor>,
    router: Router,
    connection: Connection,
) {
    let Some(tls) = tls else {
        return answer(stream, router, connection).await;
    };
    if let Ok(Ok(stream)) = tokio::time::timeout(HEAD, tls.accept(stream)).await {
        answer(stream, router, connection).await;
    }
}

async fn answer<S>(stream: S, router: Router, connection: Connection)
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    let router = router.layer(Extension(connection));
    let served = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD)
        .max_buf_size(MOST_HEAD_BYTES)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router));
    // What broke a connection concerns the other end.
    let _ = served.await;
}

/// A body that stops coming ends with an error.
pub async fn not_for_ever(request: Request) -> Request {
    request.map(|body| {
        let pieces = StreamExt::timeout(body.into_data_stream(), PIECE);
        Body::from_stream(pieces.map(|piece| match piece {
            Ok(piece) => piece.map_err(io::Error::other),
            Err(_) => Err(io::Error::new(
                io::ErrorKind::TimedOut,
                "nothing more came for 20 s",
            )),
        }))
    })
}
