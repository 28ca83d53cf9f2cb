"""A round of faults drawn by chance: drawn, tried, kept in build/mutants, and reported."""

from __future__ import annotations

import json
import threading
from collections import Counter, deque
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from reflux import build, table
from reflux.errors import UserError
from dev.mutation import drawing
from dev.mutation.drawing import Fault
from dev.mutation.reach import Costs, Reach, mutants_folder
from dev.mutation.tree import FORMATS, Test, Tree
from dev.mutation.trial import Bench, NotCompiled, Verdict
from reflux.paths import shown

AIM = 0.9          # of those not shown equivalent
EQUIVALENT_MAX = 0.1  # of all
CAUGHT, SURVIVED, EQUIVALENT = "caught", "survived", "equivalent"


@dataclass
class Result:
    """Verdict on one fault. by: the test that noticed; reach: the tests that reach the line, where none noticed."""

    file: str
    function: str
    line: int
    kind: str
    old: str
    new: str
    status: str
    format: str = ""
    by: str = ""
    trouble: str = ""
    cpu_s: float = 0.0
    reach: list[str] = field(default_factory=list)

    @property
    def key(self) -> tuple[str, str, str, str]:
        return self.file, self.function, self.old, self.new


class Round:
    """Both number formats, each built when it is first needed.

    A fault is tried in the float build where its object code differs there, else in the fixed build. One that
    the float build's tests do not notice is tried in the fixed build too, where it exists there: tools/test runs both.
    """

    def __init__(self, jobs: int, longest_s: float | None = None):
        self.jobs, self.longest_s = jobs, longest_s
        self.benches: dict[str, Bench] = {}
        self.reaches: dict[str, Reach] = {}
        self.tests: dict[str, list[Test]] = {}
        self.costs: dict[str, Costs] = {}
        self.built: set[str] = set()  # programs that are up to date
        self.lock = threading.Lock()
        self.known = drawing.equivalents()
        self.work = mutants_folder() / "work"

    heading = "layer"
    equivalent_max = EQUIVALENT_MAX

    def faults(self, files: list[str]) -> dict[tuple[str, int], list[Fault]]:
        """All that can be drawn, by file and line."""
        return drawing.faults_by_line(files)

    def state(self, seed: int, files: list[str]) -> State:
        return State(seed, files, self.longest_s)

    def bench(self, name: str) -> Bench:
        if name not in self.benches:
            tree = Tree(name)
            self.tests[name] = tree.tests()
            self.benches[name] = Bench(tree, {})
        return self.benches[name]

    def reach(self, name: str) -> Reach:
        if name not in self.reaches:
            reach = Reach(name)
            reach.measure()
            self.reaches[name] = reach
        return self.reaches[name]

    def tests_at(self, name: str, first: str, fault: Fault) -> list[Test]:
        """Built, and with their costs. Lines that both builds compile (first is float) are reached by the same tests."""
        bench = self.bench(name)
        names = self.reach(first).tests_at(fault.file, fault.edit)
        tests = [t for t in self.tests[name] if t.name in names]
        with self.lock:
            missing = sorted({p for t in tests for p in t.programs} - self.built)
            if missing and not bench.tree.built:
                bench.tree.build(tuple(bench.tree.target_of(p) for p in missing))
            self.built.update(missing)
            bench.costs.update(self.costs.setdefault(name, Costs(bench.tree)).measure(tests))
        passing = [t for t in tests if t.name in bench.costs]
        return [t for t in passing if self.longest_s is None or bench.costs[t.name] <= self.longest_s]

    def prepare(self) -> None:
        """Builds the programs that nearly every fault needs."""
        bench = self.bench("float")
        bench.tree.build()
        self.costs["float"] = Costs(bench.tree)
        bench.costs = self.costs["float"].measure(self.tests["float"])
        self.reach("float")

    def format_of(self, fault: Fault, plain: str, changed: str) -> str | None:
        """The first number format whose object code differs; None: nowhere."""
        for name in FORMATS:
            if self.bench(name).differs(fault.path, plain, changed, self.work / "compared"):
                return name
        return None

    def attempt(self, fault: Fault, first: str, place: Path) -> Result:
        e = fault.edit
        result = Result(fault.file, e.function, e.line, e.kind, fault.old, fault.new, SURVIVED, first)
        plain = fault.path.read_text(encoding="utf-8")
        changed = e.apply(plain)
        for name in list(FORMATS)[list(FORMATS).index(first):]:
            if name != first and not self.bench(name).differs(fault.path, plain, changed, place / "compared"):
                continue
            tests = self.tests_at(name, first, fault)
            verdict: Verdict = self.benches[name].attempt(fault.path, changed, tests, place)
            result.cpu_s += verdict.cpu_s
            result.reach = sorted(set(result.reach) | {t.name for t in tests})
            if verdict.test is not None:
                result.status, result.format, result.by, result.trouble = CAUGHT, name, verdict.test, verdict.trouble
                result.reach = []
                return result
        return result

    # --- a round -------------------------------------------------------------------------------------

    def run(self, count: int, seed: int, files: list[str]) -> int:
        state = self.state(seed, files)
        state.load(drawing.sources_digest())
        if len(state.results) > count:
            state.begin()
        self.prepare()
        faults = drawing.draws(seed, self.faults(files))
        for _ in range(state.drawn):
            next(faults)
        progress = build.Progress("mutants")
        waiting: deque[tuple[int, Counter, Future]] = deque()
        drawn, dropped = state.drawn, Counter(state.discarded)
        with ThreadPoolExecutor(self.jobs) as pool:
            while len(state.results) < count:
                if len(waiting) < self.jobs and len(state.results) + len(waiting) < count and faults is not None:
                    fault = next(faults, None)
                    if fault is None:
                        faults = None
                        continue
                    drawn += 1
                    task = self._start(pool, fault, drawn, dropped)
                    if task is not None:
                        waiting.append((drawn, Counter(dropped), task))
                    continue
                if not waiting:
                    break
                state.drawn, state.discarded, task = waiting.popleft()
                result = task.result()
                if result is None:
                    dropped["not C"] += 1
                    continue
                state.results.append(result)
                state.save()
                progress.show(f"{len(state.results)} of {count}, {state.summary()}, {result.file}")
        progress.end(f"{len(state.results)} tried")
        return self.report(state)

    def _start(self, pool: ThreadPoolExecutor, fault: Fault, drawn: int, dropped: Counter) -> Future | None:
        """None where it is none: it does not compile, or is the same code."""
        plain = fault.path.read_text(encoding="utf-8")
        try:
            first = self.format_of(fault, plain, fault.edit.apply(plain))
        except NotCompiled:
            dropped["not C"] += 1
            return None
        if first is None:
            dropped["same code"] += 1
            return None
        if fault.key in self.known:
            e = fault.edit
            done: Future = Future()
            done.set_result(Result(fault.file, e.function, e.line, e.kind, fault.old, fault.new, EQUIVALENT, first,
                                   trouble=self.known[fault.key]))
            return done
        return pool.submit(self._attempt_or_none, fault, first, self.work / f"fault-{drawn}")

    def _attempt_or_none(self, fault: Fault, first: str, place: Path) -> Result | None:
        try:
            return self.attempt(fault, first, place)
        except NotCompiled:
            return None

    def again(self, seed: int, files: list[str]) -> int:
        """Those that survived last time, in the sources and tests of now."""
        state = self.state(seed, files)
        state.load(None)
        if not state.results:
            raise UserError(f"{shown(state.path)}: no results there; first --random N --seed {seed} without --again")
        self.prepare()
        now = {f.key: f for faults in self.faults(files).values() for f in faults}
        progress = build.Progress("mutants")
        survivors = [i for i, r in enumerate(state.results) if r.status == SURVIVED]
        for n, i in enumerate(survivors, 1):
            old = state.results[i]
            progress.show(f"{n} of {len(survivors)}, {old.file}")
            fault = now.get(old.key)
            if fault is None:
                print(f"no longer there: {old.file}: {old.old}")
                continue
            if fault.key in self.known:
                old.status, old.trouble = EQUIVALENT, self.known[fault.key]
            else:
                plain = fault.path.read_text(encoding="utf-8")
                first = self.format_of(fault, plain, fault.edit.apply(plain))
                if first is not None:
                    state.results[i] = self.attempt(fault, first, self.work / "again")
            state.digest = ""  # no longer the results of one state of the sources
            state.save()
        progress.end(f"{len(survivors)} tried again")
        return self.report(state)

    def report(self, state: State) -> int:
        results = state.results
        for r in results:
            if r.status == EQUIVALENT:
                print(f"equivalent: {r.file}:{r.line} {r.function}\n    - {r.old}\n    + {r.new}\n    {r.trouble}")
        for r in results:
            if r.status == SURVIVED:
                names = ", ".join(r.reach[:12]) + (f" and {len(r.reach) - 12} more" if len(r.reach) > 12 else "")
                print(f"not noticed: {r.file}:{r.line} {r.function} ({r.kind}, {r.format})\n    - {r.old}\n    + {r.new}\n"
                      f"    reached by: {names or 'no test'}")
        print()
        print(table.columns([self.heading, "mutants", "caught", "equivalent", "not noticed"], self.rows(results)))
        counts = Counter(r.status for r in results)
        judged = len(results) - counts[EQUIVALENT]
        share = counts[CAUGHT] / judged if judged else 0.0
        by_kind = ", ".join(f"{k} {sum(r.kind == k and r.status == CAUGHT for r in results)} of "
                            f"{sum(r.kind == k and r.status != EQUIVALENT for r in results)}"
                            for k in sorted({r.kind for r in results}))
        print(f"\ncaught by kind: {by_kind}")
        print(f"drawn {state.drawn}: same object code {state.discarded['same code']}, not C {state.discarded['not C']}; "
              f"processor time of the tests {sum(r.cpu_s for r in results):.0f} s")
        print(f"mutants: {len(results)} drawn with seed {state.seed}, caught {counts[CAUGHT]} of {judged} ({100 * share:.1f} %), "
              f"shown equivalent {counts[EQUIVALENT]}")
        return 0 if share >= AIM and counts[EQUIVALENT] <= self.equivalent_max * len(results) else 1

    def rows(self, results: list[Result]) -> list[list[str]]:
        layers = sorted({Path(r.file).parts[1] for r in results})
        return [*(totals(x, [r for r in results if Path(r.file).parts[1] == x]) for x in layers), totals("firmware", results)]


