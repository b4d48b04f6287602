use std::collections::BTreeMap;

use bevy::input::gamepad::GamepadButton;
use bevy::prelude::*;
use bevy_enhanced_input::prelude::ModKeys;
use veduta_ecs::{Words, WordsValue};

use crate::{Control, ControlList, Controls, Device, Input, LastDevice, Listed, Stick, Way};

/// What is written on keys, by their places: learned from what they write when they are pressed.
#[derive(Resource, Debug, Clone, PartialEq, Eq, Default)]
pub struct KeyCaps(BTreeMap<KeyCode, String>);

impl KeyCaps {
    /// Whether this is known already.
    pub(crate) fn has(&self, key: KeyCode, written: char) -> bool {
        self.0.get(&key).is_some_and(|cap| cap.chars().eq(written.to_uppercase()))
    }

    /// A key has written this, with no other held.
    pub(crate) fn learn(&mut self, key: KeyCode, written: char) {
        if !written.is_whitespace() && !written.is_control() {
            self.0.insert(key, written.to_uppercase().collect());
        }
    }
}

/// Names of the inputs that controls are bound to now, on the device that was used last, in the visitor's language: for help, hints and
/// tooltips. Kept by [`ControlsPlugin`](crate::ControlsPlugin).
#[derive(Resource, Debug, Clone, PartialEq, Eq, Default)]
pub struct KeyNames {
    names: BTreeMap<&'static str, Vec<String>>,
    device: Device,
}

/// Between names of inputs.
const BETWEEN: &str = " · ";

impl KeyNames {
    /// Names of what all controls of a list are bound to.
    #[must_use]
    pub fn tell(list: &ControlList, controls: &Controls, device: Device, words: &Words, caps: &KeyCaps) -> Self {
        let named = |control: &Listed| {
            let bound = controls.bound(control);
            let on = |device: Device| bound.iter().copied().filter(move |input| input.device() == device);
            // What cannot be done on this device is told for the keyboard.
            let device = if on(device).next().is_some() { device } else { Device::Keys };
            let mut names: Vec<String> = on(device).map(|input| label(input, words, caps)).collect();
            names.dedup();
            names
        };
        Self { names: list.iter().map(|control| (control.name, named(control))).collect(), device }
    }

    /// The first input of a control; empty if it is bound to nothing.
    #[must_use]
    pub fn first<C: Control>(&self) -> &str {
        self.of(C::NAME).first().map_or("", String::as_str)
    }

    /// The first input of a control, for sentences: what is bound to nothing is done by “nothing”.
    #[must_use]
    pub fn said<C: Control>(&self, words: &Words) -> String {
        self.of(C::NAME).first().cloned().unwrap_or_else(|| words.say("input-none"))
    }

    /// All inputs of a control; empty if it is bound to nothing.
    #[must_use]
    pub fn all<C: Control>(&self) -> String {
        self.of(C::NAME).join(BETWEEN)
    }

    /// The first inputs of some controls, as `W A S D`; what they have in common is said once, as `left stick ⬆ ⬇`.
    #[must_use]
    pub fn firsts(&self, controls: &[&str]) -> String {
        let mut firsts: Vec<&str> = controls.iter().filter_map(|name| self.of(name).first()).map(String::as_str).collect();
        firsts.dedup();
        let parts: Vec<(&str, &str)> = firsts.iter().filter_map(|name| name.rsplit_once(' ')).collect();
        if let Some((common, _)) = parts.first()
            && parts.len() == firsts.len()
            && parts.iter().all(|(before, last)| before == common && last.chars().count() < 3)
        {
            let lasts: Vec<&str> = parts.iter().map(|(_, last)| *last).collect();
            return format!("{common} {}", lasts.join(" "));
        }
        // Letters stand beside each other; longer names need more between them.
        let are_short = firsts.iter().all(|name| name.chars().count() < 9);
        firsts.join(if are_short { " " } else { BETWEEN })
    }

    /// What the visitor has in hand: the device whose inputs are named.
    #[must_use]
    pub fn device(&self) -> Device {
        self.device
    }

    fn of(&self, control: &str) -> &[String] {
        self.names.get(control).map_or(&[], Vec::as_slice)
    }
}

