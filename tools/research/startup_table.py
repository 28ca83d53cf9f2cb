"""The tables of the campaign of start-ups: what is asked for beside what was found, and the same by class of plant."""

from __future__ import annotations

import math
import statistics
from typing import Iterable

from reflux import table

Row = dict[str, str]
ENGINEER_MS = 2.2  # largest sensitivity with which the engineer's loops count as reached
SOUND_MS, SOUND_MARGIN = 2.5, 1.5
LIMIT_SHARE = 1.05
UNSTABLE_KINDS = {"unstable"}  # a Niederlinski index says nothing of them
STABLE_LINEAR_NOT = {"unstable", "integrating", "backlash", "stiction", "drift", "gain-doubles", "column"}


def kept(row: Row) -> bool:
    return row["outcome"] == "kept"


def unstable(row: Row) -> bool:
    return row["stable"] == "no"


def thin(row: Row) -> bool:
    return row["stable"] == "yes" and (float(row["ms"]) > SOUND_MS or float(row["gain_margin"]) < SOUND_MARGIN)


def sound(row: Row) -> bool:
    return row["stable"] == "yes" and not thin(row)


def wrong(row: Row) -> bool:
    return bool(row["niederlinski"]) and float(row["niederlinski"]) < 0.0 and row["kind"] not in UNSTABLE_KINDS


def excursion(row: Row) -> float:
    values = [float(row[key]) for key in ("excursion_tests", "excursion_trial") if row[key]]
    return max(values, default=math.nan)


def name(row: Row) -> str:
    return f"{row['plant']} seed {row['seed']} noise {row['noise']}"


def harmful(rows: Iterable[Row]) -> list[str]:
    """Runs that must never be."""
    return [f"{name(row)}: kept, and {'unstable' if unstable(row) else 'the pairing is wrong'} on the plant" for row in rows
            if kept(row) and (unstable(row) or wrong(row))]


def reached(engineers: list[Row]) -> set[tuple[str, str, str]]:
    return {(e["plant"], e["seed"], e["noise"]) for e in engineers if e["stable"] == "yes" and float(e["ms"]) <= ENGINEER_MS}


def key(row: Row) -> tuple[str, str, str]:
    return row["plant"], row["seed"], row["noise"]


def deviations(rows: Iterable[Row]) -> tuple[list[float], list[float], int]:
    """Errors of gains and of average residence times over their deviations, of elements that no flag leaves open; and how many are open."""
    gains: list[float] = []
    times: list[float] = []
    flagged = 0
    for row in rows:
        for cell in row["deviations"].split():
            _, gain, time, is_open = cell.rsplit(":", 3)
            if is_open == "1":
                flagged += 1
                continue
            gains.append(float(gain))
            if time != "nan":
                times.append(float(time))
    return gains, times, flagged


def beyond(values: list[float], most: float) -> str:
    return f"{100.0 * sum(abs(v) > most for v in values) / len(values):.1f}" if values else "-"


def share(part: int, whole: int) -> str:
    return f"{part} of {whole}" + (f" ({100.0 * part / whole:.1f} %)" if whole else "")


def demands(rows: list[Row], engineers: list[Row]) -> tuple[list[str], list[list[str]]]:
    able = reached(engineers)
    known = {key(e) for e in engineers}
    of_able = [r for r in rows if key(r) in able]
    kept_rows = [r for r in rows if kept(r)]
    proposed_sound = [r for r in rows if r["proposed"] == "yes" and sound(r)]
    stable_linear = [r for r in rows if r["kind"] not in STABLE_LINEAR_NOT]
    gains, times, flagged = deviations(rows)
    back = sum(r["outcome"] == "taken back" for r in proposed_sound)
    hours = [float(r["hours_tests"]) for r in rows if r["hours_tests"]]
    kept_hours = [float(r["hours_tests"]) for r in kept_rows]
    out = [
        ["kept and unstable on the true plant", "0", share(sum(unstable(r) for r in kept_rows), len(kept_rows))],
        ["kept with gain margin below 1.5 or Ms above 2.5", "at most 1 %", share(sum(thin(r) for r in kept_rows), len(kept_rows))],
        ["wrong pairing kept (Niederlinski index negative)", "0", share(sum(wrong(r) for r in kept_rows), len(kept_rows))],
        [f"kept, where the engineer reaches Ms of {ENGINEER_MS:g}", "at least 90 %", share(sum(kept(r) for r in of_able), len(of_able))],
        ["kept, where the engineer does not", "-", share(sum(kept(r) for r in rows if key(r) in known - able), len(known - able))],
        ["sound loops taken back", "at most 3 %", share(back, len(proposed_sound))],
        ["proposed and not sound", "-", share(sum(r["proposed"] == "yes" and not sound(r) and bool(r["stable"]) for r in rows),
                                              sum(r["proposed"] == "yes" for r in rows))],
        ["kept with an element slow or unknown", "0", share(sum(bool(r["slow"]) for r in kept_rows), len(kept_rows))],
        ["true limit passed by more than 5 %, stable linear plants", "0",
         share(sum(excursion(r) > LIMIT_SHARE for r in stable_linear), len(stable_linear))],
        ["gains beyond 2 sd; beyond 3 sd, %", "7; 1", f"{beyond(gains, 2)}; {beyond(gains, 3)} of {len(gains)}"],
        ["residence times beyond 2 sd; beyond 3 sd, %", "7; 1", f"{beyond(times, 2)}; {beyond(times, 3)} of {len(times)}"],
        ["elements left open by a flag", "-", share(flagged, flagged + len(gains))],
        ["hours of tests, median: all; kept", "-", f"{table.figure(statistics.median(hours))}; "
         f"{table.figure(statistics.median(kept_hours)) if kept_hours else '-'}" if hours else "-"],
        ["start-ups of a run, mean", "-", f"{statistics.fmean(float(r['starts']) for r in rows):.2f}" if rows else "-"],
        ["runs without an end", "0", str(sum(r["outcome"] == "no end" for r in rows))],
    ]
    return ["what", "asked for", "found"], out


