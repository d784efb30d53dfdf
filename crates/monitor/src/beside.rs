//! What goes through every instant of a block beside the windows.

pub(crate) mod moving;

use num_complex::Complex32;

use crate::input::sample::{CHANNELS, ClippedChannels};
use crate::report::Report;
use moving::Moving;

/// Units of a channel whose code of one instant is `code`: `scale code - offset` is V or A at the terminals, with all that is known of
/// the channel's gain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CodeUnits {
    /// V or A of a code.
    pub scale: f32,
    /// V or A of code 0, the other way round.
    pub offset: f32,
}

/// Instants in codes that follow each other.
#[derive(Clone, Copy, Debug)]
pub struct Stretch<'a> {
    /// Codes of each instant: voltage a, current a, voltage b, current b, voltage c, current c.
    pub codes: &'a [[u16; CHANNELS]],
    /// Counts of the encoder at the same instants.
    pub counts: &'a [u16],
    /// Axes of the supply's oscillator, of length 1; empty while no supply is followed.
    pub axes: &'a [Complex32],
    /// Frequency of the oscillator, rad/s.
    pub omega: f32,
    /// Channels at a rail in any of the instants.
    pub clipped: ClippedChannels,
    /// Units of the channels in the order voltages a, b, c, then currents a, b, c.
    pub units: &'a [CodeUnits; CHANNELS],
}

/// Goes through every instant beside the windows, and has a say when one ends.
pub trait Beside {
    /// Takes the instants that follow.
    fn take(&mut self, stretch: &Stretch<'_>);

    /// What it says with the window that ended with the last of them.
    fn window(&mut self, report: &Report) -> Option<Moving>;
}

/// Nothing goes beside.
impl Beside for () {
    #[inline(always)]
    fn take(&mut self, _: &Stretch<'_>) {}

    #[inline(always)]
    fn window(&mut self, _: &Report) -> Option<Moving> {
        None
    }
}
