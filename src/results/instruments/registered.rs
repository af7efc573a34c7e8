//! Properties of a kind of instrument in the registry.

use super::{Instrument, Setting};
use talcum_engine::domain::{Bounds, Vibration};
use talcum_engine::grid::BoxGrid;
use talcum_engine::schema::{Key, KeyValues};
use talcum_engine::state::SizeRange;

/// A kind of instrument of the registry: the settings of one `[measure.NAME]`, as plain data.
pub trait RegisteredInstrument: Sized {
    /// The measured quantities, for the manual.
    const MEANING: &'static str;

    /// Its keys in the case file, besides `kind`, `every` and `start`.
    const KEYS: &'static [Key];

    /// The settings with these values; `None` if one is missing or wrong, which has then been reported.
    fn from_keys(values: &dyn InstrumentValues) -> Option<Self>;

    /// An instrument that has not taken a sample yet.
    fn begin(&self, setting: &Setting<'_>) -> Box<dyn Instrument>;
}

/// The values of an instrument's keys, and other data of the case.
pub trait InstrumentValues: KeyValues {
    /// A whole number, or its default.
    fn count(&self, key: &str) -> Option<u64>;

    /// Whole numbers along x, y and z.
    fn counts(&self, key: &str) -> Option<[usize; 3]>;

    /// A list of numbers.
    fn numbers(&self, key: &str) -> Option<Vec<f64>>;

    /// Reports an error of a key.
    fn fail(&self, key: &'static str, message: String);

    /// The box.
    fn bounds(&self) -> &Bounds;

    /// Sizes of the particles, if the case gives them.
    fn sizes(&self) -> Option<SizeRange>;

    /// The cells of a volume-averaged gas, if the case has one.
    fn gas_grid(&self) -> Option<&BoxGrid>;

    /// The vibration of the plate in the first stage that has one.
    fn vibration(&self) -> Option<Vibration>;
}
