//! An empty Bevy app gains a city in three lines: the plugins, the city, a walker.
//!
//! Bake a city first: `cargo run --bin veduta-bake -- bake scenes/old_prague -o town.city`, then
//! `cargo run -p veduta --example empty_app`.

use bevy::prelude::*;
use veduta::prelude::*;

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, VedutaPlugins))
        .insert_resource(OpenCity("town.city".into()))
        .add_systems(Startup, |mut commands: Commands| _ = commands.spawn((Camera3d::default(), Walker)))
        .run()
}
