//! What happens at a start.

use cortex_m::peripheral::SCB;
use cortex_m_rt::entry;
use update::{Journal, Next, State, layout};

use crate::flash::ChipFlash;
use crate::{lamps, program, supply, watchdog};

include!(concat!(env!("OUT_DIR"), "/key.rs"));

#[entry]
fn main() -> ! {
    let mut flash = ChipFlash::new();
    let has_work = has_work(&mut flash);
    // An ordinary start touches nothing.
    if has_work {
        watchdog::extend();
        supply::watch();
    }
    let next = update::start(&mut flash, &KEY);
    if has_work {
        flash.forget_instructions();
        supply::unwatch();
        watchdog::restore();
    }
    match next {
        Next::Program => program::start(),
        Next::Again => SCB::sys_reset(),
        Next::NoProgram => lamps::show_no_program(),
    }
}

/// Whether something is to be checked or copied, which takes longer than the watchdog waits after a reset.
fn has_work(flash: &mut ChipFlash) -> bool {
    let journal = Journal::open(flash, layout::JOURNAL);
    journal.is_ok_and(|journal| match journal.state() {
        State::Idle | State::Confirmed | State::Reverted | State::Refused(_) => false,
        State::Requested
        | State::Exchanging { .. }
        | State::Installed { .. }
        | State::OnTrial { .. }
        | State::Reverting { .. } => true,
    })
}
