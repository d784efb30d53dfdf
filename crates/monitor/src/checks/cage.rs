//! From which sideband on a cage is doubtful, and from which on bars count as broken: by the motor's own healthy sidebands
//! where a calibration knows them, by the number of its bars where the plate gives it, else by what holds for most motors.

use core::f32::consts::TAU;

use crate::checks::rotor_bars::Sidebands;

/// Lower sideband of the healthy motor, at a light and at a heavy load; twice the same where only one load was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HealthySidebands {
    /// Active currents, as shares of the rated current, the smaller first, > 0.
    pub at: [f32; 2],
    /// Lower sidebands there, as shares of the active current, >= 0.
    pub lower: [f32; 2],
    /// Standard deviation from block to block, share of the active current, >= 0.
    pub scatter: f32,
}

/// What is known of the cage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cage {
    /// Rotor bars; 0: not known.
    pub bars: f32,
    /// Sidebands of the healthy motor.
    pub healthy: Option<HealthySidebands>,
}

/// Lower sidebands between which the answers change, as shares of the active current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CageLimits {
    /// From here on the cage is doubtful.
    pub doubtful: f32,
    /// From here on bars count as broken.
    pub broken: f32,
    /// What the healthy motor showed at this load.
    pub healthy: Option<f32>,
}

/// The cage as one report shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RotorReading {
    /// What the block says that this window ended; blocks are whole turns of twice the slip angle, one to some seconds.
    pub sidebands: Option<Sidebands>,
    /// The limits that hold for that block.
    pub limits: Option<CageLimits>,
    /// Bars count as broken: block after block they said so.
    pub is_broken: bool,
}

/// Power factor by which limits that are published against the whole current are turned into shares of the active one.
const POWER_FACTOR: f32 = 0.8;
/// Share of what one bar leaves from which on bars count as broken. Currents between the bars and the inertia of the shaft
/// make a real sideband smaller than the formula's.
const SHARE_OF_ONE: f32 = 0.5;

/// A rise that counts, in standard deviations of one block. Three blocks in a row must show it.
const DEVIATIONS: f32 = 4.0;
/// A rise that counts, as a share of the healthy sideband: 3.5 dB.
const RISE: f32 = 0.5;
/// Least rise that counts, share of the active current: what loads and windings of another temperature move.
const LEAST_RISE: f32 = 0.0025;
/// Share of the rise from which on a cage is doubtful.
const DOUBT: f32 = 0.5;

impl Cage {
    /// Nothing known of it.
    pub const UNKNOWN: Cage = Cage {
        bars: 0.0,
        healthy: None,
    };
    /// Doubtful from here on without a calibration. Practice reads a sideband 54 to 60 dB below the current as good, 42 to
    /// 48 dB as a crack, and 36 to 42 dB as a broken bar (vendors' charts; 48 dB are 0.4 % of the current, 0.5 % of the
    /// active one at a power factor of 0.8).
    pub const DOUBTFUL: f32 = 0.005;
    /// Broken from here on, where nothing is known: 40 dB below the current, 1.0 % of it.
    pub const BROKEN: f32 = 0.0125;
    /// Bars count as broken from here on at least, however many there are: 44 dB below the current. A whole cage of a
    /// measured motor left 0.57 %.
    pub const LEAST_BROKEN: f32 = 0.008;

    /// The limits at an active current, share of the rated one.
    pub fn limits(&self, active: f32, pole_pairs: f32) -> CageLimits {
        match &self.healthy {
            Some(healthy) => healthy.limits(active.abs()),
            None => CageLimits {
                doubtful: Self::DOUBTFUL,
                broken: self.broken_without_calibration(pole_pairs),
                healthy: None,
            },
        }
    }

    fn broken_without_calibration(&self, pole_pairs: f32) -> f32 {
        let one = one_bar(self.bars, pole_pairs);
        let share = SHARE_OF_ONE * one / POWER_FACTOR;
        if share > Self::LEAST_BROKEN {
            share.min(Self::BROKEN)
        } else if one > 0.0 {
            Self::LEAST_BROKEN
        } else {
            Self::BROKEN
        }
    }
}

