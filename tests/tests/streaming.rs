//! Streaming from disk and over HTTP on the loopback address, with faults: the walk goes on with what is there.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta::buildings::BuildSettings;
use veduta::ecs::{Around, Awaited, CellMesh, CellMeshKind, DistrictMemory, Footing, Itinerary, OpenCells, StandingCells, Stop};
use veduta::prelude::*;
use veduta::streaming::{CurrentCell, Event, Fetching, Journal, Link, Motion, Pace, Reason, Wanted, What, Why, replay};
use veduta_city::{GridPos, Level, Levels, bounds};
use veduta_store::{DirReader, RegionEntry, read_index};
use veduta_tests::{in_memory, inner_point, quiet_app, sample_city, update_until, workplace};

/// A plain file server on the loopback address; it can be told to die.
struct Server {
    address: String,
    dead: Arc<AtomicBool>,
    served: Arc<AtomicUsize>,
}

impl Server {
    fn of(dir: &Path) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port on the loopback address");
        let address = format!("http://{}", listener.local_addr().expect("it is bound"));
        let (dead, served) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicUsize::new(0)));
        let (dir, flag, count) = (dir.to_owned(), Arc::clone(&dead), Arc::clone(&served));
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                if !flag.load(Ordering::SeqCst) {
                    answer(&dir, stream, &count);
                }
            }
        });
        Self { address, dead, served }
    }
}

fn answer(dir: &Path, mut stream: TcpStream, count: &AtomicUsize) {
    let mut line = String::new();
    let mut reader = BufReader::new(&stream);
    if reader.read_line(&mut line).is_err() {
        return;
    }
    let mut header = String::new();
    while reader.read_line(&mut header).is_ok_and(|n| n > 2) {
        header.clear();
    }
    let path = line.split(' ').nth(1).unwrap_or("/").trim_start_matches('/').to_owned();
    let reply = match std::fs::read(dir.join(path)) {
        Ok(bytes) => {
            count.fetch_add(1, Ordering::SeqCst);
            let mut reply = format!("HTTP/1.1 200 OK\r\nContent-Length: {}\r\nConnection: close\r\n\r\n", bytes.len()).into_bytes();
            reply.extend(bytes);
            reply
        }
        Err(_) => b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n".to_vec(),
    };
    // A client that has hung up is no concern of the server's.
    let _ = stream.write_all(&reply);
}

/// Spawns a viewer at the city's start once it is open, and waits until all in sight stands.
fn stand(app: &mut App) -> Entity {
    update_until(app, 8_000, "the city is open", |world| world.contains_resource::<City>());
    let start = app.world().resource::<City>().start;
    let viewer = app.world_mut().spawn((Viewer, Eye::at(start), Transform::default())).id();
    viewer_sees(app);
    viewer
}

fn viewer_sees(app: &mut App) {
    update_until(app, 8_000, "all in sight stands", |world| {
        let wanted = world.resource::<Wanted>();
        let standing = world.resource::<StandingCells>();
        !wanted.in_sight.is_empty() && wanted.in_sight.iter().all(|&cell| standing.levels(cell).has(Level::One))
    });
}

fn failures(app: &App) -> Vec<String> {
    app.world().resource::<Messages<CityFailed>>().iter_current_update_messages().map(|f| f.message.clone()).collect()
}

fn copy_of_the_sample(name: &str) -> PathBuf {
    fn copy(from: &Path, to: &Path) {
        std::fs::create_dir_all(to).expect("a folder of our own");
        for entry in std::fs::read_dir(from).expect("the baked city").flatten() {
            let target = to.join(entry.file_name());
            if entry.path().is_dir() {
                copy(&entry.path(), &target);
            } else {
                std::fs::copy(entry.path(), target).expect("room");
            }
        }
    }
    let to = workplace(name).join("copy.city");
    copy(sample_city(), &to);
    to
}

