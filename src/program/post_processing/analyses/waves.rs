//! Waves of the solids fraction: the states of the bed over height and time, and the properties of the waves.

use crate::post_processing::evenly_spaced::EvenRows;
use crate::post_processing::result_file::ResultFile;
use crate::post_processing::{Analysis, Findings, Kind, Results, Unmeasured, Value};
use talcum_engine::fields::{Column, Unit};
use talcum_results::analysis::NoValue;
use talcum_results::analysis::waves::{
    BedState, Cell, Front, SolidsFractionField, State, StateShares, WaveMap, WaveOptions, Waves,
    map_waves,
};
use talcum_results::output::{Cells, ColumnUnits, ResultTable};

pub(super) const ANALYSIS: Analysis = Analysis {
    name: "waves",
    title: "Waves of the solids fraction over height and time",
    scalars: || {
        vec![
            STATE,
            SPEED,
            PERIOD,
            WAVELENGTH,
            AMPLITUDE,
            LOWEST,
            HIGHEST,
            VOID_SPEED,
            VOID_SPACING,
            FRONT_SPEED,
            RISE,
            SHARE,
            SWEPT,
            FROZEN,
            PLUG,
            DISORDERED,
        ]
    },
    of_case: |case| ResultFile::Profiles.require_of(case),
    find,
};

const STATES: [&str; 6] =
    ["waves", "waves_in_part", "intermittent", "frozen", "rising_plug", "disordered"];
const STATE: Kind = Kind::text("state", &STATES, "what the bed does as a whole");
const SPEED: Kind = Kind::number("speed", Unit::Speed, "of the waves, positive if they rise");
const PERIOD: Kind = Kind::number("period", Unit::Time, "time after which the pattern repeats");
const WAVELENGTH: Kind = Kind::number("wavelength", Unit::Length, "speed times period");
const AMPLITUDE: Kind = Kind::number(
    "amplitude",
    Unit::One,
    "of the sine that has the variance of the travelling pattern",
);
const LOWEST: Kind =
    Kind::number("lowest", Unit::One, "1 % of the solids fractions in the waves are below");
const HIGHEST: Kind =
    Kind::number("highest", Unit::One, "99 % of the solids fractions there are below");
const VOID_SPEED: Kind = Kind::number("void_speed", Unit::Speed, "of voids that were followed");
const VOID_SPACING: Kind =
    Kind::number("void_spacing", Unit::Length, "distance between neighbouring voids");
const FRONT_SPEED: Kind = Kind::number(
    "front_speed",
    Unit::Speed,
    "of the front between waves and still bed, negative if it descends",
);
const RISE: Kind =
    Kind::number("plug_speed", Unit::Speed, "mean velocity of the material in rising plugs");
const SHARE: Kind = Kind::number(
    "share",
    Unit::One,
    "part of the bed's heights and times with waves, all over or here and there",
);
const SWEPT: Kind = Kind::number(
    "swept_share",
    Unit::One,
    "part of the bed's material that waves sweep in the record, periodic or not",
);
const FROZEN: Kind = Kind::number("frozen_share", Unit::One, "part that stands still");
const PLUG: Kind = Kind::number("plug_share", Unit::One, "part that rises as a plug");
const DISORDERED: Kind =
    Kind::number("disordered_share", Unit::One, "part that moves without waves");

fn find(results: &Results) -> Result<Findings, Unmeasured> {
    let profiles = results.profiles()?;
    let even = EvenRows::of(&profiles.times)?;
    let rows = even.rows.iter().flat_map(|&row| profiles.solids_fraction(row));
    let values: Vec<f64> = rows.copied().collect();
    let heights = &profiles.heights;
    let field = SolidsFractionField {
        values: &values,
        heights: heights.len(),
        lowest: heights[0],
        spacing: heights.get(1).map_or(0.0, |second| second - heights[0]),
        start: even.start,
        interval: even.interval,
    };
    let vibration_frequency = vibration_frequency(results)?;
    let options = WaveOptions { vibration_frequency, ..WaveOptions::default() };
    let map = map_waves(&field, &options)?;
    let units = results.units();
    let mut found = Findings::new(units);
    add_waves(&mut found, &map);
    add_shares(&mut found, &map);
    found.note(format!(
        "windows of {:.4} {} and {:.4} {}",
        map.window_height,
        units.of(Unit::Length),
        map.window_duration,
        units.of(Unit::Time)
    ));
    found.notes.extend(where_and_when(&map, units));
    if let Some(frequency) = vibration_frequency {
        found.note(format!(
            "the swing of the bed on its plate, {frequency:.6} per time, was taken out"
        ));
    }
    found.tables = vec![windows(&map, units), heights_table(&map, units), times(&map, units)];
    found.tables.extend(map.front.as_ref().ok().map(|front| front_table(front, units)));
    Ok(found)
}

