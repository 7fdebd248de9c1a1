//! Quantities of one drive, and of many drives side by side.

/// Makes a struct of scalars and its lanes: the same fields, each an array over the lanes.
macro_rules! lanes {
    ($(#[$doc:meta])* $one:ident / $many:ident { $($(#[$field_doc:meta])* $field:ident),+ $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $one<R> { $($(#[$field_doc])* pub $field: R),+ }

        #[doc = concat!("[`", stringify!($one), "`] of `N` lanes, as a structure of arrays; it")]
        #[doc = "starts at a cache line, for vectors across two lines cost twice."]
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[repr(align(64))]
        pub struct $many<R, const N: usize> { $($(#[$field_doc])* pub $field: [R; N]),+ }

        impl<R> $one<R> {
            /// Every field through the function.
            #[inline(always)]
            pub fn map<S>(self, mut f: impl FnMut(R) -> S) -> $one<S> {
                $one { $($field: f(self.$field)),+ }
            }
        }

        impl<R: Copy, const N: usize> $many<R, N> {
            /// One lane.
            #[inline(always)]
            pub fn lane(&self, l: usize) -> $one<R> {
                $one { $($field: self.$field[l]),+ }
            }

            /// Overwrites one lane.
            #[inline(always)]
            pub fn set_lane(&mut self, l: usize, one: $one<R>) {
                $(self.$field[l] = one.$field;)+
            }

            /// The same values in every lane.
            #[inline(always)]
            pub fn splat(one: $one<R>) -> Self {
                Self { $($field: [one.$field; N]),+ }
            }
        }
    };
}

pub(crate) use lanes;
