//! What the running program does about updates: pieces to their place, the check, the question to the loader, its own trial.

use super::background::BackgroundFlash;
use super::state::UpdateState;
use super::tray::{Portion, Settled};
use super::waiting::{Checked, Taken, Waiting};
use crate::journal::{Journal, JournalError, State};
use crate::layout::{JOURNAL, PROGRAM};
use crate::refusal::Refusal;
use crate::seal::{SEAL_BYTES, SEAL_OFFSET, Seal};

/// Seconds in a row without trouble after which a new program confirms itself.
const QUIET_S: u16 = 60;
/// Seconds after which one that did not is given up.
const TRIAL_S: u16 = 600;

/// What is worth an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum News {
    /// This program runs for the first time.
    Installed,
    /// It has confirmed itself.
    Confirmed,
    /// A new one did not, and this one runs again.
    BroughtBack,
    /// One that was received is not taken.
    Refused(Refusal),
}

/// What has to be done while nothing is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Due {
    /// [`Updater::confirm`].
    Confirm,
    /// Start again: the loader brings the program before this one back.
    GiveUp,
}

/// Seconds of a trial: those in a row without trouble, and all.
#[derive(Clone, Copy, Debug, Default)]
struct Trial {
    quiet_s: u16,
    all_s: u16,
}

/// Updates, as the program sees them that runs.
pub struct Updater<F> {
    waiting: Waiting<F>,
    /// Of the journal.
    flash: F,
    journal: Option<Journal>,
    running: Option<Seal>,
    state: UpdateState,
    refused: Option<Refusal>,
    trial: Option<Trial>,
    news: Option<News>,
}

impl<F: BackgroundFlash> Updater<F> {
    /// Looks up how the last update ended; `waiting` and `flash` are two ways to the same flash. What is told once is done with
    /// in the journal, so this is for a moment in which nothing is sampled.
    pub fn open(waiting: F, mut flash: F) -> Self {
        let running = running(&mut flash);
        let journal = Journal::open(&mut flash, JOURNAL).ok();
        let mut updater = Updater {
            waiting: Waiting::new(waiting),
            flash,
            journal,
            running,
            state: UpdateState::None,
            refused: None,
            trial: None,
            news: None,
        };
        updater.look_up();
        updater
    }

    fn look_up(&mut self) {
        match self.journal.as_ref().map_or(State::Idle, Journal::state) {
            // `Installed`: the loader could not note the trial, which the next start makes good. The program before lies where
            // pieces would go all the same.
            State::OnTrial { .. } | State::Installed { .. } => {
                self.trial = Some(Trial::default());
                self.state = UpdateState::OnTrial;
                self.news = Some(News::Installed);
            }
            State::Confirmed => self.state = UpdateState::Confirmed,
            State::Reverted => {
                self.state = UpdateState::BroughtBack;
                self.news = Some(News::BroughtBack);
                let _ = self.write(State::Idle);
            }
            State::Refused(refusal) => {
                self.refuse(refusal);
                let _ = self.write(State::Idle);
            }
            // The loader leaves none of the others behind.
            _ => {}
        }
    }

    /// How it stands.
    pub fn state(&self) -> UpdateState {
        self.state
    }

    /// Why the last program was not taken.
    pub fn refused(&self) -> Option<Refusal> {
        self.refused
    }

    /// Bytes that were received.
    pub fn received(&self) -> u32 {
        self.waiting.received()
    }

    /// Seconds until a new program confirms itself if nothing happens; `None` without a trial.
    pub fn seconds_left(&self) -> Option<u16> {
        self.trial
            .map(|trial| QUIET_S.saturating_sub(trial.quiet_s))
    }

    /// What is worth an event, once.
    pub fn take_news(&mut self) -> Option<News> {
        self.news.take()
    }

    /// Whether pieces are taken: during a trial the program before this one lies where they would go, and what is being
    /// checked or was checked stays as it is.
    pub fn is_open(&self) -> bool {
        use UpdateState::{Asked, Checking, OnTrial};
        self.journal.is_some() && !matches!(self.state, OnTrial | Checking | Asked)
    }

