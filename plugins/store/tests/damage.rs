//! Damaged, cut and foreign bytes end in a named error, never in a panic or in other content.

mod sample;

use sample::{TempDir, city};
use veduta_city::{Level, PictureFile};
use veduta_store::*;

fn index() -> Vec<u8> {
    let temp = TempDir::new("damage");
    city(3, 2).write(&temp.0).expect("written");
    std::fs::read(temp.join(INDEX_NAME)).expect("an index")
}

#[test]
fn any_flipped_byte_of_an_index_is_noticed() {
    let good = index();
    let mut bytes = good.clone();
    for i in 0..good.len() {
        for mask in [0x01, 0x80, 0xFF] {
            bytes[i] = good[i] ^ mask;
            let error = decode_index(&bytes).expect_err("a flipped byte");
            let is_named = match i {
                0..7 => error == StoreError::NotACity,
                7 => matches!(error, StoreError::Kind { .. }),
                8..12 => matches!(error, StoreError::Newer { .. } | StoreError::Older { .. }),
                _ => error == StoreError::Checksum { what: "the index" },
            };
            assert!(is_named, "byte {i}: {error:?}");
        }
        bytes[i] = good[i];
    }
}

#[test]
fn a_cut_or_lengthened_index_is_noticed() {
    let good = index();
    for n in 0..good.len() {
        let error = decode_index(&good[..n]).expect_err("cut");
        if (7..44).contains(&n) {
            assert_eq!(error, StoreError::Length { what: "the index", expected: 44, found: n as u64 });
        }
    }
    let longer = [good.as_slice(), &[0]].concat();
    assert_eq!(decode_index(&longer), Err(StoreError::Checksum { what: "the index" }));
}

#[test]
fn what_is_wrong_with_a_file_is_told_with_its_name_and_what_to_do() {
    let temp = TempDir::new("told");
    city(1, 1).write(&temp.0).expect("written");
    let path = temp.join(INDEX_NAME);
    let mut bytes = std::fs::read(&path).expect("an index");
    let request = Client::new(ClientSettings::default()).next_request(0.0).expect("the index is asked for");
    let reader = DirReader::new(&temp.0).expect("a city");
    *bytes.last_mut().expect("some bytes") ^= 1;
    std::fs::write(&path, &bytes).expect("written");
    let error = request.fetch(&reader).expect_err("damaged").to_string();
    let told = "the index is damaged: its checksum does not match; bake the city again, or copy it whole";
    assert_eq!(error, format!("`city.veduta` in {}: {told}", reader.describe()));
    bytes[8..12].copy_from_slice(&(FORMAT_VERSION + 1).to_le_bytes());
    std::fs::write(&path, &bytes).expect("written");
    let error = request.fetch(&reader).expect_err("newer").to_string();
    assert!(error.contains("city.veduta") && error.ends_with("update the program"), "one thing to do is enough: {error}");
}

#[test]
fn a_newer_city_asks_for_a_newer_program() {
    let mut bytes = index();
    let newer = FORMAT_VERSION + 1;
    bytes[8..12].copy_from_slice(&newer.to_le_bytes());
    let error = decode_index(&bytes).expect_err("newer");
    assert_eq!(error, StoreError::Newer { found: newer });
    let told = format!("the city has format {newer}, this program reads format {FORMAT_VERSION}: update the program");
    assert_eq!(error.to_string(), told);
    bytes[8..12].copy_from_slice(&0_u32.to_le_bytes());
    assert_eq!(decode_index(&bytes), Err(StoreError::Older { found: 0 }));
    assert_eq!(decode_index(b"<!DOCTYPE html>"), Err(StoreError::NotACity));
}

#[test]
fn any_flipped_byte_of_a_packet_is_noticed_and_may_be_asked_for_again() {
    let city = city(1, 3);
    let pictures = Packet::Pictures(vec![PictureFile((0..99).collect()), PictureFile(vec![7])]);
    let packets = [Packet::Shell(Box::new(city.shells[0].clone())), Packet::Facades(city.sheets[0].clone()), pictures];
    for packet in packets {
        let good = encode_packet(&packet, PacketContext::default());
        let blob = BlobRef::of(&good);
        assert_eq!(decode_packet(&good, &blob, packet.level(), PacketContext::default()).as_ref(), Ok(&packet));
        let mut bytes = good.clone();
        for i in 0..good.len() {
            bytes[i] ^= 0x10;
            let error = decode_packet(&bytes, &blob, packet.level(), PacketContext::default()).expect_err("a flipped byte");
            assert!(matches!(error, StoreError::Checksum { .. }) && !error.is_permanent(), "byte {i}: {error:?}");
            bytes[i] = good[i];
            let error = decode_packet(&good[..i], &blob, packet.level(), PacketContext::default()).expect_err("cut");
            assert!(matches!(error, StoreError::Length { .. }) && !error.is_permanent(), "{i} bytes: {error:?}");
        }
    }
}

#[test]
fn any_flipped_byte_of_a_leaf_of_the_index_or_a_file_is_noticed() {
    let named: Vec<BlobRef> = (0..64_u8).map(|n| BlobRef::of(&[n; 9])).collect();
    let leaf = encode_leaf(&named);
    let file = encode_file(&"It is said that ".repeat(30).into_bytes()).expect("small");
    for (good, is_leaf) in [(leaf, true), (file, false)] {
        let blob = BlobRef::of(&good);
        let read = |stored: &[u8]| match is_leaf {
            true => decode_leaf(stored, &blob, named.len()).map(|_| ()),
            false => decode_file(stored, &blob).map(|_| ()),
        };
        assert_eq!(read(&good), Ok(()));
        let mut bytes = good.clone();
        for i in 0..good.len() {
            bytes[i] ^= 1 << (i % 8);
            let error = read(&bytes).expect_err("a flipped byte");
            assert!(matches!(error, StoreError::Checksum { .. }) && !error.is_permanent(), "byte {i}: {error:?}");
            bytes[i] = good[i];
            let error = read(&good[..i]).expect_err("cut");
            assert!(matches!(error, StoreError::Length { .. }) && !error.is_permanent(), "{i} bytes: {error:?}");
        }
    }
}

#[test]
fn a_packet_of_another_level_is_noticed_for_good() {
    let city = city(1, 1);
    let sheet = encode_packet(&Packet::Facades(city.sheets[0].clone()), PacketContext::default());
    let error = decode_packet(&sheet, &BlobRef::of(&sheet), Level::One, PacketContext::default()).expect_err("another level");
    assert!(matches!(error, StoreError::Kind { .. }) && error.is_permanent(), "{error:?}");
    let error = decode_packet(&sheet, &BlobRef::of(&sheet), Level::Three, PacketContext::default()).expect_err("another level");
    assert!(matches!(error, StoreError::Kind { .. }), "{error:?}");
    let error = decode_packet(&sheet, &BlobRef::of(&sheet), Level::Four, PacketContext::default()).expect_err("no such level");
    assert_eq!(error, StoreError::NoSuchLevel(Level::Four));
}
