//! The stock styles, monuments and furniture rules, as they lie in `assets`.

use veduta_city::{
    Design, FurnitureError, FurnitureRule, Monument, MonumentError, Monuments, PlacedFacade, StyleDraft, StyleError, Styles, file,
    furniture,
};

/// Name and text of every stock style, in the order in which plans number them; each comes after those that it inherits from.
const STOCK: [(&str, &str); 15] = [
    ("old_town.ron", include_str!("../../../../assets/styles/old_town.ron")),
    ("church.ron", include_str!("../../../../assets/styles/church.ron")),
    ("tower.ron", include_str!("../../../../assets/styles/tower.ron")),
    ("clock_tower.ron", include_str!("../../../../assets/styles/clock_tower.ron")),
    ("monument.ron", include_str!("../../../../assets/styles/monument.ron")),
    ("tenement.ron", include_str!("../../../../assets/styles/tenement.ron")),
    ("suburban.ron", include_str!("../../../../assets/styles/suburban.ron")),
    ("modern.ron", include_str!("../../../../assets/styles/modern.ron")),
    ("industrial.ron", include_str!("../../../../assets/styles/industrial.ron")),
    ("medieval.ron", include_str!("../../../../assets/styles/medieval.ron")),
    ("renaissance.ron", include_str!("../../../../assets/styles/renaissance.ron")),
    ("baroque.ron", include_str!("../../../../assets/styles/baroque.ron")),
    ("classicist.ron", include_str!("../../../../assets/styles/classicist.ron")),
    ("art_nouveau.ron", include_str!("../../../../assets/styles/art_nouveau.ron")),
    ("skyscraper.ron", include_str!("../../../../assets/styles/skyscraper.ron")),
];

/// What growth draws from.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stock {
    /// How houses of a kind look.
    pub styles: Styles,
    /// What may stand in a building's place, and what it is put together from.
    pub monuments: Monuments,
    /// What stands in streets and parks where a map says nothing.
    pub furniture: Vec<FurnitureRule>,
    /// Models from files, by their names: they go before monuments.
    pub models: Vec<Design>,
    /// Façades given as pictures, cut, and where they are to go.
    pub facades: Vec<PlacedFacade>,
}

