"""A start-up as its folder holds it: transcript and telemetry read back."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path

from reflux import event_sentences, logs, textfile
from reflux.commission import results
from reflux.commission.board import Event, Plant, event_of, number, plant_of, progress_of
from reflux.errors import RunFailed
from reflux.paths import shown

CONTEXT_SAMPLES = 30  # before a step, in plots and for its rest
LIMIT_SHARE = 0.2     # of span: what test_limit 0 means


@dataclass
class Channel:
    name: str
    unit: str
    lo: float
    hi: float
    limit: float = math.nan  # of a measurement, from rest

    @property
    def span(self) -> float:
        return self.hi - self.lo


@dataclass
class Experiment:
    """Rows of the telemetry: context from `first`, step at `step`, end at `last` (the row after it)."""

    input: str
    round: int
    first: int
    step: int
    last: int
    done: bool
    remarks: list[str] = field(default_factory=list)


@dataclass
class Record:
    folder: Path
    plant: Plant | None
    version: list[str]
    channels: dict[str, Channel]
    events: list[Event]
    log: logs.Log
    model: results.Model
    gains: results.Gains
    pairing: results.Pairing
    structure: results.Structure
    proposal: results.Proposal
    trial: list[results.TrialLoop]
    answers: str
    names: event_sentences.Names = field(default_factory=event_sentences.Names)
    probe: float = 1.0  # factor on a loop's gain on the way back of its step in the trial
    experiments: list[Experiment] = field(default_factory=list)
    time: list[float] = field(default_factory=list)
    outcome: str = ""  # kept, or why not
    kept: bool = False
    columns: dict[str, list[float]] = field(default_factory=dict)

    def column(self, name: str) -> list[float]:
        if name not in self.columns:
            self.columns[name] = self.log.numbers(name)
        return self.columns[name]


def replies(transcript: Path) -> tuple[dict[str, list[list[str]]], list[Event]]:
    """All replies to each command that was not refused, and all events."""
    text = textfile.read(transcript, damaged=True)
    out: dict[str, list[list[str]]] = {}
    events: list[Event] = []
    command, lines = "", []
    for line in text.splitlines():
        match = re.match(r"[\d.]+ ([<>]) (.*)$", line)
        if not match:
            continue
        sign, said = match.groups()
        if sign == ">":
            command, lines = said, []
        elif said.startswith("! "):
            event = event_of(said)
            if event:
                events.append(event)
        elif said == "ok":
            out.setdefault(command, []).append(lines)
            command, lines = "", []
        elif not said.startswith("err "):
            lines.append(said)
    return out, events


def load(folder: Path) -> Record:
    said, events = replies(folder / "transcript.txt")
    log = logs.read_if_log(folder / "telemetry.csv")
    if log is None:
        raise RunFailed(f"{shown(folder / 'telemetry.csv')}: no telemetry header (H, line): nothing was logged")

    def last(command: str) -> list[str]:
        return next((lines for lines in reversed(said.get(command, [])) if lines), [])

    answers = folder / "answers.toml"
    r = Record(folder, plant_of(last("commission plant")), last("version"), channels_of(said.get("list", [])), events, log,
               results.model_of(last("commission model")), results.gains_of(last("commission gains")),
               results.pairing_of(last("commission pairing")), results.structure_of(last("commission structure")),
               results.proposal_of(last("commission proposal")), results.trial_of(last("commission trial")),
               textfile.read(answers) if answers.is_file() else "")
    r.names = event_sentences.names_of(values_of(said.get("list", [])))
    r.probe = probe_of(said.get("list", []))
    r.time = r.column("time")
    r.experiments = experiments_of(r)
    r.kept, r.outcome = outcome_of(r, last("commission"))
    if r.kept and r.pairing.left:
        r.outcome += f"; without a loop: {', '.join(name for _, name, _ in r.pairing.left)}"
    return r


def values_of(lists: list[list[str]]) -> dict[str, str]:
    """The last value of each parameter."""
    values: dict[str, str] = {}
    for lines in lists:
        for line in lines:
            name, _, value = line.partition(" = ")
            values[name] = value.split()[0] if value.split() else "-"
    return values


def channels_of(lists: list[list[str]]) -> dict[str, Channel]:
    """Configured channels by name, from the last `list` that has any."""
    values = values_of(lists)
    out = {}
    for key, name in values.items():
        match = re.match(r"((meas|mv)\d+)\.name$", key)
        if not match or name == "-":
            continue
        group = match[1]
        c = Channel(name, values.get(f"{group}.unit", "-"), number(values[f"{group}.lo"]), number(values[f"{group}.hi"]))
        if match[2] == "meas":
            limit = number(values.get(f"{group}.test_limit", "0"))
            c.limit = (limit if limit > 0 else LIMIT_SHARE * c.span) * (
                0.5 if values.get(f"{group}.test_critical") == "on" else 1.0)
        out[name] = c
    return out


def probe_of(lists: list[list[str]]) -> float:
    """test.probe of the last listing that has it; 1 where it is off or the board has none."""
    found = [number(line.split()[2]) for lines in lists for line in lines if line.startswith("test.probe = ")]
    return found[-1] if found and found[-1] > 0 else 1.0


def experiments_of(r: Record) -> list[Experiment]:
    out: list[Experiment] = []
    round_of: dict[str, int] = {}
    step: Event | None = None
    remarks: list[str] = []
    free = 0  # first row that belongs to no experiment yet
    for event in r.events:
        if event.code == "TEST_STEP":
            step, remarks = event, []
        elif event.code == "TEST_CUT" and step:
            channel = r.channels.get(event.subject)
            far = f"{event.value * channel.span:.3g} {channel.unit}" if channel else f"{100 * event.value:.3g} % of span"
            remarks.append(f"turned round: {event.subject} would have gone {far} from rest")
        elif event.code == "TEST_LONGER" and out:
            out[-1].remarks.append("not at rest at the end: repeated with more time")
        elif event.code == "TEST_SMALLER" and out:
            out[-1].remarks.append("not linear: repeated with smaller steps")
        elif step and event.code in ("TEST_DONE", "COMMISSION_ENDED"):
            at, end = row_at(r.time, step.at_s), row_at(r.time, event.at_s)
            if end - at > 1:
                round_of[step.subject] = round_of.get(step.subject, 0) + 1
                out.append(Experiment(step.subject, round_of[step.subject], max(free, at - CONTEXT_SAMPLES), at, end,
                                      event.code == "TEST_DONE", remarks))
            free, step = end, None
    return out


def row_at(times: list[float], at_s: float) -> int:
    """First row at that time or later."""
    lo, hi = 0, len(times)
    while lo < hi:
        mid = (lo + hi) // 2
        if times[mid] < at_s:
            lo = mid + 1
        else:
            hi = mid
    return lo


def outcome_of(r: Record, status: list[str]) -> tuple[bool, str]:
    """True if loops are kept, and the words for it."""
    try:
        p = progress_of(status)
    except RunFailed:
        return False, "it did not begin"
    for event in reversed(r.events):
        why = event.text.partition(": ")[2] or event.text
        who = "" if event.subject == "-" else event.subject + " "
        if event.code == "TRIAL_KEPT":
            return True, "1 loop kept: it matched the prediction" if event.value == 1 else f"{event.value:g} loops kept: they matched the prediction"
        if event.code == "TRIAL_FAILED":
            return False, f"rolled back: {who}{why}"
        if event.code == "COMMISSION_ENDED":
            return False, f"ended: {who}{why}"
        if event.code in ("PROPOSAL", "NOT_DETERMINED"):
            if r.proposal.why_not:
                return False, f"not determined: {r.proposal.why_not.removeprefix('pairing not determined: ')}"
            return False, "the proposal was rejected" if p.phase == "idle" else "the proposal was not accepted"
    return False, f"it went no further than: {p.phase}"
