//! Recordings and pictures beside a file that names them.

use std::io::Read;
use std::path::{Path, PathBuf};

use veduta_bake::below;
use veduta_city::{Life, LifeKind, Place};
use veduta_route::Gazetteer;

/// Larger pictures are not shown; bytes.
const PICTURE_BYTES: u64 = 8 << 20;

/// A kind of file: what it is called, and how its names end.
struct Kind {
    what: &'static str,
    endings: &'static [&'static str],
}

const RECORDING: Kind = Kind { what: "recording", endings: &[".ogg"] };
const PICTURE: Kind = Kind { what: "picture", endings: &[".png", ".jpg", ".jpeg", ".webp"] };

/// How long a recording beside a file plays, seconds; or why it cannot be played, in words.
pub(super) fn recording_beside(path: &Path, file: &str) -> Result<f64, String> {
    let at = found_beside(path, file, &RECORDING)?;
    let bytes = std::fs::read(&at).map_err(|error| format!("the recording `{file}`: {error}"))?;
    let recording = veduta_synth::Recording::new(bytes).map_err(|error| format!("the recording `{file}`: {error}"))?;
    Ok(recording.seconds())
}

/// A file of a city's life, and what lives by it.
pub(super) struct Living {
    /// Its name.
    pub file: String,
    /// The names of what can be seen to live.
    pub names: Vec<String>,
}

/// What lives in a city by what is told of it. Files that cannot be read are left out: who checks them is told.
pub(super) fn living_in(city: &Path) -> Vec<Living> {
    let read = |path: PathBuf| {
        let life: Life = veduta_city::file::read(&path).ok()?;
        let seen = life.things.into_iter().filter(|thing| !matches!(thing.kind, LifeKind::Smoke { .. } | LifeKind::Bell { .. }));
        let file = path.file_name()?.to_string_lossy().into_owned();
        Some(Living { file, names: seen.map(|thing| thing.name).collect() })
    };
    told_of(city, ".life.ron").into_iter().filter_map(read).collect()
}

/// The files of a kind that tell of a city: those that lie in its folder, or beside its map and begin as it does.
pub(super) fn told_of(city: &Path, ending: &str) -> Vec<PathBuf> {
    let is_folder = city.is_dir();
    let folder = if is_folder { city } else { city.parent().unwrap_or(Path::new("")) };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let name = city.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let is_of_city = |path: &PathBuf| {
        let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        file.strip_suffix(ending).is_some_and(|stem| is_folder || name.starts_with(&format!("{stem}.")))
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_of_city).collect();
    files.sort();
    files
}

/// Whether a picture beside a file is there, is one, and is small enough to be shown.
pub(super) fn picture_beside(path: &Path, file: &str) -> Result<(), String> {
    let at = found_beside(path, file, &PICTURE)?;
    let read = std::fs::File::open(&at).and_then(|opened| {
        let mut head = Vec::new();
        let bytes = opened.metadata()?.len();
        opened.take(12).read_to_end(&mut head)?;
        Ok((bytes, head))
    });
    let (bytes, head) = read.map_err(|error| format!("the picture `{file}`: {error}"))?;
    if !is_picture(&head) {
        return Err(format!(
            "`{file}` is called a picture and is none: it does not begin as PNG, JPEG or WebP do; save it again as one of them"
        ));
    }
    if bytes > PICTURE_BYTES {
        return Err(format!("the picture `{file}` has {bytes} bytes; at most {PICTURE_BYTES} are shown: make it smaller"));
    }
    Ok(())
}

/// Whether a file that begins so is a picture that can be shown.
fn is_picture(head: &[u8]) -> bool {
    let is_webp = head.starts_with(b"RIFF") && head.get(8..12) == Some(b"WEBP");
    is_webp || head.starts_with(b"\x89PNG\r\n\x1a\n") || head.starts_with(b"\xff\xd8\xff")
}

/// Where a file of a kind lies; or why it cannot be one, in words.
fn found_beside(path: &Path, file: &str, kind: &Kind) -> Result<PathBuf, String> {
    let Kind { what, endings } = kind;
    let shown = file.escape_debug();
    if file.is_empty() {
        return Err(format!("the {what} has no name; give the path of a file in or below the folder of this file"));
    }
    if file.contains('\\') || file.contains(char::is_control) {
        return Err(format!(
            "the {what}'s path `{shown}` has a `\\`; in a path write `/`, as in \"sounds/river.ogg\", on every system"
        ));
    }
    if file.contains("://") {
        return Err(format!("the {what} `{shown}` is not fetched from the web: it must lie in or below the folder of this file"));
    }
    if !veduta_city::is_beside(file) {
        return Err(format!(
            "the {what} `{shown}` must lie in or below the folder of this file; copy it there and name it from there"
        ));
    }
    let small = file.to_lowercase();
    if !endings.iter().any(|ending| small.ends_with(ending)) {
        return Err(of_another_kind(file, kind));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let at = below(folder, file).map_err(|astray| format!("the {what} `{shown}`: {astray}"))?;
    if at.is_dir() {
        return Err(format!("`{shown}` is a folder; give a {what}"));
    }
    if at.is_file() {
        Ok(at)
    } else {
        Err(format!("there is no file `{shown}` in the folder of this file{}", alike(&at, file, kind)))
    }
}

/// That a file's name is not that of its kind, and what to do.
fn of_another_kind(file: &str, kind: &Kind) -> String {
    let stem = file.rsplit_once('.').filter(|(_, ending)| !ending.contains('/')).map_or(file, |(stem, _)| stem);
    if kind.what == RECORDING.what {
        return format!(
            "`{file}` is no recording by its name: they are Ogg Vorbis and end in .ogg; convert a sound, for example by \
             `ffmpeg -i {file} -c:a libvorbis {stem}.ogg`"
        );
    }
    format!("`{file}` is no picture by its name: they end in {}", kind.endings.join(", "))
}

/// Files of a kind where one is looked for that is not there: the one that may be meant, or all if they are few.
fn alike(at: &Path, file: &str, kind: &Kind) -> String {
    const FEW: usize = 6;
    let folder = at.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let before = file.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
    let names =
        std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
    let is_of_kind = |name: &String| kind.endings.iter().any(|ending| name.to_lowercase().ends_with(ending));
    let mut there: Vec<String> = names.filter(is_of_kind).map(|name| format!("{before}{name}")).collect();
    there.sort();
    let named: Vec<Place> = there.iter().map(|name| Place { name: name.clone(), ..Place::default() }).collect();
    let named = Gazetteer::new(&named);
    let quoted = |names: &[&str]| names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
    match named.find(file).map(|place| place.name.as_str()).or_else(|| named.suggest(file).first().copied()) {
        Some(name) if name.to_lowercase() == file.to_lowercase() => format!("; did you mean \"{name}\"? Capital letters count"),
        Some(name) => format!("; did you mean \"{name}\"?"),
        None if there.is_empty() => String::new(),
        None => {
            let some: Vec<&str> = there.iter().take(FEW).map(String::as_str).collect();
            let are = if there.len() == 1 { "is" } else { "are" };
            format!("; there {are} {}{}", quoted(&some), if there.len() > FEW { " and others" } else { "" })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_known_by_how_they_begin() {
        assert!(is_picture(b"\x89PNG\r\n\x1a\n\0\0\0\r") && is_picture(b"\xff\xd8\xff\xe0") && is_picture(b"RIFF\0\0\0\0WEBPVP8 "));
        assert!(!is_picture(b"RIFF\0\0\0\0WAVE") && !is_picture(b"import os") && !is_picture(b""));
    }
}
