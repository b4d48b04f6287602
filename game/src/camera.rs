//! The one camera: what the walk sees, films and stills show.

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy::render::view::{ColorGrading, ColorGradingGlobal, ColorGradingSection};

/// Lens, film and grade. AgX keeps bright walls from clipping but greys colours, so some of both is given back.
#[must_use]
pub fn camera() -> impl Bundle {
    let section = ColorGradingSection { contrast: 1.16, ..default() };
    let grade = ColorGrading {
        global: ColorGradingGlobal { post_saturation: 1.2, ..default() },
        shadows: section,
        midtones: section,
        highlights: section,
    };
    (Camera3d::default(), Tonemapping::AgX, grade, lens())
}

/// Near and far planes that hold a façade at arm's length and the sky dome.
fn lens() -> Projection {
    Projection::Perspective(PerspectiveProjection { near: 0.1, far: 6_000.0, ..default() })
}