CLASS_HEADER = ["class", "runs", "kept", "taken back", "not determined", "refused", "ended early", "engineer can", "kept of these",
                "kept unstable", "kept thin", "wrong pairs", "sound taken back", "slow kept", "worst limit", "passed", "hours"]
HONEST_HEADER = ["class", "elements", "open", "gain > 2 sd, %", "gain > 3 sd, %", "largest", "time > 2 sd, %", "time > 3 sd, %", "largest "]


def by_class(rows: list[Row], engineers: list[Row], of: str = "kind") -> list[list[str]]:
    able = reached(engineers)
    out = []
    for kind in dict.fromkeys(r[of] for r in rows):
        some = [r for r in rows if r[of] == kind]
        kept_rows = [r for r in some if kept(r)]
        of_able = [r for r in some if key(r) in able]
        worst = max((e for r in some if not math.isnan(e := excursion(r))), default=math.nan)
        out.append([kind, str(len(some)), str(len(kept_rows)),
                    *(str(sum(r["outcome"] == o for r in some)) for o in ("taken back", "not determined", "refused", "ended early")),
                    str(len(of_able)), str(sum(kept(r) for r in of_able)), str(sum(unstable(r) for r in kept_rows)),
                    str(sum(thin(r) for r in kept_rows)), str(sum(wrong(r) for r in kept_rows)),
                    str(sum(r["outcome"] == "taken back" and sound(r) for r in some)), str(sum(bool(r["slow"]) for r in kept_rows)),
                    "-" if math.isnan(worst) else f"{worst:.2f}", str(sum(excursion(r) > LIMIT_SHARE for r in some)),
                    table.figure(statistics.median(float(r["hours_tests"]) for r in some))])
    return out


def honesty(rows: list[Row]) -> list[list[str]]:
    out = []
    for kind in dict.fromkeys(r["kind"] for r in rows):
        gains, times, flagged = deviations(r for r in rows if r["kind"] == kind)
        if gains or flagged:
            out.append([kind, str(len(gains)), str(flagged), beyond(gains, 2), beyond(gains, 3), largest(gains), beyond(times, 2),
                        beyond(times, 3), largest(times)])
    return out


def largest(values: list[float]) -> str:
    return table.figure(max(map(abs, values))) if values else "-"


def reasons(rows: list[Row]) -> list[list[str]]:
    """Why runs were not kept, each reason with its count and a plant."""
    found: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        if not kept(row):
            words = row["reason"].split(" ", 1)[-1] if row["outcome"] in ("taken back", "ended early") else row["reason"]
            found.setdefault((row["outcome"], words), []).append(row)
    return [[outcome, words, str(len(some)), ", ".join(dict.fromkeys(r["plant"] for r in some[:4]))]
            for (outcome, words), some in sorted(found.items(), key=lambda item: -len(item[1]))]


def worst_runs(rows: list[Row]) -> list[list[str]]:
    """Kept sets that should not have been, and limits passed."""
    out = []
    for row in rows:
        why = ("unstable" if unstable(row) else "wrong pairing" if wrong(row) else f"Ms {row['ms']}, gain margin {row['gain_margin']}"
               if thin(row) else "") if kept(row) else ""
        if excursion(row) > LIMIT_SHARE:
            why = f"{why}, limit {excursion(row):.2f}".lstrip(", ")
        if why:
            out.append([name(row), row["outcome"], why, row["settings"]])
    return out


def text(title: str, rows: list[Row], engineers: list[Row]) -> str:
    if not rows:
        return f"# {title}\n\nThere are no runs yet.\n"
    parts = [f"# {title}", f"Written by `tools/campaign startup`: {len(rows)} runs of {len({r['plant'] for r in rows})} plants.",
             table.markdown(*demands(rows, engineers)),
             "## By class", table.markdown(CLASS_HEADER, by_class(rows, engineers)),
             "## By plant", table.markdown(["plant", *CLASS_HEADER[1:]],
                                            by_class([r for r in rows if not r["plant"].startswith("random-")], engineers, "plant")),
             "## Stated deviations, stable linear plants", "The error of gain and average residence time over the stated deviation; "
             "that of T + L is taken as the root of the sum of both squares, where the board does not state one.",
             table.markdown(HONEST_HEADER, honesty(rows)),
             "## Why runs were not kept", table.markdown(["outcome", "reason", "runs", "for example"], reasons(rows))]
    bad = worst_runs(rows)
    if bad:
        parts += ["## Runs to look at", table.markdown(["run", "outcome", "why", "settings"], bad)]
    return "\n\n".join(parts) + "\n"
