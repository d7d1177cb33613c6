//! MeatPack: the commonest characters of G-code in four bits each.
//!
//! In: bytes. Out: text. A byte holds two characters, the first one in its
//! lower half; a half of 15 says that a whole character follows. Two bytes of
//! 255 announce a command. The format is that of
//! github.com/scottmudge/OctoPrint-MeatPack, in which other slicers pack the
//! text of binary G-code.

/// The characters for which the halves of a byte stand. The twelfth is E where
/// blanks are left out.
const CHARACTERS: [u8; 15] = *b"0123456789. \nGX";
/// A half that announces a whole character.
const WHOLE: u8 = 15;
/// Stands twice before a command.
const SIGNAL: u8 = 0xff;

/// What the bytes so far have said.
#[derive(Default)]
struct Unpacker {
    text: Vec<u8>,
    packed: bool,
    without_blanks: bool,
    /// Number of whole characters that follow, and the character that stands
    /// after the first of them.
    whole: u8,
    after: Option<u8>,
}

/// The unpacked text, which is at most twice as long as the bytes.
pub(super) fn unpacked(bytes: &[u8]) -> Vec<u8> {
    let mut unpacker = Unpacker::default();
    let (mut signals, mut commanded) = (0, false);
    for &byte in bytes {
        if byte == SIGNAL && !commanded {
            signals += 1;
            commanded = signals == 2;
            continue;
        }
        if std::mem::take(&mut commanded) {
            unpacker.command(byte);
        } else {
            if signals == 1 {
                unpacker.byte(SIGNAL);
            }
            unpacker.byte(byte);
        }
        signals = 0;
    }
    unpacker.text
}

impl Unpacker {
    fn command(&mut self, byte: u8) {
        match byte {
            251 => self.packed = true,
            250 | 249 => self.packed = false,
            247 => self.without_blanks = true,
            246 => self.without_blanks = false,
            _ => {}
        }
    }

    fn byte(&mut self, byte: u8) {
        if !self.packed {
            self.text.push(byte);
            return;
        }
        if self.whole > 0 {
            self.whole -= 1;
            self.text.push(byte);
            self.text.extend(self.after.take());
            return;
        }
        match [byte & 15, byte >> 4].map(|half| self.character(half)) {
            [Some(first), second] => {
                self.text.push(first);
                // The half after a line's end only fills the byte up.
                if first == b'\n' {
                    return;
                }
                match second {
                    Some(second) => self.text.push(second),
                    None => self.whole = 1,
                }
            }
            [None, Some(second)] => {
                self.whole = 1;
                self.after = Some(second);
            }
            [None, None] => self.whole = 2,
        }
    }

    fn character(&self, half: u8) -> Option<u8> {
        match half {
            WHOLE => None,
            11 if self.without_blanks => Some(b'E'),
            half => CHARACTERS.get(usize::from(half)).copied(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_unpacked() {
        let packing = [255, 255, 251];
        // G1, X, 1, a line's end, and a half that fills the byte up.
        let code = [0x1d, 0x1e, 0xcc];
        assert_eq!(unpacked(&[&packing[..], &code].concat()), b"G1X1\n");
        // The bytes have a whole character first, then second, then two.
        let whole = [0x1f, b'M', 0xf1, b'Y', 0xff, b'a', b'b'];
        let all = [&packing[..], &whole, &[0x0c]].concat();
        assert_eq!(unpacked(&all), b"M11Yab\n");
        // Without blanks their half stands for an E. Unpacked text stands as it
        // is.
        let spare = [255, 255, 247, 0xb0, 255, 255, 250, b';', b'o', b'\n'];
        assert_eq!(unpacked(&[&packing[..], &spare].concat()), b"0E;o\n");
        assert_eq!(unpacked(&[255, 255, 251, 255]), b"");
    }
}
