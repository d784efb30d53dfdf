//! Figures: what is drawn over what, as addresses in the embedded result; the browser draws them.

use maud::{Markup, html};
use serde::Serialize;

/// One figure.
#[derive(Clone, Debug, Serialize)]
pub struct Chart {
    /// Horizontal axis.
    pub x: AxisX,
    /// Vertical axis.
    pub y: AxisY,
    /// What is drawn.
    pub series: Vec<Series>,
    /// Constant levels.
    pub limits: Vec<Limit>,
    /// Figures of one group share their read-out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub group: Option<&'static str>,
    /// Height in units of the font size.
    pub height_rem: f64,
}

/// Horizontal axis.
#[derive(Clone, Debug, Serialize)]
pub struct AxisX {
    /// Quantity.
    pub label: String,
    /// Unit; empty for classes.
    pub unit: &'static str,
    /// Address of the values, `*` for every row.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub from: String,
    /// Names of the classes, where the axis has no values.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub labels: Option<Vec<String>>,
}

/// Vertical axis.
#[derive(Clone, Debug, Serialize)]
pub struct AxisY {
    /// Quantity.
    pub label: String,
    /// Unit.
    pub unit: &'static str,
    /// Division.
    pub scale: Scale,
    /// Whether the axis starts at zero.
    pub from_zero: bool,
    /// For [`Scale::Asinh`]: where the logarithmic part begins.
    pub linear_below: f64,
}

/// Division of the vertical axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// Even.
    Linear,
    /// Even near zero, logarithmic beyond, both signs.
    Asinh,
    /// Logarithmic.
    Log,
}

/// One line, set of points or set of bars.
#[derive(Clone, Debug, Serialize)]
pub struct Series {
    /// Name in the legend.
    pub label: String,
    /// Address of the values, `*` for every row.
    pub from: String,
    /// Address of the horizontal values where they are not the axis' own.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub x: String,
    /// Colour by its name in the style sheet.
    pub color: &'static str,
    /// How it is drawn.
    pub kind: Kind,
    /// Dashes, CSS pixels on and off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dash: Option<[u32; 2]>,
    /// The rows that belong to it, if not all.
    #[serde(rename = "where", skip_serializing_if = "Option::is_none")]
    pub rows: Option<Rows>,
    /// Whether the vertical axis may cut it off.
    pub outside_scale: bool,
    /// A share, drawn in percent.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub percent: bool,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A line.
    Line,
    /// A line with marks.
    Marked,
    /// Marks.
    Points,
    /// Bars beside those of the other series.
    Bars,
}

/// A choice of rows.
#[derive(Clone, Debug, Serialize)]
pub struct Rows {
    /// Address of what is looked at.
    pub from: String,
    /// What it must be.
    pub is: serde_json::Value,
    /// Whether the line is interrupted where rows are missing.
    pub gaps: bool,
}

/// A constant level.
#[derive(Clone, Debug, Serialize)]
pub struct Limit {
    /// Address of the level.
    pub from: String,
    /// Name in the legend.
    pub label: String,
    /// Whether the negative of it is a limit too.
    pub both: bool,
}

impl Chart {
    /// A figure over the values at an address.
    pub fn over(label: &str, unit: &'static str, from: impl Into<String>) -> Self {
        Chart::new(AxisX {
            label: label.to_owned(),
            unit,
            from: from.into(),
            labels: None,
        })
    }

    /// A figure over classes.
    pub fn over_classes(label: &str, labels: Vec<String>) -> Self {
        Chart::new(AxisX {
            label: label.to_owned(),
            unit: "",
            from: String::new(),
            labels: Some(labels),
        })
    }

    fn new(x: AxisX) -> Self {
        Chart {
            x,
            y: AxisY {
                label: String::new(),
                unit: "",
                scale: Scale::Linear,
                from_zero: false,
                linear_below: 1.0,
            },
            series: Vec::new(),
            limits: Vec::new(),
            group: None,
            height_rem: 16.0,
        }
    }

    /// Names the vertical axis.
    pub fn y(mut self, label: &str, unit: &'static str) -> Self {
        label.clone_into(&mut self.y.label);
        self.y.unit = unit;
        self
    }

    /// Divides the vertical axis evenly up to `linear_below`, logarithmically beyond.
    pub fn asinh(mut self, linear_below: f64) -> Self {
        self.y.scale = Scale::Asinh;
        self.y.linear_below = linear_below;
        self
    }

    /// Divides the vertical axis logarithmically.
    pub fn log(mut self) -> Self {
        self.y.scale = Scale::Log;
        self
    }

    /// Starts the vertical axis at zero.
    pub fn starting_at_zero(mut self) -> Self {
        self.y.from_zero = true;
        self
    }

    /// Shares the read-out with the other figures of `group`.
    pub fn group(mut self, group: &'static str) -> Self {
        self.group = Some(group);
        self
    }

    /// Adds a series.
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Adds a level and its negative.
    pub fn limits(mut self, label: &str, from: impl Into<String>) -> Self {
        self.limits.push(Limit {
            from: from.into(),
            label: label.to_owned(),
            both: true,
        });
        self
    }

    /// The figure under a heading, with a sentence that says what to look at.
    pub fn figure(&self, heading: &str, sentence: &str) -> Markup {
        let chart = serde_json::to_string(self).unwrap_or_default();
        html! {
            figure data-chart=(chart) {
                figcaption {
                    h3 { (heading) }
                    button.reset type="button" aria-label={ "Show all of: " (heading) } { "Show all" }
                    @if !sentence.is_empty() { p { (sentence) } }
                }
                div.plot role="img" tabindex="0" aria-label={ (heading) ". " (sentence) " Arrow keys read values, plus and minus zoom, Escape shows all; the numbers follow as a table." } {}
                details { summary { "Numbers" } div.numbers tabindex="0" {} }
            }
        }
    }
}

impl Series {
    /// A line.
    pub fn line(label: &str, from: impl Into<String>, color: &'static str) -> Self {
        Series {
            label: label.to_owned(),
            from: from.into(),
            x: String::new(),
            color,
            kind: Kind::Line,
            dash: None,
            rows: None,
            outside_scale: false,
            percent: false,
        }
    }

    /// Drawn differently.
    pub fn kind(self, kind: Kind) -> Self {
        Series { kind, ..self }
    }

    /// Dashed, so that lines over each other can be told apart without colour; each model its own way.
    pub fn dashed(self, model: usize) -> Self {
        let dash = [[8, 4], [3, 3], [12, 3]][model % 3];
        Series {
            dash: Some(dash),
            ..self
        }
    }

    /// Only rows where the value at `from` is `is`.
    pub fn rows(mut self, from: impl Into<String>, is: impl Into<serde_json::Value>) -> Self {
        self.rows = Some(Rows {
            from: from.into(),
            is: is.into(),
            gaps: false,
        });
        self
    }

    /// As [`Series::rows`], with the line interrupted elsewhere.
    pub fn interrupted(self, from: impl Into<String>, is: impl Into<serde_json::Value>) -> Self {
        let mut series = self.rows(from, is);
        if let Some(rows) = &mut series.rows {
            rows.gaps = true;
        }
        series
    }

    /// A share, drawn in percent.
    pub fn percent(self) -> Self {
        Series {
            percent: true,
            ..self
        }
    }

    /// Not counted when the vertical axis is chosen.
    pub fn outside_scale(self) -> Self {
        Series {
            outside_scale: true,
            ..self
        }
    }
}
