//! A link on which a board tells on its own: frames of windows, which become seconds here.
//!
//! A frame cannot be asked for again. Those that are missing are counted and told; a second of which frames are missing has
//! fewer windows.

use std::time::Duration;

use board::modbus::{Field, Image, SecondCollector};
use board::{Frame, Message};
use fleet::{Entry, GapOf, now_ms};
use live::{Decoder, Source, open_serial};
use tokio::io::AsyncReadExt;
use tokio::net::TcpStream;
use tokio::sync::mpsc;
use tokio::time::{sleep, timeout};

use super::clock::Clock;
use super::context::Context;
use super::motor::{UNKNOWN, Watched, gap};
use super::tally::{Post, Tally};
use super::visit::stored;
use crate::config::{LinkConfig, LinkKind};

/// Samples of a second.
const SAMPLES: u64 = 10_000;
/// How well the begin of a run is known from one frame, s, and how much further off it is for each second of the run: the way
/// of a frame, and a crystal.
const BEGIN_S: f64 = 2.0;
const DRIFT: f64 = 1e-4;
const RESIDUALS: [Field; 4] = [
    Field::Residual1,
    Field::Residual2,
    Field::Residual3,
    Field::Residual4,
];

type Bytes = Result<Vec<u8>, String>;

/// Listens to the one board of a link.
pub(super) async fn follow(link: &LinkConfig, motors: &mut [Watched], context: &Context) {
    let [motor] = motors else {
        return;
    };
    let mut run = Run::new(motor.second, motor.clock);
    loop {
        let mut bytes = open(&link.kind);
        let why = listen(&mut bytes, &mut run, motor, context).await;
        context.is_down(motor, &why, false).await;
        sleep(Duration::from_secs(1)).await;
    }
}

/// Takes what comes until the connection ends; why it did.
async fn listen(
    bytes: &mut mpsc::Receiver<Bytes>,
    run: &mut Run,
    motor: &mut Watched,
    context: &Context,
) -> String {
    let mut decoder = Decoder::default();
    let mut heard = std::time::Instant::now();
    loop {
        let piece = match timeout(Duration::from_secs(1), bytes.recv()).await {
            Ok(Some(Ok(piece))) => piece,
            Ok(Some(Err(why))) => return why,
            Ok(None) => return "the connection ended".to_owned(),
            Err(_) => Vec::new(),
        };
        let damaged = decoder.damaged;
        let messages = decoder.take(&piece);
        Tally::add(&context.tally.damaged_frames, decoder.damaged - damaged);
        let mut entries = Vec::new();
        for message in messages {
            if let Message::Window(frame) = message {
                heard = std::time::Instant::now();
                entries.extend(run.take(&frame, now_ms()));
            }
        }
        if heard.elapsed() < Duration::from_secs(1) {
            context.is_up(motor).await;
        } else if heard.elapsed() > context.patience.lost_after {
            let why = decoder.foreign.map_or_else(
                || "no frames come: is the board powered, and the speed right?".to_owned(),
                |error| error.to_string(),
            );
            context.is_down(motor, &why, false).await;
        }
        if entries.is_empty() {
            continue;
        }
        let post = Post {
            motor: motor.id.clone(),
            entries,
            durable: None,
        };
        if context.posts.send(post).await.is_err() {
            return "the gateway ends".to_owned();
        }
    }
}

/// Bytes of a link, until the other end of the channel is dropped.
fn open(kind: &LinkKind) -> mpsc::Receiver<Bytes> {
    let (send, bytes) = mpsc::channel(64);
    match kind.clone() {
        LinkKind::FramesSerial { port, baud } => {
            drop(std::thread::spawn(move || serial(&port, baud, &send)));
        }
        LinkKind::FramesTcp { address } => {
            drop(tokio::spawn(async move {
                if let Err(error) = network(&address, &send).await {
                    let _ = send.send(Err(format!("{address}: {error}"))).await;
                }
            }));
        }
        LinkKind::ModbusTcp { .. } | LinkKind::ModbusRtu { .. } => {}
    }
    bytes
}

