//! What docs/detection.md says was found.

/// Rows of one motor in one block.
pub struct Section {
    /// Motor and block.
    pub title: String,
    /// Its rows.
    pub rows: Vec<Found>,
}

/// One row.
pub struct Found {
    /// Name of the fault.
    pub fault: String,
    /// As the page says it.
    pub told: String,
    /// The smallest size, percent; `None` where no size was found in 99 of 100.
    pub smallest_percent: Option<f64>,
}

/// The sections of the first table, up to the pairs.
pub fn sections(page: &str) -> Vec<Section> {
    let mut sections: Vec<Section> = Vec::new();
    for line in page
        .lines()
        .take_while(|line| !line.starts_with("### Pairs"))
    {
        if let Some(title) = line.strip_prefix("### ") {
            let title = title.to_owned();
            sections.push(Section {
                title,
                rows: Vec::new(),
            });
        }
        if let (Some(section), Some(found)) = (sections.last_mut(), row(line)) {
            section.rows.push(found);
        }
    }
    sections
}

fn row(line: &str) -> Option<Found> {
    let mut cells = line.strip_prefix("| `")?.split(" | ");
    let fault = cells.next()?.split('`').next()?.to_owned();
    let told = cells.next()?.to_owned();
    let size = told.trim_start_matches("<=").trim().trim_end_matches(" %");
    let smallest_percent = size.parse().ok();
    // A dead sensor is no size of a gain.
    (told != "dead").then_some(Found {
        fault,
        told,
        smallest_percent,
    })
}
