//! Invalid studies are rejected with file, line, key, value and the allowed values.

use super::fakes::{CASE, Desk};

const AXIS: &str = "[[axis]]\nkey = \"cohesion.bond_number\"\nvalues = [2, 4]\n";

/// Studies and the errors with which they are rejected; their lines 1 and 2 are the title and the case.
const REFUSED: &[(&str, &str)] = &[
    ("seed = 5\n", "study.toml:3: seed = 5: unknown key: did you mean seeds?"),
    ("seeds = 0\n", "study.toml:3: seeds = 0: must be between 1 and 10000"),
    ("seeds = []\n", "study.toml:3: seeds = []: must not be empty"),
    ("seeds = [4, 4]\n", "study.toml:3: particles.seed: has the same values twice"),
    ("confidence = 95\n", "study.toml:3: confidence = 95: must be at least 0.5 and at most 0.999"),
    (
        "[[axis]]\nkey = \"cohesion.bond_number\"\nvalues = []\n",
        "study.toml:5: axis.1.values = []: must not be empty",
    ),
    (
        "[[axis]]\nkey = \"cohesion.bond_number\"\nvalues = [4, 4.0]\n",
        "study.toml:3: cohesion.bond_number: has the same values twice",
    ),
    (
        "[[axis]]\nkey = \"cohesion.bond_number\"\n",
        "study.toml:3: axis.1.values: missing: give values or range",
    ),
    (
        "[[axis]]\nkey = \"cohesion.bond_number\"\nrange = { from = 0, to = 1, step = -1 }\n",
        "axis.1.range.step = -1: must lead from 0 to 1",
    ),
    (
        "[[axis]]\nkeys = [\"a.b\", \"c.d\"]\nvalues = [[1, 2], [3]]\n",
        "axis.1.values.2 = [3]: must have 2 values, one for each of keys",
    ),
    (
        "[set]\ncohesion.bond_number = 3\n[[axis]]\nkey = \"cohesion.bond_number\"\nvalues = [2, 4]\n",
        "study.toml:5: cohesion.bond_number: is already set at line 4",
    ),
    (
        "[[axis]]\nkey = \"cohesion.bond_numbr\"\nvalues = [2, 4]\n",
        "study.toml:3: cohesion.bond_numbr = 2: unknown key",
    ),
    (
        "[[axis]]\nkey = \"cohesion.bond_number\"\nvalues = [2, -4]\n",
        "study.toml:3: cohesion.bond_number = -4: must be at least 0",
    ),
    (
        "[measure.x]\ncolumn = \"bed_tip\"\nstatistic = \"mean\"\n",
        "study.toml:4: measure.x.column = \"bed_tip\": no such column: did you mean bed_top?",
    ),
    (
        "[measure.x]\nsource = \"analyse\"\n",
        "measure.x.source = \"analyse\": must be \"series\" or \"case\" or \"analysis\"; did you mean \"analysis\"?",
    ),
    (
        "[measure.x]\ncolumn = \"bed_top\"\nstatistic = \"median\"\n",
        "measure.x.statistic = \"median\": must be \"mean\" or \"last\" or \"max\"",
    ),
    (
        "[measure.x]\ncolumn = \"bed_top\"\nstatistic = \"mean\"\nwindow = { from = 50 }\n",
        "study.toml:3: measure.x: the window begins at 50, but the run ends at 4",
    ),
    (
        "measures = [\"bed.height\", \"waves.sped\"]\n",
        "study.toml:3: measures.2 = \"waves.sped\": no such quantity: did you mean waves.speed?",
    ),
    (
        "measures = [\"bed.height\", \"bed.height\"]\n",
        "study.toml:3: measures.2 = \"bed.height\": is listed twice",
    ),
    (
        "[measure.x]\nsource = \"analysis\"\nquantity = \"bed.hight\"\n",
        "study.toml:5: measure.x.quantity = \"bed.hight\": no such quantity: did you mean bed.height?",
    ),
    (
        "[measure.x]\nsource = \"analysis\"\nquantity = \"u_mf\"\nwindow = { from = 50 }\n",
        "study.toml:3: measure.x: the window begins at 50, but the run ends at 4",
    ),
    (
        "measures = [\"bubbles.rise_velocity\"]\n",
        "study.toml:3: measure.bubbles.rise_velocity: no run can give it: there is no gas",
    ),
    (
        "[measure.x]\nsource = \"case\"\nmeasure = \"net\"\ncolumn = \"contacts\"\nstatistic = \"mean\"\n",
        "study.toml:3: measure.x: the case has no [measure.net]: did you mean network?",
    ),
    (
        "[measure.x]\nsource = \"case\"\nmeasure = \"network\"\ncolumn = \"mean_ages\"\nstatistic = \"mean\"\n",
        "study.toml:3: measure.x: the instrument network has no number mean_ages: did you mean mean_age?",
    ),
    (
        "[measure.x]\nsource = \"case\"\nmeasure = \"network\"\nstatistic = \"mean\"\n",
        "study.toml:3: measure.x.column: missing: must be a text in quotes (A number that this instrument gives",
    ),
    (
        "[measure.state]\ncolumn = \"bed_top\"\nstatistic = \"mean\"\n",
        "study.toml:3: measure.state: is the name of another column of the tables",
    ),
    ("[run]\nranks = 0\n", "study.toml:4: run.ranks = 0: must be between 1 and 65536"),
    ("[continuation]\naxis = \"x\"\n", "study.toml:4: continuation.axis = \"x\": there is no axis"),
    (
        "[[axis]]\nkey = \"stage.pour.duration\"\nvalues = [2, 4]\n[set]\ntitle.x = 1\n",
        "study.toml:7: title.x=1: title is not a section",
    ),
    ("seeds = 2\nseeds = 3\n", "study.toml:4:1: not valid TOML"),
];

