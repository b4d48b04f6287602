use bevy::prelude::*;
use veduta_city::LifeKind;

/// What lives, how far off it is shown, and what it may cost. Live.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct LifeSettings {
    /// Which kinds live.
    pub kinds: LifeKinds,
    /// Distances are taken times this: 1 shows a flag as far as it can be told from a stroke.
    pub reach: f32,
    /// Most pigeons about the viewers.
    pub most_pigeons: u32,
    /// Most drops of water in one fountain, beside its threads; 0 for threads alone.
    pub most_drops: u32,
    /// Most chimneys that smoke, at most 192.
    pub most_fires: u32,
    /// Most vertices that all that lives may draw in a frame; what is farthest off is left out first.
    pub most_vertices: u32,
    /// Whether light falls plainly, without shadows or gloss, as on the rest of a city drawn by a processor.
    pub plain_light: bool,
}

/// Kinds of living things.
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq)]
pub struct LifeKinds {
    /// Water in fountains.
    pub fountains: bool,
    /// Flags.
    pub flags: bool,
    /// Smoke over chimneys.
    pub smoke: bool,
    /// Pigeons.
    pub pigeons: bool,
    /// Signs that swing.
    pub signs: bool,
    /// Clocks, and the figures that pass when they strike.
    pub clocks: bool,
    /// Bells.
    pub bells: bool,
}

impl LifeKinds {
    /// All of them.
    pub const ALL: Self = Self { fountains: true, flags: true, smoke: true, pigeons: true, signs: true, clocks: true, bells: true };
    /// None.
    pub const NONE: Self =
        Self { fountains: false, flags: false, smoke: false, pigeons: false, signs: false, clocks: false, bells: false };

    /// Whether a kind lives.
    #[must_use]
    pub const fn has(&self, kind: &LifeKind) -> bool {
        match kind {
            LifeKind::Fountain { .. } => self.fountains,
            LifeKind::Flag { .. } => self.flags,
            LifeKind::Smoke { .. } => self.smoke,
            LifeKind::Flock { .. } => self.pigeons,
            LifeKind::Sign { .. } => self.signs,
            LifeKind::Clock { .. } | LifeKind::Figures { .. } => self.clocks,
            LifeKind::Bell { .. } => self.bells,
        }
    }
}

impl Default for LifeSettings {
    fn default() -> Self {
        Self {
            kinds: LifeKinds::ALL,
            reach: 1.0,
            most_pigeons: 90,
            most_drops: 220,
            most_fires: 28,
            most_vertices: 60_000,
            plain_light: false,
        }
    }
}

impl LifeSettings {
    /// How far off a kind is shown, metres.
    #[must_use]
    pub fn reach_m(&self, kind: &LifeKind) -> f64 {
        let base = match kind {
            LifeKind::Fountain { radius_m, .. } => 70.0 + 20.0 * radius_m,
            LifeKind::Flag { size_m, .. } => 110.0 + 60.0 * size_m.1,
            LifeKind::Smoke { .. } => 340.0,
            LifeKind::Flock { radius_m, .. } => 95.0 + radius_m,
            LifeKind::Sign { .. } => 70.0,
            LifeKind::Clock { radius_m, .. } => 60.0 + 110.0 * radius_m,
            LifeKind::Figures { .. } => 60.0,
            LifeKind::Bell { .. } => 1_500.0,
        };
        base * f64::from(self.reach.clamp(0.0, 10.0))
    }
}
