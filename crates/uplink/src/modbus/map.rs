//! The register map: what a motor shows, and where each motor's registers are.

use fleet::alarm::Severity;
use fleet::{MotorState, Second};

/// How a value lies in registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One register.
    Word,
    /// Two registers, high word first.
    Long,
    /// IEEE 754 single precision in two registers, high word first; NaN where there is no value.
    Float,
    /// So many registers of text, two characters each, filled up with 0.
    Text(u16),
}

impl Kind {
    /// Registers that a value takes.
    pub const fn words(self) -> u16 {
        match self {
            Kind::Word => 1,
            Kind::Long | Kind::Float => 2,
            Kind::Text(words) => words,
        }
    }
}

/// Names of the values, in the order of their addresses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // The map says it once, for the documentation too.
pub enum Field {
    MapVersion,
    Link,
    Age,
    Time,
    Start,
    Number,
    Lamps,
    Windows,
    WindowsJudged,
    NotJudged,
    LikelyFault,
    Residual1,
    Residual2,
    Residual3,
    Residual4,
    Voltage,
    Current,
    SupplyFrequency,
    Speed,
    LastEvent,
    OpenAlarms,
    WorstAlarm,
    Unacknowledged,
    Name,
}

/// One value of the map.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// What it is of.
    pub field: Field,
    /// How it is stored.
    pub kind: Kind,
    /// Unit, empty where there is none.
    pub unit: &'static str,
    /// What it says.
    pub meaning: &'static str,
}

const fn entry(field: Field, kind: Kind, unit: &'static str, meaning: &'static str) -> Entry {
    Entry {
        field,
        kind,
        unit,
        meaning,
    }
}

const FIELDS: usize = Field::Name as usize + 1;
/// Grows when an address changes its meaning.
pub const MAP_VERSION: u16 = 1;

/// Every register of a motor, in order of address.
pub const MAP: [Entry; FIELDS] = {
    use Kind::{Float, Long, Text, Word};
    [
        entry(
            Field::MapVersion,
            Word,
            "",
            "1; grows when an address changes its meaning",
        ),
        entry(
            Field::Link,
            Word,
            "",
            "0 the board does not answer, 1 it answers, 2 nobody has asked it yet",
        ),
        entry(
            Field::Age,
            Long,
            "s",
            "since the newest second; 4294967295: there is none. What follows is that old",
        ),
        entry(
            Field::Time,
            Long,
            "s",
            "of the newest second, Unix time by the gateway's clock",
        ),
        entry(
            Field::Start,
            Long,
            "",
            "run of the board's program: number of the first event of this start",
        ),
        entry(
            Field::Number,
            Long,
            "",
            "second since that start, from 1; 0: none yet",
        ),
        entry(
            Field::Lamps,
            Long,
            "",
            "two bits per lamp from the lowest, in the order RUN r1 r2 r3 r4 SENSOR LINE LOAD FAULT: 0 off, 1 on, 2 blinking; the most severe within the second",
        ),
        entry(Field::Windows, Word, "", "windows that ended in the second"),
        entry(Field::WindowsJudged, Word, "", "of these judged"),
        entry(
            Field::NotJudged,
            Word,
            "",
            "reason of the last one that was not judged, as the board's register; 0: all were",
        ),
        entry(
            Field::LikelyFault,
            Word,
            "",
            "number of the likely fault, as the board's register",
        ),
        entry(
            Field::Residual1,
            Float,
            "",
            "r1, mean of the second, share of its scale",
        ),
        entry(Field::Residual2, Float, "", "r2"),
        entry(Field::Residual3, Float, "", "r3"),
        entry(Field::Residual4, Float, "", "r4"),
        entry(Field::Voltage, Float, "V", "phase voltage, RMS"),
        entry(Field::Current, Float, "A", "phase current, RMS"),
        entry(Field::SupplyFrequency, Float, "Hz", "of the supply"),
        entry(Field::Speed, Float, "1/min", "of the shaft"),
        entry(
            Field::LastEvent,
            Long,
            "",
            "number of the board's newest event; 0: none yet",
        ),
        entry(
            Field::OpenAlarms,
            Word,
            "",
            "alarms that somebody has to look at; 65535: as many or more",
        ),
        entry(
            Field::WorstAlarm,
            Word,
            "",
            "the worst of them: 0 none, 1 low, 2 medium, 3 high",
        ),
        entry(
            Field::Unacknowledged,
            Word,
            "",
            "open alarms that nobody has acknowledged; 65535: as many or more",
        ),
        entry(Field::Name, Text(32), "", "name of the motor, ASCII"),
    ]
};

