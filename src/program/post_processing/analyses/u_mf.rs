//! Minimum fluidisation velocity from ramps of the superficial gas velocity.

use crate::post_processing::evenly_spaced::nearest;
use crate::post_processing::{Analysis, Findings, Kind, Results, Unmeasured, Value};
use talcum_engine::fields::{Column, Unit};
use talcum_results::analysis::NoValue;
use talcum_results::analysis::bed_height::{BedHeightOptions, Profile, bulk_solids_fraction};
use talcum_results::analysis::minimum_fluidisation::{
    Branch, Fit, Ramp, Series, minimum_fluidisation, ratio_to_balance,
};
use talcum_results::output::{ColumnUnits, ResultTable};
use talcum_runs::case::{Case, Stage};

pub(super) const ANALYSIS: Analysis = Analysis {
    name: "u_mf",
    title: "Minimum fluidisation velocity",
    scalars: || {
        let ramps = [&UP, &DOWN].into_iter().flat_map(RampKinds::all);
        [U_MF].into_iter().chain(ramps).chain([HYSTERESIS, DROP_HYSTERESIS]).collect()
    },
    of_case: |_| Ok(()),
    find,
};

const U_MF: Kind = Kind::number(
    "",
    Unit::Speed,
    "U_mf of the ramp up, or of the ramp down if that one alone gives it",
);
const HYSTERESIS: Kind = Kind::number("hysteresis", Unit::Speed, "U_mf up less U_mf down");
const DROP_HYSTERESIS: Kind = Kind::number(
    "drop_hysteresis",
    Unit::One,
    "largest difference of the pressure drops, up less down, over the weight, below both U_mf",
);

/// The numbers of one ramp.
struct RampKinds {
    table: &'static str,
    fit_table: &'static str,
    velocity: Kind,
    plateau: Kind,
    overshoot: Kind,
    solids_fraction: Kind,
    balance: Kind,
    ratio: Kind,
}

/// Defines the numbers of a ramp from its name.
macro_rules! ramp {
    ($way:literal) => {
        RampKinds {
            table: concat!("u_mf/", $way),
            fit_table: concat!("u_mf/fit_", $way),
            velocity: Kind::number($way, Unit::Speed, concat!("U_mf of the ramp ", $way)),
            plateau: Kind::number(
                concat!($way, "_plateau"),
                Unit::One,
                "pressure drop of the fluidised bed over the weight",
            ),
            overshoot: Kind::number(
                concat!($way, "_overshoot"),
                Unit::One,
                "highest pressure drop less the plateau, over the weight",
            ),
            solids_fraction: Kind::number(
                concat!($way, "_solids_fraction"),
                Unit::One,
                "of the bulk of the packed bed, where its pressure drop is fitted",
            ),
            balance: Kind::number(
                concat!($way, "_balance"),
                Unit::Speed,
                "U_mf of the force balance by the case's drag law at that solids fraction",
            ),
            ratio: Kind::number(
                concat!($way, "_ratio"),
                Unit::One,
                "U_mf over that of the force balance",
            ),
        }
    };
}

const UP: RampKinds = ramp!("up");
const DOWN: RampKinds = ramp!("down");

impl RampKinds {
    fn all(&self) -> [Kind; 6] {
        let Self { velocity, plateau, overshoot, solids_fraction, balance, ratio, .. } = self;
        [*velocity, *plateau, *overshoot, *solids_fraction, *balance, *ratio]
    }
}

fn find(results: &Results) -> Result<Findings, Unmeasured> {
    let (velocities, drops) =
        (results.column("superficial_velocity")?, results.column("grid_pressure_drop")?);
    let heights: Vec<f64> =
        results.column("centre_height")?.iter().map(|centre| 2.0 * centre).collect();
    let mut found = Findings::new(results.units());
    let bulk = bulk(results);
    if let Err(Unmeasured::Unreadable(error)) = &bulk {
        return Err(error.clone().into());
    }
    if let Err(Unmeasured::Nothing(reason)) = &bulk {
        found.note(format!("of the solids fraction of the bulk {reason}"));
    }
    let series = Series {
        velocities: &velocities,
        pressure_drops: &drops,
        bed_heights: Some(&heights),
        solids_fractions: bulk.as_deref().ok(),
    };
    let ramps = minimum_fluidisation(&series)?;
    let fit_of = |ramp: &Result<Ramp, NoValue>| ramp.clone().and_then(|ramp| ramp.fit);
    let (up, down) = (fit_of(&ramps.up), fit_of(&ramps.down));
    found.add(
        &U_MF,
        up.clone().or_else(|reason| down.clone().map_err(|_| reason)).map(|fit| fit.velocity),
    );
    for (kinds, ramp, fit) in [(&UP, &ramps.up, &up), (&DOWN, &ramps.down, &down)] {
        add_ramp(&mut found, kinds, fit, results);
        if let Ok(Ramp { branch, .. }) = ramp {
            found.tables.push(points(kinds, branch, results.units()));
        }
        if let Ok(fit) = fit {
            found.tables.push(fit_table(kinds, fit, results.units()));
        }
    }
    found.add(&HYSTERESIS, ramps.hysteresis.clone().map(|both| both.velocity));
    found.add(&DROP_HYSTERESIS, ramps.hysteresis.map(|both| both.pressure_drop));
    Ok(found)
}

