//! `[load]`: what the shaft drives beside the motor's own friction.

mod torque;

pub use torque::{Interpolation, Load, Profile, ProfileError};

use document::{Bounds, Section};
use motor::motor_file::Nameplate;

/// What the shaft drives.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadSpec {
    /// Factor on the motor file's load friction `B_l`.
    pub friction_factor: f64,
    /// Everything else.
    pub other: Load,
}

impl Default for LoadSpec {
    /// The load friction of the motor file and nothing else.
    fn default() -> LoadSpec {
        LoadSpec {
            friction_factor: 1.0,
            other: Load::None,
        }
    }
}

impl LoadSpec {
    /// A constant torque, N m, beside the motor file's friction; `active`: it may drive the motor, as a lowered weight does.
    pub fn constant(torque: f64, active: bool) -> LoadSpec {
        LoadSpec {
            other: Load::Constant { torque, active },
            ..LoadSpec::default()
        }
    }

    /// Whether the load is friction only.
    pub fn is_linear(&self) -> bool {
        self.other == Load::None
    }
}

const FRICTION_PERCENT: Bounds = Bounds::between(0.0, 1000.0, "percent");
const TORQUE: Bounds = Bounds::between(-1e8, 1e8, "N m");
const TORQUE_PERCENT: Bounds = Bounds::between(-1000.0, 1000.0, "percent");
const QUADRATIC: Bounds = Bounds::between(0.0, 1e6, "N m s2");
const TIME: Bounds = Bounds::between(0.0, 86_400.0, "s");
const INTERPOLATIONS: [(&str, Interpolation); 2] = [
    ("step", Interpolation::Step),
    ("linear", Interpolation::Linear),
];

pub(super) fn read(root: &Section<'_>, nameplate: &Nameplate) -> Option<LoadSpec> {
    let Some(section) = root.optional_section("load")? else {
        return Some(LoadSpec::default());
    };
    let spec = read_values(&section, nameplate);
    section.finish();
    spec
}

fn read_values(section: &Section<'_>, nameplate: &Nameplate) -> Option<LoadSpec> {
    let friction = section.number_or("friction_percent", &FRICTION_PERCENT, 100.0);
    let constant = read_torque(section, nameplate, "constant_nm", "constant_percent");
    let quadratic = section.number_or("quadratic_nm_s2", &QUADRATIC, 0.0);
    let active = section.flag_or("active", false);
    let profile = read_profile(section, nameplate);
    let (active, mut loads) = (active?, Vec::new());
    if let Some(torque) = constant? {
        loads.push(Load::Constant { torque, active });
    }
    let quadratic = quadratic?;
    if quadratic > 0.0 {
        loads.push(Load::Quadratic(quadratic));
    }
    if let Some(profile) = profile? {
        loads.push(Load::Profile { profile, active });
    }
    let other = match loads.len() {
        0 => Load::None,
        1 => loads.remove(0),
        _ => Load::Sum(loads),
    };
    Some(LoadSpec {
        friction_factor: friction? / 100.0,
        other,
    })
}

/// A torque given in N m or in percent of the rated torque, not both.
fn read_torque(
    section: &Section<'_>,
    nameplate: &Nameplate,
    in_nm: &str,
    in_percent: &str,
) -> Option<Option<f64>> {
    let torque = section.optional_number(in_nm, &TORQUE);
    let percent = section.optional_number(in_percent, &TORQUE_PERCENT);
    match (torque?, percent?) {
        (Some(_), Some(_)) => {
            section.report(
                in_percent,
                format!("is given together with {in_nm}: keep one of the two"),
            );
            None
        }
        (None, Some(percent)) => Some(Some(percent / 100.0 * nameplate.torque_nm)),
        (torque, None) => Some(torque),
    }
}

fn read_profile(section: &Section<'_>, nameplate: &Nameplate) -> Option<Option<Profile>> {
    let interpolation = section.choice_or("interpolation", &INTERPOLATIONS, Interpolation::Step);
    let points: Option<Vec<_>> = section
        .sections("profile")?
        .into_iter()
        .map(|point| read_point(point, nameplate))
        .collect();
    let (interpolation, points) = (interpolation?, points?);
    if points.is_empty() {
        return Some(None);
    }
    match Profile::new(points, interpolation) {
        Ok(profile) => Some(Some(profile)),
        Err(error) => {
            section.report("profile", error.to_string());
            None
        }
    }
}

fn read_point(section: Section<'_>, nameplate: &Nameplate) -> Option<(f64, f64)> {
    let at = section.number("at_s", &TIME, "when this torque begins");
    let torque = read_torque(&section, nameplate, "torque_nm", "torque_percent");
    if torque == Some(None) {
        section.report("torque_nm", "is missing: add torque_nm or torque_percent");
    }
    section.finish();
    Some((at?, torque??))
}
