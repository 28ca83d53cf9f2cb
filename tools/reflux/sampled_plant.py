"""Difference models for tools/decouple: those of tools/identify, sampled plants of host_sim/plants, and continuous ones sampled here, exactly,
with inputs that stand still between samples and dead times of any length."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from reflux import board_model, plant_file
from reflux.errors import UserError
from reflux.ina_plant import UNIT, lags_of, paired
from reflux.paths import shown

MOST, A_MOST, B_MOST = 4, 4, 8  # loops; coefficients of A behind its 1, of B from z^-1 on (firmware/lti/difference_model.h)
SAME = 1e-9  # poles, and samples of dead time, that are one but for rounding


@dataclass(frozen=True)
class SampledPlant:
    """A(z^-1) y = B(z^-1) u, as many outputs as inputs, loop k output k by input k. a: n x na, b: n x n x nb, coefficients of z^-1 on, in
    engineering units. Spans are None where nothing says them."""

    name: str
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    a: np.ndarray
    b: np.ndarray
    period: float  # s
    output_spans: np.ndarray | None = None
    input_spans: np.ndarray | None = None
    filtered: str = ""  # setting of the filter that the board found it behind

    @property
    def n(self) -> int:
        return len(self.outputs)

    def in_spans(self) -> SampledPlant:
        """Model in fractions of span; unchanged where there are no spans."""
        if self.output_spans is None or self.input_spans is None:
            return self
        return replace(self, b=self.b * (self.input_spans[None, :] / self.output_spans[:, None])[:, :, None])

    def integrates(self) -> np.ndarray:
        """Outputs with A(1) = 0 but for rounding."""
        return np.abs(1 + self.a.sum(axis=1)) <= SAME * (1 + np.abs(self.a).sum(axis=1))

    def gains(self) -> np.ndarray:
        """At rest. Of an output that integrates: B(1), which is what it gains in a sample but for a factor of its row."""
        at_rest = np.where(self.integrates(), 1.0, 1 + self.a.sum(axis=1))
        return self.b.sum(axis=2) / at_rest[:, None]


def read(name: str, pairs: str | None, period: float | None) -> SampledPlant:
    """period: of sampling, for a continuous plant."""
    if board_model.is_listing(name):
        plant = of_board(Path(name), pairs, period)
        check(plant)
        return plant
    j, path = plant_file.load(name)
    if "period_s" in j:
        plant = identified(j, path, pairs)
    elif j.get("model") in ("state_space", "discrete"):
        raise UserError(f"{path.stem} has matrices: a denominator for each output is not read off them here; identify it (tools/identify --format json)")
    elif "column" in j or j.get("model") not in READERS:
        raise UserError(f"{path.stem} is not linear: identify it (tools/identify --format json)")
    else:
        try:
            plant = of_file(j, pairs, period)
        except (AttributeError, KeyError, TypeError, ValueError, IndexError) as error:
            raise UserError(f"{shown(path)} is not as docs/use/linear-plants.md has it: {type(error).__name__} {error}") from None
    if period is not None and not np.isclose(period, plant.period, rtol=1e-9):
        raise UserError(f"--period {period:g}: {plant.name} is sampled already, every {plant.period:g} s")
    check(plant)
    return plant


def check(plant: SampledPlant) -> None:
    """Checks the sizes that the firmware's model takes; the coefficients themselves are its affair."""
    if plant.n > MOST:
        raise UserError(f"{plant.name} has {plant.n} loops, more than {MOST}: name some with --pairs")
    if plant.a.shape[1] > A_MOST:
        i = next(i for i in range(plant.n) if np.any(plant.a[i, A_MOST:]))
        raise UserError(f"{plant.outputs[i]}: its denominator is of order {1 + int(np.flatnonzero(plant.a[i])[-1])}, and {A_MOST} is the most")
    if plant.b.shape[2] > B_MOST:
        i, j = np.argwhere(np.any(plant.b[:, :, B_MOST:] != 0, axis=2))[0]
        raise UserError(f"{plant.outputs[i]} by {plant.inputs[j]}: B reaches to z^-{1 + int(np.flatnonzero(plant.b[i, j])[-1])}, and z^-{B_MOST} is the most; "
                        f"with a period longer than {plant.period:g} s dead times take fewer samples")


def shortened(x: np.ndarray) -> np.ndarray:
    """Without coefficients at the end that are 0 for all, but one."""
    used = np.flatnonzero(np.any(x.reshape(-1, x.shape[-1]) != 0, axis=0))
    return np.ascontiguousarray(x[..., : max(1, used[-1] + 1 if len(used) else 1)])


# ---- what is sampled already ----


