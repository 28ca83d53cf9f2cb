"""tools/bench: how fast, how many instructions, how large. Numbers to look at, never pass or fail."""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Callable

from dev import bench_composition, bench_decoupling, bench_estimation, bench_feedforward, bench_kalman, bench_link, bench_plants, bench_tick
from reflux import build, launch, runner, scenario, table
from research import trays
from reflux.boards import BOARDS
from reflux.errors import RunFailed, UserError
from reflux.paths import ROOT, SCENARIOS, build_dir, named, shown

RESULTS = ROOT / "tests" / "bench" / "results.md"
ICOUNT = ("-icount", "shift=0")
LINK_TICKS = 40
STATS_AT_END = "stats"
Parts = list[tuple[str, list[str], list[list[str]]]]
DAY_TITLE = "A day of the splitter, both ends by tray temperatures, 30 s ticks"


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/bench",
        description="Measures speed, instructions per tick and memory, prints the tables and writes them to "
        "tests/bench/results.md. A table that cannot be measured here says why.")
    p.add_argument("--ticks", type=int, default=4000, metavar="N", help="ticks of each speed run (default 4000)")
    p.add_argument("--plants", action="store_true", help="only the simulated plants, print only")
    p.add_argument("--lockstep", action="store_true", help="only lockstep ticks per second, as scenarios run, print only")
    p.add_argument("--link", action="store_true", help="only the cost of the plant link per tick; prints it and writes no file")
    p.add_argument("--tick", action="store_true", help="only a tick without the link, print only")
    p.add_argument("--estimation", action="store_true", help="only estimators, the self-tuner and tray temperature control, print only")
    p.add_argument("--decoupling", action="store_true", help="only decouplers and pole placement, print only")
    p.add_argument("--feedforward", action="store_true", help="only adaptive feedforward, print only")
    p.add_argument("--image", action="store_true", help="only the sizes of images and their largest stack frames, print only")
    p.add_argument("--renew", action="store_true", help="with --lockstep, --estimation, --decoupling, --feedforward or --image: write these tables into FILE and leave its others")
    p.add_argument("--before", metavar="COMMIT", default=bench_tick.BEFORE,
                   help=f"version beside which a tick without the link is counted (default {bench_tick.BEFORE}); it is built "
                   "in the build folder")
    p.add_argument("--out", type=named, default=RESULTS, metavar="FILE")
    options = p.parse_args(arguments)
    if options.ticks < 10:
        raise UserError("--ticks must be 10 or more")
    if options.link:
        build.build("host", ("reflux-sim",))
        print(f"\n{bench_link.TITLE}\n{table.columns(bench_link.HEADER, link_rows())}", flush=True)
        return 0
    if options.lockstep or options.estimation or options.decoupling or options.feedforward or options.image:
        some = [*(lockstep_parts(options.ticks) if options.lockstep else []), *(estimation_parts() if options.estimation else []), *(bench_decoupling.parts() if options.decoupling else []),
                *(bench_feedforward.parts() if options.feedforward else []),
                *(image_parts() if options.image else [])]
        for title, header, rows in some:
            print(f"\n{title}\n{table.columns(header, rows)}", flush=True)
        if options.renew:
            options.out.write_text(renewed(options.out.read_text(encoding="utf-8"), some), encoding="utf-8")
        return 0
    if options.renew:
        raise UserError("--renew goes with --lockstep, --estimation, --decoupling, --feedforward or --image")
    if not re.fullmatch(r"[\w.-]+", options.before):
        raise UserError("--before must be a commit or a tag")
    bench_tick.check(options.before)
    if options.tick:
        print(f"\n{bench_tick.TITLE}\n{table.columns(bench_tick.header(options.before), tick_rows(options.before))}", flush=True)
        return 0
    launch.build_for("memory")
    build.build("host", ("plant_cost", "matrix_cost", "libreflux_lab"))
    if options.plants:
        for title, header, rows in bench_plants.parts():
            print(f"\n{title}\n{table.columns(header, rows)}", flush=True)
        return 0
    parts = [
        *bench_plants.parts(),
        (DAY_TITLE, ["law", "firmware", "s of wall time", "times real time"], day_rows()),
        *lockstep_parts(options.ticks),
        ("Instructions per tick", ["where", "how", "least", "mean", "most"], instruction_rows()),
        (bench_tick.TITLE, bench_tick.header(options.before), tick_rows(options.before)),
        (bench_link.TITLE, bench_link.HEADER, link_rows()),
        *estimation_parts(),
        *bench_decoupling.parts(),
        *bench_feedforward.parts(),
        ("Instructions of matrices of 16 x 16, host", ["what", "instructions"], matrix_rows()),
        *image_parts(),
    ]
    text = ["# Speed and size\n", f"Written by `tools/bench` on {machine()}. The firmware is measured with the "
            "plant `pilot` and the scenario `smoke`.\n"]
    for title, header, rows in parts:
        print(f"\n{title}\n{table.columns(header, rows)}" if rows else f"\n{title}: nothing", flush=True)
        text.append(section(title, header, rows))
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text("\n".join(text), encoding="utf-8")
    print(f"\n{shown(options.out)}")
    return 0


