//! Many instants in ADC codes at once: what a processor without time does sample by sample, and what it does by block.
//!
//! Synchronisation and encoder follow every instant. The sums behind the phasors only need every instant's axis, so they
//! wait for the end of the block (or of the turn) and then keep their place in the processor's registers. Sample by
//! sample, in blocks of any length: the operations and their order are the same, and so is every bit of the result.

use num_complex::Complex32;

use crate::beside::{Beside, CodeUnits, Stretch};
use crate::input::sample::{CHANNELS, ClippedChannels, RawBlock, RawSample};
use crate::input::validity::IntakeState;
use crate::monitor::{Monitor, MonitorState};
use crate::report::Report;
use crate::sync::encoder::EncoderState;
use pll::{SyncState, SyncTick};

impl Monitor {
    /// Takes one instant in ADC codes. See [`Monitor::update`] and, for many instants, [`Monitor::update_block`].
    pub fn update_raw(&self, state: &mut MonitorState, raw: &RawSample) -> Option<Report> {
        self.update_raw_beside(state, raw, &mut ())
    }

    /// The same, with what goes through every instant beside the windows.
    pub fn update_raw_beside(
        &self,
        state: &mut MonitorState,
        raw: &RawSample,
        beside: &mut impl Beside,
    ) -> Option<Report> {
        state.expect_codes(true);
        let codes = raw.interleaved();
        let parts = (&mut state.intake, &mut state.sync, &mut state.encoder);
        let tick = self.follow_instant(parts, &codes, raw.encoder_count);
        let report = self.take_codes(state, (&codes, raw.clipped), &tick);
        let last = (core::slice::from_ref(&codes), raw.clipped);
        let counts = core::slice::from_ref(&raw.encoder_count);
        self.show_last(state, (last, counts), &tick, beside);
        report.map(|mut report| {
            report.moving = beside.window(&report);
            report
        })
    }

    /// Takes instants from the front of `block` until a report is due or none is left. See [`Monitor::update`].
    #[inline]
    pub fn update_block(
        &self,
        state: &mut MonitorState,
        block: &mut RawBlock<'_>,
    ) -> Option<Report> {
        self.update_block_beside(state, block, &mut ())
    }

    /// The same, with what goes through every instant beside the windows.
    #[inline]
    pub fn update_block_beside(
        &self,
        state: &mut MonitorState,
        block: &mut RawBlock<'_>,
        beside: &mut impl Beside,
    ) -> Option<Report> {
        state.expect_codes(true);
        while !block.is_empty() {
            let counts = block.counts();
            let (plain, event) = self.follow(state, block);
            let taken = block.take(plain);
            let clipped = self.sum_up(state, taken, block.is_watched);
            let of_turn = (taken.0, counts);
            self.show(state, of_turn, clipped, beside);
            let Some(tick) = event else {
                continue;
            };
            let counts = block.counts();
            let last = block.take(1);
            let report = self.take_event(state, last, &tick);
            self.show_last(state, (last, counts), &tick, beside);
            if let Some(mut report) = report {
                report.moving = beside.window(&report);
                return Some(report);
            }
        }
        None
    }

    /// Shows instants inside one turn to what goes beside.
    #[inline]
    fn show(
        &self,
        state: &MonitorState,
        (codes, counts): (&[[u16; CHANNELS]], &[u16]),
        clipped: ClippedChannels,
        beside: &mut impl Beside,
    ) {
        if codes.is_empty() {
            return;
        }
        beside.take(&Stretch {
            codes,
            counts,
            axes: state.axes.0.get(..codes.len()).unwrap_or_default(),
            omega: state.sync.omega(),
            clipped,
            units: &self.units_at_terminals(state),
        });
    }

    /// Shows the instant that ends a turn, or has none.
    #[inline]
    fn show_last(
        &self,
        state: &MonitorState,
        ((codes, clipped), counts): ((&[[u16; CHANNELS]], ClippedChannels), &[u16]),
        tick: &SyncTick,
        beside: &mut impl Beside,
    ) {
        let axes: &[Complex32] = match state.sync.is_searching() {
            true => &[],
            false => core::slice::from_ref(&tick.axis),
        };
        beside.take(&Stretch {
            codes,
            counts,
            axes,
            omega: state.sync.omega(),
            clipped: clipped.union(self.config.converter.clipped(codes)),
            units: &self.units_at_terminals(state),
        });
    }

