use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::*;
use veduta_ecs::{Awaited, VedutaSystems};

use crate::{Pace, StreamingStats};

/// Tells figures of streaming among Bevy's diagnostics, once a frame: add Bevy's `LogDiagnosticsPlugin` to read them on the console.
#[derive(Debug, Clone, Copy, Default)]
pub struct StreamingDiagnosticsPlugin;

impl StreamingDiagnosticsPlugin {
    /// Cells that are loaded.
    pub const CELLS: DiagnosticPath = DiagnosticPath::const_new("streaming/cells");
    /// Cells in sight, or about to be, that do not stand yet ([`Awaited`]): 0 where nothing is missing.
    pub const AWAITED: DiagnosticPath = DiagnosticPath::const_new("streaming/awaited");
    /// Requests under way.
    pub const IN_FLIGHT: DiagnosticPath = DiagnosticPath::const_new("streaming/in_flight");
    /// Requests that have failed since the city was opened.
    pub const FAILURES: DiagnosticPath = DiagnosticPath::const_new("streaming/failures");
    /// Memory of what is loaded and made of it, MiB.
    pub const MEMORY: DiagnosticPath = DiagnosticPath::const_new("streaming/memory");
    /// All that has come since the city was opened, kB.
    pub const RECEIVED: DiagnosticPath = DiagnosticPath::const_new("streaming/received");
    /// The [`Pace`] of the line, kB a second, once it can be told.
    pub const PACE: DiagnosticPath = DiagnosticPath::const_new("streaming/pace");
}

impl Plugin for StreamingDiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        let units = [
            (Self::CELLS, ""),
            (Self::AWAITED, ""),
            (Self::IN_FLIGHT, ""),
            (Self::FAILURES, ""),
            (Self::MEMORY, " MiB"),
            (Self::RECEIVED, " kB"),
            (Self::PACE, " kB/s"),
        ];
        for (path, unit) in units {
            app.register_diagnostic(Diagnostic::new(path).with_suffix(unit));
        }
        app.add_systems(Update, measure.after(VedutaSystems::Stream).run_if(resource_exists::<StreamingStats>));
    }

    fn finish(&self, app: &mut App) {
        if !app.world().contains_resource::<StreamingStats>() {
            warn!("nothing streams, so there are no figures of it: add StreamingPlugin");
        }
    }
}

fn measure(mut diagnostics: Diagnostics<'_, '_>, stats: Res<StreamingStats>, awaited: Res<Awaited>, pace: Res<Pace>) {
    use StreamingDiagnosticsPlugin as Of;
    diagnostics.add_measurement(&Of::CELLS, || stats.cells as f64);
    diagnostics.add_measurement(&Of::AWAITED, || (awaited.cells + awaited.ahead) as f64);
    diagnostics.add_measurement(&Of::IN_FLIGHT, || stats.in_flight as f64);
    diagnostics.add_measurement(&Of::FAILURES, || stats.failures as f64);
    diagnostics.add_measurement(&Of::MEMORY, || stats.bytes_in_memory as f64 / f64::from(1 << 20));
    diagnostics.add_measurement(&Of::RECEIVED, || stats.bytes_all as f64 / 1e3);
    if let Some(bytes_s) = pace.bytes_s() {
        diagnostics.add_measurement(&Of::PACE, || bytes_s / 1e3);
    }
}
