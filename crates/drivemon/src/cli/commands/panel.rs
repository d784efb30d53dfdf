//! `drivemon panel`: the lamps in a browser.

use std::net::IpAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use audit::{Audit, Expectation, audit};
use clap::Args;
use motor::MotorFile;
use recording::Source as Read;
use tokio::sync::watch;

use crate::cli::arguments::input::{InputArgs, read_motor};
use crate::cli::commands::ending::told_to_end;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::terminal::say;
use live::{open_probe, open_serial};
use panel::fleet::{DueRule, Look};
use panel::source::{BoardSource, ReplayedSource, SimulatedSource, Source, built_in_motor};
use panel::{self, MotorError, Options, PanelError, Session, TlsFiles};
use scenario::Scenario;

/// Show the panel in a browser: lamps, causes, residuals, signals, vectors; a simulated motor, a recording or a board.
///
/// Without a source a simulated motor runs whose faults are switched on the page. The address is printed; the server
/// answers this computer only, and needs no network.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Panel {
    /// Run a scenario; after its end it goes on as it then is
    #[arg(long, value_name = "SCENARIO", group = "source")]
    sim: Option<PathBuf>,
    /// Play a recording: speed, pause and time are chosen on the page
    #[arg(long, value_name = "REC", group = "source")]
    replay: Option<PathBuf>,
    /// Listen to a board on a serial port, e.g. /dev/ttyACM0 or COM3
    #[arg(long, value_name = "PORT", group = "source")]
    serial: Option<String>,
    /// Listen to a board through a debug probe (needs a build with the feature `probe`)
    #[arg(long, group = "source")]
    probe: bool,
    /// Show a plant of many motors: the gateway's configuration (*.toml), or its store
    ///
    /// The page reads the store beside `drivemon gateway`. On this computer everybody may see it; who acknowledges alarms needs a
    /// token from `drivemon fleet user add`. With --allow-network everybody needs one.
    #[arg(long, value_name = "CONFIG_OR_STORE", group = "source")]
    fleet: Option<PathBuf>,
    /// With --fleet: a motor without data for so long is grey, s; more than the longest time between two visits of its link
    #[arg(long, value_name = "S", default_value_t = 30, requires = "fleet", value_parser = clap::value_parser!(u32).range(2..=86_400))]
    stale_after: u32,
    /// With --fleet: a calibration older than so many days is due
    #[arg(long, value_name = "DAYS", default_value_t = 365, requires = "fleet", value_parser = clap::value_parser!(u32).range(1..=36_500))]
    recalibrate_after: u32,
    /// With --fleet: a calibration is due once r1 or r4 has moved by more than this since, % of scale, means of seven days
    #[arg(long, value_name = "PERCENT", default_value_t = 1.0, requires = "fleet", value_parser = drift)]
    recalibrate_drift: f32,
    /// Speed of the serial port, bit/s
    #[arg(
        long,
        value_name = "BAUD",
        default_value_t = 115_200,
        requires = "serial"
    )]
    baud: u32,
    /// Motor file: the motor that runs when no source is named, and the one to judge with
    #[arg(long, value_name = "M")]
    motor: Option<PathBuf>,
    /// Source seconds per second on the wall, to begin with
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = speed)]
    speed: f64,
    /// Port to listen on; 0 takes any that is free
    #[arg(long, default_value_t = 8350, help_heading = "The server")]
    port: u16,
    /// Address to listen on; others than this computer's own need --allow-network
    #[arg(
        long,
        value_name = "ADDRESS",
        default_value = "127.0.0.1",
        help_heading = "The server"
    )]
    host: IpAddr,
    /// Let others who reach --host and have the printed link watch and switch
    ///
    /// The link holds a random token; the browser keeps it as a cookie, and without it nothing is shown. With --fleet people
    /// sign in with tokens of their own instead. A token does not protect what is sent: with --tls-cert and --tls-key it is
    /// encrypted; without them anyone who can listen on the network can read it, the token too, and a plant is not shown.
    #[arg(long, help_heading = "The server")]
    allow_network: bool,
    /// Encrypt (TLS) with the certificates of this file: PEM, the server's own first
    #[arg(
        long,
        value_name = "FILE",
        requires = "tls_key",
        help_heading = "The server"
    )]
    tls_cert: Option<PathBuf>,
    /// The certificate's private key: PEM, without a password; read at the start
    #[arg(
        long,
        value_name = "FILE",
        requires = "tls_cert",
        help_heading = "The server"
    )]
    tls_key: Option<PathBuf>,
    /// With --fleet: show a plant on a network without TLS, because something else encrypts or nobody else listens
    #[arg(
        long,
        requires = "fleet",
        conflicts_with = "tls_cert",
        help_heading = "The server"
    )]
    allow_plain: bool,
    /// Answer to a further host name, e.g. that of a proxy
    #[arg(long, value_name = "NAME", help_heading = "The server")]
    allow_host: Vec<String>,
    /// Open the page in the usual browser
    #[arg(long, help_heading = "The server")]
    open: bool,
    #[command(flatten)]
    input: InputArgs,
}

