//! What other recorders call the channels.

use recording::{Channel, Signal, Target};

/// A name with its capitals, blanks and marks gone: `U_L1-N` is `ul1n`.
fn plain(name: &str) -> String {
    let letters = name.chars().filter(|c| c.is_alphanumeric());
    letters.flat_map(char::to_lowercase).collect()
}

/// The phases of some countries.
const RST: [&str; 3] = ["r", "s", "t"];
/// Names of the phases a, b, c, one row each.
const PHASES: [[&str; 3]; 6] = [
    ["a", "b", "c"],
    ["1", "2", "3"],
    ["l1", "l2", "l3"],
    ["u", "v", "w"],
    RST,
    ["phasea", "phaseb", "phasec"],
];
/// Names of the pairs of phases ab, bc, ca.
const PAIRS: [[&str; 3]; 6] = [
    ["ab", "bc", "ca"],
    ["12", "23", "31"],
    ["l1l2", "l2l3", "l3l1"],
    ["l12", "l23", "l31"],
    ["uv", "vw", "wu"],
    ["rs", "st", "tr"],
];
const VOLTAGE: [&str; 6] = ["v", "u", "voltage", "spannung", "volt", "tension"];
const CURRENT: [&str; 4] = ["i", "current", "strom", "courant"];

/// A quantity with the names of its single channel.
type Single = (&'static [&'static str], Target);

const SINGLES: [Single; 4] = [
    (
        &[
            "t",
            "time",
            "zeit",
            "temps",
            "tijd",
            "timestamp",
            "zeitstempel",
            "datetime",
            "dateandtime",
            "datetimestamp",
            "datumzeit",
            "uhrzeit",
            "timesec",
            "elapsedtime",
            "relativetime",
            "seconds",
            "second",
            "xvalue",
            "xaxis",
            "timestamps",
            "dateheure",
            "localtime",
            "clock",
            "timechannel",
        ],
        Target::Time,
    ),
    (
        &[
            "speed",
            "drehzahl",
            "rpm",
            "vitesse",
            "omega",
            "omegam",
            "wm",
            "rotorspeed",
            "motorspeed",
            "shaftspeed",
            "nist",
            "nmot",
            "rotationalspeed",
            "istdrehzahl",
            "actualspeed",
            "nactrpm",
            "speedactual",
        ],
        Target::Channel(Channel::SPEED),
    ),
    (
        &[
            "torque",
            "drehmoment",
            "shafttorque",
            "mist",
            "loadtorque",
            "couple",
            "actualtorque",
        ],
        Target::Channel(Channel::TORQUE),
    ),
    (
        &[
            "temperature",
            "temperatur",
            "temp",
            "windingtemperature",
            "wicklungstemperatur",
        ],
        Target::Channel(Channel::TEMPERATURE),
    ),
];
/// Single letters that mean a channel only with a unit of it.
const WITH_UNIT: [Single; 2] = [
    (&["n"], Target::Channel(Channel::SPEED)),
    (&["m", "md"], Target::Channel(Channel::TORQUE)),
];

/// A set of three columns of one kind, by the names that one recorder gives them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Three {
    /// The column of each phase or pair, with whether it is taken the other way round (`vba`).
    pub columns: [Option<(usize, bool)>; 3],
    pub signals: [Signal; 3],
    /// Whether these are line voltages.
    pub is_line: bool,
    /// Whether two of the names could mean something else: `ir` and `is` are rotor and stator as well.
    takes_all: bool,
}

impl Three {
    /// How many of the three are there.
    pub fn count(&self) -> usize {
        self.columns.iter().flatten().count()
    }
}

const VOLTAGES: [Signal; 3] = [Signal::Va, Signal::Vb, Signal::Vc];
const CURRENTS: [Signal; 3] = [Signal::Ia, Signal::Ib, Signal::Ic];

/// The sets of phase voltages, line voltages and currents that names can mean; each has two columns or three.
pub(crate) fn threes(stems: &[String]) -> Vec<Three> {
    let names: Vec<String> = stems.iter().map(|stem| plain(stem)).collect();
    let mut found: Vec<Three> = Vec::new();
    for (words, signals) in [(&VOLTAGE[..], VOLTAGES), (&CURRENT[..], CURRENTS)] {
        for (word, phases) in words
            .iter()
            .flat_map(|word| PHASES.map(|phases| (word, phases)))
        {
            let column = |phase: &str| find(&names, word, phase).map(|k| (k, false));
            let columns = phases.map(column);
            found.push(Three {
                columns,
                signals,
                is_line: false,
                takes_all: phases == RST,
            });
        }
    }
    for (word, pairs) in VOLTAGE
        .iter()
        .flat_map(|word| PAIRS.map(|pairs| (word, pairs)))
    {
        let columns = pairs.map(|pair| {
            let forward = find(&names, word, pair).map(|k| (k, false));
            forward.or_else(|| find(&names, word, &reversed(pair)).map(|k| (k, true)))
        });
        found.push(Three {
            columns,
            signals: VOLTAGES,
            is_line: true,
            takes_all: false,
        });
    }
    found.retain(|three| three.count() >= if three.takes_all { 3 } else { 2 });
    found.dedup_by(|a, b| a.columns == b.columns);
    found
}