def lockstep_parts(ticks: int) -> Parts:
    for kind in ("memory", "stm32f405"):
        launch.build_for(kind)
    build.build("host", ("libreflux_lab",))
    return [("Lockstep ticks per second", ["way", "ticks", "ticks per second"], speed_rows(ticks))]


def estimation_parts() -> Parts:
    return [*bench_estimation.parts(), *bench_composition.parts(counted), *bench_kalman.parts(counted)]


def image_parts() -> Parts:
    for kind in BOARDS:
        build.build(kind)
    return [
        ("The image, bytes", ["part", "text", "data", "bss"], size_rows()),
        ("Largest stack frames of the image, bytes", ["function", "frame"], stack_rows()),
    ]


def section(title: str, header: list[str], rows: list[list[str]]) -> str:
    return f"## {title}\n\n{table.markdown(header, rows)}\n"


def renewed(text: str, parts: Parts) -> str:
    """The page with these tables in place of those of the same titles; a new one stands behind the one before it."""
    head, *sections = re.split(r"^(?=## )", text, flags=re.M)
    titles = [s.splitlines()[0].removeprefix("## ") for s in sections]
    at = len(sections)
    for title, header, rows in parts:
        new = section(title, header, rows)
        if title in titles:
            at = titles.index(title)
            sections[at] = new
        else:
            at = min(at + 1, len(sections))
            sections.insert(at, new)
            titles.insert(at, title)
    return "\n".join(part.rstrip("\n") + "\n" for part in [head, *sections])


def machine() -> str:
    try:
        names = re.findall(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.M)
    except OSError:
        names = []
    return f"{names[0]} ({len(names)} threads)" if names else "a machine that does not tell its name"


def guarded(what: list[str], width: int, measure: Callable[[], list[str]]) -> list[str]:
    """A row; where measuring fails the reason stands in it."""
    try:
        return [*what, *measure()]
    except (RunFailed, UserError) as error:
        return [*what, f"not measured: {error}", *[""] * (width - len(what) - 1)]


def bench_scenario(ticks: int, firmware: str) -> scenario.Scenario:
    base = scenario.load(SCENARIOS / "smoke.toml")
    tick = base.tick_s or 30.0
    end = scenario.Line(ticks * tick, STATS_AT_END)
    return replace(base, duration_s=ticks * tick, tick_s=tick, firmware=firmware, lines=(*base.lines, end), noise=1.0)


def measured_run(ticks: int, firmware: str, extra: tuple[str, ...] = ()) -> tuple[runner.Result, list[str]]:
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        out = Path(folder)
        result = runner.run(bench_scenario(ticks, firmware), runner.Options(out, quiet=True, extra=extra))
        return result, runner.replies_in(out / "transcript.txt", STATS_AT_END)