const ADDRESSES: [u16; FIELDS] = addresses();
/// Registers of a motor.
pub const WORDS: u16 = ADDRESSES[FIELDS - 1] + MAP[FIELDS - 1].kind.words();
/// From one motor's first register to the next one's, where many motors share a unit.
pub const BLOCK: u16 = 100;
/// Motors that share a unit.
pub const IN_A_UNIT: usize = 600;
/// Last unit; the first one is 1. Many masters can address no other ones.
pub const LAST_UNIT: u8 = 247;

/// Where each motor's registers are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// Motor N is unit N, from address 0.
    #[default]
    Own,
    /// Motors share units, [`IN_A_UNIT`] each, in steps of [`BLOCK`] registers.
    Shared,
}

impl Layout {
    /// Motors that have registers.
    pub const fn most(self) -> usize {
        self.in_a_unit() * LAST_UNIT as usize
    }

    const fn in_a_unit(self) -> usize {
        match self {
            Layout::Own => 1,
            Layout::Shared => IN_A_UNIT,
        }
    }
}

const fn addresses() -> [u16; FIELDS] {
    let mut addresses = [0; FIELDS];
    let mut k = 1;
    while k < FIELDS {
        addresses[k] = addresses[k - 1] + MAP[k - 1].kind.words();
        k += 1;
    }
    addresses
}

/// Address of a value's first register within a motor's, counted from 0 as on the wire.
pub const fn address(field: Field) -> u16 {
    ADDRESSES[field as usize]
}

/// All motors in the order of their numbers, as a master sees them.
#[derive(Clone, Debug, Default)]
pub struct Plant {
    layout: Layout,
    motors: Vec<Image>,
}

#[derive(Clone, Debug)]
struct Image {
    words: [u16; WORDS as usize],
    second_ms: Option<i64>,
}

impl Plant {
    /// The plant as the store knows it. Motors beyond [`Layout::most`] have no registers.
    pub fn new(motors: &[MotorState], layout: Layout) -> Plant {
        let motors = motors.iter().take(layout.most());
        Plant {
            layout,
            motors: motors.map(Image::new).collect(),
        }
    }

    /// Whether a unit has registers.
    pub fn has(&self, unit: u8) -> bool {
        !self.unit(unit).is_empty()
    }

    /// The motors of a unit.
    fn unit(&self, unit: u8) -> &[Image] {
        if !(1..=LAST_UNIT).contains(&unit) {
            return &[];
        }
        let most = self.layout.in_a_unit();
        let motors = self.motors.chunks(most).nth(usize::from(unit) - 1);
        motors.unwrap_or_default()
    }

    /// Registers of a unit; `None` where one of them does not exist. Between two motors' registers there are zeros.
    pub fn range(&self, unit: u8, first: u16, count: u16, now_ms: i64) -> Option<Vec<u16>> {
        let motors = self.unit(unit);
        let addresses = usize::from(first)..usize::from(first) + usize::from(count);
        let word = |at: usize| {
            let block = usize::from(BLOCK);
            let word = motors.get(at / block)?.word(at % block, now_ms);
            // Beyond the last motor's registers there is nothing.
            word.or_else(|| (at / block + 1 < motors.len()).then_some(0))
        };
        addresses.map(word).collect()
    }
}

