"""A campaign of controllers, self-tuners first: variants of a few scenarios, each judged beside another of its table by the integral of
the absolute error in windows that the campaign names, as after setpoint changes and after loads."""

from __future__ import annotations

import argparse
import csv
import hashlib
import math
import statistics
import tempfile
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from reflux import build, metrics, runner, table
from research import best_inputs, changed_plant, mv_use
from reflux import scenario as scenarios
from reflux.errors import RunFailed, UserError
from reflux.paths import CAMPAIGNS, shown
from reflux.scenario import Event, Line, Scenario
from reflux.schema import Table

MINUTE = 60.0
# Columns of a table: sums beside those of the first line; or mean and worst of its seeds, and how the MVs were used.
FORMS = ("shares", "figures")
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
    source: tuple[str, ...] = ()  # what the source has, by window
    windows: tuple[tuple[str, tuple[float, float]], ...] = ()  # of its table; min
    console: tuple[str, ...] = ()  # files from the campaign's folder, in place of the scenario's
    measure: tuple[str, ...] = ()  # truths that are measured besides
    plant: str = ""  # what is different about it: changed_plant


@dataclass(frozen=True)
class Part:
    name: str
    title: str
    text: str
    kinds: tuple[str, ...]  # names of its windows


@dataclass(frozen=True)
class Comparison:
    name: str
    title: str
    about: str
    parts: tuple[Part, ...]
    variants: tuple[Variant, ...]
    again_min: float  # how much later everything comes a second time, where the plant's gain changes
    form: str = FORMS[0]

    def jobs(self, fraction: float) -> list[dict[str, Any]]:
        """Returns every n-th line of a part of the campaign, each with the line that it is compared with."""
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
    windows = windows_in(top)
    again, form = top.number("again_min", 0.0, low=0), top.text("form", FORMS[0], choices=FORMS)
    parts: list[Part] = []
    variants: list[Variant] = []
    for one in top.tables("table"):
        heading, text = one.text("title"), " ".join(one.texts("text", []))
        own = windows_in(one) if one.has("windows") else windows
        parts.append(Part(one.text("name"), heading, text, tuple(kind for kind, _ in own)))
        whole = read_variant(one, Variant("", parts[-1].name, "", windows=own))
        for line in one.tables("run"):
            variants.append(read_variant(line, replace(whole, name=line.text("name"))))
            line.done()
            if not variants[-1].scenario:
                raise UserError(f"{line.path('scenario')} is missing")
        one.done()
    top.done()
    campaign = Comparison(name, title, about, tuple(parts), tuple(variants), again, form)
    for variant in variants:
        place_of(campaign, variant)
        if variant.gain and not again:
            raise UserError(f'{variant.part}, "{variant.name}": a gain needs again_min')
    return campaign


def read_variant(at: Table, common: Variant) -> Variant:
    """Settings of a table for all its lines, or of a line for itself: lists come after those of the table, single values in their place."""
    lists = {key: (*getattr(common, key), *at.texts(key, [])) for key in ("set", "send", "events", "measure")}
    texts = {key: at.text(key, getattr(common, key)) for key in ("scenario", "against", "plant")}
    numbers = {key: at.number(key, getattr(common, key)) for key in ("amplitude", "noise", "gain", "from_min")}
    source = tuple(at.texts("source", []))
    if source and len(source) != len(common.windows):
        raise UserError(f"{at.path('source')} needs {len(common.windows)} texts, one for each window")
    return replace(common, **lists, **texts, **numbers, seeds=at.integer("seeds", common.seeds, low=1), source=source,
                   way=at.text("way", "run", choices=WAYS), console=tuple(at.texts("console", list(common.console))))


def windows_in(top: Table) -> tuple[tuple[str, tuple[float, float]], ...]:
    """Names in their order, first and last minute."""
    inner, out = top.table("windows"), []
    for kind in list(inner.data):
        first, last = (float(x) for x in inner.list(kind))
        out.append((kind, (first, last)))
    if not out:
        raise UserError(f"{top.path('windows')} is empty; expected NAME = [first minute, last minute]")
    return tuple(out)


