//! `drivemon monitor --serial` and `--probe`: a running board instead of a recording.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use board::{Frame, LAMPS, Message};
use clap::Args;
use monitor::Lamp;
use motor::MotorFile;
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::arguments::input::read_motor;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::terminal::say;
use crate::cli::printing::{paint, terminal};
use live::{Collector, Decoder, Fetched, Source, open_probe, open_serial, recording};

/// Silence after which the board is taken not to be there, s.
const SILENCE: Duration = Duration::from_secs(3);

/// How to reach a running board.
#[derive(Debug, Args)]
#[command(next_help_heading = "A running board instead of a recording")]
pub struct LiveArgs {
    /// Read the board's frames from a serial port, e.g. /dev/ttyACM0 or COM3
    #[arg(long, value_name = "PORT", conflicts_with_all = ["recordings", "probe"])]
    pub serial: Option<String>,
    /// Read the board's frames through a debug probe (needs a build with the feature `probe`)
    #[arg(long, conflicts_with = "recordings")]
    pub probe: bool,
    /// Speed of the serial port, bit/s
    #[arg(
        long,
        value_name = "BAUD",
        default_value_t = 115_200,
        requires = "serial"
    )]
    baud: u32,
    /// Stop after so many seconds; without it the board is watched until Ctrl-C
    #[arg(long = "for", value_name = "SECONDS", conflicts_with = "recordings", value_parser = seconds)]
    seconds: Option<f64>,
    /// Fetch the samples around the first alarm, write them as a recording, and stop; needs --motor
    #[arg(
        long,
        value_name = "FILE.csv",
        requires = "motor",
        conflicts_with = "recordings"
    )]
    capture: Option<PathBuf>,
}

/// Seconds that a clock can count: more than none, at most a century.
fn seconds(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|x: &f64| *x > 0.0 && *x <= 3e9);
    number.ok_or_else(|| "write a time in seconds above 0, as 60".to_owned())
}

/// What was seen of a running board.
#[derive(Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Watched {
    /// Windows that arrived.
    pub windows: u64,
    /// Of these judged.
    pub judged: u64,
    /// Windows whose frames never came.
    pub lost: u64,
    /// Frames that were damaged on the way.
    pub damaged: u64,
    /// FAULT was lit.
    pub fault: bool,
    /// File of the samples around the alarm.
    pub capture: Option<String>,
}

impl Answer for Watched {
    const FORMAT: &'static str = "watch/1";
}

/// Where results go and when to stop.
struct Watch<'a> {
    args: &'a LiveArgs,
    motor: Option<MotorFile>,
    quiet: bool,
    decoder: Decoder,
    collector: Collector,
    lamps: Option<[Lamp; LAMPS]>,
    watched: Watched,
}

impl LiveArgs {
    /// The recording that may be written.
    pub fn capture(&self) -> Option<&PathBuf> {
        self.capture.as_ref()
    }

    /// Watches the board. `quiet` leaves standard output alone.
    ///
    /// # Errors
    /// No port, no board, a motor file that does not fit.
    pub fn run(&self, motor: Option<&Path>, quiet: bool) -> Result<(Watched, Finding), Failure> {
        let motor = motor.map(read_motor).transpose()?;
        let source = match &self.serial {
            Some(port) => open_serial(port, self.baud),
            None => open_probe(),
        };
        let mut source = source.map_err(|error| Failure::Usage(error.to_string()))?;
        let mut watch = Watch {
            args: self,
            motor,
            quiet,
            decoder: Decoder::default(),
            collector: Collector::default(),
            lamps: None,
            watched: Watched::default(),
        };
        watch.listen(source.as_mut())?;
        watch.conclude()
    }
}

