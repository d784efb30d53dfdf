//! Learning on the running motor, and what flash knows from earlier learning.

use board::{
    Calibration, CalibrationSource, EffectTerms, LearnState, Learner, Loaded, MotorImage, Progress,
    Refusal,
};
use monitor::{Lamp, Lamps, Monitor, MonitorConfig, Report};

use crate::hardware::flash_store::FlashStore;

/// The motor file's configuration, the calibration that stands over it, and learning.
pub struct Commissioning {
    factory: Option<MonitorConfig>,
    motor: u32,
    store: Option<FlashStore>,
    learner: Option<Learner>,
    source: CalibrationSource,
    learning: LearnState,
    /// A person has seen that something is wrong with the calibration or with learning.
    acknowledged: bool,
}

impl Commissioning {
    /// Takes the compiled-in constants and the steady-state terms of their effects.
    pub fn new(image: &MotorImage, terms: &EffectTerms, store: Option<FlashStore>) -> Self {
        Commissioning {
            factory: image.config(terms).ok(),
            motor: image.identification(),
            store,
            learner: None,
            source: CalibrationSource::CompiledIn,
            learning: LearnState::Idle,
            acknowledged: false,
        }
    }

    /// Where the calibration comes from, and how learning stands.
    pub fn state(&self) -> (CalibrationSource, LearnState) {
        (self.source, self.learning)
    }

    /// A monitor with the calibration in flash, or without it where it does not hold; `None` when the compiled-in
    /// constants do not hold themselves.
    #[inline(never)]
    pub fn monitor(&mut self) -> Option<Monitor> {
        let factory = self.factory?;
        let plain = Monitor::new(factory).ok()?;
        let loaded = self.store.as_mut().and_then(|store| store.load().ok());
        let (source, calibrated) = self.choose(&factory, loaded);
        self.source = source;
        defmt::info!("calibration: {=u8}", source as u8);
        Some(calibrated.unwrap_or(plain))
    }

    fn choose(
        &self,
        factory: &MonitorConfig,
        loaded: Option<Loaded>,
    ) -> (CalibrationSource, Option<Monitor>) {
        let Some(Loaded { newest, lost }) = loaded else {
            return (CalibrationSource::Lost, None);
        };
        match newest {
            None if lost => (CalibrationSource::Lost, None),
            None => (CalibrationSource::CompiledIn, None),
            Some(calibration) if calibration.motor != self.motor => {
                (CalibrationSource::OtherMotor, None)
            }
            Some(calibration) => match calibrated(factory, &calibration) {
                Some(monitor) => (CalibrationSource::Flash, Some(monitor)),
                None => (CalibrationSource::Lost, None),
            },
        }
    }

    /// Begins to learn, anew where it was learning already.
    pub fn begin(&mut self) {
        defmt::info!("learning");
        self.learner = Some(Learner::new(self.motor));
        self.learning = LearnState::Learning;
        self.acknowledged = false;
    }

    /// A person has seen the lamps.
    pub fn acknowledge(&mut self) {
        self.acknowledged = true;
    }

    /// Takes a report; a calibration comes out of the last one that learning needs.
    #[inline(never)]
    pub fn observe(&mut self, report: &Report, monitor: &Monitor) -> Option<Calibration> {
        let learner = self.learner.as_mut()?;
        let factory = self.factory.as_ref()?;
        match learner.observe(report, monitor.config(), &factory.thresholds) {
            Progress::Learning => None,
            Progress::Learnt(calibration) => {
                self.learner = None;
                Some(calibration)
            }
            Progress::Refused(refusal) => {
                self.refuse(refusal);
                None
            }
        }
    }

    fn refuse(&mut self, refusal: Refusal) {
        defmt::warn!("nothing learnt: {=u8}", refusal as u8);
        self.learner = None;
        self.learning = LearnState::Refused(refusal);
    }

    /// Writes a calibration to flash. Takes up to 50 ms, in which nothing is sampled.
    #[inline(never)]
    pub fn store(&mut self, calibration: &Calibration) {
        let saved = self.store.as_mut().map(|store| store.save(calibration));
        match saved {
            Some(Ok(())) => self.learning = LearnState::Stored,
            _ => self.refuse(Refusal::Store),
        }
    }

    /// What the panel shows about learning: r1..r4 blink while it lasts, FAULT after a refusal, SENSOR where a calibration
    /// was ignored; the latter two until they are acknowledged.
    #[inline(never)]
    pub fn overlay(&self, lamps: &Lamps) -> Lamps {
        let mut shown = *lamps;
        if self.learner.is_some() {
            shown.r = [Lamp::Blink; 4];
        }
        if self.acknowledged {
            return shown;
        }
        if matches!(self.learning, LearnState::Refused(_)) && shown.fault == Lamp::Off {
            shown.fault = Lamp::Blink;
        }
        if self.source.is_ignored() && shown.sensor == Lamp::Off {
            shown.sensor = Lamp::Blink;
        }
        shown
    }
}

fn calibrated(factory: &MonitorConfig, calibration: &Calibration) -> Option<Monitor> {
    Monitor::new(board::calibrated(factory, calibration).ok()?).ok()
}
