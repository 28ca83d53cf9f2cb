"""Results of a start-up, from the listings of `commission` (docs/use/console.md), and as tables."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

from reflux import table
from reflux.commission.board import number, pairs_of
from reflux.commission.progress import span_of_time


@dataclass
class TestedInput:
    name: str
    held: float
    amplitude: float
    unit: str
    half_s: float
    rounds: int
    worst: float
    remarks: str = ""  # skipped, cut by ..., small


@dataclass
class Element:
    """gain (zero s + 1) exp(-dead s) / (square s2 + time s + 1), engineering units and seconds; sd: standard deviations."""

    measurement: str
    input: str
    unit: str
    gain: float
    gain_sd: float
    time_s: float
    time_sd_s: float
    dead_s: float
    dead_sd_s: float
    flags: list[str]
    moments: tuple[float, float, float] | None = None  # gain, T, L: the second opinion
    moments_flags: list[str] = field(default_factory=list)
    plateau: float = 0.0
    square_s2: float = 0.0  # 0: one lag
    zero_s: float = 0.0
    residence: tuple[float, float] | None = None  # average residence time and its sd; older boards do not say

    @property
    def shape(self) -> str:
        """Lags and zero in words; nothing for one lag."""
        if self.square_s2 <= 0:
            return ""
        halves = self.time_s ** 2 / 4 - self.square_s2
        if halves < 0:
            lags = f"damping {self.time_s / 2 / math.sqrt(self.square_s2):.2g}"
        else:
            lags = " and ".join(f"{table.figure(self.time_s / 2 + sign * math.sqrt(halves))} s" for sign in (1, -1))
            lags = f"lags {lags}"
        return lags + (f", zero {table.figure(self.zero_s)} s" if self.zero_s else "")

    @property
    def has_gain(self) -> bool:
        return "no_gain" not in self.flags


@dataclass
class Model:
    inputs: list[TestedInput] = field(default_factory=list)
    noise: dict[str, tuple[float, str]] = field(default_factory=dict)
    elements: dict[tuple[str, str], Element] = field(default_factory=dict)
    direction: list[str] = field(default_factory=list)  # lines about the test of all inputs together

    def measurements(self) -> list[str]:
        return list(self.noise)

    def tested(self) -> list[str]:
        return [i.name for i in self.inputs if i.rounds > 0]


@dataclass
class Gains:
    rank: int = 0
    rank_exact: int = 0
    condition: float = float("nan")
    condition_scaled: float = float("nan")
    singular: list[float] = field(default_factory=list)
    null_inputs: dict[str, float] = field(default_factory=dict)
    null_outputs: dict[str, float] = field(default_factory=dict)
    rga_inputs: list[str] = field(default_factory=list)
    rga: dict[str, list[float]] = field(default_factory=dict)


@dataclass
class Pairing:
    verdict: str = ""
    probability: float = float("nan")
    niederlinski: float = float("nan")
    pairs: list[tuple[str, str, float, float]] = field(default_factory=list)  # lambda, share of draws
    open: list[tuple[str, float, str]] = field(default_factory=list)  # measurement, share, rival
    second_opinion: str = ""  # of gains over residence times
    determinant: float = float("nan")  # in its own standard deviations
    doubts: list[str] = field(default_factory=list)  # what speaks against it, in words
    warnings: list[str] = field(default_factory=list)  # what the operator has to know of the pairs
    choices: list[list[str]] = field(default_factory=list)  # pairings that would do: inputs in the order of the pairs; of many loops none
    short: list[tuple[str, str, float]] = field(default_factory=list)  # measurement, input, half in s that it needs
    left: list[tuple[str, str, str]] = field(default_factory=list)  # measurement or input, name, why it has no loop

    @property
    def determined(self) -> bool:
        return self.verdict == "determined"

    @property
    def rivals(self) -> bool:
        """Do the draws disagree about an input?"""
        return any(share < 1 for _, share, _ in self.open)


@dataclass
class Loop:
    measurement: str
    input: str
    gain: float
    ti_s: float
    td_s: float
    action: str
    step: float
    iae: float
    overshoot: float
    settles_s: float


@dataclass
class InnerLoop:
    """Below the loop on `below`, which drives its setpoint."""

    measurement: str
    input: str
    gain: float
    ti_s: float
    action: str
    below: str


@dataclass
class Feedforward:
    source: str
    to: str
    numbers: dict[str, float]  # gain in spans; lead, lag, dead, late in s; left: of the integral of the error
    used: str  # yes, or why not


@dataclass
class Proposal:
    why_not: str = ""
    rule: str = ""
    factor: float = float("nan")
    factor_least: float = float("nan")  # the same where no part of the plant has one of its own
    log_modulus_db: float = float("nan")
    # Largest sensitivities and complementary ones, of the worst plant drawn and of the model; older boards give the three above.
    sensitivity: list[float] = field(default_factory=list)
    lowered: float = 1.0  # by what all gains of a part had to be multiplied in the end
    decoupler: str = ""
    others: list[str] = field(default_factory=list)  # lines that this tool has no table for
    loops: list[Loop] = field(default_factory=list)
    inner: list[InnerLoop] = field(default_factory=list)
    feedforwards: list[Feedforward] = field(default_factory=list)


@dataclass
class TrialLoop:
    measurement: str
    input: str
    step: float
    iae: float
    iae_predicted: float
    overshoot: float
    overshoot_predicted: float


def model_of(lines: list[str]) -> Model:
    m = Model()
    for line in lines:
        words = line.split()
        if words[0] == "input" and len(words) >= 13:
            v = pairs_of(words[2:6])
            rest = pairs_of([*words[7:9], *words[10:14]])
            m.inputs.append(TestedInput(words[1], number(v["held"]), number(v["amplitude"]), words[6],
                                        number(rest["half"]), int(rest["rounds"]), number(rest["worst"]),
                                        " ".join(words[14:])))
        elif words[0] == "output" and len(words) >= 5:
            m.noise[words[1]] = (number(words[3]), words[4])
        elif words[0] == "element" and len(words) >= 20:
            m.elements[words[1], words[2]] = Element(
                words[1], words[2], words[7], number(words[4]), number(words[6]), number(words[9]), number(words[11]),
                number(words[14]), number(words[16]), _flags(words))
            e = m.elements[words[1], words[2]]
            if found := re.search(r" square (\S+)", line):
                e.square_s2 = number(found[1])
            if found := re.search(r" zero (\S+)", line):
                e.zero_s = number(found[1])
            if found := re.search(r" residence (\S+) sd (\S+)", line):
                e.residence = number(found[1]), number(found[2])
        elif words[0] in ("direction", "along"):
            m.direction.append(line)
        elif words[0] == "moments" and len(words) >= 12 and (words[1], words[2]) in m.elements:
            e, v = m.elements[words[1], words[2]], pairs_of(words[3:11])
            e.moments = (number(v["gain"]), number(v["T"]), number(v["L"]))
            e.plateau, e.moments_flags = number(v["plateau"]), _flags(words)
    return m


def _flags(words: list[str]) -> list[str]:
    after = words[words.index("flags") + 1:] if "flags" in words else []
    return [w for w in after if w != "-"]


def gains_of(lines: list[str]) -> Gains:
    g = Gains()
    for line in lines:
        words = line.split()
        if words[0] == "rank":
            v = pairs_of(words)
            g.rank, g.rank_exact = int(v["rank"]), int(v["exact"])
            g.condition, g.condition_scaled = number(v["condition"]), number(v["scaled"])
        elif words[0] == "singular":
            g.singular = [number(w) for w in words[1:]]
        elif words[0] == "null":
            null = g.null_inputs if words[1] == "inputs" else g.null_outputs
            null.update({k: number(v) for k, v in pairs_of(words[2:]).items()})
        elif words[0] == "rga" and not g.rga_inputs:
            g.rga_inputs = [] if words[1:2] == ["none:"] else words[1:]
        elif words[0] == "rga":
            g.rga[words[1]] = [number(w) for w in words[2:]]
    return g


def pairing_of(lines: list[str]) -> Pairing:
    p = Pairing()
    for line in lines:
        words = line.split()
        if words[0] == "pairing":
            head, _, rest = line.partition(" probability ")
            p.verdict = head.removeprefix("pairing ")
            v = pairs_of(["probability", *rest.split()])
            p.probability, p.niederlinski = number(v["probability"]), number(v.get("niederlinski", "nan"))
            p.determinant = number(v.get("determinant", "nan"))
        elif words[0] == "pair":
            v = pairs_of(words[3:])
            p.pairs.append((words[1], words[2], number(v["lambda"]), number(v["share"])))
        elif words[0] == "open":
            v = pairs_of(words[2:])
            p.open.append((words[1], number(v["share"]), v.get("rival", "-")))
        elif words[0] == "second_opinion":
            p.second_opinion = line.removeprefix("second_opinion ")
        elif words[0] == "doubt" and words[1] == "element":
            p.doubts.append(_element_doubt(words))
            if words[4] == "half":
                p.short.append((words[2], words[3], number(words[8])))
        elif words[0] == "doubt":
            p.doubts.append(line.removeprefix("doubt "))
        elif words[0] == "subset":
            p.warnings.append(f"the loops on {', '.join(words[4:])} run away while the others are in manual: their Niederlinski "
                              f"index is {table.figure(number(words[2]))}")
        elif words[0] == "choice":
            p.choices.append(words[words.index("inputs") + 1:])
        elif words[0] == "left":
            p.left.append((words[1], words[2].rstrip(":"), line.partition(": ")[2]))
    return p


def _element_doubt(words: list[str]) -> str:
    """doubt element MEASUREMENT INPUT [half S s needs S s] flags ..."""
    measurement, source, *rest = words[2:]
    flags = ", ".join(_flags(words))
    if rest[0] != "half":
        return f"{measurement} by {source} is {flags}: no loop is made of it"
    half, needs = span_of_time(number(rest[1])), span_of_time(number(rest[4]))
    return (f"{measurement} by {source} is {flags}: half a double step of {source} took {half}, and must take {needs} or more "
            "(`time`, `longest`)")


def proposal_of(lines: list[str]) -> Proposal:
    p = Proposal()
    for line in lines:
        words = line.split()
        if line.startswith("no proposal"):
            p.why_not = line.partition(": ")[2]
        elif words[0] == "settings":
            if found := re.search(r"Ms (\S+) nominal (\S+) Mt (\S+) nominal (\S+)(?: lowered (\S+))?", line):
                p.sensitivity = [number(x) for x in found.groups()[:4]]
                p.rule, p.lowered = line[len("settings "):found.start()].strip(), number(found[5] or "1")
                continue
            head, _, rest = line.partition(", slowed by ")
            v = pairs_of(["factor", *rest.split()])
            p.rule, p.factor = head.removeprefix("settings "), number(v["factor"])
            p.factor_least = number(v.get("least", v["factor"]))
            p.log_modulus_db = number(v.get("log_modulus_dB", "nan"))
        elif words[0] == "decoupler":
            p.decoupler = line.removeprefix("decoupler ")
        elif words[0] == "loop" and len(words) >= 10:
            v = pairs_of([*words[3:9], *words[10:]])
            p.loops.append(Loop(words[1], words[2], number(v["gain"]), number(v["ti"]), number(v["td"]), words[9],
                                number(v["step"]), number(v["iae"]), number(v["overshoot"]), number(v["settles"])))
        elif words[0] == "inner" and len(words) >= 12:
            v = pairs_of(words[3:9])
            p.inner.append(InnerLoop(words[1], words[2], number(v["gain"]), number(v["ti"]), words[9], words[11]))
        elif words[0] == "feedforward" and " used " in line:
            v = pairs_of(words[7:19])
            p.feedforwards.append(Feedforward(words[3], words[6], {k: number(x) for k, x in v.items()},
                                              line.partition(" used ")[2]))
        else:
            p.others.append(line)
    return p


@dataclass
class Block:
    part: int
    worst_lambda: float
    driven_by: list[int]
    members: list[tuple[str, str, bool]] = field(default_factory=list)  # measurement, input, served by single loops


@dataclass
class Structure:
    parts: int = 0
    blocks: list[Block] = field(default_factory=list)
    ways: list[tuple[str, str, dict[str, float]]] = field(default_factory=list)  # from input, to input
    cascades: list[tuple[str, str, dict[str, float], str]] = field(default_factory=list)  # inner, outer, how, used
    multivariable: dict[int, str] = field(default_factory=dict)  # block: what it gets


def structure_of(lines: list[str]) -> Structure:
    s = Structure()
    for line in lines:
        words = line.split()
        if words[0] == "structure" and words[1:2] == ["parts"]:
            s.parts = int(words[2])
        elif words[0] == "block" and len(words) >= 11:
            v = pairs_of(words[1:9])
            s.blocks.append(Block(int(v["part"]), number(v["worst_lambda"]),
                                  [int(w) for w in words[10:] if w != "-"]))
        elif words[0] == "member" and len(words) >= 7 and 0 < int(words[4]) <= len(s.blocks):
            s.blocks[int(words[4]) - 1].members.append((words[1], words[2], words[6] == "yes"))
        elif words[0] == "way" and len(words) >= 8:
            s.ways.append((words[3], words[6], {k: number(v) for k, v in pairs_of(words[7:]).items()}))
        elif words[0] == "cascade" and len(words) >= 15:
            s.cascades.append((words[2], words[4], {k: number(v) for k, v in pairs_of(words[5:13]).items()},
                               line.partition(" used ")[2]))
        elif words[0] == "multivariable" and words[1:2] == ["block"]:
            s.multivariable[int(words[2])] = line.partition(" gets ")[2]
    return s


def trial_of(lines: list[str]) -> list[TrialLoop]:
    out = []
    for line in lines:
        words = line.split()
        if words[0] == "trial" and len(words) >= 13:
            n = [number(w) for w in words[4::2]]
            out.append(TrialLoop(words[1], words[2], *n[:5]))
    return out


# ---- tables: the same on a terminal and in the report ----
