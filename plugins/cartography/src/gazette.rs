//! The index of a map: what has a name, and in which field of the map's grid it lies.

use glam::DVec2;

use crate::Area;

/// A grid over a map: letters from left to right, numbers from the top down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fields {
    map: Area,
    /// How many fields there are across and down.
    pub count: (u32, u32),
}

/// Most fields across: one for each letter.
const MOST: f64 = 26.0;

impl Fields {
    /// Fields about so large, millimetres.
    #[must_use]
    pub fn new(map: Area, about_mm: f64) -> Self {
        let count = (map.size() / about_mm).map(|n| libm::round(n).clamp(1.0, MOST));
        Self { map, count: (count.x as u32, count.y as u32) }
    }

    /// Size of a field.
    #[must_use]
    pub fn size(&self) -> DVec2 {
        self.map.size() / DVec2::new(f64::from(self.count.0), f64::from(self.count.1))
    }

    /// Letter of a column, from 0.
    #[must_use]
    pub fn letter(column: u32) -> char {
        char::from(b'A' + column.min(25) as u8)
    }

    /// The field that a place of the drawing lies in, as in `C4`; `None` beyond the map.
    #[must_use]
    pub fn of(&self, at: DVec2) -> Option<String> {
        if !self.map.contains(at) {
            return None;
        }
        let field = ((at - self.map.min) / self.size()).map(libm::floor);
        let (column, row) = ((field.x as u32).min(self.count.0 - 1), (field.y as u32).min(self.count.1 - 1));
        Some(format!("{}{}", Self::letter(column), row + 1))
    }
}

/// A line of the index.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// Name.
    pub name: String,
    /// Its field.
    pub field: String,
}

/// Entries sorted by a key, each name in each field once.
#[must_use]
pub fn index(mut entries: Vec<Entry>, key: &dyn Fn(&str) -> String) -> Vec<Entry> {
    entries.sort_by_cached_key(|entry| (key(&entry.name), entry.name.clone(), entry.field.clone()));
    entries.dedup();
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_lettered_across_and_numbered_down() {
        let fields = Fields::new(Area::new(DVec2::new(10.0, 20.0), DVec2::new(300.0, 200.0)), 52.0);
        assert_eq!(fields.count, (6, 4));
        let at = |x, y| fields.of(DVec2::new(x, y));
        assert_eq!(at(10.0, 20.0).as_deref(), Some("A1"));
        assert_eq!(at(310.0, 220.0).as_deref(), Some("F4"));
        assert_eq!(at(125.0, 175.0).as_deref(), Some("C4"));
        assert_eq!(at(9.0, 30.0), None);
    }

    #[test]
    fn names_are_sorted_by_their_key_and_told_once_a_field() {
        let entry = |name: &str, field: &str| Entry { name: name.into(), field: field.into() };
        let all = vec![entry("Žatecká", "A1"), entry("Celetná", "C4"), entry("Čapkova", "B2"), entry("Celetná", "C4")];
        let plain = |name: &str| name.to_lowercase().replace('č', "c").replace('ž', "z");
        let names: Vec<String> = index(all, &plain).into_iter().map(|entry| entry.name).collect();
        assert_eq!(names, ["Čapkova", "Celetná", "Žatecká"]);
    }
}
