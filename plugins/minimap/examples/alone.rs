//! The minimap alone, of any plan: a game's own streets and houses, and a viewer that walks in a circle.
//!
//! `cargo run -p veduta-minimap --example minimap_alone` (M opens the large map, N turns it north up)

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::{GridPolygon, GridPos, GroundPatch, Id, Massing, Overview, Place, PlaceKind, PlanStreet, SurfaceKind};
use veduta_ecs::{City, Eye, JumpTo, Overviews, Viewer};
use veduta_minimap::{MinimapPlugin, MinimapSettings};

fn main() -> AppExit {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins, MinimapPlugin))
        .insert_resource(MinimapSettings { share: 0.5, north_up: true, ..default() })
        .insert_resource(village())
        .add_systems(Startup, |mut commands: Commands| _ = commands.spawn((Camera3d::default(), Viewer)))
        .add_systems(Update, (circle, tell_jumps));
    app.run()
}

/// A rectangle by its middle and half its size in metres.
fn rectangle(middle: (i32, i32), half: (i32, i32)) -> GridPolygon {
    let corner = |x: i32, y: i32| GridPos((middle.0 + x * half.0) * 1024, (middle.1 + y * half.1) * 1024);
    GridPolygon::simple(vec![corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)])
}

/// A square with houses round it, a street across it and a pond.
fn village() -> City {
    let line = [(-120, 0), (0, 0), (120, 20)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec();
    let street =
        PlanStreet { id: Id(1), name: "Long Street".into(), line, width: 8 * 1024, walkable: true, ..PlanStreet::default() };
    let house = |(x, y)| Massing::block(rectangle((x, y), (7, 6)), 9 * 1024);
    let patch = |surface, outline| GroundPatch { surface, outline, z: 0, course: None };
    let beside = [(-40, 45), (-20, 45), (0, 45), (20, 45), (40, 45), (-40, -45), (-20, -45), (0, -45), (20, -45)];
    let square = Place { name: "Market".into(), kind: PlaceKind::Square, pos: DVec2::new(0.0, 10.0), ..default() };
    let overview = Overview {
        streets: vec![street],
        ground: vec![
            patch(SurfaceKind::Cobbles, rectangle((0, 0), (50, 35))),
            patch(SurfaceKind::Cobbles, rectangle((0, 0), (120, 4))),
            patch(SurfaceKind::Water, rectangle((85, -40), (20, 15))),
        ],
        houses: beside.map(house).to_vec(),
        places: vec![square],
        ..default()
    };
    City { name: "Village".into(), extent: rectangle((0, 0), (130, 80)), overviews: Overviews::whole(overview), ..default() }
}

fn circle(time: Res<Time>, mut eyes: Query<&mut Eye, With<Viewer>>) {
    let angle = time.elapsed_secs_f64() * 0.2;
    for mut eye in &mut eyes {
        eye.plan_pos = DVec2::new(angle.sin(), angle.cos()) * 28.0;
        eye.heading_deg = (angle.to_degrees() + 90.0).rem_euclid(360.0);
    }
}

/// A click on the large map asks to go there; this game only says so.
fn tell_jumps(mut jumps: MessageReader<JumpTo>) {
    for JumpTo(view) in jumps.read() {
        info!("to {:.0}", view.pos);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_viewer_walks_inside_the_village_and_faces_ahead() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, veduta_ecs::EcsPlugin)).insert_resource(village()).add_systems(Update, circle);
        app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(std::time::Duration::from_millis(100)));
        let viewer = app.world_mut().spawn(Viewer).id();
        let mut before = None;
        for _ in 0..50 {
            app.update();
            let eye = *app.world().get::<Eye>(viewer).expect("a viewer has an eye");
            let at = GridPos(GridPos::steps(eye.plan_pos.x), GridPos::steps(eye.plan_pos.y));
            assert!(app.world().resource::<City>().extent.contains(at));
            let ahead = DVec2::new(eye.heading_deg.to_radians().sin(), eye.heading_deg.to_radians().cos());
            let went = before.map(|before: DVec2| eye.plan_pos - before);
            assert!(went.is_none_or(|went| went.dot(ahead) >= 0.0), "{eye:?}");
            before = Some(eye.plan_pos);
        }
    }
}