impl Image {
    fn new(state: &MotorState) -> Image {
        let mut image = Image {
            words: [0; WORDS as usize],
            second_ms: state.last.as_ref().map(|second| second.time_ms),
        };
        image.long(Field::MapVersion, u32::from(MAP_VERSION));
        let link = state.link.as_ref().map_or(2, |link| u32::from(link.up));
        image.long(Field::Link, link);
        image.long(Field::LastEvent, state.last_event);
        image.long(
            Field::OpenAlarms,
            state.open_alarms.min(u32::from(u16::MAX)),
        );
        image.long(
            Field::Unacknowledged,
            state.unacknowledged.min(u32::from(u16::MAX)),
        );
        image.long(Field::WorstAlarm, state.worst.map_or(0, severity));
        image.name(state.info.id.as_str());
        match &state.last {
            Some(second) => image.second(second),
            None => image.numbers([None; 4], [None; 4]),
        }
        image
    }

    fn second(&mut self, second: &Second) {
        let time = u32::try_from(second.time_ms / 1_000).unwrap_or(0);
        self.long(Field::Time, time);
        self.long(Field::Start, second.start);
        self.long(Field::Number, second.number);
        self.long(Field::Lamps, second.lamps);
        self.long(Field::Windows, u32::from(second.windows));
        self.long(Field::WindowsJudged, u32::from(second.judged));
        self.long(Field::NotJudged, u32::from(second.not_judged));
        self.long(Field::LikelyFault, u32::from(second.fault));
        let residuals = second.residuals.map_or([None; 4], |all| all.map(Some));
        let measured = [
            second.voltage_v,
            second.current_a,
            second.frequency_hz,
            second.speed_rpm,
        ];
        self.numbers(residuals, measured);
    }

    fn numbers(&mut self, residuals: [Option<f32>; 4], measured: [Option<f32>; 4]) {
        let fields = [
            Field::Residual1,
            Field::Residual2,
            Field::Residual3,
            Field::Residual4,
            Field::Voltage,
            Field::Current,
            Field::SupplyFrequency,
            Field::Speed,
        ];
        for (field, value) in fields
            .into_iter()
            .zip(residuals.into_iter().chain(measured))
        {
            self.long(field, value.unwrap_or(f32::NAN).to_bits());
        }
    }

    /// Sets a value of one or two registers.
    fn long(&mut self, field: Field, value: u32) {
        let first = usize::from(address(field));
        match MAP[field as usize].kind {
            Kind::Word => self.words[first] = value as u16,
            _ => {
                self.words[first..first + 2].copy_from_slice(&[(value >> 16) as u16, value as u16])
            }
        }
    }

    fn name(&mut self, name: &str) {
        let first = usize::from(address(Field::Name));
        for (k, byte) in name.bytes().enumerate().take(64) {
            let high = if k % 2 == 0 { 8 } else { 0 };
            self.words[first + k / 2] |= u16::from(byte) << high;
        }
    }

    fn word(&self, at: usize, now_ms: i64) -> Option<u16> {
        match at.checked_sub(usize::from(address(Field::Age))) {
            Some(0) => Some((self.age_s(now_ms) >> 16) as u16),
            Some(1) => Some(self.age_s(now_ms) as u16),
            _ => self.words.get(at).copied(),
        }
    }

    fn age_s(&self, now_ms: i64) -> u32 {
        let age = self
            .second_ms
            .map(|then| now_ms.saturating_sub(then).max(0) / 1_000);
        age.map_or(u32::MAX, |age| u32::try_from(age).unwrap_or(u32::MAX - 1))
    }
}

fn severity(severity: Severity) -> u32 {
    match severity {
        Severity::Low => 1,
        Severity::Medium => 2,
        Severity::High => 3,
    }
}
