"""tools/evidence: runs everything that counts, and writes the counts to docs/inside/evidence.md, each with its command."""

from __future__ import annotations

import argparse
import datetime
import json
import os
import re
import shlex
import subprocess
import sys
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Callable

from reflux import boards, build, packages
from reflux.errors import RunFailed, UserError
from reflux.paths import ROOT, build_dir, build_root, named, shown

PAGE = ROOT / "docs" / "inside" / "evidence.md"
START = re.compile(r"^\s*Start\s+(\d+): (\S+)")
RANDOM_SEED = "2029"
PORT_FAULTS = "300"
OF_TEST = re.compile(r"^(\d+): (.*)$")


@dataclass
class Line:
    text: str
    command: str


@dataclass
class Result:
    """Output of one source, its date and the state of the sources."""

    lines: list[Line] = field(default_factory=list)
    problem: str = ""
    when: str = ""
    commit: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Section:
    title: str
    text: str
    source: str
    pattern: str


SECTIONS = (
    Section("Storage", "The power is cut at every flash operation of a save, with every torn prefix and with random "
            "words after an interrupted erase, every bit is flipped, twice in a row: the old or the new set is found "
            "whole, or defaults and an alarm. Words that a cut left and that read differently each time: every set answered `ok` is "
            "found at ten further starts. A sample; `test_storage_power all` and `test_storage_unstable all` try every "
            "case (docs/inside/storage.md).", "tests", r"storage\b.*\d.*"),
    Section("Storage and interrupted ticks, every case", "What `tools/test` runs a sample of. Words of an interrupted "
            "operation read differently each time: every set answered `ok` is found at ten further starts with saves between. A "
            "timer's signal runs the tick anywhere in the main loop: no plan in force is torn.", "long",
            r"(storage\b.*\d.*|.*\bapplies\b.*\d.*)"),
    Section("Link under attack", "A live run over a line that damages what passes: no bad frame is acted on.",
            "tests", r"attack\b.*\d.*"),
    Section("Faults", "Every fault of sensors, actuators and plant in every mode, each with the state it must end in.",
            "tests", r"((fault|sequence) matrix|watchdog|restart)\b.*: .*\d.*"),
    Section("Columns", "All inputs jumping over their whole spans, ticks of 1 to 300 s; balances in motion. "
            "`test_input_jumps 200` runs all seeds.", "tests",
            r"(input jumps \w+: \d.*|\w+: contents moved by .*|24 h (after steps|of changes): .*|worst deviation.*)"),
    Section("Console", "A configuration pasted at 115200 baud through a lossy line.", "tests",
            r".*: \d+ bytes, \d+ lines, \d+ dropped.*"),
    Section("Fuzzing", "libFuzzer with address and undefined-behaviour sanitizers.", "fuzz", r"fuzz \w+: .*\d.*"),
    Section("Proofs of the buffers", "Frama-C, weakest preconditions.", "prove", r"(.*goals \d+, proved \d+.*|prove\b.*\d.*)"),
    Section("The linked image", "No heap, no double precision, no streams, no recursion; every call through a pointer "
            "listed; worst-case stack with all interrupts on top. Limits by layer: `tests/target/budget.toml`.",
            "image", r"(image|flash|ram|sram|workspace|stack|calls) ?[\w-]*: .*\d.*"),
    Section("Automatic start-up on the board", "The image that is flashed, in the emulator, beside the host's firmware: "
            "every number of the model, compared as floats; what a plant of 16 x 16 costs the processor. Its memory is "
            "`commission` above, and what it leases of the workspace.", "board", r"commission .*: .*\d.*"),
    Section("Logarithm and exponential", "Against double; `REFLUX_MATH_STEP=1` tries every float there is.",
            "tests", r"float_\w+( near 1)?: \d+ arguments.*"),
    Section("Coverage of `firmware/`", "", "coverage", r"coverage: .*\d.*"),
    Section("Mutants", "Faults put into PID, CRC, storage and interlocks on purpose.", "mutate", r"mutants: .*\d.*"),
    Section("Random mutants", "Drawn from all code lines of `firmware/`, object code different, tried with the tests that reach "
            "the line. Equivalent ones stand in `tests/mutants_equivalent.toml`.", "random", r"mutants: \d+ drawn with seed.*"),
    Section("Mutants of the ports", "In the register code of each chip, as the flashed file on the virtual board.", "ports",
            r"mutants: \d+ drawn with seed.*"),
    Section("Time of `tools/test`", "", "time", r"tools/test: .*\d.*"),
)


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/evidence",
        description="Runs the programs that count things and writes docs/inside/evidence.md. Naming sources runs only these; "
        "the others' figures are those of their last run: from build/evidence, or as the page has them.")
    p.add_argument("sources", nargs="*", metavar="SOURCE", help=f"{', '.join(SOURCES)} (default: all)")
    p.add_argument("--page-only", action="store_true", help="run nothing; write the page from earlier results")
    p.add_argument("--out", type=named, default=PAGE, metavar="FILE")
    options = p.parse_args(arguments)
    for name in options.sources:
        if name not in SOURCES:
            raise UserError(f'"{name}" is not a source; known are: {", ".join(SOURCES)}')
    if not options.page_only:
        packages.need("host", "target", "test", "evidence")
    results = {name: load(name) for name in SOURCES}
    for name in () if options.page_only else options.sources or SOURCES:
        results[name] = measure(name)
        keep(name, results[name])
    text, lacking = page(results, kept_sections(PAGE))
    try:
        options.out.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UserError(f"{shown(options.out)} cannot be written: {error.strerror}") from None
    print(f"\n{shown(options.out)}: {len(SECTIONS) - len(lacking)} of {len(SECTIONS)} sections have figures"
          + (f"; without: {', '.join(lacking)}" if lacking else ""))
    failed = [name for name, r in results.items() if r.problem]
    return 1 if lacking or failed else 0


