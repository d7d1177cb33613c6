/// Declares an enum whose values have names: `ALL` has the values in the order of
/// their declaration, and `name` tells a value's name.
#[macro_export]
macro_rules! named {
    (
        $(#[$of_kind:meta])*
        pub enum $kind:ident {
            $($(#[$of_value:meta])* $value:ident = $name:literal,)+
        }
    ) => {
        $(#[$of_kind])*
        pub enum $kind {
            $($(#[$of_value])* $value,)+
        }

        impl $kind {
            /// Every value, in the order in which they are listed.
            pub const ALL: [$kind; [$($name),+].len()] = [$($kind::$value),+];

            /// The value's name.
            pub fn name(self) -> &'static str {
                match self {
                    $($kind::$value => $name,)+
                }
            }
        }
    };
}
