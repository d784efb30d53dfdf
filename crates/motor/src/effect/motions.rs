//! Whether a formula is a number at every motion of a motor: where it is not finite there is nothing to add, and to leave it out
//! there would be another model than the one that was asked for.

use crate::effect::expression::VARIABLES;
use crate::effect::{EffectError, Rated};
use exmex::{Express, FlatEx};

/// Speeds over the synchronous one: both directions, to half as much again; the usual ones first.
const SPEEDS: [f64; 27] = [
    1.0, 0.97, 0.0, 0.95, 1.03, 0.875, 1.125, 0.75, 1.25, 0.625, 1.375, 0.5, 1.5, 0.375, 0.25,
    0.125, -0.125, -0.25, -0.375, -0.5, -0.625, -0.75, -0.875, -1.0, -1.125, -1.25, -1.5,
];
/// Current (d, q) over the rated one: no load, rated load, generating, none, and switched on.
const CURRENTS: [[f64; 2]; 8] = [
    [0.4, 0.9],
    [0.4, 0.0],
    [0.4, -0.9],
    [0.0, 0.0],
    [8.0, 8.0],
    [-8.0, 8.0],
    [8.0, -8.0],
    [-8.0, -8.0],
];
/// Voltage (d, q) over the rated one.
const VOLTAGES: [[f64; 2]; 3] = [[-0.1, 1.0], [0.0, 0.0], [1.2, -1.2]];
/// Flux over the rated one.
const FLUXES: [f64; 3] = [0.9, 0.0, 1.5];
/// Angle, rad, and time, s.
const LATER: [[f64; 2]; 3] = [[0.0, 0.0], [4.0, 1.0], [1e4, 3600.0]];

/// Refuses a formula that is no number somewhere; `numbers` are its parameters and their typical sizes.
///
/// # Errors
/// The first motion at which it is not finite.
pub(super) fn check(
    formula: &str,
    numbers: &[(String, f64)],
    rated: &Rated<f64>,
) -> Result<(), EffectError> {
    // Whatever else is wrong with a formula has been said by now.
    let Ok(flat) = exmex::parse::<f64>(formula) else {
        return Ok(());
    };
    let sizes: Vec<f64> = flat
        .var_names()
        .iter()
        .map(|name| size(name, numbers))
        .collect();
    match motions(rated).find(|motion| !is_number(&flat, &sizes, motion)) {
        None => Ok(()),
        Some(motion) => Err(EffectError::Formula {
            formula: formula.to_owned(),
            reason: reason(&flat, &motion),
        }),
    }
}

/// A parameter, or its typical size while it is zero; 0 for a variable.
fn size(name: &str, numbers: &[(String, f64)]) -> f64 {
    let given = |key: &str| numbers.iter().find(|(k, _)| k == key).map(|(_, x)| *x);
    let value = given(name).filter(|x| *x != 0.0);
    value
        .or_else(|| given(&format!("{name}_typical")))
        .unwrap_or(0.0)
}

/// Every combination, as values of [`VARIABLES`].
fn motions(rated: &Rated<f64>) -> impl Iterator<Item = [f64; 9]> + '_ {
    let electrical = CURRENTS.into_iter().flat_map(|i| VOLTAGES.map(|u| (i, u)));
    let electrical = electrical.flat_map(|(i, u)| FLUXES.map(|psi| (i, u, psi)));
    electrical.flat_map(move |(i, u, psi)| {
        SPEEDS.into_iter().flat_map(move |speed| {
            LATER.map(|[theta, t]| {
                let ([i_d, i_q], [u_d, u_q]) =
                    (i.map(|x| x * rated.current), u.map(|x| x * rated.voltage));
                [
                    i_d,
                    i_q,
                    u_d,
                    u_q,
                    psi * rated.flux(),
                    speed * rated.speed(),
                    1.0 - speed,
                    theta,
                    t,
                ]
            })
        })
    })
}

fn is_number(flat: &FlatEx<f64>, sizes: &[f64], motion: &[f64; 9]) -> bool {
    let argument = |(name, size): (&String, &f64)| variable(name).map_or(*size, |k| motion[k]);
    let arguments: Vec<f64> = flat.var_names().iter().zip(sizes).map(argument).collect();
    flat.eval(&arguments).is_ok_and(f64::is_finite)
}

fn variable(name: &str) -> Option<usize> {
    VARIABLES.iter().position(|known| *known == name)
}

fn reason(flat: &FlatEx<f64>, motion: &[f64; 9]) -> String {
    let value = |name: &String| variable(name).map(|k| format!("{name} = {}", shown(motion[k])));
    let at: Vec<String> = flat.var_names().iter().filter_map(value).collect();
    let place = match at.is_empty() {
        true => "at any motion".to_owned(),
        false => format!("at {}", at.join(", ")),
    };
    format!(
        "it is no finite number {place}: write it so that it is one at standstill, at every load and in both directions"
    )
}

/// Four digits are enough to find the place.
fn shown(x: f64) -> String {
    match x {
        0.0 => "0".to_owned(),
        x => format!("{}", format!("{x:.3e}").parse::<f64>().unwrap_or(x)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rated() -> Rated<f64> {
        Rated {
            voltage: 325.0,
            current: 7.0,
            omega_sync: 100.0 * std::f64::consts::PI,
            n_p: 2.0,
            torque: 14.6,
        }
    }

    fn refused(formula: &str) -> String {
        let numbers = [("k".to_owned(), 0.0), ("k_typical".to_owned(), 1e-3)];
        match check(formula, &numbers, &rated()) {
            Ok(()) => String::new(),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn a_formula_that_is_no_number_somewhere_is_refused_with_its_motion() {
        for (formula, place) in [
            ("k/(omega-omega)", "at omega = 157.1"),
            ("k/omega", "at omega = 0:"),
            ("k/slip", "at slip = 0:"),
            ("k/psi", "at psi = 0:"),
            ("k*sqrt(omega)", "at omega = -19.63"),
            // Above synchronous speed, 157.08 rad/s, only.
            ("k*sqrt(158-omega)", "at omega = 161.8"),
            ("k*ln(t)", "at t = 0:"),
            ("k*exp(i_q^2)", "at i_q = "),
            ("k/0", "at any motion"),
        ] {
            let said = refused(formula);
            assert!(said.contains(place), "{formula}: {said}");
        }
    }

    #[test]
    fn physics_is_a_number_everywhere() {
        for formula in [
            "k*omega*abs(omega)",
            "k*cos(2*theta)",
            "2 * k * (omega / 40) / (1 + (omega / 40)^2)",
            "k*omega^3",
            "0-k*i_d",
            "k*exp(-t/10)",
            "k*psi^2*slip",
            "k*sqrt(i_d^2+i_q^2)",
        ] {
            assert_eq!(refused(formula), "", "{formula}");
        }
    }
}
