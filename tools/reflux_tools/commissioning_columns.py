"""Start-ups of the two columns at an operating point; then a feed disturbance, against the hand-tuned loops."""

from __future__ import annotations

import csv
import re
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reflux_tools import build, table
from reflux_tools.paths import SCENARIOS

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


COLUMNS = (Column("pilot", {"Lr": 4.5, "Qrb": 0.8}, ("top", "bottom"), ("T1", "T10"), (), 3600.0, 5.5,
                  ("mv1.test_step 0.12", "mv2.test_step 0.015")),
           Column("splitter", {"R": 61.62, "Q": 4143.05}, ("top", "bottom"), ("T30", "T19"), ("meas3",), 3600.0,
                  1.1 * 88.2, ("mv1.test_time 4200", "mv2.test_time 4200")))


def run(column: Column, lines: list[str], events: list[str], folder: Path) -> tuple[str, Path]:
    (folder / "script").write_text("\n".join(lines) + "\n", encoding="utf-8")
    command = [str(build.find_program("host", "reflux-sim-memory")), "--plant", column.plant, "--port", "memory",
               "--console", "memory", "--duration", "3e6", "--script", str(folder / "script"), "--transcript",
               str(folder / "said"), "--log", str(folder / "log"), "--seed", "1", "--noise", "1", "--timeout", "60"]
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
              f"{at} commission", f"{at} ?commission accept", f"{at} ~until TRIAL_KEPT|TRIAL_FAILED 1000000"]
    return lines + [f"{ends_s if ends_s else at} ~end"]


def by_hand(column: Column, at: float, ends_s: float) -> list[str]:
    return configuration(column) + [f"{at} mode {loop} auto" for loop in column.loops] + [f"{ends_s} ~end"]


def errors(log: Path, column: Column, from_s: float) -> list[float]:
    """Integrals of the magnitude of each true deviation from its mean in the half hour before, unit times s."""
    rows = csv.reader(line for line in log.open(encoding="utf-8") if line[0] != "#")
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


def of_column(column: Column) -> dict[str, Any]:
    out: dict[str, Any] = {"plant": column.plant, "verdict": "does not end", "iae": None, "hand": None}
    with tempfile.TemporaryDirectory(prefix="reflux-") as name:
        folder = Path(name)
        said, _ = run(column, started(column, None), [], folder)
        kept = re.search(r"^([\d.]+) < ! .* TRIAL_KEPT", said, re.M)
        proposed = re.search(r"^([\d.]+) < ! .* PROPOSAL", said, re.M)
        out["proposed_h"] = (float(proposed.group(1)) - column.settle_s) / 3600.0 if proposed else None
        ended = re.findall(r"! [\d.]+ \w+ (COMMISSION_ENDED|NOT_DETERMINED|TRIAL_FAILED) (.*)", said)
        if ended:
            out["verdict"] = " ".join(ended[-1])
        if kept:
            out["verdict"], end_s = "kept", float(kept.group(1))
            out["hours"] = (end_s - column.settle_s) / 3600.0
            at = end_s + 7200.0
            _, log = run(column, started(column, at + HOURS * 3600.0 + 60.0), [f"{at}:F={column.feed}"], folder)
            out["iae"] = errors(log, column, at)
        at = column.settle_s + 4 * 3600.0
        _, log = run(column, by_hand(column, column.settle_s, at + HOURS * 3600.0 + 60.0), [f"{at}:F={column.feed}"],
                     folder)
        out["hand"] = errors(log, column, at)
    return out


def text() -> str:
    rows = []
    for column in COLUMNS:
        r = of_column(column)
        for k, name in enumerate(column.controlled):
            rows.append([column.plant, name, r["verdict"], table.figure(r.get("proposed_h")),
                         table.figure(r.get("hours")),
                         table.figure(r["iae"][k] if r["iae"] else None, 4), table.figure(r["hand"][k], 4)])
    header = ["plant", "measurement", "trial", "proposal after, h", "kept after, h", "IAE started up", "IAE by hand"]
    return (f"""## The two columns at an operating point

Started up from nothing but channels, at the operating point of their scenario, with the noise of the plant. Not
everything is left at its default: the columns' gains differ much between up and down, which counts as uncertainty of the
gains, and with defaults alone the pairing stays undetermined (of the pilot column and, narrowly, of the splitter). The
pilot column is given steps of 1 % of span, the splitter halves of 4200 s. Then the feed flow goes up by a tenth:
integral over {HOURS:g} h of the magnitude of the deviation, kelvin seconds, against the loops tuned by hand
(`host_sim/scenarios/pilot.conf`, `splitter.conf`). Hours are from the beginning of the start-up.

{table.markdown(header, rows)}
""")