/// What one broken bar of `bars` leaves at `(1 - 2 s)` of the supply's frequency, as a share of the current:
/// `sin a/(2 p (2 pi - a))`, `a = 2 pi p/N` (Deleroi 1984). 0 where that says nothing.
fn one_bar(bars: f32, pole_pairs: f32) -> f32 {
    // Fewer than two bars a pole are no cage.
    if bars < 4.0 * pole_pairs {
        return 0.0;
    }
    let angle = TAU * pole_pairs / bars;
    sine(angle) / (2.0 * pole_pairs * (TAU - angle))
}

/// Of angles up to a quarter of a turn: Taylor to the seventh power, within 1.6e-4. The library's sine reaches double precision, which
/// the board's processor has only in software.
fn sine(angle: f32) -> f32 {
    let square = angle * angle;
    angle * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0)))
}

impl HealthySidebands {
    /// A straight line between both loads. Beyond them their own values hold, and the limits rise with the distance: in
    /// one measured motor the sideband of the whole cage changed by half over a third of the rated load.
    fn limits(&self, active: f32) -> CageLimits {
        let ([light, heavy], [first, last]) = (self.at, self.lower);
        let span = heavy - light;
        let way = if span > 0.0 {
            ((active - light) / span).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let healthy = first + way * (last - first);
        let beyond = (light - active).max(active - heavy).max(0.0);
        let rise = (DEVIATIONS * self.scatter)
            .max(RISE * healthy)
            .max(LEAST_RISE);
        CageLimits {
            doubtful: (healthy + DOUBT * rise) * (1.0 + beyond),
            broken: (healthy + rise) * (1.0 + beyond),
            healthy: Some(healthy),
        }
    }
}

impl CageLimits {
    /// Over what counts as broken; NaN where something else shook the current.
    pub fn normalised(&self, sidebands: &Sidebands) -> f32 {
        let share = sidebands.lower / self.broken;
        if share < 1.0 || sidebands.may_be_bars() {
            share
        } else {
            f32::NAN
        }
    }

    /// Whether a swing of the load hides what would be doubtful or broken.
    pub fn is_hidden(&self, sidebands: &Sidebands) -> bool {
        sidebands.is_swing() && sidebands.lower >= self.doubtful
    }

    /// Whether a line that stands clear lies from where the cage is doubtful on.
    pub fn raises_doubt(&self, sidebands: &Sidebands) -> bool {
        sidebands.may_be_bars() && sidebands.lower >= self.doubtful
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn percent(x: f32) -> f32 {
        0.01 * x
    }

    fn block(lower_percent: f32) -> Sidebands {
        Sidebands {
            lower: percent(lower_percent),
            upper: 0.0,
            from_speed: 0.0,
            from_cage: percent(lower_percent),
            beside: 0.0,
            active: 1.0,
        }
    }

    fn answer(limits: &CageLimits, lower_percent: f32) -> &'static str {
        let block = block(lower_percent);
        match (
            limits.normalised(&block) >= 1.0,
            limits.raises_doubt(&block),
        ) {
            (true, _) => "broken",
            (false, true) => "doubtful",
            (false, false) => "whole",
        }
    }

    /// Sidebands of a real motor with 0, 1, 2, 3 broken bars, percent of the active current, lightly and heavily loaded.
    const AT_1420_RPM: [f32; 4] = [0.37, 0.88, 0.79, 1.27];
    const AT_1380_RPM: [f32; 4] = [0.57, 0.63, 0.75, 1.06];
    /// Active currents there: slips of 80 and 120 rpm of 1500; only their order and ratio matter.
    const LIGHT: f32 = 0.67;
    const HEAVY: f32 = 1.0;