def measure(name: str) -> Result:
    started = time.monotonic()
    try:
        result = SOURCES[name]()
    except (RunFailed, UserError) as error:
        result = Result(problem=str(error))
    result.problem = result.problem.replace(f"{ROOT}/", "")
    result.seconds = time.monotonic() - started
    result.when = datetime.date.today().isoformat()
    result.commit = commit()
    print(f"{name}: {len(result.lines)} figures, {result.seconds:.0f} s" + (f"; {result.problem}" if result.problem
                                                                            else ""), flush=True)
    return result


def commit() -> str:
    """Commit of the sources, with a + where they differ from it."""
    def git(*words: str) -> str:
        try:
            return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()
        except FileNotFoundError:
            return ""
    head = git("rev-parse", "--short", "HEAD")
    sources = ("firmware", "hal", "host_sim", "tests", "tools")
    changed = git("status", "--porcelain", "--untracked-files=no", "--", *sources)
    return head + ("+" if head and changed else "")


def follow(what: str, command: list[str]) -> tuple[int, list[str]]:
    """Runs a command in the repository; shows the time that passes."""
    progress = build.Progress(what)
    started = time.monotonic()
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    try:
        process = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True, errors="replace", env=environment)
    except OSError as error:
        raise RunFailed(f"{command[0]} cannot be run: {error.strerror}") from None
    assert process.stdout is not None
    lines = []
    for line in process.stdout:
        lines.append(line.rstrip("\n"))
        progress.show(f"{time.monotonic() - started:.0f} s: {lines[-1][:60]}")
    status = process.wait()
    progress.end(f"{time.monotonic() - started:.0f} s")
    return status, lines