def identified(j: dict[str, Any], path: Path, pairs: str | None) -> SampledPlant:
    """Reads what tools/identify --format json prints."""
    try:
        if any(float(row["A"][0]) != 1 or any(float(x[0]) != 0 for x in row["B"]) for row in j["outputs"]):
            raise ValueError("A has to begin with 1, B with 0")
        names = {"name": path.stem, "outputs": j["outputs"], "inputs": [{"name": str(u)} for u in j["inputs"]]}
        rows, columns = paired(names, pairs)
        a = padded([[float(x) for x in j["outputs"][i]["A"][1:]] for i in rows])
        b = np.array([padded([[float(x) for x in row[1:]] for row in j["outputs"][i]["B"]], 40)[columns] for i in rows])
        period = float(j["period_s"])
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise UserError(f"{shown(path)} has period_s, but else is not what tools/identify --format json prints: {type(error).__name__} {error}") from None
    return SampledPlant(path.stem, tuple(j["outputs"][i]["name"] for i in rows), tuple(str(j["inputs"][k]) for k in columns), shortened(a), shortened(b), period)


def of_board(path: Path, pairs: str | None, period: float | None) -> SampledPlant:
    """Reads the model that a board has found."""
    outputs, inputs, a, b, seconds, filtered = board_model.read(path, period)
    names = {"name": path.stem, "outputs": [{"name": y} for y in outputs], "inputs": [{"name": u} for u in inputs]}
    rows, columns = paired(names, pairs)
    return SampledPlant(path.stem, tuple(outputs[i] for i in rows), tuple(inputs[k] for k in columns), shortened(a[rows]), shortened(b[np.ix_(rows, columns)]),
                        seconds, filtered=filtered)


def padded(rows: list[list[float]], length: int = 1) -> np.ndarray:
    length = max([length, *(len(row) for row in rows)])
    return np.array([row + [0.0] * (length - len(row)) for row in rows])


def of_file(j: dict[str, Any], pairs: str | None, period: float | None) -> SampledPlant:
    rows, columns = paired(j, pairs)
    a, b, seconds = READERS[j["model"]](j, rows, columns, period)
    spans = [np.array([float(j[side][k]["hi"]) - float(j[side][k]["lo"]) for k in which]) for side, which in (("outputs", rows), ("inputs", columns))]
    return SampledPlant(j["name"], tuple(j["outputs"][i]["name"] for i in rows), tuple(j["inputs"][k]["name"] for k in columns), shortened(a), shortened(b),
                        seconds, *spans)


def of_polynomials(j, rows, columns, _period):
    a, b = np.array(j["A"], float), np.array(j["B"], float)
    if np.abs(a - np.einsum("kii->ki", a)[:, :, None] * np.eye(a.shape[1])).max(initial=0.0) > 0:
        raise UserError(f"{j['name']}: A is not diagonal; an output must not stand in another's equation")
    if np.abs(b[0]).max() > 0:
        raise UserError(f"{j['name']}: B[0] is not 0; an input must not act at once")
    poles = np.einsum("kii->ik", a)[rows]
    return poles if poles.shape[1] else np.zeros((len(rows), 1)), b[1:].transpose(1, 2, 0)[np.ix_(rows, columns)], j["period"] * UNIT[j.get("time_unit", "s")]


# ---- continuous plants ----


def asked(j: dict[str, Any], period: float | None) -> float:
    if period is None:
        raise UserError(f"{j['name']} is continuous: --period says how often it is sampled, s{period_to_try(j)}")
    if not 0 < period <= 1e6:
        raise UserError("--period must be above 0, to 1e6 s")
    return period / UNIT[j.get("time_unit", "s")]


def period_to_try(j: dict[str, Any]) -> str:
    """Returns a fifth of the shortest lag, but so much that the longest dead time fits into the model's coefficients; nothing where there is no lag."""
    elements = [e for row in j["elements"] for e in row if e and "cases" not in e]
    lags = [sum(lags_of(e)) for e in elements if sum(lags_of(e)) > 0]
    dead = max((float(e.get("dead_time", 0.0)) for e in elements), default=0.0)
    if not lags:
        return ""
    period = max(min(lags) / 5, dead / (B_MOST - A_MOST)) * UNIT[j.get("time_unit", "s")]
    return f"; try --period {float(f'{period:.2g}'):g}"


def of_elements(j, rows, columns, period):
    step = asked(j, period)
    elements = [[j["elements"][i][k] for k in columns] for i in rows]
    if any(e and "cases" in e for row in elements for e in row):
        raise UserError(f"{j['name']}: has elements with cases; write the one that is meant into a file of its own")
    a, b = [], []
    for i, row in zip(rows, elements):
        common: list[complex] = []
        for e in row:
            common += [p for p in without(poles_of(e), common)] if e else []
        a.append(list(from_poles(common, step)[1:]))
        b.append([list(numerator(e, common, step, f"{j['outputs'][i]['name']} by {j['inputs'][k]['name']}")) if e else [0.0] for e, k in zip(row, columns)])
    longest = max(len(x) for row in b for x in row)
    return padded(a), np.array([padded(row, longest) for row in b]), period


def poles_of(e: dict[str, Any]) -> list[complex]:
    """In s, per time unit of the file."""
    if "quadratic" in e:
        poles = [complex(p) for p in np.roots([e["quadratic"][0], e["quadratic"][1], 1.0])]
    else:
        poles = [complex(-1.0 / lag) for lag in lags_of(e) if lag > 0]
    return poles + ([0j] if e.get("integrator") else [])