#[test]
fn a_walk_over_http_sees_the_same_cells_as_one_from_disk() {
    let server = Server::of(sample_city());
    let standing = |place: &str, fetching| {
        let mut app = quiet_app(place, fetching, Duration::from_millis(10));
        let viewer = stand(&mut app);
        app.world_mut().get_mut::<Eye>(viewer).expect("spawned").plan_pos += DVec2::new(-60.0, -30.0);
        app.update();
        viewer_sees(&mut app);
        app.world().resource::<Wanted>().in_sight.clone()
    };
    let near = standing(&sample_city().display().to_string(), Fetching::Inline);
    let far = standing(&server.address, Fetching::Threads(4));
    assert_eq!(near, far);
    assert!(server.served.load(Ordering::SeqCst) > near.len() / 2);
}

#[test]
fn levels_come_in_order_and_cells_are_released_behind_the_walker() {
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
    let viewer = stand(&mut app);
    app.world_mut().resource_mut::<StreamingSettings>().keep_s = 1.0;
    let first: Vec<u32> = app.world().resource::<StandingCells>().iter().map(|(cell, ..)| cell).collect();
    let far = app.world().resource::<City>().extent.outer.iter().map(|p| p.to_metres()).max_by(|a, b| a.x.total_cmp(&b.x));
    let far = far.expect("the city has an extent");
    app.world_mut().get_mut::<Eye>(viewer).expect("spawned").plan_pos = DVec2::new(far.x - 60.0, -10.0);
    for _ in 0..60 {
        app.update();
        for (cell, levels, _) in app.world().resource::<StandingCells>().iter() {
            assert!(levels.has(Level::One), "cell {cell} has a finer level without level 1");
        }
    }
    let now: Vec<u32> = app.world().resource::<StandingCells>().iter().map(|(cell, ..)| cell).collect();
    let idle: Vec<&u32> = now.iter().filter(|&&cell| !app.world().resource::<Wanted>().wants(cell)).collect();
    assert!(idle.is_empty(), "cells {idle:?} still stand, and nobody has wanted them for five seconds");
    let gone = first.iter().filter(|cell| !now.contains(cell)).count();
    assert!(gone > 10, "only {gone} of {} cells are gone, 400 m away", first.len());
    let entities = app.world_mut().query::<&veduta::ecs::Cell>().iter(app.world()).count();
    assert_eq!(entities, now.len(), "each standing cell is one entity");
}

#[test]
fn what_lies_on_an_itinerary_stands_before_one_is_there() {
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
    let viewer = stand(&mut app);
    let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
    let here = app.world().get::<Eye>(viewer).expect("spawned").plan_pos;
    let middles = index.cells().map(|(cell, entry)| (cell, entry.outline.centroid()));
    let within = middles.filter(|(cell, at)| index.locate(veduta_city::GridPos::from_metres(*at)) == Some(*cell));
    let (far, at) = within.max_by(|a, b| a.1.distance(here).total_cmp(&b.1.distance(here))).expect("cells");
    let seen = &index.cell(far).expect("told").visible;
    let missing =
        |app: &App| seen.iter().filter(|&&cell| !app.world().resource::<StandingCells>().levels(cell).has(Level::One)).count();
    assert!(missing(&app) > 0, "nobody has wanted it yet");
    let stop = Stop { in_s: 20.0, plan_pos: at, eye_m: 1.65 };
    app.world_mut().entity_mut(viewer).insert(Itinerary(vec![stop]));
    (0..20).for_each(|_| app.update());
    assert_eq!(missing(&app), 0, "it is there beforehand");
    assert_eq!(app.world().resource::<Wanted>().why(far), Some(Why::Ahead { from: far }));
    app.world_mut().get_mut::<Eye>(viewer).expect("spawned").plan_pos = at;
    app.update();
    assert_eq!(*app.world().resource::<Awaited>(), Awaited::default(), "the leap needs no dark");
}

