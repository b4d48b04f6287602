use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use bevy::input::gamepad::GamepadButton;
use bevy::prelude::*;
use bevy::reflect::enums::{DynamicEnum, DynamicVariant, VariantInfo};
use bevy::reflect::{FromReflect, Typed};
use bevy_enhanced_input::prelude::ModKeys;

/// Something that can be pressed, pushed or turned.
///
/// Its name is what a person reads and writes in a file of settings; [`Display`] writes it and [`FromStr`] reads it:
///
/// | name | what |
/// |---|---|
/// | `KeyW`, `Digit1`, `ArrowUp`, `F3` | the key at that place of the keyboard, whatever is written on it; `W` and `1` are read too |
/// | `Shift+KeyF`, `Ctrl+Alt+KeyQ` | that key while others are held |
/// | `Letter /` | the key that writes this, wherever it lies |
/// | `Mouse Right`, `Shift+Mouse Left`, `Mouse 4` | a button of the mouse |
/// | `Wheel Up`, `Wheel Down` | the wheel of the mouse, away from and towards the hand |
/// | `Pad South`, `Pad DPadUp`, `Pad RightTrigger2` | a button of a gamepad |
/// | `Pad LeftStick Up` | a stick of a gamepad, pushed that way |
/// | `Touch Stick Up` | the stick that a finger makes on the left half of a touchscreen |
///
/// ```
/// use veduta_controls::Input;
///
/// let input: Input = "Shift+F".parse()?;
/// assert_eq!(input.to_string(), "Shift+KeyF");
/// assert!("Pad Nose".parse::<Input>().is_err());
/// # Ok::<(), veduta_controls::InputError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// A key by its place on the keyboard, while others are held.
    Key(KeyCode, ModKeys),
    /// A key by what it writes. It rests where its place is bound in its own right.
    Letter(char),
    /// A button of the mouse, while keys are held.
    Mouse(MouseButton, ModKeys),
    /// The wheel of the mouse: [`Way::Up`] is away from the hand. How far, in lines.
    Wheel(Way),
    /// A button of any gamepad; a trigger is pressed by halves.
    Pad(GamepadButton),
    /// A stick of any gamepad, 0 to 1 beyond its dead zone.
    Stick(Stick, Way),
    /// The stick that a finger makes on the left half of a touchscreen, 0 to 1.
    TouchStick(Way),
}

/// One of a gamepad's sticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stick {
    /// Under the left thumb.
    Left,
    /// Under the right thumb.
    Right,
}

/// Which way something is pushed or turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// Up, or away from the hand.
    Up,
    /// Down, or towards the hand.
    Down,
    /// Left.
    Left,
    /// Right.
    Right,
}

/// What a visitor has in hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Device {
    /// Keyboard and mouse.
    #[default]
    Keys,
    /// A gamepad.
    Pad,
    /// A touchscreen.
    Touch,
}

/// A name that no input has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is no input; inputs are named such as KeyW, Shift+F, Letter /, Mouse Right, Wheel Up, Pad South, Pad LeftStick Up")]
pub struct InputError(
    /// As it was written.
    pub String,
);

impl Input {
    /// A key by its place.
    #[must_use]
    pub const fn key(key: KeyCode) -> Self {
        Self::Key(key, ModKeys::empty())
    }

    /// A key by its place, while Control is held.
    #[must_use]
    pub const fn ctrl(key: KeyCode) -> Self {
        Self::Key(key, ModKeys::CONTROL)
    }

    /// A button of the mouse.
    #[must_use]
    pub const fn mouse(button: MouseButton) -> Self {
        Self::Mouse(button, ModKeys::empty())
    }

    /// On which device it is.
    #[must_use]
    pub const fn device(self) -> Device {
        match self {
            Self::Key(..) | Self::Letter(_) | Self::Mouse(..) | Self::Wheel(_) => Device::Keys,
            Self::Pad(_) | Self::Stick(..) => Device::Pad,
            Self::TouchStick(_) => Device::Touch,
        }
    }

    /// The keys that are held with it.
    #[must_use]
    pub const fn mods(self) -> ModKeys {
        match self {
            Self::Key(_, mods) | Self::Mouse(_, mods) => mods,
            _ => ModKeys::empty(),
        }
    }

    /// Whether it is pressed or not, and nothing between.
    pub(crate) const fn is_digital(self) -> bool {
        matches!(self, Self::Key(..) | Self::Letter(_) | Self::Mouse(..))
    }
}

impl Way {
    pub(crate) const ALL: [Self; 4] = [Self::Up, Self::Down, Self::Left, Self::Right];

    /// How far something that points right and up is pushed this way.
    pub(crate) const fn share(self, of: Vec2) -> f32 {
        match self {
            Self::Up => of.y.max(0.0),
            Self::Down => (-of.y).max(0.0),
            Self::Left => (-of.x).max(0.0),
            Self::Right => of.x.max(0.0),
        }
    }

    fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|way| format!("{way:?}") == name)
    }
}

/// Keys that are held with others, as they are written before them.
const MODS: [(ModKeys, &str); 4] =
    [(ModKeys::CONTROL, "Ctrl"), (ModKeys::SHIFT, "Shift"), (ModKeys::ALT, "Alt"), (ModKeys::SUPER, "Super")];