def fingerprint(campaign: Comparison) -> str:
    """Changes with everything a result depends on but the lines themselves, which their jobs carry."""
    digest = hashlib.sha256(repr(campaign.again_min).encode())
    code = [Path(__file__), *(Path(str(module.__file__)) for module in (best_inputs, changed_plant, mv_use))]
    for file in (*code, *sorted({scenario_file(v) for v in campaign.variants})):
        digest.update(file.read_bytes())
        for conf in scenarios.load(file).console if file.suffix == ".toml" else ():
            digest.update(conf.read_bytes())
    for conf in sorted({CAMPAIGNS / name for v in campaign.variants for name in v.console}):
        digest.update(conf.read_bytes())
    for program in ("reflux-sim-memory", "reflux-plant"):
        digest.update(build.find_program("host", program).read_bytes())
    return digest.hexdigest()


# ---- one run ----

def scenario_file(variant: Variant) -> Path:
    return (CAMPAIGNS / variant.scenario).resolve()


def scenario_of(campaign: Comparison, variant: Variant, seed: int, more: tuple[str, ...] = (), firmware: str = "memory") -> Scenario:
    base = scenarios.load(scenario_file(variant)).with_options(firmware=firmware, seed=seed, noise=variant.noise)
    if variant.console:
        files = tuple((CAMPAIGNS / name).resolve() for name in variant.console)
        base = replace(base, console=files, config=tuple(scenarios.read_console_files(files)))
    base = replace(base, measure=base.measure + variant.measure)
    events = base.events if variant.noise == 0 else tuple(e for e in base.events if not e.name.endswith(".resolution"))
    lines = tuple(stepped(base, line, variant.amplitude) for line in base.lines)
    duration = base.duration_s
    if variant.gain:
        later = campaign.again_min * MINUTE
        first = variant.windows[-1][1][1] * MINUTE
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
    out = {kind: (a + later, b + later) for kind, (a, b) in variant.windows}
    if variant.from_min >= 0:
        kind = next(iter(out))
        out[kind] = (variant.from_min, out[kind][1])
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
        if variant.plant:
            scenario = replace(scenario, plant=changed_plant.written(scenario.plant, variant.plant, Path(folder)))
        result = runner.run(scenario, runner.Options(Path(folder) / "out", quiet=True))
        out = judged(campaign, variant, result)
        if campaign.form == "figures":
            spans = [(a * MINUTE, b * MINUTE) for a, b in windows_of(campaign, variant).values()]
            out["use"] = mv_use.told(result, spans)
        events = runner.events_in(Path(folder) / "out" / "transcript.txt")
    taken = [t for t, _, code, text in events if code == "BLOCK_EVENT" and ".adopted" in text]
    lost = [text for _, _, code, text in events if code in ("BLOCK_ALARM", "BLOCK_GAVE_UP") and "block is off" not in text]
    gave_up = [(time / MINUTE, text.split()[0]) for time, _, code, text in events if code == "BLOCK_GAVE_UP" and not text.startswith("asked ")]
    return {**out, "adopted": taken[0] / MINUTE if taken else None, "alarms": [text[:80] for text in lost], "gave_up": gave_up[:1]}


def run_one(campaign: Comparison, job: dict[str, Any], found: str = "") -> dict[str, Any]:
    """In a process of its own. A run that fails is a result too. found: what the search of this line came to with another seed."""
    variant = campaign.variants[job["line"]]
    try:
        if variant.way.startswith("search"):
            chosen = tuple(found.split(", ")) if found else searched(campaign, variant)
            return {"job": job, **simulate(campaign, variant, int(job["seed"]), chosen), "settings": ", ".join(chosen)}
        if variant.way == "best":  # of the plant as it is before anything changes
            chosen = searched(campaign, replace(variant, gain=0.0))
            return {"job": job, **simulate(campaign, variant, 1, chosen), "settings": ", ".join(chosen)}
        if variant.way == "bound":
            return {"job": job, **best_inputs.bound(scenario_of(campaign, variant, 1), windows_of(campaign, variant))}
        return {"job": job, **simulate(campaign, variant, int(job["seed"]))}
    except (RunFailed, UserError) as error:
        return {"job": job, "failed": str(error)}