    fn answers(cage: &Cage) -> [[&'static str; 4]; 2] {
        let at = |active, lower: [f32; 4]| lower.map(|x| answer(&cage.limits(active, 2.0), x));
        [at(LIGHT, AT_1420_RPM), at(HEAVY, AT_1380_RPM)]
    }

    fn calibrated(at: [f32; 2], lower_percent: [f32; 2]) -> Cage {
        Cage {
            healthy: Some(HealthySidebands {
                at,
                lower: lower_percent.map(percent),
                scatter: percent(0.03),
            }),
            ..Cage::UNKNOWN
        }
    }

    /// At the heavy load one bar moved the sideband by a tenth of the healthy one: nothing tells it from the whole cage.
    #[test]
    fn a_calibrated_real_motor_is_called_broken_where_its_sideband_rose_by_half() {
        let both = calibrated([LIGHT, HEAVY], [AT_1420_RPM[0], AT_1380_RPM[0]]);
        assert_eq!(
            answers(&both),
            [
                ["whole", "broken", "broken", "broken"],
                ["whole", "whole", "doubtful", "broken"]
            ]
        );
    }

    /// One load of the same motor calibrated, the other one watched: the whole cage is never called broken.
    #[test]
    fn a_real_motor_calibrated_at_one_load_is_not_broken_at_the_other() {
        let light = calibrated([LIGHT; 2], [AT_1420_RPM[0]; 2]);
        assert_eq!(answers(&light)[1], ["whole", "whole", "doubtful", "broken"]);
        let heavy = calibrated([HEAVY; 2], [AT_1380_RPM[0]; 2]);
        assert_eq!(answers(&heavy)[0], ["whole", "whole", "whole", "broken"]);
    }

    #[test]
    fn an_uncalibrated_real_motor_is_doubted_before_it_is_called_broken() {
        let doubted = ["doubtful"; 4];
        assert_eq!(
            answers(&Cage::UNKNOWN),
            [["whole", "doubtful", "doubtful", "broken"], doubted]
        );
        let of_44 = Cage {
            bars: 44.0,
            ..Cage::UNKNOWN
        };
        assert_eq!(
            answers(&of_44),
            [
                ["whole", "broken", "doubtful", "broken"],
                ["doubtful", "doubtful", "doubtful", "broken"]
            ]
        );
    }

    #[test]
    fn the_sine_holds_up_to_a_quarter_of_a_turn() {
        for step in 0..=90_u8 {
            let angle = f32::from(step).to_radians();
            assert!((sine(angle) - angle.sin()).abs() < 1.6e-4, "{step}");
        }
    }

    /// By hand: `a = 4 pi/28 = 0.4488`, `sin a = 0.4339`, `4 (2 pi - a) = 23.34`.
    #[test]
    fn one_bar_of_28_leaves_deleroi_s_share() {
        assert!((one_bar(28.0, 2.0) - 0.01859).abs() < 1e-5);
        let broken = |bars| {
            let cage = Cage {
                bars,
                ..Cage::UNKNOWN
            };
            cage.limits(1.0, 2.0).broken
        };
        assert!((broken(28.0) - 0.5 * 0.01859 / 0.8).abs() < 1e-5);
        assert_eq!(broken(16.0), Cage::BROKEN);
        assert_eq!(broken(60.0), Cage::LEAST_BROKEN);
        for says_nothing in [0.0, 3.0, 7.9] {
            assert_eq!(broken(says_nothing), Cage::BROKEN);
        }
    }

    #[test]
    fn a_quiet_cage_needs_a_rise_that_a_bar_could_make_and_a_restless_one_more() {
        let limits = |lower, scatter| {
            let healthy = HealthySidebands {
                at: [0.5, 1.0],
                lower: [lower; 2],
                scatter,
            };
            healthy.limits(0.7)
        };
        assert!((limits(1e-4, 0.0).broken - 0.0026).abs() < 1e-6);
        assert!((limits(4e-3, 2e-3).broken - 0.012).abs() < 1e-6);
        assert!((limits(0.02, 0.0).broken - 0.03).abs() < 1e-6);
    }

    #[test]
    fn limits_are_the_same_for_a_generator_and_wider_beyond_what_was_calibrated() {
        let cage = calibrated([0.5, 1.0], [0.4, 0.6]);
        let at = |active: f32| cage.limits(active, 2.0).broken;
        assert_eq!(at(-0.75), at(0.75));
        assert!((at(0.75) - percent(0.75)).abs() < 1e-6);
        assert!(at(0.3) > at(0.5) && at(1.3) > at(1.0));
    }

    #[test]
    fn a_line_that_is_not_clear_says_nothing_from_the_limit_on() {
        let limits = Cage::UNKNOWN.limits(1.0, 2.0);
        let shaken = |lower| Sidebands {
            beside: 0.5 * percent(lower),
            ..block(lower)
        };
        assert!(limits.normalised(&shaken(1.3)).is_nan());
        assert!(limits.normalised(&shaken(0.6)) < 1.0);
        assert!(!limits.raises_doubt(&shaken(0.6)));
    }
}
