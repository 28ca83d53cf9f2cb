"""A plant to try the firmware on: one of ours by name, a file (docs/use/linear-plants.md, docs/use/columns.md), or the same as a dictionary."""

from __future__ import annotations

import json
import re
import shutil
import tempfile
import weakref
from pathlib import Path
from typing import Any, Mapping

from reflux import given, simulator
from reflux.errors import UserError


class Plant:
    """A plant of the simulator. Refused with the simulator's words if it does not know it or the file is wrong.

        Plant("wood-berry")
        Plant("my-column.json")
        Plant({"name": "mine", "inputs": ...})
    """

    def __init__(self, what: str | Path | Mapping[str, Any]):
        if isinstance(what, Mapping):
            name = str(what.get("name", "plant"))
            if not re.fullmatch(r"[\w-]{1,40}", name):
                raise UserError(f"{name}: a plant's name has letters, digits, - and _ only")
            try:
                text = json.dumps(what)
            except (TypeError, ValueError) as error:
                raise UserError(f"{name}: {error}; a plant's dictionary has texts, numbers, lists and dictionaries, as a JSON file has") from None
            folder = tempfile.mkdtemp(prefix="reflux-")
            removed = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
            path = Path(folder) / f"{name}.json"
            path.write_text(text, encoding="utf-8")
            self.argument = str(path)
            what = json.loads(text)
        else:
            removed = None
            self.argument = str(what)
        self._what = what
        try:
            simulator.check_plant(self.argument)
        except ValueError:  # a zero, or half of a letter
            raise UserError(f"{self.argument!a} is no name of a plant or a file") from None
        except BaseException:
            if removed:
                removed()
            raise

    def at_rest(self, **inputs: float) -> dict[str, float]:
        """Every channel at the steady state, of these values of inputs where some are given."""
        return simulator.at_rest(self.argument, [f"{name}={given.number(value, name):.17g}" for name, value in inputs.items()])

    def __reduce__(self) -> tuple[Any, ...]:
        """A copy of a dictionary, also in another process, has a file of its own."""
        return Plant, (self._what,)

    def __repr__(self) -> str:
        return f"Plant({self.argument!r})"
