//! Counts intervals that hold the truth.

/// 97.5 % quantile of the normal distribution.
const TWO_SIDED: f64 = 1.96;
/// Least and largest share of 95 % intervals that may hold the truth, percent.
const PROMISED: std::ops::RangeInclusive<f64> = 92.0..=98.0;

/// A printed interval and what is true.
pub struct Interval {
    pub name: String,
    pub truth: f64,
    pub value: f64,
    pub std_error: f64,
    pub believed: f64,
    pub off: bool,
}

impl Interval {
    fn z(&self) -> f64 {
        (self.value - self.truth) / self.std_error
    }

    fn holds(&self) -> bool {
        self.z().abs() <= TWO_SIDED
    }
}

/// What one machine was answered.
#[derive(Default)]
pub struct Answer {
    pub intervals: Vec<Interval>,
    pub refused: bool,
    pub wrong: bool,
    /// Parameters that are said to be off.
    pub off: Vec<String>,
    pub said: String,
}

impl Answer {
    pub fn refused(why: String) -> Self {
        Answer {
            refused: true,
            said: why,
            ..Answer::default()
        }
    }

    pub fn print(&self) {
        for i in &self.intervals {
            eprintln!(
                "    {:30} true {:<12.6} believed {:<12.6} found {:<12.6} +- {:<12.6} z {:+.2}{}{}",
                i.name,
                i.truth,
                i.believed,
                i.value,
                i.std_error,
                i.z(),
                if i.holds() { "" } else { "  MISSED" },
                if i.off { "  off" } else { "" }
            );
        }
    }
}

/// Prints the rows of one command, parameter by parameter; whether the promise for all of them holds.
pub fn row(what: &str, answers: &[Answer]) -> bool {
    let judged = answers.iter().filter(|a| !a.refused).count();
    let all: Vec<&Interval> = answers.iter().flat_map(|a| &a.intervals).collect();
    let mut names: Vec<&str> = all.iter().map(|i| i.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    for name in names {
        let of: Vec<&&Interval> = all.iter().filter(|i| i.name == name).collect();
        let held = of.iter().filter(|i| i.holds()).count();
        let off = of.iter().filter(|i| i.off).count();
        println!(
            "| {what}: `{name}` | {judged} | {held} of {} | {:.1} % | | {off} |",
            of.len(),
            100.0 * held as f64 / of.len().max(1) as f64
        );
    }
    let held = all.iter().filter(|i| i.holds()).count();
    let share = 100.0 * held as f64 / all.len().max(1) as f64;
    let kept = PROMISED.contains(&share);
    println!(
        "| {what}: all | {judged} of {} | {held} of {} | {share:.1} % | 92 to 98 %{} | {} |",
        answers.len(),
        all.len(),
        if kept { "" } else { " MISSED" },
        all.iter().filter(|i| i.off).count()
    );
    kept
}

/// Prints how many machines without a missing effect are said to miss one; whether none is.
pub fn wrong(answers: &[Answer]) -> bool {
    let wrong = answers.iter().filter(|a| a.wrong).count();
    println!(
        "| explain: an effect named, or unknown, where nothing is missing | {} | {wrong} | | 0 | |",
        answers.len()
    );
    wrong == 0
}

/// Prints how many healthy machines have a parameter called off, or an effect named; whether none has.
pub fn called_off(answers: &[Answer]) -> bool {
    let judged = answers.iter().filter(|a| !a.refused).count();
    let off = answers.iter().filter(|a| !a.off.is_empty()).count();
    println!("| healthy at constant load: a parameter called off | {judged} | {off} | | 0 | |");
    let no_effect = wrong(answers);
    off == 0 && no_effect
}

/// Prints in how many machines a changed parameter is found; whether in all.
pub fn found(name: &str, factor: f64, answers: &[Answer]) -> bool {
    let found = answers
        .iter()
        .filter(|a| a.off.iter().any(|off| off == name));
    let found = found.count();
    println!(
        "| `{name}` x {factor}: called off | {} | {found} | | all | |",
        answers.len()
    );
    found == answers.len()
}
