//! What is seen in a room and belongs to another cell: at its border walls that face two cells and roofs of houses on corners, within it
//! the crowns of trees that stand beyond its border, and bridges.

use rayon::prelude::*;
use veduta_city::{Cells, CityPlan, GridPos, PlanObject, metres};

use crate::assign::segments;
use crate::locate::Locator;
use crate::overlay::edges;
use crate::rooms::{Edges, Room};

/// A line in plan at which something is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Guest {
    /// Its ends as seen by who looks at it.
    pub(crate) left: GridPos,
    pub(crate) right: GridPos,
    /// The other cell that what is seen there belongs to.
    pub(crate) owner: u32,
}

/// What is seen in each room and belongs to another cell than the room: that of one room side by side, and there that of one owner.
pub(crate) struct Guests {
    all: Vec<Guest>,
    /// The first of each room and owner, and the end.
    groups: Vec<u32>,
    /// The first group of each room, and the end.
    first: Vec<u32>,
}

impl Guests {
    pub(crate) fn new(plan: &CityPlan, cells: &Cells, rooms: &[Room<'_>]) -> Self {
        let (walls, within) = rayon::join(|| walls(plan, cells), || within(plan, cells));
        let at_border = |room: &Room<'_>| {
            let at_edge = |(right, left)| {
                let mut owners: Vec<u32> =
                    walls.along(right, left).flat_map(|wall| wall.0).filter(|&owner| owner != room.owner).collect();
                owners.sort_unstable();
                owners.dedup();
                owners.into_iter().map(move |owner| Guest { left, right, owner })
            };
            room.outline.rings().flat_map(|ring| edges(ring)).flat_map(at_edge).collect()
        };
        let of_rooms: Vec<Vec<Guest>> = rooms.par_iter().map(at_border).collect();
        let mut within = within.into_iter();
        let mut guests = Self { all: Vec::new(), groups: vec![0], first: vec![0] };
        for mut of_room in of_rooms {
            of_room.extend(within.next().into_iter().flatten());
            guests.add_room(of_room);
        }
        guests
    }

    /// Adds those of the next room, by owners in the order in which they come first.
    fn add_room(&mut self, mut of_room: Vec<Guest>) {
        let mut owners: Vec<u32> = Vec::new();
        for guest in &of_room {
            if !owners.contains(&guest.owner) {
                owners.push(guest.owner);
            }
        }
        of_room.sort_by_key(|guest| owners.iter().position(|owner| *owner == guest.owner));
        for group in of_room.chunk_by(|a, b| a.owner == b.owner) {
            self.all.extend(group);
            self.groups.push(self.all.len() as u32);
        }
        self.first.push(self.groups.len() as u32 - 1);
    }

    /// Numbers of the groups in a room.
    pub(crate) fn of(&self, room: u32) -> core::ops::Range<u32> {
        self.first[room as usize]..self.first[room as usize + 1]
    }

    /// Those in a room.
    pub(crate) fn within(&self, room: u32) -> &[Guest] {
        let of_room = self.of(room);
        &self.all[self.groups[of_room.start as usize] as usize..self.groups[of_room.end as usize] as usize]
    }

    /// Those of a group, which are never none.
    pub(crate) fn group(&self, group: u32) -> &[Guest] {
        &self.all[self.groups[group as usize] as usize..self.groups[group as usize + 1] as usize]
    }

    /// How many groups there are.
    pub(crate) const fn count(&self) -> usize {
        self.groups.len() - 1
    }
}

/// Objects and spans of each cell that reach into another one, by that.
fn within(plan: &CityPlan, cells: &Cells) -> Vec<Vec<Guest>> {
    let locator = Locator::new(&cells.cells);
    let mut guests = vec![Vec::new(); cells.cells.len()];
    // Who looks across a quadrilateral looks across one of its diagonals, from one side or the other.
    let mut add = |corners: [GridPos; 4], owner: u32| {
        let [a, b, c, d] = corners;
        let middle = GridPos(a.0 / 2 + c.0 / 2, a.1 / 2 + c.1 / 2);
        let places = [a, b, c, d, middle];
        let mut hosts: Vec<u32> = places.iter().filter_map(|&p| locator.find(p)).filter(|&host| host != owner).collect();
        hosts.sort_unstable();
        hosts.dedup();
        for host in hosts {
            let lines = [(a, c), (c, a), (b, d), (d, b)];
            guests[host as usize].extend(lines.map(|(left, right)| Guest { left, right, owner }));
        }
    };
    for (cell, owner) in cells.cells.iter().zip(0..) {
        for object in cell.objects.iter().filter_map(|&o| plan.objects.get(o as usize)) {
            let reach = GridPos::steps(reach_m(object));
            let corner =
                |(x, y): (i32, i32)| GridPos(object.pos.0.saturating_add(x * reach), object.pos.1.saturating_add(y * reach));
            add([(-1, -1), (1, -1), (1, 1), (-1, 1)].map(corner), owner);
        }
        for span in cell.spans.iter().filter_map(|&s| plan.spans.get(s as usize)) {
            for pair in span.stations.windows(2) {
                add([pair[0].left, pair[0].right, pair[1].right, pair[1].left], owner);
            }
        }
    }
    guests
}

