//! One window's evidence: what it shows beyond the healthy motor, how surely, and where each cause would move it.

use num_complex::Complex32;

use super::cause::Cause;
use super::directions::{Directions, Positive};
use super::healthy::{Healthy, ROWS, Row};
use super::negative::Negative;
use super::range::{Beyond, length};
use crate::checks::sensors::Phase;
use crate::model::effects::Corrected;
use crate::window::Window;
use covariance::Covariance;

/// A vector over the rows of evidence.
pub type Rows = [f32; ROWS];

/// What one window shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Departure from the healthy motor; 0 where a row is not known.
    pub departure: Rows,
    /// Whether each row is known.
    known: [bool; ROWS],
    scatter: Rows,
    /// How far the window lies beyond what the calibration saw.
    beyond: Beyond,
    positive: Directions,
    negative: Negative,
    /// Standard deviation of the angle of `Z_2`, rad.
    turn: f32,
    /// `I_2/I_1`.
    unbalance: Complex32,
    /// Rise of the resistances at which all this was computed.
    rise: f32,
    /// The rows are those of the mirror image: see [`Window`].
    backwards: bool,
}

/// Positive-sequence residuals with their directions, and how far from steady they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositiveEvidence {
    /// Rise of the resistances with which they were computed.
    pub rise: f32,
    pub residuals: Positive,
    pub directions: Directions,
    /// Standard deviation that changing currents and speeds add.
    pub unsteadiness: Positive,
    /// Whether the load is known, so that the torque balance says something about the motor.
    pub torque_known: bool,
}

impl Evidence {
    /// From voltages, currents and speed.
    pub(crate) fn new(
        healthy: &Healthy,
        window: &Window,
        measured: &Corrected,
        n_p: f32,
        positive: &PositiveEvidence,
        noise: &Rows,
    ) -> Self {
        let negative = Negative::from_voltages(window, measured, n_p);
        let mut known = healthy.scatter.map(|scatter| scatter > 0.0);
        let [torque, ..] = &mut known;
        *torque &= positive.torque_known;
        let mut scatter = healthy.scatter;
        for (scatter, noise) in scatter.iter_mut().zip(noise) {
            *scatter = scatter.max(*noise);
        }
        for (scatter, unsteady) in scatter.iter_mut().zip(positive.unsteadiness) {
            *scatter = processor::sqrtf(*scatter * *scatter + unsteady * unsteady);
        }
        let mut evidence = Evidence {
            departure: rows_with(window, &positive.residuals, negative.value),
            known,
            scatter,
            beyond: Beyond::default(),
            positive: positive.directions,
            negative,
            turn: negative.angle_left_open(&healthy.uncertainty),
            unbalance: window.i_s.unbalance(),
            rise: positive.rise,
            backwards: window.backwards,
        };
        evidence.less(&healthy.mean);
        evidence
    }

    /// From currents alone: their negative and zero sequence. `supplied`: standard deviation of what the supply may make of `I_2/I_1`.
    pub(crate) fn of_currents(
        healthy: &Healthy,
        window: &Window,
        noise: &Rows,
        supplied: f32,
    ) -> Self {
        let value = window.i_s.unbalance();
        let [re, im] = healthy.turns_axis;
        let negative = Negative {
            value,
            current: Complex32::ONE,
            turns: Complex32::new(re, im),
            ..Negative::default()
        };
        let [re, im] = healthy.current_unbalance;
        let mut mean = healthy.mean;
        let mut scatter = healthy.scatter;
        let mut known = [false; ROWS];
        for (row, m) in [
            (Row::Negative as usize, re),
            (Row::Negative as usize + 1, im),
        ] {
            set(&mut mean, row, m);
            let own = healthy.current_unbalance_scatter;
            set(&mut scatter, row, length([own, supplied]));
            set(&mut known, row, healthy.current_unbalance_scatter > 0.0);
        }
        // What a calibration has learnt of the currents' unrest holds whole windows; changes from cycle to cycle, which mostly
        // cancel in a window, would count several times.
        for (k, (scatter, noise)) in scatter.iter_mut().zip(noise).enumerate() {
            if !known.get(k).copied().unwrap_or(false) && *scatter <= 0.0 {
                *scatter = *noise;
            }
        }
        for row in [Row::ZeroCurrent as usize, Row::ZeroCurrent as usize + 1] {
            set(&mut known, row, scatter.get(row).is_some_and(|s| *s > 0.0));
        }
        let mut evidence = Evidence {
            departure: rows_of_currents(window),
            known,
            scatter,
            beyond: Beyond::default(),
            positive: Directions::default(),
            negative,
            turn: 0.0,
            unbalance: window.i_s.unbalance(),
            rise: 0.0,
            backwards: window.backwards,
        };
        evidence.less(&mean);
        evidence
    }