#[test]
fn who_flies_wants_what_shows_level_2_and_no_more() {
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
    let viewer = stand(&mut app);
    let settings = *app.world().resource::<StreamingSettings>();
    let mut eye = app.world_mut().get_mut::<Eye>(viewer).expect("spawned");
    eye.eye_m = settings.flying_from_m + 30.0;
    let here = eye.plan_pos;
    (0..4).for_each(|_| app.update());
    let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
    let wanted = app.world().resource::<Wanted>();
    let (mut near, mut far) = (0, 0);
    for (cell, entry) in index.cells() {
        let (low, high) = (entry.bounds.0.to_metres(), entry.bounds.1.to_metres());
        let is_near = here.distance(here.clamp(low, high)) <= settings.level_2_m;
        let why = wanted.why(cell);
        assert_eq!(is_near, why == Some(Why::Near), "cell {cell}: {why:?}");
        assert!(is_near || matches!(why, None | Some(Why::Skyline)), "cell {cell}: {why:?}");
        let has_windows = entry.packet(Level::Two).is_some();
        assert_eq!(wanted.wants_level(cell, Level::Two), has_windows && is_near, "cell {cell}");
        *(if is_near { &mut near } else { &mut far }) += 1;
    }
    assert!(near > 20 && far > 20, "{near} cells are near and {far} far");
}

#[test]
fn what_is_loaded_by_default_reaches_as_far_as_it_shows_by_default() {
    let (loaded, shown) = (StreamingSettings::default(), LevelDistances::default());
    let reach = [0, 1].map(|band| f64::from(shown.far[band]) + StreamingSettings::LEAD_M);
    assert_eq!([loaded.level_2_m, loaded.level_3_m], reach);
}

#[test]
fn two_viewers_are_served_under_one_cap() {
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
    let first = stand(&mut app);
    let alone = app.world().resource::<Wanted>().in_sight.clone();
    let start = app.world().resource::<City>().start;
    let mut other = Eye::at(start);
    other.plan_pos = DVec2::new(300.0, -27.0);
    let second = app.world_mut().spawn((Viewer, other, Transform::default())).id();
    app.update();
    app.update();
    viewer_sees(&mut app);
    let both = app.world().resource::<Wanted>().in_sight.clone();
    assert!(alone.iter().all(|cell| both.contains(cell)) && both.len() > alone.len(), "the union of what both see");
    // Doors open in the frame after.
    app.update();
    for viewer in [first, second] {
        let cell = app.world().get::<CurrentCell>(viewer).and_then(|current| current.0).expect("in a cell");
        assert!(app.world().resource::<OpenCells>().lead(u32::MAX, cell), "both may walk");
    }
    let cap = 40 << 20;
    assert!(in_memory(&app) > cap, "both see more than that");
    app.world_mut().resource_mut::<StreamingSettings>().memory_cap_bytes = cap;
    for _ in 0..60 {
        app.update();
    }
    assert!(in_memory(&app) <= cap);
    app.world_mut().despawn(second);
    for _ in 0..200 {
        app.update();
    }
    assert_eq!(app.world().resource::<Wanted>().in_sight, alone, "what only the other saw is no longer wanted");
}

#[test]
fn however_many_towers_a_city_has_only_so_many_are_wanted() {
    let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
    let tall: Vec<u32> = index.cells().map(|(cell, _)| cell).filter(|&cell| index.is_skyline(cell)).collect();
    for most in [0, 20, 48] {
        let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
        app.world_mut().resource_mut::<StreamingSettings>().skyline_cells = most;
        let viewer = stand(&mut app);
        (0..40).for_each(|_| app.update());
        let eye = app.world().get::<Eye>(viewer).expect("spawned");
        let looks = |cell: &u32| {
            let entry = index.cell(*cell).expect("told");
            let (low, high) = (entry.bounds.0.to_metres(), entry.bounds.1.to_metres());
            (veduta_city::metres(entry.top) - eye.ground_m) / eye.plan_pos.distance(eye.plan_pos.clamp(low, high)).max(1.0)
        };
        let mut tall = tall.clone();
        tall.sort_by(|a, b| looks(b).total_cmp(&looks(a)).then(a.cmp(b)));
        let (first, rest) = tall.split_at(tall.len().min(most as usize));
        let wanted = app.world().resource::<Wanted>();
        assert!(first.iter().all(|&cell| wanted.why(cell).is_some()), "{most}: {first:?}");
        assert!(!rest.iter().any(|&cell| wanted.why(cell) == Some(Why::Skyline)), "{most}: {rest:?}");
        let only = first.iter().filter(|&&cell| wanted.why(cell) == Some(Why::Skyline)).count();
        assert_eq!((only > 0, rest.is_empty()), (most > 0, most == 48), "{most}: {only} of {}", tall.len());
    }
}