class State:
    """build/mutants/random-SEED.json: a round so far. Another state of the sources begins anew."""

    def __init__(self, seed: int, files: list[str], longest_s: float | None, what: str = ""):
        self.seed, self.files = seed, files
        mark = (f"-{what}" if what else "") + "".join("-" + f.strip("/").replace("/", "_") for f in files)
        mark += f"-up-to-{longest_s:g}-s" if longest_s is not None else ""
        self.path = mutants_folder() / f"random-{seed}{mark}.json"
        self.digest = ""
        self.begin()

    def begin(self) -> None:
        self.drawn = 0
        self.discarded: Counter = Counter()
        self.results: list[Result] = []

    def load(self, digest: str | None) -> None:
        """None: whatever is there."""
        if self.path.is_file():
            data = json.loads(self.path.read_text(encoding="utf-8"))
            if digest is None or data["sources"] == digest:
                self.drawn, self.discarded = data["drawn"], Counter(data["discarded"])
                self.results = [Result(**r) for r in data["results"]]
        self.digest = digest or ""

    def save(self) -> None:
        data = {"sources": self.digest, "drawn": self.drawn, "discarded": dict(self.discarded),
                "results": [vars(r) for r in self.results]}
        self.path.parent.mkdir(parents=True, exist_ok=True)
        written = self.path.with_suffix(".part")
        written.write_text(json.dumps(data, indent=1), encoding="utf-8")
        written.replace(self.path)

    def summary(self) -> str:
        counts = Counter(r.status for r in self.results)
        return f"{counts[CAUGHT]} caught, {counts[SURVIVED]} not"


def totals(name: str, some: list[Result]) -> list[str]:
    """A row of the table."""
    counts = Counter(r.status for r in some)
    return [name, str(len(some)), str(counts[CAUGHT]), str(counts[EQUIVALENT]), str(counts[SURVIVED])]
