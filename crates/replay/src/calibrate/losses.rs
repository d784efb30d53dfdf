//! What the losses of the motor file leave uncertain: a fit at one load takes their current for resistance.

use monitor::{Monitor, Window};

/// Standard deviation of the active current that the uncertain parameters of the file's effects take in a window, percent of the rated current.
pub fn uncertain_current_percent(monitor: &Monitor, window: &Window) -> f64 {
    let config = monitor.config();
    let active = |changed: &Monitor| changed.conditions(window).map(|at| f64::from(at.active));
    let Some(here) = active(monitor) else {
        return 0.0;
    };
    let sigmas = config.doubt.effects.iter().enumerate();
    let uncertain = sigmas.flat_map(|(effect, sigmas)| {
        let sigmas = sigmas.iter().enumerate();
        sigmas.map(move |(parameter, sigma)| ([effect, parameter], *sigma))
    });
    let moved = |([effect, parameter], sigma): ([usize; 2], f32)| {
        let mut more = *config;
        let place = more.effects[effect].as_mut()?;
        place.parameters[parameter] *= sigma.exp();
        active(&Monitor::new(more).ok()?)
    };
    let squares = uncertain
        .filter(|(_, sigma)| *sigma > 0.0)
        .filter_map(moved)
        .map(|there| (there - here).powi(2));
    100.0 * squares.sum::<f64>().sqrt()
}
