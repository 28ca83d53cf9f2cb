"""One whole start-up of a plant by the firmware in the simulator's own process: the console's script, and what the console and the log said."""

from __future__ import annotations

import csv
import math
import re
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from reflux import build
from research import commissioning_stability, startup_plants
from research.startup_judge import PI
from research.startup_linear import Linear

LIMIT = 0.2  # of span: what a user says
TRIAL_MOST_S = 1e8
SLOW_FLAGS = {"short", "not_settled", "slow", "unknown"}
LONGEST_SAMPLES = 1000  # of today's default of test.longest
LONGER_TIMES = 4  # where the board asks for a longer test without a number
LISTINGS = ("", " model", " pairing", " proposal")


@dataclass
class Said:
    """A start-up that has come to an end: outcome, reason, and what was found."""

    outcome: str = "no end"
    reason: str = ""
    doubts: list[str] = field(default_factory=list)
    proposed: bool = False
    tested_s: float = 0.0
    end_s: float = 0.0
    flags: dict[tuple[str, str], set[str]] = field(default_factory=dict)
    elements: dict[tuple[str, str], dict[str, float]] = field(default_factory=dict)
    loops: list[tuple[str, str, float, float, float]] = field(default_factory=list)  # output, input, signed gain, ti_s, td_s
    decoupler: np.ndarray | None = None
    extras: list[str] = field(default_factory=list)  # what the judge does not know: feedforwards, cascades
    events: dict[str, int] = field(default_factory=dict)
    excursion_tests: float = math.nan  # of the limit, by the plant itself
    excursion_trial: float = math.nan
    advice: list[str] = field(default_factory=list)  # "NAME VALUE"


def script(case: startup_plants.PlantCase, settings: list[str]) -> str:
    """Channels, limits and the operating point; all else at its default."""
    data, lines = case.data, ["0 begin"]
    for kind, channels in (("meas", data["outputs"]), ("mv", data["inputs"])):
        for i, c in enumerate(channels, 1):
            lines += [f"0 set {kind}{i}.{key} {c[key]}" for key in ("name", "unit", "lo", "hi")]
            if kind == "meas":
                lines.append(f"0 set meas{i}.test_limit {LIMIT * (c['hi'] - c['lo']):g}")
            else:
                lines += [f"0 set mv{i}.min {c['lo']}", f"0 set mv{i}.max {c['hi']}", f"0 set mv{i}.safe {c['nominal']}"]
    lines += [*(f"0 set {s}" for s in settings), "0 apply"]
    tick = data["tick_s"]
    lines += [f"{tick:g} out {u['name']} {u['nominal']}" for u in data["inputs"]]
    at = f"{5 * tick:g}"
    lines += [f"{at} commission begin", f"{at} ~until PROPOSAL|NOT_DETERMINED|COMMISSION_ENDED"]
    lines += [f"{at} ?commission{what}" for what in LISTINGS]
    # Without a proposal no trial begins, and the run fails there: all that is wanted of it has been said.
    lines += [f"{at} ?commission edit", f"{at} diff", f"{at} ?commission accept", f"{at} ~until TRIAL_BEGUN {10 * tick:g}",
              f"{at} ~until TRIAL_KEPT|TRIAL_FAILED {TRIAL_MOST_S:g}", f"{at} ?commission trial", f"{at} ~end"]
    return "\n".join(lines) + "\n"


_preset = "host"


def use(preset: str) -> None:
    """The build whose program runs, in this process: "host" or "host-fixed"."""
    global _preset
    _preset = preset


def program() -> Path:
    return build.find_program(_preset, "reflux-sim-memory")


def start_up(case: startup_plants.PlantCase, noise: float, seed: int, settings: list[str], longest_s: float) -> Said:
    """settings: "NAME VALUE", besides channels and limits. longest_s: on the clock."""
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        where = Path(folder)
        (where / "plant.json").write_text(startup_plants.text(case), encoding="utf-8")
        (where / "script").write_text(script(case, settings), encoding="utf-8")
        command = [str(program()), "--plant", str(where / "plant.json"), "--port", "memory",
                   "--console", "memory", "--duration", "1e8", "--script", str(where / "script"), "--transcript", str(where / "said"),
                   "--log", str(where / "log"), "--seed", str(seed), "--noise", "1", "--timeout", "300"]
        for event in case.all_events(noise, seed):
            command += ["--event", event]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=longest_s)
            last = done.stderr.strip().splitlines()[-1:]
        except subprocess.TimeoutExpired:
            last = [f"more than {longest_s:g} s on the clock"]
        said = (where / "said").read_text(encoding="utf-8", errors="replace") if (where / "said").exists() else ""
        out = read(said, case, settings)
        if out.outcome == "no end":
            out.reason = (last or ["the simulator said nothing"])[0][-160:]
        if (where / "log").exists():
            excursions(where / "log", case, out)
        return out


