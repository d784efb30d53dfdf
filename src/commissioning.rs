//! Learning on the running motor, and what flash knows from earlier learning.

use board::modbus::BoardStatus;
use board::{
    Calibration, CalibrationSource, Configuration, Doubts, LearnState, Learner, Loaded, Overrides,
    Progress, Refusal,
};
use monitor::{Monitor, MonitorConfig, Report};

use crate::hardware::flash_store::FlashStore;

/// The motor file's configuration, the calibration that stands over it, and learning.
pub struct Commissioning {
    factory: Option<MonitorConfig>,
    motor: u32,
    store: Option<FlashStore>,
    learner: Option<Learner>,
    source: CalibrationSource,
    /// Of the calibration that is used; 0 where there is none.
    identification: u32,
    learning: LearnState,
    /// A person has seen that something is wrong with the calibration or with learning.
    acknowledged: bool,
}

impl Commissioning {
    /// Knows no motor yet.
    pub fn new(store: Option<FlashStore>) -> Self {
        Commissioning {
            factory: None,
            motor: 0,
            store,
            learner: None,
            source: CalibrationSource::CompiledIn,
            identification: 0,
            learning: LearnState::Idle,
            acknowledged: false,
        }
    }

    /// Takes a motor's constants. What was being learnt was learnt with others.
    pub fn set_motor(&mut self, holds: &Configuration) {
        self.factory = holds.config();
        self.motor = holds.identification();
        self.learner = None;
        self.learning = LearnState::Idle;
        self.acknowledged = false;
    }

    /// Writes what Modbus tells about it.
    pub fn describe(&self, status: &mut BoardStatus) {
        status.motor = self.motor;
        status.calibration = self.source;
        status.calibration_identification = self.identification;
        status.learning = self.learning;
        status.learned_windows = self.learner.as_ref().map_or(0, Learner::windows) as u16;
    }

    /// Which values are computed with.
    pub fn source(&self) -> CalibrationSource {
        self.source
    }

    /// How learning stands.
    pub fn learning(&self) -> LearnState {
        self.learning
    }

    /// What tells the calibration that is used from others; 0 where there is none.
    pub fn calibration_identification(&self) -> u32 {
        self.identification
    }

    /// What tells the motor's constants from others.
    pub fn motor(&self) -> u32 {
        self.motor
    }

    /// A monitor with the calibration in flash, or without it where it does not hold; `None` when the motor's constants do not
    /// hold themselves.
    #[inline(never)]
    pub fn monitor(&mut self) -> Option<Monitor> {
        let mut config = self.factory?;
        self.source = self.calibrate(&mut config);
        defmt::info!("calibration: {=u8}", self.source as u8);
        Monitor::new(config).ok()
    }

    /// Puts the calibration in flash over the motor file's values, if it is whole, this motor's and within its ranges.
    #[inline(never)]
    fn calibrate(&mut self, config: &mut MonitorConfig) -> CalibrationSource {
        let loaded = self.store.as_mut().and_then(|store| store.load().ok());
        self.identification = 0;
        match loaded {
            Some(Loaded {
                newest: None,
                lost: false,
            }) => CalibrationSource::CompiledIn,
            Some(Loaded {
                newest: Some(calibration),
                ..
            }) if calibration.motor != self.motor => CalibrationSource::OtherMotor,
            Some(Loaded {
                newest: Some(calibration),
                ..
            }) if calibration.apply_checked(config) => {
                self.identification = calibration.identification();
                CalibrationSource::Flash
            }
            _ => CalibrationSource::Lost,
        }
    }

    /// Begins to learn, anew where it was learning already. A board that doubts itself learns nothing.
    pub fn begin(&mut self, doubts: Doubts) {
        self.acknowledged = false;
        if doubts.is_any() {
            self.refuse(Refusal::Instrument);
            return;
        }
        defmt::info!("learning");
        self.learner = Some(Learner::new(self.motor));
        self.learning = LearnState::Learning;
    }

    /// A person has seen the lamps.
    pub fn acknowledge(&mut self) {
        self.acknowledged = true;
    }

    /// Takes a report; a calibration comes out of the last one that learning needs.
    #[inline(never)]
    pub fn observe(
        &mut self,
        report: &Report,
        monitor: &Monitor,
        doubts: Doubts,
    ) -> Option<Calibration> {
        let learner = self.learner.as_mut()?;
        if doubts.is_any() {
            self.refuse(Refusal::Instrument);
            return None;
        }
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

    /// What the panel shows about learning and calibration; a refusal and an ignored calibration until they are acknowledged.
    pub fn overrides(&self, doubts: Doubts, noticed: bool) -> Overrides {
        Overrides {
            instrument_faulty: doubts.stop_judging(),
            noticed,
            learning: self.learner.is_some(),
            refused: !self.acknowledged && matches!(self.learning, LearnState::Refused(_)),
            calibration_ignored: !self.acknowledged && self.source.is_ignored(),
        }
    }
}
