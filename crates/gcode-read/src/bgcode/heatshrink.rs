//! Heatshrink, a compression that replaces bytes by references to equal bytes a
//! few kilobytes before.
//!
//! In: bytes. Out: a stream of bits, the highest of a byte first: a 1 and a
//! byte, or a 0, how far back (less 1) the bytes to repeat begin, and their
//! number (less 1). The last byte is filled up with zeros. The format is that
//! of github.com/atomicobject/heatshrink. Writer and reader have to agree on
//! the numbers of bits for distances and for lengths.

/// Length of the shortest piece that is worth a reference, which takes 17 bits.
const SHORTEST: usize = 3;
/// Number of earlier places that are tried for each piece. Trying more makes
/// the text shorter by less than 1 %.
const TRIES: usize = 64;
/// Entries of the table of places.
const TABLE: usize = 1 << 13;
/// Stands for "no place" in the table.
const NOWHERE: u32 = u32::MAX;

/// Compresses `text`, which must be shorter than 4 GB.
pub(super) fn compressed(text: &[u8], window: u8, length: u8) -> Vec<u8> {
    let longest = 1 << length;
    let mut places = Places::new(text.len(), 1 << window);
    let mut bits = Bits::default();
    let mut at = 0;
    while at < text.len() {
        let (back, count) = places.longest(text, at, longest);
        let count = if count < SHORTEST { 1 } else { count };
        if count == 1 {
            bits.push(1, 1);
            bits.push(u32::from(text[at]), 8);
        } else {
            bits.push(0, 1);
            bits.push(back as u32 - 1, window);
            bits.push(count as u32 - 1, length);
        }
        for passed in at..at + count {
            places.add(text, passed);
        }
        at += count;
    }
    bits.finish()
}

/// The places in the text so far, by the 3 bytes that begin there.
struct Places {
    /// Greatest distance of a reference.
    reach: usize,
    /// The last place in each slot; several groups of 3 bytes share a slot.
    last: Vec<u32>,
    /// For each place the previous place in the same slot.
    before: Vec<u32>,
}

impl Places {
    fn new(length: usize, reach: usize) -> Self {
        Places {
            reach,
            last: vec![NOWHERE; TABLE],
            before: vec![NOWHERE; length],
        }
    }

    fn slot(text: &[u8], at: usize) -> Option<usize> {
        let &[a, b, c] = text.get(at..at + SHORTEST)? else {
            return None;
        };
        let three = u32::from_le_bytes([a, b, c, 0]);
        // Knuth's multiplicative hash.
        Some((three.wrapping_mul(2_654_435_761) >> 19) as usize % TABLE)
    }

    fn add(&mut self, text: &[u8], at: usize) {
        if let Some(slot) = Self::slot(text, at) {
            self.before[at] = self.last[slot];
            self.last[slot] = at as u32;
        }
    }

    /// The longest earlier piece that equals the text at `at`: how far back it
    /// begins, and its length, up to `longest`.
    fn longest(
        &self,
        text: &[u8],
        at: usize,
        longest: usize,
    ) -> (usize, usize) {
        let rest = &text[at..text.len().min(at + longest)];
        let (mut back, mut count) = (0, 0);
        let mut place = match Self::slot(text, at) {
            Some(slot) => self.last[slot],
            None => NOWHERE,
        };
        for _ in 0..TRIES {
            let from = place as usize;
            if place == NOWHERE || at - from > self.reach || count == rest.len()
            {
                break;
            }
            let same = rest.iter().zip(&text[from..]);
            let same = same.take_while(|(a, b)| a == b).count();
            if same > count {
                (back, count) = (at - from, same);
            }
            place = self.before[from];
        }
        (back, count)
    }
}

