//! How a command that runs for ever is ended.

/// Until Ctrl-C is pressed or the system asks the process to end. Without such signals a server lives until its
/// process is ended.
pub(crate) async fn told_to_end() {
    let pressed = async {
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
    };
    #[cfg(unix)]
    let asked = async {
        use tokio::signal::unix::{SignalKind, signal};
        match signal(SignalKind::terminate()) {
            Ok(mut terminate) => drop(terminate.recv().await),
            Err(_) => std::future::pending().await,
        }
    };
    #[cfg(not(unix))]
    let asked = std::future::pending::<()>();
    tokio::select! { () = pressed => {}, () = asked => {} }
}
