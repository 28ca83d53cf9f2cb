"""Automatic start-up of a plant with the firmware in the simulator's own process: `commission` by a script on the console,
and what the console said, taken apart. Needs reflux-sim-memory of the host build; nothing is built here."""

from __future__ import annotations

import csv
import json
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True

from reflux import build  # noqa: E402

SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0}
OUTCOMES = "PROPOSAL|NOT_DETERMINED|COMMISSION_ENDED"


@dataclass(frozen=True)
class Event:
    time_s: float
    code: str
    subject: str
    value: float
    text: str


@dataclass
class Plant:
    """A JSON file of host_sim/plants, or of one's own."""

    path: Path
    data: dict = field(init=False)

    def __post_init__(self) -> None:
        self.data = json.loads(self.path.read_text())

    @property
    def outputs(self) -> list[dict]:
        return self.data["outputs"]

    @property
    def inputs(self) -> list[dict]:
        return self.data["inputs"]

    @property
    def tick_s(self) -> float:
        return self.data["tick_s"]

    def poles(self) -> np.ndarray:
        """1/s."""
        unit = SECONDS[self.data["time_unit"]]
        if self.data["model"] == "state_space":
            return np.linalg.eigvals(np.array(self.data["A"], float)) / unit
        if self.data["model"] in ("discrete", "polynomial"):
            a = np.array(self.data["A"], float)
            if self.data["model"] == "polynomial":
                n = a.shape[1]
                a = np.vstack([np.hstack(list(-a)), np.eye((len(a) - 1) * n, len(a) * n)])
            z = np.linalg.eigvals(a)
            return np.log(z[np.abs(z) > 1e-6] + 0j) / (self.data["period"] * unit)
        poles: list[complex] = []
        for row in self.data["elements"]:
            for e in row[:len(self.inputs)]:
                if e is None:
                    continue
                lags = e.get("lags", [])
                poles += [-1.0 / (t * unit) for t in (lags if isinstance(lags, list) else [lags])]
                if "quadratic" in e:
                    a2, a1 = e["quadratic"]
                    poles += list(np.roots([a2, a1, 1.0]) / unit)
        return np.array(poles)

    def slowest_s(self) -> float:
        """Slowest time constant of what is stable and does not integrate."""
        real = self.poles().real
        return float(-1.0 / max(r for r in real if r < -1e-9))

    def first_order(self) -> dict[tuple[str, str], tuple[float, float, float]]:
        """(output, input): gain, time constant and dead time (s) of the elements that are just that."""
        unit = SECONDS[self.data["time_unit"]]
        found = {}
        for y, row in zip(self.outputs, self.data.get("elements", [])):
            for u, e in zip(self.inputs, row):
                if e is None or {"zero", "quadratic", "integrator", "cases"} & set(e):
                    continue
                lags = e.get("lags", [])
                lags = lags if isinstance(lags, list) else [lags]
                if len(lags) == 1:
                    found[y["name"], u["name"]] = (e["gain"], lags[0] * unit, e.get("dead_time", 0.0) * unit)
        return found

    def perfect_sensors(self) -> list[str]:
        """Events: no resolution. Noise is an option of the run."""
        return [f"0:{y['name']}.resolution=0" for y in self.outputs]


def number(word: str) -> float:
    """nan: `none`, it is not known."""
    return float("nan") if word == "none" else float(word)


def plant(name: str) -> Plant:
    return Plant(ROOT / "host_sim" / "plants" / f"{name}.json")


def committed_pairing(name: str) -> list[tuple[str, str]]:
    pairs = []
    for line in (ROOT / "tests" / "reference" / "linear_pairing.csv").read_text().splitlines():
        words = line.split(",")
        if words[0] == name and words[1] != "none":
            pairs.append((words[1], words[2]))
    return pairs


def configuration(of: Plant) -> list[str]:
    """Every channel as the plant has it; at a start its outputs are where they will be held."""
    lines = ["begin"]
    for kind, channels in (("meas", of.outputs), ("mv", of.inputs)):
        for i, c in enumerate(channels, 1):
            lines += [f"set {kind}{i}.{k} {c[k]}" for k in ("name", "unit", "lo", "hi")]
            if kind == "mv":
                lines += [f"set mv{i}.min {c['lo']}", f"set mv{i}.max {c['hi']}", f"set mv{i}.safe {c['nominal']}"]
    return lines


