use std::collections::BTreeMap;

use bevy::prelude::*;

use crate::{ControlList, Input, InputError, Listed};

/// What the visitor has changed: inputs by name of control. What is not here is as its control declares it. Live.
#[derive(Resource, Debug, Clone, PartialEq, Eq, Default)]
pub struct Controls {
    changed: BTreeMap<String, Vec<Input>>,
}

/// Controls as they are written in a file: names of inputs by name of control.
pub type WrittenControls = BTreeMap<String, Vec<String>>;

/// Something in a file of controls that was dropped.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ControlFinding {
    /// No control has such a name.
    #[error("{0:?} is no control: left out")]
    UnknownControl(
        /// The name.
        String,
    ),
    /// Something that is no input.
    #[error("{control}: left out, for {error}")]
    UnknownInput {
        /// Name of the control that it was bound to.
        control: String,
        /// What is wrong.
        error: InputError,
    },
}

/// One input that would do two things at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Conflict {
    /// The input.
    pub input: Input,
    /// Names of the two controls.
    pub controls: [&'static str; 2],
}

impl Controls {
    /// Reads what is written in a file. What cannot be is dropped, and told of. A control all of whose inputs are dropped stays as it is declared.
    #[must_use]
    pub fn read(written: &WrittenControls, list: &ControlList) -> (Self, Vec<ControlFinding>) {
        let (mut controls, mut findings) = (Self::default(), Vec::new());
        for (name, inputs) in written {
            let Some(control) = list.get(name) else {
                findings.push(ControlFinding::UnknownControl(name.clone()));
                continue;
            };
            let mut bound: Vec<Input> = Vec::new();
            for input in inputs {
                match input.parse() {
                    Ok(input) if bound.contains(&input) => {}
                    Ok(input) => bound.push(input),
                    Err(error) => findings.push(ControlFinding::UnknownInput { control: name.clone(), error }),
                }
            }
            if !bound.is_empty() || inputs.is_empty() {
                controls.set(control, bound);
            }
        }
        (controls, findings)
    }

    /// As it is written in a file.
    #[must_use]
    pub fn written(&self) -> WrittenControls {
        let names = |inputs: &Vec<Input>| inputs.iter().map(Input::to_string).collect();
        self.changed.iter().map(|(name, inputs)| (name.clone(), names(inputs))).collect()
    }

    /// What a control is bound to.
    #[must_use]
    pub fn bound<'a>(&'a self, control: &'a Listed) -> &'a [Input] {
        self.changed.get(control.name).map_or(control.defaults, Vec::as_slice)
    }

    /// Whether the visitor has changed a control.
    #[must_use]
    pub fn is_changed_from_first(&self, control: &Listed) -> bool {
        self.changed.contains_key(control.name)
    }

    /// Binds a control to inputs, and to nothing else.
    pub fn set(&mut self, control: &Listed, inputs: Vec<Input>) {
        if inputs == control.defaults {
            self.changed.remove(control.name);
        } else {
            self.changed.insert(control.name.to_owned(), inputs);
        }
    }

    /// Puts an input in the place of a control's n-th, or behind the last.
    pub fn put(&mut self, control: &Listed, nth: usize, input: Input) {
        let mut bound = self.bound(control).to_vec();
        match bound.get_mut(nth) {
            Some(place) => *place = input,
            None => bound.push(input),
        }
        let mut once: Vec<Input> = Vec::new();
        bound.retain(|input| {
            let is_first = !once.contains(input);
            once.push(*input);
            is_first
        });
        self.set(control, bound);
    }

    /// Takes a control's n-th input away.
    pub fn take(&mut self, control: &Listed, nth: usize) {
        let mut bound = self.bound(control).to_vec();
        if nth < bound.len() {
            bound.remove(nth);
            self.set(control, bound);
        }
    }

    /// Binds a control as it was at first.
    pub fn reset(&mut self, control: &Listed) {
        self.changed.remove(control.name);
    }

    /// Binds all controls as they were at first.
    pub fn reset_all(&mut self) {
        self.changed.clear();
    }

