use super::*;
use estimation::specimen;
use motor::effects::find;
use nalgebra::DMatrix;

fn effect(name: &str) -> &'static dyn Effect {
    find(name, "").expect("in the library")
}

fn parameter(name: &str, key: &str) -> &'static Parameter {
    let all = effect(name).descriptor().parameters.iter();
    all.into_iter()
        .find(|p| p.name == key)
        .expect("a parameter")
}

#[test]
fn a_resonance_is_scanned_finely_and_a_shape_on_its_own_grid() {
    let resonance = ALL
        .iter()
        .find(|e| e.descriptor().is_resonance())
        .expect("one");
    let p = resonance
        .descriptor()
        .parameters
        .iter()
        .find(|p| p.role == Role::Shape && p.is_resonance);
    let p = p.expect("a resonance has a frequency");
    let scan = grid(p);
    let (first, last) = (p.grid[0], p.grid[p.grid.len() - 1]);
    assert!(
        (scan[0] / first - 1.0).abs() < 1e-9 && (scan[scan.len() - 1] / last - 1.0).abs() < 1e-9
    );
    for pair in scan.windows(2) {
        assert!(pair[1] / pair[0] > 1.0 && pair[1] / pair[0] < SCAN_RATIO + 1e-9);
    }
    let shape = parameter("magnetizing-saturation", "saturation_exponent");
    assert_eq!(grid(shape), shape.grid);
    assert_eq!(grid(parameter("windage", "windage_nm_s2")), [0.0]);
}

/// Every combination of the grids, sizes zero.
#[test]
fn grid_points_are_all_combinations_without_size() {
    let prior = specimen::prior("");
    let points = grid_points(effect("magnetizing-saturation"), &prior);
    let parameters = effect("magnetizing-saturation").descriptor().parameters;
    let number: usize = parameters.iter().map(|p| grid(p).len()).product();
    assert_eq!(points.len(), number);
    for (k, p) in parameters.iter().enumerate() {
        let mut seen: Vec<f64> = points.iter().map(|c| c.values[k]).collect();
        seen.sort_by(f64::total_cmp);
        seen.dedup();
        assert_eq!(seen.len(), grid(p).len(), "{}", p.name);
        assert!(p.role != Role::Size || seen == [0.0]);
    }
}

/// A formula in force does not keep another from being asked about; an effect in one form keeps its other forms.
#[test]
fn what_is_part_of_the_model_is_not_asked_about_again() {
    let formula = |text: &str, k: &str| {
        format!(
            "[[effects]]\nname = \"expression\"\nformula = \"{text}\"\nadds_to = \"torque\"\n{k}\n"
        )
    };
    let saturation = "[[effects]]\nname = \"magnetizing-saturation\"\nsaturation = 0.1\n";
    let rest = formula("k * omega", "k = 1e-6")
        + &formula("k * omega^2", "k = 0.0\nk_typical = 1e-6")
        + saturation;
    let prior = specimen::prior(&rest);
    let study = specimen::table_study(|_| ());
    let fit = specimen::trial(&study).fit;
    let asked = askable(&study.fitted.case, &prior, &fit, &["windage"]);
    let has = |name: &str| asked.iter().any(|e| e.descriptor().name == name);
    let formulas = asked.iter().map(|e| e.descriptor());
    let formulas: Vec<&str> = formulas
        .filter(|d| d.name == expression::NAME)
        .map(|d| d.form)
        .collect();
    assert_eq!(formulas, ["k * omega^2"]);
    assert!(has("core-loss") && !has("windage") && !has("magnetizing-saturation"));
    let with = Fit {
        hypothesis: study.at_prior().with(
            EffectConfig::absent(prior.formulas[0], &prior.plant.rated),
            &prior.plant.rated,
        ),
        ..fit
    };
    let asked = askable(&study.fitted.case, &prior, &with, &[]);
    assert!(
        asked
            .iter()
            .all(|e| e.descriptor().name != expression::NAME)
    );
}

fn absent(name: &str) -> EffectConfig {
    EffectConfig::absent(effect(name), &specimen::prior("").plant.rated)
}

fn screened(name: &str, held_out: f64) -> Screened {
    Screened {
        config: absent(name),
        held_out: vec![0.25 * held_out; 4],
        possible: true,
        visible: 0.0,
        visible_with_known_scale: None,
    }
}

#[test]
fn points_are_ranked_within_their_effect_and_effects_by_their_best() {
    let all = [
        screened("windage", 5.0),
        screened("core-loss", 3.0),
        screened("windage", 2.0),
        screened("core-loss", 4.0),
        screened("windage", 7.0),
    ];
    let groups = ranked(&all, 2);
    let totals: Vec<Vec<f64>> = groups
        .iter()
        .map(|g| g.iter().map(Screened::total).collect())
        .collect();
    assert_eq!(totals, [[2.0, 5.0], [3.0, 4.0]]);
    assert_eq!(groups[0][0].config.effect.descriptor().name, "windage");
}

