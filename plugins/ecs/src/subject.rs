use bevy::prelude::*;

/// Something that moves and that a tour can follow with the eye, by its name: a cart, a flock of pigeons, somebody who goes ahead. It is about
/// as long as the entity has a `GlobalTransform` and is not hidden; of several of one name the nearest is meant.
///
/// ```
/// use bevy::prelude::*;
/// use veduta_ecs::Subject;
///
/// fn spawn_cart(mut commands: Commands) {
///     // A tour says: Look(at: Spot(at: Place("Market"), follow: "Hay cart"), seconds: 2)
///     commands.spawn((Subject("Hay cart".into()), Transform::from_xyz(12.0, 1.2, -40.0)));
/// }
/// ```
#[derive(Component, Reflect, Debug, Clone, PartialEq, Eq, Hash, Default)]
#[reflect(Component)]
pub struct Subject(
    /// Its name.
    pub String,
);
