//! Definitions generated from the lines of the registry of drag laws.

/// Defines [`DragLaw`](super::DragLaw) from `name => file::Type` lines.
macro_rules! drag_laws {
    ($($name:literal => $file:ident :: $Law:ident),* $(,)?) => {
        $(pub use $file::$Law;)*

        /// A drag law: one of the registry, which a case chooses by name, or one from outside the crate.
        #[derive(Clone, Debug, PartialEq)]
        pub enum DragLaw {
            $(
                #[doc = concat!("In a case: `drag = \"", $name, "\"`.")]
                $Law($Law),
            )*
            /// A law from outside the crate, which no case file can choose.
            Custom(CustomDragLaw),
        }

        $(
            impl From<$Law> for DragLaw {
                fn from(law: $Law) -> Self {
                    Self::$Law(law)
                }
            }
        )*

        impl DragLaw {
            /// The laws that a case can choose from, by name.
            pub const NAMES: &'static [&'static str] = &[$($name),*];

            /// The words of `gas.drag`, each with the keys of its law.
            pub const WORDS: &'static [$crate::schema::Word] = &[$(
                $crate::schema::Word::with($name, $Law::MEANING, $Law::KEYS)
            ),*];

            /// The law with a given name and the values of its keys; `None` if there is none of this name, or a value
            /// is missing or wrong.
            pub fn from_keys(name: &str, values: &dyn $crate::schema::KeyValues) -> Option<Self> {
                match name {
                    $($name => $Law::from_keys(values).map(Self::from),)*
                    _ => None,
                }
            }

            /// Name of the law in the case file; for a law from outside the crate, its given name.
            pub fn name(&self) -> &str {
                match self {
                    $(Self::$Law(_) => $name,)*
                    Self::Custom(law) => law.name(),
                }
            }

            /// Examples of every law of the registry, for tests.
            pub fn examples() -> Vec<Self> {
                let mut examples = Vec::new();
                $(examples.extend($Law::examples().into_iter().map(Self::from));)*
                examples
            }
        }

        impl DragCorrelation for DragLaw {
            #[inline(always)]
            fn scaled_drag(&self, solids_fraction: f64, reynolds: f64) -> f64 {
                match self {
                    $(Self::$Law(law) => law.scaled_drag(solids_fraction, reynolds),)*
                    Self::Custom(law) => law.scaled_drag(solids_fraction, reynolds),
                }
            }

            /// The law is chosen once, so that the loop contains no branch.
            #[inline(always)]
            fn scaled_drags<const N: usize>(
                &self,
                solids_fraction: &[f64; N],
                reynolds: &[f64; N],
            ) -> [f64; N] {
                match self {
                    $(Self::$Law(law) => law.scaled_drags(solids_fraction, reynolds),)*
                    Self::Custom(law) => law.scaled_drags(solids_fraction, reynolds),
                }
            }

            fn depends_on_reynolds(&self) -> bool {
                match self {
                    $(Self::$Law(law) => law.depends_on_reynolds(),)*
                    Self::Custom(law) => law.depends_on_reynolds(),
                }
            }
        }
    };
}
