//! What comes and goes, in a terminal: how often, how large, and when.

use discovery::{BurstReport, BurstsReport};

use crate::cli::arguments::study::{quantity, wrapped};
use crate::cli::printing::terminal::say;

/// Cells of a timeline.
const CELLS: usize = 72;
/// A cell by the share of its time in which something was missing.
const SHADES: [char; 5] = ['.', '\u{2591}', '\u{2592}', '\u{2593}', '\u{2588}'];
/// Longest bursts that are listed.
const LISTED: usize = 6;

/// Prints count, share of time, sizes, a timeline of each recording and the longest bursts.
pub fn print(bursts: &BurstsReport) {
    let sizes = [bursts.smallest, bursts.median, bursts.largest].map(quantity);
    let text = format!(
        "It comes and goes: {} times, {:.1} % of the time; smallest {}, median {}, largest {} {}.",
        bursts.count, bursts.share_of_time_percent, sizes[0], sizes[1], sizes[2], bursts.unit
    );
    say!("{}", wrapped(&text));
    let last = bursts.bursts.iter().map(|b| b.recording).max();
    for recording in 1..=last.unwrap_or(0) {
        let of: Vec<&BurstReport> = bursts
            .bursts
            .iter()
            .filter(|b| b.recording == recording)
            .collect();
        let end = of.iter().map(|b| b.to_s).fold(0.0, f64::max);
        say!(
            "  recording {recording}, 0 to {end:.2} s, each of {CELLS} cells {:.0} ms:",
            1e3 * end / CELLS as f64
        );
        say!("  {}", timeline(&of, end));
    }
    let mut longest: Vec<&BurstReport> = bursts.bursts.iter().collect();
    longest.sort_by(|a, b| (b.to_s - b.from_s).total_cmp(&(a.to_s - a.from_s)));
    say!("  The longest:");
    for b in longest.into_iter().take(LISTED) {
        say!(
            "    recording {}, {:.4} to {:.4} s: {} {}",
            b.recording,
            b.from_s,
            b.to_s,
            quantity(b.size),
            bursts.unit
        );
    }
}

/// One character a cell; a burst that is shorter than a cell shows all the same.
fn timeline(bursts: &[&BurstReport], end: f64) -> String {
    let width = end / CELLS as f64;
    let cell = |k: usize| {
        let (from, to) = (width * k as f64, width * (k + 1) as f64);
        let inside = |b: &&BurstReport| (b.to_s.min(to) - b.from_s.max(from)).max(0.0);
        let share = bursts.iter().map(inside).sum::<f64>() / width;
        let shade = (share * (SHADES.len() - 1) as f64).ceil() as usize;
        SHADES[shade.min(SHADES.len() - 1)]
    };
    (0..CELLS).map(cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_bursts_show_and_full_cells_are_full() {
        let burst = |from_s, to_s| BurstReport {
            recording: 1,
            from_s,
            to_s,
            size: 1.0,
        };
        let all = [burst(0.1, 0.101), burst(36.0, 37.0), burst(71.5, 72.0)];
        let all: Vec<&BurstReport> = all.iter().collect();
        let line: Vec<char> = timeline(&all, 72.0).chars().collect();
        assert_eq!(line.len(), CELLS);
        assert_eq!(
            [line[0], line[1], line[36], line[71]],
            [SHADES[1], '.', SHADES[4], SHADES[2]]
        );
        assert_eq!(line.iter().filter(|c| **c != '.').count(), 3);
    }
}
