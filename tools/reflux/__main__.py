"""reflux COMMAND ..., or python3 -m reflux COMMAND ...: what the small scripts in tools/ start."""

from __future__ import annotations

import importlib
import os
import signal
import sys

from reflux import ending
from reflux.errors import Ended, RunFailed, UserError
from reflux.paths import INSTALLED, tool

COMMANDS = {
    "demo": "reflux.cmd_demo",
    "play": "reflux.cmd_play",
    "run": "reflux.cmd_run",
    "commission": "reflux.cmd_commission",
    "console": "reflux.cmd_console",
    "io": "reflux.cmd_io",
    "flash": "reflux.cmd_flash",
    "plot": "reflux.cmd_plot",
    "calibrate": "reflux.cmd_calibrate",
    "column": "reflux.cmd_column",
    "gradients": "reflux.cmd_gradients",
    "consistency": "reflux.cmd_consistency",
    "ina": "reflux.cmd_ina",
    "decouple": "reflux.cmd_decouple",
    "identify": "reflux.cmd_identify",
    "state-feedback": "reflux.cmd_state_feedback",
    "test": "dev.cmd_test",
    "campaign": "research.cmd_campaign",
    "bench": "dev.cmd_bench",
    "style": "dev.cmd_style",
    "fuzz": "dev.cmd_fuzz",
    "coverage": "dev.cmd_coverage",
    "prove": "dev.cmd_prove",
    "mutate": "dev.cmd_mutate",
    "image": "dev.cmd_image",
    "evidence": "dev.cmd_evidence",
    "reference": "dev.cmd_reference",
    "site": "dev.cmd_site",
    "wheel": "dev.cmd_wheel",
}
# One line of --help for each.
WORDS = {
    "demo": "the demonstration: packages, build, emulator, report",
    "play": "a running, configured column and a console on it",
    "run": "one scenario, with log, plots and report; compare two logs",
    "commission": "automatic start-up of an unknown plant, on a board or on this computer",
    "console": "a board's console: terminal, command files, saved configurations, live plots",
    "io": "a guided check of the sensors and outputs at a board's own pins",
    "flash": "write the image to a board",
    "plot": "columns of a log as a picture or a table",
    "calibrate": "the calibration of a measurement from one or two points",
    "column": "profile, gains and times of a column; the console lines of a board for it",
    "gradients": "where to put a column's thermometers",
    "consistency": "covariances of a filter, and whether a recorded run bears them out",
    "ina": "inverse Nyquist array and the static decoupler found with it",
    "decouple": "a polynomial, static, partial or one-way decoupler with its controllers",
    "identify": "a difference model from a log",
    "state-feedback": "decoupling by state feedback",
    "test": "the tests",
    "campaign": "a scenario over many seeds",
    "bench": "speed, instructions per tick and memory",
    "style": "the style checks",
    "fuzz": "inputs that nobody thought of",
    "coverage": "what the tests reach",
    "prove": "proofs of single functions",
    "mutate": "faults put into the code, and which of them the tests notice",
    "image": "proofs on the linked image, and where its memory goes",
    "evidence": "what counts things, run and written to docs/inside/evidence.md",
    "reference": "the reference pages, from the tables of the code",
    "site": "the pages as a site with search",
    "wheel": "the package for pip, with programs, plants and scenarios",
}
PACKAGES = {
    "numpy": "python3-numpy",
    "scipy": "python3-scipy",
    "matplotlib": "python3-matplotlib",
    "serial": "python3-serial",
}


def call(name: str, arguments: list[str]) -> int:
    """Runs one command; what is wrong becomes one line on stderr and an exit status."""
    try:
        module = importlib.import_module(COMMANDS[name])
        return int(module.main(arguments) or 0)
    except UserError as error:
        print(f"{tool(name)}: {error}", file=sys.stderr)
        return 2
    except RunFailed as error:
        print(f"{tool(name)}: {error}", file=sys.stderr)
        return 1
    except ModuleNotFoundError as error:
        package = PACKAGES.get((error.name or "").split(".")[0])
        if package is None:
            raise
        print(
            f"{tool(name)}: {sys.executable} has no module {error.name}; install the package "
            f"{package} (tools/bootstrap does), or name another interpreter in REFLUX_PYTHON",
            file=sys.stderr,
        )
        return 1
    except Ended as end:
        print(f"{tool(name)}: ended by {signal.Signals(end.number).name}", file=sys.stderr)
        return 128 + end.number
    except KeyboardInterrupt:
        print(f"\n{tool(name)}: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1


def is_here(name: str) -> bool:
    """An installed package has no commands of development."""
    return not INSTALLED or COMMANDS[name].startswith("reflux.")


def help_text() -> str:
    """The tree of commands, users' first."""
    files = "" if INSTALLED else "Each command is also a file in tools/; "
    out = ["usage: reflux COMMAND ...", "", f"{files}COMMAND --help says more.", ""]
    here = {name: words for name, words in WORDS.items() if is_here(name)}
    width = max(map(len, here)) + 2
    for title, own in (("use", True), ("development", False)):
        rows = [f"  {name:{width}}{words}" for name, words in here.items() if COMMANDS[name].startswith("reflux.") == own]
        out += [f"{title}:", *rows, ""] if rows else []
    return "\n".join(out).rstrip()


def main() -> int:
    if sys.version_info < (3, 11):
        print(f"tools: Python 3.11 or newer is needed; {sys.executable} is "
              f"{sys.version.split()[0]}", file=sys.stderr)
        return 1
    if sys.argv[1:2] in (["--help"], ["-h"], ["help"]):
        print(help_text())
        return 0
    if len(sys.argv) < 2 or sys.argv[1] not in COMMANDS:
        wrong = f"reflux: there is no command {sys.argv[1]}\n" if len(sys.argv) > 1 else ""
        print(f"{wrong}{help_text()}", file=sys.stderr)
        return 2
    if not is_here(sys.argv[1]):
        print(f"reflux: {sys.argv[1]} is a command of the repository; an installed package does not have it", file=sys.stderr)
        return 2
    with ending.cleanly(sys.argv[1]):
        return call(sys.argv[1], sys.argv[2:])


if __name__ == "__main__":
    sys.exit(main())
