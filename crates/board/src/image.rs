//! The motor constants as they lie in flash: words with a schema version and a checksum, so that a
//! corrupted constant is noticed at power-up instead of being computed with.

mod healthy;

use healthy::{HEALTHY_WORDS, read_healthy, write_healthy};
use heapless::Vec;
use monitor::{
    Abc, ActiveEffect, ActiveEffects, ActiveLaws, AnalogueChain, CHANNELS, CIRCUIT, Cage,
    ChannelScale, ComparatorConfig, Converter, FieldCurrent, Frame, HealthySidebands, LoadKind,
    MAX_EFFECT_PARAMETERS, MAX_EFFECTS, MAX_LAWS, MonitorConfig, ParameterDoubt,
};
use motor::effect::SteadyEffect;
use motor::effect::curve::{Action, BOARD_KNOTS, SteadyCurve};
use motor::effects::STEADY;
use motor::{Mechanics, TParams};

use crate::checksum::{Checksum, crc32_words};

/// Words of an image, version and checksum included.
pub const IMAGE_WORDS: usize = 42
    + HEALTHY_WORDS
    + CAGE_WORDS
    + CIRCUIT
    + CHANNELS
    + CHAIN_WORDS
    + MAX_EFFECTS * (1 + 2 * MAX_EFFECT_PARAMETERS)
    + MAX_LAWS * LAW_WORDS;

/// Words of a law: where it acts, number of knots, mean, then knots, values and bends.
const LAW_WORDS: usize = 3 + 3 * BOARD_KNOTS;

/// Words of the analogue chain: delays and roll-off.
const CHAIN_WORDS: usize = CHANNELS + 1;

/// Words of the cage: bars, then healthy loads, sidebands and scatter.
const CAGE_WORDS: usize = 6;

/// Layout of the words; a different one gets a different number.
const SCHEMA: u32 = 0x444D_000D;

/// The monitor's configuration as words for flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotorImage(pub [u32; IMAGE_WORDS]);

/// Why an image cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageError {
    /// The checksum does not hold.
    Checksum,
    /// Written for another layout.
    Schema,
    /// A choice that this version does not know.
    Choice,
    /// An effect is switched on that this program does not know.
    Effects,
}

impl core::fmt::Display for ImageError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            ImageError::Checksum => "the checksum of the motor constants does not hold",
            ImageError::Schema => "the motor constants have another layout than this program",
            ImageError::Choice => "the motor constants hold an unknown frame, field or load",
            ImageError::Effects => {
                "the motor constants switch on an effect that this program lacks"
            }
        })
    }
}

impl core::error::Error for ImageError {}

impl MotorImage {
    /// Packs a configuration.
    pub fn new(config: &MonitorConfig) -> Self {
        let mut writer = Writer::default();
        writer.word(SCHEMA);
        write_measurement(&mut writer, config);
        write_motor(&mut writer, config);
        write_judgement(&mut writer, config);
        write_effects(&mut writer, config);
        config
            .laws
            .iter()
            .for_each(|law| write_law(&mut writer, law.as_ref()));
        let mut words = [0; IMAGE_WORDS];
        words
            .iter_mut()
            .zip(&writer.words)
            .for_each(|(place, word)| *place = *word);
        words[IMAGE_WORDS - 1] = crc32_words(&words[..IMAGE_WORDS - 1]);
        MotorImage(words)
    }

    /// What tells these constants from any others: their checksum.
    pub fn identification(&self) -> u32 {
        self.0[IMAGE_WORDS - 1]
    }

    /// Checks and unpacks an image. Ranges are checked by [`monitor::Monitor::new`].
    ///
    /// # Errors
    /// A wrong checksum, another layout, an unknown choice or effect.
    pub fn config(&self) -> Result<MonitorConfig, ImageError> {
        config_of(&self.0)
    }
}

/// The same of an image's words, wherever they lie.
pub(crate) fn config_of(words: &[u32; IMAGE_WORDS]) -> Result<MonitorConfig, ImageError> {
    let [content @ .., checksum] = words;
    if crc32_words(content) != *checksum {
        return Err(ImageError::Checksum);
    }
    let mut reader = Reader { words: content };
    if reader.word() != SCHEMA {
        return Err(ImageError::Schema);
    }
    let config = read(&mut reader)?;
    Ok(MonitorConfig {
        channel_gain: reader.numbers(),
        effects: effects(&mut reader)?,
        laws: laws(&mut reader)?,
        ..config
    })
}

