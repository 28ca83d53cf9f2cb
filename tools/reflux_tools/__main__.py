"""python3 -m reflux_tools COMMAND ...: started by the small scripts in tools/."""

from __future__ import annotations

import importlib
import os
import signal
import sys

from reflux_tools.errors import RunFailed, UserError

COMMANDS = {
    "run": "cmd_run",
    "demo": "cmd_demo",
    "test": "cmd_test",
    "campaign": "cmd_campaign",
    "bench": "cmd_bench",
    "plot": "cmd_plot",
    "calibrate": "cmd_calibrate",
    "column": "cmd_column",
    "gradients": "cmd_gradients",
    "consistency": "cmd_consistency",
    "ina": "cmd_ina",
    "decouple": "cmd_decouple",
    "identify": "cmd_identify",
    "state-feedback": "cmd_state_feedback",
    "style": "cmd_style",
    "fuzz": "cmd_fuzz",
    "coverage": "cmd_coverage",
    "prove": "cmd_prove",
    "mutate": "cmd_mutate",
    "image": "cmd_image",
    "flash": "cmd_flash",
    "console": "cmd_console",
    "commission": "cmd_commission",
    "evidence": "cmd_evidence",
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
        module = importlib.import_module(f"reflux_tools.{COMMANDS[name]}")
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
        print(f"usage: python3 -m reflux_tools {{{','.join(COMMANDS)}}} ...", file=sys.stderr)
        return 2
    # Being ended by somebody else is like Ctrl-C: what was started here is ended too.
    for ending in (signal.SIGTERM, signal.SIGHUP):  # a closed terminal ends what it started, too
        signal.signal(ending, signal.default_int_handler)
    return call(sys.argv[1], sys.argv[2:])


if __name__ == "__main__":
    sys.exit(main())
