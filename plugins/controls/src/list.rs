use std::any::TypeId;

use bevy::prelude::*;
use bevy::utils::TypeIdMap;
use bevy_enhanced_input::context::instance::ContextInstances;
use bevy_enhanced_input::prelude::*;

use crate::{Control, Controls, ControlsSystems, Input, Scope};

/// All controls that there are, and the scopes they are heard in.
#[derive(Resource, Default)]
pub struct ControlList {
    scopes: Vec<ListedScope>,
    controls: Vec<Listed>,
    by_type: TypeIdMap<usize>,
}

/// A control on the list.
#[derive(Debug, Clone)]
pub struct Listed {
    /// [`Control::NAME`].
    pub name: &'static str,
    /// [`Scope::NAME`].
    pub scope: &'static str,
    /// [`Control::DEFAULTS`].
    pub defaults: &'static [Input],
    pub(crate) key_share: f32,
    pub(crate) curve: f32,
    pub(crate) action: Option<Entity>,
    /// What its action is bound to now.
    pub(crate) bound: Option<Vec<Input>>,
    spawn: fn(&mut World, Entity) -> Entity,
}

struct ListedScope {
    name: &'static str,
    never_with: &'static [&'static str],
    is_active: bool,
    entity: Option<Entity>,
    spawn: fn(&mut World) -> Entity,
}

impl ControlList {
    /// Controls in the order in which they were added.
    pub fn iter(&self) -> impl Iterator<Item = &Listed> {
        self.controls.iter()
    }

    /// Names of scopes that have controls, in the order in which they were added.
    pub fn scopes(&self) -> impl Iterator<Item = &'static str> {
        self.scopes.iter().map(|scope| scope.name).filter(|name| self.controls.iter().any(|control| control.scope == *name))
    }

    /// A control by its name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Listed> {
        self.controls.iter().find(|control| control.name == name)
    }

    /// Whether two scopes can be active at once.
    #[must_use]
    pub fn overlap(&self, one: &str, other: &str) -> bool {
        let never = |one: &str, other: &str| self.scopes.iter().any(|s| s.name == one && s.never_with.contains(&other));
        one == other || !(never(one, other) || never(other, one))
    }

    /// Whether controls of a scope are heard now.
    #[must_use]
    pub fn is_active(&self, scope: &str) -> bool {
        self.scopes.iter().any(|s| s.name == scope && s.is_active)
    }

    pub(crate) fn action_of<C: Control>(&self) -> Option<Entity> {
        self.controls.get(*self.by_type.get(&TypeId::of::<C>())?)?.action
    }

    pub(crate) fn controls_mut(&mut self) -> impl Iterator<Item = &mut Listed> {
        self.controls.iter_mut()
    }

    fn scope_mut(&mut self, name: &str) -> Option<&mut ListedScope> {
        self.scopes.iter_mut().find(|scope| scope.name == name)
    }

    /// Puts a control on the list. One that is there already stays as it is.
    pub(crate) fn add<C: Control>(&mut self) {
        if self.by_type.contains_key(&TypeId::of::<C>()) {
            return;
        }
        if self.get(C::NAME).is_some() {
            error!("two controls are named {:?}: the second is left out; give it another name", C::NAME);
            return;
        }
        self.by_type.insert(TypeId::of::<C>(), self.controls.len());
        self.controls.push(Listed {
            name: C::NAME,
            scope: C::Scope::NAME,
            defaults: C::DEFAULTS,
            key_share: C::KEY_SHARE,
            curve: C::CURVE,
            action: None,
            bound: None,
            spawn: spawn_control::<C>,
        });
    }
}

