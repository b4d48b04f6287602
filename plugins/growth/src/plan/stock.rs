//! The stock styles and monuments, as they lie in `assets/styles` and `assets/monuments`.

use veduta_city::{Monument, Monuments, Style, Styles, file};

/// Name and text of every stock style, in the order in which plans number them.
const STOCK: [(&str, &str); 9] = [
    ("old_town.ron", include_str!("../../../../assets/styles/old_town.ron")),
    ("church.ron", include_str!("../../../../assets/styles/church.ron")),
    ("tower.ron", include_str!("../../../../assets/styles/tower.ron")),
    ("clock_tower.ron", include_str!("../../../../assets/styles/clock_tower.ron")),
    ("monument.ron", include_str!("../../../../assets/styles/monument.ron")),
    ("tenement.ron", include_str!("../../../../assets/styles/tenement.ron")),
    ("suburban.ron", include_str!("../../../../assets/styles/suburban.ron")),
    ("modern.ron", include_str!("../../../../assets/styles/modern.ron")),
    ("industrial.ron", include_str!("../../../../assets/styles/industrial.ron")),
];

/// What growth draws from.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stock {
    /// How houses of a kind look.
    pub styles: Styles,
    /// What may stand in a building's place, and what it is put together from.
    pub monuments: Monuments,
}

impl Stock {
    /// The styles and monuments that come with growth.
    #[must_use]
    pub fn new() -> Self {
        Self { styles: styles(), monuments: monuments() }
    }

    /// Adds styles and monuments, or puts them in place of those of the same name.
    #[must_use]
    pub fn with(mut self, styles: Vec<Style>, monuments: Vec<Monument>) -> Self {
        for style in styles {
            match self.styles.find(&style.name) {
                Some(i) => self.styles.0[i] = style,
                None => self.styles.0.push(style),
            }
        }
        for monument in monuments {
            match self.monuments.0.iter_mut().find(|known| known.name == monument.name) {
                Some(known) => *known = monument,
                None => self.monuments.0.push(monument),
            }
        }
        self
    }
}

/// The styles that come with growth: `old_town` (the one for houses that nothing else decides about), `church`, `tower`,
/// `clock_tower`, `monument`, `tenement`, `suburban`, `modern`, `industrial`.
fn styles() -> Styles {
    // Each text is part of the program, and a test reads every one: none is ever left out.
    Styles(STOCK.iter().filter_map(|(name, text)| file::parse(text, name).ok()).collect())
}

/// Name and text of every file of stock monuments.
const MONUMENTS: [(&str, &str); 1] = [("solids.ron", include_str!("../../../../assets/monuments/solids.ron"))];

/// The monuments that come with growth, and the parts that they are put together from: see `assets/monuments`.
fn monuments() -> Monuments {
    // Each text is part of the program, and a test reads every one: none is ever left out.
    Monuments(MONUMENTS.iter().filter_map(|(name, text)| file::parse::<Monuments>(text, name).ok()).flat_map(|m| m.0).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stock_style_and_monument_reads_and_is_sound() {
        for (name, text) in STOCK {
            let style: Style = file::parse(text, name).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(format!("{}.ron", style.name), name);
        }
        assert_eq!(styles().0.len(), STOCK.len());
        assert_eq!(styles().validate(), []);
        assert_eq!(styles().find("old_town"), Some(0));
        for (name, text) in MONUMENTS {
            let monuments: Monuments = file::parse(text, name).unwrap_or_else(|e| panic!("{e}"));
            assert!(!monuments.0.is_empty(), "{name}");
        }
        let wrong: Vec<String> = monuments().validate().iter().map(ToString::to_string).collect();
        assert_eq!(wrong, [""; 0]);
    }
}
