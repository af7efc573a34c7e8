//! Reports of a run at its start and at its end.

use super::progress::readable;
use std::fmt::Write;
use talcum_runs::case::Case;
use talcum_runs::simulation::Outcome;

/// The head of a run: its case, and the choices that the case leaves open.
pub(super) fn head(case: &Case, particles: usize, ranks: usize) -> String {
    let mut message =
        format!("{}: {particles} particles on {}\n", case.title, count_of(ranks, "rank"));
    for stage in &case.stages {
        let _ =
            writeln!(message, "  stage \"{}\": time {} to {}", stage.name, stage.start, stage.end);
    }
    for note in &case.notes {
        let _ = writeln!(message, "  {note}");
    }
    message
}

/// A number of things: 1 rank, 2 ranks.
pub(super) fn count_of(count: usize, thing: &str) -> String {
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
}

/// A number in readable form, to six digits: lengths of a box are rounded to a quantum, 0.002 to 0.0020000000000000018.
pub(super) fn six_digits(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}

/// The end of a run: rates, the share of each phase of the step, and the particles that have left.
pub(super) fn table(outcome: &Outcome, ranks: usize) -> String {
    let seconds = outcome.elapsed.as_secs_f64();
    let rate = outcome.particle_steps / seconds.max(1.0e-9) * 1.0e-6;
    let mut message = format!(
        "{} steps in {}: {rate:.2} million particle-steps/s, {:.2} per rank\n",
        outcome.steps,
        readable(outcome.elapsed.as_secs_f64()),
        rate / ranks as f64
    );
    let total: f64 = outcome.phases.iter().map(|phase| phase.mean).sum();
    let _ = writeln!(
        message,
        "{:<24}{:>10}{:>8}{:>22}",
        "stage", "seconds", "share", "largest over mean"
    );
    for phase in &outcome.phases {
        let imbalance = if phase.mean > 0.0 { phase.largest / phase.mean } else { 1.0 };
        let share = 100.0 * phase.mean / total.max(1.0e-12);
        let _ = writeln!(
            message,
            "{:<24}{:>10.2}{share:>6.1} %{imbalance:>22.2}",
            phase.phase.name(),
            phase.mean
        );
    }
    if outcome.departed > 0 {
        let _ = writeln!(message, "{} particles have left through open faces", outcome.departed);
    }
    message
}

#[cfg(test)]
mod tests {
    use super::six_digits;

    #[test]
    fn numbers_are_printed_to_six_digits_whatever_their_size() {
        let printed =
            [0.0020000000000000018, 123456.789, -1.0, 0.0].map(|x| six_digits(x).to_string());
        assert_eq!(printed, ["0.002", "123457", "-1", "0"]);
        assert!(six_digits(f64::NAN).is_nan());
    }
}
