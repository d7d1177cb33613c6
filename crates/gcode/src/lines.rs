//! Lines and words: what everything else is written with.

use super::number::{push_integer, push_scaled, scaled, text};
use super::{COARSE, WriteError, Writer, comments, flavour};
use isoslice_base::units::{Celsius, Percent};
use std::io::Write;

impl<W: Write> Writer<'_, W> {
    /// Sets the units and modes that this writer relies on.
    pub(super) fn modes(&mut self) {
        self.line("G21");
        self.line("G90");
        self.line(if self.filament.relative { "M83" } else { "M82" });
    }

    pub(super) fn temperature(&mut self, command: &str, to: Celsius) {
        self.line(&format!("{command} S{}", text(to, COARSE)));
    }

    pub(super) fn set_fan(&mut self, speed: Percent) {
        let pwm = flavour::pwm(speed);
        if self.fan != Some(pwm) {
            self.fan = Some(pwm);
            self.line(&flavour::fan(self.plan.flavour, pwm));
        }
    }

    pub(super) fn type_comment(&mut self, name: Option<&str>) {
        if let Some(name) = name {
            let before = comments::before_role(self.plan.comments);
            self.buffer.extend_from_slice(before.as_bytes());
            self.line(name);
        }
    }

    /// Marks what follows as printed by a template, not as the part.
    pub(super) fn custom_comment(&mut self) {
        self.type_comment(comments::custom(self.plan.comments));
    }

    pub(super) fn comment_number(
        &mut self,
        tag: &str,
        count: i64,
        decimals: u32,
    ) {
        self.buffer.extend_from_slice(tag.as_bytes());
        push_scaled(&mut self.buffer, count, decimals);
        self.buffer.push(b'\n');
    }

    pub(super) fn word(&mut self, letter: &[u8], count: i64, decimals: u32) {
        self.buffer.extend_from_slice(letter);
        match u64::try_from(count) {
            Ok(whole) if decimals == 0 => {
                push_integer(&mut self.buffer, whole);
            }
            _ => push_scaled(&mut self.buffer, count, decimals),
        }
    }

    pub(super) fn line(&mut self, text: &str) {
        self.buffer.extend_from_slice(text.as_bytes());
        self.buffer.push(b'\n');
    }

    /// A number as a count of its last decimal; an error if the number is not
    /// finite.
    pub(super) fn count(
        &self,
        what: &'static str,
        value: f64,
        decimals: u32,
    ) -> Result<i64, WriteError> {
        scaled(value, decimals).ok_or(WriteError::BadNumber {
            what,
            value,
            layer: self.layer + 1,
        })
    }

    pub(super) fn flush(&mut self) -> Result<(), WriteError> {
        let text = &self.buffer;
        match &mut self.waiting {
            Some(waiting) => waiting.write(text, self.copy)?,
            None => {
                self.out.write_all(text)?;
                (self.copy)(text);
                if let Some(record) = &mut self.record {
                    record.passed(text);
                }
            }
        }
        self.buffer.clear();
        Ok(())
    }
}