/// `l2l1` of `l1l2`, `ba` of `ab`.
fn reversed(pair: &str) -> String {
    let (first, second) = pair.split_at(pair.len() / 2);
    match pair.len() {
        3 => format!("l{}{}", &pair[2..], &pair[1..2]),
        _ => format!("{second}{first}"),
    }
}

/// `u1`, `u1n`, `phaseavoltage`, `voltagephasea`, `ul1inst`.
fn find(names: &[String], word: &str, phase: &str) -> Option<usize> {
    let is = |name: &String| {
        let middle = name
            .strip_prefix(word)
            .and_then(|rest| rest.strip_prefix(phase));
        let behind = || {
            name.strip_prefix(phase)
                .and_then(|rest| rest.strip_prefix(word))
        };
        let rest = middle.or_else(|| behind().filter(|_| word.len() > 1));
        rest.is_some_and(|rest| matches!(rest, "" | "n" | "inst" | "ninst" | "actual" | "act"))
    };
    names.iter().position(is)
}

/// The single channel that a name means; `unit` is of which quantity its unit is, where it has one.
pub(crate) fn single(stem: &str, has_unit_of: impl Fn(Target) -> bool) -> Option<Target> {
    let name = plain(stem);
    let named = SINGLES
        .iter()
        .find(|(names, _)| names.contains(&name.as_str()));
    let lettered = || {
        WITH_UNIT
            .iter()
            .find(|(names, target)| names.contains(&name.as_str()) && has_unit_of(*target))
    };
    named.or_else(lettered).map(|(_, target)| *target)
}

/// The unit that a name itself is.
pub(crate) fn unit_in(stem: &str) -> Option<&'static str> {
    match plain(stem).as_str() {
        "rpm" | "nactrpm" => Some("rpm"),
        _ => None,
    }
}

/// Whether a column of this name can be a channel or the clock.
pub(crate) fn is_known(name: &str) -> bool {
    let plain = plain(name);
    let of_three = |words: &[&str], ends: &[[&str; 3]]| {
        words.iter().any(|word| {
            let mut ends = ends.iter().flatten();
            ends.any(|end| find(std::slice::from_ref(&plain), word, end).is_some())
        })
    };
    Target::parse(name).is_some()
        || single(name, |_| false).is_some()
        || of_three(&VOLTAGE, &PHASES)
        || of_three(&VOLTAGE, &PAIRS)
        || of_three(&CURRENT, &PHASES)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(names: &[&str]) -> Vec<Three> {
        threes(
            &names
                .iter()
                .map(|name| (*name).to_owned())
                .collect::<Vec<_>>(),
        )
    }

    #[test]
    fn phases_have_many_names() {
        for names in [
            ["Ua", "Ub", "Uc"],
            ["U L1", "U L2", "U L3"],
            ["V1N", "V2N", "V3N"],
            ["U_L1-N", "U_L2-N", "U_L3-N"],
            ["Voltage 1", "Voltage 2", "Voltage 3"],
            ["Phase A Voltage", "Phase B Voltage", "Phase C Voltage"],
        ] {
            let found = columns(&names);
            assert_eq!(found.len(), 1, "{names:?} {found:?}");
            let all = [0, 1, 2].map(|k| Some((k, false)));
            assert_eq!(
                (found[0].columns, found[0].is_line),
                (all, false),
                "{names:?}"
            );
        }
        assert_eq!(columns(&["I U", "I V", "I W"])[0].signals, CURRENTS);
        assert_eq!(columns(&["I1"]), []);
        assert_eq!(columns(&["ir", "is"]), []);
        assert_eq!(columns(&["ir", "is", "it"]).len(), 1);
    }

    #[test]
    fn a_line_voltage_may_be_turned_round() {
        let found = columns(&["U12", "U32"]);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].columns, [Some((0, false)), Some((1, true)), None]);
        assert!(found[0].is_line);
    }

    #[test]
    fn a_letter_needs_its_unit() {
        let speed = Target::Channel(Channel::SPEED);
        assert_eq!(single("n", |target| target == speed), Some(speed));
        assert_eq!(single("n", |_| false), None);
        assert_eq!(single("Drehzahl", |_| false), Some(speed));
        assert!(is_known("IL2") && is_known("Zeit") && !is_known("CH1") && !is_known("Comment"));
    }
}
