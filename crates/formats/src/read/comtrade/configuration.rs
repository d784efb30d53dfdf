//! The configuration: which channels, which rates, which kind of data.

use super::lines::{Line, Lines, text};
use recording::Error;

/// What a `.cfg` says, as far as it matters here.
pub(super) struct Configuration {
    /// Year of the standard: 1991, 1999 or 2013.
    pub revision: u32,
    /// The analogue channels in the order of the data.
    pub analogs: Vec<Analog>,
    /// Number of status channels.
    pub digitals: usize,
    /// Rate, Hz, and number of the last sample of each part; none where the time stamps count.
    pub rates: Vec<(f64, u64)>,
    /// How the samples are written.
    pub kind: DataKind,
    /// One step of a time stamp, s.
    pub stamp_s: f64,
}

/// How the samples are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DataKind {
    /// Text.
    Ascii,
    /// Two bytes.
    Binary16,
    /// Four bytes.
    Binary32,
    /// Four bytes, IEEE 754.
    Float32,
}

/// An analogue channel.
pub(super) struct Analog {
    /// `ch_id`.
    pub name: String,
    /// `uu`.
    pub unit: String,
    factor: f64,
    offset: f64,
    /// `max`, the largest code that the recorder writes, if it says so.
    pub largest: Option<f64>,
    /// What leads from the values to the primary side.
    pub side: Side,
}

/// Which side of a transformer the values belong to.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Side {
    /// The primary one, or there is no transformer.
    Primary,
    /// The secondary one; primary over secondary.
    Secondary(f64),
    /// The secondary one, and the ratio, as written in the file, is not a number.
    Unknown(String),
}

/// More channels than any recorder has.
const MOST_CHANNELS: usize = 10_000;
/// More parts of different rates than any recorder writes.
const MOST_RATES: usize = 1_000;

impl Configuration {
    /// Parses the text of a `.cfg`; `name` is the file that errors name.
    ///
    /// # Errors
    /// A line that does not hold what the standard says, with the field's name there.
    pub fn parse(name: &str, bytes: &[u8]) -> Result<Configuration, Error> {
        let text = text(bytes);
        let mut lines = Lines::new(name, &text);
        let station = lines.next("the station")?;
        let revision = station.text(2).parse().unwrap_or(1991);
        let counts = lines.next("the number of channels")?;
        let analogs = counts.count_before(1, "##A", "A")?;
        let digitals = counts.count_before(2, "##D", "D")?;
        if analogs.saturating_add(digitals) > MOST_CHANNELS {
            return Err(counts.wrong("TT", counts.text(0), "a number of channels up to 10000"));
        }
        let analogs = (0..analogs).map(|_| analog(&mut lines));
        let analogs = analogs.collect::<Result<Vec<_>, _>>()?;
        for _ in 0..digitals {
            lines.next("its last status channel")?;
        }
        lines.next("the line frequency")?;
        let rates = rates(&mut lines)?;
        let start = lines.next("the time of the first sample")?;
        lines.next("the time of the trigger")?;
        let kind = kind(&mut lines)?;
        let factor = time_factor(&mut lines)?;
        // Nine decimals of a second: the stamps count nanoseconds (2013, 7.4.8).
        let nanoseconds = start
            .text(1)
            .split('.')
            .nth(1)
            .is_some_and(|part| part.len() > 6);
        let step = if nanoseconds && revision >= 2013 {
            1e-9
        } else {
            1e-6
        };
        Ok(Configuration {
            revision,
            analogs,
            digitals,
            rates,
            kind,
            stamp_s: step * factor,
        })
    }

    /// How many samples there should be; 0 where the configuration does not say.
    pub fn declared_samples(&self) -> u64 {
        self.rates.last().map_or(0, |(_, last)| *last)
    }

    /// Bytes of status channels in a binary record.
    pub fn digital_bytes(&self) -> usize {
        2 * self.digitals.div_ceil(16)
    }

