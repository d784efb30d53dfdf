//! Which configuration holds: compiled in, confirmed, or on trial.

use embedded_storage::nor_flash::NorFlash;

use super::store::ConfigurationStore;
use super::{Configuration, Line, Refused};
use crate::door::relay::RelayMode;
use crate::image::MotorImage;

/// How long a configuration that nobody confirms stays on trial, s.
pub const TRIAL_S: u32 = 60;

/// What was compiled into the program.
#[derive(Clone, Copy, Debug)]
pub struct Compiled {
    /// Name of the motor.
    pub name: &'static str,
    /// Constants of motor, sensors and lamps.
    pub image: &'static MotorImage,
    /// The board's sampling time, s.
    pub t_sample: f32,
}

/// Where the configuration comes from. The numbers are those of the Modbus register.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u16)]
pub enum ConfigurationSource {
    /// Compiled in; nothing was ever confirmed.
    #[default]
    CompiledIn = 0,
    /// Confirmed.
    Confirmed = 1,
    /// On trial.
    Trial = 2,
    /// Line and relay as confirmed; the motor constants compiled in, because the program was flashed with others since, or cannot compute
    /// with those that were confirmed.
    OtherProgram = 3,
    /// Compiled in, because nothing that was confirmed is whole.
    Lost = 4,
}

/// Decides which configuration holds, and remembers it.
pub struct Configurator<F> {
    compiled: Compiled,
    store: Option<ConfigurationStore<F>>,
    source: ConfigurationSource,
    /// The button was held at power-up: the line is the one that a new board has, until somebody configures it.
    factory_line: bool,
    trial_until_s: Option<u32>,
    refused: Option<Refused>,
}

impl<F: NorFlash> Configurator<F> {
    /// Nothing is looked up yet.
    pub fn new(
        compiled: Compiled,
        store: Option<ConfigurationStore<F>>,
        factory_line: bool,
    ) -> Self {
        Configurator {
            compiled,
            store,
            source: ConfigurationSource::CompiledIn,
            factory_line,
            trial_until_s: None,
            refused: None,
        }
    }

    /// Looks up the configuration that holds without a trial.
    #[inline(never)]
    pub fn standing(&mut self, into: &mut Configuration) {
        self.source = self.confirmed(into);
        if self.factory_line {
            into.set_line(Line::default());
        }
    }

    fn confirmed(&mut self, into: &mut Configuration) -> ConfigurationSource {
        let loaded = self.store.as_mut().and_then(|store| store.load(into).ok());
        let known = loaded.unwrap_or_default();
        let (Some(base), Ok(line)) = (known.compiled, into.line()) else {
            let lost = known.damaged || known.compiled.is_some();
            self.compile(into, Line::default(), RelayMode::default());
            return match lost {
                true => ConfigurationSource::Lost,
                false => ConfigurationSource::CompiledIn,
            };
        };
        let same_program = base == self.compiled.image.identification();
        if same_program && into.check(self.compiled.t_sample).is_ok() {
            return ConfigurationSource::Confirmed;
        }
        let relay = into.relay().unwrap_or_default();
        self.compile(into, line, relay);
        ConfigurationSource::OtherProgram
    }

    fn compile(&self, into: &mut Configuration, line: Line, relay: RelayMode) {
        into.set_line(line);
        into.set_relay(relay);
        into.set_motor(self.compiled.name, self.compiled.image);
    }

    /// Checks what a master has written and begins its trial; `false` where it is refused.
    #[inline(never)]
    pub fn commit(&mut self, staged: &Configuration, now_s: u32) -> bool {
        self.refused = staged.check(self.compiled.t_sample).err();
        if self.refused.is_none() {
            self.begin_trial(now_s);
        }
        self.refused.is_none()
    }

    /// Begins the trial of the motor that is compiled in; line and relay stay as they are in `holds`.
    pub fn commit_compiled(&mut self, holds: &mut Configuration, now_s: u32) {
        self.refused = None;
        self.begin_trial(now_s);
        holds.set_motor(self.compiled.name, self.compiled.image);
    }

    fn begin_trial(&mut self, now_s: u32) {
        self.source = ConfigurationSource::Trial;
        self.trial_until_s = Some(now_s.wrapping_add(TRIAL_S));
        self.factory_line = false;
    }

    /// Whether something is on trial that can be confirmed; where nothing is, that is why a confirmation was refused.
    pub fn awaits_confirmation(&mut self) -> bool {
        if self.trial_until_s.is_none() {
            self.refused = Some(Refused::NoTrial);
        }
        self.trial_until_s.is_some()
    }

    /// Stores what is on trial; whether it is stored. Takes up to 40 ms.
    #[inline(never)]
    pub fn confirm(&mut self, holds: &Configuration) -> bool {
        if !self.awaits_confirmation() {
            return false;
        }
        let compiled = self.compiled.image.identification();
        let saved = self.store.as_mut().map(|store| store.save(compiled, holds));
        if !matches!(saved, Some(Ok(()))) {
            self.refused = Some(Refused::Flash);
            return false;
        }
        (self.refused, self.trial_until_s) = (None, None);
        self.source = ConfigurationSource::Confirmed;
        true
    }

    /// Ends a trial at once and looks up what held before it; `false` where there is none.
    pub fn discard(&mut self, into: &mut Configuration) -> bool {
        let ends = self.trial_until_s.take().is_some();
        if ends {
            self.standing(into);
        }
        ends
    }

    /// Ends a trial that nobody has confirmed and looks up what held before it; `false` while there is nothing to end.
    pub fn look(&mut self, now_s: u32, into: &mut Configuration) -> bool {
        self.seconds_left(now_s) == Some(0) && self.discard(into)
    }

    /// Seconds until a trial ends; `None` where there is none.
    pub fn seconds_left(&self, now_s: u32) -> Option<u32> {
        let left = self.trial_until_s?.wrapping_sub(now_s);
        Some(if left > TRIAL_S { 0 } else { left })
    }

    /// Where the configuration comes from.
    pub fn source(&self) -> ConfigurationSource {
        self.source
    }

    /// Why the last one was refused.
    pub fn refused(&self) -> Option<Refused> {
        self.refused
    }
}

#[cfg(test)]
mod tests;
