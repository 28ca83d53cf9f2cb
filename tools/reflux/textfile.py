"""Text files that people give to the tools: one way to read them all.

A file is UTF-8, with or without a byte order mark. Another encoding is refused with a way to convert the file.
"""

from __future__ import annotations

import codecs
import json
from pathlib import Path
from typing import Any

from reflux.errors import UserError
from reflux.paths import shown

LOOKED_AT = 256  # bytes at the beginning in which a zero byte means an encoding of several bytes to a character


def read(path: Path, damaged: bool = False) -> str:
    """Returns the text. damaged: a transcript of a line that may have lost bytes; what is not UTF-8 is replaced."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UserError(f"{shown(path)}: cannot be read: {error.strerror}") from None
    return decode(data, shown(path), damaged)


def decode(data: bytes, source: str, damaged: bool = False) -> str:
    """Returns the text of bytes; `source` names them in a refusal."""
    utf16 = ("UTF-16" if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) else
             "" if damaged or b"\0" not in data[:LOOKED_AT] else "UTF-16BE" if data[:1] == b"\0" else "UTF-16LE")
    if utf16:
        raise UserError(f"{source}: is UTF-16 text; it must be UTF-8 (iconv -f {utf16} -t UTF-8 OLD > NEW)")
    try:
        text = data.decode("utf-8-sig", errors="replace" if damaged else "strict")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise UserError(f"{source}:{line}: byte 0x{data[error.start]:02X} is not UTF-8 text; save the file as UTF-8") from None
    return text.replace("\r\n", "\n")


def read_json(path: Path) -> Any:
    """Returns the value of a JSON file."""
    try:
        return json.loads(read(path))
    except (ValueError, RecursionError) as error:
        raise UserError(f"{shown(path)}: not JSON: {error}") from None