    /// Bytes that a record has at least: in text one per field and its separator.
    pub fn fewest_bytes(&self) -> usize {
        let channels = self.analogs.len();
        match self.kind {
            DataKind::Ascii => 2 + channels,
            DataKind::Binary16 => 8 + 2 * channels + self.digital_bytes(),
            DataKind::Binary32 | DataKind::Float32 => 8 + 4 * channels + self.digital_bytes(),
        }
    }
}

/// `An,ch_id,ph,ccbm,uu,a,b,skew,min,max,primary,secondary,PS`
fn analog(lines: &mut Lines<'_>) -> Result<Analog, Error> {
    let line = lines.next("its last analogue channel")?;
    if line.len() < 7 {
        let wanted = "a channel: An,ch_id,ph,ccbm,uu,a,b,skew,min,max,primary,secondary,PS";
        return Err(line.wrong(line.text(1), line.text(0), wanted));
    }
    let offset = match line.text(6) {
        "" => 0.0,
        _ => line.number(6, "b")?,
    };
    Ok(Analog {
        name: line.text(1).to_owned(),
        unit: line.text(4).to_owned(),
        factor: line.number(5, "a")?,
        offset,
        largest: line.text(9).parse().ok(),
        side: side(&line),
    })
}

fn side(line: &Line<'_>) -> Side {
    if !line.text(12).eq_ignore_ascii_case("S") {
        return Side::Primary;
    }
    let (primary, secondary) = (line.text(10), line.text(11));
    let positive = |text: &str| text.parse().ok().filter(|x: &f64| *x > 0.0);
    let ratio = positive(primary).zip(positive(secondary));
    let ratio = ratio.map(|(primary, secondary): (f64, f64)| primary / secondary);
    match ratio.filter(|ratio| ratio.is_normal()) {
        Some(ratio) => Side::Secondary(ratio),
        None => Side::Unknown(format!("{primary}/{secondary}")),
    }
}

fn rates(lines: &mut Lines<'_>) -> Result<Vec<(f64, u64)>, Error> {
    let line = lines.next("the number of sampling rates")?;
    let count = line.count(0, "nrates")?;
    if count > MOST_RATES {
        return Err(line.wrong("nrates", line.text(0), "a number of rates up to 1000"));
    }
    // Without a rate there still is one line, with the number of the last sample.
    let mut rates = Vec::new();
    for _ in 0..count.max(1) {
        let line = lines.next("its last sampling rate")?;
        let (rate, last) = (line.number(0, "samp")?, line.count(1, "endsamp")?);
        if rate < 0.0 {
            return Err(line.wrong("samp", line.text(0), "a rate in Hz"));
        }
        rates.push((rate, last as u64));
    }
    Ok(rates)
}

fn kind(lines: &mut Lines<'_>) -> Result<DataKind, Error> {
    let line = lines.next("the kind of data")?;
    let text = line.text(0);
    match text.to_ascii_uppercase().as_str() {
        "ASCII" => Ok(DataKind::Ascii),
        "BINARY" => Ok(DataKind::Binary16),
        "BINARY32" => Ok(DataKind::Binary32),
        "FLOAT32" => Ok(DataKind::Float32),
        _ => Err(line.wrong("ft", text, "ASCII, BINARY, BINARY32 or FLOAT32")),
    }
}

fn time_factor(lines: &mut Lines<'_>) -> Result<f64, Error> {
    match lines.optional().filter(|line| !line.text(0).is_empty()) {
        None => Ok(1.0),
        Some(line) => {
            let factor = line.number(0, "timemult")?;
            match factor > 0.0 {
                true => Ok(factor),
                false => Err(line.wrong("timemult", line.text(0), "a factor above 0")),
            }
        }
    }
}

impl Analog {
    /// The primary value of a raw one, in the channel's unit; NaN stays NaN.
    pub fn value(&self, raw: f64) -> f64 {
        let ratio = match self.side {
            Side::Secondary(ratio) => ratio,
            Side::Primary | Side::Unknown(_) => 1.0,
        };
        (self.factor * raw + self.offset) * ratio
    }
}
