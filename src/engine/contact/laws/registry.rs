//! Definitions generated from the lines of the registry of contact laws.

/// Defines [`ContactLaw`](super::ContactLaw) from `file::Type` lines.
macro_rules! contact_laws {
    ($($file:ident :: $Law:ident),* $(,)?) => {
        $(pub use $file::$Law;)*

        /// A contact law: one of the registry, which a case chooses by name, or one from outside the crate.
        #[derive(Clone, Debug, PartialEq)]
        pub enum ContactLaw {
            $(
                #[doc = concat!("In a case: `law = \"", stringify!($file), "\"`.")]
                $Law($Law),
            )*
            /// A law from outside the crate, which no case file can choose.
            Custom($crate::contact::CustomContactLaw),
        }

        $(
            impl From<$Law> for ContactLaw {
                fn from(law: $Law) -> Self {
                    Self::$Law(law)
                }
            }
        )*

        impl ContactLaw {
            /// The laws that a case can choose from, by name.
            pub const NAMES: &'static [&'static str] = &[$(stringify!($file)),*];

            /// The words of `contact.law`, each with the keys of its law.
            pub const WORDS: &'static [$crate::schema::Word] = &[$(
                $crate::schema::Word::with(
                    stringify!($file),
                    <$Law as $crate::contact::RegisteredContactLaw>::MEANING,
                    <$Law as $crate::contact::RegisteredContactLaw>::KEYS,
                )
            ),*];

            /// The law with a given name and the values of its keys; `None` if there is none of this name, or a value
            /// is missing or wrong.
            pub fn from_keys(
                name: &str,
                values: &dyn $crate::contact::ContactLawValues,
            ) -> Option<Result<Self, $crate::contact::InvalidContactLaw>> {
                $(
                    if name == stringify!($file) {
                        let law = <$Law as $crate::contact::RegisteredContactLaw>::from_keys(values);
                        return law.map(|law| law.map(Self::from));
                    }
                )*
                None
            }

            /// The adhesion of the law with a given name; `None` if there is none of this name.
            pub fn adhesion_of(name: &str) -> Option<$crate::contact::Adhesion> {
                $(
                    if name == stringify!($file) {
                        return Some(<$Law as $crate::contact::RegisteredContactLaw>::ADHESION);
                    }
                )*
                None
            }

            /// Name of the law in the case file; for a law from outside the crate, its given name.
            pub fn name(&self) -> &str {
                match self {
                    $(Self::$Law(_) => stringify!($file),)*
                    Self::Custom(law) => law.name(),
                }
            }

            /// Exponent n of the overlap to which the normal force of first loading is proportional; 1 for a law from
            /// outside the crate, which does not give it.
            pub fn overlap_exponent(&self) -> f64 {
                match self {
                    $(Self::$Law(_) => <$Law as $crate::contact::RegisteredContactLaw>::OVERLAP_EXPONENT,)*
                    Self::Custom(_) => 1.0,
                }
            }

            /// This law for bodies whose stiffnesses are larger by a factor, with the same adhesion; `None` for a law
            /// from outside the crate.
            pub fn stiffened(&self, factor: f64) -> Option<Self> {
                use $crate::contact::RegisteredContactLaw;
                match self {
                    $(Self::$Law(law) => Some(law.stiffened(factor).into()),)*
                    Self::Custom(_) => None,
                }
            }

            /// This law with its own adhesion scaled such that the work of separation is that of bodies `reduction`
            /// times as stiff. A law from outside the crate is unchanged.
            #[must_use]
            pub fn keeping_work(&self, reduction: f64) -> Self {
                use $crate::contact::RegisteredContactLaw;
                match self {
                    $(Self::$Law(law) => law.keeping_work(reduction).into(),)*
                    Self::Custom(_) => self.clone(),
                }
            }

            /// This law for parcels. A law from outside the crate is unchanged.
            #[must_use]
            pub fn coarse_grained(&self, parcels: &$crate::contact::CoarseGraining) -> Self {
                use $crate::contact::RegisteredContactLaw;
                match self {
                    $(Self::$Law(law) => law.coarse_grained(parcels).into(),)*
                    Self::Custom(_) => self.clone(),
                }
            }

            /// Examples of every law of the registry, without rolling friction, for tests.
            pub fn examples(scales: $crate::contact::ExampleScales) -> Vec<Self> {
                let mut examples = Vec::new();
                $(
                    let laws = <$Law as $crate::contact::RegisteredContactLaw>::examples(scales);
                    examples.extend(laws.into_iter().map(Self::from));
                )*
                examples
            }

            /// The law through its type, for blocks of pairs and for single contacts.
            pub(crate) fn as_block_law(&self) -> &dyn $crate::contact::BlockLaw {
                match self {
                    $(Self::$Law(law) => law,)*
                    Self::Custom(law) => law.as_block_law(),
                }
            }
        }

        impl $crate::contact::ContactForceLaw for ContactLaw {
            // The match is by type, since instruments and the energy ledger evaluate all contacts one by one.
            #[inline(always)]
            fn force(
                &self,
                contact: &$crate::contact::Contact,
                history: &mut $crate::particles::ContactHistory,
                dt: f64,
            ) -> $crate::contact::ContactForce {
                match self {
                    $(Self::$Law(law) => law.force(contact, history, dt),)*
                    Self::Custom(law) => law.as_block_law().force(contact, history, dt),
                }
            }

            fn sticking_force(
                &self,
                contact: &$crate::contact::Contact,
                history: &mut $crate::particles::ContactHistory,
                dt: f64,
            ) -> ($crate::contact::ContactForce, bool) {
                self.as_block_law().sticking_force(contact, history, dt)
            }

            fn slide(
                &self,
                contact: &$crate::contact::Contact,
                history: &mut $crate::particles::ContactHistory,
                force: &mut $crate::contact::ContactForce,
            ) {
                self.as_block_law().slide(contact, history, force)
            }

            #[inline(always)]
            fn touches(
                &self,
                contact: &$crate::contact::Contact,
                history: &$crate::particles::ContactHistory,
            ) -> bool {
                match self {
                    $(Self::$Law(law) => law.touches(contact, history),)*
                    Self::Custom(law) => law.as_block_law().touches(contact, history),
                }
            }

            fn stored_energy(
                &self,
                contact: &$crate::contact::Contact,
                history: &$crate::particles::ContactHistory,
            ) -> $crate::contact::StoredInContact {
                self.as_block_law().stored_energy(contact, history)
            }

            fn work(&self, step: &$crate::contact::ContactStep<'_>) -> $crate::contact::ContactWork {
                self.as_block_law().work(step)
            }

            fn contact_range(&self, reduced_radius: f64) -> f64 {
                self.as_block_law().contact_range(reduced_radius)
            }

            fn stiffness(&self, overlap: f64, reduced_radius: f64) -> f64 {
                self.as_block_law().stiffness(overlap, reduced_radius)
            }

            fn stiffness_over(&self, contact: &$crate::contact::Contact, dt: f64) -> [f64; 2] {
                self.as_block_law().stiffness_over(contact, dt)
            }

            fn contact_duration(&self, reduced_mass: f64, reduced_radius: f64) -> f64 {
                self.as_block_law().contact_duration(reduced_mass, reduced_radius)
            }

            fn largest_force(&self, overlap: f64, reduced_radius: f64) -> f64 {
                self.as_block_law().largest_force(overlap, reduced_radius)
            }
        }
    };
}
