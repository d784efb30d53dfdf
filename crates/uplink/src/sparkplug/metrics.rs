//! The metrics of a motor and of the plant, in groups whose values come together.

use super::value::{Datatype, Definition};

const fn metric(
    name: &'static str,
    datatype: Datatype,
    unit: &'static str,
    meaning: &'static str,
) -> Definition {
    Definition {
        name,
        datatype,
        unit,
        meaning,
    }
}

/// Metrics whose values come together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// What the configuration says of a motor.
    Info,
    /// A second of a motor.
    Second,
    /// The link to a motor's board.
    Link,
    /// An event of a board.
    Event,
    /// Something is missing.
    Gap,
    /// An alarm, of a motor or of the plant.
    Alarm,
    /// A recording.
    Recording,
    /// Another board.
    Board,
    /// The gateway itself.
    Gateway,
    /// History that was thinned.
    Thinned,
}

/// Groups of a motor, in the order of their metrics in a birth.
pub const OF_MOTOR: [Group; 8] = [
    Group::Info,
    Group::Second,
    Group::Link,
    Group::Event,
    Group::Gap,
    Group::Alarm,
    Group::Recording,
    Group::Board,
];

/// Groups of the gateway, in the order of their metrics in a birth. `bdSeq` and `Node Control/Rebirth` stand before them.
pub const OF_GATEWAY: [Group; 3] = [Group::Gateway, Group::Alarm, Group::Thinned];

/// Aliases of one motor or of the gateway; each has a block of so many.
pub const ALIASES: u64 = 128;

impl Group {
    /// Its metrics, in the order in which their values are given.
    pub fn metrics(self) -> &'static [Definition] {
        match self {
            Group::Info => &INFO,
            Group::Second => &SECOND,
            Group::Link => &LINK,
            Group::Event => &EVENT,
            Group::Gap => &GAP,
            Group::Alarm => &ALARM,
            Group::Recording => &RECORDING,
            Group::Board => &BOARD,
            Group::Gateway => &GATEWAY,
            Group::Thinned => &THINNED,
        }
    }

    /// Alias of its first metric within the block of a motor, or of the gateway.
    pub fn first_alias(self) -> u64 {
        let before = |groups: &[Group]| -> u64 {
            let groups = groups.iter().take_while(|group| **group != self);
            groups.map(|group| group.metrics().len() as u64).sum()
        };
        if OF_MOTOR.contains(&self) {
            before(&OF_MOTOR)
        } else {
            // Behind those that the gateway shares with a motor, and one of their own for bdSeq.
            1 + before(&OF_MOTOR) + before(&OF_GATEWAY)
        }
    }
}

const INFO: [Definition; 5] = [
    metric(
        "Info/Title",
        Datatype::Text,
        "",
        "what people call the motor",
    ),
    metric(
        "Info/Nameplate",
        Datatype::Text,
        "",
        "its nameplate in words",
    ),
    metric("Info/Place", Datatype::Text, "", "where it is"),
    metric("Info/Link", Datatype::Text, "", "how its board is reached"),
    metric("Info/MotorFile", Datatype::Text, "", "its motor file"),
];

const SECOND: [Definition; 23] = {
    use Datatype::{Float, UInt8, UInt64};
    [
        metric(
            "Second/Start",
            UInt64,
            "",
            "run of the board's program: number of the first event of this start",
        ),
        metric(
            "Second/Number",
            UInt64,
            "",
            "second since that start, from 1",
        ),
        metric(
            "Lamps/RUN",
            UInt8,
            "",
            "most severe state within the second: 0 off, 1 on, 2 blinking",
        ),
        metric("Lamps/r1", UInt8, "", "the same of r1"),
        metric("Lamps/r2", UInt8, "", "of r2"),
        metric("Lamps/r3", UInt8, "", "of r3"),
        metric("Lamps/r4", UInt8, "", "of r4"),
        metric("Lamps/SENSOR", UInt8, "", "of SENSOR"),
        metric("Lamps/LINE", UInt8, "", "of LINE"),
        metric("Lamps/LOAD", UInt8, "", "of LOAD"),
        metric("Lamps/FAULT", UInt8, "", "of FAULT"),
        metric(
            "Windows/Total",
            UInt8,
            "",
            "windows that ended in the second",
        ),
        metric("Windows/Judged", UInt8, "", "of these judged"),
        metric(
            "Windows/NotJudged",
            UInt8,
            "",
            "reason of the last one that was not judged; 0: all were",
        ),
        metric(
            "LikelyFault",
            UInt8,
            "",
            "number of the likely fault; 0: none of those known",
        ),
        metric("Residuals/r1", Float, "", "mean of r1, share of its scale"),
        metric("Residuals/r2", Float, "", "of r2"),
        metric("Residuals/r3", Float, "", "of r3"),
        metric("Residuals/r4", Float, "", "of r4"),
        metric("Voltage", Float, "V", "phase voltage, RMS"),
        metric("Current", Float, "A", "phase current, RMS"),
        metric("SupplyFrequency", Float, "Hz", "of the supply"),
        metric("Speed", Float, "1/min", "of the shaft"),
    ]
};