const EXAMPLES: &str = "\
Examples:
  drivemon panel                                                   a simulated motor; switch faults on the page
  drivemon panel --motor motors/peer-2k2.toml                      another motor, simulated
  drivemon panel --sim sim-host/scenarios/sensor-faults.toml       a scenario
  drivemon panel --replay rec.csv.gz --motor motors/peer-2k2.toml  a recording
  drivemon panel --serial /dev/ttyACM0 --motor m.toml              a running board
  drivemon panel --fleet plant.toml                                a plant of many motors
  drivemon panel --fleet plant.toml --host 0.0.0.0 --allow-network --tls-cert plant.pem --tls-key plant.key
Ctrl-C ends it.";

/// For a file that is being read when the panel ends.
const LAST_WORK: std::time::Duration = std::time::Duration::from_secs(1);

fn speed(text: &str) -> Result<f64, String> {
    let speed = text.parse::<f64>().map_err(|error| error.to_string())?;
    match (0.01..=100.0).contains(&speed) {
        true => Ok(speed),
        false => Err("choose a factor from 0.01 to 100".into()),
    }
}

fn drift(text: &str) -> Result<f32, String> {
    let percent = text.parse::<f32>().map_err(|error| error.to_string())?;
    match (0.01..=100.0).contains(&percent) {
        true => Ok(percent),
        false => Err("choose a share from 0.01 to 100 percent".into()),
    }
}

