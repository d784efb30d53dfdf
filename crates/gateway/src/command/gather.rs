//! `drivemon gateway`.

use std::collections::BTreeSet;
use std::future::Future;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use motor::MotorFile;
use tokio::runtime::{Builder, Runtime};
use tokio::time::{MissedTickBehavior, interval, timeout};

use super::error::CommandError;
use super::outputs::{Handles, Outputs};
use super::terminal::Terminal;
use crate::config::{Config, advice};
use crate::{Gateway, Snapshot, connect};

/// For a serial port that is being read when the gateway ends.
const LAST_WORK: Duration = Duration::from_secs(1);

/// Read many boards and keep what they report in one store.
///
/// Boards are asked for what comes behind the last number in the store, so that an end of the gateway at any moment loses nothing
/// and stores nothing twice, as long as it is back within two minutes. What a board does not have any more is stored as a gap.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  drivemon gateway plant.toml --check            what would be done, and what is wrong
  drivemon gateway plant.toml --check --connect  the same, and every board is asked once
  drivemon gateway plant.toml                    until Ctrl-C or SIGTERM
  drivemon fleet simulate 20 --config-out plant.toml   boards to try it with
docs/fleet/gateway.md describes the configuration.
Exit codes: 0 fine, 1 --check found something to change, or a board that does not answer, 2 bad configuration, or the store cannot be written.")]
pub struct Gather {
    /// Which motors there are, on which links, and where everything is kept
    config: PathBuf,
    /// Say what would be done and what is wrong, without a connection
    #[arg(long)]
    check: bool,
    /// With --check: ask every board once
    #[arg(long, requires = "check")]
    connect: bool,
    /// Say how things are after every so many seconds; 0: never
    #[arg(long, value_name = "S", default_value_t = 60)]
    every: u64,
}

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ran {
    /// A check found nothing to change.
    Sound,
    /// A check found something to change, or a board that does not answer.
    ToChange,
    /// The gateway ran.
    Gathered(Snapshot),
}

/// Motor files that are named and cannot be read, each once.
fn wrong_motor_files(config: &Config) -> Vec<String> {
    let mut seen = BTreeSet::new();
    let named = config.motors.iter().filter_map(|motor| {
        let file = motor.info.motor_file.as_ref()?;
        seen.insert(file).then_some((motor, file))
    });
    let wrong = named.filter_map(|(motor, file)| {
        let error = MotorFile::read(file).err()?;
        Some(format!("motor_file of {}: {error}", motor.info.id))
    });
    wrong.collect()
}

impl Gather {
    /// Runs the command; the gateway ends when `end` does.
    ///
    /// # Errors
    /// The configuration, or the store.
    pub fn run<O: Outputs>(
        &self,
        terminal: Terminal,
        end: impl Future<Output = ()>,
    ) -> Result<Ran, CommandError> {
        let folder = self.config.parent().unwrap_or(Path::new(""));
        let (config, outputs) = Config::read(&self.config, |root| O::read(root, folder))?;
        let runtime = Builder::new_current_thread().enable_all().build()?;
        if self.check {
            return Ok(self.check(&config, &outputs, &runtime, terminal.say));
        }
        let outcome = runtime.block_on(self.gather(&config, outputs, terminal, end));
        // A serial port that is being read must not hold the end up.
        runtime.shutdown_timeout(LAST_WORK);
        let counts = outcome?;
        (terminal.complain)(&told(&counts));
        Ok(Ran::Gathered(counts))
    }

    fn check(
        &self,
        config: &Config,
        outputs: &impl Outputs,
        runtime: &Runtime,
        say: fn(&str),
    ) -> Ran {
        let (motors, links) = (config.motors.len(), config.links.len());
        say(&format!(
            "{}: {} on {}",
            self.config.display(),
            count(motors, "motor"),
            count(links, "link")
        ));
        let mut sound = true;
        for k in 0..links {
            sound &= show_link(config, k, say);
            if self.connect {
                sound &= show_answers(config, k, runtime, say);
            }
        }
        let limits = &config.limits;
        say(&format!(
            "store: {}, up to {} GB; seconds for {} days, minutes for {}, hours for {}, recordings for {}",
            config.store.display(),
            limits.bytes as f64 / 1e9,
            limits.seconds_days,
            limits.minutes_days,
            limits.hours_days,
            limits.recordings_days
        ));
        outputs.described().iter().for_each(|line| say(line));
        for wrong in wrong_motor_files(config).iter().chain(&outputs.to_change()) {
            sound = false;
            say(&format!("  to change: {wrong}"));
        }
        if sound { Ran::Sound } else { Ran::ToChange }
    }