fn write_measurement(w: &mut Writer, config: &MonitorConfig) {
    w.number(config.t_sample);
    w.scale(&config.converter.voltage);
    w.scale(&config.converter.current);
    let [voltage, current] = config.converter.ratiometric.map(u32::from);
    w.word(u32::from(config.converter.max_code) | voltage << 16 | current << 17);
    w.numbers(&config.converter.chain.delay);
    w.number(config.converter.chain.roll_off);
    w.number(config.encoder_counts_per_revolution);
}

fn write_motor(w: &mut Writer, config: &MonitorConfig) {
    let (p, m) = (&config.params, &config.mechanics);
    w.numbers(&[p.r_s, p.r_r, p.l_ls, p.l_lr, p.l_m]);
    w.numbers(&[m.n_p, m.inertia, m.friction, m.load_friction]);
    w.numbers(&[config.rated_voltage, config.rated_current]);
    w.numbers(&[config.rated_omega, config.rated_torque]);
}

fn write_judgement(w: &mut Writer, config: &MonitorConfig) {
    let frame = match config.frame {
        Frame::RotorFlux => 0,
        Frame::Voltage => 1,
    };
    let load = match config.load {
        LoadKind::Friction => 0,
        LoadKind::Measured => 1,
        LoadKind::Free => 2,
    };
    w.word(frame | load << 8 | (config.window_cycles as u32) << 16);
    // A field current is positive, so 0 stands for the live one.
    w.number(match config.field {
        FieldCurrent::Live => 0.0,
        FieldCurrent::Nominal(amp) => amp,
    });
    w.numbers(&config.thresholds);
    w.word(u32::from(config.comparator.persistence));
    w.number(config.comparator.hysteresis);
    write_healthy(w, config.healthy.as_ref());
    write_cage(w, &config.cage);
    w.numbers(&config.doubt.circuit);
    config
        .doubt
        .effects
        .iter()
        .for_each(|sigmas| w.numbers(sigmas));
}

fn read_doubt(r: &mut Reader<'_>) -> ParameterDoubt {
    let circuit = r.numbers();
    let mut doubt = ParameterDoubt {
        circuit,
        ..ParameterDoubt::default()
    };
    for sigmas in &mut doubt.effects {
        *sigmas = r.numbers();
    }
    doubt
}

/// A healthy load is positive, so 0 stands for sidebands that were not calibrated.
fn write_cage(w: &mut Writer, cage: &Cage) {
    w.number(cage.bars);
    let Some(healthy) = &cage.healthy else {
        w.numbers(&[0.0; CAGE_WORDS - 1]);
        return;
    };
    w.numbers(&healthy.at);
    w.numbers(&healthy.lower);
    w.number(healthy.scatter);
}

fn read_cage(r: &mut Reader<'_>) -> Cage {
    let bars = r.number();
    let healthy = HealthySidebands {
        at: r.numbers(),
        lower: r.numbers(),
        scatter: r.number(),
    };
    Cage {
        bars,
        healthy: (healthy.at[0] > 0.0).then_some(healthy),
    }
}

fn write_effects(w: &mut Writer, config: &MonitorConfig) {
    w.numbers(&config.channel_gain);
    for effect in &config.effects {
        w.word(effect.map_or(0, |active| number(active.effect)));
        w.numbers(&effect.map_or([0.0; MAX_EFFECT_PARAMETERS], |effect| effect.parameters));
    }
}

/// The first word of a law that is there is its action's number and one.
fn write_law(w: &mut Writer, law: Option<&SteadyCurve<f32>>) {
    let Some(law) = law else {
        (0..LAW_WORDS).for_each(|_| w.word(0));
        return;
    };
    let (knots, mean, curve) = law.words();
    w.word(law.action.number() + 1);
    w.word(knots as u32);
    w.number(mean);
    curve.iter().for_each(|numbers| w.numbers(numbers));
}

fn laws(r: &mut Reader<'_>) -> Result<ActiveLaws, ImageError> {
    let mut active = ActiveLaws::default();
    for slot in &mut active {
        let (number, knots, mean) = (r.word(), r.word() as usize, r.number());
        let curve = [r.numbers(), r.numbers(), r.numbers()];
        if let Some(number) = number.checked_sub(1) {
            let action = Action::by_number(number).ok_or(ImageError::Choice)?;
            *slot = Some(SteadyCurve::of_words(action, knots, mean, curve));
        }
    }
    Ok(active)
}

/// Checksum of name and form, never 0: the same in every version, whatever else joins the library.
fn number(effect: &dyn SteadyEffect) -> u32 {
    let known = effect.descriptor();
    let mut checksum = Checksum::new();
    checksum.update(known.name.as_bytes());
    checksum.update(b"/");
    checksum.update(known.form.as_bytes());
    checksum.finish().max(1)
}