fn serial(port: &str, baud: u32, send: &mpsc::Sender<Bytes>) {
    let opened = open_serial(port, baud);
    let mut source: Box<dyn Source> = match opened {
        Ok(source) => source,
        Err(error) => return drop(send.blocking_send(Err(error.to_string()))),
    };
    loop {
        let read = source.read().map_err(|error| error.to_string());
        let ends = read.is_err();
        if send.blocking_send(read).is_err() || ends {
            return;
        }
    }
}

async fn network(address: &str, send: &mpsc::Sender<Bytes>) -> std::io::Result<()> {
    let mut stream = TcpStream::connect(address).await?;
    let mut piece = vec![0; 4_096];
    loop {
        let length = stream.read(&mut piece).await?;
        if length == 0 {
            return Err(std::io::ErrorKind::ConnectionAborted.into());
        }
        if send.send(Ok(piece[..length].to_vec())).await.is_err() {
            return Ok(());
        }
    }
}

/// A run of a board's program. Frames do not tell which: it gets the Unix time of its begin as number, s.
struct Run {
    start: u32,
    /// The second under way; 0: none.
    number: u32,
    /// Newest second that is stored.
    stored: Option<(u32, u32)>,
    next: Option<u32>,
    clock: Clock,
    image: Image,
    collector: SecondCollector,
}

impl Run {
    fn new(stored: Option<(u32, u32)>, clock: Clock) -> Self {
        Run {
            start: 0,
            number: 0,
            stored,
            next: None,
            clock,
            image: Image::default(),
            collector: SecondCollector::new(0),
        }
    }

    /// Takes a frame; the entries that it completes.
    fn take(&mut self, frame: &Frame, now_ms: i64) -> Vec<Entry> {
        let mut entries = self.missing(frame, now_ms);
        let number = second_of(frame);
        if self.next.is_none() {
            entries.extend(self.begin(frame, now_ms));
        } else if number != self.number {
            entries.extend(self.close(now_ms));
        }
        self.number = number;
        self.next = Some(frame.sequence.wrapping_add(1));
        fill(&mut self.image, frame);
        self.collector.take(&self.image);
        entries
    }

    /// Frames that did not come. A board that began anew counts from 0: that is another run.
    fn missing(&mut self, frame: &Frame, now_ms: i64) -> Vec<Entry> {
        let Some(next) = self.next else {
            return Vec::new();
        };
        match frame.sequence.wrapping_sub(next) {
            0 => Vec::new(),
            lost if lost < u32::MAX / 2 => {
                vec![gap(
                    GapOf::Frames,
                    next,
                    frame.sequence.wrapping_sub(1),
                    now_ms,
                )]
            }
            _ => {
                let last = self.close(now_ms);
                self.next = None;
                last.into_iter().collect()
            }
        }
    }

    /// A run begins, or goes on behind a pause of the gateway.
    fn begin(&mut self, frame: &Frame, now_ms: i64) -> Option<Entry> {
        let age_s = frame.sample_index as f64 / SAMPLES as f64;
        let begin_s = now_ms as f64 / 1_000.0 - age_s;
        self.collector = SecondCollector::new(0);
        match self.stored {
            Some((start, _)) if (f64::from(start) - begin_s).abs() < BEGIN_S + DRIFT * age_s => {
                self.start = start;
                None
            }
            stored => {
                // A later run has a later number, however the clock was set.
                let earliest = stored.map_or(0, |(start, _)| start.saturating_add(1));
                self.start = (begin_s as u32).max(earliest);
                self.clock = Clock::default();
                let (start, number) = stored.filter(|(_, number)| *number != UNKNOWN)?;
                let what = GapOf::Seconds { start };
                Some(gap(what, number.saturating_add(1), UNKNOWN, now_ms))
            }
        }
    }

    fn close(&mut self, now_ms: i64) -> Option<Entry> {
        let second = board::Second {
            start: self.start,
            number: self.number,
            ..self.collector.close(&self.image)
        };
        self.clock.observe(now_ms, self.number);
        self.stored = Some((self.start, self.number));
        let time_ms = self.clock.time_ms(self.number).unwrap_or(now_ms);
        (self.number > 0).then(|| Entry::Second(stored(&second, time_ms)))
    }
}

