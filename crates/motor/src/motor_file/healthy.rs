//! `[healthy]`: what `calibrate` learned of the healthy motor; with it FAULT follows the direction of the evidence.

use document::{Bounds, Section};

use crate::InMotion;

/// Rows of evidence: torque balance, `e_d`, `e_q`, then real and imaginary part of the negative sequence's balance, of the
/// zero sequence of the currents and of that of the voltages.
pub const EVIDENCE_ROWS: usize = 9;

/// Lower sidebands of a healthy cage at a light and at a heavy load; twice the same where only one was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HealthyRotor {
    /// Active currents, percent of the rated current, the smaller first.
    pub active_percent: [f64; 2],
    /// Current at `(1 - 2 s)` times the supply's frequency there, percent of the active current.
    pub sideband_percent: [f64; 2],
    /// Its standard deviation from block to block, percent of the active current.
    pub scatter_percent: f64,
}

/// Where the windows of a calibration lay; what is known of the motor holds there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibratedRange {
    /// Largest positive-sequence current, percent of the rated one.
    pub current_percent: f64,
    /// Smallest and largest voltage over frequency, percent of the rated ones.
    pub volt_per_hertz_percent: [f64; 2],
    /// Lowest and highest supply frequency, percent of the rated one.
    pub frequency_percent: [f64; 2],
    /// Smallest active current, percent of the rated current; below 0 the motor fed it back, as a hoist does when it lowers.
    pub active_percent: f64,
}

/// Statistics of the healthy motor, percent of each row's scale or of each quantity's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HealthySettings {
    /// What the healthy motor shows in each row.
    pub mean_percent: [f64; EVIDENCE_ROWS],
    /// How much that scatters; 0: not calibrated.
    pub scatter_percent: [f64; EVIDENCE_ROWS],
    /// `I_2/I_1`, real and imaginary part.
    pub current_unbalance_percent: [f64; 2],
    /// Scatter of `I_2/I_1`; 0: not calibrated.
    pub current_unbalance_scatter_percent: f64,
    /// Positive sequence of the currents at which it was learnt, percent of the rated current; 0: not said.
    pub current_unbalance_at_percent: f64,
    /// Standard deviation of the supply's unbalance from one time to another where no voltages are measured.
    pub supply_unbalance_percent: f64,
    /// What the supply's negative sequence dropped over the motor's impedance, `Z_2 I_2/V_1`: real and imaginary part.
    pub negative_drop_percent: [f64; 2],
    /// Angle by which the current of shorted turns leads the motor's, degrees.
    pub turns_angle_deg: f64,
    /// Standard uncertainty of the stator resistance, off the direction of heating.
    pub stator_resistance_percent: f64,
    /// Standard uncertainty of the rotor resistance, off the direction of heating.
    pub rotor_resistance_percent: f64,
    /// Range of both resistances together, from the winding's temperature.
    pub heating_percent: f64,
    /// Standard uncertainty of the magnetizing inductance.
    pub magnetizing_inductance_percent: f64,
    /// Standard uncertainty of the leakage inductances.
    pub leakage_percent: f64,
    /// Standard uncertainty of friction.
    pub friction_percent: f64,
    /// Standard uncertainty of each current channel's gain.
    pub current_gain_percent: f64,
    /// Standard uncertainty of each voltage channel's gain.
    pub voltage_gain_percent: f64,
    /// Standard uncertainty of the speed.
    pub speed_percent: f64,
    /// Standard uncertainty of the current that feeds the losses of the iron at rated voltage, percent of the rated current.
    pub iron_loss_percent: f64,
    /// Standard uncertainty of the negative sequence's impedance.
    pub negative_impedance_percent: f64,
    /// Where the calibration saw the motor; `None`: nothing says.
    pub range: Option<CalibratedRange>,
    /// Standard deviations at which FAULT lights.
    pub significance: f64,
    /// Sidebands of the rotor's bars; `None`: not calibrated.
    pub rotor: Option<HealthyRotor>,
    /// How the motor in good order moved, beside how its file says.
    pub in_motion: InMotion,
}

