//! All peripherals together, and what happens when.

mod acquisition;
pub(crate) mod bus;
mod clocks;
pub(crate) mod relay;
mod sensing;

use monitor::RawSample;

use acquisition::{Taking, Writes};
use sensing::Sensing;

use crate::peripherals::adc::Adc;
use crate::peripherals::backup::Backup;
use crate::peripherals::dma::{Dma, Transfer};
use crate::peripherals::flash::Flash;
use crate::peripherals::gpio::Port as Gpio;
use crate::peripherals::iwdg::Iwdg;
use crate::peripherals::nvic::Nvic;
use crate::peripherals::rcc::{Cause, Rcc};
use crate::peripherals::registers::{Registers, Unmodelled};
use crate::peripherals::timer::Timer;
use crate::peripherals::usart::Usart;

/// What the sensors deliver.
pub trait Inputs {
    /// Codes of single conversions, 100 us times `index` after the first look; called with growing indices, some of which may be
    /// left out. Between them the pins follow straight lines, which take (w 100 us)^2/12 from a sinusoid: 0.012 % at 60 Hz.
    fn at(&mut self, index: u64) -> RawSample;

    /// What is added to the straight lines in a channel (voltages a, b, c, then currents a, b, c) `t` seconds after the first
    /// look, in codes: what is too fast for them, such as the carrier of an inverter.
    fn ripple(&mut self, channel: usize, t: f64) -> f64 {
        let _ = (channel, t);
        0.0
    }
}

/// A serial port, as docs/wiring.md names them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// RS-485.
    Modbus,
    /// The virtual COM port.
    Frames,
}

/// What was counted since power-up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Instructions executed; code whose condition failed inside an IT block counts too.
    pub instructions: u64,
    /// Emulated time, in units of 1/[`crate::TICK_HZ`] s.
    pub ticks: u64,
    /// Samples of which every conversion was made: sixteen sequences each.
    pub conversions: u64,
    /// Triggers that came while the converter was not ready.
    pub missed_triggers: u64,
    /// Resets other than the first power-up.
    pub resets: u64,
    /// Exceptions taken.
    pub exceptions: u64,
}

pub(crate) const IRQ_DMA1_CH1: usize = 11;
pub(crate) const IRQ_TIM15: usize = 24;
const IRQ_TIM3: usize = 29;
const IRQ_USART1: usize = 37;
const IRQ_LPUART1: usize = 91;
/// Request lines of the multiplexer (RM0440, table of DMAMUX inputs).
const LINE_ADC1: u32 = 5;
const LINE_TIM4_UP: u32 = 71;
const LINE_LPUART1_TX: u32 = 35;
/// Hz of the low-speed oscillator.
const LSI_HZ: u64 = 32_000;
/// ADC5's channel of the reference.
const VREFINT_CHANNEL: u32 = 18;
/// ADC5's channel of the temperature sensor, and its codes at 30 and 130 degrees Celsius (3.0 V).
const TEMPERATURE_CHANNEL: u32 = 4;
pub(crate) const TS_CAL_30: u16 = 1037;
pub(crate) const TS_CAL_130: u16 = 1379;
/// Factory value of the reference: its code at 3.0 V (1.208 V); at 3.3 V it is a whole code too, so that a nominal supply is measured as
/// nominal.
pub(crate) const VREFINT_CAL: u16 = 1650;

