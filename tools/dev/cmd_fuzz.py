"""tools/fuzz: the fuzz targets of tests/fuzz under libFuzzer, and the corpora kept from them."""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

from reflux import build, packages
from reflux.errors import RunFailed, UserError
from reflux.paths import ROOT, build_dir, shown

FUZZ = ROOT / "tests" / "fuzz"
# bytes of an input
LONGEST = {"plants": 4096, "frame": 1024, "messages": 256, "console": 128, "mixed": 128, "records": 256, "restore": 256,
           "column_table": 64}
KEPT_FILES, KEPT_BYTES = 70, 100_000  # of one corpus


@dataclass
class Result:
    inputs: int
    seconds: float
    crashes: list[Path]
    edges: int


def targets() -> list[str]:
    return sorted(f.stem.removeprefix("fuzz_") for f in FUZZ.glob("fuzz_*.c") if f.stem != "fuzz_board")


def main(arguments: list[str]) -> int:
    known = targets()
    p = argparse.ArgumentParser(
        prog="tools/fuzz",
        description=f"Runs fuzz targets under libFuzzer with sanitizers, one after the other: {', '.join(known)}. Inputs "
        "that end badly are kept in build/PRESET/crashes; replay them with build/PRESET/tests/fuzz/fuzz_NAME FILE.")
    p.add_argument("names", nargs="*", metavar="NAME", help="targets (default: all)")
    p.add_argument("--runs", type=int, default=1_000_000, metavar="N", help="inputs for each target (default 1000000)")
    p.add_argument("--seconds", type=int, default=3600, metavar="S", help="longest time for each target (default 3600)")
    p.add_argument("--seed", type=int, default=1, metavar="N")
    p.add_argument("--small", action="store_true",
                   help="use the scalar type and the limits of the STM32F100 (preset and folder fuzz-small)")
    p.add_argument("--keep", action="store_true",
                   help="replace tests/fuzz/corpus/NAME by the smallest set of inputs that reaches as much")
    options = p.parse_args(arguments)
    if options.keep and options.small:
        raise UserError("--keep is for the larger build: what the small one reaches is not all there is")
    preset = "fuzz-small" if options.small else "fuzz"
    for name in options.names:
        if name not in known:
            raise UserError(f'"{name}" is not a fuzz target; there are: {", ".join(known)}')
    if options.runs < 1 or options.seconds < 1 or options.seed < 1:
        raise UserError("--runs, --seconds and --seed must be 1 or more")
    chosen = options.names or known
    packages.need("host", "fuzz")
    build.build(preset, tuple(f"fuzz_{name}" for name in chosen))
    bad = 0
    for name in chosen:
        result = run(name, preset, options)
        if options.keep and not result.crashes:
            keep(name)
        files = [f for f in (FUZZ / "corpus" / name).glob("*") if f.is_file()]
        print(f"{preset} {name}: inputs {result.inputs}, crashes {len(result.crashes)}, edges {result.edges}, corpus files "
              f"{len(files)}, bytes {sum(f.stat().st_size for f in files)}, seed {options.seed}, "
              f"{result.seconds:.0f} s", flush=True)
        for crash in result.crashes:
            print(f"    {shown(crash)}")
        bad += len(result.crashes)
    return 1 if bad else 0


def program(name: str, preset: str = "fuzz") -> str:
    return str(build_dir(preset) / "tests" / "fuzz" / f"fuzz_{name}")


def run(name: str, preset: str, options: argparse.Namespace) -> Result:
    crashes = build_dir(preset) / "crashes"
    work, kept = build_dir(preset) / "corpus" / name, FUZZ / "corpus" / name
    for folder in (crashes, work, kept):
        folder.mkdir(parents=True, exist_ok=True)
    before = set(crashes.glob(f"{name}-*"))
    command = [program(name, preset), f"-runs={options.runs}", f"-max_total_time={options.seconds}", f"-seed={options.seed}",
               f"-max_len={LONGEST.get(name, 512)}", "-print_final_stats=1", f"-artifact_prefix={crashes}/{name}-"]
    dictionary = FUZZ / f"{'console' if name == 'mixed' else name}.dict"
    if dictionary.is_file():
        command.append(f"-dict={dictionary}")
    started = time.monotonic()
    progress = build.Progress(f"{preset} {name}")
    log = build_dir(preset) / f"{name}.log"
    inputs = edges = 0
    with log.open("w") as out:
        process = subprocess.Popen([*command, str(work), str(kept)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                   text=True, errors="replace", cwd=ROOT)
        assert process.stderr is not None
        for line in process.stderr:
            out.write(line)
            if match := re.match(r"#(\d+)\s+\w+\s+cov: (\d+)", line):
                inputs, edges = int(match[1]), int(match[2])
                progress.show(f"{inputs} of {options.runs} inputs")
            elif match := re.match(r"stat::number_of_executed_units:\s*(\d+)", line):
                inputs = int(match[1])
        status = process.wait()
    found = sorted(set(crashes.glob(f"{name}-*")) - before)
    if status != 0 and not found:
        raise RunFailed(f"fuzz target {name} ended with status {status}; what it said is in {shown(log)}")
    return Result(inputs, time.monotonic() - started, found, edges)


def keep(name: str) -> None:
    """Edges decide, not how often they are passed: small and still everywhere. The shortest inputs are preferred."""
    small = build_dir("fuzz") / "corpus" / f"{name}.small"
    shutil.rmtree(small, ignore_errors=True)
    small.mkdir(parents=True)
    command = [program(name), "-merge=1", "-use_counters=0", f"-max_len={LONGEST.get(name, 512)}", str(small),
               str(build_dir("fuzz") / "corpus" / name), str(FUZZ / "corpus" / name)]
    answer = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    if answer.returncode != 0:
        raise RunFailed(f"the corpus of {name} could not be minimised: {answer.stderr.strip().splitlines()[-1]}")
    kept = FUZZ / "corpus" / name
    for old in kept.glob("*"):
        old.unlink()
    size = 0
    files = sorted(small.iterdir(), key=lambda f: (f.stat().st_size, f.name))
    if len(files) > KEPT_FILES:  # a spread over all sizes
        files = [files[i * len(files) // KEPT_FILES] for i in range(KEPT_FILES)]
    for f in files:
        size += f.stat().st_size
        if size <= KEPT_BYTES:
            shutil.copyfile(f, kept / f.name[:16])
