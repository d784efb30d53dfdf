//! `[parameters]`: the T model and the mechanics.

use super::Nameplate;
use crate::{Mechanics, TParams};
use document::{Bounds, Section};

pub(super) struct Parameters {
    pub(super) t_model: TParams<f64>,
    pub(super) temperature_degc: Option<f64>,
    pub(super) mechanics: Mechanics<f64>,
}

const RESISTANCE: Bounds = Bounds::above(0.0, 1e5, "ohm");
const LEAKAGE: Bounds =
    Bounds::between(0.0, 100.0, "H").hint("henry, not millihenry, not the reactance in ohm");
const MAGNETIZING: Bounds =
    Bounds::above(0.0, 1000.0, "H").hint("henry, not millihenry, not the reactance in ohm");
const INERTIA: Bounds = Bounds::above(0.0, 1e6, "kg m2");
const FRICTION: Bounds = Bounds::between(0.0, 1e6, "N m s");
/// Copper and aluminium windings outside this range are not in service.
const TEMPERATURE: Bounds = Bounds::between(-100.0, 400.0, "degC");

pub(super) fn read(root: &Section<'_>, nameplate: Option<&Nameplate>) -> Option<Parameters> {
    let section = root.section("parameters", "the T model referred to the stator")?;
    let t_model = read_t_model(&section);
    let temperature = section.optional_number("temperature_degc", &TEMPERATURE);
    let mechanics = read_mechanics(&section);
    if let Some(t_model) = &t_model {
        check_leakage(&section, t_model);
    }
    section.finish();
    let mechanics = mechanics?;
    Some(Parameters {
        t_model: t_model?,
        temperature_degc: temperature?,
        mechanics: Mechanics {
            n_p: f64::from(nameplate?.pole_pairs),
            ..mechanics
        },
    })
}

fn read_t_model(section: &Section<'_>) -> Option<TParams<f64>> {
    let r_s = section.number("stator_resistance_ohm", &RESISTANCE, "stator resistance");
    let r_r = section.number(
        "rotor_resistance_ohm",
        &RESISTANCE,
        "rotor resistance referred to the stator",
    );
    let l_ls = section.number("stator_leakage_henry", &LEAKAGE, "stator leakage");
    let l_lr = section.number(
        "rotor_leakage_henry",
        &LEAKAGE,
        "rotor leakage referred to the stator",
    );
    let l_m = section.number(
        "magnetizing_inductance_henry",
        &MAGNETIZING,
        "magnetizing inductance",
    );
    Some(TParams {
        r_s: r_s?,
        r_r: r_r?,
        l_ls: l_ls?,
        l_lr: l_lr?,
        l_m: l_m?,
    })
}

fn read_mechanics(section: &Section<'_>) -> Option<Mechanics<f64>> {
    let inertia = section.number(
        "inertia_kg_m2",
        &INERTIA,
        "inertia of everything on the shaft",
    );
    let friction = section.number("friction_nm_s", &FRICTION, "viscous friction of the motor");
    let load_friction = section.number(
        "load_friction_nm_s",
        &FRICTION,
        "the load as viscous friction, 0 when it is not",
    );
    Some(Mechanics {
        n_p: 1.0,
        inertia: inertia?,
        friction: friction?,
        load_friction: load_friction?,
    })
}

fn check_leakage(section: &Section<'_>, t_model: &TParams<f64>) {
    let leakages = [
        ("stator_leakage_henry", t_model.l_ls),
        ("rotor_leakage_henry", t_model.l_lr),
    ];
    for (key, leakage) in leakages {
        if leakage >= t_model.l_m {
            section.report(
                key,
                format!(
                    "{leakage} H is not below magnetizing_inductance_henry = {}: write both in henry",
                    t_model.l_m
                ),
            );
        }
    }
    if t_model.l_ls + t_model.l_lr == 0.0 {
        section.report(
            "stator_leakage_henry",
            "0 H on both sides makes sigma = 1 - L_m^2/(L_s L_r) zero; it must be above 0 and below 1: \
             give at least one leakage above 0",
        );
    } else if !(t_model.sigma() > 1e-6 && t_model.sigma() < 1.0) {
        section.report(
            "magnetizing_inductance_henry",
            format!(
                "sigma = 1 - L_m^2/(L_s L_r) = {:e} must be above 1e-6 and below 1: write leakages and \
                 magnetizing inductance in henry",
                t_model.sigma()
            ),
        );
    }
}