/// The frequency of the plate in the stages of the window; `None` if it is at rest in one of them.
fn vibration_frequency(results: &Results) -> Result<Option<f64>, Unmeasured> {
    let mut found = None;
    for stage in results.stages()? {
        let Some(vibration) = stage.physics.gravity.vibration else { return Ok(None) };
        found = Some(vibration.frequency);
    }
    Ok(found)
}

fn add_waves(found: &mut Findings, map: &WaveMap) {
    found.add(&STATE, Value::Text(name_of(map.state)));
    let of = |value: &dyn Fn(&Waves) -> Value| match &map.waves {
        Ok(waves) => value(waves),
        Err(reason) => Value::Nothing(reason.clone()),
    };
    found.add(&SPEED, of(&|waves| waves.speed.into()));
    found.add(&PERIOD, of(&|waves| waves.period.clone().into()));
    found.add(&WAVELENGTH, of(&|waves| waves.wavelength.clone().into()));
    found.add(&AMPLITUDE, of(&|waves| waves.amplitude.into()));
    found.add(&LOWEST, of(&|waves| waves.lowest.into()));
    found.add(&HIGHEST, of(&|waves| waves.highest.into()));
    found.add(&VOID_SPEED, map.voids.as_ref().map(|voids| voids.speed).map_err(Clone::clone));
    found.add(&VOID_SPACING, map.voids.as_ref().map(|voids| voids.spacing).map_err(Clone::clone));
    found.add(&FRONT_SPEED, map.front.as_ref().map(|front| front.speed).map_err(Clone::clone));
}

fn add_shares(found: &mut Findings, map: &WaveMap) {
    let plugs = map.cells.iter().filter(|cell| cell.state == State::RisingPlug);
    let rises: Vec<f64> = plugs.map(|cell| cell.material_velocity.value).collect();
    let rise = match rises.len() {
        0 => Value::Nothing(NoValue::because("no plug rises")),
        count => (rises.iter().sum::<f64>() / count as f64).into(),
    };
    found.add(&RISE, rise);
    found.add(&SHARE, map.shares.waves + map.shares.intermittent);
    found.add(&SWEPT, map.swept_share);
    found.add(&FROZEN, map.shares.frozen);
    found.add(&PLUG, map.shares.rising_plug);
    found.add(&DISORDERED, map.shares.disordered);
}

/// Range of heights with waves for at least half of the time, and range of times with waves in at least half of the
/// bed.
fn where_and_when(map: &WaveMap, units: ColumnUnits) -> [String; 2] {
    let ends = |mut places: Vec<f64>| {
        places.sort_by(f64::total_cmp);
        Some([*places.first()?, *places.last()?])
    };
    let heights = map.heights.iter().filter(|height| height.waves_share >= 0.5);
    let in_half = |shares: &StateShares| shares.waves + shares.intermittent >= 0.5;
    let times = map.times.iter().filter(|time| in_half(&time.shares));
    let heights = match ends(heights.map(|height| height.height).collect()) {
        Some([low, high]) => {
            format!("at heights from {low:.4} to {high:.4} {}", units.of(Unit::Length))
        }
        None => "at no height".to_owned(),
    };
    let times = match ends(times.map(|time| time.time).collect()) {
        Some([first, last]) => {
            format!("at times from {first:.4} to {last:.4} {}", units.of(Unit::Time))
        }
        None => "at no time".to_owned(),
    };
    [
        format!("where: waves for half of the time or more {heights} (middles of windows)"),
        format!("when: waves in half of the bed or more {times} (middles of windows)"),
    ]
}

