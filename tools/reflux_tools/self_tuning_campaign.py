"""A campaign of self-tuners: variants of a few scenarios, each judged beside another of its table by the integral of
the absolute error after setpoint changes and after loads."""

from __future__ import annotations

import argparse
import csv
import hashlib
import math
import re
import statistics
import tempfile
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from reflux_tools import best_inputs, build, metrics, runner, table
from reflux_tools import scenario as scenarios
from reflux_tools.errors import RunFailed, UserError
from reflux_tools.paths import CAMPAIGNS, ROOT, shown
from reflux_tools.scenario import Event, Line, Scenario
from reflux_tools.schema import Table

MINUTE = 60.0
PAGE = ROOT / "docs" / "self-tuning-experiments.md"
KINDS = ("setpoints", "loads")
WAYS = ("run", "search", "search setpoints", "best", "bound")


@dataclass(frozen=True)
class Variant:
    """One line of a table."""

    name: str
    part: str  # the table it stands in
    scenario: str  # a path from the campaign's folder
    set: tuple[str, ...] = ()  # parameters and their values
    send: tuple[str, ...] = ()  # "minute console line"
    events: tuple[str, ...] = ()  # "minute NAME=VALUE"
    against: str = ""  # the line of the same table that it is compared with; none: itself
    amplitude: float = 1.0  # of the setpoint changes
    noise: float = 0.0
    seeds: int = 1
    gain: float = 0.0  # the plant's gain from then on, and all of it once more; 0: only once
    from_min: float = -1.0  # the setpoints' window begins here
    way: str = "run"
    source: tuple[str, str] = ("", "")  # what the source has, of setpoints and loads
    windows: tuple[tuple[str, tuple[float, float]], ...] = ()  # of its table, in place of the campaign's


@dataclass(frozen=True)
class Part:
    name: str
    title: str
    text: str


@dataclass(frozen=True)
class Comparison:
    name: str
    title: str
    about: str
    windows: dict[str, tuple[float, float]]  # min
    parts: tuple[Part, ...]
    variants: tuple[Variant, ...]
    again_min: float  # how much later everything comes a second time, where the plant's gain changes

    def jobs(self, fraction: float) -> list[dict[str, Any]]:
        """Of a part of the campaign every so-manieth line, with what it is compared with."""
        step = max(1, round(1 / fraction))
        wanted = {k for k in range(0, len(self.variants), step)}
        wanted |= {place_of(self, self.variants[k]) for k in wanted}
        return [{"line": k, "part": v.part, "name": v.name, "seed": seed} for k, v in enumerate(self.variants)
                if k in wanted and (fraction == 1.0 or v.way == "run") for seed in range(1, v.seeds + 1)]


def place_of(campaign: Comparison, variant: Variant) -> int:
    """Which line it is compared with."""
    name = variant.against or variant.name
    found = [k for k, v in enumerate(campaign.variants) if (v.part, v.name) == (variant.part, name)]
    if not found:
        raise UserError(f'{variant.part}, "{variant.name}": there is no line "{name}" to compare it with')
    return found[0]


# ---- the file ----

def load(top: Table, name: str) -> Comparison:
    title, about = top.text("title", name), " ".join(top.texts("about"))
    inner = top.table("windows")
    windows = {kind: pair(inner, kind) for kind in KINDS}
    inner.done()
    again = top.number("again_min", above=0)
    parts: list[Part] = []
    variants: list[Variant] = []
    for one in top.tables("table"):
        parts.append(Part(one.text("name"), one.text("title"), " ".join(one.texts("text", []))))
        defaults = {key: one.text(key, "") for key in ("scenario", "against")}
        numbers = {key: one.number(key, value) for key, value in (("amplitude", 1.0), ("noise", 0.0), ("gain", 0.0),
                                                                ("from_min", -1.0))}
        common, seeds = tuple(one.texts("set", [])), one.integer("seeds", 1, low=1)
        sent = tuple(one.texts("send", []))
        own = tuple((kind, pair(one, kind)) for kind in KINDS if one.has(kind))
        for line in one.tables("run"):
            variants.append(replace(read_variant(line, parts[-1].name, defaults, numbers, common, sent, seeds), windows=own))
        one.done()
    top.done()
    campaign = Comparison(name, title, about, windows, tuple(parts), tuple(variants), again)
    for variant in variants:
        place_of(campaign, variant)
    return campaign


