"""Which lines of the firmware each test reaches, and what processor time it takes: kept in build/mutants.

What was found for a test is kept for as long as its programs stay the same to the last byte.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
from pathlib import Path

from reflux import build
from dev.mutation.edits import Edit
from dev.mutation.tree import Test, Tree
from reflux.paths import ROOT, build_root

FIRMWARE = ROOT / "firmware"


class Costs:
    """Processor time of each test where nothing is wrong, s. A test that fails then can tell nothing: it is in failing."""

    def __init__(self, tree: Tree):
        self.tree = tree
        self.kept = _Kept(mutants_folder() / f"{tree.name}-costs.json")
        self.failing: dict[str, str] = {}

    def measure(self, tests: list[Test]) -> dict[str, float]:
        out = {}
        progress = build.Progress(f"{self.tree.name}, nothing wrong")
        missing = [t for t in tests if self.kept.get(t) is None and t.name not in self.failing]
        for n, test in enumerate(missing, 1):
            progress.show(f"{n} of {len(missing)}, {test.name}")
            outcome = self.tree.run(test, mutants_folder() / "work" / "unchanged")
            if outcome.trouble is None:
                self.kept.put(test, outcome.cpu_s)
            else:
                self.failing[test.name] = outcome.trouble
                print(f"{test.name} fails where nothing is wrong ({self.tree.name}), and is left out: {outcome.trouble}")
        if missing:
            progress.end(f"{len(missing)} tests")
        for test in tests:
            cost = self.kept.get(test)
            if cost is not None:
                out[test.name] = float(cost)
        return out


class Reach:
    """Lines by file, from gcov, for the tests of one number format."""

    def __init__(self, name: str):
        self.tree = Tree(f"{name}-lines")
        self.kept = _Kept(self.tree.folder.parent / f"{name}-lines.json")
        self.reached: dict[str, dict[str, set[int]]] = {}
        self.counted: dict[str, set[int]] = {}

    def measure(self) -> None:
        self.tree.build()
        tests = self.tree.tests()
        missing = [t for t in tests if self.kept.get(t) is None]
        progress = build.Progress(f"{self.tree.name}, lines reached")
        for n, test in enumerate(missing, 1):
            progress.show(f"{n} of {len(missing)}, {test.name}")
            self.kept.put(test, self._one(test))
        if missing:
            progress.end(f"{len(missing)} tests")
        for test in tests:
            found = self.kept.get(test)
            self.reached[test.name] = {file: set(lines["reached"]) for file, lines in found.items()}
            for file, lines in found.items():
                self.counted.setdefault(file, set()).update(lines["reached"], lines["missed"])

    def _one(self, test: Test) -> dict[str, dict[str, list[int]]]:
        for old in self.tree.folder.rglob("*.gcda"):
            old.unlink()
        self.tree.run(test, self.tree.folder.parent / "work" / "lines")
        counts: dict[str, dict[int, bool]] = {}
        files = sorted(str(p) for p in self.tree.folder.rglob("*.gcda"))
        for at in range(0, len(files), 50):
            answer = subprocess.run(["gcov", "--json-format", "--stdout", *files[at:at + 50]], cwd=self.tree.folder,
                                    capture_output=True, text=True, errors="replace", check=False)
            for line in answer.stdout.splitlines():
                if line.startswith("{"):
                    self._add(json.loads(line), counts)
        return {file: {"reached": sorted(n for n, hit in lines.items() if hit),
                       "missed": sorted(n for n, hit in lines.items() if not hit)} for file, lines in counts.items()}

    def _add(self, document: dict, counts: dict[str, dict[int, bool]]) -> None:
        for entry in document["files"]:
            path = (Path(document["current_working_directory"]) / entry["file"]).resolve()
            if FIRMWARE not in path.parents:
                continue
            lines = counts.setdefault(str(path.relative_to(ROOT)), {})
            for line in entry["lines"]:
                n = line["line_number"]
                lines[n] = lines.get(n, False) or line["count"] > 0

    def tests_at(self, file: str, edit: Edit) -> set[str]:
        """The tests that reach the statement of this edit; for a table or a macro, those that reach its file."""
        span = set(range(edit.first, edit.last + 1)) & self.counted.get(file, set())
        if span:
            at = {edit.line} & span or span
            return {name for name, files in self.reached.items() if files.get(file, set()) & at}
        return {name for name, files in self.reached.items() if files.get(file)}


class _Kept:
    """A file of what is known of each test, with the digest of its programs."""

    def __init__(self, path: Path):
        self.path = path
        self.data: dict[str, dict] = {}
        self.digests: dict[str, str] = {}
        if path.is_file():
            try:
                self.data = json.loads(path.read_text(encoding="utf-8"))
            except ValueError:
                pass

    def _digest(self, test: Test) -> str:
        if test.name not in self.digests:
            sha = hashlib.sha256("\0".join(test.command).encode())
            for word in test.command:
                if Path(word).is_file() and Path(word).suffix not in (".md",):
                    sha.update(Path(word).read_bytes())
            self.digests[test.name] = sha.hexdigest()
        return self.digests[test.name]

    def get(self, test: Test):
        entry = self.data.get(test.name)
        return entry["value"] if entry and entry["digest"] == self._digest(test) else None

    def put(self, test: Test, value) -> None:
        self.data[test.name] = {"digest": self._digest(test), "value": value}
        self.path.parent.mkdir(parents=True, exist_ok=True)
        written = self.path.with_suffix(".part")
        written.write_text(json.dumps(self.data), encoding="utf-8")
        written.replace(self.path)


def mutants_folder() -> Path:
    return build_root() / "mutants"
