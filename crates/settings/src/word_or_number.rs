//! Settings that are one of a few words, or a number.

use super::value::{Measure, Raw, Refused, Value, ValueKind};
use isoslice_base::units::{Degrees, Mm};

/// Declares the types.
macro_rules! words_or_number {
    ($(
        $(#[doc = $doc:literal])+
        $name:ident {
            $($(#[doc = $word_doc:literal])+ $word:ident = $text:literal),+;
            $(#[doc = $number_doc:literal])+
            $number:ident($ty:ty) is $kind:ident,
        }
    )+) => {$(
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum $name {
            $($(#[doc = $word_doc])+ $word,)+
            $(#[doc = $number_doc])+
            $number($ty),
        }

        impl Value for $name {
            fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused> {
                Ok(match raw {
                    $(Raw::Text($text) | Raw::Word($text) => Self::$word,)+
                    _ => Self::$number(Value::read(raw, measure)?),
                })
            }

            fn to_toml(&self) -> String {
                match self {
                    $(Self::$word => format!("{:?}", $text),)+
                    Self::$number(number) => number.to_toml(),
                }
            }

            fn kind(&self) -> ValueKind {
                ValueKind::$kind(&[$($text),+])
            }
        }
    )+};
}

words_or_number! {
    /// A wall around the print that keeps draughts off.
    DraftShield {
        /// There is no draft shield.
        Off = "off",
        /// The draft shield is as high as the print.
        Full = "full";
        /// The draft shield is this high, mm.
        UpTo(Mm) is WordOrNumber,
    }

    /// What an expression of infill is.
    InfillMode {
        /// A surface to lay beads on, where the expression is zero.
        Surface = "surface",
        /// A solid, with one wall of its own, where the expression is negative.
        Solid = "solid";
        /// A solid with this number of walls.
        Walls(u32) is WordOrWhole,
    }

    /// Pattern of the dense layers of supports.
    InterfacePattern {
        /// Parallel lines that begin along those of infill, turned by a right
        /// angle every layer.
        Lines = "lines",
        /// Rings inside one another, from the border inwards.
        Concentric = "concentric";
        /// Parallel lines, in this direction on even layers.
        Towards(Degrees) is WordOrNumber,
    }
}

impl DraftShield {
    /// Height of the draft shield above the bed, mm; 0 if there is none.
    pub fn height(self) -> Mm {
        match self {
            DraftShield::Off => 0.0,
            DraftShield::Full => f64::INFINITY,
            DraftShield::UpTo(height) => height,
        }
    }
}

impl InfillMode {
    /// Number of walls of infill that is a solid.
    pub fn walls(self) -> Option<u32> {
        match self {
            InfillMode::Surface => None,
            InfillMode::Solid => Some(1),
            InfillMode::Walls(count) => Some(count),
        }
    }
}
