//! The loader's work on a flash whose power fails at every step: the old program or the new one, never a mix, never stuck.

mod flash;
mod journal;
mod programs;

use flash::Flash;
use programs::{OWNER, Recipe, package, program, recipe};
use proptest::prelude::*;
use update::layout::{JOURNAL, PROGRAM, WAITING};
use update::{Journal, Next, Refusal, SecretKey, State, Version, start};

fn boot(flash: &mut Flash) -> Next {
    start(flash, &SecretKey::from_seed(OWNER).public())
}

fn state(flash: &mut Flash) -> State {
    Journal::open(flash, JOURNAL).unwrap().state()
}

fn note(flash: &mut Flash, state: State) {
    let mut journal = Journal::open(flash, JOURNAL).unwrap();
    journal.write(flash, state).unwrap();
}

/// A board with a program that runs, and a package that waits and was asked for.
fn asked(running: &[u8], package: &[u8]) -> Flash {
    let mut flash = Flash::blank();
    flash.put(PROGRAM, running);
    flash.put(WAITING, package);
    note(&mut flash, State::Requested);
    flash
}

fn runs(flash: &Flash, program: &[u8]) -> bool {
    flash.bytes[PROGRAM as usize..].starts_with(program)
}

#[test]
fn without_a_request_the_program_starts_and_nothing_is_written() {
    let old = program(recipe(9000, 1));
    let mut flash = Flash::blank();
    flash.put(PROGRAM, &old);
    let before = flash.bytes.clone();
    assert_eq!(boot(&mut flash), Next::Program);
    assert!(flash.bytes == before && flash.steps == 0);
}

#[test]
fn without_a_program_it_says_so() {
    assert_eq!(boot(&mut Flash::blank()), Next::NoProgram);
}

#[test]
fn the_new_program_runs_on_trial_and_stays_when_it_confirms_itself() {
    for (old, new) in [
        (9_000, 5_000),
        (5_000, 9_000),
        (4_096, 4_096),
        (221_184, 221_184),
    ] {
        let (old, new) = (program(recipe(old, 1)), program(recipe(new, 2)));
        let mut flash = asked(&old, &package(&new, OWNER));
        assert_eq!(boot(&mut flash), Next::Program);
        assert!(runs(&flash, &new) && matches!(state(&mut flash), State::OnTrial { .. }));
        note(&mut flash, State::Confirmed);
        assert_eq!(boot(&mut flash), Next::Program);
        assert!(runs(&flash, &new));
    }
}

#[test]
fn a_program_that_does_not_confirm_itself_makes_room_for_the_old_one() {
    for (old, new) in [(9_000, 5_000), (5_000, 9_000), (221_184, 221_184)] {
        let (old, new) = (program(recipe(old, 1)), program(recipe(new, 2)));
        let mut flash = asked(&old, &package(&new, OWNER));
        assert_eq!(boot(&mut flash), Next::Program);
        assert_eq!(boot(&mut flash), Next::Program);
        assert!(runs(&flash, &old));
        assert_eq!(state(&mut flash), State::Reverted);
        assert_eq!(boot(&mut flash), Next::Program);
        assert!(runs(&flash, &old));
    }
}

#[test]
fn what_must_not_be_taken_is_refused_with_its_reason() {
    let old = program(recipe(9_000, 1));
    let new = recipe(8_000, 2);
    let older = Recipe {
        version: Version::parse("1.1.9"),
        ..new
    };
    let other = Recipe {
        board: 0x444D_0002,
        ..new
    };
    let signed = |recipe| package(&program(recipe), OWNER);
    let mut damaged = signed(new);
    damaged[7_000] ^= 4;
    let mut resealed = program(new);
    resealed[0x1E4..0x1E8].copy_from_slice(&400_000_u32.to_le_bytes());
    let mut mended_signature = signed(new);
    mended_signature[8_000 + 33] ^= 1;
    let cases = [
        (package(&program(new), [8; 32]), Refusal::Signature),
        (mended_signature, Refusal::Signature),
        // Erased flash behind the program is no signature.
        (program(new), Refusal::Signature),
        (signed(older), Refusal::Older),
        (signed(other), Refusal::Board),
        (damaged, Refusal::Checksum),
        (signed(new)[..6_000].to_vec(), Refusal::Checksum),
        (package(&resealed, OWNER), Refusal::NoProgram),
        (vec![0xFF; 9_000], Refusal::NoProgram),
    ];
    for (package, reason) in cases {
        let mut flash = asked(&old, &package);
        assert_eq!(boot(&mut flash), Next::Program);
        assert_eq!(state(&mut flash), State::Refused(reason));
        assert!(runs(&flash, &old));
    }
}