impl Panel {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        if let Some(plant) = &self.fleet {
            return self.show(plant);
        }
        let (source, motor) = self.source()?;
        let name = self.motor_name();
        let session = panel::start(source, motor, self.speed);
        let session = session.map_err(|error| match error {
            MotorError::Value(error) => Failure::Config { file: name, error },
            MotorError::Effects(error) => Failure::File(error),
        })?;
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(|error| Failure::Usage(format!("no server can be started: {error}")))?;
        let served = runtime.block_on(self.serve(Arc::new(session)));
        // A file that is still being read must not hold the end up.
        runtime.shutdown_timeout(LAST_WORK);
        served.map_err(|error| Failure::Usage(error.to_string()))?;
        Ok(Finding::Nothing)
    }

    /// A plant of many motors, until the program is told to end.
    fn show(&self, plant: &Path) -> Result<Finding, Failure> {
        #[cfg(feature = "gateway")]
        let plant = &gateway::config::Config::store_of(plant)?;
        let look = Look {
            stale_ms: 1_000 * i64::from(self.stale_after),
            due: DueRule {
                after_days: self.recalibrate_after,
                drift_percent: self.recalibrate_drift,
            },
        };
        let told = |url: &str| self.tell(url);
        panel::fleet::show(plant, look, &self.options(), told, told_to_end())
            .map_err(|error| Failure::Usage(error.to_string()))?;
        Ok(Finding::Nothing)
    }

    fn tell(&self, url: &str) {
        say!("panel: {url}   (Ctrl-C ends it)");
        if self.open {
            open(url);
        }
    }

    async fn serve(&self, session: Arc<Session>) -> Result<(), PanelError> {
        let status = session.status();
        let running = panel::bind(&self.options(), session).await?;
        let url = running.url();
        say!("{}: {}", status.source.kind, status.source.name);
        self.tell(&url);
        if running.is_on_all_addresses() {
            say!("from another computer: the same link with this computer's name or address");
        }
        let (end, ended) = watch::channel(false);
        tokio::spawn(async move {
            told_to_end().await;
            let _ = end.send(true);
        });
        running.serve(ended).await;
        Ok(())
    }

    fn options(&self) -> Options {
        Options {
            host: self.host,
            port: self.port,
            allow_network: self.allow_network,
            allow_hosts: self.allow_host.clone(),
            tls: self
                .tls_cert
                .clone()
                .zip(self.tls_key.clone())
                .map(|(certificates, key)| TlsFiles { certificates, key }),
            allow_plain: self.allow_plain,
        }
    }

    fn motor_name(&self) -> String {
        let path = self.motor.as_ref().or(self.sim.as_ref());
        path.map_or("the built-in motor".into(), |path| {
            path.display().to_string()
        })
    }

    fn source(&self) -> Result<(Box<dyn Source>, Option<MotorFile>), Failure> {
        let motor = self.motor.as_deref().map(read_motor).transpose()?;
        match (&self.sim, &self.replay) {
            (Some(scenario), _) => self.scenario(scenario, motor),
            (_, Some(recording)) => self.recording(recording, motor),
            _ if self.probe || self.serial.is_some() => self.board(motor),
            _ => simulated(motor),
        }
    }

    fn scenario(
        &self,
        path: &Path,
        motor: Option<MotorFile>,
    ) -> Result<(Box<dyn Source>, Option<MotorFile>), Failure> {
        let scenario = Scenario::read(path)?;
        let named = |error| Failure::Usage(format!("{}: {error}", path.display()));
        let source = SimulatedSource::new(&scenario).map_err(named)?;
        Ok((Box::new(source), motor.or(Some(scenario.motor))))
    }

    fn recording(
        &self,
        path: &Path,
        motor: Option<MotorFile>,
    ) -> Result<(Box<dyn Source>, Option<MotorFile>), Failure> {
        let Read::Recording(recording) = self.input.read(path)? else {
            let why = format!(
                "{}: a load table has no samples to play: use `drivemon monitor`",
                path.display()
            );
            return Err(Failure::Usage(why));
        };
        let expectation = motor
            .as_ref()
            .map_or_else(Expectation::default, Expectation::from);
        let audit = audit(&recording, &expectation);
        if !audit.supported {
            return Err(Failure::Unsupported(why_not(path, &audit)));
        }
        let source = ReplayedSource::new(recording, audit, motor.is_some());
        Ok((Box::new(source), motor))
    }

    fn board(
        &self,
        motor: Option<MotorFile>,
    ) -> Result<(Box<dyn Source>, Option<MotorFile>), Failure> {
        let link = match &self.serial {
            Some(port) => open_serial(port, self.baud),
            None => open_probe(),
        };
        let link = link.map_err(|error| Failure::Usage(error.to_string()))?;
        let name = self.serial.clone().unwrap_or("debug probe".into());
        Ok((Box::new(BoardSource::new(link, name, motor.clone())), motor))
    }
}

fn simulated(motor: Option<MotorFile>) -> Result<(Box<dyn Source>, Option<MotorFile>), Failure> {
    let motor = motor.map_or_else(built_in_motor, Ok)?;
    let source = SimulatedSource::of_motor(motor.clone());
    let source = source.map_err(|error| Failure::Usage(error.to_string()))?;
    Ok((Box::new(source), Some(motor)))
}

/// What makes a recording unusable, in the words of its audit.
fn why_not(path: &Path, audit: &Audit) -> String {
    let refusing = audit.findings.iter().filter(|finding| finding.refuses);
    let details: Vec<&str> = refusing.map(|finding| finding.detail.as_str()).collect();
    format!("{}: {}", path.display(), details.join(" "))
}

/// Opens a page in the usual browser; where there is none, the printed address is enough.
fn open(url: &str) {
    let (program, arguments): (&str, &[&str]) = match std::env::consts::OS {
        "windows" => ("rundll32", &["url.dll,FileProtocolHandler"]),
        "macos" => ("open", &[]),
        _ => ("xdg-open", &[]),
    };
    if std::process::Command::new(program)
        .args(arguments)
        .arg(url)
        .spawn()
        .is_err()
    {
        crate::cli::printing::terminal::complain(format_args!(
            "no browser could be opened; open {url} yourself"
        ));
    }
}
