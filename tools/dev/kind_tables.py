"""Which functions the kinds of blocks have, read from their tables in firmware/kinds/: sets for the list of calls through pointers.

    @kinds_ENTRY     every kind's function of this entry of struct block_kind: @kinds_describe
    @STAGE_ENTRY     those of the kinds of a stage: @control_step, @estimate_follow
    @record_ENTRY    those of the kinds with rows of parameters, which `blockN.kind` selects: @record_check
    @own_ENTRY       those of the kinds that `loopN.algorithm` selects: @own_shift
    @kinds_verb      the handlers of all rows of struct block_verb

A new kind is in them as soon as it is in firmware/app/kinds.c.
"""

from __future__ import annotations

import re
from pathlib import Path

from reflux.errors import RunFailed
from reflux.paths import ROOT, every

FIRMWARE = ROOT / "firmware"
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
TEXT = re.compile(r'"(?:[^"\\\n]|\\.)*"')


def _code(path: Path) -> str:
    """Without comments, and without what stands in texts."""
    return TEXT.sub('""', COMMENT.sub(" ", path.read_text(encoding="utf-8")))


def _between(pattern: str, text: str) -> list[tuple[str, str]]:
    """Name and content of each declaration that begins with the pattern and ends with `};` at the margin."""
    return re.findall(pattern + r"(.*?)^\};", text, re.DOTALL | re.MULTILINE)


def sets(firmware: Path = FIRMWARE) -> dict[str, list[str]]:
    declared = re.search(r"^struct block_kind \{(.*?)^\};", _code(firmware / "block" / "block.h"), re.DOTALL | re.MULTILINE)
    if not declared:
        raise RunFailed("firmware/block/block.h: there is no struct block_kind")
    entries = re.findall(r"\(\*(\w+)\)\(", declared[1])
    stages = [name.lower() for name in re.findall(r"\bSTAGE_(\w+)", _code(firmware / "block" / "block.h"))]
    out: dict[str, list[str]] = {f"@{group}_{entry}": [] for group in ("kinds", "record", "own", *stages) for entry in entries}
    out["@kinds_verb"] = []
    found = set()
    for path in every(firmware / "kinds", "*/*.c"):
        text = _code(path)
        for _, rows in _between(r"^(?:static )?const struct block_verb (\w+)\[\w*\] = \{", text):
            out["@kinds_verb"] += re.findall(r"(\w+),?\s*\}", rows)
        for name, body in _between(r"^(?:static )?const struct block_kind (\w+) = \{", text):
            found.add(name)
            fields = dict(re.findall(r"\.(\w+)\s*=\s*([^,]+?)\s*,", body))
            groups = ["kinds", fields.get("stage", "").removeprefix("STAGE_").lower()]
            groups += [group for group, field in (("record", "parameter"), ("own", "algorithms")) if field in fields]
            for entry in [entry for entry in entries if entry in fields]:
                for group in groups:
                    out[f"@{group}_{entry}"].append(fields[entry])
    lost = [name for name in re.findall(r"&(\w+)", _code(firmware / "app" / "kinds.c")) if name not in found]
    if lost:
        raise RunFailed(f"{', '.join(lost)} of firmware/app/kinds.c: no `const struct block_kind {lost[0]} = {{` begins a line in "
                        "firmware/kinds/")
    return out
