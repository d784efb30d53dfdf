//! The primary host application: whether it is there (Sparkplug 3.0, sections 4.2.3, 5.4 and 5.5).

use serde::Deserialize;

/// Longest STATE that is read, bytes; it has two numbers.
const LONGEST: usize = 1024;

/// What a STATE message says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
struct Said {
    online: bool,
    timestamp: u64,
}

/// What is known of the primary host.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Host {
    said: Option<Said>,
}

/// What a STATE message changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Nothing: it said the same, it is older than what is known, or it is no STATE message.
    None,
    /// It is there now.
    Came,
    /// It is away now.
    Went,
}

impl Host {
    /// Whether it said that it is there.
    pub fn is_online(&self) -> bool {
        self.said.is_some_and(|said| said.online)
    }

    /// The session ended: whether it is there must be said again. Its last time stays known.
    pub fn forget(&mut self) {
        if let Some(said) = &mut self.said {
            said.online = false;
        }
    }

    /// Takes a STATE message. A message older than the newest one is out of date and changes nothing.
    pub fn take(&mut self, payload: &[u8]) -> Turn {
        let Some(said) = read(payload) else {
            return Turn::None;
        };
        if self
            .said
            .is_some_and(|known| said.timestamp < known.timestamp)
        {
            return Turn::None;
        }
        let before = self.is_online();
        self.said = Some(said);
        match (before, said.online) {
            (false, true) => Turn::Came,
            (true, false) => Turn::Went,
            _ => Turn::None,
        }
    }
}

fn read(payload: &[u8]) -> Option<Said> {
    if payload.len() > LONGEST {
        return None;
    }
    serde_json::from_slice(payload).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(online: bool, timestamp: u64) -> Vec<u8> {
        format!("{{\"online\":{online},\"timestamp\":{timestamp}}}").into_bytes()
    }

    #[test]
    fn an_older_message_changes_nothing() {
        let mut host = Host::default();
        assert!(!host.is_online());
        assert_eq!(host.take(&said(true, 100)), Turn::Came);
        assert_eq!(host.take(&said(false, 99)), Turn::None);
        assert!(host.is_online());
        // A host's death says the time of its birth.
        assert_eq!(host.take(&said(false, 100)), Turn::Went);
        assert_eq!(host.take(&said(true, 99)), Turn::None);
        assert!(!host.is_online());
        assert_eq!(host.take(&said(true, 101)), Turn::Came);
        assert_eq!(host.take(&said(true, 102)), Turn::None);
    }

    #[test]
    fn what_is_no_state_changes_nothing() {
        let mut host = Host::default();
        for payload in [
            &b"ONLINE"[..],
            b"",
            b"{\"online\":true}",
            b"{\"online\":\"true\",\"timestamp\":1}",
            b"{\"online\":true,\"timestamp\":-1}",
            b"[true,1]x",
            &[b' '; 4000],
        ] {
            assert_eq!(host.take(payload), Turn::None, "{payload:?}");
        }
        assert!(!host.is_online());
    }
}
