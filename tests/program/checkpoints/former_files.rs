//! Checkpoints that former versions of Talcum wrote can be restarted.

use super::forge;
use crate::launch::{in_repository, talcum};
use hdf5::types::VarLenUnicode;
use std::path::Path;
use talcum::output::checkpoint::{newest_good, read};
use talcum::parallel::OneRank;

/// The digest of each file in `checkpoints`, one for each version of the schema, and of the run that continues from it to t = 2.5;
/// commit c075153 found them, whose program wrote the files of versions 4 to 6. Those of versions 1 to 3 were made from its files by
/// taking away what later versions brought.
const OLD_FILES: [[&str; 2]; 6] = [
    ["70e45156e11fc25bdbcf23b01b4af4a4", "31e8439719fb6e0ce61321017154a0eb"],
    ["31b736eb016e45f444c008c212ef2849", "9d6b7ca2103c46ad7738fac0be85f9cc"],
    ["31b736eb016e45f444c008c212ef2849", "9d6b7ca2103c46ad7738fac0be85f9cc"],
    ["1eda81a9dad360cab7d1bccee71707d8", "afd9b17e8e794ecbbcb3979dc5122bb7"],
    ["e66fcf33321117df8cb672c855daae08", "82cd92a1d1b7bc59e01aef72a9562e5b"],
    ["0ea1cb43921dda58c4ba53e45763fb26", "a840f2833abb111090d6ed22567cb028"],
];

#[test]
fn files_of_all_schema_versions_restart() {
    let folder = tempfile::tempdir().unwrap();
    for (digests, version) in OLD_FILES.iter().zip(1..) {
        let file = in_repository(&format!("tests/program/checkpoints/version-{version}.h5"));
        let (found, _, digest) = read(&file, &OneRank).unwrap();
        assert_eq!((digest.to_string().as_str(), found.particles.len()), (digests[0], 24));
        assert_eq!(found.looked_at.is_some(), version == 6);
        let results = folder.path().join(version.to_string()).display().to_string();
        let ended = talcum(
            version % 2,
            &[
                "restart",
                &file.display().to_string(),
                "--output",
                &results,
                "--set",
                "time.end=2.5",
            ],
        );
        assert_eq!(ended.digest(), digests[1], "version {version}");
    }
}

#[test]
fn a_checkpoint_whose_case_has_a_former_name_restarts() {
    let folder = tempfile::tempdir().unwrap();
    let in_folder = |name: &str| folder.path().join(name).display().to_string();
    let case = in_repository("tests/cases/good/adhesive-elastic-plastic.toml");
    let case = case.display().to_string();
    talcum(1, &["run", &case, "--until", "0.05", "--output", &in_folder("first")]).digest();
    let (first, ..) = newest_good(Path::new(&in_folder("first")), &OneRank).unwrap().found.unwrap();
    let restarted = |output: &str, more: &[&str]| {
        let (file, output) = (first.display().to_string(), in_folder(output));
        let restart = ["restart", &file, "--until", "0.06", "--output", &output];
        talcum(1, &[&restart, more].concat())
    };
    let expected = restarted("present", &[]).digest();
    forge(&first, |file| {
        let text = file.attr("case").unwrap().read_scalar::<VarLenUnicode>().unwrap();
        let former: VarLenUnicode =
            text.replace("adhesion_over_weight", "bond_number").parse().unwrap();
        assert_ne!(former, text, "the control: the name is in it");
        file.attr("case").unwrap().write_scalar(&former).unwrap();
        let hash: VarLenUnicode =
            blake3::hash(former.as_bytes()).to_hex().to_string().parse().unwrap();
        file.attr("case_blake3").unwrap().write_scalar(&hash).unwrap();
    });
    assert_eq!(restarted("former", &[]).digest(), expected);
    // What the user writes now is another matter.
    let refused = restarted("set", &["--set", "contact.bond_number=10"]);
    assert!(refused.errors.contains("is now contact.adhesion_over_weight"), "{}", refused.errors);
}
