"""The guided check of tools/io: sensors by hand, outputs one at a time, calibration. It asks before it changes anything."""

from __future__ import annotations

import math
import statistics

from reflux.cmd_calibrate import correction
from reflux.errors import RunFailed, UserError
from reflux.io_board import CheckedBoard
from reflux.io_person import Person
from reflux.io_wiring import Channel, Output, Wiring
from reflux.session import Refused

STILL_ROWS = 5  # a reading is the mean of so many samples
HAND_S = 60.0
MOVED_SHARE = 0.01  # of the span
MOVED_NOISE = 6.0  # standard deviations of a reading that nobody touches
CROSSTALK = 0.3  # another reading that moves by this part of what the strongest one does moves with it
# What to look at for each fault of a sensor (firmware/devices/devices.c has these words).
ADVICE = {
    "no chip answers": "supply and ground of the chip, the select pin or address, clock and data lines",
    "another chip, or it does not take its settings": "the select pin or address, and the chip's name in the setting `device`",
    "checksum wrong, or two reads differ": "length of the wires, the pull-up, ground",
    "sensor or wire open": "the sensor's wires and terminals, one after the other",
    "sensor shorted": "the sensor's wires: two of them touch, or moisture in the probe",
    "voltage outside the supply, or a wire at a rail": "a wire on the wrong terminal, or the sensor touches ground or the supply",
    "out of range": "the sensor's type and the settings `type`, `reference` and `nominal`",
    "cold junction out of range": "where the chip sits: it must be between -55 and 125 degC",
    "chip has lost power": "the chip's supply, under load as well",
    "bus failed": "the lines of the bus: shorted together or to ground, or without a pull-up",
}