/// The second in which a frame's window ended, from 1.
fn second_of(frame: &Frame) -> u32 {
    frame.sample_index.div_ceil(SAMPLES).max(1) as u32
}

/// The registers that a board would show with this frame.
fn fill(image: &mut Image, frame: &Frame) {
    use std::f32::consts::{SQRT_2, TAU};
    image.set_long(Field::Lamps, frame.lamps);
    image.set_word(Field::NotJudged, u16::from(frame.not_judged));
    image.set_word(Field::Motion, u16::from(frame.motion));
    let residuals = frame.residuals.unwrap_or([f32::NAN; 4]);
    for (field, value) in RESIDUALS.into_iter().zip(residuals) {
        image.set_float(field, value);
    }
    image.set_float(Field::Voltage, frame.u_s_volt / SQRT_2);
    image.set_float(Field::Current, frame.i_s_amp / SQRT_2);
    image.set_float(Field::SupplyFrequency, frame.omega_sync_rad_s.abs() / TAU);
    let speed = frame.omega_mech_rad_s.unwrap_or(f32::NAN);
    image.set_float(Field::Speed, speed * 60.0 / TAU);
}

#[cfg(test)]
mod tests {
    use super::*;
    use board::Shown;
    use monitor::Report;

    const BEGIN_MS: i64 = 1_790_000_000_000;

    /// Frame `sequence` of a board that sends 50 a second, with the time at which it comes.
    fn frame(sequence: u32) -> (Frame, i64) {
        let sample_index = 200 * (u64::from(sequence) + 1);
        let report = Report {
            sample_index,
            ..Report::default()
        };
        let frame = Frame::new(&report, &Shown::default(), sequence, 3_300);
        (frame, BEGIN_MS + sample_index as i64 / 10)
    }

    fn numbers(entries: &[Entry]) -> Vec<(u32, u8)> {
        let second = |entry: &Entry| match entry {
            Entry::Second(second) => Some((second.number, second.windows)),
            _ => None,
        };
        entries.iter().filter_map(second).collect()
    }

    fn gaps(entries: &[Entry]) -> Vec<(GapOf, u32, u32)> {
        let gap = |entry: &Entry| match entry {
            Entry::Gap(gap) => Some((gap.what, gap.first, gap.last)),
            _ => None,
        };
        entries.iter().filter_map(gap).collect()
    }

    fn take(run: &mut Run, sequences: impl Iterator<Item = u32>, later_ms: i64) -> Vec<Entry> {
        sequences
            .flat_map(|sequence| {
                let (frame, now_ms) = frame(sequence);
                run.take(&frame, now_ms + later_ms)
            })
            .collect()
    }

    #[test]
    fn fifty_frames_are_a_second_and_missing_ones_are_told() {
        let mut run = Run::new(None, Clock::default());
        let entries = take(&mut run, (0..151).filter(|k| !(70..75).contains(k)), 0);
        assert_eq!(numbers(&entries), [(1, 50), (2, 45), (3, 50)]);
        assert_eq!(gaps(&entries), [(GapOf::Frames, 70, 74)]);
    }

    #[test]
    fn a_run_goes_on_behind_a_pause_and_a_new_one_is_another() {
        let mut run = Run::new(None, Clock::default());
        let first = take(&mut run, 0..101, 0);
        let Some(Entry::Second(last)) = first.last() else {
            panic!("two seconds");
        };
        let known = (last.start, last.number);
        let mut again = Run::new(Some(known), Clock::default());
        let on = take(&mut again, 500..601, 0);
        assert_eq!(again.start, known.0);
        assert_eq!(numbers(&on), [(11, 50), (12, 50)]);
        // The board begins anew an hour later.
        let anew = take(&mut again, 0..51, 3_600_000);
        let lost = GapOf::Seconds { start: known.0 };
        // The second under way is closed before.
        assert_eq!(gaps(&anew), [(lost, 14, UNKNOWN)]);
        assert_eq!(again.start, known.0 + 3_600);
    }
}