def of_tool(name: str, *arguments: str) -> Result:
    """Runs a tool of ours; its output counts in whole lines."""
    command = [f"tools/{name}", *arguments]
    if not (ROOT / command[0]).is_file():
        return Result(problem=f"there is no {command[0]} yet")
    status, lines = follow(name, [str(ROOT / command[0]), *arguments])
    out = Result([Line(line.strip(), shlex.join(command)) for line in lines])
    if status != 0:
        last = next((line for line in reversed(lines) if line.strip()), "it said nothing")
        out.problem = f"`{shlex.join(command)}` ended with {status}: {last}"
    return filtered(out, name)


def of_tests() -> Result:
    """Lines the tests print, each with the ctest command that repeats it."""
    folder = build.build("host")
    status, lines = follow("tests", ["ctest", "--test-dir", str(folder), "-V", "-L", "unit|loop", "-j", "2"])
    failed = [m[1] for line in lines if (m := re.match(r"^\s*\d+ - (\S+) \((?:Failed|Timeout|.*Exception)", line))]
    out = Result(problem="" if status == 0 else f"failed: {', '.join(failed) or 'ctest'}")
    names: dict[str, str] = {}
    for line in lines:
        start = START.match(line)
        if start:
            names[start[1]] = start[2]
        said = OF_TEST.match(line)
        if said:
            text = re.sub(r"^\S+\.c:\d+:\w+:INFO: ", "", said[2]).strip()
            out.lines.append(Line(text, f"ctest --test-dir build/host -V -R '^{names.get(said[1], '')}$'"))
    return filtered(out, "tests")


def of_long() -> Result:
    """Every case of what the tests run a sample of."""
    out = Result()
    for folder, name, argument in (("unit", "test_storage_power", "all"), ("unit", "test_storage_unstable", "all"),
                                   ("loop", "test_interrupted", "100000")):
        build.build("host", (name,))
        program = f"build/host/tests/{folder}/{name}"
        status, lines = follow(name, [str(build_dir("host") / "tests" / folder / name), argument])
        out.lines += [Line(line.strip(), f"{program} {argument}") for line in lines]
        if status != 0:
            out.problem = f"`{program} {argument}` ended with {status}"
    return filtered(out, "long")


def of_board() -> Result:
    """Lines of the test that runs automatic start-up on the image."""
    for preset, targets in (("host", ("reflux-sim", "reflux-host")), ("host-fixed", ("reflux-host",)),
                            ("stm32f405", ()), ("stm32f405-fixed", ())):
        build.build(preset, targets)
    test = "tests/target/test_commission.py"
    status, lines = follow("board", [sys.executable, str(ROOT / test), "all"])
    # The summary of the tests before is a dot in front of a line.
    out = Result([Line(line.lstrip(".").strip(), f"python3 {test} all") for line in lines])
    if status != 0:
        out.problem = f"`python3 {test} all` ended with {status}"
    return filtered(out, "board")


def of_time() -> Result:
    """Duration of the last run of all tests, from ctest's own log."""
    log = build_dir("test") / "Testing" / "Temporary" / "LastTest.log"
    try:
        text = log.read_text(errors="replace")
    except OSError:
        return Result(problem="tools/test has not been run here")
    # Both lines read `Nov 21 02:50 UTC`; the epoch is on the lines of each test only as a time of day.
    tests = len(re.findall(r"^\d+/\d+ Test: ", text, re.M))
    took = sum(float(x) for x in re.findall(r"^Test time = +([\d.]+) sec", text, re.M))
    times = re.findall(r"^(?:Start|End) testing: (\w+ +\d+ [\d:]+)", text, re.M)
    wall = ""
    if len(times) == 2:
        first, last = (datetime.datetime.strptime(t + " 2000", "%b %d %H:%M %Y") for t in times)
        wall = f"{int((last - first).total_seconds() // 60)} minutes, "
    labels = set(re.findall(r"^\d+/\d+ Test: (\w+)\.", text, re.M))
    return filtered(Result([Line(f"tools/test: {tests} tests, {wall}{took / 60:.0f} minutes of tests one after the "
                                 f"other ({', '.join(sorted(labels))})", "tools/test")]), "time")


