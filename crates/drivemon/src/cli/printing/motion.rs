//! What was judged while something changed.

use replay::MotionSummary;

use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

/// Prints how much was judged in motion, why the rest was not, and every alarm; nothing where nothing moved. Lines begin with `indent`.
pub(crate) fn print_motion(motion: &MotionSummary, indent: &str) {
    if let Some(why) = &motion.not_possible {
        say!("{indent}in motion not judged: {why}");
        return;
    }
    if motion.windows == 0 {
        return;
    }
    say!(
        "{indent}judged in motion: {} of {} windows that were not at rest",
        motion.judged,
        motion.windows
    );
    for share in &motion.not_judged {
        say!("{indent}  {} not judged: {}", share.windows, share.reason);
    }
    for fault in &motion.alarms {
        let cause = fault.words();
        let cause =
            cause.unwrap_or_else(|| "it was over before its cause could be told".to_owned());
        let alarm = format!(
            "FAULT in motion at {:.3} s, first seen at about {:.3} s, T = {:.1}:",
            fault.raised_s, fault.onset_s, fault.statistic
        );
        say!("{indent}{} {cause}", paint::error(alarm));
    }
    for doubt in &motion.unexplained {
        let found = format!(
            "from about {:.3} s on something does not fit, T = {:.1}:",
            doubt.onset_s, doubt.statistic
        );
        say!("{indent}{} {}", paint::caution(found), doubt.doubt());
    }
    if motion.is_healthy() {
        say!("{indent}{}", paint::good("in motion no fault was seen"));
    }
}