    async fn gather(
        &self,
        config: &Config,
        outputs: impl Outputs,
        terminal: Terminal,
        end: impl Future<Output = ()>,
    ) -> Result<Snapshot, CommandError> {
        let complain = terminal.complain;
        let names = outputs.names();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let mut gateway = Gateway::start(config, &names, move |line| complain(&line))?;
        let handles = Handles {
            store: gateway.store(),
            alarms: gateway.alarms(),
            stored: gateway.stored(),
            ended: gateway.ended(),
            terminal,
        };
        let handing_on = outputs.run(handles);
        tokio::pin!(handing_on);
        complain(&format!(
            "{}, store {}   (Ctrl-C ends it)",
            count(config.motors.len(), "motor"),
            config.store.display()
        ));
        let mut turn = interval(Duration::from_secs(self.every.max(1)));
        turn.set_missed_tick_behavior(MissedTickBehavior::Delay);
        turn.tick().await;
        tokio::pin!(end);
        loop {
            tokio::select! {
                () = &mut end => break,
                why = &mut handing_on => return Err(CommandError::Output(why)),
                error = gateway.failed() => return Err(error.into()),
                _ = turn.tick(), if self.every > 0 => complain(&told(&gateway.snapshot())),
            }
        }
        gateway.begin_end();
        // Outputs hear of the end, too, and keep their places.
        let _ = timeout(LAST_WORK, &mut handing_on).await;
        Ok(gateway.end().await?)
    }
}

/// `false` where something should be changed.
fn show_link(config: &Config, k: usize, say: fn(&str)) -> bool {
    let (Some(link), Some(advice)) = (config.links.get(k), advice(config, k)) else {
        return true;
    };
    let motors = count(config.motors_of(k).count(), "motor");
    let every = match link.kind.is_asked() {
        true => format!(", visited every {} s", link.poll.as_secs_f64()),
        false => String::new(),
    };
    let busy = advice.busy.map_or(String::new(), |busy| {
        format!(", line busy for {:.0} % of the time", 100.0 * busy)
    });
    let (name, kind) = (&link.name, &link.kind);
    say(&format!("link {name}: {kind}, {motors}{every}{busy}"));
    let warnings = advice.warnings.iter();
    warnings.for_each(|warning| say(&format!("  to change: {warning}")));
    advice.warnings.is_empty()
}

/// `false` where a board does not answer.
fn show_answers(config: &Config, k: usize, runtime: &Runtime, say: fn(&str)) -> bool {
    let mut sound = true;
    for told in runtime.block_on(connect(config, k)) {
        let motor = told.motor;
        sound &= !matches!(told.answer, Some(Err(_)));
        say(&match told.answer {
            Some(Ok(answer)) => format!("  {motor}: {answer}"),
            Some(Err(why)) => format!("  {motor}: no: {why}"),
            None => format!("  {motor}: tells on its own; not asked"),
        });
    }
    sound
}

fn count(number: usize, what: &str) -> String {
    match number {
        1 => format!("1 {what}"),
        _ => format!("{number} {what}s"),
    }
}

fn told(now: &Snapshot) -> String {
    format!(
        "{} of {} motors answer; stored: {} seconds, {} events, {} gaps",
        now.up, now.motors, now.seconds, now.events, now.gaps
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::Plan;

    #[test]
    fn a_motor_file_that_is_not_there_is_to_change_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let plan = Plan {
            boards: 3,
            listen: "127.0.0.1:5020".parse().expect("an address"),
            per_port: 200,
            seed: 4,
            faulty: 0,
            faults_within_s: 60,
            restart_s: None,
        };
        let text = plan.configuration("plant.db");
        let config = || {
            let path = folder.path().join("plant.toml");
            Config::parse(&text, &path, Config::no_outputs)
                .expect("accepted")
                .0
        };
        let wrong = wrong_motor_files(&config());
        assert_eq!(wrong.len(), 1, "{wrong:?}");
        assert!(wrong[0].starts_with("motor_file of m00001: "), "{wrong:?}");
        let file = config().motors[0].info.motor_file.clone().expect("named");
        std::fs::copy("../../motors/peer-2k2.toml", file).expect("copied");
        assert_eq!(wrong_motor_files(&config()), Vec::<String>::new());
    }
}
