use veduta_city::{Cells, CityPlan, FacadeSheet};

/// Content of every cell's level-2 packet: the openings of its walls, in the order in which [`crate::cell_shells`] lists
/// them. Walls that the plan does not have ([`crate::check`] names them) come as blind walls, so that the order holds.
#[must_use]
pub fn facade_sheets(plan: &CityPlan, cells: &Cells) -> Vec<FacadeSheet> {
    let wall = |&(h, v, w): &(u32, u16, u16)| {
        let volume = plan.houses.get(h as usize).and_then(|house| house.volumes.get(usize::from(v)))?;
        Some(volume.walls.get(usize::from(w)).cloned().unwrap_or_default())
    };
    cells.cells.iter().map(|cell| FacadeSheet { walls: cell.walls.iter().filter_map(wall).collect() }).collect()
}
