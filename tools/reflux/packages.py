"""Debian packages of a tool, installed once its arguments have been judged."""

from __future__ import annotations

import subprocess
import sys

from reflux.errors import RunFailed
from reflux.paths import INSTALLED, ROOT


def need(*groups: str, sets_up: bool = False) -> None:
    """Has tools/bootstrap install what is missing of these groups, after asking. Where nobody can be asked only a tool that sets up
    everything installs (sets_up); for another one tools/bootstrap says how. An installed package has brought what it needs."""
    if INSTALLED:
        return
    sys.stdout.flush()
    command = [str(ROOT / "tools" / "bootstrap"), "--set-up" if sets_up else "--ask", *groups]
    if subprocess.run(command, check=False).returncode:
        raise RunFailed("packages are missing, see above")