#[test]
fn what_is_seen_far_away_along_the_ground_is_there_as_a_district() {
    let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
    let middle = |cell: u32| index.cell(cell).expect("told").outline.centroid();
    let is_within = |cell: &u32| index.locate(veduta_city::GridPos::from_metres(middle(*cell))) == Some(*cell);
    let about = |cell: u32| Around::coarsely(middle(cell), 1.0).middle;
    let is_tall = |vista: u32, cell: u32| {
        let RegionEntry { top, bounds, .. } = index.regions[vista as usize];
        veduta_city::metres(top) > bounds::distance_m(bounds, about(cell)) * StreamingSettings::TALL
    };
    let (number, region) = index.regions_here().find(|(_, region)| !region.vistas.is_empty()).expect("a river to look along");
    let cell = index.regions[number as usize].numbers().find(is_within).expect("a round cell");
    let after = |nearest: usize, tall: usize| {
        let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
        let mut settings = app.world_mut().resource_mut::<StreamingSettings>();
        (settings.overview_m, settings.vistas, settings.tall_vistas) = (1.0, nearest, tall);
        let viewer = stand(&mut app);
        app.world_mut().get_mut::<Eye>(viewer).expect("spawned").plan_pos = middle(cell);
        update_until(&mut app, 200, "the viewer is there", |world| {
            world.get::<CurrentCell>(viewer).is_some_and(|at| at.0 == Some(cell))
        });
        (0..60).for_each(|_| app.update());
        let wanted = app.world().resource::<Wanted>().overviews.clone();
        let mut meshes = app.world_mut().query::<&CellMesh>();
        let afar = meshes.iter(app.world()).filter(|mesh| mesh.kind == CellMeshKind::District).map(|mesh| mesh.cell);
        let shown: BTreeSet<u32> = afar.filter_map(|cell| index.region_of(cell)).collect();
        (wanted, shown)
    };
    let ((with, shown), (without, _), (tall, _)) = (after(48, 0), after(0, 0), after(0, 48));
    assert!(region.vistas.iter().all(|vista| with.contains(vista) && shown.contains(vista)), "{with:?} {shown:?}");
    assert!(region.vistas.iter().any(|vista| !without.contains(vista)), "{without:?}");
    assert_eq!(with.first(), without.first(), "what is near comes first");
    // Of what is not near, what rises by a metre in sixteen or more comes however many are nearer.
    for &vista in region.vistas.iter().filter(|vista| !without.contains(vista)) {
        assert_eq!(tall.contains(&vista), is_tall(vista, cell), "region {vista}: {tall:?}");
    }
}

#[test]
fn what_looks_tall_is_found_anew_when_the_ground_comes() {
    let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
    let (number, region) = index.regions_here().find(|(_, region)| !region.vistas.is_empty()).expect("a river to look along");
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
    let mut settings = app.world_mut().resource_mut::<StreamingSettings>();
    (settings.overview_m, settings.vistas) = (1.0, 0);
    let viewer = stand(&mut app);
    let cell = index.regions[number as usize].numbers().start;
    let plan_pos = inner_point(&index.cell(cell).expect("told").outline);
    app.world_mut().entity_mut(viewer).insert(Footing::Own);
    let mut at = |ground_m: f64| {
        let mut eye = app.world_mut().get_mut::<Eye>(viewer).expect("spawned");
        (eye.plan_pos, eye.ground_m) = (plan_pos, ground_m);
        (0..20).for_each(|_| app.update());
        app.world().resource::<City>().overviews.vistas().to_vec()
    };
    let (low, high, again) = (at(0.0), at(300.0), at(0.0));
    assert!(low.iter().all(|vista| region.vistas.contains(vista)) && !low.is_empty(), "{low:?} of {:?}", region.vistas);
    assert_eq!((high, again), (Vec::new(), low), "from a balloon nothing rises");
}