/// Sizes come in typical sizes; physics forbids a negative loss, and nothing is believed beyond six typical sizes.
#[test]
fn estimates_are_written_in_the_unit_of_the_effect() {
    let prior = specimen::prior("");
    let p = parameter("windage", "windage_nm_s2");
    let unit = p.typical * p.scale.of(&prior.plant.rated);
    let mut config = absent("windage");
    assert!(estimate(&prior, &mut config, &[2.0]));
    assert!((config.values[0] / (2.0 * unit) - 1.0).abs() < 1e-12);
    assert!(estimate(&prior, &mut config, &[100.0]));
    let most = p.range[1].min(6.0 * p.typical) * p.scale.of(&prior.plant.rated);
    assert!((config.values[0] / most - 1.0).abs() < 1e-12);
    assert!(!estimate(&prior, &mut config, &[-0.5]));
    let mut gain = absent("current-gain");
    assert!(
        estimate(&prior, &mut gain, &[-0.5]),
        "a gain may be too small"
    );
    assert!(gain.values[0] < 0.0);
}

#[test]
fn a_refit_starts_small_where_a_size_cannot_be_negative() {
    let prior = specimen::prior("");
    let p = parameter("windage", "windage_nm_s2");
    let (mut loss, mut gain) = (absent("windage"), absent("current-gain"));
    make_small(&prior, &mut loss);
    make_small(&prior, &mut gain);
    let expected = 0.3 * p.typical * p.scale.of(&prior.plant.rated);
    assert!((loss.values[0] / expected - 1.0).abs() < 1e-12);
    assert_eq!(gain.values[0], 0.0);
}

/// What a nominal column imitates is not visible; what stands at right angles to all of them is, with its square.
#[test]
fn a_signature_is_visible_as_far_as_the_nominals_cannot_imitate_it() {
    // Columns (3, 0), (4, 0) and (1, 2) in the plane; the first is a nominal.
    let gram = DMatrix::from_row_slice(3, 3, &[9.0, 12.0, 3.0, 12.0, 16.0, 4.0, 3.0, 4.0, 5.0]);
    let all = Block {
        gram,
        score: DVector::zeros(3),
        sse: 0.0,
    };
    let penalty = |w: f64| Penalty {
        weight: DVector::from_column_slice(&[w, 1.0, 1.0]),
        pull: DVector::zeros(3),
    };
    assert!((visible(&all, &penalty(0.0), 1, 2) - 4.0).abs() < 1e-9);
    assert!(visible(&all, &penalty(0.0), 1, 1).abs() < 1e-9);
    // A prior that holds the nominal leaves part of the imitation: 16 - 12^2/(9 + 9).
    assert!((visible(&all, &penalty(9.0), 1, 1) - 8.0).abs() < 1e-9);
}

#[test]
fn new_columns_carry_the_prior_of_an_effect() {
    let base = Penalty {
        weight: DVector::from_column_slice(&[5.0, 7.0]),
        pull: DVector::from_column_slice(&[0.1, 0.2]),
    };
    let more = extended_penalty(&base, 2);
    // One over four typical sizes squared.
    assert_eq!(more.weight.as_slice(), [5.0, 7.0, 0.0625, 0.0625]);
    assert_eq!(more.pull.as_slice(), [0.1, 0.2, 0.0, 0.0]);
}

fn names(study: &estimation::data::study::Study, excluded: &[&str]) -> Vec<&'static str> {
    let trial = specimen::trial(study);
    let all = askable(&study.fitted.case, &study.prior, &trial.fit, excluded);
    all.iter().map(|e| e.descriptor().name).collect()
}

#[test]
fn only_what_applies_and_is_not_there_yet_is_asked_about() {
    let table = specimen::table_study(|_| ());
    let asked = names(&table, &["core-loss"]);
    assert!(asked.contains(&"windage") && !asked.contains(&"core-loss"));
    for e in ALL {
        let d = e.descriptor();
        if d.applies != Applies::Always {
            assert!(
                !asked.contains(&d.name),
                "{} needs samples or an inverter",
                d.name
            );
        }
    }
    let mut present = table.clone();
    present.prior.plant.effects.push(absent("windage"));
    assert!(!names(&present, &[]).contains(&"windage"));
}

/// A table of a machine with core loss: the screened estimate is of its size, and no other loss predicts the table
/// better.
#[test]
fn screening_finds_what_a_table_hides() {
    let watt_per_volt2 = 2e-4;
    let study = specimen::table_study(|plant| {
        let mut config = absent("core-loss");
        config.values[0] = watt_per_volt2;
        plant.effects.push(config);
    });
    let trial = specimen::trial(&study);
    let groups = ranked(
        &screen(&study.fitted.case, &study.prior, &trial.fit, &[]),
        1,
    );
    let base: f64 = trial.folds.iter().sum();
    let best = &groups[0][0];
    assert!(best.total() < 0.2 * base, "{} of {base}", best.total());
    let core = groups
        .iter()
        .flatten()
        .find(|s| s.config.effect.descriptor().name == "core-loss");
    let core = core.expect("asked about");
    assert!(core.possible && core.total() < 0.2 * base);
    assert!(
        (core.config.values[0] / watt_per_volt2 - 1.0).abs() < 0.35,
        "{}",
        core.config.values[0]
    );
    assert!(core.visible > 1.0);
}