def of_ports() -> Result:
    out = Result()
    for board in boards.BOARDS:
        part = of_tool("mutate", "--board", board, "--random", PORT_FAULTS, "--seed", RANDOM_SEED)
        out.lines += part.lines
        out.problem = out.problem or part.problem
    return out


SOURCES: dict[str, Callable[[], Result]] = {
    "tests": of_tests,
    "long": of_long,
    "fuzz": lambda: of_tool("fuzz"),
    "prove": lambda: of_tool("prove"),
    "board": of_board,
    "image": lambda: of_tool("image"),
    "coverage": lambda: of_tool("coverage"),
    "mutate": lambda: of_tool("mutate"),
    "random": lambda: of_tool("mutate", "--random", "300", "--seed", RANDOM_SEED),
    "ports": of_ports,
    "time": of_time,
}


def filtered(result: Result, name: str) -> Result:
    """Only what a section wants; the same line twice is one."""
    wanted = [re.compile(s.pattern) for s in SECTIONS if s.source == name]
    seen: dict[str, Line] = {}
    for line in result.lines:
        if any(p.fullmatch(line.text) for p in wanted):
            seen.setdefault(line.text, line)
    result.lines = list(seen.values())
    return result


def store(name: str) -> Path:
    return build_root() / "evidence" / f"{name}.json"


def keep(name: str, result: Result) -> None:
    store(name).parent.mkdir(parents=True, exist_ok=True)
    store(name).write_text(json.dumps(asdict(result)), encoding="utf-8")


def load(name: str) -> Result:
    try:
        data = json.loads(store(name).read_text(encoding="utf-8"))
        return Result(**{**data, "lines": [Line(**line) for line in data["lines"]]})
    except (OSError, ValueError, TypeError, KeyError):
        return Result()


def kept_sections(path: Path) -> dict[str, str]:
    """The figures of each section the page has, by its title: commands with what they printed, and the day."""
    try:
        parts = re.split(r"^## (.*)\n", path.read_text(encoding="utf-8"), flags=re.M)
    except OSError:
        return {}
    found = ((title, re.search(r"^    \$ .*\Z", text, re.M | re.S)) for title, text in zip(parts[1::2], parts[2::2]))
    return {title: figures[0].rstrip() + "\n" for title, figures in found if figures}


def page(results: dict[str, Result], kept: dict[str, str]) -> tuple[str, list[str]]:
    """The page, and the titles of sections without a figure. kept: figures of sections whose source has not been run here."""
    out = ["# Evidence\n", "Counts, each with the command that prints it. Written by `tools/evidence`; changes here "
           "are lost. A `+` behind a commit says that the sources had changes on top of it.\n"]
    lacking = []
    for section in SECTIONS:
        result = results[section.source]
        lines = [line for line in result.lines if re.fullmatch(section.pattern, line.text)]
        out.append(f"## {section.title}\n")
        if section.text:
            out.append(section.text + "\n")
        if not result.when and section.title in kept:
            out.append(kept[section.title])
            continue
        for command in dict.fromkeys(line.command for line in lines):
            out.append(f"    $ {command}")
            out += [f"    {line.text}" for line in lines if line.command == command]
            out.append("")
        if lines:
            out.append(f"{result.when}, commit {result.commit or 'unknown'}."
                       + (f" **Not all was good: {result.problem}**" if result.problem else "") + "\n")
        else:
            lacking.append(section.title)
            out.append(f"*Not available: {result.problem or not_yet(section.source, result)}.*\n")
    return "\n".join(out).rstrip() + "\n", lacking


def not_yet(source: str, result: Result) -> str:
    if not result.when:
        return f"`tools/evidence {source}` has not been run"
    return f"nothing that was run printed a line like `{section_hint(source)}`"


def section_hint(source: str) -> str:
    return next(s.pattern for s in SECTIONS if s.source == source)