#[test]
fn of_what_is_seen_from_afar_no_more_comes_than_takes_half_of_the_cap() {
    let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
    let (number, _) = index.regions_here().find(|(_, region)| !region.vistas.is_empty()).expect("a river to look along");
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
    app.world_mut().resource_mut::<StreamingSettings>().overview_m = 1.0;
    app.world_mut().resource_mut::<BuildSettings>().districts_m = 1.0;
    let viewer = stand(&mut app);
    let cell = index.regions[number as usize].numbers().start;
    app.world_mut().get_mut::<Eye>(viewer).expect("spawned").plan_pos = inner_point(&index.cell(cell).expect("told").outline);
    (0..60).for_each(|_| app.update());
    let all = (app.world().resource::<City>().overviews.vistas().len(), app.world().resource::<DistrictMemory>().bytes);
    app.world_mut().resource_mut::<StreamingSettings>().memory_cap_bytes = all.1;
    (0..60).for_each(|_| app.update());
    let some = (app.world().resource::<City>().overviews.vistas().len(), app.world().resource::<DistrictMemory>().bytes);
    assert!(some.0 < all.0 && some.1 < all.1, "{some:?} of {all:?}");
    assert!(in_memory(&app) <= all.1, "{} bytes of {}", in_memory(&app), all.1);
}

#[test]
fn who_flies_sees_every_cell_near_by_as_itself_and_the_others_from_afar() {
    let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
    let viewer = stand(&mut app);
    app.world_mut().get_mut::<Eye>(viewer).expect("a viewer").eye_m = 60.0;
    update_until(&mut app, 2_000, "all that is wanted from aloft is here", |world| {
        let (wanted, standing) = (world.resource::<Wanted>(), world.resource::<StandingCells>());
        let overviews = &world.resource::<City>().overviews;
        wanted.order.iter().any(|&(cell, _)| wanted.why(cell) == Some(Why::Near))
            && wanted.in_sight.iter().all(|&cell| standing.levels(cell).has(Level::One))
            && wanted.overviews.iter().all(|&part| overviews.get(part).is_some())
    });
    update_until(&mut app, 200, "what the cells near the start were wanted for is past", |world| {
        let wanted = world.resource::<Wanted>();
        world.resource::<StandingCells>().iter().all(|(cell, ..)| wanted.wants(cell))
    });
    let mut query = app.world_mut().query::<(&CellMesh, &Visibility)>();
    let districts = query.iter(app.world()).filter(|(mesh, _)| mesh.kind == CellMeshKind::District);
    let afar: BTreeSet<u32> = districts.filter(|(_, shown)| **shown == Visibility::Visible).map(|(mesh, _)| mesh.cell).collect();
    let near: BTreeSet<u32> = app.world().resource::<StandingCells>().iter().map(|(cell, ..)| cell).collect();
    assert_eq!(afar.intersection(&near).next(), None, "nothing is shown twice");
    assert!(near.len() > 30 && afar.len() > 60, "{} stand, {} are seen from afar", near.len(), afar.len());
    assert!((0..index.cell_count()).all(|cell| near.contains(&cell) || afar.contains(&cell)), "and nothing is missing");
}

#[test]
fn over_a_slow_line_finer_levels_are_asked_for_bit_by_bit() {
    let order_of = |world: &World| world.resource::<Wanted>().order.clone();
    let finer = |world: &World| {
        let standing = world.resource::<StandingCells>();
        let order = order_of(world).into_iter();
        order.filter(|&(cell, level)| level > Level::One && !standing.levels(cell).has(level)).collect::<Vec<_>>()
    };
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(200));
    stand(&mut app);
    let pace = app.world().resource::<Pace>().bytes_s().expect("of five frames a second, one passes between asking and taking");
    assert!(pace > 20_000.0, "{pace} B a second");
    let all = order_of(app.world()).iter().filter(|(_, level)| *level > Level::One).count();
    assert!(all > 8, "{all} finer levels are wanted at once");

    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
    app.insert_resource(Link { bytes_s: 300.0, ..Link::default() });
    app.world_mut().resource_mut::<StreamingSettings>().finer_within_s = 0.01;
    stand(&mut app);
    let pace = app.world().resource::<Pace>().bytes_s().expect("one has waited long");
    assert!((200.0..400.0).contains(&pace), "{pace} B a second");
    assert_eq!(finer(app.world()).len(), 1, "one comes after the other, of {all}");
    update_until(&mut app, 4_000, "who stands still gets all of them in the end", |world| {
        let standing = world.resource::<StandingCells>();
        let finer = |(_, levels, _)| [Level::Two, Level::Three].into_iter().filter(|&level| Levels::has(levels, level)).count();
        standing.iter().map(finer).sum::<usize>() >= all
    });
}

