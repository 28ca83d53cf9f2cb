"""The campaign of adaptive feedforward (tools/research/feedforward_study.py and feedforward_other_plants.py): sums of J beside the source's published
parameters, each method and case, integrals after a step of the disturbance, the experiment on the source's rig and on the pilot column."""

from __future__ import annotations

import argparse
import hashlib
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from reflux import build, high_order, table
from research import feedforward_other_plants, feedforward_study, trays_campaign
from reflux.errors import RunFailed, UserError
from research.feedforward_other_plants import Pilot, Rig
from research.feedforward_study import Case, ratios, si, sim
from research.kalman_1989_campaign import changed_in
from reflux.paths import build_dir
from reflux.schema import Table

CELL, RUN = 0.02, 0.15  # of J0: most of a case's median above the published, most of a run above J*
RETUNED_S = 5.0  # method A where it is not begun anew


@dataclass(frozen=True)
class Line:
    case: Case  # of method A
    name: str
    note: str
    wanted: bool  # has to reach what is asked for
    by_case: bool

    def case_of(self, method: str) -> Case:
        every = RETUNED_S if method == "A" and self.case.carry else 0.0
        return replace(self.case, method=method, every_s=every)


@dataclass(frozen=True)
class Feedforward:
    name: str
    title: str
    about: str
    seeds: tuple[int, ...]
    lines: tuple[Line, ...]
    other_plants: tuple[tuple[Rig | Pilot, str], ...]

    def part(self, fraction: float) -> Feedforward:
        return replace(self, seeds=self.seeds[: max(2, round(len(self.seeds) * fraction))])

    def jobs(self, whole: bool) -> list[dict[str, Any]]:
        """In part: all methods of the first line, one in turn of each line that has other code or other signals than those before, and each method
        once on the pilot column."""
        lines = {(c.core, c.search, c.carry, c.disturbance): line for line in reversed(self.lines) for c in [line.case]}
        played = [line for line in self.lines if whole or line in lines.values()]
        wanted: list[Any] = [line.case_of(m) for i, line in enumerate(played) for j, m in enumerate(si.METHODS) if whole or i == 0 or i % 4 == j]
        seen: set[str] = set()
        for case, _ in self.other_plants:
            if whole or isinstance(case, Rig) or case.method not in seen:
                wanted.append(case)
                seen.add("" if isinstance(case, Rig) else case.method)
        return [job_of(c, self.seeds) for c in wanted]


def load(top: Table, name: str) -> Feedforward:
    title, about = top.text("title", name), " ".join(top.texts("about"))
    first = top.integer("first_seed", 1)
    seeds = tuple(range(first, first + top.integer("seeds", low=1, high=1000)))
    lines, other_plants = [], []
    for one in top.tables("line"):
        words = one.text("with", "")
        line = Line(changed_in(Case(), words), one.text("name"), words, one.boolean("wanted", False), one.boolean("by_case", False))
        for method in si.METHODS:
            feedforward_study.check(line.case_of(method))
        lines.append(line)
        one.done()
    for key, kind in (("rig", Rig), ("pilot", Pilot)):
        for one in top.tables(key):
            words = one.text("with", "")
            other_plants.append((changed_in(kind(), words), words))
            one.done()
    top.done()
    return Feedforward(name, title, about, seeds, tuple(lines), tuple(other_plants))


def fingerprint(_: Feedforward) -> str:
    digest = hashlib.sha256()
    for file in (feedforward_study.__file__, feedforward_other_plants.__file__, high_order.__file__, sim.__file__, si.__file__, *(build_dir(p) / "libreflux_board.so" for p in ("host", "host-fixed")),
                 build.find_program("host", "reflux-plant")):
        digest.update(Path(str(file)).read_bytes())
    return digest.hexdigest()


def job_of(case: Any, seeds: tuple[int, ...]) -> dict[str, Any]:
    kind = {Case: "regimes", Rig: "rig", Pilot: "pilot"}[type(case)]
    return {"kind": kind, **asdict(case), "first_seed": seeds[0], "seeds": len(seeds)}