impl Default for HealthySettings {
    /// Nothing calibrated; what drifts in a careful installation: winding temperatures of stator and rotor apart by 2.5 K,
    /// inductances hardly, bearings and seals, dividers and transformers of class 0.2, a quartz; iron losses are 1 to 3 % of the rated power.
    fn default() -> Self {
        HealthySettings {
            mean_percent: [0.0; EVIDENCE_ROWS],
            scatter_percent: [0.0; EVIDENCE_ROWS],
            current_unbalance_percent: [0.0; 2],
            current_unbalance_scatter_percent: 0.0,
            current_unbalance_at_percent: 0.0,
            supply_unbalance_percent: SUPPLY_UNBALANCE_PERCENT,
            negative_drop_percent: [0.0; 2],
            turns_angle_deg: TURNS_ANGLE_DEG,
            stator_resistance_percent: 1.0,
            rotor_resistance_percent: 1.0,
            heating_percent: 30.0,
            magnetizing_inductance_percent: 0.2,
            leakage_percent: 0.5,
            friction_percent: 2.0,
            current_gain_percent: 0.2,
            voltage_gain_percent: 0.2,
            speed_percent: 0.01,
            iron_loss_percent: 1.5,
            negative_impedance_percent: 10.0,
            range: None,
            significance: 5.5,
            rotor: None,
            in_motion: InMotion::Unseen,
        }
    }
}

/// A short's current is nearly in phase with its voltage, which an idle motor's current lags by 70 to 80 degrees; on a
/// measured 0.75 hp motor without load 70.
const TURNS_ANGLE_DEG: f64 = 70.0;

/// A public supply stays below 2 % in nearly all ten minutes (EN 50160): as much is 5.5 of these deviations, where FAULT lights.
const SUPPLY_UNBALANCE_PERCENT: f64 = 0.35;

const MEAN: Bounds = Bounds::between(-1000.0, 1000.0, "percent");
const SHARE: Bounds = Bounds::between(0.0, 1000.0, "percent");
const ANGLE: Bounds = Bounds::between(-360.0, 360.0, "degrees");
const SIDEBAND: Bounds = Bounds::between(0.0, 100.0, "percent");
const ACTIVE: Bounds = Bounds::between(1.0, 1000.0, "percent");
const SIGNIFICANCE: Bounds = Bounds::between(1.0, 1000.0, "standard deviations");

pub(super) fn read(root: &Section<'_>) -> Option<Option<HealthySettings>> {
    let Some(section) = root.optional_section("healthy")? else {
        return Some(None);
    };
    let settings = read_values(&section);
    section.finish();
    settings.map(Some)
}

fn read_values(section: &Section<'_>) -> Option<HealthySettings> {
    let base = HealthySettings::default();
    let rows = |key, bounds: &Bounds| {
        let read = section.optional_numbers::<EVIDENCE_ROWS>(key, bounds)?;
        Some(read.unwrap_or([0.0; EVIDENCE_ROWS]))
    };
    let share = |key, default| section.number_or(key, &SHARE, default);
    let mean = rows("mean_percent", &MEAN);
    let scatter = rows("scatter_percent", &SHARE);
    let unbalance = section.optional_numbers::<2>("current_unbalance_percent", &MEAN);
    let drop = section.optional_numbers::<2>("negative_drop_percent", &MEAN);
    let numbers = base.shares().map(|(key, default)| share(key, default));
    let angle = section.number_or("turns_angle_deg", &ANGLE, base.turns_angle_deg);
    let significance = section.number_or("significance", &SIGNIFICANCE, base.significance);
    let rotor = read_rotor(section);
    let range = read_range(section);
    let in_motion = section.choice_or("in_motion", &InMotion::CHOICE, base.in_motion);
    let mut settings = HealthySettings {
        mean_percent: mean?,
        scatter_percent: scatter?,
        current_unbalance_percent: unbalance?.unwrap_or_default(),
        negative_drop_percent: drop?.unwrap_or_default(),
        turns_angle_deg: angle?,
        significance: significance?,
        rotor: rotor?,
        range: range?,
        in_motion: in_motion?,
        ..base
    };
    for (place, number) in settings.share_places().into_iter().zip(numbers) {
        *place = number?;
    }
    Some(settings)
}