#[test]
fn a_level_that_comes_when_the_one_before_it_has_gone_waits_its_turn() {
    let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
    let painted = (0..index.cell_count()).find(|&cell| index.cell(cell).is_some_and(|entry| entry.packet(Level::Three).is_some()));
    let painted = painted.expect("a front of the sample city is painted");
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
    app.insert_resource(Link { latency_s: 2.0, ..Link::default() });
    let near = *app.world().resource::<StreamingSettings>();
    app.world_mut().resource_mut::<StreamingSettings>().keep_s = 0.3;
    let at = inner_point(&index.cell(painted).expect("told").outline);
    app.world_mut().spawn((Viewer, Eye { plan_pos: at, ..Eye::default() }, Transform::default()));
    let is_asked = |world: &mut World, asked: Level| {
        let packet = What::Packet { cell: painted, level: asked };
        world.resource::<Journal>().entries().any(|entry| matches!(entry.event, Event::Asked { what, .. } if what == packet))
    };
    update_until(&mut app, 4_000, "level 3 is on its way", |world| is_asked(world, Level::Three));
    let levels = |world: &World| replay(world.resource::<Journal>().entries()).remove(&painted).unwrap_or_default();
    assert_eq!(levels(app.world()), [Level::One, Level::Two]);
    // Nobody wants finer levels for as long as it takes that level 2 goes and level 3 comes.
    let mut settings = app.world_mut().resource_mut::<StreamingSettings>();
    (settings.level_2_m, settings.level_3_m) = (-1.0, -1.0);
    (0..10).for_each(|_| app.update());
    assert_eq!(levels(app.world()), [Level::One], "level 2 has gone");
    for _ in 0..30 {
        app.update();
        assert_eq!(levels(app.world()), [Level::One], "level 3 stays away without it");
    }
    *app.world_mut().resource_mut::<StreamingSettings>() = near;
    let all = [Level::One, Level::Two, Level::Three];
    update_until(&mut app, 400, "all are here again, in order", |world| levels(world) == all);
}

#[test]
fn what_a_leap_leaves_behind_goes_a_few_cells_a_frame() {
    let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
    let viewer = stand(&mut app);
    app.world_mut().resource_mut::<StreamingSettings>().keep_s = 0.5;
    let before: BTreeSet<u32> = app.world().resource::<StandingCells>().iter().map(|(cell, ..)| cell).collect();
    let start = app.world().get::<Eye>(viewer).expect("a viewer").plan_pos;
    let places = (0..index.cell_count()).filter_map(|cell| Some(inner_point(&index.cell(cell)?.outline)));
    let far = places.max_by(|a, b| a.distance(start).total_cmp(&b.distance(start))).expect("the city has cells");
    app.world_mut().get_mut::<Eye>(viewer).expect("a viewer").plan_pos = far;
    let mut released = Vec::new();
    for _ in 0..200 {
        let noted = app.world().resource::<Journal>().noted();
        app.update();
        let journal = app.world().resource::<Journal>();
        let new = journal.entries().rev().take((journal.noted() - noted) as usize);
        released.push(new.filter(|entry| matches!(entry.event, Event::Released { why: Reason::Idle, .. })).count());
    }
    let most = released.iter().max().copied().unwrap_or(0);
    assert!((1..=4).contains(&most), "{released:?}");
    let wanted = app.world().resource::<Wanted>();
    let gone = before.iter().filter(|&&cell| !wanted.wants(cell)).count();
    assert!(gone > 20, "{gone} of {} are left behind", before.len());
    let stays = app.world().resource::<StandingCells>().iter().filter(|&(cell, ..)| !wanted.wants(cell)).count();
    assert_eq!(stays, 0, "all of them go in the end");
}