const SEARCH: &str = "[bisection]\nkey = \"cohesion.bond_number\"\nbracket = [1, 9]\ntolerance = 0.5\nmeasure = \"top\"\nthreshold = 5\ndirection = \"falls\"\n";

#[track_caller]
fn assert_refused(study: &str, expected: &str) {
    let refusal = Desk::new(study).refusal();
    assert!(refusal.contains(expected), "{study}\n{refusal}\nexpected {expected}");
}

#[test]
fn bad_studies_are_refused_with_line_key_value_and_what_is_allowed() {
    for (study, expected) in REFUSED {
        assert_refused(study, expected);
    }
}

#[test]
fn bad_searches_and_continuations_are_refused() {
    let search = SEARCH;
    for (study, expected) in [
        (
            format!(
                "{AXIS}[continuation]\naxis = \"cohesion.bond_number\"\nfrom_stage = \"pour\"\n"
            ),
            "bed.toml: it has no stages",
        ),
        (
            search.replace("\"top\"", "\"tip\""),
            "study.toml:7: bisection.measure = \"tip\": no such quantity: did you mean top?",
        ),
        (
            search.replace("\"top\"", "\"waves.state\""),
            "study.toml:8: bisection.threshold = 5: must be a text that waves.state may give: waves, waves_in_part",
        ),
        (
            search.replace("\"top\"", "\"waves.state\"").replace("= 5", "= \"frosen\""),
            "bisection.threshold = \"frosen\": is nothing that waves.state gives: did you mean frozen?",
        ),
        (
            search.replace("= 5", "= \"frozen\""),
            "study.toml:8: bisection.threshold = \"frozen\": must be a number, as top is",
        ),
        (search.replace("0.5", "9"), "study.toml:6: bisection.tolerance = 9: must be below 8"),
        (
            search.replace("[1, 9]", "[9, 1]"),
            "study.toml:5: bisection.bracket = [9, 1]: must be two numbers, the smaller first",
        ),
        (
            search.replace("\"falls\"", "\"down\""),
            "bisection.direction = \"down\": must be \"rises\" or \"falls\"",
        ),
        (
            search.replace("[1, 9]", "[-1, 9]"),
            "study.toml:3: cohesion.bond_number = -1.0: must be at least 0",
        ),
    ] {
        assert_refused(&study, expected);
    }
    let both = format!("{AXIS}[continuation]\naxis = \"cohesion.bond_number\"\n")
        + &search.replace("cohesion.bond_number", "gas.superficial_velocity");
    assert_refused(
        &both,
        "bisection.key = \"gas.superficial_velocity\": cannot be combined with [continuation]",
    );
}