def case_of(job: dict[str, Any]) -> tuple[Any, list[int]]:
    rest = dict(job)
    kind, first, count = rest.pop("kind"), rest.pop("first_seed"), rest.pop("seeds")
    return {"regimes": Case, "rig": Rig, "pilot": Pilot}[kind](**rest), list(range(first, first + count))


def run_one(job: dict[str, Any]) -> dict[str, Any]:
    """In a process of its own. A run that fails is a result too."""
    case, seeds = case_of(job)
    try:
        if isinstance(case, Case):
            return {"job": job, **feedforward_study.measured(case, seeds)}
        if isinstance(case, Rig):
            return {"job": job, "runs": [feedforward_other_plants.play_rig(case, seed) for seed in seeds]}
        count = 10 if case.method in feedforward_other_plants.METHODS else 1  # nothing is random in the others
        return {"job": job, "runs": [feedforward_other_plants.play_pilot(case, seed) for seed in seeds[:count]]}
    except (RunFailed, UserError, RuntimeError, np.linalg.LinAlgError) as error:
        return {"job": job, "failed": str(error)}


# ---- what is asked for ----


@cache
def known() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """J* and J0 by case, and the optima."""
    best = sim.exact(ratios())
    return sim.objective(best, ratios()), sim.objective((0, 0, 0), ratios()), best


def published(who: str) -> np.ndarray:
    return np.asarray(sim.objective(np.array(sim.PUBLISHED[who]), ratios()))


def j_of(result: dict[str, Any]) -> np.ndarray:
    """[cases, seeds]"""
    return np.asarray(sim.objective(np.array(result["tunings"]), ratios()[:, None, :]))


@dataclass(frozen=True)
class Verdict:
    total: float  # median of the sums over the cases
    cell: float  # worst median of a case above the published, in J0
    cell_of: str
    run: float  # worst run above J*, in J0
    run_of: str
    misses: tuple[str, ...]


def verdict(method: str, result: dict[str, Any]) -> Verdict:
    j, (least, none, _), theirs = j_of(result), known(), published(method)
    total = float(np.median(j.sum(axis=0)))
    cells, runs = (np.median(j, axis=1) - theirs) / none, ((j - least[:, None]) / none[:, None]).max(axis=1)
    c, r = int(cells.argmax()), int(runs.argmax())
    misses = []
    if total > theirs.sum():
        misses.append(f"sum {total:.1f}, published {theirs.sum():.1f}")
    if cells[c] > CELL:
        misses.append(f"{sim.REGIMES[c].name} {cells[c]:.3f} J0 above the published")
    if runs[r] > RUN:
        misses.append(f"a run of {sim.REGIMES[r].name} {runs[r]:.3f} J0 above J*")
    return Verdict(total, float(cells[c]), sim.REGIMES[c].name, float(runs[r]), sim.REGIMES[r].name, tuple(misses))


# ---- tables ----


def sums_table(campaign: Feedforward, state: Any) -> tuple[list[str], list[list[str]]]:
    header = ["line", "with", *(f"{m}: sum, cell, run" for m in si.METHODS)]
    rows = [["published parameters", "", *(f"{published(m).sum():.1f}" for m in si.METHODS)]]
    for line in campaign.lines:
        cells = []
        for m in si.METHODS:
            result = state.get(job_of(line.case_of(m), campaign.seeds))
            if result is None or "failed" in result:
                cells.append("not run" if result is None else f"failed: {result['failed'][:40]}")
                continue
            v = verdict(m, result)
            text = f"{v.total:.1f}, {v.cell:+.3f}, {v.run:.3f}"
            cells.append(f"**{text}**" if v.misses else text)
        rows.append([line.name, line.note, *cells])
    return header, rows


