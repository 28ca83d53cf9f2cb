"""Reflux from Python (docs/use/python.md): a board and a plant in this process or on a port, and the firmware's own analysis and design.

    from reflux import Lab
    with Lab("pilot") as lab:
        lab.mode("bottom", "auto")
        log = lab.run(hours=2)
    log.plot()

It is also the package behind the commands of tools/. Names are loaded when they are first used.
"""

from __future__ import annotations

import importlib
import logging
from typing import Any

_NAMES = {
    "Lab": "reflux.lab",
    "Plant": "reflux.plant",
    "Scenario": "reflux.scenario",
    "Refused": "reflux.session",
    "UserError": "reflux.errors",
    "RunFailed": "reflux.errors",
    "rga": "reflux.doors",
    "pair": "reflux.doors",
    "design": "reflux.doors",
    "identify": "reflux.doors",
    "columns": "reflux.columns",
    "ColumnEnv": "reflux.column_env",
}
__all__ = [name for name in _NAMES if name != "ColumnEnv"]  # it needs gymnasium

logging.getLogger("reflux").addHandler(logging.NullHandler())


def __getattr__(name: str) -> Any:
    if name not in _NAMES:
        raise AttributeError(f"module reflux has no {name}")
    module = importlib.import_module(_NAMES[name])
    return module if name == "columns" else getattr(module, name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_NAMES])
