//! A running board: windows that it has judged, and the samples around its alarms.

use std::time::{Duration, Instant as WallTime};

use ::board::{Frame, Message};
use document::FileError;
use monitor::{Candidates, Lamp, MonitorConfig, MotionWord, Reason, Report};
use motor::MotorFile;

use super::{Can, Item, Source, SourceFailure, SourceInfo};
use crate::running::message::{
    LampsMessage, LikelyCause, Operation, WindowMessage, in_motion, likely, rms, slip_percent,
};
use live::{Collector, Decoder, Source as Link, recording};
use replay::words;

/// s; sampling time of the board.
const T_SAMPLE: f64 = 1e-4;
/// What to do about a board that doubts itself.
const DOUBTFUL_BOARD: &str = "measure the board's 3.3 V and look at the connectors of its inputs; if both are right, exchange the board";
/// Silence after which the board is taken not to be there.
const SILENCE: Duration = Duration::from_secs(3);

/// A board behind a serial port or a debug probe.
pub struct BoardSource {
    link: Box<dyn Link>,
    name: String,
    motor: Option<MotorFile>,
    decoder: Decoder,
    collector: Collector,
    now_s: f64,
    heard: WallTime,
}

impl BoardSource {
    /// Listens to an open link; the motor file gives slip and the captures their units.
    pub fn new(link: Box<dyn Link>, name: String, motor: Option<MotorFile>) -> BoardSource {
        BoardSource {
            link,
            name,
            motor,
            decoder: Decoder::default(),
            collector: Collector::default(),
            now_s: 0.0,
            heard: WallTime::now(),
        }
    }

    fn window(&mut self, frame: &Frame) -> Item {
        self.now_s = frame.sample_index as f64 * T_SAMPLE;
        let pole_pairs = self.motor.as_ref().map(|motor| motor.mechanics.n_p as f32);
        let normalised = frame
            .residuals
            .zip(self.motor.as_ref())
            .map(over_thresholds);
        let (causes, todo) = self.causes(frame, normalised);
        Item::Judged(Box::new(WindowMessage {
            causes,
            todo,
            t_s: self.now_s,
            lamps: LampsMessage::from_order(std::array::from_fn(|k| frame.lamp(k))),
            not_judged: words::reason(frame.not_judged),
            motion: MotionWord::from_number(frame.motion).and_then(in_motion),
            r_percent: frame.residuals.map(|r| r.map(|r| 100.0 * r)),
            r_over_threshold: normalised.map(|r| r.map(Some)),
            operation: operation(frame, pole_pairs),
            ..WindowMessage::default()
        }))
    }

    /// What lit FAULT, from the residuals that the frame carries. A calibrated motor is judged by more than these, and a
    /// dead sensor's name stays on the board: there is nothing to name then.
    fn causes(
        &self,
        frame: &Frame,
        normalised: Option<[f32; 4]>,
    ) -> (Vec<LikelyCause>, Vec<&'static str>) {
        if Reason::from_number(frame.not_judged) == Some(Reason::Instrument) {
            return (Vec::new(), vec![DOUBTFUL_BOARD]);
        }
        let by_table = self
            .motor
            .as_ref()
            .is_some_and(|motor| motor.healthy.is_none());
        let lit = (1..=4).any(|k| frame.lamp(k) == Lamp::On);
        let fault = frame.fault();
        let candidates = normalised.filter(|_| by_table && lit && frame.not_judged == 0);
        let mut report = Report {
            candidates: candidates.as_ref().map(Candidates::from_normalised),
            ..Report::default()
        };
        report.lamps.fault = fault;
        likely(replay::causes::of_report(&report, &[], true), false)
    }
}

fn over_thresholds((r, motor): ([f32; 4], &MotorFile)) -> [f32; 4] {
    let thresholds = motor.monitor.threshold_percent;
    std::array::from_fn(|k| 100.0 * r[k] / thresholds[k] as f32)
}

