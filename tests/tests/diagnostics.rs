//! Figures among Bevy's diagnostics.

use std::time::Duration;

use bevy::diagnostic::{DiagnosticPath, DiagnosticsStore};
use bevy::prelude::*;
use veduta::prelude::*;
use veduta::streaming::{Fetching, StreamingDiagnosticsPlugin as Of, StreamingStats};
use veduta_tests::{quiet_app, sample_city, update_until};

#[test]
fn figures_of_streaming_are_among_the_diagnostics() {
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_millis(33));
    app.add_plugins(Of);
    let read = |app: &App, path: &DiagnosticPath| {
        let diagnostics = app.world().resource::<DiagnosticsStore>();
        diagnostics.get(path).unwrap_or_else(|| panic!("{path} is not there")).value()
    };
    app.update();
    assert_eq!([Of::CELLS, Of::MEMORY, Of::FAILURES].map(|path| read(&app, &path)), [Some(0.0); 3]);
    assert_eq!(read(&app, &Of::PACE), None, "nobody can tell yet");
    update_until(&mut app, 200, "the city is open", |world| world.contains_resource::<City>());
    let start = app.world().resource::<City>().start;
    app.world_mut().spawn((Viewer, Eye::at(start), Transform::default()));
    (0..300).for_each(|_| app.update());
    let stats = *app.world().resource::<StreamingStats>();
    assert!(stats.cells > 10, "{stats:?}");
    let expected = [
        (Of::CELLS, stats.cells as f64),
        (Of::AWAITED, 0.0),
        (Of::IN_FLIGHT, 0.0),
        (Of::FAILURES, 0.0),
        (Of::MEMORY, stats.bytes_in_memory as f64 / 1_048_576.0),
        (Of::RECEIVED, stats.bytes_all as f64 / 1_000.0),
    ];
    for (path, value) in expected {
        assert_eq!(read(&app, &path), Some(value), "{path}");
    }
}