def without(poles: list[complex], taken: list[complex]) -> list[complex]:
    """Those that are not among `taken`, each of which stands for one."""
    left = list(taken)
    rest = []
    for p in poles:
        near = next((k for k, q in enumerate(left) if abs(p - q) <= SAME * (abs(p) + abs(q))), None)
        if near is None:
            rest.append(p)
        else:
            del left[near]
    return rest


def from_poles(poles: list[complex], step: float) -> np.ndarray:
    """In z^-1, with zeros where e^(p step) are."""
    return np.real(np.poly(np.exp(np.array(poles, complex) * step))) if poles else np.ones(1)


def numerator(e: dict[str, Any], common: list[complex], step: float, where: str) -> np.ndarray:
    """Coefficients from z^-1 on, over the denominator of all of `common`."""
    own = poles_of(e)
    den = np.real(np.poly(own)) if own else np.ones(1)
    # Lags are 1 + tau s, so the gain goes with the product of the poles that are not 0.
    scale = e["gain"] * np.real(np.prod([-p for p in own if p != 0])) if own else e["gain"]
    num = scale * (np.array([e["zero"], 1.0]) if e.get("zero") else np.ones(1))
    if len(num) > len(den):
        raise UserError(f"{where}: more zeros than poles")
    a, b, c, d = companion(num, den)
    found = sampled(a, b, c, d, float(e.get("dead_time", 0.0)), step, from_poles(own, step), where)
    return np.convolve(found, from_poles(without(common, own), step))


def companion(num: np.ndarray, den: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Companion form of num/den, den with a leading 1."""
    n = len(den) - 1
    num = np.concatenate([np.zeros(n + 1 - len(num)), num])
    a = np.zeros((n, n))
    if n:
        a[0] = -den[1:]
        a[1:, :-1] = np.eye(n - 1)
    return a, np.eye(n, 1)[:, 0], num[1:] - num[0] * den[1:], float(num[0])


def sampled(a, b, c, d, dead: float, step: float, den: np.ndarray, where: str) -> np.ndarray:
    """Numerator over `den`, coefficients of z^-1 on, of C (s - A)^-1 B e^(-s dead) + D with an input that stands still for a step. The part
    of a step by which the dead time exceeds whole ones splits the input's share: Astrom and Wittenmark, Computer-Controlled Systems, 2.3."""
    whole = int(np.floor(dead / step + SAME))
    part = max(0.0, dead - whole * step)
    part = 0.0 if part <= SAME * step else part
    n = len(a)
    now, late, over = held(a, b, step - part)[1], np.zeros(n), held(a, b, step)[0]
    if part:
        late = held(a, b, step - part)[0] @ held(a, b, part)[1]
    answer = np.zeros(whole + n + 3)  # to an impulse; its length is the numerator's and one
    at = whole + (1 if part else 0)
    answer[at] += d
    if d and at == 0:
        raise UserError(f"{where}: acts at once, without lag or dead time; a sampled controller wants an input that acts a sample later")
    x = now
    answer[whole + 1] += c @ x
    x = over @ x + late
    for k in range(whole + 2, len(answer)):
        answer[k] += c @ x
        x = over @ x
    found = np.convolve(answer, den)[1 : whole + n + 2]
    found[np.abs(found) <= 1e-13 * np.abs(found).max(initial=0.0)] = 0.0
    return found


def held(a: np.ndarray, b: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
    """e^(A t), and what an input of 1 for this time adds."""
    from scipy.linalg import expm  # takes a part of a second to load

    n = len(a)
    if not n:
        return np.zeros((0, 0)), np.zeros(0)
    both = np.zeros((n + 1, n + 1))
    both[:n, :n], both[:n, n] = a, b
    found = expm(both * time)
    return found[:n, :n], found[:n, n]


READERS = {"polynomial": of_polynomials, "transfer": of_elements}


# ---- spans ----


def with_spans(plant: SampledPlant, text: str) -> SampledPlant:
    """text: NAME=SPAN,... for every channel, or a plant that has channels of these names."""
    names = (*plant.outputs, *plant.inputs)
    if "=" in text:
        found = {}
        for word in text.split(","):
            name, _, value = word.partition("=")
            try:
                found[name.strip()] = float(value)
            except ValueError:
                raise UserError(f"--spans {text}: {word} must be NAME=SPAN") from None
    else:
        j, _ = plant_file.load(text)
        found = {c["name"]: float(c["hi"]) - float(c["lo"]) for side in ("outputs", "inputs") for c in j.get(side, []) if "hi" in c and "lo" in c}
    wrong = [n for n in names if not 1e-9 <= found.get(n, 0.0) <= 1e9]
    if wrong:
        raise UserError(f"--spans {text}: has no span above 0 for {', '.join(wrong)}")
    return replace(plant, output_spans=np.array([found[n] for n in plant.outputs]), input_spans=np.array([found[n] for n in plant.inputs]))
