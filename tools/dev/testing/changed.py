"""Chooses the tests that reach changed files. What is not known to be out of reach runs.

A test reaches a source of the firmware, the ports or the simulator if tests/reach.txt says so, or if it has no row there. A
header is reached through every source that includes it. A Python test reaches the modules that it imports.
"""

from __future__ import annotations

import json
import re
import subprocess
from functools import cache
from pathlib import Path

from reflux import boards
from reflux.errors import UserError
from reflux.paths import ROOT, build_dir
from dev.testing import reach
from dev.testing.entries import SANITIZED, Test

COMPILED = (".c", ".h", ".S")
COUNTED = ("firmware", "hal", "host_sim")  # folders that tests/reach.txt speaks of
FIXED = "REFLUX_FIXED_POINT"
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)
IMPORT = re.compile(r"^\s*(?:from\s+([\w.]+)\s+import\s+(\(.*?\)|[^\n]+)|import\s+([\w., ]+))", re.MULTILINE | re.DOTALL)
# Tests that read pages, and those that read every C source as text.
OF_PAGES = ("tools.documents", "tools.links", "tools.architecture", "tools.evidence", "tools.reference", "link_document", "fault_matrix")
OF_SOURCES = ("style.", "tools.architecture")


def choose(tests: list[Test], commit: str) -> list[Test]:
    """The tests that reach what has changed, and a line for each file that says how many they are."""
    files = changed_files(commit)
    chosen: set[str] = set()
    for path in files:
        found = reaching(tests, path)
        print(f"  {path}: {len(found)} tests" if len(found) < len(tests) else f"  {path}: every test")
        chosen |= found
    print(f"tools/test --changed: {len(files)} files, {len(chosen)} of {len(tests)} tests reach them", flush=True)
    return [test for test in tests if test.name in chosen]


def fitting(tests: list[Test], seconds: dict[str, float], room_s: float) -> list[Test]:
    """As many tests as fit into room_s seconds of test time, the shortest first. A test whose time is unknown is short."""
    out, used = [], 0.0
    for test in sorted(tests, key=lambda t: seconds.get(t.name, 0.0)):
        used += seconds.get(test.name, 0.0)
        if used > room_s:
            break
        out.append(test)
    return out


def changed_files(commit: str) -> list[str]:
    """Paths that differ from the commit, untracked ones too. Without one: uncommitted changes, or else the last commit."""
    if commit:
        return sorted({*_git("diff", "--name-only", commit, "--"), *_untracked()})
    return sorted({*_git("diff", "--name-only", "HEAD", "--"), *_untracked()}) or _git("diff", "--name-only", "HEAD~1", "HEAD", "--")


def _untracked() -> list[str]:
    return _git("ls-files", "--others", "--exclude-standard")


def _git(*words: str) -> list[str]:
    try:
        answer = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise UserError("--changed asks git, which is not installed") from None
    if answer.returncode != 0:
        raise UserError(f"--changed: git {words[0]}: {(answer.stderr.strip() or 'failed').splitlines()[-1]}")
    return answer.stdout.splitlines()


def reaching(tests: list[Test], path: str) -> set[str]:
    """Names of the tests that this file can change."""
    top = path.split("/", 1)[0]
    if path.endswith(COMPILED) and top in (*COUNTED, "tests"):
        return _reaching_source(tests, path)
    if path.endswith(".py"):
        found = {t.name for t in tests if path in _scripts_of(t)}
        if top == "tools":  # a page may run any tool
            found |= {t.name for t in tests if t.name.startswith("tools.commands")}
        return found or _everything(tests)
    if path.endswith(".md"):
        page = f"tools.commands-{Path(path).stem}"
        return {t.name for t in tests if t.name.startswith(page) or t.name.split(".", 1)[1] in OF_PAGES or t.name in OF_PAGES}
    if path.endswith(".ipynb"):
        return {t.name for t in tests if t.name.startswith("tools.notebooks") or t.name == "tools.links"}
    if path.startswith("docs/reference/notes/"):
        return {test.name for test in tests if test.name == "tools.reference"}
    if path.startswith("tests/campaign/results/") or path.startswith("docs/figures/"):
        return set()
    return _everything(tests)


def _everything(tests: list[Test]) -> set[str]:
    return {test.name for test in tests}


