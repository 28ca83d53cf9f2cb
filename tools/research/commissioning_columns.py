"""Start-ups of the two columns at an operating point; then a feed disturbance, against the hand-tuned loops. Written down by
tools/figures/column_table.py."""

from __future__ import annotations

import csv
import re
import statistics
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reflux import build, table
from reflux.paths import CAMPAIGNS, SCENARIOS

RESULT = CAMPAIGNS / "results" / "commissioning-columns.md"
HOURS = 6.0  # that the error is integrated over
LONGEST_S = 600  # of one run, on the clock


@dataclass(frozen=True)
class Column:
    plant: str
    held: dict[str, float]  # outputs at the operating point
    loops: tuple[str, ...]  # of the configuration tuned by hand: the same channels
    controlled: tuple[str, ...]
    idle: tuple[str, ...]  # measurements of the configuration that no loop uses
    settle_s: float
    feed: float
    settings: tuple[str, ...] = ()  # what is not left at its default


COLUMNS = (Column("pilot", {"Lr": 4.5, "Qrb": 0.8}, ("top", "bottom"), ("T1", "T10"), (), 3600.0, 5.5),
           Column("splitter", {"R": 61.62, "Q": 4143.05}, ("top", "bottom"), ("T30", "T19"), ("meas3",), 21600.0,
                  1.1 * 88.2))


def run(column: Column, lines: list[str], events: list[str], folder: Path, seed: int = 1) -> tuple[str, Path]:
    (folder / "script").write_text("\n".join(lines) + "\n", encoding="utf-8")
    command = [str(build.find_program("host", "reflux-sim-memory")), "--plant", column.plant, "--port", "memory",
               "--console", "memory", "--duration", "3e6", "--script", str(folder / "script"), "--transcript",
               str(folder / "said"), "--log", str(folder / "log"), "--seed", str(seed), "--noise", "1", "--timeout", "60"]
    for event in events:
        command += ["--event", event]
    subprocess.run(command, capture_output=True, timeout=LONGEST_S)
    return (folder / "said").read_text(encoding="utf-8", errors="replace"), folder / "log"


def configuration(column: Column) -> list[str]:
    text = (SCENARIOS / f"{column.plant}.conf").read_text(encoding="utf-8").splitlines()
    lines = [f"0 {line}" for line in text if line.strip() and not line.startswith("#")]
    return lines + [f"60 out {name} {value}" for name, value in column.held.items()]


def started(column: Column, ends_s: float | None) -> list[str]:
    """The start-up; then, where ends_s is given, the loops go on until then."""
    lines = configuration(column) + ["90 begin", *(f"90 set loop{i}.name -" for i in (1, 2)),
                                     *(f"90 set {name}.test off" for name in column.idle),
                                     *(f"90 set {s}" for s in column.settings),
                                     "90 apply"]
    at = column.settle_s
    lines += [f"{at} commission begin", f"{at} ~until PROPOSAL|NOT_DETERMINED|COMMISSION_ENDED 3000000",
              f"{at} commission model", f"{at} commission proposal", f"{at} commission pairing", f"{at} ?commission accept", f"{at} ~until TRIAL_KEPT|TRIAL_FAILED 1000000"]
    return lines + [f"{ends_s if ends_s else at} ~end"]


def by_hand(column: Column, at: float, ends_s: float) -> list[str]:
    return configuration(column) + [f"{at} mode {loop} auto" for loop in column.loops] + [f"{ends_s} ~end"]


def errors(log: Path, column: Column, from_s: float) -> list[float]:
    """Integrals of the magnitude of each true deviation from its mean in the half hour before, unit times s."""
    with log.open(encoding="utf-8") as file:
        rows = csv.reader(line for line in file if line[0] != "#")
        head = [re.sub(r"\[.*", "", cell) for cell in next(rows)]
        at = [head.index(f"{name}.true") for name in column.controlled]
        before: list[list[float]] = [[] for _ in at]
        total, last = [0.0] * len(at), from_s
        for row in rows:
            t = float(row[1])
            for k, i in enumerate(at):
                if from_s - 1800.0 <= t < from_s:
                    before[k].append(float(row[i]))
                elif from_s <= t <= from_s + HOURS * 3600.0:
                    total[k] += abs(float(row[i]) - sum(before[k]) / len(before[k])) * (t - last)
            last = max(t, from_s)
    return total


