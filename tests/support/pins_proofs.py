"""Outputs with `out.proof` on, at a shorted and at a broken load: the cold pilot column at the pins, whose pot shows what its heater does and whose flow
meter shows what the feed's valve or pump does. A cell without a fault shows that nothing is told of an output that is well.

docs/reference/pins.md says what a proof sees, and within which time.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Callable

from board import ROOT
from pins_faults import SAMPLES, Cell, Job, Run, run

SCENARIOS = ROOT / "host_sim" / "scenarios"
FAULT_S, ON_S = 60, 70     # plant time; an output that is switched on is so behind the fault
AFTER_S = 60
NONE, SHORTED, BROKEN = "none", "shorted", "broken"
LIMITS = {"vLr": (0.0, 100.0), "Qrb": (0.0, 1.25), "vD": (0.0, 100.0), "vB": (0.0, 100.0), "vF": (0.0, 100.0), "vCW": (0.0, 100.0)}
NEAR = {"Qrb": 0.004}      # a pulse width counted in ms of 1 s, twice


@dataclass(frozen=True)
class Proof:
    """An output of the cold column by its kind. wiring: its line; rows: its settings beside the scenario's."""

    name: str
    output: str
    row: int
    wiring: str
    rows: tuple[str, ...]


@dataclass(frozen=True)
class State:
    """lines: of the output, at their times. faults: those that it shows, with words; within_s: from the later one of fault and command."""

    name: str
    lines: tuple[tuple[int, float], ...]
    fault: str
    words: str
    within_s: float
    fault_s: float = FAULT_S
    cooled: bool = False  # the condenser has its water, without which an interlock holds the heater off

    @property
    def begin_s(self) -> float:
        return max([self.fault_s, *(at for at, value in self.lines if value > 0 and at > self.fault_s)])

    @property
    def end_s(self) -> float:
        return self.begin_s + self.within_s


# The pot warms by 5 degC in 40 s with the heater at 1.25 kW. It boils at 103 degC, and cools from there by 5 degC in 130 s, or half as fast while what
# the column held runs down into it.
WARM_S, COOL_S, FLOW_S, STILL_S = 60, 600, 30, 60
HEATER_ROWS = ("proof warms", "proof_at chan3", "proof_change 5", f"proof_on {WARM_S}", f"proof_off {COOL_S}", "proof_below 90")
FLOW_ROWS = ("proof flows", "proof_at chan10", "proof_change 0.5", f"proof_on {FLOW_S}", f"proof_off {STILL_S}")
HOT_S = 900
STATES = {
    "Qrb": (State("switched on, cold", ((ON_S, 1.25),), BROKEN, "nothing warms", 2 * WARM_S, cooled=True),
            State("off, cold", (), SHORTED, "it warms", 3 * WARM_S),
            State("off, hot", ((ON_S, 1.25), (HOT_S, 0.0)), SHORTED, "does not cool", COOL_S, HOT_S, cooled=True)),
    "vF": (State("switched on", ((ON_S, 80.0),), BROKEN, "nothing flows", 2 * FLOW_S),
           State("off", (), SHORTED, "it flows", 2 * STILL_S)),
}
CHIP = ("kind ad5422", "pin PC8", "pin2 PC9", "bus spi1")
PROOFS = tuple(Proof(f"{kind}, heater proved", "Qrb", 2, f"Qrb {wiring} lo=0 hi=1.5", rows) for kind, wiring, rows in (
    ("window", "ssr PA1", ("kind window", "pin PA1", "period 2")),
    ("burst", "ssr PA1", ("kind burst", "pin PA1")),
    ("relay", "relay PA1", ("kind relay", "pin PA1")),
    ("pwm", "pwm PA1", ("kind pwm", "pin PA1")),
    ("analog", "pwm PA1", ("kind analog", "pin PA1")),
    ("ad5422, 0-10 V", "ad5422 spi1 PC9 clear=PC8 signal=voltage", (*CHIP, "range 0-10V")),
)) + tuple(Proof(f"{kind}, flow proved", "vF", 5, f"vF {wiring} hi=100", rows) for kind, wiring, rows in (
    ("pwm", "pwm PA1", ("kind pwm", "pin PA1")),
    ("motor_valve", "valve PC2 PC3 PC0 PC1 travel=5", ()),
    ("stepper", "stepper PC8 PC9 steps=14.4", ("kind stepper", "pin PC8", "pin2 PC9", "flow 100", "steps 14.4", "ramp 2000")),
    ("ad5422, 4-20 mA", "ad5422 spi1 PC9 clear=PC8", (*CHIP, "range 4-20mA")),
))
PROVED = {proof.name: proof for proof in PROOFS}


