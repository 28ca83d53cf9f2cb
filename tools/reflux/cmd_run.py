"""tools/run: one scenario, from start to report."""

from __future__ import annotations

import argparse
from pathlib import Path

from reflux import launch, runner, table
from reflux import scenario as scenarios
from reflux.compare import compare_command
from reflux.errors import UserError
from reflux.paths import named, out_root, shown, tool
from reflux.schema import check_number


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog=tool("run"),
        description="Runs a scenario (docs/use/scenarios.md): builds what it needs, starts the firmware, lets the "
        "simulated plant run against it, and writes log, plots and report. Exit status: 0 all limits kept, "
        "1 a limit missed or the run failed, 2 usage error.")
    p.add_argument("scenario", nargs="?", metavar="SCENARIO",
                   help="a .toml file, or the name of one in host_sim/scenarios")
    p.add_argument("--firmware", choices=scenarios.FIRMWARES,
                   help="host: a process; stm32f405, stm32f100: the image in the emulator; -fixed: built with "
                   "fixed-point numbers, as stm32f100 always is; memory: inside the simulator; serial: a board on two serial ports")
    p.add_argument("--console-port", metavar="PORT", help="with --firmware serial, such as /dev/ttyUSB0")
    p.add_argument("--link-port", metavar="PORT", help="with --firmware serial, such as /dev/ttyUSB1")
    p.add_argument("--out", type=named, metavar="FOLDER", help="folder for the results (default: out/NAME)")
    p.add_argument("--seed", type=int, metavar="N", help="seed of the sensor noise")
    p.add_argument("--noise", type=float, metavar="X", help="factor on the noise of all sensors")
    p.add_argument("--speed", metavar="max|X", help="as fast as possible (max), or a multiple of real time")
    p.add_argument("--quiet", action="store_true", help="print no progress and no table")
    p.add_argument("--no-report", action="store_true", help="write no report.html and no plots")
    p.add_argument("--no-build", action="store_true", help="do not build; use what is there")
    p.add_argument("--compare", nargs=2, metavar=("A", "B"),
                   help="compare two logs (or output folders) bit for bit; run nothing")
    return p


def with_options(scenario: scenarios.Scenario, options: argparse.Namespace) -> scenarios.Scenario:
    if options.seed is not None:
        check_number("--seed", options.seed, low=0)
    if options.noise is not None:
        check_number("--noise", options.noise, low=0)
    if options.speed is not None:
        scenarios.check_speed(options.speed, "--speed")
    firmware = options.firmware or launch.at_hand(scenario.firmware, scenario.wiring is not None)
    if not options.firmware and firmware != scenario.firmware and not getattr(options, "quiet", False):
        print(f"{scenario.firmware} is no part of the installed package: the {firmware} build runs the scenario")
    return scenario.with_options(seed=options.seed, noise=options.noise, speed=options.speed, firmware=firmware)


def main(arguments: list[str]) -> int:
    options = parser().parse_args(arguments)
    if options.compare:
        if options.scenario:
            raise UserError("--compare compares two logs and takes no scenario")
        return compare_command(*options.compare)
    if not options.scenario:
        raise UserError(f"which scenario? give a .toml file (see {tool('run')} --help)")
    scenario = with_options(scenarios.load(scenarios.find(options.scenario)), options)
    return run(scenario, options.out or out_root() / scenario.name, options)


def run(scenario: scenarios.Scenario, out: Path, options: argparse.Namespace) -> int:
    """Also what tools/demo does."""
    ports = {"console_port": options.console_port, "link_port": options.link_port}
    launch.check_ports(scenario.firmware, **ports)
    scenarios.check_pins(scenario)
    if not options.no_build:
        launch.build_for(scenario.firmware, options.quiet)
    runner.check_plant(scenario)
    result = runner.run(scenario, runner.Options(out, quiet=options.quiet, **ports))
    if not options.no_report:
        from reflux import report  # matplotlib takes a second to load
        path = report.write(result)
    if not options.quiet:
        _print_table(result)
    for failure in result.failures():
        print(f"FAILED  {failure}", flush=True)
    if not options.quiet:
        print(f"\nReport: {shown(path)}" if not options.no_report else f"\nLog: {shown(out / 'log.csv')}")
    return 0 if result.passed else 1


def _print_table(result: runner.Result) -> None:
    units = result.units()
    if units:
        print()
        print(table.columns(table.loop_header(units), table.loop_rows(result.windows, units, overall=True)))