/// How far an object may reach about its place, metres.
fn reach_m(object: &PlanObject) -> f64 {
    let height_m = metres(object.height);
    if object.kind.is_tree() { 0.5 * height_m } else { 1.0 + height_m }
}

/// Walls, solid on their left, with the cells of them and of their houses' roofs.
fn walls(plan: &CityPlan, cells: &Cells) -> Edges<[u32; 2]> {
    let mut roofs = vec![None; plan.houses.len()];
    for (cell, number) in cells.cells.iter().zip(0..) {
        for &house in &cell.houses {
            if let Some(roof) = roofs.get_mut(house as usize) {
                *roof = Some(number);
            }
        }
    }
    let mut walls = Vec::new();
    for (cell, number) in cells.cells.iter().zip(0..) {
        for of_volume in cell.walls.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let (house, volume, _) = of_volume[0];
            let Some(whole) = plan.houses.get(house as usize) else { continue };
            let Some(segments) = whole.volumes.get(usize::from(volume)).map(segments) else { continue };
            let owners = [number, roofs[house as usize].unwrap_or(number)];
            walls.extend(of_volume.iter().filter_map(|wall| Some((*segments.get(usize::from(wall.2))?, owners))));
        }
    }
    Edges::new(walls.into_iter())
}

#[cfg(test)]
mod tests {
    use veduta_city::{Cell, GridPolygon, Id, ObjectKind};

    use super::*;
    use crate::rooms::rooms;

    fn at(x: i32, y: i32) -> GridPos {
        GridPos(x * 1024, y * 1024)
    }

    #[test]
    fn a_crown_over_the_border_is_seen_from_beyond_it_and_a_bush_is_not() {
        let square = |x: i32| GridPolygon::simple(vec![at(x, 0), at(x + 20, 0), at(x + 20, 20), at(x, 20)]);
        let owners_before = |kind: ObjectKind, height: i32| {
            let object = PlanObject { id: Id(1), kind, pos: at(24, 10), z: 0, heading: 0, height: height * 1024, monument: None };
            let plan = CityPlan { objects: vec![object], ..CityPlan::default() };
            let cell = |x: i32, objects: Vec<u32>| Cell { outline: square(x), objects, ..Cell::default() };
            let cells = Cells { cells: vec![cell(0, vec![]), cell(20, vec![0])], ..Cells::default() };
            let guests = Guests::new(&plan, &cells, &rooms(&cells));
            assert!(guests.of(1).is_empty(), "nothing is its own guest");
            guests.within(0).iter().map(|guest| guest.owner).collect::<Vec<u32>>()
        };
        assert_eq!(owners_before(ObjectKind::Tree, 12), [1; 4], "a crown is looked at across both diagonals, both ways");
        assert_eq!(owners_before(ObjectKind::Tree, 6), []);
    }

    #[test]
    fn those_of_one_owner_stand_together_in_the_order_of_the_first() {
        let guest = |x: i32, owner: u32| Guest { left: at(x, 0), right: at(x + 1, 0), owner };
        let mut guests = Guests { all: Vec::new(), groups: vec![0], first: vec![0] };
        guests.add_room(vec![guest(0, 7), guest(1, 3), guest(2, 7)]);
        guests.add_room(vec![]);
        guests.add_room(vec![guest(4, 3)]);
        assert_eq!([0, 1, 2].map(|room| guests.of(room)), [0..2, 2..2, 2..3]);
        assert_eq!(guests.group(0), [guest(0, 7), guest(2, 7)]);
        assert_eq!(guests.within(0), [guest(0, 7), guest(2, 7), guest(1, 3)]);
        assert_eq!((guests.within(1), guests.group(2)), (&[][..], &[guest(4, 3)][..]));
        assert_eq!(guests.count(), 3);
    }
}