const LINK: [Definition; 2] = [
    metric(
        "Link/Up",
        Datatype::Boolean,
        "",
        "whether the board answers",
    ),
    metric("Link/Why", Datatype::Text, "", "why it does not"),
];

const EVENT: [Definition; 6] = {
    use Datatype::{Text, UInt16, UInt64};
    [
        metric(
            "Event/Number",
            UInt64,
            "",
            "number of the event in the board's log",
        ),
        metric("Event/Cause", UInt16, "", "number of its cause"),
        metric("Event/Words", Text, "", "its cause in words"),
        metric(
            "Event/Times",
            UInt16,
            "",
            "how often it happened before it was written",
        ),
        metric("Event/Value1", UInt64, "", "its first value, by the cause"),
        metric("Event/Value2", UInt64, "", "its second value"),
    ]
};

const GAP: [Definition; 4] = {
    use Datatype::{Text, UInt64};
    [
        metric(
            "Gap/Of",
            Text,
            "",
            "what is missing and cannot be asked for again: seconds, events, frames",
        ),
        metric(
            "Gap/Start",
            UInt64,
            "",
            "of seconds: the run of the program",
        ),
        metric("Gap/First", UInt64, "", "first missing number"),
        metric("Gap/Last", UInt64, "", "last missing number"),
    ]
};

const ALARM: [Definition; 13] = {
    use Datatype::{Boolean, DateTime, Float, Text, UInt64};
    [
        metric(
            "Alarm/Number",
            UInt64,
            "",
            "number of the alarm that changed",
        ),
        metric("Alarm/Change", Text, "", "what happened to it"),
        metric("Alarm/State", Text, "", "its state (ISA-18.2)"),
        metric("Alarm/Cause", Text, "", "what it is about"),
        metric("Alarm/Severity", Text, "", "how soon somebody must act"),
        metric(
            "Alarm/Present",
            Boolean,
            "",
            "whether its condition is there",
        ),
        metric("Alarm/Fault", Text, "", "name of the likely fault"),
        metric("Alarm/Size", Float, "", "size"),
        metric(
            "Alarm/Times",
            UInt64,
            "",
            "how often it rose since it was last normal",
        ),
        metric("Alarm/Raised", DateTime, "", "when it last rose"),
        metric("Alarm/Who", Text, "", "who changed it"),
        metric("Alarm/Why", Text, "", "why"),
        metric("Alarm/Evidence", Text, "", "what it rests on"),
    ]
};

const RECORDING: [Definition; 5] = {
    use Datatype::{DateTime, Text, UInt64};
    [
        metric(
            "Recording/File",
            Text,
            "",
            "name of a recording, the samples around an alarm",
        ),
        metric("Recording/Size", UInt64, "byte", "its size"),
        metric("Recording/From", DateTime, "", "begin of its samples"),
        metric("Recording/To", DateTime, "", "their end"),
        metric("Recording/Missing", Text, "", "why an alarm has none"),
    ]
};

const BOARD: [Definition; 1] = [metric(
    "Board/Serial",
    Datatype::Text,
    "",
    "serial number of the board that watches the motor from now on",
)];

const GATEWAY: [Definition; 4] = [
    metric(
        "Gateway/Version",
        Datatype::Text,
        "",
        "version of the program",
    ),
    metric(
        "Gateway/Motors",
        Datatype::UInt64,
        "",
        "motors that are declared",
    ),
    metric(
        "Gateway/RefusedCommands",
        Datatype::UInt64,
        "",
        "commands that were refused since the program started",
    ),
    metric(
        "Gateway/ForeignBirths",
        Datatype::UInt64,
        "",
        "births under this node's name that it has not said, since the program started: a second gateway of that name, or old births played again",
    ),
];

const THINNED: [Definition; 4] = {
    use Datatype::{DateTime, Text, UInt64};
    [
        metric("Thinned/To", Text, "", "what was done with old history"),
        metric(
            "Thinned/Before",
            DateTime,
            "",
            "everything before this is thinned",
        ),
        metric(
            "Thinned/Count",
            UInt64,
            "",
            "how much: blocks, hours, entries",
        ),
        metric("Thinned/Why", Text, "", "which limit asked for it"),
    ]
};

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn names(groups: &[Group]) -> Vec<String> {
        let metrics = groups.iter().flat_map(|group| group.metrics());
        metrics.map(|metric| metric.name.to_lowercase()).collect()
    }

    #[test]
    fn names_differ_in_more_than_their_case() {
        for groups in [&OF_MOTOR[..], &OF_GATEWAY[..]] {
            let all = names(groups);
            assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), all.len());
        }
    }

    #[test]
    fn aliases_of_a_block_differ_and_fit() {
        for groups in [&OF_MOTOR[..], &OF_GATEWAY[..]] {
            let mut taken = BTreeSet::new();
            for group in groups {
                for k in 0..group.metrics().len() as u64 {
                    let alias = group.first_alias() + k;
                    assert!(alias < ALIASES && taken.insert(alias), "{group:?} {k}");
                }
            }
        }
        let bd_seq = OF_MOTOR
            .iter()
            .map(|g| g.metrics().len() as u64)
            .sum::<u64>();
        assert!(bd_seq < Group::Gateway.first_alias());
    }
}
