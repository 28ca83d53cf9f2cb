"""tools/test: builds what the tests need and puts all of them behind one ctest.

Each preset has a build tree with tests of its own. Their entries are read (ctest --show-only=json-v1) and
written once more, with the preset before their names, into one tree, build/test, together with the tests that
belong to no preset: style, the tools themselves, whole runs and campaigns.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

from reflux_tools import boards, build, machine_code
from reflux_tools.errors import RunFailed, UserError
from reflux_tools.paths import CAMPAIGNS, ROOT, build_dir

LABELS = ("unit", "loop", "fuzz", "target", "style", "tools", "campaign")
SANITIZED = ("asan", "asan-fixed")
HANG_S = 1800.0  # stops a test that hangs, and is far longer than any takes on a busy machine
COPIED = ("LABELS", "TIMEOUT", "WORKING_DIRECTORY", "ENVIRONMENT", "WILL_FAIL", "RUN_SERIAL", "PROCESSORS",
          "RESOURCE_LOCK", "SKIP_RETURN_CODE", "PASS_REGULAR_EXPRESSION", "FAIL_REGULAR_EXPRESSION")
# What one test leaves for another: each build tree has its own.
FIXTURES = ("FIXTURES_SETUP", "FIXTURES_CLEANUP", "FIXTURES_REQUIRED")


@dataclass
class Test:
    """One entry of the tree."""

    name: str
    command: list[str]
    labels: list[str]
    properties: dict[str, object] = field(default_factory=dict)


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/test",
        description="Builds and runs the tests behind one ctest, whose summary comes last. Labels: unit and loop "
        "(on the host, with sanitizers, in float and in fixed point), fuzz (the kept corpora and a short run from them), "
        "target (the image in the emulator), style "
        "(clang-format and clang-tidy), tools (the tools themselves), campaign (a twentieth of each campaign).")
    p.add_argument("labels", nargs="*", metavar="LABEL", help=f"only these: {', '.join(LABELS)} (default: all)")
    p.add_argument("-j", "--jobs", type=int, default=max(2, os.cpu_count() or 2), metavar="N")
    p.add_argument("-R", "--regex", metavar="REGEX", help="only tests whose names match")
    p.add_argument("--list", action="store_true", help="build, list the tests, run none")
    options = p.parse_args(arguments)
    for label in options.labels:
        if label not in LABELS:
            raise UserError(f'"{label}" is no label; known are: {", ".join(LABELS)}')
    if options.jobs < 1:
        raise UserError("--jobs must be 1 or more")
    labels = set(options.labels or LABELS)
    tests = collect(labels)
    folder = write_tree(tests)
    return run_ctest(folder, options)


def collect(labels: set[str]) -> list[Test]:
    """Builds what these labels need and returns their tests."""
    tests: list[Test] = []
    if labels & {"unit", "loop", "fuzz"}:
        tests += sanitized_tests(labels)
    if labels & {"loop", "target", "campaign"}:
        build.build("host", ("reflux-sim", "reflux-sim-memory", "reflux-plant", "reflux-host", "libreflux"))
    if labels & {"tools", "campaign"}:
        build.build("host", ("libreflux", "libreflux_board"))
    if "campaign" in labels:
        for preset in ("host", "host-fixed"):
            build.build(preset, ("endurance", "libreflux_board"))
        build.build("host", ("endurance_kalman",))
    if "loop" in labels:
        tests += loop_tests()
    if "target" in labels:
        build.build("host-fixed", ("reflux-host",))
        for preset in boards.PRESETS:
            build.build(preset)
        tests += target_tests()
    if "style" in labels:
        for preset in ("host", *boards.BOARDS):
            build.configure(preset)
        tests += style_tests()
    if "tools" in labels:
        tests += python_tests("tools")
    if "campaign" in labels:
        tests += campaign_tests()
    return tests


def sanitized_tests(labels: set[str]) -> list[Test]:
    """Float and fixed point; of the second what is other machine code than the first. Where num_t does not occur a
    program is the same one twice."""
    first, second = SANITIZED
    for preset in SANITIZED:
        build.build(preset)
    tests = [test for test in tests_of(first) if labels & set(test.labels)]
    known = {test.name.removeprefix(f"{first}."): test for test in tests}
    both = [test for test in tests_of(second) if labels & set(test.labels)]
    for test in both:
        twin = known.get(test.name.removeprefix(f"{second}."))
        if twin is None or not same_test(twin, test):
            tests.append(test)
    print(f"{len(both) - (len(tests) - len(known))} of {len(both)} tests are the same machine code in {first} and {second}, "
          "and run once", flush=True)
    return tests


def same_test(left: Test, right: Test) -> bool:
    """The same command on programs that are the same machine code."""
    folders = [str(build_dir(preset)) + os.sep for preset in SANITIZED]
    if len(left.command) != len(right.command) or left.properties.get("ENVIRONMENT") != right.properties.get("ENVIRONMENT"):
        return False
    for a, b in zip(left.command, right.command):
        if a == b:
            continue
        if not (a.startswith(folders[0]) and b.startswith(folders[1]) and a[len(folders[0]):] == b[len(folders[1]):]
                and machine_code.is_program(Path(a)) and machine_code.is_program(Path(b))
                and machine_code.same(Path(a), Path(b))):
            return False
    return True


def tests_of(preset: str) -> list[Test]:
    """The entries of one build tree, with the preset before their names."""
    answer = subprocess.run(["ctest", "--test-dir", str(build_dir(preset)), "--show-only=json-v1"],
                            capture_output=True, text=True, check=False)
    if answer.returncode != 0:
        raise RunFailed(f"ctest cannot list the tests of {preset}: {answer.stderr.strip()}")
    out = []
    for entry in json.loads(answer.stdout)["tests"]:
        properties = {item["name"]: item["value"] for item in entry.get("properties", [])}
        if "command" not in entry:
            raise RunFailed(f"test {entry['name']} of {preset} was not built")
        labels = properties.pop("LABELS", [])
        kept = {key: value for key, value in properties.items() if key in COPIED}
        kept |= {key: [f"{preset}.{name}" for name in properties[key]] for key in FIXTURES if key in properties}
        out.append(Test(f"{preset}.{entry['name']}", entry["command"], list(labels), kept))
    return out


def python() -> str:
    return sys.executable


WITH_BLOCKS = ("stm32f405", "stm32f405-fixed")
KALMAN = ("begin", "set block3.method ekf", "set block3.noise 0.2", "set block3.feed_z 0.02")


def loop_tests() -> list[Test]:
    """The same scenario inside one process and over a socket: one and the same log; and whole-firmware tests."""
    return [same_log("loop.smoke-memory-and-host", "memory", "host", "loop"), *python_tests("loop")]


def target_tests() -> list[Test]:
    """The same scenario on the host and on the image in the emulator."""
    whole = [image for image in boards.RUNS if image.preset in WITH_BLOCKS]
    return [*(same_log(f"target.smoke-{image.test}", image.twin, image.preset, "target") for image in boards.RUNS),
            # Bare: when a proposal comes into force depends on how fast the main loop is.
            *(same_log(f"target.self-tuning-{image.test}", image.twin, image.preset, "target", "self-tuning-pair",
                       ("begin", "set block1.supervise off", "apply"))
              for image in whole),
            *(same_log(f"target.decoupled-{image.test}", image.twin, image.preset, "target", "kotyk-decoupled")
              for image in whole),
            *(same_log(f"target.state-{image.test}", image.twin, image.preset, "target", "pilot-state", until=10800)
              for image in whole),
            *(same_log(f"target.ahead-{image.test}", image.twin, image.preset, "target", "pilot-ahead", until=3600) for image in whole),
            # Until it proposes.
            *(same_log(f"target.experiment-{image.test}", image.twin, image.preset, "target", "kotyk-experiment", until=135600)
              for image in whole),
            same_log("target.estimate-float", "host", "stm32f405", "target", "methanol-estimate"),
            # Until the feed has changed: three components, and two with a linear model.
            *(same_log(f"target.kalman-{covariance}-{image.test}", image.twin, image.preset, "target", "splitter-estimate",
                       (*KALMAN, f"set block3.covariance {covariance}", "apply"), until=5400)
              for covariance in ("full", "band") for image in whole),
            same_log("target.kalman-linear-float", "host", "stm32f405", "target", "pilot-kalman",
                     ("begin", "set block2.method kalman", "set block2.covariance band", "apply"), until=7200),
            *python_tests("target")]


def python_tests(label: str) -> list[Test]:
    """Every test_*.py of tests/LABEL."""
    files = sorted((ROOT / "tests" / label).glob("test_*.py"))
    return [Test(f"{label}.{f.stem.removeprefix('test_')}", [python(), str(f)], [label], {"TIMEOUT": HANG_S})
            for f in files]


def same_log(name: str, left: str, right: str, label: str, scenario: str = "smoke", lines: tuple[str, ...] = (),
             until: int | None = None) -> Test:
    ends = [] if until is None else ["--until", str(until)]
    command = [python(), str(ROOT / "tests" / "loop" / "same_log.py"), *ends, f"host_sim/scenarios/{scenario}.toml", left, right, *lines]
    return Test(name, command, [label], {"TIMEOUT": HANG_S})


def style_tests() -> list[Test]:
    command = [str(ROOT / "tools" / "style")]
    return [Test(f"style.{what}", [*command, what], ["style"], {"TIMEOUT": HANG_S})
            for what in ("clang-format", "clang-tidy")]


def campaign_tests() -> list[Test]:
    """A twentieth of each campaign's seeds; the campaign itself uses all processors."""
    command = str(ROOT / "tools" / "campaign")
    return [Test(f"campaign.{f.stem}", [command, f.stem, "--fraction", "0.05", "--check", "--no-build"],
                 ["campaign"], {"TIMEOUT": HANG_S, "RUN_SERIAL": "ON"}) for f in sorted(CAMPAIGNS.glob("*.toml"))]