#[test]
fn the_memory_cap_holds() {
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
    let cap = 32 << 20;
    app.world_mut().resource_mut::<StreamingSettings>().memory_cap_bytes = cap;
    update_until(&mut app, 2_000, "the city is open", |world| world.contains_resource::<City>());
    let start = app.world().resource::<City>().start;
    let viewer = app.world_mut().spawn((Viewer, Eye::at(start), Transform::default())).id();
    let mut most = 0;
    for i in 0..120 {
        app.world_mut().get_mut::<Eye>(viewer).expect("spawned").plan_pos.x += f64::from(i % 7);
        app.update();
        let loaded = in_memory(&app);
        assert!(loaded <= cap, "{loaded} bytes are loaded of {cap} allowed");
        most = most.max(loaded);
    }
    assert!(most > cap / 2, "what fits under the cap stands: {most} bytes");
    let (standing, eye) = (app.world().resource::<StandingCells>(), app.world().get::<Eye>(viewer).expect("spawned").plan_pos);
    let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
    let away_m = |cell: &u32| bounds::distance_m(index.cell(*cell).expect("told").bounds, eye);
    let wanted = app.world().resource::<Wanted>();
    let mean_m = |cells: &[u32]| cells.iter().map(away_m).sum::<f64>() / cells.len() as f64;
    let standing: Vec<u32> = standing.iter().map(|(cell, ..)| cell).collect();
    let left_out: Vec<u32> = wanted.in_sight.iter().copied().filter(|&cell| !wanted.wants(cell)).collect();
    // Small ones may fit behind a large one that did not.
    let (away, here) = (mean_m(&left_out), mean_m(&standing));
    assert!(away > 1.5 * here, "the farthest stay away: {left_out:?}, {away} m, of {standing:?}, {here} m");
}

#[test]
fn a_missing_and_a_damaged_packet_are_told_and_the_walk_goes_on() {
    let city = copy_of_the_sample("damage");
    let index = read_index(&DirReader::new(&city).expect("a city")).expect("a whole index");
    let start = index.locate(veduta_city::GridPos::from_metres(index.start.pos)).expect("the start lies in a cell");
    let visible = &index.cell(start).expect("told").visible;
    let seen: Vec<u32> = visible.iter().copied().filter(|&cell| cell != start).take(2).collect();
    let path = |cell: u32| {
        let packet = index.cell(cell).and_then(|entry| entry.packets[0]);
        city.join(packet.expect("every cell has a level 1").path())
    };
    std::fs::remove_file(path(seen[0])).expect("it was there");
    let mut bytes = std::fs::read(path(seen[1])).expect("it is there");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x20;
    std::fs::write(path(seen[1]), bytes).expect("our own copy");

    let mut app = quiet_app(&city.display().to_string(), Fetching::Inline, Duration::from_millis(50));
    update_until(&mut app, 2_000, "the city is open", |world| world.contains_resource::<City>());
    let at = app.world().resource::<City>().start;
    app.world_mut().spawn((Viewer, Eye::at(at), Transform::default()));
    let mut told = Vec::new();
    for _ in 0..120 {
        app.update();
        told.extend(failures(&app));
    }
    for cell in &seen {
        assert!(told.iter().any(|m| m.contains(&format!("cell {cell},"))), "nothing is said of cell {cell}: {told:?}");
    }
    let standing = app.world().resource::<StandingCells>();
    let wanted = app.world().resource::<Wanted>();
    let holes: Vec<u32> = wanted.in_sight.iter().copied().filter(|&c| standing.levels(c).finest().is_none()).collect();
    let mut expected = seen.clone();
    expected.sort_unstable();
    let mut holes = holes;
    holes.sort_unstable();
    assert_eq!(holes, expected, "all but the damaged cells stand");
}

