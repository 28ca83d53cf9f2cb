"""Which sources each test runs: tests/reach.txt, measured with gcov by `tools/coverage --reach`.

The file lists the sources, then a row for each test: a hexadecimal number whose bit k (the lowest is 0) stands for source k.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

from reflux.errors import UserError
from reflux.paths import ROOT, shown

TABLE = ROOT / "tests" / "reach.txt"
HEAD = """# Sources of firmware/, hal/ and host_sim/ that each test runs. Written by tools/coverage --reach; tools/test --changed reads it.
# After the sources a row for each test: bit k (the lowest is 0) of its hexadecimal number stands for source k.
"""


def row_of(name: str) -> str:
    """Both number formats of a test share a row: asan-fixed.pid has that of pid."""
    first, _, rest = name.partition(".")
    return rest if first in ("asan", "asan-fixed", "host") else name


@cache
def load(path: Path = TABLE) -> dict[str, frozenset[str]]:
    """Sources by test. Empty without the file: nothing is known then."""
    sources: list[str] = []
    out: dict[str, frozenset[str]] = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines() if path.is_file() else [], 1):
        if not line or line.startswith("#"):
            continue
        words = line.split()
        try:
            if len(words) == 1:
                sources.append(words[0])
            else:
                bits = int(words[1], 16)
                out[words[0]] = frozenset(s for k, s in enumerate(sources) if bits >> k & 1)
        except (ValueError, IndexError):
            raise UserError(f"{shown(path)}:{number}: must be a source, or a test and a hexadecimal number") from None
    return out


def store(reached: dict[str, set[str]], path: Path = TABLE) -> None:
    """Writes the file."""
    sources = sorted(set().union(*reached.values()))
    place = {source: k for k, source in enumerate(sources)}
    rows = (f"{name} {sum(1 << place[s] for s in reached[name]):x}" for name in sorted(reached))
    path.write_text(HEAD + "\n".join([*sources, "", *rows]) + "\n", encoding="utf-8")