fn operation(frame: &Frame, pole_pairs: Option<f32>) -> Operation {
    let omega = frame.omega_sync_rad_s;
    // Negative where the field turns backwards; then so is the speed, and the slip is what it is forwards.
    let turning = (omega != 0.0).then_some(omega);
    Operation {
        voltage_rms_volt: rms(frame.u_s_volt),
        current_rms_amp: rms(frame.i_s_amp),
        frequency_hz: turning.map(|omega| omega.abs() / std::f32::consts::TAU),
        speed_rad_s: frame.omega_mech_rad_s,
        slip_percent: turning
            .zip(frame.omega_mech_rad_s.zip(pole_pairs))
            .map(|(omega, (speed, n_p))| slip_percent(omega, speed * n_p)),
        ..Operation::default()
    }
}

impl Source for BoardSource {
    fn info(&self) -> SourceInfo {
        SourceInfo {
            kind: "board",
            name: self.name.clone(),
            sample_rate_hz: 1.0 / T_SAMPLE,
            span_s: None,
            can: Can::default(),
            audit: Vec::new(),
        }
    }

    fn now_s(&self) -> f64 {
        self.now_s
    }

    fn advance(&mut self, _: f64, take: &mut dyn FnMut(Item)) -> Result<bool, SourceFailure> {
        let bytes = self
            .link
            .read()
            .map_err(|error| SourceFailure(error.to_string()))?;
        for message in self.decoder.take(&bytes) {
            self.heard = WallTime::now();
            match message {
                Message::Window(frame) => take(self.window(&frame)),
                Message::Capture(piece) => {
                    let fetched = self.collector.take(piece).zip(self.motor.as_ref());
                    let kept = fetched.and_then(|(fetched, motor)| recording(&fetched, motor).ok());
                    kept.into_iter()
                        .for_each(|kept| take(Item::Capture(Box::new(kept))));
                }
            }
        }
        if self.heard.elapsed() > SILENCE {
            let why = "no frame came for 3 s: is this the board's port, is its speed right, and is the board running?";
            self.heard = WallTime::now();
            return Err(SourceFailure(why.into()));
        }
        Ok(true)
    }