def write_tree(tests: list[Test]) -> Path:
    folder = build_dir("test")
    folder.mkdir(parents=True, exist_ok=True)
    names = [test.name for test in tests]
    doubled = sorted({name for name in names if names.count(name) > 1})
    if doubled:
        raise RunFailed(f"two tests are called {doubled[0]}")
    text = ["# Written by tools/test; changes here are lost.\n"]
    for test in tests:
        text.append(f"add_test({quote(test.name)} {' '.join(map(quote, test.command))})\n")
        pairs = {"LABELS": test.labels, "WORKING_DIRECTORY": str(ROOT), **test.properties}
        words = " ".join(f"{key} {quote(value)}" for key, value in pairs.items())
        text.append(f"set_tests_properties({quote(test.name)} PROPERTIES {words})\n")
    (folder / "CTestTestfile.cmake").write_text("".join(text), encoding="utf-8")
    return folder


def quote(value: object) -> str:
    """CMake's bracket argument: nothing in it is special."""
    if isinstance(value, bool):
        value = "ON" if value else "OFF"
    if isinstance(value, list):
        value = ";".join(map(str, value))
    return f"[==[{value}]==]"


def run_ctest(folder: Path, options: argparse.Namespace) -> int:
    command = ["ctest", "--test-dir", str(folder), "--output-on-failure", "--no-tests=error", "-j", str(options.jobs)]
    if options.regex:
        command += ["-R", options.regex]
    if options.list:
        command.append("--show-only")
    print(flush=True)
    return subprocess.run(command, cwd=ROOT, check=False).returncode