/// Declares scopes and controls. Before the app runs: what is added later is not heard.
pub trait ControlsAppExt {
    /// Adds a scope, and the system that says each frame whether it is active. Once is enough; it stays as it was added first.
    fn add_scope<S: Scope, M>(&mut self, when: impl IntoSystem<(), bool, M> + 'static) -> &mut Self;
    /// Adds a control to the list. Its scope may be added before or after it.
    fn add_control<C: Control>(&mut self) -> &mut Self;
}

impl ControlsAppExt for App {
    fn add_scope<S: Scope, M>(&mut self, when: impl IntoSystem<(), bool, M> + 'static) -> &mut Self {
        crate::ensure(self);
        let mut list = self.world_mut().resource_mut::<ControlList>();
        if list.scope_mut(S::NAME).is_some() {
            return self;
        }
        list.scopes.push(ListedScope {
            name: S::NAME,
            never_with: S::NEVER_WITH,
            is_active: true,
            entity: None,
            spawn: |world| world.spawn((S::default(), ContextPriority::<S>::new(S::PRIORITY))).id(),
        });
        self.add_input_context::<S>();
        self.add_systems(PreUpdate, IntoSystem::into_system(when).pipe(activate::<S>).in_set(ControlsSystems::Scopes))
    }

    fn add_control<C: Control>(&mut self) -> &mut Self {
        crate::ensure(self);
        self.world_mut().resource_mut::<ControlList>().add::<C>();
        self
    }
}

fn spawn_control<C: Control>(world: &mut World, scope: Entity) -> Entity {
    let settings = ActionSettings { accumulation: Accumulation::MaxAbs, require_reset: true, consume_input: false };
    world.spawn((Action::<C>::new(), Name::new(C::NAME), settings, ActionOf::<C::Scope>::new(scope))).id()
}

fn activate<S: Scope>(
    In(is_active): In<bool>,
    mut list: ResMut<ControlList>,
    contexts: Query<(Entity, &ContextActivity<S>)>,
    mut commands: Commands,
) {
    for (entity, was_active) in &contexts {
        if **was_active != is_active {
            commands.entity(entity).insert(ContextActivity::<S>::new(is_active));
        }
    }
    if list.is_active(S::NAME) != is_active
        && let Some(scope) = list.bypass_change_detection().scope_mut(S::NAME)
    {
        scope.is_active = is_active;
    }
}

/// Makes the actions of all controls, once.
pub(crate) fn spawn(world: &mut World) {
    if !world.contains_resource::<ContextInstances<PreUpdate>>() {
        warn!("controls are not heard: call `App::finish` before the first `App::update`, as `App::run` does");
        return;
    }
    let mut list = world.remove_resource::<ControlList>().unwrap_or_default();
    for scope in list.scopes.iter_mut().filter(|scope| scope.entity.is_none()) {
        scope.entity = Some((scope.spawn)(world));
    }
    let ControlList { scopes, controls, .. } = &mut list;
    for control in controls.iter_mut().filter(|control| control.action.is_none()) {
        match scopes.iter().find(|scope| scope.name == control.scope).and_then(|scope| scope.entity) {
            Some(scope) => control.action = Some((control.spawn)(world, scope)),
            None => error!("{:?} is not heard: add its scope {:?} with `App::add_scope`", control.name, control.scope),
        }
    }
    world.insert_resource(list);
}

/// Binds actions to what their controls are bound to now.
pub(crate) fn bind(
    controls: Res<Controls>,
    mut list: ResMut<ControlList>,
    mut sensed: ResMut<crate::sense::Sensed>,
    mut custom: ResMut<CustomInputs>,
    mut settings: Query<&mut ActionSettings>,
    mut commands: Commands,
) {
    for control in list.bypass_change_detection().controls_mut() {
        let wanted = controls.bound(control);
        let Some(action) = control.action.filter(|_| control.bound.as_deref() != Some(wanted)) else { continue };
        commands.entity(action).despawn_related::<Bindings>();
        for &input in wanted {
            let binding = match input {
                Input::Key(key, mod_keys) => Binding::Keyboard { key, mod_keys },
                Input::Mouse(button, mod_keys) => Binding::MouseButton { button, mod_keys },
                _ => Binding::Custom(sensed.id(input, &mut custom)),
            };
            let mut made = commands.spawn((BindingOf(action), binding));
            if input.is_digital() && control.key_share != 1.0 {
                made.insert(Scale::splat(control.key_share));
            } else if !input.is_digital() && control.curve != 1.0 {
                made.insert(ExponentialCurve::splat(control.curve));
            }
        }
        if let Ok(mut settings) = settings.get_mut(action) {
            // Where keys are held with it, what is bound to it alone is not meant.
            settings.consume_input = wanted.iter().any(|input| !input.mods().is_empty());
        }
        control.bound = Some(wanted.to_vec());
    }
}
