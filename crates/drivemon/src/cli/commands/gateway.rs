//! `drivemon gateway` and `drivemon fleet`: many boards, one store.

use clap::Args;
use gateway::Snapshot;
pub use gateway::command::Fleet;
use gateway::command::{CommandError, Gather, Ran, Terminal, Uplinks};
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;

use super::ending::told_to_end;

use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::JsonArgs;
use crate::cli::printing::terminal::{complain, line};

const TERMINAL: Terminal = Terminal {
    say: |text| line(format_args!("{text}")),
    complain: |text| complain(format_args!("{text}")),
};

#[derive(Debug, Args)]
pub struct GatewayArgs {
    #[command(flatten)]
    json: JsonArgs,
    #[command(flatten)]
    gather: Gather,
}

/// What a gateway has done from its start to its end.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Counted {
    /// Counts since the start.
    counts: Snapshot,
}

impl Answer for Counted {
    const FORMAT: &'static str = "gateway/1";
}

impl GatewayArgs {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let ran = self.gather.run::<Uplinks>(TERMINAL, told_to_end());
        let ran = ran.map_err(failure)?;
        if let Ran::Gathered(counts) = ran {
            self.json.write(&Counted { counts })?;
        }
        Ok(match ran {
            Ran::ToChange => Finding::Something,
            Ran::Sound | Ran::Gathered(_) => Finding::Nothing,
        })
    }
}

/// Runs a command about plants of many motors.
pub fn fleet(fleet: &Fleet) -> Result<Finding, Failure> {
    #[cfg(feature = "panel")]
    let page = panel::fleet::month_page;
    #[cfg(not(feature = "panel"))]
    let page = |_: &_, _: &_| Err("build drivemon with its feature panel".into());
    fleet.run(TERMINAL, page, told_to_end()).map_err(failure)?;
    Ok(Finding::Nothing)
}

fn failure(error: CommandError) -> Failure {
    if let CommandError::Config(error) = error {
        return Failure::File(error);
    }
    Failure::Usage(error.to_string())
}
