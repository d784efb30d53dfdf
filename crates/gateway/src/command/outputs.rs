//! What a gateway hands on, and to whom.

use std::future::Future;
use std::path::Path;
use std::sync::Arc;

use document::Section;
use fleet::Store;
use fleet::alarm::Watch;
use tokio::sync::watch;

use super::terminal::Terminal;

/// What outputs work with.
pub struct Handles {
    /// The store; each output keeps its place there.
    pub store: Arc<Store>,
    /// The alarms.
    pub alarms: Arc<Watch>,
    /// Changes whenever something new is on the disk.
    pub stored: watch::Receiver<u64>,
    /// `true` once the gateway ends.
    pub ended: watch::Receiver<bool>,
    /// Where lines go.
    pub terminal: Terminal,
}

/// Outputs of a gateway: sections of its configuration, and what is done with the store.
pub trait Outputs: Sized {
    /// Reads them from the top level of a configuration in `folder`. `None` after a problem, which is reported.
    fn read(root: &Section<'_>, folder: &Path) -> Option<Self>;

    /// Names of those that have a place in the store: it keeps for them what they have not taken.
    fn names(&self) -> Vec<String>;

    /// What a check says of them, a line each.
    fn described(&self) -> Vec<String>;

    /// What would keep them from working, a line each: a check says it.
    fn to_change(&self) -> Vec<String> {
        Vec::new()
    }

    /// Works until the gateway ends; why it cannot go on, where it ends before.
    fn run(self, handles: Handles) -> impl Future<Output = String>;
}

/// Nothing is handed on.
impl Outputs for () {
    fn read(_: &Section<'_>, _: &Path) -> Option<Self> {
        Some(())
    }

    fn names(&self) -> Vec<String> {
        Vec::new()
    }

    fn described(&self) -> Vec<String> {
        vec!["outputs: none".to_owned()]
    }

    async fn run(self, mut handles: Handles) -> String {
        // A gateway that was dropped has ended, too.
        let _ = handles.ended.wait_for(|ended| *ended).await;
        String::new()
    }
}
