//! Single values: fidget's operations, but in f64.

use super::Number;
use fidget::types::FloatExt;

macro_rules! own {
    ($($name:ident)*) => {
        $(fn $name(self) -> Self {
            f64::$name(self)
        })*
    };
}

impl Number for f64 {
    own!(abs recip sqrt floor ceil round sin cos tan asin acos atan exp ln);

    fn splat(v: f32) -> Self {
        v.into()
    }
    fn neg(self) -> Self {
        -self
    }
    fn square(self) -> Self {
        self * self
    }
    // These operations are defined by bits or by exact zeros, so fidget's own
    // are used, in f32.
    fn not(self) -> Self {
        FloatExt::not(self as f32).into()
    }
    fn rand(self) -> Self {
        FloatExt::rand(self as f32).into()
    }
    fn mix(self, o: Self) -> Self {
        FloatExt::mix(self as f32, o as f32).into()
    }
    fn add(self, o: Self) -> Self {
        self + o
    }
    fn sub(self, o: Self) -> Self {
        self - o
    }
    fn mul(self, o: Self) -> Self {
        self * o
    }
    fn scale(self, by: f32) -> Self {
        self * f64::from(by)
    }
    fn div(self, o: Self) -> Self {
        self / o
    }
    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }
    fn modulo(self, o: Self) -> Self {
        self.rem_euclid(o)
    }
    fn compare(self, o: Self) -> Self {
        self.partial_cmp(&o)
            .map_or(f64::NAN, |order| f64::from(order as i8))
    }
    // NaN wins in fidget's min and max, unlike in f64's.
    fn min(self, o: Self) -> Self {
        if self.is_nan() || o.is_nan() {
            f64::NAN
        } else {
            f64::min(self, o)
        }
    }
    fn max(self, o: Self) -> Self {
        if self.is_nan() || o.is_nan() {
            f64::NAN
        } else {
            f64::max(self, o)
        }
    }
    fn and(self, o: Self) -> Self {
        if self == 0.0 { self } else { o }
    }
    fn or(self, o: Self) -> Self {
        if self != 0.0 { self } else { o }
    }
}
