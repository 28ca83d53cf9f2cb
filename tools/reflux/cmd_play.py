"""tools/play: a simulated plant that runs under a configured board, and a console on it."""

from __future__ import annotations

import argparse
import contextlib
import difflib
import re
import time
from dataclasses import dataclass
from pathlib import Path

from reflux import build, launch, plant_file, scenario_settings, session, simulator, textfile, watch
from reflux import scenario as scenarios
from reflux.errors import Ended, RunFailed, UserError
from reflux.paths import PLANTS, SCENARIOS, shown, tool
from reflux.ports import Port
from reflux.scenario import Scenario, check_speed
from reflux.schema import load_toml
from reflux.session import Refused, Session
from reflux.terminal import CONTROL_C, LEAVE, interactive

READY_S = 20.0
SPEED = "60"
UNUSED = "-"


@dataclass(frozen=True)
class Bench:
    """What is started: the plant as reflux-sim takes it, its options, and console lines."""

    plant: str
    options: tuple[str, ...]
    lines: tuple[str, ...]


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog=tool("play"),
        description="Starts the firmware and a simulated plant on this computer, configures the board, brings the plant to its operating "
        "point, closes the loops, and opens the console. Ctrl-C (or ^]) ends everything. "
        f"NAME is a configuration in {shown(SCENARIOS)}: {', '.join(names())}.")
    p.add_argument("name", nargs="?", default="pilot", metavar="NAME", help="a configuration by name, or a .conf file together with --plant (default pilot)")
    p.add_argument("--plant", metavar="PLANT", help="another plant: a name of reflux-sim --list, or a plant file (.json)")
    p.add_argument("--speed", default=SPEED, metavar="max|X", help=f"multiple of real time (default {SPEED})")
    p.add_argument("--manual", action="store_true", help="leave the loops in manual and the outputs at their safe values")
    p.add_argument("--watch", action="store_true", help="show loops, outputs and alarms above the line where you type, as tools/console --watch does")
    p.add_argument("--no-build", action="store_true", help="do not build; use what is there")
    options = p.parse_args(arguments)
    check_speed(options.speed, "--speed")
    if options.watch:
        watch.check_terminal()
    bench = bench_of(options.name, options.plant)
    if not options.no_build:
        build.build("host", ("reflux-host", "reflux-sim"))
    simulator.check_plant(bench.plant)
    if options.plant:  # configurations of ours fit, some by options of the plant that add channels
        for line in misfits(bench):
            print(line, flush=True)
    try:
        return play(bench, options)
    except Ended:
        raise
    except KeyboardInterrupt:  # Ctrl-C is how this is ended
        return 0


def play(bench: Bench, options: argparse.Namespace) -> int:
    with contextlib.ExitStack() as stack:
        firmware = stack.enter_context(launch.start("host"))
        stack.enter_context(launch.plant(firmware, bench.plant, "--speed", options.speed, *bench.options))
        port = stack.enter_context(contextlib.closing(Port(firmware.console)))
        talk = Session(port)
        configure(talk, bench)
        await_plant(talk, firmware)
        hints = ["status"] if options.manual else operate(talk, bench)
        print(f"{bench.plant} at {options.speed} times real time. Try: {'; '.join(hints)}. Ctrl-C ends everything.", flush=True)
        if options.watch:
            return watch.run(talk)
        talk.write("mode human")
        return interactive(port, None, (LEAVE, CONTROL_C), "Ctrl-C ends it")


# ---- what is started ----

def names() -> list[str]:
    """Configurations with a plant at the link; one with a wiring file beside it has its plant at the board's pins."""
    return sorted(path.stem for path in SCENARIOS.glob("*.conf") if not path.with_suffix(".wiring").is_file())


def bench_of(name: str, plant: str | None) -> Bench:
    """A name of ours brings plant, tick and start of the scenario that uses it; another file needs a plant."""
    path = Path(name) if name.endswith(".conf") else SCENARIOS / f"{name}.conf"
    if not path.is_file():
        raise UserError(no_configuration(name))
    if plant is not None:
        return Bench(plant, (), tuple(line for _, line in session.commands_in(path, textfile.read(path))))
    found = scenario_of(path)
    if found is None:
        raise UserError(f"{shown(path)}: no scenario beside it says which plant it is for; name one with --plant")
    scenarios.check_link(found)
    return Bench(found.plant_argument, tuple(found.plant_options()), tuple(line.text for line in found.config))


def no_configuration(name: str) -> str:
    if name.endswith(".conf"):
        return f"{name}: no such file; --plant PLANT goes with a .conf file of yours"
    if name.endswith((".toml", ".json")):
        what = f"a scenario, which {tool('run')} plays" if name.endswith(".toml") else "a plant, which goes behind --plant"
        return f"{name} is {what}; here goes the name of a configuration or a .conf file"
    plant = ""
    if (PLANTS / f"{name}.json").is_file():
        plant = f": it is a plant; `{tool('commission')} --plant {name}` writes a board.conf for it, for `{tool('play')} board.conf --plant {name}`"
    near = difflib.get_close_matches(name, names(), 1)
    meant = f'; did you mean "{near[0]}"?' if near and not plant else ""
    return f'there is no configuration "{name}"{plant}; known are {", ".join(names())}, or name a .conf file with --plant{meant}'


