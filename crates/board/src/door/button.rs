//! One button with three meanings, by how long it is held.

/// Looks per 3.2 ms block that a contact may bounce (16 ms).
const DEBOUNCE: u16 = 5;
/// Looks after which a press is long (2 s).
const LONG: u16 = 625;
/// Looks after which a press is very long (8 s).
const VERY_LONG: u16 = 2_500;

/// What a person did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Press {
    /// Pressed and released: acknowledge.
    Short,
    /// Held for two seconds: the other lamp mode. Comes while the button is still held.
    Long,
    /// Held for eight seconds: learn. Comes after [`Press::Long`], while the button is still held.
    VeryLong,
}

/// The button's memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Button {
    held: u16,
}

impl Button {
    /// Takes one look, every 3.2 ms.
    pub fn look(&mut self, pressed: bool) -> Option<Press> {
        let before = self.held;
        if pressed {
            self.held = before.saturating_add(1);
            return match self.held {
                LONG if before < LONG => Some(Press::Long),
                VERY_LONG if before < VERY_LONG => Some(Press::VeryLong),
                _ => None,
            };
        }
        self.held = 0;
        (DEBOUNCE..LONG).contains(&before).then_some(Press::Short)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn presses(looks: impl IntoIterator<Item = (bool, u32)>) -> Vec<Press> {
        let mut button = Button::default();
        let each = looks
            .into_iter()
            .flat_map(|(pressed, times)| (0..times).map(move |_| pressed));
        each.filter_map(|pressed| button.look(pressed)).collect()
    }

    #[test]
    fn a_bounce_is_nothing() {
        assert_eq!(presses([(true, 4), (false, 1), (true, 4), (false, 9)]), []);
    }

    #[test]
    fn a_press_counts_when_it_ends() {
        assert_eq!(presses([(true, 30)]), []);
        assert_eq!(presses([(true, 30), (false, 9)]), [Press::Short]);
    }

    #[test]
    fn a_long_press_counts_once_and_is_no_short_one() {
        assert_eq!(presses([(true, 2_499), (false, 9)]), [Press::Long]);
    }

    #[test]
    fn a_very_long_press_is_a_long_one_first_and_counts_once() {
        let both = [Press::Long, Press::VeryLong];
        assert_eq!(presses([(true, 2_500), (false, 9)]), both);
        assert_eq!(presses([(true, 80_000), (false, 9)]), both);
    }
}
