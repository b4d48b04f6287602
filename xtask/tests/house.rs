//! The rules of the house that no compiler holds: who imports whom, how long files are, what documents may say.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand};

/// Crates that know no engine, apart from the model and the pipeline.
const CORE: [&str; 8] = [
    "veduta-survey",
    "veduta-growth",
    "veduta-texture",
    "veduta-cells",
    "veduta-route",
    "veduta-synth",
    "veduta-cartography",
    "veduta-store",
];
/// Plugins, none of which knows another.
const PLUGINS: [&str; 10] = [
    "veduta-streaming",
    "veduta-buildings",
    "veduta-facade",
    "veduta-tour",
    "veduta-minimap",
    "veduta-guide",
    "veduta-walker",
    "veduta-sky",
    "veduta-sound",
    "veduta-life",
];

/// Plugins that draw windows.
const WITH_WINDOWS: [&str; 3] = ["veduta-tour", "veduta-minimap", "veduta-guide"];

/// Plugins that read what a visitor presses.
const WITH_CONTROLS: [&str; 4] = ["veduta-tour", "veduta-minimap", "veduta-guide", "veduta-walker"];

/// What a crate may import among ours: in its code, and in its tests besides.
struct Imports {
    code: Vec<&'static str>,
    tests: Vec<&'static str>,
}

/// The import table. Imports run downwards only; a crate that is not here is not of the house.
fn table() -> BTreeMap<&'static str, Imports> {
    let with = |parts: &[&[&'static str]]| parts.concat();
    let mut table = BTreeMap::new();
    let mut enter = |name, code: Vec<&'static str>, tests: Vec<&'static str>| {
        assert!(table.insert(name, Imports { code, tests }).is_none(), "{name} stands twice in the table");
    };
    enter("veduta-city", vec![], vec![]);
    for name in CORE {
        enter(name, vec!["veduta-city"], with(&[&CORE]));
    }
    enter("veduta-bake", with(&[&["veduta-city"], &CORE]), vec![]);
    enter("veduta-ecs", vec!["veduta-city"], vec![]);
    enter("veduta-ui", vec!["veduta-ecs"], vec![]);
    enter("veduta-controls", vec!["veduta-ecs"], vec![]);
    for name in PLUGINS {
        let ui: &[&str] = if WITH_WINDOWS.contains(&name) { &["veduta-ui"] } else { &[] };
        let controls: &[&str] = if WITH_CONTROLS.contains(&name) { &["veduta-controls"] } else { &[] };
        enter(name, with(&[&["veduta-city", "veduta-ecs"], ui, controls, &CORE]), vec!["veduta-bake"]);
    }
    enter(
        "veduta",
        with(&[&["veduta-city", "veduta-ecs", "veduta-ui", "veduta-controls"], &PLUGINS]),
        with(&[&["veduta-bake"], &CORE]),
    );
    enter("veduta-game", with(&[&["veduta", "veduta-city", "veduta-bake"], &CORE]), vec![]);
    enter("veduta-tests", with(&[&["veduta", "veduta-game", "veduta-city", "veduta-bake", "veduta-ecs"], &CORE, &PLUGINS]), vec![]);
    enter("veduta-digests", vec!["veduta-city", "veduta-growth"], vec![]);
    enter("xtask", vec![], vec![]);
    table
}

fn root() -> PathBuf {
    // Tests run in their package's folder.
    std::env::current_dir().ok().and_then(|d| d.parent().map(Path::to_owned)).expect("xtask lies in the workspace's folder")
}

fn metadata() -> Metadata {
    let mut command = MetadataCommand::new();
    command.manifest_path(root().join("Cargo.toml")).no_deps();
    command.exec().expect("cargo reads the workspace's manifests")
}

/// Every import among `(crate, imported crate, whether only for tests)` that the table does not allow.
fn trespasses<'a>(imports: impl IntoIterator<Item = (&'a str, &'a str, bool)>) -> Vec<String> {
    let table = table();
    let mut found = Vec::new();
    for (name, imported, for_tests) in imports {
        let Some(allowed) = table.get(name) else {
            found.push(format!("{name} is not in the import table"));
            continue;
        };
        let is_allowed = allowed.code.contains(&imported) || for_tests && allowed.tests.contains(&imported);
        if !is_allowed {
            found.push(format!("{name} imports {imported}{}", if for_tests { " for its tests" } else { "" }));
        }
    }
    found
}