fn effects(r: &mut Reader<'_>) -> Result<ActiveEffects, ImageError> {
    let mut active = ActiveEffects::default();
    for slot in &mut active {
        let (wanted, parameters) = (r.word(), r.numbers());
        if wanted != 0 {
            let found = STEADY.iter().find(|effect| number(**effect) == wanted);
            let effect = *found.ok_or(ImageError::Effects)?;
            *slot = Some(ActiveEffect { effect, parameters });
        }
    }
    Ok(active)
}

fn read(r: &mut Reader<'_>) -> Result<MonitorConfig, ImageError> {
    let t_sample = r.number();
    let (voltage, current, codes) = (r.scale(), r.scale(), r.word());
    let converter = Converter {
        voltage,
        current,
        max_code: codes as u16,
        ratiometric: [codes >> 16 & 1 == 1, codes >> 17 & 1 == 1],
        chain: AnalogueChain {
            delay: r.numbers(),
            roll_off: r.number(),
        },
    };
    let encoder_counts_per_revolution = r.number();
    let [r_s, r_r, l_ls, l_lr, l_m] = r.numbers();
    let [n_p, inertia, friction, load_friction] = r.numbers();
    let [rated_voltage, rated_current, rated_omega, rated_torque] = r.numbers();
    let (frame, load, window_cycles) = choices(r.word())?;
    Ok(MonitorConfig {
        t_sample,
        converter,
        encoder_counts_per_revolution,
        params: TParams {
            r_s,
            r_r,
            l_ls,
            l_lr,
            l_m,
        },
        effects: ActiveEffects::default(),
        laws: ActiveLaws::default(),
        channel_gain: [1.0; CHANNELS],
        mechanics: Mechanics {
            n_p,
            inertia,
            friction,
            load_friction,
        },
        rated_voltage,
        rated_current,
        rated_omega,
        rated_torque,
        frame,
        load,
        window_cycles,
        field: field(r.number()),
        thresholds: r.numbers(),
        comparator: ComparatorConfig {
            persistence: r.word() as u8,
            hysteresis: r.number(),
        },
        healthy: read_healthy(r),
        cage: read_cage(r),
        doubt: read_doubt(r),
    })
}

fn field(amp: f32) -> FieldCurrent {
    if amp > 0.0 {
        FieldCurrent::Nominal(amp)
    } else {
        FieldCurrent::Live
    }
}

fn choices(word: u32) -> Result<(Frame, LoadKind, usize), ImageError> {
    let frame = match word & 0xFF {
        0 => Frame::RotorFlux,
        1 => Frame::Voltage,
        _ => return Err(ImageError::Choice),
    };
    let load = match word >> 8 & 0xFF {
        0 => LoadKind::Friction,
        1 => LoadKind::Measured,
        2 => LoadKind::Free,
        _ => return Err(ImageError::Choice),
    };
    Ok((frame, load, (word >> 16) as usize))
}

/// Fills an image from the front; a word too many is dropped and shows in the round trip test.
#[derive(Default)]
struct Writer {
    words: Vec<u32, IMAGE_WORDS>,
}

impl Writer {
    fn word(&mut self, word: u32) {
        let _ = self.words.push(word);
    }

    fn number(&mut self, x: f32) {
        self.word(x.to_bits());
    }

    fn numbers(&mut self, numbers: &[f32]) {
        numbers.iter().for_each(|x| self.number(*x));
    }

    fn scale(&mut self, scale: &ChannelScale) {
        self.numbers(&[scale.unit_per_code, scale.zero_code]);
        self.numbers(&[scale.gain.a, scale.gain.b, scale.gain.c]);
        self.numbers(&[scale.offset.a, scale.offset.b, scale.offset.c]);
    }
}

struct Reader<'a> {
    words: &'a [u32],
}

impl Reader<'_> {
    fn word(&mut self) -> u32 {
        match self.words {
            [word, rest @ ..] => {
                self.words = rest;
                *word
            }
            [] => 0,
        }
    }

    fn number(&mut self) -> f32 {
        f32::from_bits(self.word())
    }

    fn numbers<const N: usize>(&mut self) -> [f32; N] {
        [(); N].map(|()| self.number())
    }

    fn scale(&mut self) -> ChannelScale {
        let [unit_per_code, zero_code] = self.numbers();
        ChannelScale {
            unit_per_code,
            zero_code,
            gain: Abc::from_array(self.numbers()),
            offset: Abc::from_array(self.numbers()),
        }
    }
}

#[cfg(test)]
mod tests;
