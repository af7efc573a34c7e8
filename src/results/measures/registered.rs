//! Properties of a kind of measure in the registry.

use super::{Measure, Setting};
use talcum_engine::domain::{Bounds, Vibration};
use talcum_engine::grid::BoxGrid;
use talcum_engine::schema::{Key, KeyValues};
use talcum_engine::state::SizeRange;

/// A kind of measure of the registry: the settings of one `[measure.NAME]`, as plain data.
pub trait RegisteredMeasure: Sized {
    /// The measured quantities, for the manual.
    const MEANING: &'static str;

    /// Its keys in the case file, besides `kind`, `every` and `start`.
    const KEYS: &'static [Key];

    /// The settings with these values; `None` if one is missing or wrong, which has then been reported.
    fn from_keys(values: &dyn MeasureValues) -> Option<Self>;

    /// A measure that has not taken a sample yet.
    fn begin(&self, setting: &Setting<'_>) -> Box<dyn Measure>;
}

/// The values of a measure's keys, and other data of the case.
pub trait MeasureValues: KeyValues {
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
