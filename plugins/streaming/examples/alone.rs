//! Streaming alone: it says which cells are there, and the game draws them as it likes (here: their outlines).
//!
//! `cargo run -p veduta-streaming --example streaming_alone -- town.city` (a directory or a URL)

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_ecs::{Cell, CellContent, City, CityFailed, CityOpened, Eye, OpenCity, Viewer, WorldOrigin};
use veduta_streaming::StreamingPlugin;

fn main() -> AppExit {
    let city = std::env::args().nth(1).unwrap_or_else(|| "town.city".into());
    let mut app = App::new();
    app.add_plugins((DefaultPlugins, StreamingPlugin::default())).add_systems(Update, draw_cells);
    visit(&mut app, city);
    app.run()
}

/// Opens a city and drifts across it, looking down.
fn visit(app: &mut App, city: String) {
    app.insert_resource(OpenCity(city))
        .add_systems(Startup, |mut commands: Commands| _ = commands.spawn((Camera3d::default(), Viewer)))
        .add_systems(Update, (stand_at_start, drift, tell_failures));
}

fn stand_at_start(mut opened: MessageReader<CityOpened>, city: Option<Res<City>>, mut eyes: Query<&mut Eye>) {
    let Some(city) = city.filter(|_| opened.read().last().is_some()) else { return };
    for mut eye in &mut eyes {
        *eye = Eye { eye_m: 120.0, pitch_deg: -60.0, ..Eye::at(city.start) };
    }
}

fn drift(time: Res<Time>, mut eyes: Query<&mut Eye>) {
    for mut eye in &mut eyes {
        let ahead = eye.heading_deg.to_radians();
        eye.plan_pos += DVec2::new(ahead.sin(), ahead.cos()) * 8.0 * time.delta_secs_f64();
    }
}

fn draw_cells(mut gizmos: Gizmos, origin: Res<WorldOrigin>, cells: Query<&CellContent, With<Cell>>) {
    for CellContent { shell, sheet, .. } in &cells {
        let colour = if sheet.is_some() { Color::srgb(0.9, 0.6, 0.2) } else { Color::srgb(0.4, 0.5, 0.6) };
        for ring in shell.outline.rings() {
            let closed = ring.iter().chain(ring.first());
            gizmos.linestrip(closed.map(|&corner| origin.world_from_grid(corner + shell.origin)), colour);
        }
    }
}

fn tell_failures(mut failures: MessageReader<CityFailed>) {
    for failure in failures.read() {
        warn!("{}", failure.message);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_city::{CellShell, Cells, CityPlan, FacadeSheet, GridPolygon, GridPos};
    use veduta_streaming::Fetching;

    #[test]
    fn cells_arrive_where_the_viewer_stands() {
        let outline = GridPolygon::simple(vec![GridPos(-9000, -9000), GridPos(9000, -9000), GridPos(0, 9000)]);
        let cell = veduta_city::Cell { outline: outline.clone(), ..veduta_city::Cell::default() };
        let cells = Cells { cells: vec![cell], visible: vec![vec![0]], ..Cells::default() };
        let shell = CellShell { outline, ..CellShell::default() };
        let dir = std::env::temp_dir().join(format!("veduta-streaming-alone-{}.city", std::process::id()));
        let written = veduta_store::write_city(&dir, &CityPlan::default(), &cells, &[shell], &[FacadeSheet::default()]);
        written.expect("the temporary directory can be written");

        let mut app = App::new();
        app.add_plugins((MinimalPlugins, StreamingPlugin { fetching: Fetching::Inline }));
        visit(&mut app, dir.display().to_string());
        for _ in 0..20 {
            app.update();
        }
        let found = app.world_mut().query::<(&Cell, &CellContent)>().iter(app.world()).count();
        assert_eq!(found, 1, "the one cell of the city is there");
        std::fs::remove_dir_all(&dir).expect("it was written above");
    }
}