#[test]
fn a_server_that_dies_and_returns_is_survived() {
    let server = Server::of(sample_city());
    let mut app = quiet_app(&server.address, Fetching::Threads(2), Duration::from_millis(100));
    let viewer = stand(&mut app);
    let before = app.world().resource::<StandingCells>().len();
    server.dead.store(true, Ordering::SeqCst);
    app.world_mut().get_mut::<Eye>(viewer).expect("spawned").plan_pos = DVec2::new(300.0, -27.0);
    let mut told = Vec::new();
    update_until(&mut app, 8_000, "a failure is told", |world| {
        told.extend(world.resource::<Messages<CityFailed>>().iter_current_update_messages().map(|f| f.will_retry));
        !told.is_empty()
    });
    assert!(told.iter().all(|retry| *retry), "a dead server is tried again");
    assert!(!app.world().resource::<StandingCells>().is_empty() && before > 0, "what was there stays for a while");
    server.dead.store(false, Ordering::SeqCst);
    viewer_sees(&mut app);
}

#[test]
fn a_city_that_is_not_there_is_a_message_with_the_fix() {
    let mut app = quiet_app("/no/such/place.city", Fetching::Inline, Duration::from_millis(10));
    let mut cursor = app.world().resource::<Messages<CityFailed>>().get_cursor();
    let mut told = Vec::new();
    for _ in 0..5 {
        app.update();
        told.extend(cursor.read(app.world().resource::<Messages<CityFailed>>()).map(|f| f.message.clone()));
    }
    assert_eq!(told.len(), 1, "told once: {told:?}");
    assert!(told[0].contains("/no/such/place.city"), "{told:?}");
}

#[test]
fn whoever_runs_is_read_ahead_of_farther_than_the_next_cell() {
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(100));
    update_until(&mut app, 500, "the city is open", |world| world.contains_resource::<City>());
    let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
    let from = app.world().resource::<City>().start.pos;
    // Across the square, to where most cells lie in a row.
    let row = |way: &DVec2| {
        let cells = (0..100).map(|m| index.locate(GridPos::from_metres(from + *way * f64::from(m))));
        cells.collect::<Option<BTreeSet<u32>>>().map_or(0, |cells| cells.len())
    };
    let ways = (0..72).map(|n| DVec2::from_angle(f64::from(n) * core::f64::consts::TAU / 72.0));
    let way = ways.max_by_key(row).expect("there are some");
    let viewer = app.world_mut().spawn((Viewer, Eye { plan_pos: from, ..Eye::default() }, Transform::default())).id();
    (0..30).for_each(|_| app.update());
    let ahead = |app: &App| app.world().get::<Motion>(viewer).expect("measured").ahead.clone();
    assert_eq!(ahead(&app), [], "he stands");
    let (mut farthest, mut read_ahead) = (0, 0);
    for step in 1..=100 {
        app.world_mut().get_mut::<Eye>(viewer).expect("spawned").plan_pos = from + way * 0.6 * f64::from(step);
        app.update();
        let ahead = ahead(&app);
        farthest = farthest.max(ahead.len());
        let here = app.world().get::<CurrentCell>(viewer).and_then(|current| current.0).expect("in a street");
        let next: BTreeSet<u32> = index.portals(here).filter_map(|portal| portal.other(here)).chain([here]).collect();
        let seen = |cell: &u32| index.cell(*cell).into_iter().flat_map(|entry| entry.visible.iter().copied());
        let by_turn: BTreeSet<u32> = next.iter().flat_map(seen).collect();
        let wanted = app.world().resource::<Wanted>();
        for (cell, way_m) in ahead {
            assert!(way_m <= 6.1 * Motion::AHEAD_S, "{way_m} m");
            for seen in seen(&cell) {
                assert!(wanted.wants_level(seen, Level::One), "cell {seen} is seen from {cell}, {way_m} m ahead of {here}");
                read_ahead += usize::from(!by_turn.contains(&seen));
            }
        }
    }
    assert!(farthest >= 2, "{farthest} cells ahead of a run along {way}");
    assert!(read_ahead > 0, "nothing was read that the neighbours do not see");
    (0..50).for_each(|_| app.update());
    assert_eq!(ahead(&app), [], "he stands again");
}