def day_rows() -> list[list[str]]:
    """The splitter under the source's first scenario, both ends; with building and writing of nothing but the run."""
    def row(law: str, firmware: str) -> Callable[[], list[str]]:
        def measure() -> list[str]:
            structure = "sC[Q,5][R,33]" if law == "conventional" else "sC[Q,5,7][R,33,34]"
            case = trays.Case(structure, law, state="SS2", firmware=firmware)
            with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
                day = replace(trays.scenario(case, Path(folder)), duration_s=86400.0)
                wall = float(runner.run(day, runner.Options(Path(folder) / "out", quiet=True)).facts["wall_s"])
            return [f"{wall:.2f}", f"{86400 / wall:,.0f}"]
        return measure

    return [guarded([law, firmware], 4, row(law, firmware)) for law in ("conventional", "cascade", "clf") for firmware in ("memory", "host")]


def speed_rows(ticks: int) -> list[list[str]]:
    def row(firmware: str, count: int) -> Callable[[], list[str]]:
        def measure() -> list[str]:
            result, _ = measured_run(count, firmware)
            return [str(result.facts["samples"]), f"{int(result.facts['samples']) / float(result.facts['wall_s']):.0f}"]
        return measure

    ways = [("in memory", "memory", ticks), ("unix socket, host firmware", "host", ticks),
            ("unix socket, STM32F405 image in the emulator", "stm32f405", max(200, ticks // 10))]
    rows = [guarded([what], 3, row(firmware, count)) for what, firmware, count in ways]
    rows += [guarded([what], 3, lambda once=once: lab_speed(ticks, once)) for what, once in
             (("reflux.Lab, run(): with the log as numbers; processor time", True), ("reflux.Lab, step(): a call for each tick; processor time", False))]
    rows.insert(1, guarded(["pseudo-terminal, host firmware"], 3, lambda: pty_speed(ticks)))
    return rows


def lab_speed(ticks: int, once: bool) -> list[str]:
    """Firmware and plant in this process, both loops in auto; ticks per second of processor time."""
    from reflux import Lab

    with Lab("pilot") as lab:
        for loop in lab.loops:
            lab.mode(loop, "auto")
        started = time.process_time()
        if once:
            lab.run(ticks=ticks)
        else:
            for _ in range(ticks):
                lab.step()
        return [str(ticks), f"{ticks / (time.process_time() - started):.0f}"]


def pty_speed(ticks: int) -> list[str]:
    """The host firmware makes both pseudo-terminals; it is then a board on two ports."""
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        place = Path(folder)
        command = [str(build.find_program("host", "reflux-host")), "--console", f"pty:{place / 'con'}",
                   "--link", f"pty:{place / 'lnk'}", "--boot-id", "1"]
        firmware = launch.spawn("serial", command, place, Path(command[0]))
        try:
            launch.await_paths(firmware, [place / "con", place / "lnk"])
            options = runner.Options(place / "out", str(place / "con"), str(place / "lnk"), quiet=True)
            result = runner.run(bench_scenario(ticks, "serial"), options)
        finally:
            launch.end(firmware.process)
    return [str(result.facts["samples"]), f"{int(result.facts['samples']) / float(result.facts['wall_s']):.0f}"]


def instruction_rows() -> list[list[str]]:
    return [guarded(["host, x86-64", "valgrind --tool=callgrind, app_tick and below (turns between samples too)"], 5, callgrind),
            guarded(["STM32F405 image in the emulator", "TIM2 under -icount shift=0, reception included"], 5, lambda: icount("stm32f405")),
            guarded(["STM32F100 image in the emulator, fixed point", "SysTick under -icount shift=0, to 42, reception included"], 5,
                    lambda: icount("stm32f100"))]


def callgrind() -> list[str]:
    """The firmware inside the simulator; only what app_tick calls is counted."""
    counts = []
    ticks = (60, 120)  # two runs, so that the start does not count
    for count in ticks:
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            place = Path(folder)
            wanted = bench_scenario(count, "memory")
            wanted = replace(wanted, lines=())
            runner.write_script(wanted, place / "script.txt")
            program = build.find_program("host", "reflux-sim-memory")
            inside = launch.Firmware("memory", "memory", "memory", "reflux-sim-memory", program)
            command = [c for c in runner.simulator_command(wanted, inside, place) if c != "--progress"]
            counts.append(counted("app_tick", command))
    return ["-", f"{(counts[1] - counts[0]) / (ticks[1] - ticks[0]):.0f}", "-"]


def counted(function: str, command: list[str]) -> int:
    """Instructions of one function and what it calls."""
    if shutil.which("valgrind") is None:
        raise RunFailed("there is no valgrind; tools/bootstrap test installs it")
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        out = Path(folder) / "out"
        answer = subprocess.run(["valgrind", "--tool=callgrind", f"--toggle-collect={function}",
                                 f"--callgrind-out-file={out}", *command], capture_output=True, text=True, check=False)
        if answer.returncode != 0:
            raise RunFailed(f"under valgrind: {(answer.stderr.strip().splitlines() or ['failed'])[-1]}")
        found = re.search(r"^(?:summary|totals): (\d+)", out.read_text(), re.M)
    if found is None:
        raise RunFailed("callgrind wrote no totals")
    return int(found.group(1))


def or_reason(rows: Callable[[], list[list[str]]], width: int) -> list[list[str]]:
    """A whole table; where measuring fails the reason stands in it."""
    try:
        return rows()
    except (RunFailed, UserError) as error:
        return [[f"not measured: {error}", *[""] * (width - 1)]]


def tick_rows(before: str) -> list[list[str]]:
    return or_reason(lambda: bench_tick.rows(counted, before), len(bench_tick.header(before)))


def link_rows() -> list[list[str]]:
    return or_reason(lambda: bench_link.rows(lambda kind, more: measured_run(LINK_TICKS, kind, more)), len(bench_link.HEADER))


def matrix_rows() -> list[list[str]]:
    program = str(build.find_program("host", "tests/unit/matrix_cost"))
    names = (("product", "multiply"), ("equilibration", "equilibrate"), ("LU factors", "factor"), ("inverse from them", "inverse"),
             ("pseudo-inverse of 16 x 16", "pseudo_inverse"), ("pseudo-inverse of 15 x 16", "wide"))
    return [guarded([what], 2, lambda name=name: [f"{counted('measured', [program, name]):,}"]) for what, name in names]


def icount(kind: str) -> list[str]:
    _, stats = measured_run(200, kind, ICOUNT)
    return tick_stats(stats)


def tick_stats(lines: list[str]) -> list[str]:
    """`tick n 12 min 3 mean 4 max 5 last 4 unit instructions`, as the console's stats prints it."""
    for line in lines:
        if line.startswith("tick "):
            found = dict(re.findall(r"(min|mean|max) (\d+)", line))
            if len(found) == 3:
                return [found["min"], found["mean"], found["max"]]
    raise RunFailed("the firmware's stats have no line `tick ... min N mean N max N`")


def size_rows() -> list[list[str]]:
    folder = build_dir("stm32f405")
    rows = []
    libraries = sorted(folder.rglob("libreflux_*.a"))
    for library in libraries:
        sums = _size(["-t", str(library)])
        rows.append([library.stem.removeprefix("libreflux_") + " (before the linker drops what is unused)", *sums])
    for kind in BOARDS:
        image = build_dir(kind) / f"reflux-{kind}.elf"
        if image.is_file():
            rows.append([f"image {image.name}", *_size([str(image)])])
    return rows


def _size(arguments: list[str]) -> list[str]:
    answer = subprocess.run(["arm-none-eabi-size", *arguments], capture_output=True, text=True, check=False)
    if answer.returncode != 0 or not answer.stdout.strip():
        return ["-", "-", "-"]
    return answer.stdout.strip().splitlines()[-1].split()[:3]


def stack_rows(count: int = 8) -> list[list[str]]:
    """From the compiler's own figures (-fstack-usage): single frames, not sums over calls."""
    frames = []
    folder = build_dir("stm32f405")
    for path in folder.rglob("*.su"):
        if path.relative_to(folder).parts[0] == "tests":
            continue
        for line in path.read_text(errors="replace").splitlines():
            parts = line.split("\t")
            if len(parts) >= 2 and parts[1].isdigit():
                frames.append((int(parts[1]), parts[0].rsplit(":", 1)[-1]))
    return [[name, str(size)] for size, name in sorted(set(frames), reverse=True)[:count]]
