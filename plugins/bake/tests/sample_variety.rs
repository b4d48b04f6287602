//! How little the fronts along the sample city's streets repeat one another.

use std::path::Path;

use veduta_bake::{BakeSettings, Input, plan};
use veduta_growth::plan::repetition;

#[test]
fn no_street_of_the_sample_city_is_a_row_of_doubles() {
    let input = Input::of(Path::new("../../scenes/old_prague")).unwrap_or_else(|e| panic!("{e}"));
    let planned = plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
    let seen = repetition(&planned.plan);
    println!("{seen:?}");
    assert!(seen.fronts > 500, "{} fronts", seen.fronts);
    assert!(seen.mean <= 0.4, "a front is to {} like its likest", seen.mean);
    let (street, mean) = seen.dullest.expect("there are long streets");
    assert!(mean <= 0.5, "in {street} a front is to {mean} like its likest");
    assert_eq!(seen.doubles, []);
}
