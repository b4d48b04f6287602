//! Portals, walked through: a walker passes those that lead to an open cell, and stands before all others.

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use veduta::ecs::{OpenCells, VedutaSystems};
use veduta::prelude::*;
use veduta::streaming::CurrentCell;
use veduta::walker::Intent;
use veduta_store::{CityIndex, DirReader, read_index};
use veduta_tests::{sample_city, walker_in};

/// Whether all portals are kept shut.
#[derive(Resource)]
struct Shut(bool);

fn shut(keep: Res<Shut>, walkers: Query<&CurrentCell, With<Walker>>, mut open: ResMut<OpenCells>) {
    if keep.0 {
        let here = walkers.iter().filter_map(|current| current.0).collect();
        open.set_if_neq(OpenCells { cells: Some(here) });
    } else {
        open.set_if_neq(OpenCells { cells: None });
    }
}

fn eye(app: &App, walker: Entity) -> Eye {
    *app.world().get::<Eye>(walker).expect("the walker has an eye")
}

fn cell(app: &App, walker: Entity) -> Option<u32> {
    app.world().get::<CurrentCell>(walker).and_then(|current| current.0)
}

/// Walks to a place for so many seconds at most, or until another cell is entered.
fn walk_to(app: &mut App, walker: Entity, to: DVec2, seconds: f64) {
    let from = cell(app, walker);
    for _ in 0..(seconds / 0.033) as u32 {
        let way = to - eye(app, walker).plan_pos;
        app.world_mut().get_mut::<Eye>(walker).expect("the walker has an eye").heading_deg = way.x.atan2(way.y).to_degrees();
        *app.world_mut().resource_mut::<Intent>() = Intent { go: DVec3::Y, ..Intent::default() };
        app.update();
        if cell(app, walker) != from {
            break;
        }
    }
    *app.world_mut().resource_mut::<Intent>() = Intent::default();
}

/// The portals of a cell that lead on, each with the middle of it and a place two metres behind that.
fn doors(index: &CityIndex, cell: u32, inside: DVec2) -> Vec<(u32, DVec2, DVec2)> {
    let door = |portal: &veduta_city::Portal| {
        let (a, b) = (portal.ends.0.to_metres(), portal.ends.1.to_metres());
        let (middle, across) = ((a + b) / 2.0, (b - a).perp().normalize_or_zero());
        let out = if (middle - inside).dot(across) < 0.0 { -across } else { across };
        Some((portal.other(cell)?, middle, middle + 2.0 * out))
    };
    index.portals(cell).filter_map(door).collect()
}

#[test]
fn a_shut_portal_stops_a_walker_and_an_open_one_does_not() {
    let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
    let (mut app, walker) = walker_in(sample_city());
    app.insert_resource(Shut(true));
    app.add_systems(Update, shut.after(VedutaSystems::Stream));
    let home = cell(&app, walker).expect("the start lies in a cell");
    let start = eye(&app, walker).plan_pos;
    let mut passed = Vec::new();
    for (next, middle, behind) in doors(&index, home, start) {
        app.insert_resource(Shut(true));
        app.world_mut().get_mut::<Eye>(walker).expect("the walker has an eye").plan_pos = start;
        (0..10).for_each(|_| app.update());
        walk_to(&mut app, walker, behind, 45.0);
        assert_eq!(cell(&app, walker), Some(home), "through the shut portal to cell {next} at {middle}");
        let before = eye(&app, walker).plan_pos;
        app.insert_resource(Shut(false));
        walk_to(&mut app, walker, behind, 10.0);
        // Those behind a corner are not reached by going straight on.
        if cell(&app, walker) == Some(next) {
            let short_m = before.distance(middle);
            assert!(short_m < 3.0, "the portal to cell {next} stopped the walker {short_m} m before it");
            passed.push(next);
        }
    }
    assert!(passed.len() >= 2, "only cells {passed:?} were entered");
}