def read_variant(line: Table, part: str, defaults: dict[str, str], numbers: dict[str, float], common: tuple[str, ...],
                 sent: tuple[str, ...], seeds: int) -> Variant:
    values = {key: line.text(key, value) for key, value in defaults.items()}
    counted = {key: line.number(key, value) for key, value in numbers.items()}
    source = [str(x) for x in line.texts("source", ["", ""])]
    if len(source) != 2:
        raise UserError(f"{line.path('source')} needs two texts, for setpoints and for loads")
    variant = Variant(line.text("name"), part, set=common + tuple(line.texts("set", [])), send=sent + tuple(line.texts("send", [])),
                      events=tuple(line.texts("events", [])), seeds=line.integer("seeds", seeds, low=1),
                      way=line.text("way", "run", choices=WAYS), source=(source[0], source[1]), **values, **counted)
    line.done()
    if not variant.scenario:
        raise UserError(f"{line.path('scenario')} is missing")
    return variant


def pair(inner: Table, key: str) -> tuple[float, float]:
    first, last = (float(x) for x in inner.list(key))
    return first, last


def fingerprint(campaign: Comparison) -> str:
    """Changes with everything a result depends on but the lines themselves, which their jobs carry."""
    digest = hashlib.sha256(repr((campaign.windows, campaign.again_min)).encode())
    for file in (Path(__file__), Path(best_inputs.__file__), *sorted({scenario_file(v) for v in campaign.variants})):
        digest.update(file.read_bytes())
        for conf in scenarios.load(file).console if file.suffix == ".toml" else ():
            digest.update(conf.read_bytes())
    for program in ("reflux-sim-memory", "reflux-plant"):
        digest.update(build.find_program("host", program).read_bytes())
    return digest.hexdigest()


# ---- one run ----

def scenario_file(variant: Variant) -> Path:
    return (CAMPAIGNS / variant.scenario).resolve()


def scenario_of(campaign: Comparison, variant: Variant, seed: int, more: tuple[str, ...] = (), firmware: str = "memory") -> Scenario:
    base = scenarios.load(scenario_file(variant)).with_options(firmware=firmware, seed=seed, noise=variant.noise)
    events = base.events if variant.noise == 0 else tuple(e for e in base.events if not e.name.endswith(".resolution"))
    lines = tuple(stepped(base, line, variant.amplitude) for line in base.lines)
    duration = base.duration_s
    if variant.gain:
        later = campaign.again_min * MINUTE
        first = campaign.windows["loads"][1] * MINUTE
        duration += later
        lines += tuple(replace(line, at_s=line.at_s + later) for line in lines if line.at_s + later >= first)
        mvs = [Event(first, f"{loop.mv}.gain", variant.gain) for loop in base.loops]
        events += tuple(mvs) + tuple(replace(e, at_s=e.at_s + later) for e in events if e.at_s > 0)
    for text in variant.events:
        minute, what = text.split(" ", 1)
        name, value = what.split("=")
        events += (Event(float(minute) * MINUTE, name, float(value)),)
    for text in variant.send:
        minute, said = text.split(" ", 1)
        lines += (Line(float(minute) * MINUTE, said),)
    # Into the last transaction of the configuration: what changes later would find the self-tuner begun.
    settings = tuple(Line(0.0, f"set {text}") for text in (*variant.set, *more))
    assert base.config[-1].text == "apply"
    config = (*base.config[:-1], *settings, base.config[-1])
    by_time = sorted(lines, key=lambda line: line.at_s)
    return replace(base, lines=tuple(by_time), events=tuple(events), duration_s=duration, config=config)


def stepped(base: Scenario, line: Line, factor: float) -> Line:
    """A setpoint line with its distance from the loop's first setpoint times the factor."""
    words = line.text.split()
    if factor == 1.0 or words[0] != "sp":
        return line
    first = next(float(x.text.split()[2]) for x in base.lines if x.text.split()[:2] == words[:2])
    return replace(line, text=f"sp {words[1]} {first + factor * (float(words[2]) - first):.9g}")


def windows_of(campaign: Comparison, variant: Variant) -> dict[str, tuple[float, float]]:
    later = campaign.again_min if variant.gain else 0.0
    out = {kind: (a + later, b + later) for kind, (a, b) in (dict(variant.windows) or campaign.windows).items()}
    if variant.from_min >= 0:
        out["setpoints"] = (variant.from_min, out["setpoints"][1])
    return out


def judged(campaign: Comparison, variant: Variant, result: runner.Result) -> dict[str, Any]:
    """IAE of each loop in degC min, or whatever the unit, in each window."""
    out: dict[str, Any] = {}
    for kind, (first, last) in windows_of(campaign, variant).items():
        out[kind] = []
        for loop in result.scenario.loops:
            data = metrics.trace(result.log, loop)
            inside = [k for k, t in enumerate(data.t) if first * MINUTE <= t <= last * MINUTE]
            out[kind].append(metrics.iae(*([row[k] for k in inside] for row in (data.t, data.y, data.r))) / MINUTE)
    return out


