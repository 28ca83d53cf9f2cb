"""The campaign of tray temperature control: every structure under every scenario, in both scalings of the slopes; then maps of what
the controllers bear beside plain PIs."""

from __future__ import annotations

import argparse
import hashlib
import math
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from reflux import build, column_slopes, table
from research import trays, trays_claims
from reflux.errors import RunFailed, UserError
from reflux.paths import ROOT
from reflux.schema import Table
from research.trays import Case

SCALINGS = ("printed", "consistent")
IMPURITIES = ("iC4_D", "C3_B")
# Changes of a map, one thing at a time. A period of 5 min is beyond what form euler takes.
CHANGES: tuple[tuple[str, dict[str, Any]], ...] = (
    ("as it is", {}),
    ("noise 0.05 K", {"noise": 0.05}),
    ("noise 0.2 K", {"noise": 0.2}),
    ("noise 0.5 K", {"noise": 0.5}),
    ("period 1 s", {"tick_s": 1.0}),
    ("period 10 s", {"tick_s": 10.0}),
    ("period 60 s", {"tick_s": 60.0}),
    ("period 60 s, joint", {"tick_s": 60.0, "form": "joint"}),
    ("period 120 s", {"tick_s": 120.0}),
    ("period 120 s, joint", {"tick_s": 120.0, "form": "joint"}),
    ("period 300 s, joint", {"tick_s": 300.0, "form": "joint"}),
    ("lag of the sensors 0", {"lag_s": 0.0}),
    ("lag 60 s", {"lag_s": 60.0}),
    ("lag 180 s", {"lag_s": 180.0}),
    ("lag 300 s", {"lag_s": 300.0}),
    ("a times 0.5", {"slope_times": 0.5}),
    ("a times 1.5", {"slope_times": 1.5}),
    ("w times 0.5", {"gains_times": 0.5}),
    ("w times 1.5", {"gains_times": 1.5}),
    ("stiction 0.2 %", {"stiction": 0.002}),
    ("stiction 1 %", {"stiction": 0.01}),
    ("stiction 2 %", {"stiction": 0.02}),
    ("stiction 2 %, mv.band 2.1 %", {"stiction": 0.02, "band": 0.021}),
)


@dataclass(frozen=True)
class Part:
    title: str
    cases: tuple[Case, ...]  # with the consistent slopes
    is_map: bool


@dataclass(frozen=True)
class Trays:
    name: str
    title: str
    about: str
    parts: tuple[Part, ...]

    def cases(self, fraction: float) -> list[Case]:
        out = []
        for part in self.parts:
            for case in part.cases:
                if part.is_map:
                    out += [
                        replace(case, pi=pi, **changed(change, pi)) for _, change in CHANGES for pi in (False, True)
                    ]
                else:
                    out += [replace(case, scaling=scaling) for scaling in SCALINGS]
        wanted = list(dict.fromkeys(out))
        return wanted[:: max(1, round(1 / fraction))]


def changed(change: dict[str, Any], pi: bool) -> dict[str, Any]:
    """PIs have no form."""
    return {key: value for key, value in change.items() if not (pi and key == "form")}


def job_of(case: Case) -> dict[str, Any]:
    """Key that tells it from others; PIs are the same whatever law stands beside them."""
    told = asdict(case)
    if case.pi:
        told["law"] = told["form"] = "pi"
        told["structure"] = first_stages(case.structure)
    return told


def first_stages(name: str) -> str:
    of = trays.structure(name)
    return "sC" + "".join(f"[{p.mv},{p.stages[0]}]" for p in of.pairings)


def load(top: Table, name: str) -> Trays:
    title, about = top.text("title", name), " ".join(top.texts("about"))
    parts = []
    for key, is_map in (("table", False), ("map", True)):
        for one in top.tables(key):
            heading, state = one.text("title"), one.text("state", choices=tuple(trays.STATES))
            scenario = one.text("scenario", choices=tuple(trays.SCENARIOS))
            saturation = one.boolean("saturation", False)
            cases = []
            for line in one.texts("lines"):
                law, _, structure = line.partition(" ")
                trays.structure(structure)
                cases.append(Case(structure, law, "consistent", state, scenario, saturation))
            one.done()
            parts.append(Part(heading, tuple(cases), is_map))
    top.done()
    return Trays(name, title, about, tuple(parts))


def fingerprint(campaign: Trays) -> str:
    digest = hashlib.sha256()
    for file in (
        Path(__file__),
        Path(trays.__file__),
        Path(column_slopes.__file__),
        ROOT / "host_sim" / "plants" / "splitter.json",
        build.find_program("host", "reflux-sim-memory"),
        build.find_program("host", "reflux-sim"),
    ):
        digest.update(file.read_bytes())
    return digest.hexdigest()


def run_one(case: Case) -> dict[str, Any]:
    """In a process of its own. A run that fails is a result too."""
    try:
        return {"job": job_of(case), **asdict(trays.measure(case, trays.run(case)))}
    except (RunFailed, UserError) as error:
        return {"job": job_of(case), "failed": str(error)}


def run_missing(
    cases: list[Any],
    state: Any,
    workers: int,
    job: Callable[[Any], dict[str, Any]] = job_of,
    one: Callable[[Any], dict[str, Any]] = run_one,
) -> None:
    missing = {repr(job(c)): c for c in cases if state.get(job(c)) is None}
    if not missing:
        return
    progress, started = build.Progress("campaign"), time.monotonic()
    with ProcessPoolExecutor(workers) as pool:
        waiting = [pool.submit(one, case) for case in missing.values()]
        try:
            for count, future in enumerate(as_completed(waiting), 1):
                state.add(future.result())
                left = (time.monotonic() - started) / count * (len(missing) - count)
                progress.show(f"{count} of {len(missing)} runs, about {left:.0f} s left")
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    progress.end(f"{len(missing)} runs in {time.monotonic() - started:.0f} s")