/// What is wrong with styles, monuments or rules that are brought.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StockError {
    /// A style cannot be drawn from.
    #[error(transparent)]
    Style(#[from] StyleError),
    /// A monument cannot be built.
    #[error(transparent)]
    Monument(#[from] MonumentError),
    /// A rule cannot be followed.
    #[error(transparent)]
    Furniture(#[from] FurnitureError),
}

impl Stock {
    /// What comes with growth.
    pub fn new() -> Self {
        Self { styles: styles(), monuments: monuments(), furniture: furniture(), models: Vec::new(), facades: Vec::new() }
    }

    /// Adds styles, monuments and rules, or puts them in place of those of the same name.
    ///
    /// # Errors
    /// Everything that is then wrong with any of them: two of those brought share a name, a style inherits from one that is not
    /// there, a monument cannot be built, a rule puts a monument that is not there.
    pub fn with(
        mut self,
        styles: &[StyleDraft],
        monuments: Vec<Monument>,
        furniture: Vec<FurnitureRule>,
    ) -> Result<Self, Vec<StockError>> {
        let mut errors: Vec<StockError> = Vec::new();
        for (i, draft) in styles.iter().enumerate() {
            if styles[..i].iter().any(|other| other.name == draft.name) {
                errors.push(StyleError::Twice(draft.name.clone()).into());
                continue;
            }
            match (draft.finish(&self.styles), self.styles.find(&draft.name)) {
                (Ok(style), Some(i)) => self.styles.0[i] = style,
                (Ok(style), None) => self.styles.0.push(style),
                (Err(error), _) => errors.push(error.into()),
            }
        }
        errors.extend(self.styles.validate().into_iter().map(StockError::from));
        for (i, monument) in monuments.iter().enumerate() {
            if monuments[..i].iter().any(|other| other.name == monument.name) {
                errors.push(MonumentError::Twice(monument.name.clone()).into());
            }
        }
        // Working all of them out takes a while.
        let is_new = !monuments.is_empty();
        for monument in monuments {
            match self.monuments.0.iter_mut().find(|known| known.name == monument.name) {
                Some(known) => *known = monument,
                None => self.monuments.0.push(monument),
            }
        }
        if is_new {
            errors.extend(self.monuments.validate().into_iter().map(StockError::from));
        }
        errors.extend(furniture::validate(&furniture).into_iter().map(StockError::from));
        for rule in furniture {
            for furnishing in rule.put.iter().filter(|one| !one.monument.is_empty()) {
                if self.monuments.find(&furnishing.monument).is_none() {
                    let (rule, monument) = (rule.name.clone(), furnishing.monument.clone());
                    errors.push(FurnitureError::Monument { rule, monument }.into());
                }
            }
            match self.furniture.iter_mut().find(|known| known.name == rule.name) {
                Some(known) => *known = rule,
                None => self.furniture.push(rule),
            }
        }
        if errors.is_empty() { Ok(self) } else { Err(errors) }
    }
}

/// The styles that come with growth; the first is for houses that nothing else decides about.
fn styles() -> Styles {
    let mut styles = Styles::default();
    // Each text is part of the program, and a test reads every one: none is ever left out.
    for (name, text) in STOCK {
        styles.0.extend(file::parse::<StyleDraft>(text, name).ok().and_then(|draft| draft.finish(&styles).ok()));
    }
    styles
}

/// Name and text of every file of stock monuments.
const MONUMENTS: [(&str, &str); 5] = [
    ("solids.ron", include_str!("../../../../assets/monuments/solids.ron")),
    ("classical.ron", include_str!("../../../../assets/monuments/classical.ron")),
    ("gothic.ron", include_str!("../../../../assets/monuments/gothic.ron")),
    ("baroque.ron", include_str!("../../../../assets/monuments/baroque.ron")),
    ("prague_towers.ron", include_str!("../../../../assets/monuments/prague_towers.ron")),
];

/// The monuments that come with growth, and the parts that they are put together from: see `assets/monuments`.
fn monuments() -> Monuments {
    // Each text is part of the program, and a test reads every one: none is ever left out.
    Monuments(MONUMENTS.iter().filter_map(|(name, text)| file::parse::<Monuments>(text, name).ok()).flat_map(|m| m.0).collect())
}

/// The rules that come with growth: see `assets/furniture`.
const FURNITURE: (&str, &str) = ("stock.ron", include_str!("../../../../assets/furniture/stock.ron"));

fn furniture() -> Vec<FurnitureRule> {
    // The text is part of the program, and a test reads it.
    file::parse(FURNITURE.1, FURNITURE.0).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stock_style_and_monument_reads_and_is_sound() {
        for (name, text) in STOCK {
            let style: StyleDraft = file::parse(text, name).unwrap_or_else(|e| panic!("{e}"));
            style.finish(&styles()).unwrap_or_else(|e| panic!("{e}"));
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
        let rules: Vec<FurnitureRule> = file::parse(FURNITURE.1, FURNITURE.0).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((rules.is_empty(), furniture::validate(&rules)), (false, Vec::new()));
    }

    #[test]
    fn two_of_one_name_are_told() {
        let style = |name: &str| StyleDraft { name: name.to_owned(), inherits: Some("church".to_owned()), ..StyleDraft::default() };
        let monument = |name: &str| {
            let text = format!("(name: \"{name}\", parts: [])");
            file::parse::<Monument>(&text, "test").unwrap_or_else(|e| panic!("{e}"))
        };
        let told = |styles: &[StyleDraft], monuments: Vec<Monument>| {
            let errors = Stock::new().with(styles, monuments, Vec::new()).err().unwrap_or_default();
            errors.iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        for name in ["mine", "old_town"] {
            assert_eq!(told(&[style(name), style(name)], Vec::new()), [format!("two styles are called `{name}`")]);
        }
        for name in ["mine", "obelisk"] {
            let errors = told(&[], vec![monument(name), monument(name)]);
            assert_eq!(errors, [format!("two monuments are called `{name}`")]);
        }
        let stock = Stock::new().with(&[style("mine"), style("old_town")], vec![monument("mine"), monument("obelisk")], Vec::new());
        let counts = stock.map(|stock| (stock.styles.0.len(), stock.monuments.0.len()));
        assert_eq!(counts, Ok((styles().0.len() + 1, monuments().0.len() + 1)));
    }

    #[test]
    fn rules_are_added_replaced_and_checked() {
        let with = |text: &str| {
            let rules: Vec<FurnitureRule> = file::parse(text, "test").unwrap_or_else(|e| panic!("{e}"));
            Stock::new().with(&[], Vec::new(), rules).map_err(|e| e.iter().map(ToString::to_string).collect::<Vec<_>>())
        };
        let count = furniture().len();
        let stock =
            with("[(name: \"bins\", put: []), (name: \"tubs\", put: [(kind: Planter)], place: Scatter(of: Yards, every_m: 9))]");
        let stock = stock.unwrap_or_else(|e| panic!("{e:?}"));
        assert_eq!(stock.furniture.len(), count + 1);
        assert!(stock.furniture.iter().any(|rule| rule.name == "bins" && rule.put.is_empty()));
        let told = with("[(name: \"x\", put: [(kind: Statue, monument: \"colossus\")], place: Scatter(of: Yards, every_m: 9))]");
        assert_eq!(told.err(), Some(vec!["furniture rule `x`: there is no monument `colossus`".to_owned()]));
    }

    #[test]
    fn every_file_of_the_assets_is_part_of_the_stock() {
        let files = |folder: &str| {
            let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets").join(folder);
            let all = std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
            let names = all.map(|file| file.unwrap_or_else(|e| panic!("{e}")).file_name().to_string_lossy().into_owned());
            let mut names: Vec<String> = names.filter(|name| name.ends_with(".ron")).collect();
            names.sort_unstable();
            names
        };
        let listed = |list: &[(&str, &str)]| {
            let mut names: Vec<String> = list.iter().map(|(name, _)| (*name).to_owned()).collect();
            names.sort_unstable();
            names
        };
        assert_eq!(files("styles"), listed(&STOCK));
        assert_eq!(files("monuments"), listed(&MONUMENTS));
        assert_eq!(files("furniture"), listed(&[FURNITURE]));
    }
}
