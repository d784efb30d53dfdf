//! Pages as a stranger gets them: self-contained, true to their JSON, and drawn without an error.

mod browser;
mod page;

use page::Page;

#[test]
fn the_demo_page_is_self_contained_and_true_to_its_json() {
    let page = Page::of("demo", &["demo"]);
    page.check();
    // Every row of Table 1 in both directions, four residuals, three matrices; and more around them.
    assert!(page.numbers().len() > 3 * 18 * 4);
    browser::check(&page);
}

#[test]
fn the_page_of_a_monitored_fault_is_self_contained_and_true_to_its_json() {
    let recording = page::scratch("faulty.csv.gz");
    let scenario = page::project("sim-host/scenarios/sensor-faults.toml");
    let made = page::drivemon(&["simulate", &scenario, "-o", &recording]);
    assert!(made.status.success(), "{made:?}");
    let motor = page::project("motors/assumed-300w.toml");
    let page = Page::of("monitor", &["monitor", &recording, "--motor", &motor]);
    page.check();
    assert!(page.html.contains("First lit") || page.html.contains("first lit"));
    browser::check(&page);
}

#[test]
fn a_recording_without_voltages_gives_a_page_too() {
    let recording = page::project("tests/data/itsc_075hp/sc_a3_b0_c0_001.csv.gz");
    let page = Page::of("currents", &["monitor", &recording]);
    page.check();
    assert!(page.html.contains("not measured"));
    browser::check(&page);
}

#[test]
fn the_page_of_a_load_table_is_self_contained_and_true_to_its_json() {
    let table = page::project("tests/data/imc_18k5_load_test/load_test.csv");
    let motor = page::project("motors/imc-18k5.toml");
    let page = Page::of("table", &["monitor", &table, "--motor", &motor]);
    page.check();
    browser::check(&page);
}

#[test]
fn a_page_that_cannot_be_written_is_an_error_that_names_it() {
    let table = page::project("tests/data/imc_18k5_load_test/load_test.csv");
    let done = page::drivemon(&["monitor", &table, "--report", "no/such/folder/x.html"]);
    assert_eq!(done.status.code(), Some(2));
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(said.contains("no/such/folder/x.html"), "{said}");
}