#[test]
fn imports_run_downwards_only() {
    let metadata = metadata();
    let ours: BTreeSet<&str> = metadata.packages.iter().map(|p| p.name.as_str()).collect();
    let known: BTreeSet<&str> = table().into_keys().collect();
    assert_eq!(ours, known, "the crates of the workspace and those of the import table");
    let imports = metadata.packages.iter().flat_map(|package| {
        let among_ours = package.dependencies.iter().filter(|d| ours.contains(d.name.as_str()));
        among_ours.map(|d| (package.name.as_str(), d.name.as_str(), d.kind == DependencyKind::Development))
    });
    assert_eq!(trespasses(imports), Vec::<String>::new());
}

#[test]
fn the_table_forbids_what_it_should() {
    let forbidden = [
        ("veduta-city", "veduta-route", false),
        ("veduta-cells", "veduta-growth", false),
        ("veduta-store", "veduta-ecs", false),
        ("veduta-ecs", "veduta-store", false),
        ("veduta-tour", "veduta-minimap", false),
        ("veduta-tour", "veduta-minimap", true),
        ("veduta-streaming", "veduta-bake", false),
        ("veduta-streaming", "veduta-ui", false),
        ("veduta-ui", "veduta-city", false),
        ("veduta-life", "veduta-sound", false),
        ("veduta-sky", "veduta-controls", false),
        ("veduta", "veduta-game", false),
        ("stranger", "veduta-city", false),
    ];
    assert_eq!(trespasses(forbidden).len(), forbidden.len());
    let allowed = [("veduta-tour", "veduta-route", false), ("veduta-streaming", "veduta-bake", true)];
    assert_eq!(trespasses(allowed), Vec::<String>::new());
}

/// Packages of a lock file with the names of what each depends on; packages of one name are taken together.
fn locked(lock: &str) -> BTreeMap<&str, BTreeSet<&str>> {
    let mut packages: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    let mut name = "";
    for line in lock.lines() {
        if let Some(rest) = line.strip_prefix("name = \"") {
            name = rest.trim_end_matches('"');
            packages.entry(name).or_default();
        } else if let Some(rest) = line.strip_prefix(" \"") {
            let dependency = rest.split([' ', '"']).next().unwrap_or_default();
            packages.entry(name).or_default().insert(dependency);
        }
    }
    packages
}

/// All that a package depends on, through others too.
fn reach<'a>(packages: &BTreeMap<&'a str, BTreeSet<&'a str>>, from: &'a str) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut open = vec![from];
    while let Some(name) = open.pop() {
        for &next in packages.get(name).into_iter().flatten() {
            if reached.insert(next) {
                open.push(next);
            }
        }
    }
    reached
}

fn is_engine(name: &str) -> bool {
    name.starts_with("bevy") || ["wgpu", "winit", "egui", "rapier3d"].contains(&name)
}

#[test]
fn no_core_crate_knows_the_engine_even_through_others() {
    let lock = std::fs::read_to_string(root().join("Cargo.lock")).expect("the workspace has a lock file");
    let packages = locked(&lock);
    for name in CORE.into_iter().chain(["veduta-city", "veduta-bake", "xtask"]) {
        assert!(packages.contains_key(name), "{name} is in the lock file");
        let engine: Vec<&str> = reach(&packages, name).into_iter().filter(|n| is_engine(n)).collect();
        assert_eq!(engine, Vec::<&str>::new(), "{name} depends on the engine");
    }
    // The same question asked of a plugin has the other answer.
    assert!(reach(&packages, "veduta-sky").into_iter().any(is_engine));
}