def start_up(column: Column, folder: Path, seed: int) -> dict[str, Any]:
    """verdict; proposed_h, hours: until the proposal, until the loops are kept; probability, pairs."""
    out: dict[str, Any] = {"verdict": "does not end", "probability": None, "pairs": [], "rounds": 1}
    said, _ = run(column, started(column, None), [], folder, seed)
    kept = re.search(r"^([\d.]+) < ! .* TRIAL_KEPT", said, re.M)
    proposed = re.search(r"^([\d.]+) < ! .* PROPOSAL", said, re.M)
    told = re.search(r"! [\d.]+ \w+ (?:PROPOSAL|NOT_DETERMINED) - ([\d.]+)", said)
    out["proposed_h"] = (float(proposed.group(1)) - column.settle_s) / 3600.0 if proposed else None
    out["probability"] = float(told.group(1)) if told else None
    out["pairs"] = re.findall(r"< pair (\S+) (\S+) lambda", said)
    out["rounds"] = 1 + said.count(" TEST_EXTENDED ")
    ended = re.findall(r"! [\d.]+ \w+ (COMMISSION_ENDED|NOT_DETERMINED|TRIAL_FAILED) (.*)", said)
    if ended:
        out["verdict"] = " ".join(ended[-1])
    if kept:
        out["verdict"], out["end_s"] = "kept", float(kept.group(1))
        out["hours"] = (out["end_s"] - column.settle_s) / 3600.0
    return out


def of_column(column: Column, seed: int) -> dict[str, Any]:
    with tempfile.TemporaryDirectory(prefix="reflux-") as name:
        folder = Path(name)
        out = start_up(column, folder, seed)
        out["iae"] = None
        if out["verdict"] == "kept":
            at = out["end_s"] + 7200.0
            _, log = run(column, started(column, at + HOURS * 3600.0 + 60.0), [f"{at}:F={column.feed}"], folder, seed)
            out["iae"] = errors(log, column, at)
        at = column.settle_s + 4 * 3600.0
        _, log = run(column, by_hand(column, column.settle_s, at + HOURS * 3600.0 + 60.0), [f"{at}:F={column.feed}"],
                     folder, seed)
        out["hand"] = errors(log, column, at)
    return out


def middle(values: list[float]) -> str:
    """Median, and from least to largest."""
    return f"{statistics.median(values):.3g} ({min(values):.3g} to {max(values):.3g})" if values else "-"


def text(seeds: int) -> str:
    rows, sums = [], []
    for column in COLUMNS:
        results = [of_column(column, seed) for seed in range(1, seeds + 1)]
        for seed, r in enumerate(results, 1):
            rows.append([column.plant, str(seed), ", ".join("-".join(p) for p in r["pairs"]), r["verdict"], str(r["rounds"]), table.figure(r["probability"], 4),
                         table.figure(r["proposed_h"]), table.figure(r.get("hours")),
                         *(table.figure(x, 4) for x in r["iae"] or [None, None]),
                         *(table.figure(x, 4) for x in r["hand"])])
        kept = [r for r in results if r["iae"]]
        sums.append([column.plant, f"{len(kept)} of {seeds}", middle([r["proposed_h"] for r in kept]),
                     middle([r["hours"] for r in kept]),
                     *(middle([r["iae"][k] / r["hand"][k] for r in kept]) for k in range(2))])
    first = table.markdown(["plant", "kept", "proposal after, h", "kept after, h", "IAE over by hand, upper",
                            "IAE over by hand, lower"], sums)
    header = ["plant", "seed", "pairs", "trial", "rounds", "probability", "proposal after, h", "kept after, h", "IAE upper", "IAE lower",
              "by hand, upper", "by hand, lower"]
    return f"""# Start-ups of the two columns at an operating point

Written by `tools/figures/column_table.py`. Started up with everything at its default, from nothing but channels, at the
operating point of their scenario, with the noise of the plant, after {COLUMNS[0].settle_s / 3600:g} h (`pilot`) and
{COLUMNS[1].settle_s / 3600:g} h (`splitter`) there. Two hours after the trial the feed flow goes up by a tenth: IAE is the
integral over {HOURS:g} h of the magnitude of the deviation, kelvin seconds, against the loops tuned by hand
(`host_sim/scenarios/pilot.conf`, `splitter.conf`) under the same disturbance and noise. Upper and lower:
{", ".join(f"{c.controlled[0]} and {c.controlled[1]} of `{c.plant}`" for c in COLUMNS)}. Hours are from the beginning of the
start-up. Median, and least to largest:

{first}

{table.markdown(header, rows)}
"""
