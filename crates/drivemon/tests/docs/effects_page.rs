//! The page of effects is written from the library.

use std::fs;

use crate::root;

/// Each effect is one file of the library; its page says what that file says.
#[test]
fn the_page_of_effects_says_what_the_library_says() {
    let path = root().join("docs/effects.md");
    let fresh = effects_page();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&path, &fresh).expect("writable");
    }
    let page = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        page == fresh,
        "docs/effects.md is stale: run with UPDATE_DOCS=1\n{fresh}"
    );
}

const EFFECTS_INTRODUCTION: &str = "\
# Physical effects

What the T model leaves out, one effect per file of [`crates/motor/src/effects`](../crates/motor/src/effects). This page is written from
those files by the test `crates/drivemon/tests/docs`. An effect is switched on by an entry `[[effects]]` of a [motor file](motor-file.md), of a
[scenario](scenarios.md), or by `drivemon adopt`. \"Typical\" is the ordinary size for the 2.2 kW motor of `motors/peer-2k2.toml`, as a motor
file writes it; every size may be 0 (or 1 for a gain), which means absent, up to 25 times the typical one.
";

fn effects_page() -> String {
    let motor = motor::MotorFile::read(root().join("motors/peer-2k2.toml")).expect("shipped");
    let rated = motor::effect::rated(&motor);
    let mut page = EFFECTS_INTRODUCTION.to_owned();
    for effect in motor::effects::ALL {
        let known = effect.descriptor();
        let form = match known.form {
            "" => String::new(),
            form => format!(", `form = \"{form}\"`"),
        };
        page += &format!("\n## `{}`{form}\n\n", known.name);
        page += &format!("Missing, one sees: {}.\n\n", known.symptom);
        page += "| key | unit | typical |\n|---|---|---|\n";
        for parameter in known.parameters {
            let typical = parameter.to_file(parameter.typical * parameter.scale.of(&rated));
            page += &format!(
                "| `{}` | {} | {} |\n",
                parameter.name,
                parameter.unit,
                short(typical)
            );
        }
        let look_alikes: Vec<String> = known
            .look_alikes
            .iter()
            .map(|name| format!("`{name}`"))
            .collect();
        if !look_alikes.is_empty() {
            page += &format!(
                "\nLooks like {}. Separated by: {}.\n",
                look_alikes.join(", "),
                known.separating_test
            );
        }
        page += match known.applies {
            motor::effect::Applies::Inverter => "\nBehind a frequency converter only.\n",
            motor::effect::Applies::Samples => {
                "\nShows in samples over time only, not in a load-test table.\n"
            }
            motor::effect::Applies::Always => "",
        };
    }
    page
}

/// Three significant digits.
fn short(x: f64) -> String {
    let digits = if x == 0.0 {
        0.0
    } else {
        2.0 - x.abs().log10().floor()
    };
    if (0.0..8.0).contains(&digits) {
        format!("{x:.0$}", digits as usize)
    } else {
        format!("{x:.2e}")
    }
}
