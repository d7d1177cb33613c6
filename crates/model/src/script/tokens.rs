//! Powers as mathematics has them, by another reading of a script's tokens.
//!
//! rhai binds `^` weaker than `+`, and a sign tighter than `**`. Here `^` is
//! `**`, and after a sign the power becomes an operator of its own, which
//! `operators` makes: -x ^ 2 is -(x ^ 2), as it is in formulas and in Python.

use rhai::{Engine, LexError, Token};
use std::sync::{Mutex, PoisonError};

/// The power of what has a sign: -a ** b is -(a ** b).
pub(super) const SIGNED_POWER: &str = "-**";

/// rhai's own power binds by 190. This one binds tighter, so that it comes
/// first in 2 ** -x ** 2.
const TIGHTER: u8 = 191;

/// What stands before the next token, inside the same brackets.
#[derive(Clone, Copy, Default)]
struct Before {
    /// A minus, or another odd number of them, before the last operand.
    signed: bool,
    /// A power whose base has a sign.
    powered: bool,
}

/// The brackets that are open, each with what stands in it so far.
#[derive(Default)]
struct Reader {
    outer: Vec<Before>,
    here: Before,
}

impl Reader {
    fn read(&mut self, token: Token) -> Token {
        match &token {
            Token::UnaryMinus => self.here.signed = !self.here.signed,
            Token::IntegerConstant(v) => self.here.signed ^= *v < 0,
            Token::FloatConstant(v) => {
                self.here.signed ^= v.0.is_sign_negative()
            }
            Token::XOr | Token::PowerOf => return self.power(),
            Token::XOrAssign => {
                self.here = Before::default();
                return Token::PowerOfAssign;
            }
            Token::LeftParen
            | Token::LeftBracket
            | Token::QuestionBracket
            | Token::LeftBrace
            | Token::MapStart => {
                self.outer.push(std::mem::take(&mut self.here));
            }
            Token::RightParen | Token::RightBracket | Token::RightBrace => {
                self.here = self.outer.pop().unwrap_or_default();
            }
            // These are parts of an operand.
            Token::Identifier(..)
            | Token::Reserved(..)
            | Token::Unit
            | Token::Period
            | Token::Elvis
            | Token::DoubleColon
            | Token::UnaryPlus => {}
            Token::EOF => *self = Reader::default(),
            _ => self.here = Before::default(),
        }
        token
    }

    fn power(&mut self) -> Token {
        if self.here.powered {
            let what = "powers of powers after a minus: write parentheses, as \
                        in -(x ** (2 ** 3))";
            return Token::LexError(Box::new(LexError::Runtime(what.into())));
        }
        if !std::mem::take(&mut self.here.signed) {
            return Token::PowerOf;
        }
        self.here.powered = true;
        Token::Custom(Box::new(SIGNED_POWER.into()))
    }
}

/// Makes the engine read powers as in mathematics: the minus of `-x ** 2` belongs
/// to the whole power.
pub(super) fn add_powers(engine: &mut Engine) {
    let registered = engine.register_custom_operator(SIGNED_POWER, TIGHTER);
    debug_assert!(registered.is_ok(), "the operator's name is free");
    let reader = Mutex::new(Reader::default());
    #[allow(deprecated, reason = "not deprecated, but rhai may change it")]
    engine.on_parse_token(move |token, at, _| {
        let mut reader = reader.lock().unwrap_or_else(PoisonError::into_inner);
        // A text that ended in an error has left brackets open.
        if at.line() == Some(1) && at.position() == Some(1) {
            *reader = Reader::default();
        }
        reader.read(token)
    });
}
