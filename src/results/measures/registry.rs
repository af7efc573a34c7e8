//! Definitions generated from the lines of the registry of measures.

/// Defines [`MeasureKind`](super::MeasureKind) from `file::Type` lines. The name of the file is that of the kind in a
/// case.
macro_rules! measure_kinds {
    ($($file:ident :: $Kind:ident),* $(,)?) => {
        $(pub use $file::$Kind;)*

        /// A kind of measure with its settings, which a case chooses by name.
        #[derive(Clone, Debug, PartialEq)]
        pub enum MeasureKind {
            $(
                #[doc = concat!("In a case: `kind = \"", stringify!($file), "\"`.")]
                $Kind($Kind),
            )*
        }

        impl MeasureKind {
            /// The words of `kind`, each with the keys of its measure.
            pub const WORDS: &'static [::talcum_engine::schema::Word] = &[$(
                ::talcum_engine::schema::Word::with(
                    stringify!($file),
                    <$Kind as RegisteredMeasure>::MEANING,
                    <$Kind as RegisteredMeasure>::KEYS,
                )
            ),*];

            /// The kind with a name and the settings of these keys; `None` if there is none of this name, or a value is
            /// missing or wrong.
            pub fn from_keys(name: &str, values: &dyn MeasureValues) -> Option<Self> {
                $(
                    if name == stringify!($file) {
                        return <$Kind as RegisteredMeasure>::from_keys(values).map(Self::$Kind);
                    }
                )*
                None
            }

            /// Its name in the case file.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$Kind(_) => stringify!($file),)*
                }
            }

            /// A measure that has not taken a sample yet.
            pub fn begin(&self, setting: &Setting<'_>) -> Box<dyn Measure> {
                match self {
                    $(Self::$Kind(kind) => kind.begin(setting),)*
                }
            }
        }
    };
}