/// The solids fraction of the bulk at the times of the series, from the nearest profiles.
fn bulk(results: &Results) -> Result<Vec<f64>, Unmeasured> {
    let profiles = results.whole_profiles()?;
    let threshold = results.case()?.output.bed_threshold;
    let options = BedHeightOptions { threshold, ..BedHeightOptions::default() };
    let spacing = match profiles.heights[..] {
        [first, second, ..] => second - first,
        _ => 0.0,
    };
    let of_row = |row: usize| {
        let profile = Profile { solids_fractions: profiles.solids_fraction(row), spacing };
        bulk_solids_fraction(&profile, &options)
    };
    let rows: Vec<Result<f64, NoValue>> = (0..profiles.times.len()).map(of_row).collect();
    match rows.iter().find(|row| row.is_ok()).or(rows.first()) {
        None => return Err(NoValue::because("profiles.h5 holds no results yet").into()),
        Some(Err(reason)) => return Err(reason.clone().into()),
        Some(Ok(_)) => {}
    }
    // There is no number if a bed in motion has no bulk; it is needed only for the packed bed.
    let bulk = |time: &f64| rows[nearest(&profiles.times, *time)].clone().unwrap_or(f64::NAN);
    Ok(results.column("time")?.iter().map(bulk).collect())
}

fn add_ramp(
    found: &mut Findings,
    kinds: &RampKinds,
    fit: &Result<Fit, NoValue>,
    results: &Results,
) {
    let of = |value: &dyn Fn(&Fit) -> Value| match fit {
        Ok(fit) => value(fit),
        Err(reason) => Value::Nothing(reason.clone()),
    };
    let unknown = || NoValue::because("the solids fraction of the bulk is unknown");
    found.add(&kinds.velocity, of(&|fit| fit.velocity.into()));
    found.add(&kinds.plateau, of(&|fit| fit.plateau.into()));
    found.add(&kinds.overshoot, of(&|fit| (fit.peak - fit.plateau.value).into()));
    found.add(&kinds.solids_fraction, of(&|fit| fit.solids_fraction.ok_or_else(unknown).into()));
    let balance = |fit: &Fit| {
        let phi = fit.solids_fraction.ok_or_else(unknown)?.value;
        let (case, stage) = gas_stage(results)?;
        case.minimum_fluidisation(stage, phi).ok_or_else(no_balance)
    };
    found.add(&kinds.balance, of(&|fit| balance(fit).into()));
    let ratio = |fit: &Fit| {
        let (case, stage) = gas_stage(results)?;
        ratio_to_balance(fit, |phi| case.minimum_fluidisation(stage, phi).unwrap_or(f64::NAN))
    };
    found.add(&kinds.ratio, of(&|fit| ratio(fit).into()));
}

fn no_balance() -> NoValue {
    NoValue::because("there is no gas or no gravity to balance")
}

/// The last stage with a gas among those in the window.
fn gas_stage(results: &Results) -> Result<(&Case, &Stage), NoValue> {
    let nothing = |why: Unmeasured| match why {
        Unmeasured::Nothing(reason) => reason,
        Unmeasured::Unreadable(error) => NoValue::because(error.to_string()),
    };
    let case = results.case().map_err(nothing)?;
    let stages = results.stages().map_err(nothing)?;
    let with_gas = stages.filter(|stage| case.minimum_fluidisation(stage, 0.5).is_some());
    Ok((case, with_gas.last().ok_or_else(no_balance)?))
}

fn points(kinds: &RampKinds, branch: &Branch, units: ColumnUnits) -> ResultTable {
    let velocities = branch.velocities.clone();
    let mut columns = vec![
        Column::numbers("superficial_velocity", units.of(Unit::Speed), "of the gas", velocities),
        Column::numbers("pressure_drop", "1", "over the weight", branch.pressure_drops.clone()),
    ];
    columns.extend(branch.bed_heights.clone().map(|heights| {
        Column::numbers(
            "bed_height",
            units.of(Unit::Length),
            "twice that of the centre of mass",
            heights,
        )
    }));
    columns.extend(
        branch
            .solids_fractions
            .clone()
            .map(|fractions| Column::numbers("solids_fraction", "1", "of the bulk", fractions)),
    );
    ResultTable::new(kinds.table, columns)
}

/// A table for plotting the fit: dp = linear U + quadratic U^2 up to U_mf, and the plateau beyond.
fn fit_table(kinds: &RampKinds, fit: &Fit, units: ColumnUnits) -> ResultTable {
    let one = |name: &str, unit: &str, about: &str, value: f64| {
        Column::numbers(name, unit, about, vec![value])
    };
    let per_speed = format!("1/({})", units.of(Unit::Speed));
    let columns = vec![
        one("velocity", units.of(Unit::Speed), "U_mf", fit.velocity.value),
        one("velocity_error", units.of(Unit::Speed), "its standard error", fit.velocity.error),
        one("linear", &per_speed, "a of dp = a U + b U^2, over the weight", fit.linear),
        one("quadratic", &format!("{per_speed}^2"), "b, likewise", fit.quadratic),
        one("determination", "1", "R^2 of the packed bed's points", fit.determination),
        one("plateau", "1", "over the weight", fit.plateau.value),
        one("peak", "1", "highest pressure drop over the weight", fit.peak),
        one("peak_velocity", units.of(Unit::Speed), "of that peak", fit.peak_velocity),
    ];
    ResultTable::new(kinds.fit_table, columns)
}
