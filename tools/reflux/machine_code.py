"""Compares two programs by their machine code: the same bytes in memory, whatever stands beside them for debuggers."""

from __future__ import annotations

import struct
from pathlib import Path

from reflux.errors import RunFailed

ALLOCATED = 2  # a section that is loaded
NO_BITS = 8  # one that has a size and no bytes
NOT_COMPARED = (".note.gnu.build-id",)  # made from the debugging sections too


def same(left: Path, right: Path) -> bool:
    """True where each section that is loaded has the same name, place, size and bytes in both."""
    return left.stat().st_size > 0 and loaded(left) == loaded(right)


def is_program(path: Path) -> bool:
    """An ELF file."""
    if not path.is_file():
        return False
    with path.open("rb") as f:
        return f.read(4) == b"\x7fELF"


def loaded(path: Path) -> list[tuple[bytes, int, int, bytes]]:
    """Name, address, size and bytes of each loaded section of a 64-bit little-endian ELF file."""
    image = path.read_bytes()
    if image[:6] != b"\x7fELF\x02\x01":
        raise RunFailed(f"{path} is not a 64-bit little-endian ELF file")
    table, = struct.unpack_from("<Q", image, 40)
    size, count, names_at = struct.unpack_from("<HHH", image, 58)
    rows = [struct.unpack_from("<IIQQQQ", image, table + k * size) for k in range(count)]
    names = rows[names_at][4]
    out = []
    for name_at, kind, flags, address, offset, length in rows:
        begin = names + name_at
        name = image[begin:image.index(b"\0", begin)]
        if flags & ALLOCATED and name.decode() not in NOT_COMPARED:
            out.append((name, address, length, b"" if kind == NO_BITS else image[offset:offset + length]))
    return out