pub(crate) fn tell(
    (list, controls, words, caps, last): (Res<ControlList>, Res<Controls>, Res<Words>, Res<KeyCaps>, Res<LastDevice>),
    mut names: ResMut<KeyNames>,
) {
    if controls.is_changed() || words.is_changed() || caps.is_changed() || last.is_changed() || list.is_changed() {
        names.set_if_neq(KeyNames::tell(&list, &controls, last.0, &words, &caps));
    }
}

/// An input as a visitor reads it.
#[must_use]
pub fn label(input: Input, words: &Words, caps: &KeyCaps) -> String {
    let with = |message: &str, name: &'static str, value: WordsValue| words.say_with(message, &[(name, value)]);
    let arrow = |way: Way| WordsValue::from(["⬆", "⬇", "⬅", "➡"][way as usize]);
    let own = match input {
        Input::Key(code, _) => key(code, words, caps),
        Input::Letter(letter) => letter.to_uppercase().collect(),
        Input::Mouse(button, _) => match button {
            MouseButton::Left => words.say("input-mouse-left"),
            MouseButton::Right => words.say("input-mouse-right"),
            MouseButton::Middle => words.say("input-mouse-middle"),
            MouseButton::Back => words.say("input-mouse-back"),
            MouseButton::Forward => words.say("input-mouse-forward"),
            MouseButton::Other(n) => with("input-mouse-other", "n", n.into()),
        },
        Input::Wheel(way) => words.say(if way == Way::Up { "input-wheel-up" } else { "input-wheel-down" }),
        Input::Pad(button) => match pad(button) {
            Ok(name) => with("input-pad", "button", name.into()),
            Err(way) => with("input-pad-cross", "way", arrow(way)),
        },
        Input::Stick(Stick::Left, way) => with("input-stick-left", "way", arrow(way)),
        Input::Stick(Stick::Right, way) => with("input-stick-right", "way", arrow(way)),
        Input::TouchStick(way) => with("input-touch", "way", arrow(way)),
    };
    let held = [(ModKeys::CONTROL, "Ctrl+"), (ModKeys::SHIFT, "Shift+"), (ModKeys::ALT, "Alt+"), (ModKeys::SUPER, "Super+")];
    held.into_iter().filter(|(key, _)| input.mods().contains(*key)).map(|(_, name)| name).chain([own.as_str()]).collect()
}

/// Signs on keys where they do not say them themselves, as most keyboards have them.
const SIGNS: [(KeyCode, &str); 27] = [
    (KeyCode::ArrowUp, "⬆"),
    (KeyCode::ArrowDown, "⬇"),
    (KeyCode::ArrowLeft, "⬅"),
    (KeyCode::ArrowRight, "➡"),
    (KeyCode::Escape, "Esc"),
    (KeyCode::Delete, "Del"),
    (KeyCode::Minus, "−"),
    (KeyCode::Equal, "="),
    (KeyCode::BracketLeft, "["),
    (KeyCode::BracketRight, "]"),
    (KeyCode::Backslash, "\\"),
    (KeyCode::Semicolon, ";"),
    (KeyCode::Quote, "'"),
    (KeyCode::Backquote, "`"),
    (KeyCode::Comma, ","),
    (KeyCode::Period, "."),
    (KeyCode::Slash, "/"),
    (KeyCode::IntlBackslash, "<"),
    (KeyCode::NumpadAdd, "Num +"),
    (KeyCode::NumpadSubtract, "Num −"),
    (KeyCode::NumpadMultiply, "Num *"),
    (KeyCode::NumpadDivide, "Num /"),
    (KeyCode::NumpadEnter, "Num Enter"),
    (KeyCode::ShiftLeft, "Shift"),
    (KeyCode::ControlLeft, "Ctrl"),
    (KeyCode::AltLeft, "Alt"),
    (KeyCode::SuperLeft, "Super"),
];

fn key(code: KeyCode, words: &Words, caps: &KeyCaps) -> String {
    if let Some(cap) = caps.0.get(&code) {
        return cap.clone();
    }
    if let Some((_, sign)) = SIGNS.iter().find(|(known, _)| *known == code) {
        return (*sign).to_owned();
    }
    let right = |name: &'static str| words.say_with("key-right", &[("key", name.into())]);
    match code {
        KeyCode::Space => words.say("key-space"),
        KeyCode::Enter => words.say("key-enter"),
        KeyCode::ShiftRight => right("Shift"),
        KeyCode::ControlRight => right("Ctrl"),
        KeyCode::AltRight => right("Alt"),
        KeyCode::SuperRight => right("Super"),
        other => {
            let name = format!("{other:?}");
            let short = name.strip_prefix("Key").or_else(|| name.strip_prefix("Digit")).map(str::to_owned);
            short.or_else(|| name.strip_prefix("Numpad").map(|rest| format!("Num {rest}"))).unwrap_or(name)
        }
    }
}