#[test]
fn every_crate_takes_the_workspaces_lints_and_versions() {
    for package in metadata().packages {
        let manifest = std::fs::read_to_string(&package.manifest_path).expect("cargo has just read it");
        assert!(manifest.contains("[lints]\nworkspace = true"), "{}: takes the workspace's lints", package.name);
        assert!(package.description.is_some(), "{}: says what it is", package.name);
        let own: Vec<&str> = manifest.lines().filter(|line| line.contains("version = \"")).collect();
        assert_eq!(own, Vec::<&str>::new(), "{}: versions stand in the workspace's table", package.name);
    }
}

/// Every file of the project by its path from the root, in order; what is built and what git keeps is left out.
fn files() -> Vec<(String, PathBuf)> {
    let root = root();
    let mut found = Vec::new();
    let mut open = vec![root.clone()];
    while let Some(dir) = open.pop() {
        for entry in std::fs::read_dir(&dir).expect("the project's folders can be read") {
            let path = entry.expect("the project's folders can be read").path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_symlink() || [".git", "target", "out"].contains(&name.as_str()) {
                continue;
            }
            if path.is_dir() {
                open.push(path);
            } else {
                let inside = path.strip_prefix(&root).expect("found below the root");
                found.push((inside.to_string_lossy().replace('\\', "/"), path.clone()));
            }
        }
    }
    found.sort();
    found
}

/// Files of text that people write.
fn written() -> Vec<(String, String)> {
    let endings = ["rs", "md", "toml", "ron", "wgsl", "sh", "yml", "yaml", "json"];
    let is_text = |name: &str| name.starts_with(".ci/") || endings.iter().any(|e| name.ends_with(&format!(".{e}")));
    let files = files().into_iter().filter(|(name, _)| is_text(name));
    files.map(|(name, path)| (name, std::fs::read_to_string(path).expect("text is UTF-8"))).collect()
}

/// Most lines of a source file, unless it says near its top why it has more.
const LINES: usize = 600;

fn is_too_long(text: &str) -> bool {
    let says_why = |line: &str| line.trim_start().strip_prefix("// Long because: ").is_some_and(|why| why.trim().len() >= 10);
    text.lines().count() > LINES && !text.lines().take(20).any(says_why)
}

#[test]
fn long_source_files_say_why() {
    let sources: Vec<_> = written().into_iter().filter(|(name, _)| name.ends_with(".rs")).collect();
    assert!(sources.len() > 100, "the project's sources are found");
    let long: Vec<&str> = sources.iter().filter(|(_, text)| is_too_long(text)).map(|(name, _)| name.as_str()).collect();
    assert_eq!(long, Vec::<&str>::new(), "over {LINES} lines: split them, or write `// Long because: …` near their top");
}

#[test]
fn a_long_file_needs_a_reason() {
    let body = "x\n".repeat(LINES);
    assert!(!is_too_long(&body));
    assert!(is_too_long(&format!("x\n{body}")));
    assert!(is_too_long(&format!("// Long because: \n{body}")), "an empty reason is none");
    assert!(!is_too_long(&format!("// Long because: one table of forms.\n{body}")));
    assert!(is_too_long(&format!("{body}// Long because: one table of forms.\n")), "the reason stands near the top");
}

/// Hosts that documents and sources may name: standards, licences, public sources, and names made for examples.
const HOSTS: [&str; 31] = [
    "github.com",
    "docs.rs",
    "doc.rust-lang.org",
    "rustup.rs",
    "bevy.org",
    "keepachangelog.com",
    "semver.org",
    "www.apache.org",
    "creativecommons.org",
    "opendatacommons.org",
    "www.openstreetmap.org",
    "wiki.openstreetmap.org",
    "rustsec.org",
    "doi.org",
    "protobuf.dev",
    "www.w3.org",
    "embarkstudios.github.io",
    "www.opengis.net",
    "www.loc.gov",
    // KML's extensions, and what they mean.
    "www.google.com",
    "developers.google.com",
    "www.clicketyclick.dk",
    "geojson.org",
    "www2.census.gov",
    "www.esri.com",
    // What visitors may read on.
    "en.wikipedia.org",
    "cs.wikipedia.org",
    "de.wikipedia.org",
    "prague.eu",
    "www.mlp.cz",
    "projectfluent.org",
];