def fixed_words(campaign: Feedforward, state: Any) -> str:
    """Distance of lines in fixed point from the same in float32."""
    most = 0.0
    for line in campaign.lines:
        if line.case.core == "fixed":
            for m in si.METHODS:
                ours, same = (state.get(job_of(c, campaign.seeds)) for c in (line.case_of(m), replace(line.case_of(m), core="firmware")))
                if ours and same and "failed" not in ours and "failed" not in same:
                    most = max(most, float(np.max(np.abs(j_of(ours) - j_of(same)) / known()[1][:, None])))
    return f"Between fixed point and float32 J of no run differs by more than {most:.4f} J0." if most else ""


def cases_table(campaign: Feedforward, state: Any, line: Line) -> str:
    least, none, _ = known()
    header = ["case", "J0", "J*", *(f"{m}: published, median, worst" for m in si.METHODS)]
    rows = []
    for i, regime in enumerate(sim.REGIMES):
        row = [regime.name, f"{none[i]:.1f}", f"{least[i]:.2f}"]
        for m in si.METHODS:
            j = j_of(state.get(job_of(line.case_of(m), campaign.seeds)))[i]
            row.append(f"{published(m)[i]:.2f}, {np.median(j):.2f}, {j.max():.2f}")
        rows.append(row)
    return table.markdown(header, rows)


def pairs(db: np.ndarray, degrees: np.ndarray) -> str:
    return "; ".join(f"{a:+.2f}, {b:+.1f}" for a, b in zip(db, degrees))


def errors_table(campaign: Feedforward, state: Any, line: Line) -> str:
    header = ["case", "Shinskey", *(x for m in si.METHODS for x in (f"{m} published", m))]
    rows = []
    for i, regime in enumerate(sim.REGIMES):
        row = [regime.name, pairs(*sim.controller_error(sim.PUBLISHED["Shinskey"][i], regime))]
        for m in si.METHODS:
            tunings = np.array(state.get(job_of(line.case_of(m), campaign.seeds))["tunings"])[i]
            db, degrees = sim.controller_error(tunings, regime)
            row += [pairs(*sim.controller_error(sim.PUBLISHED[m][i], regime)), pairs(np.median(db, axis=0), np.median(degrees, axis=0))]
        rows.append(row)
    return table.markdown(header, rows)


def largest_and_h2(four: np.ndarray) -> str:
    return "{:.2f}, {:.1f}; {:.2f}, {:.1f}".format(*four)


def misses_of(result: dict[str, Any]) -> np.ndarray:
    """Medians of the seeds [cases, 4]."""
    return np.array([np.median(sim.misses(np.array(t), regime), axis=0) for t, regime in zip(result["tunings"], sim.REGIMES)])


def published_misses(who: str) -> np.ndarray:
    return np.array([sim.misses(t, regime) for t, regime in zip(sim.PUBLISHED[who], sim.REGIMES)])


def misses_table(campaign: Feedforward, state: Any, line: Line) -> str:
    found = {m: misses_of(state.get(job_of(line.case_of(m), campaign.seeds))) for m in si.METHODS}
    rows = []
    for i, regime in enumerate(sim.REGIMES):
        row = [regime.name, largest_and_h2(published_misses("Shinskey")[i])]
        for m in si.METHODS:
            theirs, ours = published_misses(m)[i], found[m][i]
            text = largest_and_h2(ours)
            row += [largest_and_h2(theirs), f"**{text}**" if (ours > theirs).any() else text]
        rows.append(row)
    return table.markdown(["case", "Shinskey", *(x for m in si.METHODS for x in (f"{m} published", m))], rows)


def h2_table(campaign: Feedforward, state: Any) -> str:
    """Means over the nine cases, by line."""
    def row(name: str, note: str, values: list[np.ndarray]) -> list[str]:
        return [name, note, *(largest_and_h2(v.mean(axis=0)) for v in values)]

    rows = [row("Shinskey's rules", "", [published_misses("Shinskey")] * len(si.METHODS)),
            row("published parameters", "", [published_misses(m) for m in si.METHODS]),
            row("optimum of J without dead time", "", [np.array([sim.misses(t, r) for t, r in zip(known()[2], sim.REGIMES)])] * len(si.METHODS))]
    for line in campaign.lines:
        rows.append(row(line.name, line.note, [misses_of(state.get(job_of(line.case_of(m), campaign.seeds))) for m in si.METHODS]))
    return table.markdown(["line", "with", *si.METHODS], rows)