    fn config(&self, _: Option<&MotorFile>) -> Result<Option<MonitorConfig>, FileError> {
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::board::modbus::{BoardStatus, Field, Image, Status, address};
    use ::board::{Display, MAX_FRAME_BYTES, Overrides, Relay, Shown, levels};
    use live::SourceError;
    use monitor::{Lamps, NotJudged, Residuals, Window};
    use proptest::prelude::*;

    /// A link that delivers these bytes and then nothing.
    struct Canned(Vec<u8>);

    impl Link for Canned {
        fn read(&mut self) -> Result<Vec<u8>, SourceError> {
            Ok(std::mem::take(&mut self.0))
        }
    }

    fn report() -> Report {
        let mut report = Report {
            sample_index: 25_000,
            window: Some(Window {
                omega_sync: 376.99,
                omega_mech: Some(183.5),
                ..Window::default()
            }),
            residuals: Some(Residuals {
                r: [0.012, 0.0, 0.0, -0.006],
                ..Residuals::default()
            }),
            ..Report::default()
        };
        report.lamps = Lamps {
            run: Lamp::On,
            r: [Lamp::On, Lamp::Off, Lamp::Off, Lamp::On],
            fault: Lamp::On,
            ..Lamps::default()
        };
        report
    }

    fn windows(reports: &[Report]) -> Vec<WindowMessage> {
        let frames = (0..)
            .zip(reports)
            .map(|(k, report)| Frame::new(report, &Shown::only(report.lamps), k, 3_300));
        told(&frames.collect::<Vec<_>>())
    }

    /// What the page is told of these frames.
    fn told(frames: &[Frame]) -> Vec<WindowMessage> {
        let bytes = frames
            .iter()
            .flat_map(|frame| frame.encode(&mut [0; MAX_FRAME_BYTES]).to_vec());
        let text = include_str!("../../../../motors/assumed-300w.toml");
        let motor = MotorFile::parse(text, "motor").expect("it ships");
        let link = Box::new(Canned(bytes.collect()));
        let mut source = BoardSource::new(link, "port".into(), Some(motor));
        let mut windows = Vec::new();
        let mut take = |item| match item {
            Item::Judged(window) => windows.push(*window),
            other => panic!("{other:?}"),
        };
        assert!(source.advance(0.0, &mut take).expect("a sound link"));
        windows
    }

    #[test]
    fn a_board_s_window_is_told_with_its_lamps_and_numbers() {
        let [window] = windows(&[report()]).try_into().expect("one window");
        assert_eq!(window.lamps.lit(), ["r1", "r4", "fault"]);
        assert_eq!((window.t_s, window.not_judged.as_deref()), (2.5, None));
        // r1 and r4: the resistances, a tie, as the terminal would name them.
        let causes = window.causes.iter().map(|cause| (cause.name, cause.tied));
        assert_eq!(
            causes.take(2).collect::<Vec<_>>(),
            [("Rs", true), ("Rr", true)]
        );
        let over = window.r_over_threshold.expect("residuals");
        // Thresholds of r1 and r4: 0.6 % and 0.3 %.
        assert!(
            (over[0].expect("r1") - 2.0).abs() < 1e-3 && (over[3].expect("r4") + 2.0).abs() < 1e-3
        );
        let slip = window.operation.slip_percent.expect("a speed");
        assert!(
            (slip - 100.0 * (1.0 - 2.0 * 183.5 / 376.99)).abs() < 1e-3,
            "{slip}"
        );
    }

    #[test]
    fn the_reason_of_a_window_that_was_not_judged_is_told() {
        let reports = [NotJudged::Transient, NotJudged::NoSpeed].map(|reason| Report {
            not_judged: Some(reason),
            ..report()
        });
        let told = windows(&reports)
            .into_iter()
            .map(|window| window.not_judged);
        let expected = [NotJudged::Transient, NotJudged::NoSpeed]
            .map(|reason| Some(words::not_judged(reason)));
        assert_eq!(told.collect::<Vec<_>>(), expected);
    }

    #[test]
    fn no_other_parameters_can_be_tried_on_a_board() {
        let source = BoardSource::new(Box::new(Canned(Vec::new())), "port".into(), None);
        assert!(source.config(None) == Ok(None) && !source.info().can.parameters);
    }

    fn any_lamp() -> impl Strategy<Value = Lamp> {
        prop_oneof![Just(Lamp::Off), Just(Lamp::On), Just(Lamp::Blink)]
    }

    fn any_lamps() -> impl Strategy<Value = Lamps> {
        proptest::array::uniform9(any_lamp()).prop_map(
            |[run, r1, r2, r3, r4, sensor, line, load, fault]| Lamps {
                run,
                r: [r1, r2, r3, r4],
                sensor,
                line,
                load,
                fault,
            },
        )
    }

    fn any_overrides() -> impl Strategy<Value = Overrides> {
        any::<[bool; 5]>().prop_map(
            |[
                instrument_faulty,
                learning,
                refused,
                calibration_ignored,
                noticed,
            ]| Overrides {
                instrument_faulty,
                learning,
                refused,
                calibration_ignored,
                noticed,
            },
        )
    }

    fn words_of(registers: &Image, field: Field, count: u16) -> Vec<u16> {
        let words = registers.range(address(field), count);
        words.expect("in the map").to_vec()
    }

    /// Lamps as the wires carry them over both halves of a blink.
    fn by_wires(shown: &Shown) -> Vec<Lamp> {
        let halves = levels(&shown.lamps, true)
            .into_iter()
            .zip(levels(&shown.lamps, false));
        let lamps = halves.map(|halves| match halves {
            (true, true) => Lamp::On,
            (true, false) => Lamp::Blink,
            _ => Lamp::Off,
        });
        lamps.collect()
    }

    fn by_master(registers: &Image) -> Vec<Lamp> {
        let words = words_of(registers, Field::Lamps, 2);
        let bits = u32::from(words[0]) << 16 | u32::from(words[1]);
        let lamps = (0..9).map(|k| match bits >> (2 * k) & 3 {
            1 => Lamp::On,
            2 => Lamp::Blink,
            _ => Lamp::Off,
        });
        lamps.collect()
    }

    fn by_page(lamps: &LampsMessage) -> Vec<Lamp> {
        let [run, r1, r2, r3, r4] = [lamps.run, lamps.r1, lamps.r2, lamps.r3, lamps.r4];
        let [sensor, line, load, fault] = [lamps.sensor, lamps.line, lamps.load, lamps.fault];
        vec![run, r1, r2, r3, r4, sensor, line, load, fault]
    }

    proptest! {
        /// Whatever the monitor says, the board overrides and the door remembers: wires, frame, registers and page show one thing.
        #[test]
        fn wires_frames_registers_and_page_show_the_same(
            before in any_lamps(),
            now in any_lamps(),
            over_before in any_overrides(),
            over_now in any_overrides(),
            latched: bool,
            judged_before: bool,
            judged: bool,
            acknowledged: bool,
        ) {
            let report_of = |lamps: Lamps, judged: bool| Report {
                lamps,
                not_judged: (!judged).then_some(NotJudged::Transient),
                residuals: report().residuals.filter(|_| judged),
                ..report()
            };
            let mut display = Display::default();
            display.set_latched(latched);
            let mut status = Status::default();
            let first = report_of(before, judged_before);
            let shown_first = display.show(&before, &over_before);
            let mut refreshed = status.take(&first, &shown_first, &BoardStatus::default());
            if acknowledged {
                display.acknowledge();
            }
            let shown = display.show(&now, &over_now);
            status.refresh(&mut refreshed, &shown, &BoardStatus::default());
            // Between two reports a master reads what it would have read had the door shown this from the first.
            let anew = Status::default().take(&first, &shown, &BoardStatus::default());
            prop_assert_eq!(refreshed, anew);

            let second = report_of(now, judged);
            let registers = status.take(&second, &shown, &BoardStatus::default());
            let frames = [(&first, 0), (&second, 1)]
                .map(|(report, sequence)| Frame::new(report, &shown, sequence, 3_300));
            let [page_refreshed, page] = told(&frames).try_into().expect("two windows");
            let door = by_wires(&shown);
            let mut relay = Relay::default();
            relay.step(&shown, judged, true);
            prop_assert_eq!(relay.is_energised(), door[8] != Lamp::On && !over_now.instrument_faulty);

            let [sensor, fault] = [door[5], door[8]];
            for (registers, page) in [(&registers, &page), (&refreshed, &page_refreshed)] {
                prop_assert_eq!(&by_master(registers), &door);
                prop_assert_eq!(&by_page(&page.lamps), &door);
                let verdict = words_of(registers, Field::Verdict, 1)[0];
                prop_assert_eq!(verdict == 2, fault == Lamp::On);
                prop_assert!(verdict != 1 || sensor != Lamp::On);
                let reason = words_of(registers, Field::NotJudged, 1)[0];
                prop_assert_eq!(&page.not_judged, &words::reason(reason as u8));
                let residual = words_of(registers, Field::Residual1, 2);
                let residual = f32::from_bits(u32::from(residual[0]) << 16 | u32::from(residual[1]));
                prop_assert_eq!(residual.is_nan(), page.r_percent.is_none());
            }
            // A board that doubts itself blames nothing on the motor.
            if over_now.instrument_faulty {
                prop_assert!(page.causes.is_empty() && page.r_percent.is_none());
                for registers in [&registers, &refreshed] {
                    prop_assert_eq!(words_of(registers, Field::LikelyFault, 1)[0], 0);
                    prop_assert_eq!(words_of(registers, Field::NotJudged, 1)[0], 14);
                }
            }
        }
    }
}
