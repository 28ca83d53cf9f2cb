"""tools/prove: the bounds of the frame codec, proved by Frama-C WP from the contracts in its sources."""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import time

from reflux import build, packages
from reflux.errors import RunFailed
from reflux.paths import ROOT, build_root, shown

SOURCES = ("firmware/link/frame.c",)
OPTIONS = ("-wp", "-wp-rte", "-wp-prover", "z3", "-wp-par", "1")


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/prove",
        description="Proves with Frama-C WP that no access of the frame codec leaves its buffers, that nothing overflows, "
        "and that every loop ends, for every input (docs/inside/proofs.md). Takes a minute or two.")
    p.add_argument("--timeout", type=int, default=10, metavar="S", help="time for one goal (default 10)")
    options = p.parse_args(arguments)
    packages.need("host", "prove")
    folder = build_root() / "prove"
    folder.mkdir(parents=True, exist_ok=True)
    configuration = folder / "why3.conf"
    environment = {**os.environ, "WHY3CONFIG": str(configuration)}
    if not configuration.is_file():
        _run(["why3", "config", "detect"], environment)
    failed = 0
    for source in SOURCES:
        started = time.monotonic()
        progress = build.Progress(f"proving {source}")
        progress.show("...")
        cpp = f"-I{ROOT / 'firmware'} -include {ROOT / 'tests' / 'proofs' / 'stubs.h'}"
        text = _run(["frama-c", *OPTIONS, "-wp-timeout", str(options.timeout), f"-cpp-extra-args={cpp}", source],
                    environment)
        (folder / "prove.log").write_text(text, encoding="utf-8")
        match = re.search(r"Proved goals:\s*(\d+) / (\d+)", text)
        if match is None:
            raise RunFailed(f"frama-c proved nothing; what it said is in {shown(folder / 'prove.log')}")
        proved, goals = int(match[1]), int(match[2])
        failed += goals - proved
        progress.end(f"goals {goals}, proved {proved}, {time.monotonic() - started:.0f} s")
        for line in re.findall(r"Goal (\S+) : (?:Failed|Timeout|Unknown)", text):
            print(f"    not proved: {line}")
    return 1 if failed else 0


def _run(command: list[str], environment: dict[str, str]) -> str:
    try:
        answer = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, errors="replace",
                                check=False)
    except FileNotFoundError:
        raise RunFailed(f"there is no program {command[0]}; tools/bootstrap evidence installs it") from None
    if answer.returncode != 0:
        last = (answer.stdout + answer.stderr).strip().splitlines()
        raise RunFailed(f"{command[0]}: {last[-1] if last else 'it said nothing'}")
    return answer.stdout