def simulate(campaign: Comparison, variant: Variant, seed: int, more: tuple[str, ...] = (),
             firmware: str = "memory") -> dict[str, Any]:
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        scenario = scenario_of(campaign, variant, seed, more, firmware)
        result = runner.run(scenario, runner.Options(Path(folder), quiet=True))
        out = judged(campaign, variant, result)
        events = runner.events_in(Path(folder) / "transcript.txt")
    taken = [t for t, _, code, text in events if code == "BLOCK_EVENT" and ".adopted" in text]
    lost = [text for _, _, code, text in events if code in ("BLOCK_ALARM", "BLOCK_GAVE_UP") and "block is off" not in text]
    return {**out, "adopted": taken[0] / MINUTE if taken else None, "alarms": [text[:80] for text in lost]}


def run_one(campaign: Comparison, job: dict[str, Any]) -> dict[str, Any]:
    """In a process of its own. A run that fails is a result too."""
    variant = campaign.variants[job["line"]]
    try:
        if variant.way.startswith("search"):
            return {"job": job, **searched(campaign, variant)}
        if variant.way == "best":  # of the plant as it is before anything changes
            chosen = tuple(searched(campaign, replace(variant, gain=0.0))["settings"].split(", "))
            return {"job": job, **simulate(campaign, variant, 1, chosen), "settings": ", ".join(chosen)}
        if variant.way == "bound":
            return {"job": job, **best_inputs.bound(scenario_of(campaign, variant, 1), windows_of(campaign, variant))}
        return {"job": job, **simulate(campaign, variant, int(job["seed"]))}
    except (RunFailed, UserError) as error:
        return {"job": job, "failed": str(error)}


# ---- the best PIs ----

EVALUATIONS, STARTS = 120, 3


def searched(campaign: Comparison, variant: Variant) -> dict[str, Any]:
    """Gains and integral times of the loops' own PIDs that make the sum of both windows' IAE (or that of setpoints), each as part of
    what it is with the settings of the scenario, least: Nelder and Mead's search in their logarithms from three starts."""
    import numpy as np
    from scipy.optimize import minimize

    base = scenarios.load(scenario_file(variant))
    numbers = [(f"loop{k}.{what}", float(next(line.text.split()[2] for line in reversed(base.config)
                                              if line.text.startswith(f"set loop{k}.{what} "))))
               for k in range(1, len(base.loops) + 1) for what in ("gain", "ti")]

    def settings(x: Any) -> tuple[str, ...]:
        return tuple(f"{name} {value * math.exp(d):.5g}" for (name, value), d in zip(numbers, x))

    first = simulate(campaign, variant, 1)

    def cost(x: Any) -> float:
        if max(abs(x)) > 4:
            return 1e3
        got = simulate(campaign, variant, 1, settings(x))
        return sum(sum(got[kind]) / sum(first[kind]) for kind in (KINDS[:1] if variant.way.endswith("setpoints") else KINDS))

    best = None
    for start in range(STARTS):
        x0 = np.random.default_rng(start).normal(0, 0.5 if start else 0.0, len(numbers))
        found = minimize(cost, x0, method="Nelder-Mead", options={"maxfev": EVALUATIONS, "xatol": 0.02, "fatol": 0.002})
        if best is None or found.fun < best.fun:
            best = found
    assert best is not None
    chosen = settings(best.x)
    return {**simulate(campaign, variant, 1, chosen), "settings": ", ".join(chosen)}


# ---- results ----

def of_line(results: list[dict[str, Any]], line: int) -> list[dict[str, Any]]:
    return [r for r in results if r["job"]["line"] == line]


def total(results: list[dict[str, Any]], line: int, kind: str) -> float:
    """Sum over the loops, mean over the seeds; NaN where a run failed."""
    found = of_line(results, line)
    if not found or any("failed" in r or kind not in r for r in found):
        return math.nan
    return statistics.fmean(sum(r[kind]) for r in found)


def percent(results: list[dict[str, Any]], campaign: Comparison, line: int, kind: str) -> float:
    mine = total(results, line, kind)
    other = total(results, place_of(campaign, campaign.variants[line]), kind)
    return 100 * (mine / other - 1) if other > 0 else math.nan


def shown_percent(value: float) -> str:
    if math.isnan(value):
        return "-"
    return f"x {1 + value / 100:.0f}" if value >= 300 else f"{value:+.0f} %"