    /// With the channels' gains and the converter's supply as they are known.
    fn units_at_terminals(&self, state: &MonitorState) -> [CodeUnits; CHANNELS] {
        let converter = &self.config.converter;
        let mut gains = converter.supply_gains(state.converter_supply.0);
        for (gain, known) in gains.iter_mut().zip(&self.config.channel_gain) {
            *gain *= known;
        }
        self.codes.at_terminals(gains)
    }

    /// Follows supply and shaft through the instants inside one turn, whose axes it notes, to the first that is more.
    #[inline]
    fn follow(&self, state: &mut MonitorState, block: &RawBlock<'_>) -> (usize, Option<SyncTick>) {
        let mut plain = 0;
        for ((codes, count), axis) in block.instants().zip(&mut state.axes.0) {
            let tick = self.follow_instant(
                (&mut state.intake, &mut state.sync, &mut state.encoder),
                codes,
                count,
            );
            if tick.restarted || tick.turn_ends.is_some() || state.sync.is_searching() {
                return (plain, Some(tick));
            }
            *axis = tick.axis;
            plain += 1;
        }
        (plain, None)
    }

    #[inline(always)]
    fn follow_instant(
        &self,
        (intake, sync, encoder): (&mut IntakeState, &mut SyncState, &mut EncoderState),
        codes: &[u16; CHANNELS],
        count: u16,
    ) -> SyncTick {
        let reference = self.reference(intake, codes);
        self.encoder.count(encoder, count);
        self.sync.update(sync, reference)
    }

    /// Uncalibrated: where the oscillator's phase stands does not matter, only that it stands there in every cycle.
    #[inline(always)]
    fn reference(&self, intake: &mut IntakeState, codes: &[u16; CHANNELS]) -> f32 {
        let [v_a, i_a, v_b, i_b, v_c, i_c] = codes.map(i32::from);
        let [per_voltage_code, per_current_code] = self.codes.reference_per_code;
        let u = (2 * v_a - v_b - v_c) as f32 * per_voltage_code;
        let i = (2 * i_a - i_b - i_c) as f32 * per_current_code;
        intake.reference([u, i], &self.reference_filter)
    }

    #[inline]
    fn sum_up(
        &self,
        state: &mut MonitorState,
        (codes, clipped): (&[[u16; CHANNELS]], ClippedChannels),
        is_watched: bool,
    ) -> ClippedChannels {
        state.count(codes.len());
        let axes = state.axes.0.get(..codes.len()).unwrap_or_default();
        let range = &self.codes.range;
        let inside = if is_watched {
            state.phasor.add_codes::<false>(codes, axes, range)
        } else {
            state.phasor.add_codes::<true>(codes, axes, range)
        };
        self.admit(state, (codes, clipped), inside)
    }

    #[inline]
    fn admit(
        &self,
        state: &mut MonitorState,
        (codes, clipped): (&[[u16; CHANNELS]], ClippedChannels),
        inside: bool,
    ) -> ClippedChannels {
        let at_rail = if inside {
            ClippedChannels::NONE
        } else {
            self.config.converter.clipped(codes)
        };
        let clipped = at_rail.union(clipped);
        state.intake.admit_codes(codes.len(), clipped);
        clipped
    }

    #[inline(never)]
    fn take_event(
        &self,
        state: &mut MonitorState,
        (codes, clipped): (&[[u16; CHANNELS]], ClippedChannels),
        tick: &SyncTick,
    ) -> Option<Report> {
        self.take_codes(state, (codes.first()?, clipped), tick)
    }

    #[inline(always)]
    fn take_codes(
        &self,
        state: &mut MonitorState,
        (codes, clipped): (&[u16; CHANNELS], ClippedChannels),
        tick: &SyncTick,
    ) -> Option<Report> {
        let [v_a, i_a, v_b, i_b, v_c, i_c] = codes.map(f32::from);
        let [volt, ampere] = self.codes.range.zero;
        let x = [
            v_a - volt,
            v_b - volt,
            v_c - volt,
            i_a - ampere,
            i_b - ampere,
            i_c - ampere,
        ];
        state.count(1);
        self.admit(state, (core::slice::from_ref(codes), clipped), false);
        self.take_instant(state, tick, &x, &self.codes.units)
    }
}