def estimates_table(campaign: Feedforward, state: Any, line: Line) -> str:
    rows = []
    for i, regime in enumerate(sim.REGIMES):
        found = [state.get(job_of(line.case_of(m), campaign.seeds)) for m in si.METHODS]
        rows.append([regime.name, *(pairs(np.array(r["dB"][i]), np.array(r["degrees"][i])) + " / " + largest_and_h2(np.array(r["misses"][i])) for r in found)])
    return table.markdown(["case", *si.METHODS], rows)


def tunings_table(campaign: Feedforward, state: Any, line: Line) -> str:
    best = known()[2]
    rows = []
    for i, regime in enumerate(sim.REGIMES):
        found = [np.median(np.array(state.get(job_of(line.case_of(m), campaign.seeds))["tunings"])[i], axis=0) for m in si.METHODS]
        rows.append([regime.name, "{:.3f} {:.3f} {:.3f}".format(*best[i]), *("{:.3f} {:.3f} {:.3f} {:.3f}".format(*t) for t in found)])
    return table.markdown(["case", "J*", *si.METHODS], rows)


def iae_table(campaign: Feedforward, state: Any) -> str:
    lines = [line for line in campaign.lines if line.wanted and line.by_case]
    header = ["case", "PI alone", "Shinskey", *(f"{m} published" for m in si.METHODS), *(f"{m}{'' if line.case.dead else ' without dead time'}" for line in lines for m in si.METHODS),
              "optimum of J", "ideal"]
    rows = []
    for i, regime in enumerate(sim.REGIMES):
        row = [float(sim.step_iae(t, regime)[0]) for t in (None, *(sim.PUBLISHED[w][i] for w in ("Shinskey", *si.METHODS)))]
        for line in lines:
            for m in si.METHODS:
                row.append(float(np.median(sim.step_iae(np.array(state.get(job_of(line.case_of(m), campaign.seeds))["tunings"])[i], regime))))
        row += [float(sim.step_iae(t, regime)[0]) for t in (known()[2][i], sim.ideal(regime))]
        rows.append([regime.name, *(f"{x:.3f}" for x in row)])
    return table.markdown(header, rows)


def not_there(result: dict[str, Any] | None) -> str:
    return "not run" if result is None else f"failed: {result['failed'][:40]}" if "failed" in result else ""


def rig_table(campaign: Feedforward, state: Any) -> str:
    header = ["with", "tuned: lead s, lag s, K, dead time s", "worst of all seeds at 0.001, 0.003, 0.01 rad/s: dB, degrees", "IAE of the cycles' disturbance, K s",
              "a cycle from rest: tuned, worst", "gain alone"]
    rows = []
    for case, words in campaign.other_plants:
        if not isinstance(case, Rig):
            continue
        result = state.get(job_of(case, campaign.seeds))
        if missing := not_there(result):
            rows.append([words, missing])
            continue
        runs = result["runs"]
        t = np.median([r["tuning"] for r in runs], axis=0)
        off = np.max([np.abs(np.array(feedforward_other_plants.error_of(r["tuning"]))) for r in runs], axis=0)
        iae = ", ".join(f"{k[2:]} {np.median([r['iae'][k] for r in runs]):.1f}" for k in runs[0]["iae"])
        rest = np.array([[r["rest"][k] for k in ("tuned", "gain alone")] for r in runs])
        rows.append([words, ", ".join(f"{x:.2f}" for x in t), "; ".join(f"{a:.2f}, {b:.1f}" for a, b in zip(off[0][:3], off[1][:3])), iae,
                     f"{np.median(rest[:, 0]):.1f}, {rest[:, 0].max():.1f}", f"{np.median(rest[:, 1]):.1f}"])
    return table.markdown(header, [[*row, *[""] * (len(header) - len(row))] for row in rows])


