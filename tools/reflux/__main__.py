"""python3 -m reflux COMMAND ...: started by the small scripts in tools/."""

from __future__ import annotations

import importlib
import os
import signal
import sys

from reflux import ending
from reflux.errors import Ended, RunFailed, UserError

COMMANDS = {
    "run": "reflux.cmd_run",
    "demo": "reflux.cmd_demo",
    "play": "reflux.cmd_play",
    "test": "dev.cmd_test",
    "campaign": "research.cmd_campaign",
    "bench": "dev.cmd_bench",
    "plot": "reflux.cmd_plot",
    "calibrate": "reflux.cmd_calibrate",
    "column": "reflux.cmd_column",
    "gradients": "reflux.cmd_gradients",
    "consistency": "reflux.cmd_consistency",
    "ina": "reflux.cmd_ina",
    "decouple": "reflux.cmd_decouple",
    "identify": "reflux.cmd_identify",
    "state-feedback": "reflux.cmd_state_feedback",
    "style": "dev.cmd_style",
    "fuzz": "dev.cmd_fuzz",
    "coverage": "dev.cmd_coverage",
    "prove": "dev.cmd_prove",
    "mutate": "dev.cmd_mutate",
    "image": "dev.cmd_image",
    "flash": "reflux.cmd_flash",
    "console": "reflux.cmd_console",
    "commission": "reflux.cmd_commission",
    "evidence": "dev.cmd_evidence",
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
        print(f"tools/{name}: {error}", file=sys.stderr)
        return 2
    except RunFailed as error:
        print(f"tools/{name}: {error}", file=sys.stderr)
        return 1
    except ModuleNotFoundError as error:
        package = PACKAGES.get((error.name or "").split(".")[0])
        if package is None:
            raise
        print(
            f"tools/{name}: {sys.executable} has no module {error.name}; install the package "
            f"{package} (tools/bootstrap does), or name another interpreter in REFLUX_PYTHON",
            file=sys.stderr,
        )
        return 1
    except Ended as end:
        print(f"tools/{name}: ended by {signal.Signals(end.number).name}", file=sys.stderr)
        return 128 + end.number
    except KeyboardInterrupt:
        print(f"\ntools/{name}: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1


def main() -> int:
    if sys.version_info < (3, 11):
        print(f"tools: Python 3.11 or newer is needed; {sys.executable} is "
              f"{sys.version.split()[0]}", file=sys.stderr)
        return 1
    if len(sys.argv) < 2 or sys.argv[1] not in COMMANDS:
        print(f"usage: python3 -m reflux {{{','.join(COMMANDS)}}} ...", file=sys.stderr)
        return 2
    with ending.cleanly(sys.argv[1]):
        return call(sys.argv[1], sys.argv[2:])


if __name__ == "__main__":
    sys.exit(main())
