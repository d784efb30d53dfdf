//! Supply cycles as a whole, for programs that follow a motor over days without its samples.

use crate::monitor::{Monitor, MonitorState};
use crate::report::Report;
use crate::window::Cycle;

impl Monitor {
    /// Takes what one supply cycle would have left behind, in V, A and rad/s at the recorder, and goes on as
    /// [`Monitor::update`] does at the end of a cycle: phasors are seen from an oscillator that turns once in the cycle.
    ///
    /// The supply must have been found in samples before; without a lock no window is formed. Samples that follow begin anew
    /// with [`MonitorState::resume_after_gap`].
    pub fn update_cycle(&self, state: &mut MonitorState, cycle: &Cycle) -> Report {
        state.expect_codes(false);
        state.measured = [true; 2];
        // A cycle is less than 2^16 samples.
        state.count(cycle.phasors.samples as usize);
        let corrected = cycle.corrected(&self.config().channel_gain);
        self.take_cycle(state, corrected)
    }
}