def misfits(bench: Bench) -> list[str]:
    """What the configuration wants and the plant does not have, with what would be right. Points that a block writes are no channels of the plant."""
    values = scenario_settings.values_of(bench.lines)
    written = {point for key, value in values.items() if re.fullmatch(r"block\d+\.points", key) for point in value.split(",")}
    rows = [line.split(",") for line in simulator.ask("--steady", "--plant", bench.plant).splitlines()[1:]]
    out = []
    for group, kind in (("meas", "measurement"), ("mv", "manipulated")):
        units = {row[1]: row[2] for row in rows if row[0] == kind}
        for name, k in scenario_settings.in_use(values, group).items():
            unit = values.get(f"{k}.unit", "")
            if name in written:
                continue
            if name not in units:
                has = ", ".join(f"{n} ({u})" for n, u in units.items())
                out.append(f"{k}.name {name}: the plant has no {'output' if group == 'meas' else 'input'} of that name; it has {has}")
            elif plant_file.unit_of(unit, f"{k}.unit") != units[name]:
                out.append(f"{k}.unit {unit}: the plant has {name} in {units[name]}: `set {k}.unit {units[name]}`")
    return out


def scenario_of(path: Path) -> Scenario | None:
    """The scenario of the same name, else one that this file alone configures, else any that uses it."""
    users = []
    for file in sorted(path.parent.glob("*.toml")):
        with contextlib.suppress(UserError):
            used = load_toml(file).get("console")
            if isinstance(used, list) and path.name in used:
                found = scenarios.load(file)
                users.append((file.stem != path.stem, used != [path.name], file.name, found))
    return min(users, key=lambda user: user[:3])[3] if users else None


# ---- what is done first ----

def configure(talk: Session, bench: Bench) -> None:
    for line in bench.lines:
        try:
            talk.ask(line)
        except Refused as error:
            raise RunFailed(f"the board refuses `{line}`: {error}") from None


def await_plant(talk: Session, firmware: launch.Firmware) -> None:
    """Until a sample has met the configuration, because there is no measurement to begin from before that."""
    end = time.monotonic() + READY_S
    while True:
        said = talk.ask("status")
        ticks = next((int(found[1]) for line in said if (found := re.search(r"\bticks (\d+)", line))), 0)
        if ticks > 1 and "link ready" in said[0] and not any("not announced" in line or "next sample" in line for line in said):
            return
        if died := firmware.died():
            raise RunFailed(died)
        if time.monotonic() > end:
            return  # a slow plant: what follows is taken at its next tick
        time.sleep(0.05)


def operate(talk: Session, bench: Bench) -> list[str]:
    """Outputs to the plant's operating point, then the loops to automatic from the inside out, with the setpoints of that point: the plant has left it
    while the board had no configuration. Returns lines to try.

    A plant that a sequence starts is left to the sequence."""
    values = scenario_settings.values_of(bench.lines)
    if scenario_settings.has_sequence(values):
        return ["seq start", "seq", "status"]
    at_rest = simulator.at_rest(bench.plant)
    for name in scenario_settings.in_use(values, "mv"):
        if name in at_rest:
            tell(talk, f"out {name} {at_rest[name]:.7g}")
    numbers = scenario_settings.in_use(values, "loop")
    loops = {name: values.get(f"{k}.out", UNUSED) for name, k in numbers.items()}
    setpoints = {name: at_rest[pv] for name, k in numbers.items()
                 if (pv := values.get(f"{k}.pv", UNUSED)) in at_rest and name not in loops.values()}
    hints = []
    for name in sorted(loops, key=lambda name: loops[name] in loops):  # inner loops first
        inner = loops[name] in loops
        if tell(talk, f"mode {loops[name]} cascade" if inner else f"mode {name} auto") and (not inner or tell(talk, f"mode {name} auto")):
            hints.append(name)
    end = time.monotonic() + READY_S  # modes are taken at the plant's next tick
    await_loops(talk, [rf"{re.escape(name)} (auto|cascade)\b" for name in hints], end)
    asked = {name: f"{setpoints[name]:.4g}" for name in hints if name in setpoints}
    taken = [name for name, value in asked.items() if tell(talk, f"sp {name} {value}")]
    await_loops(talk, [rf"{re.escape(name)} .*\bsp {re.escape(asked[name])} " for name in taken], end)
    return ["status", "loop"] + [f"sp {name} {setpoint}" for name in hints[-1:]
                                 if (setpoint := above(setpoints[name]) if name in setpoints else near(talk, name))]


def await_loops(talk: Session, patterns: list[str], end: float) -> None:
    """Until a line of `loop` matches each pattern, or the time is over."""
    while time.monotonic() < end:
        lines = talk.ask("loop")
        if all(any(re.match(pattern, line) for line in lines) for pattern in patterns):
            return
        time.sleep(0.05)


def tell(talk: Session, line: str) -> bool:
    try:
        talk.ask(line)
        return True
    except Refused as error:
        print(f"{line}: {error}", flush=True)
        return False


def near(talk: Session, loop: str) -> str:
    """A setpoint a little above the present one."""
    for line in talk.ask("loop"):
        if found := re.match(rf"{re.escape(loop)} .*\bsp ([-\d.e+]+)", line):
            return above(float(found[1]))
    return ""


def above(value: float) -> str:
    """A hundredth of the number higher; of 0 nothing."""
    return f"{value + 0.01 * abs(value):.4g}" if value else ""