class Check:
    """Findings are lines for the end; each that is not fine counts as a failure."""

    def __init__(self, board: CheckedBoard, person: Person, wiring: Wiring, hold_s: float) -> None:
        self.board, self.person, self.wiring, self.hold_s = board, person, wiring, hold_s
        self.findings: list[tuple[bool, str]] = []

    def note(self, fine: bool, text: str) -> None:
        self.findings.append((fine, text))
        print(f"   {'ok' if fine else 'NOT OK'}: {text}", flush=True)

    def list(self) -> None:
        """Everything that is at the pins, with the newest readings."""
        width = max(len(row.name) for row in [*self.wiring.channels, *self.wiring.outputs])
        for c in self.wiring.channels:
            print(f"{c.name:{width}}  {c.where:28}  {self.board.words(c)}")
        for o in self.wiring.outputs:
            heater = ", heater" if o.heater else ""
            print(f"{o.name:{width}}  {o.where:28}  {o.least:g} .. {o.most:g} {o.unit}, safe {o.safe:g}{heater}")
        for pin in self.wiring.enables:
            print(f"{'':{width}}  enable on {pin}: on while clock, tick and main loop turn; heaters are off without it")

    # ---- before ----

    def prepare(self) -> None:
        """Loops in manual, and readings at room temperature believed. RunFailed where the person does not want that."""
        if loops := self.board.automatic_loops():
            if not self.person.agrees(f"{', '.join(loops)} would move outputs meanwhile. Put into manual?"):
                raise RunFailed("a loop in automatic would move outputs during the check")
            for loop in loops:
                self.board.talk.ask(f"mode {loop} manual")
            self.board.samples(2)
        outside = [c for c in self.wiring.channels if c.name not in self.board.faults and self.board.reasons.get(c.name) == "out of range"]
        if outside:
            names = ", ".join(c.name for c in outside)
            if self.person.agrees(f"{names}: the reading is outside what the board believes (meas.valid_lo, meas.valid_hi). Believe it until the end of this check?"):
                self.board.widen(outside)
                self.board.samples(STILL_ROWS)

    # ---- sensors ----

    def sensors(self) -> None:
        for c in self.wiring.channels:
            print(f"\n{c.name}: {c.where}. It reads {self.board.words(c)}.")
            if not self.board.usable(c.name):
                fault = self.board.faults.get(c.name, "")
                self.note(False, f"{c.name} {self.board.words(c)}{'; look at ' + ADVICE[fault] if fault in ADVICE else ''}")
                continue
            self.by_hand(c)

    def by_hand(self, wanted: Channel) -> None:
        """Which readings move when somebody warms this sensor."""
        channels = [c for c in self.wiring.channels if self.board.usable(c.name)]
        rows = self.board.samples(STILL_ROWS)
        rest = {c.name: statistics.fmean(row[c.name] for row in rows) for c in channels}
        noise = {c.name: statistics.pstdev([row[c.name] for row in rows]) for c in channels}
        enough = {c.name: max(MOVED_SHARE * abs(c.span), MOVED_NOISE * noise[c.name]) for c in channels}

        def change(c: Channel) -> float:
            return (self.board.value(c.name) - rest[c.name]) / enough[c.name]

        seen = self.person.watch(f"{wanted.name}: warm it with your hand now, or move what it measures (Enter leaves it out)",
                                 lambda: any(abs(change(c)) >= 1.0 for c in channels), HAND_S)
        if seen is None:
            print(f"   {wanted.name} left out")
            return
        if not seen:
            self.note(False, f"nothing moved in {HAND_S:g} s while {wanted.name} was touched")
            return
        self.board.samples(STILL_ROWS)
        strongest = max(abs(change(c)) for c in channels)
        moved = {c.name: self.board.value(c.name) - rest[c.name] for c in channels if abs(change(c)) >= max(1.0, CROSSTALK * strongest)}
        self.judge(wanted, moved)

    def judge(self, wanted: Channel, moved: dict[str, float]) -> None:
        others = ", ".join(name for name in moved if name != wanted.name)
        if wanted.name not in moved:
            self.note(False, f"{others} moved, {wanted.name} did not: exchange their wires, or their select pins or addresses in the settings")
        elif others:
            self.note(False, f"{others} moved together with {wanted.name}: two channels may read one sensor")
        elif wanted.unit == "degC" and moved[wanted.name] < 0:
            self.note(False, f"{wanted.name} fell by {-moved[wanted.name]:.3g} degC: if it was warmed, its two wires are exchanged")
        else:
            self.note(True, f"{wanted.name} moved by {moved[wanted.name]:+.3g} {wanted.unit}, and nothing else did")

    # ---- outputs ----

    def outputs(self) -> None:
        for o in self.wiring.outputs:
            self.output(o)

    def output(self, o: Output) -> None:
        """Moved after a question, for a short time, and back."""
        if o.heater:
            print(f"\n{o.name} is a heater: unplug it and put a lamp in its place.")
        else:
            print()
        value: float | None = o.little()
        answer = self.person.ask(f"{o.name}: {o.where}. Move it from {o.safe:g} to {value:g} {o.unit} for at most {self.hold_s:g} s? "
                                 "[y, another value, Enter leaves it out] ")
        if (value := self.wanted(answer or "", o)) is None:
            print(f"   {o.name} left out")
            return
        try:
            self.board.move(o, value)
            status = next((line for line in self.board.talk.ask("status") if line.startswith(f"{o.name} = ")), "")
            if "interlocked" in status:
                self.note(False, f"{o.name} is held by an interlock: `alarm` at the console says which, and mend its sensor first")
                return
            answered = self.person.agrees(f"Did {o.name} move, and nothing else?", self.hold_s)
        except Refused as error:
            self.note(False, f"{o.name}: the board refuses {value:g}: {error}")
            return
        finally:
            self.board.park(o)
        said = {True: f"{o.name} moved at {value:g} {o.unit}", False: f"{o.name} did not move, or something else did: look at its pin {o.where.split()[-1]}",
                None: f"no answer about {o.name} in {self.hold_s:g} s"}
        self.note(answered is True, f"{said[answered]}, and is back at {o.safe:g}")

    @staticmethod
    def wanted(answer: str, o: Output) -> float | None:
        """None: leave it out."""
        if answer.casefold() in ("y", "yes"):
            return o.little()
        try:
            value = float(answer)
        except ValueError:
            return None
        return value if math.isfinite(value) else None

    # ---- calibration ----

    def calibrate(self) -> bool:
        """True when a calibration is in force that was not before."""
        names = {c.name: c for c in self.wiring.channels}
        done = False
        while names:
            answer = self.person.ask(f"\nCalibrate a sensor? {', '.join(names)} (Enter: none) ")
            if not answer:
                return done
            if answer not in names:
                print(f"there is no {answer}")
                continue
            done = self.calibrate_one(names[answer]) or done
            names.pop(answer)
        return done

    def calibrate_one(self, c: Channel) -> bool:
        points: list[tuple[float, float]] = []
        for which in ("first", "second"):
            more = "" if which == "first" else ", or Enter for the zero alone"
            answer = self.person.ask(f"{c.name}: put it where you know the true value, and wait until the reading stands still. The {which} true value{more}: ")
            if not answer:
                break
            try:
                true = float(answer)
                if not math.isfinite(true):
                    raise ValueError
            except ValueError:
                print(f"{answer}: not a number; {c.name} keeps its calibration")
                return False
            rows = self.board.samples(STILL_ROWS)
            if not self.board.usable(c.name):
                self.note(False, f"{c.name} {self.board.words(c)}: no calibration with that")
                return False
            reading = statistics.fmean(row[c.name] for row in rows)
            print(f"   it reads {reading:.6g}, true is {true:g} {c.unit}")
            points.append((reading, true))
        if not points:
            return False
        try:
            gain, zero = correction(points)
        except UserError as error:
            self.note(False, f"{c.name}: {error}")
            return False
        lines = [f"set {c.meas}.gain {gain * c.gain:.7g}", f"set {c.meas}.zero {zero + gain * c.zero:.7g}"]
        if not self.person.agrees(f"{'; '.join(lines)}: take these settings?"):
            return False
        try:
            self.board.transaction(lines)
        except Refused as error:
            self.note(False, f"{c.name}: the board refuses the calibration: {error}")
            return False
        self.note(True, f"{c.name} is calibrated and now reads {self.board.words(c)}")
        return True

    def offer_save(self) -> None:
        """After restore of the limits of belief: what is stored has them as they were."""
        if self.person.agrees("Save the settings in the board's flash?"):
            refused = self.board.save()
            self.note(not refused, f"not saved: {refused}" if refused else "saved")