# ---- the best PIs ----

EVALUATIONS, STARTS = 120, 3


def searched(campaign: Comparison, variant: Variant) -> tuple[str, ...]:
    """Gains and integral times of the loops' own PIDs that make the sum of all windows' IAE (or that of the first), each as part of
    what it is with the settings of the scenario, least: Nelder and Mead's search in their logarithms from three starts, seed 1."""
    import numpy as np
    from scipy.optimize import minimize

    base = scenario_of(campaign, variant, 1)
    judged_by = [kind for kind, _ in variant.windows][:1 if variant.way.endswith("setpoints") else None]
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
        return sum(sum(got[kind]) / sum(first[kind]) for kind in judged_by)

    best = None
    for start in range(STARTS):
        x0 = np.random.default_rng(start).normal(0, 0.5 if start else 0.0, len(numbers))
        found = minimize(cost, x0, method="Nelder-Mead", options={"maxfev": EVALUATIONS, "xatol": 0.02, "fatol": 0.002})
        if best is None or found.fun < best.fun:
            best = found
    assert best is not None
    return settings(best.x)


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
    return figures(campaign, part, lines, results) if campaign.form == "figures" else shares(campaign, part, lines, results)


def shares(campaign: Comparison, part: Part, lines: list[int], results: list[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    loops = max((len(r[part.kinds[0]]) for k in lines for r in of_line(results, k) if part.kinds[0] in r), default=1)
    cited = [i for i in range(len(part.kinds)) if any(any(campaign.variants[k].source[i:i + 1]) for k in lines)]
    header = [""]
    for i, kind in enumerate(part.kinds):
        header += [kind, *(["of these the first loop"] if loops > 1 else []), "against the first line", *(["source"] if i in cited else [])]
    rows = []
    for k in lines:
        variant, found, row = campaign.variants[k], of_line(results, k), [campaign.variants[k].name]
        for i, kind in enumerate(part.kinds):
            value = total(results, k, kind)
            row.append("failed" if math.isnan(value) else table.figure(value))
            if loops > 1:
                row.append("-" if math.isnan(value) else table.figure(statistics.fmean(r[kind][0] for r in found)))
            row.append("" if place_of(campaign, variant) == k else shown_percent(percent(results, campaign, k, kind)))
            row += [variant.source[i] if variant.source else ""] if i in cited else []
        rows.append(row)
    return header, rows


def figures(campaign: Comparison, part: Part, lines: list[int], results: list[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    """Sums over the loops: the mean of the seeds and in brackets the worst; then how the MVs were used."""
    good = {k: [r for r in of_line(results, k) if "failed" not in r] for k in lines}
    used = {k: [r["use"] for r in found if "use" in r] for k, found in good.items()}  # a bound has none
    mvs = next((list(use["moves"]) for found in used.values() for use in found), [])
    rows = []
    for k in lines:
        row = [campaign.variants[k].name]
        for kind in part.kinds:
            row.append(mean_and_worst([sum(r[kind]) for r in good[k]]))
        row.append(table.figure(100 * statistics.fmean(use["at_limit"] for use in used[k])) if used[k] else "-")
        row += [table.figure(statistics.fmean(use["moves"][mv] for use in used[k])) if used[k] else "-" for mv in mvs]
        row.append(given_up(good[k]))
        rows.append(row)
    return ["", *part.kinds, "at a limit, %", *(f"moves of {mv}" for mv in mvs), "gave up"], rows


def given_up(found: list[dict[str, Any]]) -> str:
    """In how many runs a block left its loops to their PIDs, and when first, with the reason."""
    first = sorted(tuple(r["gave_up"][0]) for r in found if r.get("gave_up"))
    if not first:
        return ""
    count = f"{len(first)} of {len(found)}, " if len(found) > 1 else ""
    return f"{count}{first[0][0]:.0f} min, {first[0][1]}"


def mean_and_worst(values: list[float]) -> str:
    if not values:
        return "failed"
    return table.figure(statistics.fmean(values)) + (f" ({table.figure(max(values))})" if len(values) > 1 else "")


def remarks(campaign: Comparison, part: Part, results: list[dict[str, Any]]) -> list[str]:
    """Settings and alarms of the first seed, and in how many of several there were any."""
    out = []
    for k, variant in enumerate(campaign.variants):
        found = of_line(results, k) if variant.part == part.name else []
        for r in (r for r in found if r["job"]["seed"] == 1):
            if "failed" in r:
                out.append(f"{variant.name}: {r['failed']}")
            if r.get("settings"):
                out.append(f"{variant.name}: {r['settings']}")
            if r.get("alarms"):
                out.append(f"{variant.name}: {'; '.join(r['alarms'][:3])}")
        told = sum(1 for r in found if r.get("alarms"))
        if campaign.form == "figures" and told and len(found) > 1:
            out.append(f"{variant.name}: alarms in {told} of {len(found)} runs")
    return out


def text_of(campaign: Comparison, results: list[dict[str, Any]]) -> str:
    out = [f"# {campaign.title}", f"Written by `tools/campaign {campaign.name}`. {campaign.about}"]
    for part in campaign.parts:
        out += [f"## {part.title}", part.text, table.markdown(*rows_of(campaign, part, results))]
        said = remarks(campaign, part, results)
        out += ["\n".join(f"- {s}" for s in said)] if said else []
    return "\n\n".join(x for x in out if x) + "\n"


def write_results(campaign: Comparison, results: list[dict[str, Any]], folder: Path) -> None:
    (folder / f"{campaign.name}.md").write_text(text_of(campaign, results), encoding="utf-8")
    with (folder / f"{campaign.name}.csv").open("w", encoding="utf-8", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        kinds = list(dict.fromkeys(kind for part in campaign.parts for kind in part.kinds))
        writer.writerow(["table", "run", "seed", *(f"{kind} {loop}" for kind in kinds for loop in ("1", "2")), "adopted", "remark"])
        for r in results:
            cells = [f"{r[kind][i]:.5g}" if kind in r and i < len(r[kind]) else "" for kind in kinds for i in (0, 1)]
            adopted = "" if r.get("adopted") is None else f"{r['adopted']:g}"
            writer.writerow([r["job"]["part"], r["job"]["name"], r["job"]["seed"], *cells, adopted,
                             r.get("failed", r.get("settings", "; ".join(r.get("alarms", []))))])
    print(f"results: {shown(folder / campaign.name)}.md and .csv")


def execute(campaign: Comparison, options: argparse.Namespace, state: Any) -> int:
    jobs = [{**job, "what": repr(campaign.variants[job["line"]])} for job in campaign.jobs(options.fraction)]
    missing = [job for job in jobs if state.get(job) is None]
    progress = build.Progress(campaign.name)
    # A search is done once; its other seeds are played with what it came to.
    later = [job for job in missing if job["seed"] > 1 and campaign.variants[job["line"]].way.startswith("search")]
    searched_for = {job["line"]: job for job in jobs if job["seed"] == 1}
    count = 0
    with ProcessPoolExecutor(options.jobs) as pool:
        for stage in ([job for job in missing if job not in later], later):
            waiting = [pool.submit(run_one, campaign, job, (state.get(searched_for[job["line"]]) or {}).get("settings", "") if stage is later else "")
                       for job in stage]
            for future in as_completed(waiting):
                state.add(future.result())
                count += 1
                progress.show(f"{count} of {len(missing)} runs")
    progress.end(f"{len(missing)} runs")
    results = [state.get(job) for job in jobs]
    if options.fraction == 1.0 and not options.check:
        write_results(campaign, results, options.results)
    for part in campaign.parts:
        header, rows = rows_of(campaign, part, results)
        if rows:
            print(f"\n{part.title}\n\n{table.columns(header, rows)}")
    bad = [r for r in results if "failed" in r]
    for r in bad[:10]:
        print(f"FAILED  {r['job']['part']}, {r['job']['name']}: {r['failed']}")
    print(f"\n{len(results)} runs, {len(bad)} failed")
    return 1 if bad else 0
