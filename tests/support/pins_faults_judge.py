"""What must hold in a cell of the faults at the board's pins (pins_faults.py), and what came of it in words.

What a chip reports is told within two samples. While the fault lasts no reading that is good is wrong, but where no chip can know. The loop of the
lost measurement falls back as declared, in its time, and no other loop does. The plant gets no output outside its limits but the safe one, or less
where the board lets fall an output whose chip has the fault. What is taken back is told, the reading is right again, and the outputs go on. No rule
of a chip's data sheet is broken where the firmware can know its state.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from pins_faults import (AFTER_S, BACK_S, ENTER_S, FAULT_S, HOLD_S, LIMITS, LOADS, MANUAL, SAMPLES, STATES, STEP, Cell, Device, Fault, Job, Run, State,
                         find)

LATE_S = 1.0          # of what follows from a lost reading: the next sample
SLOW_S = 3            # a reading is of one of the last so many samples
SETTLED_S = 6         # outputs are what was commanded at 3 s, and T1 was read
VALVE_NEAR = 0.36     # l/h, the dead band of a valve and what it overruns; one that has just been switched on closes first, to know where it is
OVER = {"SENSOR_FAULT": "SENSOR_FINE", "OUTPUT_FAULT": "OUTPUT_FINE", "INTERLOCK_ON": "INTERLOCK_OFF"}  # what tells the end of what
NOT_GOOD = ("MEASUREMENT_BAD", "MEASUREMENT_GOOD")


@dataclass
class Seen:
    """A run, with the times of its fault."""

    job: Job
    run: Run
    device: Device
    fault: Fault
    state: State

    @property
    def begin_s(self) -> float:
        """At power-on: before all that is said."""
        return self.state.fault_s or -1.0

    @property
    def end_s(self) -> float:
        return self.state.fault_s + self.fault.lasts_s

    @property
    def subject(self) -> str:
        """Of what is told of the fault."""
        load = next((load for load in LOADS if load.name == self.job.device), None)
        return load.moved if load else "Qrb" if self.fault.told_as == "INTERLOCK_ON" else "T1"

    @property
    def sometimes(self) -> bool:
        """The fault may be told or not, as the moment is."""
        return self.fault.sometimes or self.state.flickers

    def first(self, code: str, subject: str, begin_s: float, end_s: float) -> tuple[float, str] | None:
        return next(((at, rest) for at, seen, who, rest in self.run.said if (seen, who) == (code, subject) and begin_s < at <= end_s), None)

    def during(self, code: str, subject: str) -> tuple[float, str] | None:
        return self.first(code, subject, self.begin_s, self.end_s)

    def after(self, code: str, subject: str) -> tuple[float, str] | None:
        return self.first(code, subject, self.end_s, self.end_s + AFTER_S)


def cause(rest: str) -> str:
    """The words behind the text of an event."""
    return rest.rsplit(": ", 1)[-1]


def told(seen: Seen, wrong: list[str]) -> str:
    """What was told of the fault, in words, empty: nothing."""
    fault, event = seen.fault, seen.during(seen.fault.told_as, seen.subject)
    if event is None:
        if fault.says and not seen.sometimes:
            wrong.append("it is not told")
        return ""
    at, rest = event
    if not fault.says:
        wrong.append(f"told although nothing is wrong: {cause(rest)}")
    elif not any(words in rest for words in fault.says):
        wrong.append(f"told as: {cause(rest)}")
    if not seen.sometimes and at - seen.begin_s > fault.within_s:
        wrong.append(f"told after {at - seen.begin_s:g} s, not {fault.within_s:g} s")
    return f"{at - seen.begin_s:g} s: {cause(rest)}"


def right(seen: Seen, at: float, value: str) -> bool:
    """Whether a reading is what the plant gave to the sensor in one of the last samples."""
    log, near = seen.run.log, seen.device.near * abs(seen.device.slope)
    given = [float(log[k]["T1.meas"]) for k in range(max(int(at) - SLOW_S, 0), min(int(at) + 1, len(log)))]
    return any(abs(seen.device.zero + seen.device.slope * celsius - float(value)) <= near for celsius in given)


def readings(seen: Seen, wrong: list[str]) -> None:
    """No good reading is wrong while the fault lasts, and at the end it is good and right."""
    rows, last = seen.run.rows, max(seen.run.rows)
    free = {"wrong": seen.fault.lasts_s + LATE_S, "stand still": seen.fault.lasts_s}.get(seen.fault.readings, 0.0)
    bad = [at for at, row in rows.items() if seen.begin_s + free < at <= seen.end_s and row["T1.q"] == "0" and not right(seen, at, row["T1"])]
    if bad:
        wrong.append(f"{len(bad)} wrong readings are good, first after {bad[0] - seen.begin_s:g} s: {rows[bad[0]]['T1']}")
    if rows[last]["T1.q"] != "0" or not right(seen, last, rows[last]["T1"]):
        wrong.append("no right reading after it")


def lost_since(seen: Seen) -> float | None:
    """When T1 was lost for longer than it is held; None: it was not."""
    since = None
    for at, code, who, _ in seen.run.said:
        if who != "T1" or code not in NOT_GOOD or at <= seen.begin_s:
            continue
        if since is not None and min(at, seen.end_s) - since > HOLD_S + LATE_S:
            return since
        since = at if code == "MEASUREMENT_BAD" and at <= seen.end_s else None
    return since if since is not None and seen.end_s - since > HOLD_S + LATE_S else None


def came(seen: Seen, code: str, subject: str, since: float, after_s: float, wrong: list[str], words: str) -> str:
    """An event that must come after_s after the loss."""
    event = seen.first(code, subject, since - 1e-6, seen.end_s)
    if event is None:
        wrong.append(f"no {code} {subject}")
        return "-"
    if not after_s - LATE_S <= event[0] - since <= after_s + LATE_S:
        wrong.append(f"{code} {subject} {event[0] - since:g} s after the loss, not {after_s:g} s")
    return f"{words} at {event[0] - seen.begin_s:g} s"


def unmoved(seen: Seen, code: str, subjects: tuple[str, ...], wrong: list[str]) -> None:
    for subject in subjects:
        if event := seen.during(code, subject):
            wrong.append(f"{code} {subject}: {cause(event[1])}")


def fall_back(seen: Seen, wrong: list[str]) -> str:
    """What loops, start-up or sequence did."""
    since, how = lost_since(seen), seen.state.falls_back
    others = () if seen.fault.both else ("bottom",)
    if since is None or how == "":
        if not seen.sometimes:
            unmoved(seen, "MANUAL_BY_BOARD", ("top", *others), wrong)
            if seen.fault.readings == "wrong" and (event := seen.during("COMMISSION_ENDED", "T1")):
                return f"ended at {event[0] - seen.begin_s:g} s"  # a test that went past its limit
            unmoved(seen, "COMMISSION_ENDED", ("T1",), wrong)
            unmoved(seen, "SEQUENCE_HELD", ("T1", "top"), wrong)
        return "goes on"
    if how == "refused":
        modes = [at for at, row in seen.run.rows.items() if at <= seen.end_s and row["top.mode"] != "0"]
        if modes and not seen.sometimes:
            wrong.append(f"top is in auto at {modes[0]:g} s")
        return "auto for a while" if modes else "auto refused"
    if how == "safe":
        return came(seen, "SAFE_STATE", "T1", since, HOLD_S, wrong, "safe state")
    unmoved(seen, "MANUAL_BY_BOARD", others, wrong)
    if how == "substitute":
        unmoved(seen, "MANUAL_BY_BOARD", ("top",), wrong)
        return "substitute"
    if how == "manual at once":
        first = seen.during("MEASUREMENT_BAD", "T1")
        return came(seen, "MANUAL_BY_BOARD", "top", first[0] if first else since, 0.0, wrong, "manual")
    if how in ("manual after hold", "flickers"):
        return came(seen, "MANUAL_BY_BOARD", "top", since, HOLD_S, wrong, "manual")
    if how == "sequence held":
        return came(seen, "SEQUENCE_HELD", "top", since, HOLD_S, wrong, "held")
    ended = seen.first("COMMISSION_ENDED", "T1", seen.begin_s, since + HOLD_S + LATE_S)
    if ended is None:
        wrong.append("the start-up does not end")
        return "-"
    return f"ended at {ended[0] - seen.begin_s:g} s"


def outputs(seen: Seen, wrong: list[str]) -> None:
    """What the plant gets, of a faulty load what the board commands, is within limits or safe; in manual it stays."""
    load = next((load for load in LOADS if load.name == seen.job.device), None)
    for name, (lo, hi, safe) in LIMITS.items():
        if load is None or name != load.moved:
            values = [(number, float(row[f"{name}.cmd"])) for number, row in enumerate(seen.run.log)]
        else:
            values = [(at, float(row[f"{name}.app"])) for at, row in seen.run.rows.items()]
        valve = load is not None and load.name == "motor_valve" and name == load.moved
        near, from_s = (VALVE_NEAR, FAULT_S - 1) if valve else (STEP[name], SETTLED_S)
        values = [(at, value) for at, value in values if at >= from_s]
        if load is not None and load.name == "relay" and name == load.moved:
            continue  # it has no part of its span
        off = load.off if load is not None and name == load.moved and seen.fault in load.faults else None
        if off is not None:  # its chip may be let fall, in any part of a sample, and be given less
            lo = off
            values += [(number, float(row[f"{name}.cmd"])) for number, row in enumerate(seen.run.log) if number >= from_s]
        beyond = [(at, value) for at, value in values if not lo - near <= value <= hi + near and abs(value - safe) > near]
        if beyond:
            wrong.append(f"{name} is {beyond[0][1]:g} at {beyond[0][0] - seen.begin_s:g} s, {len(beyond)} times")
        interlocked = any(code.startswith("INTERLOCK") for _, code, _, _ in seen.run.said)
        moved = [(at, value) for at, value in values if at > ENTER_S and abs(value - MANUAL[name]) > near and not (off is not None and value < MANUAL[name])]
        if seen.state.name == "manual" and moved and not interlocked:
            wrong.append(f"{name} moves in manual, {moved[0][1]:g} at {moved[0][0] - seen.begin_s:g} s")
        if seen.state.falls_back == "safe" and (since := lost_since(seen)) is not None:
            late = [at for at, value in values if since + HOLD_S + 2 * LATE_S <= at <= seen.end_s and abs(value - safe) > near]
            if late:
                wrong.append(f"{name} is not safe {late[0] - since:g} s after the loss")


def held_off(seen: Seen, wrong: list[str]) -> None:
    """While an interlock is told, its output is off."""
    if seen.fault.told_as != "INTERLOCK_ON" or seen.sometimes:
        return
    on = [number for number, row in enumerate(seen.run.log)
          if seen.begin_s + SAMPLES + LATE_S < number <= seen.end_s and abs(float(row["Qrb.cmd"])) > STEP["Qrb"]]
    if on:
        wrong.append(f"Qrb is on {on[0] - seen.begin_s:g} s after it, {len(on)} times")


def back(seen: Seen, wrong: list[str]) -> None:
    """What was told before is told to be over."""
    over = OVER.get(seen.fault.told_as, "SENSOR_FINE")
    faults = [code for at, code, who, _ in seen.run.said if who == seen.subject and code in (*OVER, *OVER.values()) and at <= seen.end_s]
    if not faults or faults[-1] == over:
        return
    event = seen.after(over, seen.subject)
    if event is None or event[0] - seen.end_s > BACK_S:
        wrong.append("its end is not told" if event is None else f"its end is told after {event[0] - seen.end_s:g} s")


def load_words(seen: Seen) -> str:
    """What was told while a load was faulty."""
    said = [(at, code, who) for at, code, who, _ in seen.run.said
            if seen.begin_s < at <= seen.end_s and code not in ("TEST_DONE", "TEST_STEP", "CONFIG_APPLIED")]
    return "; ".join(f"{at - seen.begin_s:g} s: {code} {who}" for at, code, who in said[:3]) or "not told"


def hides_chip(fault: Fault) -> bool:
    """The firmware cannot know what state the chip is in: whether it has just got power, or has heard what was written. The chip of an output that
    has been asked and then hears no more drives its answer into what others on the bus say."""
    what = [event.split("=")[0].split(".") for event in fault.events]
    return any(re.fullmatch(r"(spi|i2c|wire)\d", who) or name in ("missing", "wrong") or (name == "dead" and who != "T1") for who, name in what)


def judge(job: Job, run: Run) -> Cell:
    """Compares what was said and done with what must hold."""
    device, _, fault = find(job)
    seen, wrong = Seen(job, run, device, fault, STATES[job.state]), []
    if run.failed:
        return Cell("", [f"the run ended: {run.failed}"])
    outputs(seen, wrong)
    if run.warned and not hides_chip(fault):
        wrong.append(run.warned)
    if job.device in {load.name for load in LOADS}:
        words = ""
        if fault.told_as == "OUTPUT_FAULT":
            words = told(seen, wrong)
            back(seen, wrong)
        return Cell(words or load_words(seen), wrong)
    words = told(seen, wrong)
    if words and not seen.sometimes and fault.told_as != "INTERLOCK_ON" and lost_since(seen) is None:
        wrong.append("told, but the measurement is not lost")
    readings(seen, wrong)
    fell = fall_back(seen, wrong)
    held_off(seen, wrong)
    back(seen, wrong)
    return Cell(f"{words or 'not told'}; {fell}", wrong)
