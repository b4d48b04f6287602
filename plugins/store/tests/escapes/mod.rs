//! Paths by which someone might try to get out of a folder. Every way to a file is tried with all of them.
#![allow(dead_code, reason = "each test uses its own part")]

/// Ways in which someone might try to get out of a folder, and ways to write them.
pub fn corpus() -> Vec<String> {
    let ups = [
        "..",
        "../..",
        "../../..",
        ".",
        "...",
        "....",
        "~",
        "",
        "%2e%2e",
        "%2E%2E",
        "..%2f",
        "%252e%252e",
        "..;",
        "..\u{2215}",
        "．．",
        // Leads nowhere else: to be told from the others.
        "notes",
    ];
    let targets =
        ["etc/passwd", "city.veduta", "secret.txt", "blobs", "", "windows/win.ini", "proc/self/environ", "x\0.bin", "nul", "con"];
    let heads = [
        "",
        "/",
        "\\",
        "//",
        "\\\\",
        "C:",
        "C:/",
        "C:\\",
        "file:///",
        "http://h/",
        "blobs/",
        "blobs/ab/",
        "./",
        "%2f",
        "\u{feff}",
        " ",
    ];
    let joints = ["/", "\\", "//", "/./", "\\\\", "%2f", "%5c", "/\0/", "/ /"];
    let mut all = Vec::new();
    for head in heads {
        for up in ups {
            for joint in joints {
                for target in targets {
                    all.push(format!("{head}{up}{joint}{target}"));
                }
            }
        }
    }
    all
}

/// Whether a path is what readers take: of plain letters, every part of it a name.
pub fn is_plain(path: &str) -> bool {
    (1..=255).contains(&path.len())
        && path.bytes().all(|b| b.is_ascii_alphanumeric() || b"._-/".contains(&b))
        && !path.split('/').any(|part| part.is_empty() || part.starts_with('.'))
}