# ---- tables ----


def milli(x: float) -> str:
    return "-" if math.isnan(x) else f"{1000 * x:.1f}"


def row_of(case: Case, result: dict[str, Any] | None) -> list[str]:
    head = [case.structure, case.law, case.scaling]
    if result is None or "failed" in result:
        return [*head, "not run" if result is None else "failed"]
    row = head
    for name in IMPURITIES if case.state == "SS2" else IMPURITIES[:1]:
        i = result["impurity"][name]
        row = [*row, milli(i["iae"]), milli(i["low"]), milli(i["peak"]), milli(i["final"]), f"{i['outside_h']:.2f}"]
    if case.state == "SS1":
        row = [*row, f"{1e6 * result['impurity']['C3_B']['final']:.0f}"]
    row = [*row, f"{result['travel']['R']:.0f}", f"{result['travel']['Q'] / 1000:.1f}"]
    if case.saturation:
        leaves = result["leaves_h"]
        row.append("never there" if math.isnan(leaves) else f"{leaves:.2f}")
    return row


def header_of(part: Part) -> list[str]:
    case = part.cases[0]
    out = ["structure", "law", "slopes"]
    for name in IMPURITIES if case.state == "SS2" else IMPURITIES[:1]:
        out += [f"IAE of {name}", "least", "peak", "final", "outside, h"]
    if case.state == "SS1":
        out.append("final C3_B, ppm")
    return [*out, "travel of R, m3/h", "of Q, Gcal/h", *(["at a limit until, h"] if case.saturation else [])]


def cost(case: Case, result: dict[str, Any] | None) -> float:
    """IAE of what is controlled."""
    if result is None or "failed" in result:
        return math.nan
    return sum(result["impurity"][name]["iae"] for name in (IMPURITIES if case.state == "SS2" else IMPURITIES[:1]))


def map_rows(part: Part, state: Any) -> tuple[list[str], list[list[str]]]:
    header = ["", "PI: IAE", *(case.law for case in part.cases), "travel of Q: PI", *(case.law for case in part.cases)]
    rows = []
    for name, change in CHANGES:
        pi_case = replace(part.cases[0], pi=True, **changed(change, True))
        pi_result = state.get(job_of(pi_case))
        pi = cost(pi_case, pi_result)
        row, travel = [name, milli(pi)], [travelled(pi_result)]
        for case in part.cases:
            result = state.get(job_of(replace(case, **change)))
            ratio = cost(case, result) / pi if pi else math.nan
            row.append("-" if math.isnan(ratio) else f"**{ratio:.2f}**" if ratio > 1 else f"{ratio:.2f}")
            travel.append(travelled(result))
        rows.append([*row, *travel])
    return header, rows


def travelled(result: dict[str, Any] | None) -> str:
    return "-" if result is None or "failed" in result else f"{result['travel']['Q'] / 1000:.1f}"


def write_results(campaign: Trays, state: Any, folder: Path) -> None:
    text = [f"# {campaign.title}\n\nWritten by `tools/campaign {campaign.name}`. {campaign.about}\n"]
    for part in campaign.parts:
        text.append(f"\n## {part.title}\n")
        if part.is_map:
            text.append(
                "\nIAE of what is controlled, as part of that of the loops' own PIs (SIMC, docs/use/splitter.md) under the same; above 1, bold, the PI "
                "is better. Slopes consistent.\n"
            )
            header, rows = map_rows(part, state)
        else:
            header = header_of(part)
            rows = [
                row_of(replace(case, scaling=scaling), state.get(job_of(replace(case, scaling=scaling))))
                for case in part.cases
                for scaling in SCALINGS
            ]
        text.append("\n" + table.markdown(header, rows))
    (folder / f"{campaign.name}.md").write_text("".join(text) + "\n", encoding="utf-8")
    (folder / f"{campaign.name}-claims.md").write_text(
        trays_claims.page(campaign.title, finder(state)), encoding="utf-8"
    )


def finder(kept: Any) -> trays_claims.Find:
    def find(
        line: str, scenario: str = "SC1", slopes: str = "printed", state: str = "SS1", saturation: bool = False
    ) -> dict[str, Any]:
        law, _, structure = line.partition(" ")
        case = Case(structure, law, slopes, state, scenario, saturation)
        result = kept.get(job_of(case))
        if result is None or "failed" in result:
            raise RunFailed(f"{line}, {scenario}: there is no result to compare")
        return dict(result)

    return find


def execute(campaign: Trays, options: argparse.Namespace, state: Any) -> int:
    cases = campaign.cases(options.fraction)
    run_missing(cases, state, options.jobs)
    results = [state.get(job_of(c)) for c in cases]
    if not options.check and options.fraction == 1.0:
        write_results(campaign, state, options.results)
    failed = [r for r in results if "failed" in r]
    for part in campaign.parts:
        found = [
            (replace(c, scaling=s), state.get(job_of(replace(c, scaling=s)))) for c in part.cases for s in SCALINGS
        ]
        if not part.is_map and any(r for _, r in found):
            print(f"\n{part.title}\n" + table.columns(header_of(part), [row_of(c, r) for c, r in found if r]))
    for r in failed[:10]:
        print(f"FAILED  {r['job']['structure']} {r['job']['law']}: {r['failed']}")
    print(f"\n{len(results)} runs, {len(failed)} failed")
    return 1 if failed else 0