# ---- what the console said ----

def read(said: str, case: startup_plants.PlantCase, settings: list[str] = ()) -> Said:
    out = Said()
    for code in re.findall(r"< ! \S+ \w+ ((?:TEST|TRIAL|COMMISSION)_\w+|PROPOSAL|NOT_DETERMINED) ", said):
        out.events[code] = out.events.get(code, 0) + 1
    ended = re.search(r"< ! (\S+) \w+ COMMISSION_ENDED (\S+) \S+ (.*)$", said, re.M)
    failed = re.search(r"< ! (\S+) \w+ TRIAL_FAILED (\S+) \S+ (.*)$", said, re.M)
    found = re.search(r"< ! (\S+) \w+ (PROPOSAL|NOT_DETERMINED) ", said)
    kept = re.search(r"< ! (\S+) \w+ TRIAL_KEPT ", said)
    out.proposed = bool(found and found[2] == "PROPOSAL")
    out.tested_s = float(found[1]) if found else float(ended[1]) if ended else 0.0
    last = [float(t) for t in re.findall(r"^(\d+\.\d+) [<>] ", said, re.M)[-1:]]
    out.end_s = last[0] if last else 0.0
    verdict = re.search(r"< pairing (.*?) probability", said)
    no_design = re.search(r"< no proposal: (.*)$", said, re.M)
    if kept:
        out.outcome = "kept"
    elif failed:
        out.outcome, out.reason = "taken back", f"{failed[2]} {_cause(failed[3])}"
    elif ended:
        out.outcome, out.reason = "ended early", f"{ended[2]} {_cause(ended[3])}"
    elif found and not out.proposed:
        words = [m[1] for m in (verdict, no_design) if m and m[1] != "determined"]
        out.outcome = "not determined" if words and words[0].startswith("not determined") else "refused"
        out.reason = words[0] if words else ""
    out.doubts = [m for m in re.findall(r"< doubt (?!element)(\S+) ", said)]
    out.doubts += [f"{m[0]}/{m[1]}:{m[2].strip().replace(' ', '+')}" for m in re.findall(r"< doubt element (\S+) (\S+) .*?flags (.*)$", said, re.M)]
    if "second_opinion differs" in said:
        out.doubts.append("second")
    _elements(said, out)
    _settings(said, case, out)
    out.advice = advice(said, case, settings)
    return out


def _cause(text: str) -> str:
    return text.split(": ", 1)[-1]


def _elements(said: str, out: Said) -> None:
    """`commission model`: the numbers with their deviations, and the flags. A later firmware may state the residence time itself."""
    for y, u, gain, gain_sd, rest in re.findall(r"< element (\S+) (\S+) gain (\S+) sd (\S+) \S+ (.*)$", said, re.M):
        flags = re.search(r"flags (.*)$", rest)
        out.flags[y, u] = set(flags[1].split()) - {"-"} if flags else set()
        found = {"gain": float(gain), "gain_sd": float(gain_sd)}
        if m := re.search(r"residence (\S+) sd (\S+)", rest):
            found["residence"], found["residence_sd"] = (0.0 if w == "none" else float(w) for w in m.groups())
        elif m := re.search(r"T (\S+) sd (\S+) s L (\S+) sd (\S+) s", rest):
            time, time_sd, dead, dead_sd = (0.0 if w == "none" else float(w) for w in m.groups())
            found["residence"], found["residence_sd"] = time + dead, math.hypot(time_sd, dead_sd)
        out.elements[y, u] = found


def _settings(said: str, case: startup_plants.PlantCase, out: Said) -> None:
    given = commissioning_stability.settings(said)
    if not given or not out.proposed:
        return
    loops, decoupler = given
    inputs = {u["name"] for u in case.data["inputs"]}
    numbers = sorted(n for n, loop in loops.items() if loop.get("out") in inputs)
    out.extras += [f"cascade {loop['name']}" for loop in loops.values() if loop.get("out") not in inputs]
    out.extras += sorted(set(re.findall(r"< set (ff\d+)\.", said)))
    for n in numbers:
        loop = loops[n]
        sign = -1.0 if loop.get("action") == "direct" else 1.0
        out.loops.append((loop["pv"], loop["out"], sign * float(loop["gain"]), float(loop.get("ti", 0)), float(loop.get("td", 0))))
    if decoupler:
        out.decoupler = np.array([[decoupler.get((i, j), float(i == j)) for j in numbers] for i in numbers])