def _reaching_source(tests: list[Test], path: str) -> set[str]:
    sources = {path, *_includers(path)} if path.endswith(".h") else {path}
    known = reach.load()
    measured = frozenset().union(*known.values())
    counted = {s for s in sources if s.startswith(tuple(f"{top}/" for top in COUNTED))}
    out = {t.name for t in tests if t.name.startswith(OF_SOURCES)}
    # No row can know a source that is a table, nor what stands behind the number format: the rows are of the float build.
    everywhere = any(s not in measured or FIXED in (ROOT / s).read_text(encoding="utf-8", errors="replace")
                     for s in counted if s.endswith(".c") and not s.startswith("hal/stm32") and (ROOT / s).is_file())
    of_board = any(s.startswith("hal/") and not s.startswith(("hal/host/", "hal/memory/")) for s in counted)
    for test in tests:
        reached = known.get(reach.row_of(test.name))
        # A test without a row may run anything that is compiled; no row knows the ports of boards, which gcov does not see.
        may = bool(counted and test.needs) if reached is None or everywhere else bool(reached & counted)
        if may or own_sources(test) & sources or of_board and any(preset in boards.PRESETS for preset, _ in test.needs):
            out.add(test.name)
    return out


@cache
def _texts() -> dict[str, set[str]]:
    """Names that each C file of the tree includes."""
    folders = ("firmware", "hal", "host_sim", "tests", "tools/libreflux")
    return {str(path.relative_to(ROOT)): set(INCLUDE.findall(path.read_text(encoding="utf-8", errors="replace")))
            for folder in folders for path in (ROOT / folder).rglob("*.[ch]")}


@cache
def _includers(path: str) -> frozenset[str]:
    """Every file that includes this one, directly or through others. Names are compared by their last two parts."""
    found: set[str] = set()
    waiting = [path]
    while waiting:
        now = waiting.pop()
        ends = (now.rsplit("/", 1)[1], "/".join(now.rsplit("/", 2)[1:]))
        for other, names in _texts().items():
            if other not in found and any(name in ends or name.endswith(f"/{ends[1]}") for name in names):
                found.add(other)
                waiting.append(other)
    return frozenset(found - {path})


@cache
def _sources_by_target(preset: str) -> dict[str, set[str]]:
    """Sources below tests/ of each test program of a sanitizer tree, from its compile commands."""
    out: dict[str, set[str]] = {}
    try:
        entries = json.loads((build_dir(preset) / "compile_commands.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return out
    for entry in entries:
        target = re.search(r" -o tests/(\w+)/CMakeFiles/([\w.-]+)\.dir/", entry["command"])
        if target:
            out.setdefault(f"tests/{target[1]}/{target[2]}", set()).add(str(Path(entry["file"]).relative_to(ROOT)))
    return out


def own_sources(test: Test) -> set[str]:
    """Sources that only this test's programs compile."""
    out: set[str] = set()
    for preset, target in test.needs:
        if preset in SANITIZED:
            out |= _sources_by_target(preset).get(target, set())
    return out


def _module_of_command(name: str) -> Path:
    """Path of tools/NAME; some path that is not there, if it is no command."""
    file = f"cmd_{name.replace('-', '_')}.py"
    return next(iter((ROOT / "tools").glob(f"*/{file}")), ROOT / "tools" / file)


@cache
def _imports(path: Path) -> frozenset[Path]:
    """The file and every module of this repository that it imports, directly or through others."""
    found: set[Path] = set()
    waiting = [path]
    while waiting:
        now = waiting.pop()
        if now in found or not now.is_file():
            continue
        found.add(now)
        text = now.read_text(encoding="utf-8")
        for package, names, plain in IMPORT.findall(text):
            modules = [package, *(f"{package}.{n.split(' as ')[0].strip()}" for n in names.strip("()").split(","))] if package else \
                      [n.split(" as ")[0].strip() for n in plain.split(",")]
            for module in modules:
                relative = module.strip().replace(".", "/")
                for base in (ROOT / "tools", now.parent, ROOT / "tests" / "support", ROOT / "tests" / "reference"):
                    waiting += [base / f"{relative}.py"]
        # Commands that the test starts as a person would, or through support.call().
        for name in re.findall(r"(?:tools[/\"', ]+|\bcall\(\s*[\"'])([a-z][a-z-]+)", text):
            waiting.append(_module_of_command(name))
    return frozenset(found)


def _scripts_of(test: Test) -> set[str]:
    """Python files that a test's command runs or imports."""
    out: set[str] = set()
    for word in test.command:
        path = Path(word)
        if path.suffix == ".py" and path.is_file():
            out |= {str(p.relative_to(ROOT)) for p in _imports(path) if ROOT in p.parents}
        elif path.parent == ROOT / "tools":
            command = _module_of_command(path.name)
            out |= {str(p.relative_to(ROOT)) for p in _imports(command)}
    return out
