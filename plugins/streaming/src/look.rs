use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use veduta_city::Level;
use veduta_store::{CityIndex, What};

use crate::deliver::LoadedCells;
use crate::fetch::Store;

/// What streaming knows and has: for whoever shows it.
#[derive(SystemParam)]
pub struct Streamed<'w> {
    store: Option<Res<'w, Store>>,
    loaded: Option<Res<'w, LoadedCells>>,
}

impl Streamed<'_> {
    /// The index of the open city, with those of its regions that have come.
    #[must_use]
    pub fn index(&self) -> Option<&CityIndex> {
        self.store.as_ref()?.client.index()
    }

    /// What is on its way.
    pub fn pending(&self) -> impl Iterator<Item = What> {
        self.store.iter().flat_map(|store| store.client.pending())
    }

    /// The finest level of a cell that is loaded; `None` if there is none.
    #[must_use]
    pub fn level(&self, cell: u32) -> Option<Level> {
        self.loaded.as_ref()?.level(cell)
    }
}