    /// The same where the calibration saw nothing of the kind.
    ///
    /// `saturating`: the motor file's inductance follows the flux, so none of its saturation is to be expected. `rated_torque`: on the scale
    /// of the torque balance.
    #[inline(never)]
    pub(crate) fn go_beyond(&mut self, beyond: &Beyond, saturating: bool, rated_torque: f32) {
        self.beyond = *beyond;
        let [torque, ..] = &mut self.scatter;
        let more = beyond.torque() * rated_torque;
        *torque = processor::sqrtf(*torque * *torque + more * more);
        if !saturating {
            let expected = beyond.saturation();
            let moved = self.direction(Cause::MagnetizingInductance);
            for (x, per_share) in self.departure.iter_mut().zip(moved) {
                *x -= expected * per_share;
            }
        }
    }

    /// Takes off what the healthy motor shows, as its channels a, b, c showed it when it was calibrated.
    fn less(&mut self, mean: &Rows) {
        let mean = if self.backwards {
            self.widen_negative(mean);
            mirrored(*mean)
        } else {
            *mean
        };
        let departure = self.departure.iter_mut().zip(&mean).zip(&self.known);
        for ((x, mean), known) in departure {
            *x = if *known { *x - mean } else { 0.0 };
        }
    }

    /// What turns in the mirror is known in size only: the impedance of the negative sequence stands between a channel's
    /// gain and its row.
    fn widen_negative(&mut self, mean: &Rows) {
        let row = Row::Negative as usize;
        let Some([re, im]) = mean.get(row..row + 2) else {
            return;
        };
        let square = re * re + im * im;
        for scatter in self.scatter.iter_mut().skip(row).take(2) {
            *scatter = processor::sqrtf(*scatter * *scatter + square);
        }
    }

    /// What the supply's negative sequence drops over the motor's impedance, `Z_2 I_2/V_1`, as the channels a, b, c show it.
    pub fn negative_drop(&self) -> Complex32 {
        match self.backwards {
            true => self.negative.drop.conj(),
            false => self.negative.drop,
        }
    }

    /// The departure as the channels a, b, c show it: what a calibration keeps, in whichever direction the motor ran.
    pub fn in_channels(&self) -> Rows {
        if self.backwards {
            mirrored(self.departure)
        } else {
            self.departure
        }
    }

    /// Whether each row is known.
    pub fn known(&self) -> &[bool; ROWS] {
        &self.known
    }

    /// Where a cause moves the evidence, per relative change.
    #[inline(never)]
    pub fn direction(&self, cause: Cause) -> Rows {
        let (d, n) = (&self.positive, &self.negative);
        let no = Complex32::ZERO;
        match cause {
            Cause::StatorResistance => self.all(&d.r_s, n.drop * n.growth.r_s),
            Cause::RotorResistance => self.all(&d.r_r, n.drop * n.growth.r_r),
            Cause::MagnetizingInductance => self.all(&d.l_m, n.drop * n.growth.l_m),
            Cause::Leakage => self.all(&d.leakage, n.drop * n.growth.leakage),
            Cause::Friction => self.all(&d.friction, no),
            Cause::AllCurrents => self.all(&d.current, -n.drop),
            Cause::AllVoltages => self.all(&d.voltage, n.drop),
            Cause::SpeedGain => self.all(&d.speed, no),
            Cause::SeriesResistance(phase) => {
                let current = self.current_in(phase);
                self.one(&d.r_s, n.series * current, [no, no])
            }
            Cause::Turns(phase) => {
                let (axis, _) = axes(phase, self.backwards);
                self.one(&d.turns, n.turns * axis, [no, no])
            }
            Cause::CurrentChannel(phase) => {
                let (axis, zero) = axes(phase, self.backwards);
                self.one(&d.current, n.current * axis, [zero, no])
            }
            Cause::VoltageChannel(phase) => {
                let (axis, zero) = axes(phase, self.backwards);
                self.one(&d.voltage, n.voltage * axis, [no, zero])
            }
        }
    }

