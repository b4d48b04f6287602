//! The stock styles, as they lie in `assets/styles`.

use veduta_city::{Styles, file};

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

/// The styles that come with growth: `old_town` (the one for houses that nothing else decides about), `church`, `tower`,
/// `clock_tower`, `monument`, `tenement`, `suburban`, `modern`, `industrial`.
#[must_use]
pub fn stock_styles() -> Styles {
    // Each text is part of the program, and a test reads every one: none is ever left out.
    Styles(STOCK.iter().filter_map(|(name, text)| file::parse(text, name).ok()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_city::Style;

    #[test]
    fn every_stock_style_reads_and_is_sound() {
        for (name, text) in STOCK {
            let style: Style = file::parse(text, name).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(format!("{}.ron", style.name), name);
        }
        assert_eq!(stock_styles().0.len(), STOCK.len());
        assert_eq!(stock_styles().validate(), []);
        assert_eq!(stock_styles().find("old_town"), Some(0));
    }
}