impl Display for Input {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (_, name) in MODS.into_iter().filter(|(key, _)| self.mods().contains(*key)) {
            write!(f, "{name}+")?;
        }
        match self {
            Self::Key(key, _) => write!(f, "{key:?}"),
            Self::Letter(letter) => write!(f, "Letter {letter}"),
            Self::Mouse(MouseButton::Other(n), _) => write!(f, "Mouse {n}"),
            Self::Mouse(button, _) => write!(f, "Mouse {button:?}"),
            Self::Wheel(way) => write!(f, "Wheel {way:?}"),
            Self::Pad(GamepadButton::Other(n)) => write!(f, "Pad {n}"),
            Self::Pad(button) => write!(f, "Pad {button:?}"),
            Self::Stick(stick, way) => write!(f, "Pad {stick:?}Stick {way:?}"),
            Self::TouchStick(way) => write!(f, "Touch Stick {way:?}"),
        }
    }
}

impl FromStr for Input {
    type Err = InputError;

    fn from_str(text: &str) -> Result<Self, InputError> {
        read(text.trim()).ok_or_else(|| InputError(text.to_owned()))
    }
}

fn read(text: &str) -> Option<Input> {
    if let Some(letter) = text.strip_prefix("Letter ") {
        let mut letters = letter.trim().chars();
        return Some(Input::Letter(letters.next()?)).filter(|_| letters.next().is_none());
    }
    let (mut mods, mut rest) = (ModKeys::empty(), text);
    while let Some((before, after)) = rest.split_once('+') {
        let (held, _) = MODS.into_iter().find(|(_, name)| name.eq_ignore_ascii_case(before.trim()))?;
        mods |= held;
        rest = after.trim();
    }
    match rest.split_once(' ').map(|(kind, of)| (kind, of.trim())) {
        None => key(rest).map(|key| Input::Key(key, mods)),
        Some(("Mouse", of)) => {
            let numbered = || of.parse().ok().map(MouseButton::Other);
            variant(of).or_else(numbered).map(|button| Input::Mouse(button, mods))
        }
        Some(_) if !mods.is_empty() => None,
        Some(("Wheel", of)) => Way::named(of).filter(|way| matches!(way, Way::Up | Way::Down)).map(Input::Wheel),
        Some(("Touch", of)) => of.strip_prefix("Stick ").and_then(Way::named).map(Input::TouchStick),
        Some(("Pad", of)) => match of.split_once(' ') {
            Some(("LeftStick", way)) => Way::named(way).map(|way| Input::Stick(Stick::Left, way)),
            Some(("RightStick", way)) => Way::named(way).map(|way| Input::Stick(Stick::Right, way)),
            Some(_) => None,
            None => variant(of).or_else(|| of.parse().ok().map(GamepadButton::Other)).map(Input::Pad),
        },
        Some(_) => None,
    }
}

/// A key by the name of its place, or by the letter or digit that stands for it.
fn key(name: &str) -> Option<KeyCode> {
    let mut letters = name.chars();
    match (letters.next(), letters.next()) {
        (Some(letter), None) if letter.is_ascii_alphabetic() => variant(&format!("Key{}", letter.to_ascii_uppercase())),
        (Some(digit), None) if digit.is_ascii_digit() => variant(&format!("Digit{digit}")),
        _ => variant(name),
    }
}

/// A variant without fields, by its name.
fn variant<T: Typed + FromReflect>(name: &str) -> Option<T> {
    let VariantInfo::Unit(_) = T::type_info().as_enum().ok()?.variant(name)? else { return None };
    T::from_reflect(&DynamicEnum::new(name, DynamicVariant::Unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_input_is_read_from_its_own_name() {
        let inputs = [
            Input::key(KeyCode::KeyW),
            Input::key(KeyCode::ArrowUp),
            Input::Key(KeyCode::Equal, ModKeys::CONTROL | ModKeys::SHIFT),
            Input::Letter('+'),
            Input::Letter('ř'),
            Input::Mouse(MouseButton::Right, ModKeys::ALT),
            Input::mouse(MouseButton::Other(7)),
            Input::Wheel(Way::Down),
            Input::Pad(GamepadButton::RightTrigger2),
            Input::Pad(GamepadButton::Other(3)),
            Input::Stick(Stick::Right, Way::Left),
            Input::TouchStick(Way::Up),
        ];
        for input in inputs {
            assert_eq!(input.to_string().parse(), Ok(input), "{input}");
        }
    }

    #[test]
    fn people_write_letters_and_spaces_as_they_like() {
        for (written, meant) in [
            ("w", "KeyW"),
            ("7", "Digit7"),
            (" Shift + F ", "Shift+KeyF"),
            ("ctrl+q", "Ctrl+KeyQ"),
            ("shift+Mouse Left", "Shift+Mouse Left"),
        ] {
            assert_eq!(written.parse::<Input>().map(|input| input.to_string()), Ok(meant.to_owned()), "{written}");
        }
    }

    #[test]
    fn what_is_no_input_is_told_as_it_was_written() {
        for written in
            ["", "KeyÄ", "Unidentified", "Hyper+KeyF", "Shift+", "Letter", "Letter ab", "Mouse", "Wheel Left", "Shift+Pad South"]
        {
            assert_eq!(written.parse::<Input>(), Err(InputError(written.to_owned())));
        }
        for written in ["Pad LeftStick In", "Pad 999", "Touch Stick", "Mouse Other", "Pad Other", "Stick Up"] {
            assert!(written.parse::<Input>().is_err(), "{written}");
        }
    }
}
