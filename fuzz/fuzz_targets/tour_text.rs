#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_city::{Step, Tour, TourSetting, TourText, file};

// The first bytes say what is done to the tour that the rest is.
fuzz_target!(|bytes: &[u8]| {
    let Some((edits, text)) = bytes.split_at_checked(6) else { return };
    let read = file::parse_bytes::<Tour>(text, "fuzz");
    let Ok(text) = core::str::from_utf8(text) else { return };
    let mut edited = match (TourText::parse(text, "fuzz"), read) {
        (Ok(edited), Ok(read)) => {
            // What is not a number is not like itself.
            assert!(*edited.tour() == read || read != read.clone());
            edited
        }
        (Err(a), Err(b)) => return assert_eq!(a, b),
        (a, b) => panic!("{a:?} and {b:?}"),
    };
    for edit in edits.chunks(2) {
        let (what, at) = (edit[0], usize::from(edit[1]));
        let many = edited.tour().steps.len();
        let before = edited.text().to_owned();
        let mut meant = edited.tour().clone();
        let is_done = match what % 6 {
            0 => edited.insert(at, &[Step::Wait { seconds: f64::from(what) }]).map(|()| {
                meant.steps.insert(at, Step::Wait { seconds: f64::from(what) });
            }),
            1 => edited.remove(at).map(|_| {
                meant.steps.remove(at);
            }),
            2 => edited.move_step(at, usize::from(what) / 6).map(|()| {
                let step = meant.steps.remove(at);
                meant.steps.insert(usize::from(what) / 6, step);
            }),
            3 => edited.set(TourSetting::Title("“T”\"".to_owned())).map(|()| meant.title = "“T”\"".to_owned()),
            4 => edited.set(TourSetting::Translations(Default::default())).map(|()| meant.translations.clear()),
            _ => {
                let step = Step::Say { text: "x".to_owned(), translations: Default::default(), seconds: None };
                edited.replace(at, &step).map(|()| meant.steps[at] = step)
            }
        };
        match is_done {
            Ok(()) => assert_eq!(*edited.tour(), meant, "{before}\n---\n{}", edited.text()),
            Err(_) => {
                let has_nan = meant != meant.clone();
                assert!(edited.text() == before && (at >= many || usize::from(what) / 6 >= many || has_nan), "{before}");
            }
        }
    }
});
