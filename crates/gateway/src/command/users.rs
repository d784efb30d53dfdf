//! `drivemon fleet user`.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use fleet::now_ms;
use fleet::people::{Outcome, People, Role, User};

use super::error::CommandError;
use super::terminal::Terminal;
use crate::config::Config;

/// Users of a plant's page.
#[derive(Debug, Args)]
pub(super) struct Users {
    #[command(subcommand)]
    command: UserCommand,
}

#[derive(Debug, Subcommand)]
enum UserCommand {
    /// Add a user, and print the token: it is shown once and kept as a hash
    Add {
        /// Name, as it stands in the audit trail
        name: String,
        /// see, acknowledge or configure; each may do what those before it may
        #[arg(long)]
        role: Role,
        #[command(flatten)]
        of: OfPlant,
    },
    /// Remove a user: the token is refused from now on
    Remove {
        /// Name
        name: String,
        #[command(flatten)]
        of: OfPlant,
    },
    /// List users with their roles
    List {
        #[command(flatten)]
        of: OfPlant,
    },
}

/// Which plant a command is about.
#[derive(Debug, Args)]
pub(super) struct OfPlant {
    /// The plant: the gateway's configuration (*.toml), or its store
    #[arg(long, value_name = "CONFIG_OR_STORE")]
    fleet: PathBuf,
}

impl Users {
    /// Runs the command.
    pub fn run(&self, terminal: Terminal) -> Result<(), CommandError> {
        match &self.command {
            UserCommand::Add { name, role, of } => add(name, *role, &of.people()?, terminal.say),
            UserCommand::Remove { name, of } => {
                let people = of.people()?;
                people.remove_user(name)?;
                note(&people, &format!("user {name} removed"))?;
                (terminal.say)(&format!("{name} removed"));
                Ok(())
            }
            UserCommand::List { of } => {
                for User { name, role } in of.people()?.users()? {
                    (terminal.say)(&format!("{role:12} {name}"));
                }
                Ok(())
            }
        }
    }
}

impl OfPlant {
    /// Its store.
    pub fn store(&self) -> Result<PathBuf, CommandError> {
        Ok(Config::store_of(&self.fleet)?)
    }

    fn people(&self) -> Result<People, CommandError> {
        let store = self.store()?;
        if let Some(folder) = store.parent().filter(|folder| *folder != Path::new("")) {
            std::fs::create_dir_all(folder)?;
        }
        Ok(People::open(&store)?)
    }
}

fn add(name: &str, role: Role, people: &People, say: fn(&str)) -> Result<(), CommandError> {
    let name = name.to_owned();
    let user = User { name, role };
    let token = people.add_user(&user, now_ms())?;
    note(people, &format!("user {} added, role {role}", user.name))?;
    say(&token);
    Ok(())
}

/// Who can write the file did it: the operating system knows the name.
fn note(people: &People, what: &str) -> Result<(), CommandError> {
    let outcome = Outcome {
        done: true,
        words: String::new(),
    };
    Ok(people.note("at the terminal", what, &outcome, now_ms())?)
}
