//! The page in a real browser, as a person uses it. Skipped with a word where no Chromium is installed.
//!
//! `UPDATE_SCREENSHOTS=1 cargo test -p drivemon --test panel browser` writes the pictures of docs/images anew.

mod bench;
mod driver;
mod first;
mod law;
mod measure;
mod page;
mod shots;
mod stories;

use driver::Driver;
pub use page::Page;

/// Runs a visit with one browser.
pub fn visit<F: Future<Output = ()>>(story: impl FnOnce(Page) -> F) {
    let Some(driver) = Driver::start() else {
        eprintln!("skipped: chromium and chromedriver are not installed, the page was not opened");
        return;
    };
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .expect("a runtime");
    runtime.block_on(async {
        let page = Page::open(&driver).await;
        story(page.clone()).await;
        page.close().await;
    });
}

#[test]
fn a_person_uses_the_panel() {
    visit(|page| async move {
        stories::faults_light_their_lamps_and_go_dark(&page).await;
        stories::parameters_are_checked_at_their_field(&page).await;
        stories::the_keyboard_and_a_screen_reader_suffice(&page).await;
        stories::the_page_comes_back_after_a_restart(&page).await;
        stories::a_measured_recording_is_played(&page).await;
        stories::an_ended_replay_shows_its_last_state(&page).await;
        stories::an_alarm_is_acknowledged(&page).await;
        stories::charts_fit_their_screen(&page).await;
        stories::the_link_with_its_token_opens_the_page(&page).await;
        if std::env::var_os("UPDATE_SCREENSHOTS").is_some() {
            shots::all(&page).await;
        }
        page.assert_silent().await;
    });
}

#[test]
fn data_that_no_longer_come_do_not_look_healthy() {
    visit(|page| async move {
        stories::old_data_do_not_look_healthy(&page).await;
        page.assert_silent().await;
    });
}

#[test]
fn a_drive_engineer_uses_the_workbench() {
    visit(|page| async move {
        let pictures = std::env::var_os("UPDATE_SCREENSHOTS").is_some();
        bench::a_hidden_effect_is_found_and_adopted(&page, pictures).await;
        page.assert_silent().await;
    });
}

#[test]
fn a_drive_engineer_finds_a_law_that_no_library_holds() {
    visit(|page| async move {
        law::a_pumps_threshold_is_found_and_adopted(&page).await;
        page.assert_silent().await;
    });
}

#[test]
fn a_technician_checks_a_motor_for_the_first_time() {
    visit(|page| async move {
        let pictures = std::env::var_os("UPDATE_SCREENSHOTS").is_some();
        first::a_real_fault_is_named_within_ten_clicks(&page, pictures).await;
        first::what_is_wrong_is_said_plainly(&page).await;
        page.assert_silent().await;
    });
}

#[test]
#[ignore = "prints measurements: cargo test --release -p drivemon --test panel -- --ignored --nocapture"]
fn measure_page_and_server() {
    visit(|page| async move {
        measure::rates(&page).await;
        measure::workbench(&page).await;
    });
}
