use bevy::prelude::*;

use crate::{Always, Input, Presses, control};

control! {
    /// Closes what was opened last.
    pub CloseTop: Always = "window.close", [
        Input::key(KeyCode::Escape),
        Input::Pad(bevy::input::gamepad::GamepadButton::East),
    ];
}

/// What is open, from below: one press of [`CloseTop`] closes one thing, that which was opened last.
#[derive(Resource, Debug, Clone, PartialEq, Eq, Default)]
pub struct Layers {
    open: Vec<&'static str>,
    /// Those of them that are read in the middle of the window.
    pages: Vec<&'static str>,
    /// What is to close in this frame.
    closing: Option<&'static str>,
}

impl Layers {
    /// Tells each frame whether something is open, and answers whether it is to close now.
    #[must_use]
    pub fn closes(&mut self, name: &'static str, is_open: bool) -> bool {
        let was_open = self.open.contains(&name);
        if is_open && !was_open {
            self.open.push(name);
        } else if !is_open && was_open {
            self.open.retain(|open| *open != name);
        }
        if is_open && self.closing == Some(name) {
            self.closing = None;
            return true;
        }
        false
    }

    /// The same of a page: what is read in the middle of the window. While one is open, what is told at its edges steps back.
    #[must_use]
    pub fn closes_page(&mut self, name: &'static str, is_open: bool) -> bool {
        if is_open != self.pages.contains(&name) {
            self.pages.retain(|page| *page != name);
            self.pages.extend(is_open.then_some(name));
        }
        self.closes(name, is_open)
    }

    /// Whether a page is open.
    #[must_use]
    pub fn has_page(&self) -> bool {
        !self.pages.is_empty()
    }

    /// The page that is read: the one that was opened last.
    #[must_use]
    pub fn page(&self) -> Option<&'static str> {
        self.pages.last().copied()
    }

    /// What lies on top.
    #[must_use]
    pub fn top(&self) -> Option<&'static str> {
        self.open.last().copied()
    }
}

pub(crate) fn close_top(presses: Presses<'_, '_>, mut layers: ResMut<Layers>) {
    let closing = layers.top().filter(|_| presses.begins::<CloseTop>());
    if layers.closing != closing {
        layers.closing = closing;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::app;

    #[test]
    fn what_was_opened_last_closes_first() {
        #[derive(Resource, Default)]
        struct Open([bool; 3]);
        const NAMES: [&str; 3] = ["map", "help", "search"];
        let mut app = app();
        app.init_resource::<Open>().add_systems(Update, |mut open: ResMut<Open>, mut layers: ResMut<Layers>| {
            for (n, name) in NAMES.into_iter().enumerate() {
                let closes = if name == "map" { layers.closes(name, open.0[n]) } else { layers.closes_page(name, open.0[n]) };
                open.0[n] &= !closes;
            }
        });
        let escape = |app: &mut App| {
            app.world_mut().resource_mut::<ButtonInput<KeyCode>>().press(KeyCode::Escape);
            app.update();
            app.update();
            app.world_mut().resource_mut::<ButtonInput<KeyCode>>().release(KeyCode::Escape);
            app.update();
            app.world().resource::<Open>().0
        };
        for n in [1, 2, 0] {
            app.world_mut().resource_mut::<Open>().0[n] = true;
            app.update();
        }
        let has_page = |app: &App| app.world().resource::<Layers>().has_page();
        assert_eq!(app.world().resource::<Layers>().page(), Some("search"), "the last of the pages");
        assert_eq!(escape(&mut app), [false, true, true], "the map was opened last");
        assert_eq!((escape(&mut app), has_page(&app)), ([false, true, false], true));
        app.world_mut().resource_mut::<Open>().0[1] = false;
        app.update();
        assert_eq!(app.world().resource::<Layers>().top(), None, "closed otherwise");
        assert!(!has_page(&app));
        app.world_mut().resource_mut::<Open>().0[0] = true;
        app.update();
        assert!(!has_page(&app), "not everything that closes is a page");
        assert_eq!(escape(&mut app), [false; 3]);
    }
}