def read_log(path: Path) -> list[dict[str, float]]:
    """Rows by column, units left off."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return [{name.split("[")[0]: float(value or "nan") for name, value in row.items()} for row in csv.DictReader(lines)]


class Run:
    """A run that has ended. script lines: (time_s, line); times do not go backwards."""

    def __init__(self, of: Plant, script: list[tuple[float, str]], *, noise: float = 0.0, seed: int = 1,
                 events: list[str] = (), duration_s: float = 1e8, log: bool = False, program: Path | None = None,
                 options: tuple[str, ...] = ()):
        program = program or build.find_program("host", "reflux-sim-memory")
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            script_file, said, rows = (Path(folder) / n for n in ("script", "said", "log.csv"))
            script_file.write_text("".join(f"{t:g} {line}\n" for t, line in script))
            command = [str(program), "--plant", str(of.path), "--port", "memory", "--console", "memory", "--duration",
                       f"{duration_s:g}", "--noise", f"{noise:g}", "--seed", str(seed), "--script", str(script_file),
                       "--transcript", str(said), "--timeout", "600", *options]
            if log:
                command += ["--log", str(rows)]
            for e in events:
                command += ["--event", e]
            done = subprocess.run(command, capture_output=True, text=True, timeout=900)
            self.message = done.stderr.strip()
            self.status = done.returncode
            self.said = said.read_text().splitlines() if said.exists() else []
            self.rows = read_log(rows) if log else []
        if self.status != 0:
            raise AssertionError(f"{of.path.stem}: exit status {self.status}: {self.message}")
        self.events = [Event(float(m[1]), m[2], m[3], float(m[4]), m[5]) for line in self.said
                       if (m := re.search(r"< ! (\S+) \w+ (\S+) (\S+) (\S+) (.*)$", line))]

    def first(self, *codes: str) -> Event | None:
        return next((e for e in self.events if e.code in codes), None)

    def all(self, *codes: str) -> list[Event]:
        return [e for e in self.events if e.code in codes]

    def reply(self, command: str) -> list[str]:
        """Payload of the last time this was asked."""
        begins = [n for n, line in enumerate(self.said) if line.endswith(f"> {command}")]
        if not begins:
            raise AssertionError(f"nobody asked for `{command}`")
        lines = []
        for line in self.said[begins[-1] + 1:]:
            text = line.split(" < ", 1)[1]
            if text == "ok" or text.startswith("err "):
                break
            if not text.startswith(("! ", "T,", "H,")):
                lines.append(text)
        return lines

    def elements(self) -> dict[tuple[str, str], dict[str, float]]:
        found = {}
        for line in self.reply("commission model"):
            if m := re.match(r"element (\S+) (\S+) gain (\S+) sd (\S+) \S+ T (\S+) sd (\S+) s L (\S+) sd (\S+) s .*?flags (.*)",
                             line):
                found[m[1], m[2]] = dict(zip(("gain", "gain_sd", "T", "T_sd", "L", "L_sd"), map(number, m.groups()[2:8])),
                                         flags=set(m[9].split()) - {"-"})
                for name in ("square", "zero", "residence"):
                    stated = re.search(rf" {name} (\S+)", line)
                    found[m[1], m[2]][name] = float(stated[1]) if stated else 0.0
        return found

    def pairs(self) -> list[tuple[str, str]]:
        return [(m[1], m[2]) for line in self.reply("commission pairing")
                if (m := re.match(r"pair (\S+) (\S+) ", line))]

    def worst(self) -> float:
        """Largest share of a limit that any test has reached."""
        return max(float(m[1]) for line in self.reply("commission model")
                   if (m := re.search(r"^input .* worst (\S+)", line)))


LISTINGS = ("", " model", " gains", " pairing", " proposal")


def whole(of: Plant, *, settings: list[str] = (), accept: bool = True, after: list[str] = (), extra_s: float = 0.0):
    """Script: configuration, outputs where they belong, tests, listings; on trial where there is a proposal."""
    begin = 5 * of.tick_s
    script = [(0.0, line) for line in [*configuration(of), *settings, "apply"]]
    script += [(of.tick_s, f"out {u['name']} {u['nominal']}") for u in of.inputs]
    script += [(begin, "commission begin"), (begin, f"~until {OUTCOMES}")]
    script += [(begin, f"commission{what}") for what in LISTINGS]
    if accept:
        script += [(begin, "commission accept"), (begin, "~until TRIAL_KEPT|TRIAL_FAILED 1000000"),
                   (begin, "commission trial")]
    script += [(begin, line) for line in after]
    return [*script, (begin, "~end")] if extra_s == 0.0 else script