    /// A short piece of work between two blocks of samples: a portion to flash, a page, or some bytes of the check.
    pub fn step(&mut self, portion: Option<&Portion>) -> Settled {
        match (portion, self.state) {
            (Some(portion), _) if self.trial.is_none() => return self.take(portion),
            (None, UpdateState::Checking) => self.check(),
            _ => self.waiting.rest(),
        }
        Settled::NotYet
    }

    fn take(&mut self, portion: &Portion) -> Settled {
        match self.waiting.take(portion) {
            Taken::Wait => Settled::NotYet,
            Taken::Done => {
                // The last piece may still be on its way when its check is asked for and even refused.
                let later = matches!(self.state, UpdateState::Checking | UpdateState::Refused);
                if portion.offset == 0 || !later {
                    (self.state, self.refused) = (UpdateState::Receiving, None);
                }
                Settled::Written(self.waiting.received())
            }
            Taken::Failed(refusal) => {
                self.refuse(refusal);
                Settled::Failed
            }
        }
    }

    fn check(&mut self) {
        match self.waiting.check(self.running) {
            Checked::NotYet => {}
            Checked::Whole(_) => self.state = UpdateState::Asked,
            Checked::Refused(refusal) => self.refuse(refusal),
        }
    }

    /// A master wants what was received to be installed: its check begins, unless something is in the way.
    pub fn install(&mut self, obstacle: Option<Refusal>) {
        if matches!(self.state, UpdateState::Checking | UpdateState::Asked) {
            return;
        }
        match self.obstacle(obstacle) {
            Some(refusal) => self.refuse(refusal),
            None => (self.state, self.refused) = (UpdateState::Checking, None),
        }
    }

    fn obstacle(&self, others: Option<Refusal>) -> Option<Refusal> {
        let trial = self.trial.map(|_| Refusal::Trial);
        let journal = self.journal.is_none().then_some(Refusal::Flash);
        trial.or(journal).or(others)
    }

    /// Leaves the question for the loader; whether the board shall start again now.
    pub fn ask(&mut self, obstacle: Option<Refusal>) -> bool {
        let written = match self.obstacle(obstacle) {
            Some(refusal) => Err(refusal),
            None => self.write(State::Requested).map_err(|_| Refusal::Flash),
        };
        if let Err(refusal) = written {
            self.refuse(refusal);
        }
        written.is_ok()
    }

    /// A second of sampling has passed. `trouble`: the board doubts what it measures.
    pub fn second(&mut self, trouble: bool) -> Option<Due> {
        let trial = self.trial.as_mut()?;
        trial.all_s = trial.all_s.saturating_add(1);
        trial.quiet_s = if trouble {
            0
        } else {
            trial.quiet_s.saturating_add(1)
        };
        match trial {
            Trial { quiet_s, .. } if *quiet_s >= QUIET_S => Some(Due::Confirm),
            Trial { all_s, .. } if *all_s >= TRIAL_S => Some(Due::GiveUp),
            _ => None,
        }
    }

    /// Samples were missing: quiet seconds count from here on.
    pub fn disturb(&mut self) {
        if let Some(trial) = &mut self.trial {
            trial.quiet_s = 0;
        }
    }

    /// The new program confirms itself. May erase a page in the program's own bank: 22 ms in which nothing runs. Where flash
    /// refuses it is tried again later.
    pub fn confirm(&mut self) {
        match self.write(State::Confirmed) {
            Ok(()) => {
                self.trial = None;
                self.state = UpdateState::Confirmed;
                self.news = Some(News::Confirmed);
            }
            Err(_) => self.disturb(),
        }
    }

    fn write(&mut self, state: State) -> Result<(), JournalError> {
        let journal = self.journal.as_mut().ok_or(JournalError::Flash)?;
        journal.write(&mut self.flash, state)
    }

    fn refuse(&mut self, refusal: Refusal) {
        self.refused = Some(refusal);
        self.news = Some(News::Refused(refusal));
        if self.trial.is_none() {
            self.state = UpdateState::Refused;
        }
    }
}

/// What the program that runs says of itself; `None` where it was never sealed.
fn running<F: BackgroundFlash>(flash: &mut F) -> Option<Seal> {
    let mut bytes = [0; SEAL_BYTES];
    flash.read(PROGRAM + SEAL_OFFSET as u32, &mut bytes).ok()?;
    Seal::of_bytes(&bytes).ok()
}

#[cfg(test)]
mod tests;