    /// Names of other controls that an input of a control does something for at the same time.
    #[must_use]
    pub fn others(&self, list: &ControlList, control: &Listed, input: Input) -> Vec<&'static str> {
        let meets = |other: &&Listed| other.name != control.name && list.overlap(other.scope, control.scope);
        list.iter().filter(meets).filter(|other| self.bound(other).contains(&input)).map(|other| other.name).collect()
    }

    /// All inputs that do two things at once.
    #[must_use]
    pub fn conflicts(&self, list: &ControlList) -> Vec<Conflict> {
        let mut found = Vec::new();
        for control in list.iter() {
            for &input in self.bound(control) {
                let others = self.others(list, control, input);
                found.extend(
                    others
                        .into_iter()
                        .filter(|other| control.name < *other)
                        .map(|other| Conflict { input, controls: [control.name, other] }),
                );
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Bow, Forward, Run, list};

    fn written(of: &[(&str, &[&str])]) -> WrittenControls {
        of.iter().map(|(name, inputs)| ((*name).to_owned(), inputs.iter().map(|&input| input.to_owned()).collect())).collect()
    }

    #[test]
    fn only_what_was_changed_is_written_and_read_again() {
        let list = list();
        let mut controls = Controls::default();
        let forward = list.get("walk.forward").expect("listed");
        controls.put(forward, 0, Input::key(KeyCode::KeyZ));
        assert_eq!(controls.written(), written(&[("walk.forward", &["KeyZ", "Pad LeftStick Up"])]));
        assert_eq!(Controls::read(&controls.written(), &list), (controls.clone(), vec![]));
        controls.put(forward, 0, Input::key(KeyCode::KeyW));
        assert_eq!(controls, Controls::default(), "as at first is no change");
        controls.take(forward, 1);
        controls.take(forward, 0);
        controls.take(forward, 0);
        assert_eq!(controls.written(), written(&[("walk.forward", &[])]), "bound to nothing is a change");
        assert_eq!(Controls::read(&controls.written(), &list).0, controls);
        controls.reset(forward);
        assert_eq!(controls, Controls::default());
    }

    #[test]
    fn an_input_stands_once_with_a_control() {
        let list = list();
        let mut controls = Controls::default();
        let forward = list.get("walk.forward").expect("listed");
        controls.put(forward, 9, Input::key(KeyCode::KeyW));
        assert_eq!(controls, Controls::default());
        controls.put(forward, 1, Input::key(KeyCode::KeyW));
        assert_eq!(controls.bound(forward), [Input::key(KeyCode::KeyW)]);
    }

    #[test]
    fn what_nobody_knows_is_dropped_and_told() {
        let file = written(&[("walk.fourward", &["KeyW"]), ("walk.run", &["Nose", "KeyX"]), ("walk.bow", &["Pad"])]);
        let (controls, findings) = Controls::read(&file, &list());
        assert_eq!(controls.written(), written(&[("walk.run", &["KeyX"])]));
        let told: Vec<String> = findings.iter().map(ToString::to_string).collect();
        assert_eq!(told.len(), 3, "{told:?}");
        assert!(told[0].contains("walk.bow") && told[0].contains("\"Pad\""), "{told:?}");
        assert!(told[1].contains("walk.fourward"), "{told:?}");
        assert!(told[2].contains("walk.run") && told[2].contains("\"Nose\"") && told[2].contains("Pad South"), "{told:?}");
    }

    #[test]
    fn one_input_may_do_two_things_only_in_scopes_that_never_meet() {
        use crate::Control;
        let list = list();
        let mut controls = Controls::default();
        assert_eq!(controls.conflicts(&list), [], "the same key bows on foot and dives in the air");
        let (run, forward) = (list.get(Run::NAME).expect("listed"), list.get(Forward::NAME).expect("listed"));
        controls.put(run, 0, Input::key(KeyCode::KeyW));
        let conflict = Conflict { input: Input::key(KeyCode::KeyW), controls: [Forward::NAME, Run::NAME] };
        assert_eq!(controls.conflicts(&list), [conflict]);
        assert_eq!(controls.others(&list, forward, Input::key(KeyCode::KeyW)), [Run::NAME]);
        controls.put(run, 0, Input::ctrl(KeyCode::KeyW));
        assert_eq!(controls.conflicts(&list), [], "held with another it is another");
        controls.put(run, 0, Bow::DEFAULTS[0]);
        assert_eq!(controls.conflicts(&list).len(), 2, "what is always heard meets both");
    }
}