fn read_rotor(section: &Section<'_>) -> Option<Option<HealthyRotor>> {
    let sideband = section.optional_numbers::<2>("rotor_sideband_percent", &SIDEBAND);
    let active = section.optional_numbers::<2>("rotor_active_percent", &ACTIVE);
    let scatter = section.number_or("rotor_sideband_scatter_percent", &SIDEBAND, 0.0);
    let (sideband, active, scatter) = (sideband?, active?, scatter?);
    let [light, heavy] = active.unwrap_or([100.0; 2]);
    Some(sideband.map(|[first, last]| {
        // Loads in either order.
        let (active_percent, sideband_percent) = if light <= heavy {
            ([light, heavy], [first, last])
        } else {
            ([heavy, light], [last, first])
        };
        HealthyRotor {
            active_percent,
            sideband_percent,
            scatter_percent: scatter,
        }
    }))
}

fn read_range(section: &Section<'_>) -> Option<Option<CalibratedRange>> {
    let [current, volt_per_hertz, frequency] = RANGE_KEYS;
    let current_percent = section.optional_number(current, &SHARE);
    let volt_per_hertz_percent = section.optional_numbers::<2>(volt_per_hertz, &SHARE);
    let frequency_percent = section.optional_numbers::<2>(frequency, &SHARE);
    let active_percent = section.optional_number(ACTIVE_KEY, &MEAN)?.unwrap_or(0.0);
    let ordered = |[low, high]: [f64; 2]| [low.min(high), low.max(high)];
    match (
        current_percent?,
        volt_per_hertz_percent?,
        frequency_percent?,
    ) {
        (None, None, None) => Some(None),
        (Some(current_percent), Some(volt_per_hertz), Some(frequency)) => {
            Some(Some(CalibratedRange {
                current_percent,
                volt_per_hertz_percent: ordered(volt_per_hertz),
                frequency_percent: ordered(frequency),
                active_percent,
            }))
        }
        _ => {
            let there = RANGE_KEYS.into_iter().find(|key| section.has(key));
            let lacking = RANGE_KEYS.into_iter().filter(|key| !section.has(key));
            let lacking: Vec<&str> = lacking.collect();
            section.report(
                there.unwrap_or(current),
                format!(
                    "also write {}: the three belong together",
                    lacking.join(" and ")
                ),
            );
            None
        }
    }
}

/// Keys of [`CalibratedRange`].
pub(super) const RANGE_KEYS: [&str; 3] = [
    "calibrated_current_percent",
    "calibrated_volt_per_hertz_percent",
    "calibrated_frequency_percent",
];

/// Key of the smallest active current, which may be absent.
pub(super) const ACTIVE_KEY: &str = "calibrated_active_percent";

/// How many plain shares there are.
const SHARES: usize = 14;

impl HealthySettings {
    /// The plain shares by their keys, in the order of the file.
    pub(super) fn shares(&self) -> [(&'static str, f64); SHARES] {
        let keys = [
            "current_unbalance_scatter_percent",
            "current_unbalance_at_percent",
            "supply_unbalance_percent",
            "stator_resistance_percent",
            "rotor_resistance_percent",
            "heating_percent",
            "magnetizing_inductance_percent",
            "leakage_percent",
            "friction_percent",
            "current_gain_percent",
            "voltage_gain_percent",
            "speed_percent",
            "iron_loss_percent",
            "negative_impedance_percent",
        ];
        let mut copy = *self;
        let mut values = copy.share_places().into_iter();
        keys.map(|key| (key, values.next().map_or(0.0, |value| *value)))
    }

    fn share_places(&mut self) -> [&mut f64; SHARES] {
        [
            &mut self.current_unbalance_scatter_percent,
            &mut self.current_unbalance_at_percent,
            &mut self.supply_unbalance_percent,
            &mut self.stator_resistance_percent,
            &mut self.rotor_resistance_percent,
            &mut self.heating_percent,
            &mut self.magnetizing_inductance_percent,
            &mut self.leakage_percent,
            &mut self.friction_percent,
            &mut self.current_gain_percent,
            &mut self.voltage_gain_percent,
            &mut self.speed_percent,
            &mut self.iron_loss_percent,
            &mut self.negative_impedance_percent,
        ]
    }
}