def can(proof: Proof, fault: str) -> bool:
    """A motor that turns a valve or pump has no shorted load."""
    return fault != SHORTED or not proof.name.startswith(("motor_valve", "stepper"))


def states_of(name: str) -> list[str]:
    return [state.name for state in STATES[PROVED[name].output]]


def proof_jobs() -> list[Job]:
    """Each fault in the state that shows it, and each state without one."""
    return [Job(proof.name, fault, state.name) for proof in PROOFS for fault in (NONE, SHORTED, BROKEN) for state in STATES[proof.output]
            if fault == NONE or (fault == state.fault and can(proof, fault))]


def find_proof(job: Job) -> tuple[Proof, State]:
    proof = PROVED[job.device]
    return proof, next(state for state in STATES[proof.output] if state.name == job.state)


def conf(name: str) -> list[str]:
    lines = (SCENARIOS / name).read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def simulate_proof(job: Job, place: Path | None = None, wire: Callable[[Path], str] | None = None) -> Run:
    proof, state = find_proof(job)
    wiring = [line for line in conf("pilot-cold-pins.wiring") if line.split()[0] != proof.output] + [proof.wiring]
    # Two steps behind the sequences of the demonstration are not there.
    lines = [*conf("pilot-cold.conf"), *(line for line in conf("pilot-cold-pins.conf") if not line.startswith("set step"))]
    unset = ("pin -", "pin2 -", "end_open -", "end_closed -") if proof.rows else ()
    rows = [*unset, *proof.rows, *(FLOW_ROWS if proof.output == "vF" else HEATER_ROWS)]
    lines += ["begin", "set tick.base 1", *(f"set out{proof.row}.{row}" for row in rows), "apply", "log on"]
    timed = [(0.0, line) for line in lines] + [(3.0, f"out {name} 0") for name in LIMITS if name != "vCW"]
    timed += [(3.0, f"out vCW {100 if state.cooled else 0}"), *((float(at), f"out {proof.output} {value:g}") for at, value in state.lines)]
    end_s = state.end_s + 2 * SAMPLES
    events = [] if job.fault == NONE else [f"{state.fault_s:g}:{proof.output}.{job.fault}=1", f"{end_s:g}:{proof.output}.{job.fault}=0"]
    return run(wiring, [f"{at:g} {line}" for at, line in sorted(timed, key=lambda each: each[0])], events, end_s + AFTER_S, place, wire, "pilot-cold")


def beyond(proof: Proof, seen: Run) -> list[str]:
    """Outputs outside their limits: what the plant gets, and of the proved one what the board reports."""
    out = []
    for name, (lo, hi) in LIMITS.items():
        values = [float(row[f"{name}.app"]) for row in seen.rows.values()] if name == proof.output else [float(row[f"{name}.cmd"]) for row in seen.log]
        near = NEAR.get(name, 0.2)
        if name == proof.output and proof.name.startswith("relay"):
            hi = 1.5  # it has no part of its span
        bad = [value for value in values if not lo - near <= value <= hi + near]
        if bad:
            out.append(f"{name} is {bad[0]:g}, {len(bad)} times")
    return out


def judge_proof(job: Job, seen: Run) -> Cell:
    """What was told of the output, against what its proof sees."""
    proof, state = find_proof(job)
    if seen.failed:
        return Cell("", [f"the run ended: {seen.failed}"])
    wrong = beyond(proof, seen)
    if seen.warned:
        wrong.append(seen.warned)
    told = [(at, rest) for at, code, who, rest in seen.said if (code, who) == ("OUTPUT_CONTRADICTED", proof.output)]
    others = sorted({code for _, code, who, _ in seen.said if code == "OUTPUT_FAULT" or (code == "OUTPUT_CONTRADICTED" and who != proof.output)})
    wrong += [f"{code} of another output or kind" for code in others]
    if job.fault == NONE:
        return Cell("not told", wrong + [f"told although it is well: {rest}" for _, rest in told])
    if not told:
        return Cell("not told", [*wrong, "it is not told"])
    at, rest = told[0][0] - state.begin_s, told[0][1]
    if state.words not in rest:
        wrong.append(f"told as: {rest}")
    if not 0.0 < at <= state.within_s + SAMPLES:
        wrong.append(f"told after {at:g} s, not {state.within_s:g} s")
    if seen.log and told[0][0] < state.fault_s:
        wrong.append("told before the fault")
    return Cell(f"{at:g} s: {state.words}", wrong)