/// A button as it is written on most gamepads, or the way of one of the cross.
fn pad(button: GamepadButton) -> Result<String, Way> {
    let name = match button {
        GamepadButton::DPadUp => return Err(Way::Up),
        GamepadButton::DPadDown => return Err(Way::Down),
        GamepadButton::DPadLeft => return Err(Way::Left),
        GamepadButton::DPadRight => return Err(Way::Right),
        GamepadButton::South => "A",
        GamepadButton::East => "B",
        GamepadButton::West => "X",
        GamepadButton::North => "Y",
        GamepadButton::LeftTrigger => "LB",
        GamepadButton::RightTrigger => "RB",
        GamepadButton::LeftTrigger2 => "LT",
        GamepadButton::RightTrigger2 => "RT",
        GamepadButton::LeftThumb => "L3",
        GamepadButton::RightThumb => "R3",
        GamepadButton::Select => "View",
        GamepadButton::Start => "Menu",
        GamepadButton::Other(n) => return Ok(n.to_string()),
        other => return Ok(format!("{other:?}")),
    };
    Ok(name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Forward, Run, list};

    fn words(language: &str) -> Words {
        let mut words = Words::default();
        crate::WORDS.iter().for_each(|(code, file)| words.add(code, file).expect("no mistakes"));
        words.speak(language);
        words
    }

    #[test]
    fn inputs_are_told_as_they_are_written_on_keys_and_pads() {
        let (english, czech, mut caps) = (words("en"), words("cs"), KeyCaps::default());
        for (input, en, cs) in [
            ("KeyW", "W", "W"),
            ("Shift+Digit1", "Shift+1", "Shift+1"),
            ("Space", "Space", "mezerník"),
            ("ShiftRight", "right Shift", "pravý Shift"),
            ("Numpad4", "Num 4", "Num 4"),
            ("ArrowLeft", "⬅", "⬅"),
            ("Mouse Right", "right mouse button", "pravé tlačítko myši"),
            ("Mouse 7", "mouse button 7", "tlačítko myši 7"),
            ("Pad South", "Pad A", "ovladač A"),
            ("Pad DPadUp", "D-pad ⬆", "kříž ⬆"),
            ("Pad RightStick Left", "right stick ⬅", "pravá páčka ⬅"),
        ] {
            let input: Input = input.parse().expect("an input");
            assert_eq!([label(input, &english, &caps), label(input, &czech, &caps)], [en, cs]);
        }
        caps.learn(KeyCode::KeyW, 'z');
        caps.learn(KeyCode::Space, ' ');
        assert_eq!(label(Input::key(KeyCode::KeyW), &english, &caps), "Z", "what this keyboard has there");
        assert_eq!(label(Input::key(KeyCode::Space), &english, &caps), "Space");
    }

    #[test]
    fn names_follow_what_is_bound_and_what_is_in_the_hand() {
        let (list, words, caps) = (list(), words("en"), KeyCaps::default());
        let mut controls = Controls::default();
        controls.put(list.get(Run::NAME).expect("listed"), 1, Input::key(KeyCode::KeyX));
        let keys = KeyNames::tell(&list, &controls, Device::Keys, &words, &caps);
        assert_eq!((keys.first::<Run>(), keys.all::<Run>().as_str()), ("R", "R · X"));
        assert_eq!(keys.firsts(&[Forward::NAME, Run::NAME]), "W R");
        let pad = KeyNames::tell(&list, &controls, Device::Pad, &words, &caps);
        assert_eq!(pad.first::<Forward>(), "left stick ⬆");
        assert_eq!(pad.first::<Run>(), "R", "there is no other way");
        controls.put(list.get(Run::NAME).expect("listed"), 2, Input::Stick(Stick::Left, Way::Down));
        let pad = KeyNames::tell(&list, &controls, Device::Pad, &words, &caps);
        assert_eq!(pad.firsts(&[Forward::NAME, Run::NAME]), "left stick ⬆ ⬇");
    }
}
