"""tools/test: builds what the tests need and puts all of them behind one ctest.

Each preset has a build tree with tests of its own. Their entries are written once more, with the preset before their
names, into one tree, build/test, together with the tests that belong to no preset: style, the tools, whole runs, campaigns.
"""

from __future__ import annotations

import argparse
import os
import re
import resource
import time

from reflux import packages
from reflux.errors import UserError
from dev.testing import changed, running, tiers, times
from dev.testing.entries import LABELS, Test, collect

PACKAGES = {"target": ("target",), "style": ("target", "test"), "tools": ("target", "test", "wheel")}  # beside host
WITHIN_S = 70.0  # of tests; building after one edited file takes up to 20 s more


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/test",
        description="Builds and runs the tests behind one ctest, whose summary comes last. Labels: unit and loop "
        "(on the host, with sanitizers, in float and in fixed point), fuzz (the kept corpora and a short run from them), "
        "target (the image in the emulator), style (clang-format, clang-tidy), tools (the tools themselves, and README's "
        "commands), campaign (a twentieth of the shorter campaigns).")
    p.add_argument("labels", nargs="*", metavar="LABEL", help=f"only these: {', '.join(LABELS)} (default: all)")
    p.add_argument("--all", action="store_true",
                   help="the full tier too: long statistics, every case of sampled tests, static analyzer, all images, every documented command")
    p.add_argument("--changed", nargs="?", const="", metavar="COMMIT",
                   help="only tests that reach what differs from COMMIT (default: uncommitted changes, or the last commit)")
    p.add_argument("--within", type=float, default=WITHIN_S, metavar="SECONDS",
                   help=f"with --changed: run the shortest tests that fit into this time and name the others (default {WITHIN_S:g}; 0: no limit)")
    p.add_argument("-j", "--jobs", type=int, default=(os.cpu_count() or 2) + 1, metavar="N",
                   help="tests at a time (default: one more than processors, because some wait)")
    p.add_argument("-R", "--regex", metavar="REGEX", help="only tests whose names match")
    p.add_argument("--list", action="store_true", help="list the tests of each tier, and why a test is in the full tier; run none")
    p.add_argument("--cases", action="store_true", help="list every test function with the tier in which it runs; run none")
    p.add_argument("--keep-times", action="store_true", help="write the seconds of this run to tests/times.txt")
    options = p.parse_args(arguments)
    for label in options.labels:
        if label not in LABELS:
            raise UserError(f'"{label}" is not a label; known are: {", ".join(LABELS)}')
    if options.jobs < 1:
        raise UserError("--jobs must be 1 or more")
    if not options.within >= 0.0:
        raise UserError("--within must be 0 or more")
    try:
        wanted = re.compile(options.regex or "")
    except re.error as error:
        raise UserError(f'--regex "{options.regex}": {error}') from None
    labels = set(options.labels or LABELS)
    packages.need("host", *sorted({group for label in labels for group in PACKAGES.get(label, ())}), sets_up=True)
    default, reasons, full = tiers.split(collect(labels), labels, tiers.rows())
    default, full = ([t for t in some if wanted.search(t.name)] for some in (default, full))
    seconds = times.load()
    if options.cases:
        from dev.testing import cases
        return cases.show(default, full)
    if options.list:
        return show(default, full, reasons, seconds, options.jobs)
    tests = [*default, *full] if options.all else default
    if not tests:
        raise UserError(f'--regex "{options.regex}": ' + ("only tests of the full tier match; --all runs them" if full
                                                       else "no test's name matches; tools/test --list names them all"))
    if options.changed is not None:
        tests = changed.choose(tests, options.changed)
        if not tests:
            print("tools/test: no test reaches what has changed")
            return 0
        if options.within > 0:
            tests = shortest(tests, seconds, options)
    return execute(tests, options, seconds)


def shortest(tests: list[Test], seconds: dict[str, float], options: argparse.Namespace) -> list[Test]:
    """Those that fit into --within; names the others. A file that the whole firmware needs is reached by half of all tests."""
    fit = changed.fitting(tests, seconds, options.within * options.jobs)
    names = {test.name for test in fit}
    left = [test for test in tests if test.name not in names]
    if left:
        print(f"{len(left)} of them do not fit into {options.within:g} s and are left to tools/test (--within 0 runs them): "
              f"{', '.join(test.name for test in left)}", flush=True)
    return fit


def execute(tests: list[Test], options: argparse.Namespace, seconds: dict[str, float]) -> int:
    """Builds, runs, and prints what it took."""
    begun = time.monotonic()
    wanted = frozenset().union(*(test.needs for test in tests))
    running.build_needs(wanted | tiers.needs_of_full(tests) if options.all else wanted)
    built, built_cpu = time.monotonic(), processor_s()
    print(f"\nExpected: {times.by_label(tests, seconds, options.jobs)}\n", flush=True)
    status, watch = running.run(running.write_tree(tests, seconds), tests, seconds, options.jobs)
    times.store(watch.seconds)
    if options.keep_times:
        times.keep(tests, times.load())
    ended, cpu = time.monotonic(), processor_s()
    print(f"\ntools/test: {len(tests)} tests in {ended - begun:.0f} s ({built - begun:.0f} s of it building), "
          f"{cpu:.0f} s of processor time ({built_cpu:.0f} s of it building)")
    return status


def processor_s() -> float:
    """Processor time of everything that was started here and has ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def show(default: list[Test], full: list[Test], reasons: dict[str, str], seconds: dict[str, float], jobs: int) -> int:
    """Both tiers."""
    print(f"tools/test: {len(default)} tests; {times.by_label(default, seconds, jobs)}")
    for test in default:
        print(f"    {test.name}")
    print(f"\nOnly tools/test --all: {len(full)} tests; {times.by_label(full, seconds, jobs)}")
    for reason in dict.fromkeys(reasons[test.name] for test in full):
        print(f"  {reason}:")
        for test in full:
            if reasons[test.name] == reason:
                print(f"    {test.name}")
    return 0
