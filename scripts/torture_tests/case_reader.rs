//! Reads many cases in one process, for scripts/torture. Each line of the input is a request in JSON:
//! `{"text": ..., "folder": ..., "set": [...]}` reads a case, makes its bed and does a few steps; `{"seal": PATH}` gives a file
//! the checksum of a checkpoint; `{"law": ..., "number": ..., "beyond": ..., "ranks": ..., "ledger": ...}` runs a bed with an odd
//! contact law. Each answer is a line: `taken`, `refused` or `panic`, and what was said.

mod odd_laws;

use serde_json::{Value, json};
use std::fs::OpenOptions;
use std::io::{BufRead, Write};
use std::panic::catch_unwind;
use std::path::Path;
use talcum::case::{Amount, BedStart, Case};
use talcum::parallel::OneRank;
use talcum::simulation::{InitialState, start_from_case};
use talcum::time_step::{self, Staggered};
use xxhash_rust::xxh3::xxh3_128;

/// A larger bed is legal, and costs what it costs: it is read and not made.
const MOST_PARTICLES: f64 = 5.0e3;
/// The same for cells of a gas.
const MOST_CELLS: f64 = 2.0e4;
/// Steps of a good case.
const STEPS: u32 = 3;
/// Mark of a checksum, as in `output/checksum.rs`.
const MARK: &[u8] = b"\nTalcum seal  2\n";
/// Bytes that are hashed as one there.
const BLOCK: usize = 1 << 22;

fn main() -> std::io::Result<()> {
    // Panics are answers here, not messages.
    std::panic::set_hook(Box::new(|_| {}));
    for line in std::io::stdin().lock().lines() {
        let request: Value = serde_json::from_str(&line?)?;
        let (outcome, message) = match request["seal"].as_str() {
            Some(path) => seal(Path::new(path)).map(|()| ("sealed", String::new()))?,
            None => answer(&request),
        };
        println!("{}", json!({ "outcome": outcome, "message": message }));
        std::io::stdout().flush()?;
    }
    Ok(())
}

/// How a case goes.
fn answer(request: &Value) -> (&'static str, String) {
    let attempt = if request["law"].is_string() { odd_laws::try_law } else { try_case };
    match catch_unwind(|| attempt(request)) {
        Ok(Ok(message)) => ("taken", message),
        Ok(Err(message)) => ("refused", message),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().cloned();
            let fixed = || panic.downcast_ref::<&str>().map(ToString::to_string);
            ("panic", text.or_else(fixed).unwrap_or_default())
        }
    }
}

/// Reads a case and tries it.
fn try_case(request: &Value) -> Result<String, String> {
    let text = |name: &str| request[name].as_str().unwrap_or_default().to_owned();
    let set: Vec<String> = request["set"].as_array().map_or_else(Vec::new, |set| {
        set.iter().filter_map(Value::as_str).map(str::to_owned).collect()
    });
    let folder = text("folder");
    let read = Case::from_text(&text("text"), "case.toml", Path::new(&folder), &set);
    let case = read.map_err(|errors| errors.to_string())?;
    if particles(&case) > MOST_PARTICLES || cells(&case) > MOST_CELLS {
        return Ok("large".to_owned());
    }
    let mut initial =
        start_from_case(&case, None, &OneRank).map_err(|error| format!("bed: {error}"))?;
    Ok(do_steps(&case, &mut initial).map_or_else(|error| error.to_string(), |()| String::new()))
}

/// Particles that a case asks for, at most.
fn particles(case: &Case) -> f64 {
    let lengths = case.domain.bounds.lengths();
    match (case.particles.amount, &case.particles.start) {
        (Some(Amount::Count(count)), _) => count as f64,
        (Some(Amount::FillHeight(height)), BedStart::Lattice { .. } | BedStart::Random { .. }) => {
            let smallest = case.size_range().map_or(0.0, |sizes| sizes.smallest_diameter);
            lengths.x * lengths.y * height.min(lengths.z) / smallest.powi(3)
        }
        _ => 0.0,
    }
}

fn cells(case: &Case) -> f64 {
    let count = |counts: [usize; 3]| counts.iter().map(|&count| count as f64).product();
    case.volume_averaged().map_or(0.0, |model| count(model.grid.counts()))
}

/// The first steps of a case.
fn do_steps(case: &Case, initial: &mut InitialState) -> Result<(), time_step::StepError> {
    let InitialState { state, work, histories, .. } = initial;
    let models = case.stages[0].models(&state.sizes);
    work.prepare(&case.domain, &models, &state.sizes);
    let histories = std::mem::take(histories);
    time_step::begin(state, &case.domain, &models, work, histories, &OneRank)?;
    time_step::find_first_forces(state, &case.domain, &models, work, &OneRank);
    let mut state = Staggered::new(state);
    for _ in 0..STEPS {
        time_step::advance(&mut state, &case.domain, &models, work, &OneRank)?;
    }
    Ok(())
}

/// Puts a checksum at the end of a file in the place of an earlier one.
fn seal(path: &Path) -> std::io::Result<()> {
    let mut bytes = std::fs::read(path)?;
    if let Some(at) = bytes.windows(MARK.len()).rposition(|window| window == MARK) {
        // Only at the end it is a checksum.
        if at + MARK.len() + 24 == bytes.len() {
            bytes.truncate(at);
        }
    }
    let hashes: Vec<u8> =
        bytes.chunks(BLOCK).flat_map(|block| xxh3_128(block).to_be_bytes()).collect();
    let hash = xxh3_128(&hashes).to_be_bytes();
    let length = (bytes.len() as u64).to_le_bytes();
    let mut file = OpenOptions::new().write(true).truncate(true).open(path)?;
    file.write_all(&bytes)?;
    file.write_all(&[MARK, &length, &hash].concat())
}