/// Boots until the loader is done; `None` where it never is.
fn boot_to_the_end(flash: &mut Flash) -> Option<Next> {
    for _ in 0..4 {
        flash.power_on();
        match boot(flash) {
            Next::Again => {}
            next => return Some(next),
        }
    }
    None
}

#[test]
fn a_copy_that_flash_refuses_once_is_done_again() {
    let (old, new) = (program(recipe(5_000, 1)), program(recipe(6_500, 2)));
    let mut from = asked(&old, &package(&new, OWNER));
    note(&mut from, State::Exchanging { pages: 4, step: 0 });
    for step in (1..2_000).step_by(61) {
        let mut flash = from.clone();
        (flash.steps, flash.refused_step) = (0, Some(step));
        assert_eq!(boot(&mut flash), Next::Again, "{step}");
        assert_eq!(boot_to_the_end(&mut flash), Some(Next::Program));
        assert!(runs(&flash, &new), "{step}");
    }
}

/// Power fails within the step after `cut` whole ones of a start that exchanges. Then the board starts until it runs.
fn exchange_with_a_cut(from: &Flash, cut: u32) -> Flash {
    let mut flash = from.clone();
    flash.seed(u64::from(cut));
    flash.steps_left = Some(cut);
    boot(&mut flash);
    assert_eq!(
        boot_to_the_end(&mut flash),
        Some(Next::Program),
        "cut {cut}"
    );
    flash
}

#[test]
fn power_may_fail_when_a_program_is_accepted() {
    let (old, new) = (program(recipe(5_000, 1)), program(recipe(6_500, 2)));
    let from = asked(&old, &package(&new, OWNER));
    for cut in 0..3 {
        assert!(runs(&exchange_with_a_cut(&from, cut), &new), "cut {cut}");
    }
}

#[test]
fn power_may_fail_at_every_step_on_the_way_forth() {
    let (old, new) = (program(recipe(5_000, 1)), program(recipe(6_500, 2)));
    let mut from = asked(&old, &package(&new, OWNER));
    // Accepted already: a signature is checked once, and takes longer than everything else here.
    note(&mut from, State::Exchanging { pages: 4, step: 0 });
    let mut whole = from.clone();
    whole.steps = 0;
    boot(&mut whole);
    assert!(runs(&whole, &new) && whole.steps > 4 * 2 * 256);
    for cut in 0..whole.steps {
        let mut flash = exchange_with_a_cut(&from, cut);
        // Cut when the trial was noted: the start after it brings the old one back.
        let at_the_end = cut + 1 >= whole.steps;
        match state(&mut flash) {
            State::OnTrial { .. } => assert!(runs(&flash, &new), "cut {cut}"),
            State::Reverted if at_the_end => assert!(runs(&flash, &old), "cut {cut}"),
            other => panic!("cut {cut}: {other:?}"),
        }
    }
}

#[test]
fn power_may_fail_at_every_step_on_the_way_back() {
    let (old, new) = (program(recipe(5_000, 1)), program(recipe(6_500, 2)));
    let mut from = asked(&old, &package(&new, OWNER));
    boot(&mut from);
    let mut whole = from.clone();
    whole.steps = 0;
    boot(&mut whole);
    assert!(runs(&whole, &old) && whole.steps > 4 * 2 * 256);
    for cut in 0..whole.steps {
        let mut flash = exchange_with_a_cut(&from, cut);
        assert_eq!(state(&mut flash), State::Reverted, "cut {cut}");
        assert!(runs(&flash, &old), "cut {cut}");
    }
}

proptest! {
    // 64 sequences of cuts: a few seconds.
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn power_may_fail_again_and_again(
        cuts in prop::collection::vec(0_u32..3_000, 1..60),
        (old_bytes, new_bytes) in (1_000_usize..12_000, 1_000_usize..12_000),
        seed in any::<u64>(),
    ) {
        let (old, new) = (program(recipe(old_bytes, 1)), program(recipe(new_bytes, 2)));
        let mut flash = asked(&old, &package(&new, OWNER));
        flash.seed(seed);
        for cut in cuts {
            flash.power_on();
            flash.steps_left = Some(cut);
            boot(&mut flash);
        }
        prop_assert_eq!(boot_to_the_end(&mut flash), Some(Next::Program));
        let reverted = state(&mut flash) == State::Reverted;
        let expected = if reverted { &old } else { &new };
        prop_assert!(runs(&flash, expected));
    }
}