#[derive(Clone)]
pub(crate) struct Machine {
    pub now: u64,
    /// When the caller wants to look at it.
    pub until: u64,
    pub rcc: Rcc,
    pub ports: [Gpio; 7],
    pub tim3: Timer,
    pub tim4: Timer,
    pub tim15: Timer,
    pub usart1: Usart,
    pub lpuart1: Usart,
    pub adc1: Adc,
    pub adc5: Adc,
    pub common: [Registers; 2],
    pub dma: Dma,
    pub nvic: Nvic,
    pub iwdg: Iwdg,
    pub flash: Flash,
    pub backup: Backup,
    pub relay: relay::Relay,
    /// Frequency of the low-speed oscillator, Hz: 32 000 within 8 %.
    pub lsi_hz: u64,
    /// Units of time per core cycle; `None` while the clock stands.
    pub cycle: Option<u64>,
    /// Half cycles per instruction: wait states and long instructions, as a mean.
    pub half_cycles: u64,
    /// What resets the chip when power fails within a step of flash.
    pub flash_failure: Cause,
    pub pwr: Registers,
    pub syscfg: Registers,
    pub exti: Registers,
    pub dbgmcu: Registers,
    pub sensing: Sensing,
    /// The encoder's count at the last trigger.
    pub count: u16,
    taking: Taking,
    /// What DMA carried to memory and memory has not got yet.
    pub writes: Writes,
    /// Every sample whose conversions are made, in order; `None` when they are not recorded.
    pub taken: Option<Vec<RawSample>>,
    /// Converter supply, mV.
    pub vdda_millivolt: u32,
    /// What the voltage detector sees, mV, where it is not the converters' supply.
    pub detector_millivolt: Option<u32>,
    /// Temperature of the chip, degrees Celsius.
    pub temperature_degc: f64,
    pub tally: Tally,
    pub event_register: bool,
    pub failure: Option<String>,
    /// Address that the instruction could not reach.
    pub unreachable: Option<u32>,
    /// The program jumped to where memory protection forbids to execute.
    pub executed_forbidden: bool,
    /// Faults since power-up: status and program counter.
    pub faults: Vec<(u32, u32)>,
    /// A word of the RAM was read whose parity does not hold.
    pub parity_failed: bool,
    pub stop: bool,
    pub next_event: u64,
    /// DMA answers no request.
    pub dma_blocked: bool,
    /// Requests of the encoder's DMA that will not be answered.
    pub lost_encoder_requests: u32,
    /// Cycles between spurious interrupts of a DMA channel, and the cycle of the next one.
    pub spurious: Option<(u64, u64)>,
    /// Instructions by address of their block, while somebody asks for them.
    pub profile: Option<std::collections::HashMap<u64, u64>>,
}

const PWR: &[(u32, u32)] = &[
    (0x00, 0x0208),
    (0x04, 0),
    (0x08, 0x8000),
    (0x0C, 0),
    (0x10, 0),
    (0x14, 0),
    (0x18, 0),
    (0x80, 0x100),
];
const SYSCFG: &[(u32, u32)] = &[
    (0x00, 0),
    (0x04, 0),
    (0x08, 0),
    (0x0C, 0),
    (0x10, 0),
    (0x14, 0),
    (0x1C, 0),
];
const EXTI: &[(u32, u32)] = &[(0x00, 0), (0x04, 0), (0x08, 0), (0x0C, 0), (0x14, 0)];
const DBGMCU: &[(u32, u32)] = &[(0x04, 0)];
const ADC_COMMON: &[(u32, u32)] = &[(0x00, 0), (0x08, 0)];

impl Machine {
    pub fn new(inputs: Box<dyn Inputs>) -> Self {
        let mut machine = Machine {
            now: 0,
            until: u64::MAX,
            rcc: Rcc::new(),
            ports: std::array::from_fn(|_| Gpio::new()),
            tim3: Timer::new(),
            tim4: Timer::new(),
            tim15: Timer::new(),
            usart1: Usart::new(false),
            lpuart1: Usart::new(true),
            adc1: Adc::new(),
            adc5: Adc::new(),
            common: [0, 1].map(|_| Registers::new("ADC common", ADC_COMMON)),
            dma: Dma::new(),
            nvic: Nvic::new(),
            iwdg: Iwdg::new(false, 0, LSI_HZ),
            flash: Flash::new(),
            backup: Backup::default(),
            relay: relay::Relay::default(),
            lsi_hz: LSI_HZ,
            cycle: None,
            half_cycles: 2,
            flash_failure: Cause::Power,
            pwr: Registers::new("PWR", PWR),
            syscfg: Registers::new("SYSCFG", SYSCFG),
            exti: Registers::new("EXTI", EXTI),
            dbgmcu: Registers::new("DBGMCU", DBGMCU),
            sensing: Sensing::new(inputs),
            count: 0,
            taking: Taking::default(),
            writes: Writes::default(),
            taken: Some(Vec::new()),
            vdda_millivolt: 3_300,
            detector_millivolt: None,
            temperature_degc: 40.0,
            tally: Tally::default(),
            event_register: false,
            failure: None,
            unreachable: None,
            executed_forbidden: false,
            faults: Vec::new(),
            parity_failed: false,
            stop: false,
            next_event: 0,
            dma_blocked: false,
            lost_encoder_requests: 0,
            spurious: None,
            profile: None,
        };
        machine.iwdg = Iwdg::new(machine.flash.starts_watchdog(), 0, LSI_HZ);
        machine.set_clocks();
        machine
    }