    /// A second direction of a cause, where it has one ([`Cause::adds_across`]).
    ///
    /// The loop of shorted turns has a resistance and a leakage: its current lags its voltage by anything up to a quarter of a turn.
    /// Currents alone could put any angle into one phase or another. `V_2 - Z_2 I_2` shows shorted turns and gains as they are,
    /// whatever the believed `Z_2` is; a resistance in series draws `I_2 = -R I_1/(3 Z_2)` through the motor's own impedance: its row
    /// is turned by the angle between both.
    pub(crate) fn across(&self, cause: Cause) -> Option<Rows> {
        let (positive, negative) = match cause {
            Cause::Turns(phase) => {
                let (axis, _) = axes(phase, self.backwards);
                let lagging = self.negative.turns * axis * -Complex32::I;
                (self.positive.turns_lagging, lagging)
            }
            Cause::SeriesResistance(phase) => {
                let turned = Complex32::new(0.0, self.turn);
                let series = self.negative.series * self.current_in(phase);
                ([0.0; 3], series * turned)
            }
            _ => return None,
        };
        let rows = self.one(&positive, negative, [Complex32::ZERO; 2]);
        self.has_voltages().then_some(rows)
    }

    #[inline(never)]
    fn all(&self, positive: &Positive, negative: Complex32) -> Rows {
        self.masked(assemble(positive, negative, [Complex32::ZERO; 2]))
    }

    fn has_voltages(&self) -> bool {
        self.negative.voltage != Complex32::ZERO
    }

    /// A phase's own current as its drop enters the negative sequence, per positive sequence: of three wires without a neutral.
    fn current_in(&self, phase: Phase) -> Complex32 {
        let (axis, _) = axes(phase, self.backwards);
        axis + self.unbalance
    }

    /// A third of what all phases would show: `negative` and `zero` hold the phase's axis already.
    #[inline(never)]
    fn one(&self, positive: &Positive, negative: Complex32, zero: [Complex32; 2]) -> Rows {
        let third = 1.0 / 3.0;
        let rows = assemble(
            &positive.map(|x| x * third),
            negative * third,
            zero.map(|x| x * third),
        );
        self.masked(rows)
    }

    #[inline(never)]
    fn masked(&self, mut rows: Rows) -> Rows {
        for (x, known) in rows.iter_mut().zip(&self.known) {
            if !known {
                *x = 0.0;
            }
        }
        rows
    }

    /// Where the two resistances move the evidence.
    pub(crate) fn resistances(&self) -> Resistances {
        Resistances {
            stator: self.direction(Cause::StatorResistance),
            rotor: self.direction(Cause::RotorResistance),
        }
    }

    /// Departure from the healthy motor whose resistances have risen by the first share, the cage's by the second beyond the
    /// winding's.
    pub(crate) fn departure_at(&self, along: &Resistances, [rise, apart]: [f32; 2]) -> Rows {
        let mut departure = self.departure;
        let moved = along.heating().into_iter().zip(along.parting());
        for (x, (per_rise, per_share)) in departure.iter_mut().zip(moved) {
            *x -= (rise - self.rise) * per_rise + apart * per_share;
        }
        departure
    }

    /// Covariance of the healthy motor's departures. The rise of its resistances is known up to the first deviation, how far they
    /// are apart up to the second.
    #[inline(never)]
    pub(crate) fn covariance(
        &self,
        healthy: &Healthy,
        along: &Resistances,
        [heating, parting]: [f32; 2],
    ) -> Covariance<ROWS> {
        let mut own = self.scatter;
        for (scatter, known) in own.iter_mut().zip(&self.known) {
            *scatter = if *known { *scatter } else { 1.0 };
        }
        let mut covariance = Covariance::of_independent(&own);
        let widened;
        let u = if self.beyond.is_within() {
            &healthy.uncertainty
        } else {
            widened = healthy.uncertainty.and(&self.beyond.added());
            &widened
        };
        let of_all = [
            (Cause::MagnetizingInductance, u.magnetizing_inductance),
            (Cause::Leakage, u.leakage),
            (Cause::Friction, u.friction),
            (Cause::SpeedGain, u.speed),
        ];
        covariance.add(&along.stator, u.stator_resistance);
        covariance.add(&along.rotor, u.rotor_resistance);
        for (cause, deviation) in of_all {
            covariance.add(&self.direction(cause), deviation);
        }
        covariance.add(&along.heating(), heating);
        covariance.add(&along.parting(), parting);
        for phase in Phase::ALL {
            covariance.add(
                &self.direction(Cause::CurrentChannel(phase)),
                u.current_gain,
            );
            covariance.add(
                &self.direction(Cause::VoltageChannel(phase)),
                u.voltage_gain,
            );
        }
        if !self.beyond.is_within() {
            let no = Complex32::ZERO;
            let in_phase = self.masked(assemble(&self.positive.turns, no, [no, no]));
            covariance.add(&in_phase, self.beyond.iron_loss(u.iron_loss));
        }
        self.add_negative_impedance(&mut covariance, healthy);
        covariance
    }

