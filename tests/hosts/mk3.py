"""A printer that PrusaLink takes for a Prusa i3 MK3S, on a pseudo-terminal.

It answers what PrusaLink asks, heats and moves in no time, and writes each
command of a print to a file. Commands of a print are those with a number and a
checksum, which are looked at; a wrong one is asked for again, as the firmware
does.

    Printer(log).port       the terminal's name
    Printer(log).commands   the commands of the print
"""

import os
import pty
import re
import threading
import tty

FIRMWARE = "3.14.1-8237"
SERIAL_NUMBER = "CZPX1234X004XC12345"

# What the firmware says besides "ok".
ANSWERS = {
    "PRUSA Fir": [FIRMWARE],
    "PRUSA SN": [SERIAL_NUMBER],
    "M862.2 Q": ["302"],
    "M862.1 Q": ["0.40"],
    "M220": ["100%"],
    "M221": ["100%"],
    "M27 P": ["Not SD printing"],
    "M20 LT": ["Begin file list", "End file list"],
    "M21": ["echo:SD init fail"],
    "M420": ["Mesh bed leveling not active."],
    "M73": [
        "NORMAL MODE: Percent done: -1; print time remaining in mins: -1; "
        "Change in mins: -1",
        "SILENT MODE: Percent done: -1; print time remaining in mins: -1; "
        "Change in mins: -1",
    ],
}
TEMPERATURES = ("T:210.0 /210.0 B:60.0 /60.0 T0:210.0 /210.0 @:0 B@:0 P:30.0 "
                "A:30.0")


class Printer:
    """The printer, whose thread ends with the program."""

    def __init__(self):
        self.commands = []
        self.ours, self.theirs = pty.openpty()
        tty.setraw(self.theirs)
        self.port = os.ttyname(self.theirs)
        self.last = 0
        threading.Thread(target=self.run, daemon=True).start()

    def say(self, *lines):
        os.write(self.ours, "".join(f"{line}\n" for line in lines).encode())

    def run(self):
        left = b""
        while True:
            left += os.read(self.ours, 4096)
            *lines, left = left.split(b"\n")
            for line in lines:
                text = line.decode("ascii", "replace").strip()
                # Comments and empty lines are not acknowledged.
                if text and not text.startswith(";"):
                    self.take(text)

    def take(self, text):
        counted = re.fullmatch(r"N(\d+) ?(.*?)\*(\d+)", text)
        if counted:
            number, command, sum_told = counted.groups()
            checksum = 0
            for byte in text[:text.rindex("*")].encode():
                checksum ^= byte
            reset = command.startswith("M110")
            if checksum != int(sum_told) or (
                    int(number) != self.last + 1 and not reset):
                self.say(f"Resend: {self.last + 1}", "ok")
                return
            self.last = int(number)
            if not reset:
                self.commands.append(command.strip())
        else:
            command = text
        reset = re.fullmatch(r"M110 ?N(-?\d+)", command.strip())
        if reset:
            self.last = int(reset[1])
        self.say(*self.answer(command.strip()), "ok")

    def answer(self, command):
        memory = re.fullmatch(r"D3 Ax([0-9a-fA-F]+) C(\d+)", command)
        if memory:
            # An EEPROM of zeros.
            bytes_told = " ".join(["00"] * int(memory[2]))
            return [f"{memory[1].lower()}  {bytes_told}"]
        if command in ("M105", "M155 S2 C7"):
            return [TEMPERATURES]
        return ANSWERS.get(command, [])