/// Whether a host is made for examples, or is this machine.
fn is_example(host: &str) -> bool {
    let example = ["example.org", "example.com", "example.net"].iter().any(|e| host == *e || host.ends_with(&format!(".{e}")));
    // A name without a dot is nobody's on the Internet: `http://h` in a test.
    example || host == "127.0.0.1" || host.starts_with('[') || !host.contains('.')
}

/// Hosts in a text's addresses that are neither known nor examples.
fn strange_hosts(text: &str) -> Vec<String> {
    let starts = ["http:", "https:"].iter().flat_map(|scheme| {
        let scheme = format!("{scheme}//");
        let len = scheme.len();
        text.match_indices(&scheme).map(move |(at, _)| at + len).collect::<Vec<_>>()
    });
    let hosts = starts.map(|at| {
        let rest = &text[at..];
        rest.split(|c: char| !(c.is_alphanumeric() || ".-[".contains(c))).next().unwrap_or_default().trim_end_matches('.')
    });
    hosts.filter(|host| !host.is_empty() && !HOSTS.contains(host) && !is_example(host)).map(str::to_owned).collect()
}

/// Paths in a text that exist on one person's machine only.
fn private_paths(text: &str) -> Vec<&str> {
    let roots =
        [concat!("/ho", "me/"), concat!("/ro", "ot/"), concat!("/Us", "ers/"), concat!("\\Us", "ers\\"), concat!("/wo", "rk/")];
    let is_path_start = |at: usize| !text[..at].ends_with(|c: char| c.is_alphanumeric() || "._-~}".contains(c));
    roots.into_iter().filter(|root| text.match_indices(root).any(|(at, _)| is_path_start(at))).collect()
}

#[test]
fn no_file_names_a_private_host_or_path() {
    let files = written();
    assert!(files.iter().any(|(name, _)| name == "README.md") && files.iter().any(|(name, _)| name == ".ci/run"));
    let mut found = Vec::new();
    for (name, text) in &files {
        found.extend(strange_hosts(text).into_iter().map(|host| format!("{name}: {host} is not in the list of `HOSTS`")));
        found.extend(private_paths(text).into_iter().map(|path| format!("{name}: {path} is a path of one machine")));
    }
    assert_eq!(found, Vec::<String>::new());
}

#[test]
fn private_hosts_and_paths_are_seen() {
    let mirror = format!("index = \"sparse+https:{}\"", "//crates.mirror.internal.net/index/");
    assert_eq!(strange_hosts(&mirror), ["crates.mirror.internal.net"]);
    let fine = "https://github.com/a http://localhost:8000 https://cities.example.org/x http://h/c http://127.0.0.1:80";
    assert_eq!(strange_hosts(fine), Vec::<String>::new());
    assert_eq!(private_paths(concat!("see /ho", "me/jan/town.ron")).len(), 1);
    assert_eq!(private_paths("plugins/home/a ${HOME}/x out/work/y"), Vec::<&str>::new());
}

#[test]
fn locked_packages_come_from_one_registry() {
    let lock = std::fs::read_to_string(root().join("Cargo.lock")).expect("the workspace has a lock file");
    let sources: BTreeSet<&str> = lock.lines().filter_map(|line| line.strip_prefix("source = ")).collect();
    assert_eq!(sources.len(), 1, "{sources:?}");
    assert!(sources.iter().all(|source| source.starts_with("\"registry+")), "no git sources: {sources:?}");
}

/// Blocks of code in a document that are quoted from a file: `<!-- from: PATH -->` above the fence.
fn quotes(document: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut lines = document.lines();
    while let Some(line) = lines.next() {
        let Some(path) = line.trim().strip_prefix("<!-- from: ").and_then(|rest| rest.strip_suffix(" -->")) else { continue };
        let fence = lines.next().unwrap_or_default();
        assert!(fence.starts_with("```"), "a fence follows `{line}`");
        let body: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
        found.push((path.to_owned(), body.join("\n")));
    }
    found
}

