//! Topics of Sparkplug B (Sparkplug 3.0, section 4.1).

use thiserror::Error;

/// Namespace of Sparkplug B.
pub const NAMESPACE: &str = "spBv1.0";

/// Longest identifier that is taken, bytes. A topic of MQTT has 65 535; this leaves room for three of them.
const LONGEST: usize = 256;

/// Why a text is no identifier.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum IdentifierError {
    /// Nothing, or too much.
    #[error("an identifier has 1 to {LONGEST} bytes, this one has {0}")]
    Length(usize),
    /// A character that a topic does not take.
    #[error(
        "{text:?} contains {found:?}: an identifier has no `+`, `/`, `#` and no control character"
    )]
    Character {
        /// The text.
        text: String,
        /// The character.
        found: char,
    },
}

/// Checks the identifier of a group, an edge node, a device or a host application.
///
/// # Errors
/// Its length, or a character that a topic does not take.
pub fn check_identifier(text: &str) -> Result<(), IdentifierError> {
    if !(1..=LONGEST).contains(&text.len()) {
        return Err(IdentifierError::Length(text.len()));
    }
    match text.chars().find(|c| "+/#".contains(*c) || c.is_control()) {
        Some(found) => Err(IdentifierError::Character {
            text: text.to_owned(),
            found,
        }),
        None => Ok(()),
    }
}

/// Kinds of messages that an edge node sends or takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Birth of the edge node.
    NBirth,
    /// Its death.
    NDeath,
    /// Its data.
    NData,
    /// A command to it.
    NCommand,
    /// Birth of a device.
    DBirth,
    /// Its death.
    DDeath,
    /// Its data.
    DData,
    /// A command to it.
    DCommand,
}

impl Kind {
    /// The element of a topic.
    pub const fn word(self) -> &'static str {
        match self {
            Kind::NBirth => "NBIRTH",
            Kind::NDeath => "NDEATH",
            Kind::NData => "NDATA",
            Kind::NCommand => "NCMD",
            Kind::DBirth => "DBIRTH",
            Kind::DDeath => "DDEATH",
            Kind::DData => "DDATA",
            Kind::DCommand => "DCMD",
        }
    }
}

/// Group and edge node of a topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    group: String,
    node: String,
}

impl Names {
    /// Names of a group and an edge node.
    ///
    /// # Errors
    /// One of them is no identifier.
    pub fn new(group: &str, node: &str) -> Result<Names, IdentifierError> {
        check_identifier(group)?;
        check_identifier(node)?;
        Ok(Names {
            group: group.to_owned(),
            node: node.to_owned(),
        })
    }

    /// The group.
    pub fn group(&self) -> &str {
        &self.group
    }

    /// The edge node.
    pub fn node(&self) -> &str {
        &self.node
    }

    /// Topic of the edge node.
    pub fn of_node(&self, kind: Kind) -> String {
        format!("{NAMESPACE}/{}/{}/{}", self.group, kind.word(), self.node)
    }

    /// Topic of a device.
    pub fn of_device(&self, kind: Kind, device: &str) -> String {
        format!("{}/{device}", self.of_node(kind))
    }

    /// The device of a command to one of this node's devices.
    pub fn commanded<'t>(&self, topic: &'t str) -> Option<&'t str> {
        topic
            .strip_prefix(&self.of_node(Kind::DCommand))?
            .strip_prefix('/')
    }
}

/// Topic on which a host application says whether it is there.
pub fn state_topic(host: &str) -> String {
    format!("{NAMESPACE}/STATE/{host}")
}