#[test]
fn all_errors_are_reported_together_and_good_studies_pass() {
    let refusal = Desk::new("seeds = 0\nseed = 1\n[run]\nranks = 0\n").refusal();
    assert_eq!(refusal.lines().count(), 3, "{refusal}");
    assert_eq!(Desk::new(&format!("seeds = 2\n{AXIS}")).refusal(), "");
    let by_name = SEARCH.replace("\"top\"", "\"waves.state\"").replace("= 5", "= \"frozen\"");
    assert_eq!(Desk::new(&format!("measures = [\"bed.height\"]\n{by_name}")).refusal(), "");
}

#[test]
fn errors_are_worded_as_those_of_case_files() {
    for (study, expected) in [
        ("[runs]\nranks = 1\n", "study.toml:3: runs: unknown key: did you mean run?"),
        ("[run]\nrank = 1\n", "study.toml:4: run.rank = 1: unknown key: did you mean ranks?"),
        (
            "[measure.x]\nsource = \"analysis\"\nquantity = \"u_mf\"\nstatistic = \"mean\"\n",
            "study.toml:6: measure.x.statistic = \"mean\": cannot be given: source \"analysis\" has no use for it",
        ),
        (
            "[measure.x]\ncolumn = \"bed_top\"\nstatistic = \"mean\"\nwindow = { from = 1, last = 2 }\n",
            "study.toml:6: measure.x.window.last = 2: cannot be given together with from: give one only",
        ),
        (
            "[measure.x]\ncolumn = \"bed_top\"\nstatistic = \"mean\"\nwindow = { from = 2, to = 1 }\n",
            "study.toml:6: measure.x.window.to = 1: must not be before from",
        ),
        (
            "[[axis]]\nkey = \"time.end\"\nrange = { from = 1, to = 2, step = 1, scale = \"logarithmic\" }\n",
            "study.toml:5: axis.1.range.step = 1: cannot be given on a logarithmic scale: give count",
        ),
    ] {
        assert_refused(study, expected);
    }
}

#[test]
fn a_study_that_is_missing_or_measures_nothing_is_refused() {
    let desk = Desk::new("");
    std::fs::write(desk.path("study.toml"), "title = \"t\"\ncase = \"bed.toml\"\n").unwrap();
    assert!(desk.refusal().contains("measure: missing"), "{}", desk.refusal());
    std::fs::remove_file(desk.path("study.toml")).unwrap();
    assert!(desk.refusal().contains("cannot be read"), "{}", desk.refusal());
    let desk = Desk::new("");
    std::fs::remove_file(desk.path("bed.toml")).unwrap();
    assert!(desk.refusal().contains("bed.toml: cannot be read"), "{}", desk.refusal());
}

#[test]
fn two_names_for_one_run_are_refused() {
    // Both axes set the same key: stage 1 is the one named "a".
    let desk = Desk::new(
        "[[axis]]\nkey = \"stage.1.duration\"\nvalues = [1, 2]\n[[axis]]\nkey = \"stage.a.duration\"\nvalues = [1, 2]\n",
    );
    let case = format!("{CASE}[[stage]]\nname = \"a\"\nduration = 1\n");
    std::fs::write(desk.path("bed.toml"), case).unwrap();
    assert!(desk.refusal().contains("are the same run"), "{}", desk.refusal());
}

#[test]
fn seeds_are_refused_where_no_random_numbers_are_drawn() {
    let desk = Desk::new("seeds = 2\n");
    let case = CASE.replace("kind = \"lattice\"", "kind = \"run\"\npath = \"x.h5\"");
    std::fs::write(desk.path("bed.toml"), case).unwrap();
    assert!(desk.refusal().contains("study.toml:3: particles.seed: the seed changes nothing"));
    desk.write(
        "[[axis]]\nreplicate = true\nkeys = [\"particles.seed\", \"particles.start.path\"]\nvalues = [[1, \"x.h5\"], [2, \"y.h5\"]]\n",
    );
    assert_eq!(desk.refusal(), "");
}
