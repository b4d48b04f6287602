//! Packets of painted façades.

mod sample;

use proptest::collection::vec;
use proptest::prelude::*;
use sample::painted;
use veduta_city::{FacadeSheet, Level, PaintedWall, PictureFile, Wall};
use veduta_store::{BlobRef, FORMAT_VERSION, Packet, PacketContext, StoreError, decode_packet, encode_packet};

fn read(stored: &[u8], level: Level) -> Result<Packet, StoreError> {
    decode_packet(stored, &BlobRef::of(stored), level, PacketContext::default())
}

fn write(packet: &Packet) -> Vec<u8> {
    encode_packet(packet, PacketContext::default())
}

fn sheet() -> FacadeSheet {
    let wall = |wall| PaintedWall { wall, painted: painted(5 + wall as u8) };
    FacadeSheet { walls: vec![Wall::default(); 4], painted: vec![wall(1), wall(3)] }
}

#[test]
fn painted_walls_and_their_pictures_survive() {
    let packet = Packet::Facades(sheet());
    assert_eq!(read(&write(&packet), Level::Two), Ok(packet));
    let pictures = Packet::Pictures(vec![PictureFile(vec![1, 2, 3]), PictureFile(Vec::new()), PictureFile((0..=255).collect())]);
    assert_eq!(read(&write(&pictures), Level::Three), Ok(pictures));
}

#[test]
fn a_form_that_changed_has_a_new_version() {
    let pictures = Packet::Pictures(vec![PictureFile(vec![7; 9])]);
    let form = [Packet::Facades(sheet()), pictures].map(|packet| blake3::hash(&write(&packet)).to_hex()[..16].to_owned());
    let expected = ["8727537f51d09280", "b4a5080cfb6fa6bb"];
    assert_eq!((FORMAT_VERSION, form), (22, expected.map(str::to_owned)), "raise FORMAT_VERSION if this is on purpose");
}

#[test]
fn what_could_not_be_drawn_is_refused() {
    let refused = |spoil: fn(&mut FacadeSheet)| {
        let mut sheet = sheet();
        spoil(&mut sheet);
        read(&write(&Packet::Facades(sheet)), Level::Two).expect_err("it cannot be drawn").to_string()
    };
    assert!(refused(|s| s.painted[1].wall = 4).contains("painted walls"));
    assert!(refused(|s| s.painted[1].wall = 1).contains("painted walls"));
    assert!(refused(|s| s.painted[0].painted.size.0 = -1).contains("steps"));
    assert!(refused(|s| s.painted[0].painted.textures.clear()).contains("no texture"));
    let many = |s: &mut FacadeSheet| {
        s.walls = vec![Wall::default(); 300];
        s.painted = (0..101).map(|wall| PaintedWall { wall, painted: painted(2) }).collect();
    };
    assert!(refused(many).contains("202 sections"));
}

#[test]
fn pictures_that_are_cut_off_or_claim_more_are_refused() {
    let whole = write(&Packet::Pictures(vec![PictureFile(vec![1; 100]), PictureFile(vec![2; 50])]));
    for length in 1..whole.len() {
        assert!(read(&whole[..length], Level::Three).is_err(), "{length} of {} bytes", whole.len());
    }
    let longer = [&whole[..], &[0]].concat();
    assert!(read(&longer, Level::Three).is_err());
    let mut many = whole.clone();
    many[1..5].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(read(&many, Level::Three).expect_err("too many").to_string().contains("4294967295 pictures"));
    let mut long = whole;
    long[5..9].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(read(&long, Level::Three).is_err());
}

proptest! {
    /// Someone who can compute checksums makes packets that no encoder would: what is not refused can be drawn.
    #[test]
    fn forged_packets_do_no_harm(edits in vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let mut stored = write(&Packet::Facades(sheet()));
        for (at, byte) in edits {
            let at = 1 + at.index(stored.len() - 1);
            stored[at] = byte;
        }
        if let Ok(Packet::Facades(sheet)) = read(&stored, Level::Two) {
            // Whoever draws it adds places up, and may store it again.
            for object in sheet.painted.iter().flat_map(|wall| &wall.painted.objects) {
                for (x, y) in object.places() {
                    prop_assert!(x.checked_add(object.size.0).is_some() && y.checked_add(object.size.1).is_some());
                }
            }
            let again = Packet::Facades(sheet);
            prop_assert_eq!(read(&write(&again), Level::Two), Ok(again));
        }
    }
}