/// Decompresses `count` bytes; none if there are fewer, or if a reference leads
/// to before the beginning.
pub(super) fn decompressed(
    bytes: &[u8],
    window: u8,
    length: u8,
    count: usize,
) -> Option<Vec<u8>> {
    let mut bits = Bits {
        bytes: bytes.to_vec(),
        ..Bits::default()
    };
    // Each byte of input repeats at most 1 << `length` bytes.
    let likely = count.min(bytes.len().saturating_mul(1 << length));
    let mut text: Vec<u8> = Vec::with_capacity(likely);
    while text.len() < count {
        if bits.take(1)? == 1 {
            text.push(bits.take(8)? as u8);
            continue;
        }
        let back = bits.take(window)? as usize + 1;
        let again = bits.take(length)? as usize + 1;
        let from = text.len().checked_sub(back)?;
        for i in from..from + again.min(count - text.len()) {
            text.push(text[i]);
        }
    }
    Some(text)
}

/// A stream of bits, written or read.
#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    /// Bits that are not yet in `bytes`, or not yet taken from it, and their
    /// number.
    part: u32,
    count: u8,
    /// Number of bytes that were taken.
    taken: usize,
}

impl Bits {
    fn push(&mut self, value: u32, count: u8) {
        self.part = (self.part << count) | value;
        self.count += count;
        while self.count >= 8 {
            self.count -= 8;
            self.bytes.push((self.part >> self.count) as u8);
        }
        self.part &= (1 << self.count) - 1;
    }

    fn finish(mut self) -> Vec<u8> {
        if self.count > 0 {
            self.push(0, 8 - self.count);
        }
        self.bytes
    }

    fn take(&mut self, count: u8) -> Option<u32> {
        while self.count < count {
            let byte = *self.bytes.get(self.taken)?;
            self.taken += 1;
            self.part = (self.part << 8) | u32::from(byte);
            self.count += 8;
        }
        self.count -= count;
        let value = self.part >> self.count;
        self.part &= (1 << self.count) - 1;
        Some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_compressed_comes_back() {
        let line = "G1 X109.715 Y113.197 E0.00925\nG1 X109.463 Y113.1\n";
        let noise: Vec<u8> = (0..9000u32)
            .map(|i| {
                (i.wrapping_mul(i).wrapping_mul(2_654_435_761) >> 24) as u8
            })
            .collect();
        for text in [&b""[..], b"a", b"aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"]
            .into_iter()
            .map(<[u8]>::to_vec)
            .chain([line.repeat(400).into_bytes(), noise])
        {
            for window in [11, 12] {
                let small = compressed(&text, window, 4);
                let again = decompressed(&small, window, 4, text.len());
                assert!(again.as_deref() == Some(&text[..]));
            }
        }
        let small = compressed(line.repeat(400).as_bytes(), 12, 4);
        assert!(small.len() * 6 < 400 * line.len(), "{}", small.len());
    }

    /// The case was worked out by hand: a, b, c as themselves, then six bytes
    /// from three bytes back.
    #[test]
    fn the_bits_are_those_of_the_format() {
        let bits = "1 01100001 1 01100010 1 01100011 0 000000000010 0101";
        let bits: Vec<u8> = bits
            .bytes()
            .filter(|b| *b != b' ')
            .map(|b| b - b'0')
            .collect();
        let bytes: Vec<u8> = bits
            .chunks(8)
            .map(|c| (0..8).fold(0, |n, i| 2 * n + c.get(i).unwrap_or(&0)))
            .collect();
        assert_eq!(compressed(b"abcabcabc", 12, 4), bytes);
        let again = decompressed(&bytes, 12, 4, 9);
        assert_eq!(again.as_deref(), Some(&b"abcabcabc"[..]));
    }

    #[test]
    fn damage_is_no_text() {
        let small = compressed(b"abcabcabc", 12, 4);
        assert_eq!(decompressed(&small[..3], 12, 4, 9), None);
        assert_eq!(decompressed(&[], 12, 4, 1), None);
        // The reference leads to before the beginning.
        assert_eq!(decompressed(&[0x00; 8], 12, 4, 9), None);
        assert_eq!(decompressed(&[0x7f; 8], 12, 4, usize::MAX), None);
    }
}