#[test]
fn quoted_code_is_what_the_files_say() {
    let readme = std::fs::read_to_string(root().join("README.md")).expect("there is a README");
    let quotes = quotes(&readme);
    assert!(quotes.len() >= 7, "the app, five plugins alone and a tour are quoted: {}", quotes.len());
    for (path, body) in &quotes {
        let file = std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("README.md quotes {path}: {e}"));
        assert!(body.trim().len() > 20 && file.contains(body.as_str()), "README.md: {path} no longer says\n{body}");
    }
    // No code for the engine stands there that CI does not build.
    let rust = readme.lines().filter(|line| line.starts_with("```rust")).count();
    assert_eq!(rust, quotes.iter().filter(|(path, _)| path.ends_with(".rs")).count(), "every Rust block is quoted from a file");
}

/// Targets of a document's links to the project's own files; pictures are left out.
fn own_links(document: &str) -> Vec<&str> {
    let targets = document.match_indices("](").filter_map(|(at, _)| {
        let open = document[..at].rfind('[')?;
        let is_picture = document[..open].ends_with('!');
        let target = document[at + 2..].split([')', '#']).next()?;
        (!is_picture && !target.is_empty() && !target.contains("://")).then_some(target)
    });
    targets.collect()
}

#[test]
fn links_lead_somewhere() {
    for name in ["README.md", "ARCHITECTURE.md", "CHANGELOG.md"] {
        let text = std::fs::read_to_string(root().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
        for link in own_links(&text) {
            assert!(root().join(link).exists(), "{name} links to {link}, which is not there");
        }
    }
    assert_eq!(own_links("[a](b.md#c) ![p](p.png) [x](https://docs.rs) [y](#z)"), ["b.md"]);
}

#[test]
fn every_dependency_has_its_line_in_the_architecture() {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("the workspace has a manifest");
    let table = manifest.split("[workspace.dependencies]").nth(1).expect("it has a table of dependencies");
    let table = table.split("\n[").next().unwrap_or_default();
    let names: Vec<&str> = table
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_lowercase()))
        .filter_map(|line| line.split([' ', '=']).next())
        .filter(|name| !name.starts_with("veduta"))
        .collect();
    assert!(names.contains(&"bevy") && names.contains(&"proptest"), "the table is read to its end: {names:?}");
    let page = std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("there is an ARCHITECTURE.md");
    for name in &names {
        assert!(page.contains(&format!("\n| `{name}` |")), "ARCHITECTURE.md says nothing of `{name}`: what for, what was rejected");
    }
}

#[test]
fn the_fast_verification_covers_every_crate_without_an_engine() {
    let verify = std::fs::read_to_string(root().join("xtask/src/verify.rs")).expect("it is beside this test");
    let list = verify.split("pub const CORE").nth(1).and_then(|rest| rest.split(';').nth(1)).expect("it lists the crates");
    for name in CORE.into_iter().chain(["veduta-city", "veduta-bake"]) {
        assert!(list.contains(&format!("\"{name}\"")), "`cargo verify core` leaves out {name}");
    }
}

/// Every package with its features, as cargo selects them for these arguments.
fn selected(arguments: &[&str]) -> BTreeSet<String> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(root()).args(["tree", "--prefix", "none", "--format", "{p} [{f}]"]).args(arguments);
    let output = cargo.output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let tree = String::from_utf8(output.stdout).expect("cargo tells in UTF-8");
    tree.lines().filter(|line| !line.is_empty()).map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
}

#[test]
fn tests_and_baking_are_built_upon_what_the_game_is_built_upon() {
    let played = selected(&["--package", "veduta-game", "--edges", "normal,build"]);
    // What `cargo run --bin veduta-bake` selects from.
    let baked = selected(&["--edges", "normal,build"]);
    let verified = selected(&["--workspace", "--exclude", "xtask", "--edges", "normal,build,dev"]);
    assert!(played.iter().any(|line| line.starts_with("bevy ")), "the tree is read");
    let other: Vec<_> = played.difference(&verified).chain(played.symmetric_difference(&baked)).collect();
    assert!(other.is_empty(), "`cargo verify`, `cargo play` and `cargo run --bin veduta-bake` each build their own of {other:#?}");
}
