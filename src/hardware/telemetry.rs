//! The log for people, over the debugger's memory channel.

use rtt_target::ChannelMode::NoBlockSkip;
use rtt_target::{rtt_init, set_defmt_channel};

/// Opens the log. It never blocks: what nobody reads is dropped.
pub fn start() {
    let channels = rtt_init! {
        up: {
            0: { size: 512, mode: NoBlockSkip, name: "defmt" }
        }
    };
    set_defmt_channel(channels.up.0);
}