def rows_of(campaign: Comparison, part: Part, results: list[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    lines = [k for k, v in enumerate(campaign.variants) if v.part == part.name and of_line(results, k)]
    loops = max((len(r["setpoints"]) for k in lines for r in of_line(results, k) if "setpoints" in r), default=1)
    cited = [i for i in (0, 1) if any(campaign.variants[k].source[i] for k in lines)]
    kinds = [(i, kind) for i, kind in enumerate(KINDS) if any(kind in r for k in lines for r in of_line(results, k)) or not lines]
    header = [""]
    for i, kind in kinds:
        header += [kind, *(["of these the first loop"] if loops > 1 else []), "against the first line", *(["source"] if i in cited else [])]
    rows = []
    for k in lines:
        variant, found, row = campaign.variants[k], of_line(results, k), [campaign.variants[k].name]
        for i, kind in kinds:
            value = total(results, k, kind)
            row.append("failed" if math.isnan(value) else table.figure(value))
            if loops > 1:
                row.append("-" if math.isnan(value) else table.figure(statistics.fmean(r[kind][0] for r in found)))
            row.append("" if place_of(campaign, variant) == k else shown_percent(percent(results, campaign, k, kind)))
            row += [variant.source[i]] if i in cited else []
        rows.append(row)
    return header, rows


def remarks(campaign: Comparison, part: Part, results: list[dict[str, Any]]) -> list[str]:
    out = []
    for r in results:
        variant = campaign.variants[r["job"]["line"]]
        if variant.part != part.name or r["job"]["seed"] != 1:
            continue
        if "failed" in r:
            out.append(f"{variant.name}: {r['failed']}")
        if r.get("settings"):
            out.append(f"{variant.name}: {r['settings']}")
        if r.get("alarms"):
            out.append(f"{variant.name}: {'; '.join(r['alarms'][:3])}")
    return out


def text_of(campaign: Comparison, results: list[dict[str, Any]]) -> str:
    out = [f"# {campaign.title}", f"Written by `tools/campaign {campaign.name}`. {campaign.about}"]
    for part in campaign.parts:
        out += [f"## {part.title}", part.text, table.markdown(*rows_of(campaign, part, results))]
        said = remarks(campaign, part, results)
        out += ["\n".join(f"- {s}" for s in said)] if said else []
    return "\n\n".join(x for x in out if x) + "\n"


def write_results(campaign: Comparison, results: list[dict[str, Any]]) -> None:
    folder = CAMPAIGNS / "results"
    (folder / f"{campaign.name}.md").write_text(text_of(campaign, results), encoding="utf-8")
    with (folder / f"{campaign.name}.csv").open("w", encoding="utf-8", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["table", "run", "seed", *(f"{kind} {loop}" for kind in KINDS for loop in ("1", "2")), "adopted", "remark"])
        for r in results:
            cells = [f"{r[kind][i]:.5g}" if kind in r and i < len(r[kind]) else "" for kind in KINDS for i in (0, 1)]
            adopted = "" if r.get("adopted") is None else f"{r['adopted']:g}"
            writer.writerow([r["job"]["part"], r["job"]["name"], r["job"]["seed"], *cells, adopted,
                             r.get("failed", r.get("settings", "; ".join(r.get("alarms", []))))])
    copy_tables(campaign, results)
    print(f"results: {shown(folder / campaign.name)}.md and .csv")


def copy_tables(campaign: Comparison, results: list[dict[str, Any]]) -> None:
    """Into the page, between <!-- table NAME --> and <!-- end of table -->."""
    page = PAGE.read_text(encoding="utf-8")
    for part in campaign.parts:
        rows = table.markdown(*rows_of(campaign, part, results))
        page = re.sub(rf"(<!-- table {re.escape(part.name)} -->\n).*?(<!-- end of table -->)",
                      lambda m: m.group(1) + "\n" + rows + "\n\n" + m.group(2), page, flags=re.S)
    PAGE.write_text(page, encoding="utf-8")


def execute(campaign: Comparison, options: argparse.Namespace, state: Any) -> int:
    jobs = [{**job, "what": repr(campaign.variants[job["line"]])} for job in campaign.jobs(options.fraction)]
    missing = [job for job in jobs if state.get(job) is None]
    progress = build.Progress(campaign.name)
    with ProcessPoolExecutor(options.jobs) as pool:
        waiting = [pool.submit(run_one, campaign, job) for job in missing]
        for count, future in enumerate(as_completed(waiting), 1):
            state.add(future.result())
            progress.show(f"{count} of {len(missing)} runs")
    progress.end(f"{len(missing)} runs")
    results = [state.get(job) for job in jobs]
    if options.fraction == 1.0 and not options.check:
        write_results(campaign, results)
    for part in campaign.parts:
        header, rows = rows_of(campaign, part, results)
        if rows:
            print(f"\n{part.title}\n\n{table.columns(header, rows)}")
    bad = [r for r in results if "failed" in r]
    for r in bad[:10]:
        print(f"FAILED  {r['job']['part']}, {r['job']['name']}: {r['failed']}")
    print(f"\n{len(results)} runs, {len(bad)} failed")
    return 1 if bad else 0
