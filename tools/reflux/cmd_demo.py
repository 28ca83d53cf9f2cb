"""tools/demo: the demonstration scenario, and where its report is."""

from __future__ import annotations

import argparse

from reflux import cmd_run, launch, packages
from reflux import scenario as scenarios
from reflux.paths import SCENARIOS, named, out_root, tool


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog=tool("demo"),
        description="Installs what is missing (as root, after asking on a terminal; else says what to install), builds the simulator and the "
        "STM32F405 image, and lets that image, in the emulator, hold a simulated distillation column for three and "
        "a half hours of plant time. Writes out/demo/report.html, plots and log.csv. Exit status 1 when a loop "
        "misses its limits.")
    p.add_argument("--board", action="store_true",
                   help="the same image on the virtual board instead, with models of sensors and relays at the board's own pins and no plant link: "
                   "the column is started from cold by the firmware's own sequence. Takes minutes; writes out/demo-board")
    p.add_argument("--firmware", choices=scenarios.FIRMWARES, help="firmware to run instead")
    p.add_argument("--console-port", metavar="PORT", help="with --firmware serial: port of the console")
    p.add_argument("--link-port", metavar="PORT", help="with --firmware serial: port of the plant link")
    p.add_argument("--out", type=named, metavar="FOLDER", help="folder for the results (default: out/demo, or out/demo-board)")
    p.add_argument("--seed", type=int, metavar="N", help="seed of the sensor noise")
    options = p.parse_args(arguments)
    for name, value in {"noise": None, "speed": None, "quiet": False, "no_report": False, "no_build": False}.items():
        setattr(options, name, value)
    scenario = cmd_run.with_options(scenarios.load(SCENARIOS / ("demo-board.toml" if options.board else "demo.toml")), options)
    scenarios.check_pins(scenario)
    launch.check_ports(scenario.firmware, options.console_port, options.link_port)
    flashed = (launch.preset_of(scenario.firmware) or "").startswith("stm32")
    packages.need("host", *(("target",) if flashed else ()), sets_up=True)
    return cmd_run.run(scenario, options.out or out_root() / scenario.name, options)