def loops(out: Said, plant: Linear) -> list[PI]:
    return [PI(plant.outputs.index(y), plant.inputs.index(u), kc, ti, td) for y, u, kc, ti, td in out.loops]


def advice(said: str, case: startup_plants.PlantCase, settings: list[str] = ()) -> list[str]:
    """What a user would change who follows the board's words: "NAME VALUE". Lines `advice ... set NAME VALUE` are taken as they stand."""
    found = re.findall(r"< advice .*?set (\S+ [^\s`]+)", said)
    if found:
        return found
    needed: dict[str, float] = {}
    for u, half in re.findall(r"< doubt element \S+ (\S+) half \S+ s needs (\S+) s", said):
        needed[u] = max(needed.get(u, 0.0), float(half))
    names = [u["name"] for u in case.data["inputs"]]
    if needed:
        return [f"mv{names.index(u) + 1}.test_time {half:g}" for u, half in needed.items() if math.isfinite(half)]
    if re.search(r"COMMISSION_ENDED .*`test.longest`", said):
        given = [float(s.split()[1]) for s in settings if s.startswith("test.longest ")]
        return [f"test.longest {LONGER_TIMES * (given[-1] if given else LONGEST_SAMPLES * case.data['tick_s']):g}"]
    return []


# ---- what the log says ----

def excursions(log: Path, case: startup_plants.PlantCase, out: Said) -> None:
    """Largest shares of the limit that the plant itself has reached, no noise and no drift of the instruments, until the proposal and after."""
    with log.open(encoding="utf-8") as lines:
        rows = csv.reader(line for line in lines if line[0] != "#")
        head = [re.sub(r"\[.*", "", cell) for cell in next(rows, [])]
        if not head:
            return
        channels = [(head.index(f"{y['name']}.true"), y["nominal"], LIMIT * (y["hi"] - y["lo"])) for y in case.data["outputs"]]
        worst = [0.0, 0.0]
        for row in rows:
            late = float(row[1]) > out.tested_s > 0.0
            for column, rest, limit in channels:
                worst[late] = max(worst[late], abs(float(row[column]) - rest) / limit)
    out.excursion_tests = worst[0]
    out.excursion_trial = worst[1] if out.proposed else math.nan


# ---- how honest ----

def deviations(out: Said, plant: Linear) -> list[tuple[str, str, float, float, bool]]:
    """Of every element: output, input, errors of gain and average residence time over their deviations, and whether a flag leaves it open."""
    gains, times = plant.gains(), plant.residences()
    found = []
    for (y, u), e in out.elements.items():
        i, j = plant.outputs.index(y), plant.inputs.index(u)
        time = math.nan
        if math.isfinite(times[i, j]) and "residence" in e and "no_gain" not in out.flags[y, u]:  # of no response there is no time
            time = _over(e["residence"] - times[i, j], e["residence_sd"])
        found.append((y, u, _over(e["gain"] - gains[i, j], e["gain_sd"]), time, bool(out.flags[y, u] & (SLOW_FLAGS | {"integrating"}))))
    return found


def _over(error: float, sd: float) -> float:
    return min(max(error / sd, -999.0), 999.0) if sd > 0.0 else 0.0 if error == 0.0 else 999.0


def slow_elements(out: Said, case: startup_plants.PlantCase) -> list[str]:
    """Elements that no set may be kept with, for the tests have not seen their end. One that does integrate may be called so."""
    found = []
    for (y, u), flags in out.flags.items():
        wrong = flags & SLOW_FLAGS
        if "integrating" in flags and not _integrates(case.data, y, u):
            wrong = wrong | {"integrating"}
        if wrong:
            found.append(f"{y}/{u}:{'+'.join(sorted(wrong))}")
    return found


def _integrates(data: dict[str, Any], y: str, u: str) -> bool:
    if data["model"] != "transfer":
        return False
    i = [c["name"] for c in data["outputs"]].index(y)
    j = [c["name"] for c in data["inputs"]].index(u)
    return bool((data["elements"][i][j] or {}).get("integrator"))