    /// The drop over the negative sequence's impedance may be wrong in size and in angle. What the calibration saw of that error is in the mean.
    fn add_negative_impedance(&self, covariance: &mut Covariance<ROWS>, healthy: &Healthy) {
        let no = Complex32::ZERO;
        let [re, im] = healthy.negative_drop;
        // Of a motor that runs the other way the mean is known in size only, and widened by it.
        let seen = if self.backwards {
            no
        } else {
            Complex32::new(re, im)
        };
        let deviation = healthy.uncertainty.negative_impedance;
        for turn in [Complex32::ONE, Complex32::I] {
            let rows = assemble(&[0.0; 3], (self.negative.drop - seen) * turn, [no, no]);
            covariance.add(&self.masked(rows), deviation);
        }
    }
}

/// Where the two resistances move the evidence, per relative change; rows as they are or whitened.
pub(crate) struct Resistances {
    /// Direction of the stator resistance.
    pub stator: Rows,
    /// Direction of the rotor resistance.
    pub rotor: Rows,
}

impl Resistances {
    /// Heating moves both by the same ratio.
    pub fn heating(&self) -> Rows {
        let mut sum = self.stator;
        sum.iter_mut().zip(&self.rotor).for_each(|(x, y)| *x += y);
        sum
    }

    /// A cage that warms more than its winding: what its resistance has risen by beyond the winding's, half up and half down.
    pub fn parting(&self) -> Rows {
        let mut half = self.rotor;
        let stator = half.iter_mut().zip(&self.stator);
        stator.for_each(|(x, y)| *x = 0.5 * (*x - y));
        half
    }

    /// The same rows, each direction passed through `f`.
    pub fn map(&self, f: impl Fn(&Rows) -> Rows) -> Self {
        Resistances {
            stator: f(&self.stator),
            rotor: f(&self.rotor),
        }
    }
}

/// What a window shows: residuals of the positive sequence, negative and zero sequences.
pub(crate) fn rows_of(
    window: &Window,
    measured: &Corrected,
    n_p: f32,
    positive: &Positive,
) -> Rows {
    let negative = Negative::from_voltages(window, measured, n_p);
    rows_with(window, positive, negative.value)
}

/// What a window of currents alone shows.
pub(crate) fn rows_of_currents(window: &Window) -> Rows {
    let zero = [window.i_s.zero_ratio(), Complex32::ZERO];
    assemble(&[0.0; 3], window.i_s.unbalance(), zero)
}

fn rows_with(window: &Window, positive: &Positive, negative: Complex32) -> Rows {
    let zero = [window.i_s.zero_ratio(), window.u_s.zero_ratio()];
    assemble(positive, negative, zero)
}

/// Axes on which a change in one phase enters the negative and the zero sequence; backwards phases b and c change places.
fn axes(phase: Phase, backwards: bool) -> (Complex32, Complex32) {
    let third = Complex32::new(-0.5, 0.866_025_4);
    let turn = if backwards { third.conj() } else { third };
    match phase {
        Phase::A => (Complex32::ONE, Complex32::ONE),
        Phase::B => (turn, turn.conj()),
        Phase::C => (turn.conj(), turn),
    }
}

/// Rows of the mirror image: negative and zero sequences are conjugate.
fn mirrored(mut rows: Rows) -> Rows {
    for row in [Row::Negative, Row::ZeroCurrent, Row::ZeroVoltage] {
        if let Some(imaginary) = rows.get_mut(row as usize + 1) {
            *imaginary = -*imaginary;
        }
    }
    rows
}

fn assemble(
    [torque, e_d, e_q]: &Positive,
    negative: Complex32,
    [current, voltage]: [Complex32; 2],
) -> Rows {
    [
        *torque,
        *e_d,
        *e_q,
        negative.re,
        negative.im,
        current.re,
        current.im,
        voltage.re,
        voltage.im,
    ]
}

fn set<T>(rows: &mut [T], row: usize, value: T) {
    if let Some(place) = rows.get_mut(row) {
        *place = value;
    }
}