def rig_rest_words() -> str:
    by_run = []
    for run, published in feedforward_other_plants.RIG_PUBLISHED.items():
        known_ones = (("PI alone", None), ("fixed", feedforward_other_plants.RIG_FIXED[run]), ("published", published), ("Shinskey", feedforward_other_plants.RIG_SHINSKEY))
        by_run.append(f"run {run}: " + ", ".join(f"{name} {feedforward_other_plants.rig_iae(run, t):.1f}" for name, t in known_ones))
    return "; ".join(by_run)


def pilot_table(campaign: Feedforward, state: Any) -> str:
    header = ["with", "ratio off at 0.0005; 0.002; 0.01 rad/s: dB, degrees", "tuned: lead s, lag s, kW per l/h, dead time s", "IAE, K min: PI alone", "gain alone", "tuned", "worst"]
    rows = []
    for case, words in campaign.other_plants:
        if not isinstance(case, Pilot):
            continue
        result = state.get(job_of(case, campaign.seeds))
        if missing := not_there(result):
            rows.append([words, missing])
            continue
        runs = result["runs"]
        iae = [f"{np.median([r['iae'][k] for r in runs]):.2f}" for k in ("PI alone", "gain alone", "tuned")]
        t = np.median([r["tuning"] for r in runs], axis=0)
        off = "" if case.method not in si.METHODS else pairs(*np.median([r["off"] for r in runs], axis=0))
        rows.append([words, off, f"{t[0]:.0f}, {t[1]:.0f}, {t[2]:.3f}, {t[3]:.0f}", *iae, f"{max(r['iae']['tuned'] for r in runs):.2f}"])
    return table.markdown(header, [[*row, *[""] * (len(header) - len(row))] for row in rows])


def pilot_models_words(campaign: Feedforward, state: Any) -> str:
    for case, _ in campaign.other_plants:
        result = state.get(job_of(case, campaign.seeds))
        if isinstance(case, Pilot) and case.method == "Shinskey" and result and "failed" not in result:
            named = zip(("heater", "feed"), result["runs"][0]["models"])
            return "Models for Shinskey's rules, spans, fitted to the responses: " + "; ".join(
                f"{name} gain {k:.2f}, dead time {dead:.0f} s, time constant {lag:.0f} s, off by {100 * error:.0f} %" for name, (k, dead, lag, error) in named) + "."
    return ""


