//! What every page has around its content.

use maud::{DOCTYPE, Markup, PreEscaped, html};

const CHART_LIBRARY: &str = include_str!("../../../assets/uplot/uPlot.iife.min.js");
const CHART_STYLE: &str = include_str!("../../../assets/uplot/uPlot.min.css");
const CHART_LICENSE: &str = include_str!("../../../assets/uplot/LICENSE");
const SCRIPT: &str = include_str!("../../../assets/report.js");
const STYLE: &str = include_str!("../../../assets/report.css");

/// Nothing may be loaded: a report opens on machines without a network, and never tells anybody that it was opened.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'";

/// How good the news is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mood {
    /// As it should be.
    Good,
    /// Look here.
    Caution,
    /// A finding.
    Bad,
}

impl Mood {
    fn class(self) -> &'static str {
        match self {
            Mood::Good => "good",
            Mood::Caution => "caution",
            Mood::Bad => "bad",
        }
    }
}

/// A complete page; `json` is embedded as it is.
pub fn page(title: &str, content: &Markup, json: &str) -> String {
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                title { (title) " – drivemon" }
                style { (PreEscaped(CHART_STYLE)) (PreEscaped(STYLE)) }
            }
            body {
                main.page {
                    h1 { "drivemon · " (title) }
                    (content)
                    (footer())
                }
                // A `<` inside a script could end it; the escape means the same to a JSON reader.
                script type="application/json" id="result" { (PreEscaped(json.replace('<', "\\u003c"))) }
                script { (PreEscaped(CHART_LIBRARY)) }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    markup.into_string()
}

fn footer() -> Markup {
    html! {
        footer {
            p { "drivemon " (env!("CARGO_PKG_VERSION")) ". A fault monitor is no protection device: it does not replace fuses, motor protection switches or safety relays." }
            p { "Drag across a figure to zoom in, double-click to see all. Every number here is in the JSON that this page carries." }
            details { summary { "Charts are drawn by uPlot (MIT licence)" } pre { (CHART_LICENSE) } }
        }
    }
}

/// The answer in one sentence, with what belongs to it.
pub fn verdict(mood: Mood, answer: &Markup, more: &Markup) -> Markup {
    html! { section class={ "verdict " (mood.class()) } aria-label="Result" { strong { (answer) } (more) } }
}

/// Key figures side by side: each a figure and what it is.
pub fn cards(cards: &[(Markup, Markup)]) -> Markup {
    html! {
        ul.cards {
            @for (figure, what) in cards {
                li { span.figure { (figure) } span.what { (what) } }
            }
        }
    }
}

/// What to do next, with the command to type where there is one.
pub fn next(why: &str, command: &str) -> Markup {
    html! {
        section aria-labelledby="next" {
            h2 id="next" { "What next" }
            p { (why) }
            @if !command.is_empty() { code.command { (command) } }
        }
    }
}