    /// What a reset does to the chip: everything but the outside world, the clock on the wall and the flash.
    pub fn reset(&mut self, cause: Cause) {
        self.rcc.reset(cause);
        if cause == Cause::Power {
            self.backup.clear();
        }
        self.ports.iter_mut().for_each(Gpio::reset);
        // The last edge of the relay's pump is the one that the reset makes.
        self.follow_relay();
        for timer in [&mut self.tim3, &mut self.tim4, &mut self.tim15] {
            timer.reset();
        }
        self.usart1.reset();
        self.lpuart1.reset();
        self.adc1.reset();
        self.adc5.reset();
        self.taking = Taking::default();
        self.dma = Dma::new();
        self.nvic = Nvic::new();
        self.flash
            .reset(matches!(cause, Cause::Power | Cause::OptionBytes));
        self.iwdg = Iwdg::new(self.flash.starts_watchdog(), self.now, self.lsi_hz);
        for block in [&mut self.pwr, &mut self.syscfg, &mut self.exti] {
            block.reset();
        }
        self.common.iter_mut().for_each(Registers::reset);
        self.parity_failed = false;
        self.event_register = false;
        self.stop = false;
        self.tally.resets += 1;
        self.set_clocks();
    }

    /// Until when the program runs on its own: something happens, or somebody looks.
    pub fn horizon(&self) -> u64 {
        self.next_happening().min(self.until)
    }

    /// When the next thing happens without the program.
    pub fn next_happening(&self) -> u64 {
        let events = [
            self.acquisition_horizon(),
            self.tim15.next_event(),
            self.adc5.next_event(),
            self.iwdg.deadline(),
            self.spurious.map(|(_, next)| next),
            self.usart1.next_event(),
            self.lpuart1.next_event(),
            self.is_fed().then_some(self.now),
        ];
        events.into_iter().flatten().min().unwrap_or(u64::MAX)
    }

    /// Lets everything happen up to `now`.
    pub fn advance(&mut self) -> Result<(), Unmodelled> {
        self.catch_up()?;
        self.tim15.advance(self.now);
        if let Some((period, next)) = &mut self.spurious
            && *next <= self.now
        {
            *next = self.now + *period;
            self.nvic.pend(IRQ_DMA1_CH1);
        }
        let (reference, temperature) = (self.reference_code(), self.temperature_code());
        self.adc5.advance(self.now, |channel, _| match channel {
            VREFINT_CHANNEL => reference,
            TEMPERATURE_CHANNEL => temperature,
            _ => 0,
        });
        self.usart1.advance(self.now);
        self.lpuart1.advance(self.now);
        self.update_lines();
        Ok(())
    }

    fn reference_code(&self) -> u16 {
        // The reference does not move; the scale does: code = cal * 3.0 V / VDDA.
        ((u32::from(VREFINT_CAL) * 3_000 + self.vdda_millivolt / 2) / self.vdda_millivolt) as u16
    }

    fn temperature_code(&self) -> u16 {
        let slope = f64::from(TS_CAL_130 - TS_CAL_30) / 100.0;
        let at_3_volt = f64::from(TS_CAL_30) + slope * (self.temperature_degc - 30.0);
        (at_3_volt * 3_000.0 / f64::from(self.vdda_millivolt)).round() as u16
    }

    fn is_fed(&self) -> bool {
        self.lpuart1.wants_byte() && self.dma.listens(LINE_LPUART1_TX) && !self.dma_blocked
    }

    /// What DMA carries from memory to a port next.
    pub fn next_feed(&mut self) -> Result<Option<Transfer>, Unmodelled> {
        if self.is_fed() {
            self.dma.request(LINE_LPUART1_TX)
        } else {
            self.update_lines();
            Ok(None)
        }
    }

    /// A serial port.
    pub fn port(&mut self, port: Port) -> &mut Usart {
        match port {
            Port::Modbus => &mut self.usart1,
            Port::Frames => &mut self.lpuart1,
        }
    }

    /// Whether anything asserts the non-maskable interrupt.
    pub fn non_maskable(&self) -> bool {
        self.flash.interrupt() || self.rcc.interrupt() || self.parity_failed
    }

    /// Asserted lines pend their interrupts.
    pub fn update_lines(&mut self) {
        for channel in 0..8 {
            if self.dma.interrupt(channel) {
                // Channels 1..=7 are neighbours; channel 8 lies elsewhere and is not used.
                self.nvic.pend(IRQ_DMA1_CH1 + channel);
            }
        }
        let lines = [
            (self.tim15.interrupt(), IRQ_TIM15),
            (self.tim3.interrupt(), IRQ_TIM3),
            (self.usart1.interrupt(), IRQ_USART1),
            (self.lpuart1.interrupt(), IRQ_LPUART1),
        ];
        for (_, irq) in lines.iter().filter(|(asserted, _)| *asserted) {
            self.nvic.pend(*irq);
        }
    }
}
