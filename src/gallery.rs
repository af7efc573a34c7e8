//! The cases that `talcum new` writes: whole files of `cases/gallery`.

/// The cases by name.
pub(crate) const GALLERY: [(&str, &str); 12] = [
    ("travelling-waves", include_str!("../cases/gallery/travelling-waves.toml")),
    ("cohesive-plug", include_str!("../cases/gallery/cohesive-plug.toml")),
    ("vibrated-bed", include_str!("../cases/gallery/vibrated-bed.toml")),
    ("bubbling-bed", include_str!("../cases/gallery/bubbling-bed.toml")),
    ("spout", include_str!("../cases/gallery/spout.toml")),
    ("round-column", include_str!("../cases/gallery/round-column.toml")),
    ("pulsed-bed", include_str!("../cases/gallery/pulsed-bed.toml")),
    ("segregation", include_str!("../cases/gallery/segregation.toml")),
    ("moving-wall", include_str!("../cases/gallery/moving-wall.toml")),
    ("agglomerates", include_str!("../cases/gallery/agglomerates.toml")),
    ("two-species", include_str!("../cases/gallery/two-species.toml")),
    ("heap", include_str!("../cases/gallery/heap.toml")),
];

#[cfg(test)]
mod tests {
    use super::GALLERY;
    use std::path::Path;

    #[test]
    fn every_case_says_what_it_is_and_what_to_look_at() {
        for (name, case) in GALLERY {
            let lines: Vec<&str> = case.lines().take(2).collect();
            assert!(lines[0].starts_with("# ") && lines[0].ends_with('.'), "{name}");
            assert!(lines[1].starts_with("# Look at: "), "{name}");
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/gallery");
        let files = std::fs::read_dir(folder).unwrap().flatten();
        let cases = files.filter(|file| file.path().extension().is_some_and(|e| e == "toml"));
        assert_eq!(cases.count(), GALLERY.len(), "every case of the gallery can be written");
    }
}