impl Watch<'_> {
    fn listen(&mut self, source: &mut dyn Source) -> Result<(), Failure> {
        let begin = Instant::now();
        let end = self.args.seconds.map(Duration::from_secs_f64);
        let mut heard = begin;
        loop {
            let bytes = source
                .read()
                .map_err(|error| Failure::Usage(error.to_string()))?;
            for message in self.decoder.take(&bytes) {
                heard = Instant::now();
                self.take(message)?;
            }
            let enough = end.is_some_and(|end| begin.elapsed() >= end);
            if enough || self.watched.capture.is_some() || terminal::is_closed() {
                return Ok(());
            }
            if heard.elapsed() > SILENCE {
                return Err(self.silence());
            }
        }
    }

    fn silence(&self) -> Failure {
        let why = match (&self.decoder.foreign, self.decoder.damaged) {
            (Some(foreign), _) => foreign.to_string(),
            (None, 0) => {
                "no frame came for 3 s: is this the board's port, and is the board running?".into()
            }
            (None, damaged) => format!(
                "{damaged} damaged frames and no sound one for 3 s: is the speed right (--baud), and this the board's port?"
            ),
        };
        Failure::Unsupported(why)
    }

    fn take(&mut self, message: Message) -> Result<(), Failure> {
        match message {
            Message::Window(frame) => self.window(&frame),
            Message::Capture(piece) => {
                if let Some(fetched) = self.collector.take(piece) {
                    self.keep(&fetched)?;
                }
            }
        }
        Ok(())
    }

    fn window(&mut self, frame: &Frame) {
        self.watched.windows += 1;
        self.watched.judged += u64::from(frame.not_judged == 0);
        let lamps: [Lamp; LAMPS] = std::array::from_fn(|k| frame.lamp(k));
        self.watched.fault |= frame.fault() == Lamp::On;
        if self.lamps != Some(lamps) && !self.quiet {
            if self.lamps.is_none() {
                say!("    time s  RUN  r1 r2 r3 r4  SENSOR LINE LOAD FAULT");
            }
            print_lamps(frame, &lamps);
        }
        self.lamps = Some(lamps);
    }

    fn keep(&mut self, fetched: &Fetched) -> Result<(), Failure> {
        let (Some(path), Some(motor)) = (&self.args.capture, &self.motor) else {
            return Ok(());
        };
        let recording =
            recording(fetched, motor).map_err(|error| Failure::Usage(error.to_string()))?;
        formats::write_recording(path, &recording)?;
        let name = path.display().to_string();
        if !self.quiet {
            say!("{name}: {} samples around the alarm", recording.len());
        }
        self.watched.capture = Some(name);
        Ok(())
    }

    fn conclude(mut self) -> Result<(Watched, Finding), Failure> {
        (self.watched.lost, self.watched.damaged) = (self.decoder.lost, self.decoder.damaged);
        if self.watched.windows == 0 {
            return Err(self.silence());
        }
        if !self.quiet {
            print_end(&self.watched);
        }
        let finding = match (self.watched.fault, self.watched.judged) {
            (true, _) => Finding::Something,
            (false, 0) => Finding::Unsupported,
            (false, _) => Finding::Nothing,
        };
        Ok((self.watched, finding))
    }
}

fn print_lamps(frame: &Frame, lamps: &[Lamp; LAMPS]) {
    let [run, r1, r2, r3, r4, sensor, line, load, fault] =
        lamps.map(crate::cli::printing::lamp_symbol::symbol);
    // The board samples at 10 kHz.
    let t = frame.sample_index as f64 * 1e-4;
    say!("{t:>10.3}   {run}   {r1}  {r2}  {r3}  {r4}     {sensor}     {line}    {load}    {fault}");
}

fn print_end(watched: &Watched) {
    say!("\n{} of {} windows judged", watched.judged, watched.windows);
    if watched.lost + watched.damaged > 0 {
        let (lost, damaged) = (watched.lost, watched.damaged);
        say!(
            "{} {lost} windows lost, {damaged} frames damaged",
            paint::caution("line:")
        );
    }
    match (watched.fault, watched.judged) {
        (true, _) => say!("{}", paint::error("FAULT was lit")),
        (false, 0) => say!("{}", paint::caution("not judged")),
        (false, _) => say!("{}", paint::good("no fault was lit")),
    }
}
