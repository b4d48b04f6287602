//! The directory reader stays within its directory.

mod sample;

use std::path::Path;

use sample::{TempDir, city};
use veduta_store::*;

#[test]
fn places_that_hold_no_city_are_told_apart_and_say_what_to_do() {
    let temp = TempDir::new("places");
    let open = |path: &Path| open_reader(&path.to_string_lossy()).map(|reader| reader.describe());
    let error = open(&temp.join("nothing")).expect_err("nothing there");
    assert!(matches!(error, ReadError::NoDirectory(_)) && error.to_string().contains("veduta-bake bake"), "{error}");
    let error = open(&temp.0).expect_err("empty");
    assert!(matches!(error, ReadError::NoIndex(_)) && error.to_string().contains("veduta-bake bake"), "{error}");
    city(1, 1).write(&temp.join("x.city")).expect("written");
    let described = open(&temp.join("x.city")).expect("a city");
    assert_eq!(open(&temp.join("x.city/city.veduta")), Ok(described), "its index will do");
    for place in ["ftp://h/x", "file:///tmp/x", "data://x"] {
        assert!(matches!(open_reader(place), Err(ReadError::Place { .. })), "{place}");
    }
    assert!(open_reader("HTTP://localhost/x.city").is_ok());
}

#[cfg(unix)]
#[test]
fn an_index_that_the_system_withholds_is_not_called_missing() {
    let temp = TempDir::new("withheld");
    // A link to itself: unlike a folder without permission, it is refused to every user.
    std::os::unix::fs::symlink(INDEX_NAME, temp.join(INDEX_NAME)).expect("a link");
    let error = DirReader::new(&temp.0).expect_err("a loop");
    assert!(matches!(&error, ReadError::Failed { path, .. } if path == INDEX_NAME), "{error}");
    std::os::unix::fs::symlink("round", temp.join("round")).expect("a link");
    assert!(matches!(DirReader::new(temp.join("round")), Err(ReadError::Failed { .. })));
}

#[test]
fn what_is_read_is_whole_and_within_the_limit() {
    let temp = TempDir::new("limit");
    city(1, 1).write(&temp.0).expect("written");
    let reader = DirReader::new(&temp.0).expect("a city");
    let bytes = reader.read(INDEX_NAME, 1 << 20).expect("the index");
    assert_eq!(bytes, std::fs::read(temp.join(INDEX_NAME)).expect("the index"));
    let size = bytes.len() as u64;
    assert_eq!(reader.read(INDEX_NAME, size), Ok(bytes), "exactly the limit");
    assert!(matches!(reader.read(INDEX_NAME, size - 1), Err(ReadError::TooLarge { .. })));
    assert!(matches!(reader.read("blobs/00/none.bin", 9), Err(ReadError::NotFound { .. })));
    assert!(matches!(reader.read("blobs", 9), Err(ReadError::Failed { .. })), "a folder is no file");
}

#[test]
fn no_path_leads_out_of_the_directory() {
    let temp = TempDir::new("escape");
    city(1, 1).write(&temp.join("x.city")).expect("written");
    std::fs::write(temp.join("secret"), "secret").expect("a file");
    let reader = DirReader::new(temp.join("x.city")).expect("a city");
    let absolute = temp.join("secret").to_string_lossy().into_owned();
    for path in ["../secret", "blobs/../../secret", "..\\secret", "%2e%2e/secret", "./../secret", "blobs/./../../secret", &absolute]
    {
        assert!(matches!(reader.read(path, 99), Err(ReadError::Forbidden { .. })), "{path}");
    }
}

#[cfg(unix)]
#[test]
fn links_are_followed_within_the_directory_only() {
    use std::os::unix::fs::symlink;
    let temp = TempDir::new("links");
    let dir = temp.join("x.city");
    city(1, 1).write(&dir).expect("written");
    std::fs::write(temp.join("secret"), "secret").expect("a file");
    symlink(temp.join("secret"), dir.join("file")).expect("a link");
    symlink("../secret", dir.join("relative")).expect("a link");
    symlink(&temp.0, dir.join("folder")).expect("a link");
    symlink(INDEX_NAME, dir.join("within")).expect("a link");
    symlink("loop", dir.join("loop")).expect("a link");
    let reader = DirReader::new(&dir).expect("a city");
    for path in ["file", "relative", "folder/secret"] {
        assert!(matches!(reader.read(path, 99), Err(ReadError::Forbidden { .. })), "{path}");
    }
    assert!(reader.read("within", 1 << 20).is_ok());
    assert!(matches!(reader.read("loop", 99), Err(ReadError::Failed { .. })));
    // The city itself may lie behind a link.
    symlink(&dir, temp.join("linked.city")).expect("a link");
    assert!(DirReader::new(temp.join("linked.city")).expect("a city").read(INDEX_NAME, 1 << 20).is_ok());
}
