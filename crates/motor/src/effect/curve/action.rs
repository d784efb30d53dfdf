//! A law without its curve: where it acts and over what.

use super::{Coordinate, Place};

/// A law at a place over a coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Action {
    /// Where it acts.
    pub place: Place,
    /// What it depends on.
    pub coordinate: Coordinate,
}

impl Action {
    /// Every action that there is.
    pub fn all() -> impl Iterator<Item = Action> {
        let over = |place: Place| {
            let coordinates = place.coordinates().iter();
            coordinates.map(move |&coordinate| Action { place, coordinate })
        };
        Place::ALL.into_iter().flat_map(over)
    }

    /// A number for the action; the same in every build of a version.
    pub fn number(self) -> u32 {
        let place = Place::ALL.iter().position(|p| *p == self.place);
        let coordinate = Coordinate::ALL.iter().position(|c| *c == self.coordinate);
        (place.unwrap_or(0) << 8 | coordinate.unwrap_or(0)) as u32
    }

    /// The action of a number; `None` for a number that [`Action::number`] does not give.
    pub fn by_number(number: u32) -> Option<Action> {
        Some(Action {
            place: *Place::ALL.get((number >> 8) as usize)?,
            coordinate: *Coordinate::ALL.get((number & 0xFF) as usize)?,
        })
    }
}
