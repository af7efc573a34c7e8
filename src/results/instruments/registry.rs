//! Definitions generated from the lines of the registry of instruments.

/// Defines [`InstrumentKind`](super::InstrumentKind) from `file::Type` lines. The name of the file is that of the kind in a
/// case.
macro_rules! instrument_kinds {
    ($($file:ident :: $Kind:ident),* $(,)?) => {
        $(pub use $file::$Kind;)*

        /// A kind of instrument with its settings, which a case chooses by name.
        #[derive(Clone, Debug, PartialEq)]
        pub enum InstrumentKind {
            $(
                #[doc = concat!("In a case: `kind = \"", stringify!($file), "\"`.")]
                $Kind($Kind),
            )*
        }

        impl InstrumentKind {
            /// The words of `kind`, each with the keys of its instrument.
            pub const WORDS: &'static [::talcum_engine::schema::Word] = &[$(
                ::talcum_engine::schema::Word::with(
                    stringify!($file),
                    <$Kind as RegisteredInstrument>::MEANING,
                    <$Kind as RegisteredInstrument>::KEYS,
                )
            ),*];

            /// The kind with a name and the settings of these keys; `None` if there is none of this name, or a value is
            /// missing or wrong.
            pub fn from_keys(name: &str, values: &dyn InstrumentValues) -> Option<Self> {
                $(
                    if name == stringify!($file) {
                        return <$Kind as RegisteredInstrument>::from_keys(values).map(Self::$Kind);
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

            /// An instrument that has not taken a sample yet.
            pub fn begin(&self, setting: &Setting<'_>) -> Box<dyn Instrument> {
                match self {
                    $(Self::$Kind(kind) => kind.begin(setting),)*
                }
            }
        }
    };
}