fn name_of(state: BedState) -> &'static str {
    let place = match state {
        BedState::Waves => 0,
        BedState::WavesInPart => 1,
        BedState::Intermittent => 2,
        BedState::Frozen => 3,
        BedState::RisingPlug => 4,
        BedState::Disordered => 5,
    };
    STATES[place]
}

/// A table of the windows that the bed fills.
fn windows(map: &WaveMap, units: ColumnUnits) -> ResultTable {
    let filled: Vec<_> = map.cells.iter().filter(|cell| cell.state != State::Empty).collect();
    let numbers = |name: &str, unit: &str, about: &str, of: &dyn Fn(&Cell) -> f64| {
        Column::numbers(name, unit, about, filled.iter().map(|cell| of(cell)).collect())
    };
    let state = |state: State| match state {
        State::Empty => "empty",
        State::Waves => "waves",
        State::Intermittent => "intermittent",
        State::Frozen => "frozen",
        State::RisingPlug => "rising_plug",
        State::Disordered => "disordered",
    };
    let states = filled.iter().map(|cell| state(cell.state).to_owned()).collect();
    let size = |length: f64| vec![length; filled.len()];
    let columns = vec![
        numbers("height", units.of(Unit::Length), "of the window's middle", &|cell| cell.height),
        numbers("time", units.of(Unit::Time), "of the window's middle", &|cell| cell.time),
        Column::numbers(
            "window_height",
            units.of(Unit::Length),
            "its height",
            size(map.window_height),
        ),
        Column::numbers(
            "window_duration",
            units.of(Unit::Time),
            "its duration",
            size(map.window_duration),
        ),
        Column::new("state", "what the bed does there", Cells::Text(states)),
        numbers("speed", units.of(Unit::Speed), "of the pattern, if one travels", &|cell| {
            cell.speed.unwrap_or(f64::NAN)
        }),
        numbers("material_velocity", units.of(Unit::Speed), "from the balance of mass", &|cell| {
            cell.material_velocity.value
        }),
        numbers("deviation", "1", "standard deviation over time", &|cell| cell.deviation),
        numbers("travelling_share", "1", "part of the variance that travels", &|cell| {
            cell.travelling_share
        }),
        numbers("chance", "1", "probability of such a pattern in noise", &|cell| cell.chance),
        numbers(
            "active_share",
            "1",
            "part of its heights and times that vary as waves do",
            &|cell| cell.active_share,
        ),
    ];
    ResultTable::new("waves/windows", columns)
}

fn heights_table(map: &WaveMap, units: ColumnUnits) -> ResultTable {
    let heights = map.heights.iter().map(|height| height.height).collect();
    let shares = map.heights.iter().map(|height| height.waves_share).collect();
    let changes = map.heights.iter().map(|height| height.changes as u64).collect();
    let columns = vec![
        Column::numbers("height", units.of(Unit::Length), "of the windows' middle", heights),
        Column::numbers("waves_share", "1", "part of the time with waves", shares),
        Column::new("changes", "how often waves began or ended", Cells::Whole(changes)),
    ];
    ResultTable::new("waves/heights", columns)
}

fn times(map: &WaveMap, units: ColumnUnits) -> ResultTable {
    let times = map.times.iter().map(|time| time.time).collect();
    let share = |name: &str, of: fn(&StateShares) -> f64| {
        let values = map.times.iter().map(|time| of(&time.shares)).collect();
        Column::numbers(name, "1", "part of the bed in this state", values)
    };
    let columns = vec![
        Column::numbers("time", units.of(Unit::Time), "of the windows' middle", times),
        share("waves", |shares| shares.waves),
        share("intermittent", |shares| shares.intermittent),
        share("frozen", |shares| shares.frozen),
        share("rising_plug", |shares| shares.rising_plug),
        share("disordered", |shares| shares.disordered),
    ];
    ResultTable::new("waves/times", columns)
}

fn front_table(front: &Front, units: ColumnUnits) -> ResultTable {
    let below = vec![u64::from(front.waves_below); front.times.len()];
    let columns = vec![
        Column::numbers(
            "time",
            units.of(Unit::Time),
            "at which a height parts the bed",
            front.times.clone(),
        ),
        Column::numbers("height", units.of(Unit::Length), "of the front", front.heights.clone()),
        Column::new("waves_below", "1 if the waves are below it", Cells::Whole(below)),
    ];
    ResultTable::new("waves/front", columns)
}
