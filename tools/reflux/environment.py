"""The environment of tests: what a person has set for other purposes must not change what a test finds."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import Mapping

from reflux.paths import build_root

# Plants, folders and switches of this project; screens; settings of git, as a hook of git gives them; settings of programs
# whose output is read here.
DROPPED = ("REFLUX_PLANTS", "REFLUX_OUT", "REFLUX_FIGURES", "REFLUX_KEEP", "REFLUX_MATH_STEP", "WALK_LOG",
           "DISPLAY", "WAYLAND_DISPLAY",
           "GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE",
           "NINJA_STATUS", "CLICOLOR_FORCE", "FORCE_COLOR", "COLUMNS", "PYTHONWARNINGS", "ASAN_OPTIONS", "UBSAN_OPTIONS",
           "LANGUAGE", "LC_ALL")
TEMPORARY_MAX = 60  # characters: a socket in a folder of a test has 107 for its whole path


def clean(environment: Mapping[str, str]) -> dict[str, str]:
    """A copy without DROPPED, with English messages in UTF-8, and with matplotlib's settings and cache in the build folder.

    A TMPDIR that is too long for the path of a socket in it is dropped, too.
    """
    kept = {name: value for name, value in environment.items() if name not in DROPPED}
    if len(kept.get("TMPDIR", "")) > TEMPORARY_MAX:
        del kept["TMPDIR"]
    return {**kept, "LC_ALL": "C.UTF-8", "MPLBACKEND": "Agg", "MPLCONFIGDIR": str(build_root() / "matplotlib")}


def prepare() -> None:
    """Makes matplotlib's list of fonts, once for each build folder: on a machine with many fonts matplotlib says on stderr that it
    does so, in the first test that draws."""
    if not list((build_root() / "matplotlib").glob("fontlist*")):
        subprocess.run([sys.executable, "-c", "import matplotlib.font_manager"], env=clean(os.environ), capture_output=True, check=False)