def write_results(campaign: Feedforward, state: Any, folder: Path) -> None:
    text = [f"# {campaign.title}\n\nWritten by `tools/campaign {campaign.name}`: {len(campaign.seeds)} seeds. {campaign.about}\n"]

    def add(title: str, words: str, made: str) -> None:
        text.append(f"\n## {title}\n\n{words}\n\n{made}\n")

    add("Sums over the nine cases",
        f"By method: median of the seeds' sums of J; the worst case's median above the published, in J0 (wanted: at most {CELL}); the worst run above J*, in J0 (wanted: at most {RUN}). "
        f"Bold: the sum is above the published, or more than that. J* sums up to {known()[0].sum():.1f}. {fixed_words(campaign, state)}",
        table.markdown(*sums_table(campaign, state)))
    for line in campaign.lines:
        if line.by_case:
            add(f"J by case: {line.name}", f"`{line.note}`.", cases_table(campaign, state, line))
    main = campaign.lines[0]
    add(f"Estimated ratio: {main.name}", "Estimated less true Gd/Gp, medians, dB and degrees at 0.5; 2; 6 rad/s / "
        "the largest on the grid; H2.", estimates_table(campaign, state, main))
    add("Controller errors summed up", "The largest between 0.5 and 6 rad/s (H-infinity), dB and degrees; root of the sum of squares of those at 0.5, 2 and 6 rad/s (H2), dB and degrees, as the source defines both. Means over the nine cases "
        "of the seeds' medians. All are computed here from the parameters, the published ones too; the source's own tables of errors, partly read off plots, are not repeated.", h2_table(campaign, state))
    shown = [line for line in campaign.lines if line.wanted and line.by_case]
    for line in shown:
        add(f"Largest and H2 error: {line.name}", "By case, medians of the seeds: H-infinity; H2, dB and degrees. Bold: one of the four is larger than with the published "
            "parameters.", misses_table(campaign, state, line))
    for line in shown:
        add(f"Controller error: {line.name}", "Tuned less ideal, continuous forms, medians of the seeds, dB and degrees at 0.5; 2; 6 rad/s. In the III cases the ideal one has to see 0.2 s ahead, which none can.",
                errors_table(campaign, state, line))
    add(f"Tunings: {main.name}", "Lead, lag, K and dead time (s), medians of each. Where lead = lag any value is as good.", tunings_table(campaign, state, main))
    add("After a unit step of the disturbance", "Integral of |y| over 30 s, no noise, in steps of 5 ms; medians of the seeds' tunings. Ideal: -Gd/Gp where it can be had; in the III cases without its prediction, "
        "which is not the best that a lead-lag can do there.", iae_table(campaign, state))
    add("The rig of chapter 4", "Fitted models, sampling 15 s, 0.02 K of noise, readings in 0.01 K; feed 40 and 45 % (ours: that the gains are per %), setpoint 97 and 98 degC; run 1 with KP 25 and 9 per minute, the fixed element "
        "K 1.2, lead 80 s, lag 110 s; run 2 with KP 18, K 2.5, lead 50 s, lag 100 s. Published results: K 1.17, lead 124.44 s, lag 124.88 s and K 1.34, lead 29 s, lag 36 s. apart: samples that the feed's "
        "square wave comes after the setpoint's, of a cycle of 80; the source does not say. With none (apart=0) both move together, u follows from y and d through the PI and the fixed element alone, and the two paths cannot be told apart. "
        "Cycles in their order, what is due to the disturbance; gain alone, the last, is K of the tuned element without lead and lag. B, C and D, which the source did not play here: two cycles of the setpoint, one of the feed under the PI alone, "
        "then the same cycles as A; models with 5 parameters (Gp), 8 (T) and 12 (Sd and u by d), ours. What the switch from one element to the next does is in these figures. It is not in those of a cycle from rest, "
        f"without noise and setpoint; there it is, K s, {rig_rest_words()}.", rig_table(campaign, state))
    add("The pilot column", "Nonlinear column (`reflux-plant`), both loops closed, sampling 15 s, 5 h with the setpoint of T10 by 0.5 K and the feed by 12 % either way, both together (A) or 2.5 h each (B, C, D; models with 16, 18 and 22 "
        "parameters, ours); then the feed 12 % up for an hour and 12 % down for one, of T10 without noise. Up to ten seeds, medians. exact: the search on the responses of the linearised column, the loop of T1 closed; Shinskey: his rules from "
        "first-order models fitted to these. Gain alone: K of the row's element without lead and lag, of Shinskey's the ratio of the fitted models' gains. " + pilot_models_words(campaign, state), pilot_table(campaign, state))
    (folder / f"{campaign.name}.md").write_text("".join(text), encoding="utf-8")


def execute(campaign: Feedforward, options: argparse.Namespace, state: Any) -> int:
    whole = options.fraction == 1.0
    campaign = campaign if whole else campaign.part(options.fraction)
    jobs = campaign.jobs(whole)
    trays_campaign.run_missing(jobs, state, options.jobs, lambda job: job, run_one)
    if not options.check and whole:
        write_results(campaign, state, options.results)
    print("\n" + table.columns(*sums_table(campaign, state)))
    bad = [f"{job}: {r['failed']}" for job in jobs if "failed" in (r := state.get(job))]
    for text in bad[:10]:
        print(f"FAILED  {text}")
    for line in campaign.lines:
        for m in si.METHODS:
            result = state.get(job_of(line.case_of(m), campaign.seeds))
            if line.wanted and result and "failed" not in result:
                missed = verdict(m, result).misses
                bad += missed
                for text in missed:
                    print(f"NOT REACHED  {line.name}, {m}: {text}")
    return 1 if bad else 0
