"""Reading TOML strictly: a key nobody knows, a wrong type or a number that cannot be meant is refused
with the file, the place in it and what would be right."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Iterable

from reflux import textfile
from reflux.errors import UserError
from reflux.paths import shown


REQUIRED = object()


@dataclass(frozen=True)
class Key:
    """A key of a table: what its reader takes, and what its page says. low, high and above are limits of numbers."""

    name: str
    kind: str  # text, number, whole number, true or false, texts, table, tables
    default: Any = REQUIRED
    unit: str = "-"
    low: float = -math.inf
    high: float = math.inf
    above: float | None = None
    choices: tuple[str, ...] | None = None
    about: str = ""
    high_words: str = ""  # for the page, where the reader takes the highest value from elsewhere
    default_words: str = ""  # likewise


def load_toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(textfile.read(path))
    except tomllib.TOMLDecodeError as error:
        raise UserError(f"{shown(path)}: not valid TOML: {error}") from None


class Table:
    """One TOML table. Take every key that is known, then call done(): what is left is an error."""

    def __init__(self, data: Any, file: Path, where: str = ""):
        self.file, self.where = file, where
        if not isinstance(data, dict):
            raise UserError(f"{shown(file)}: {where} must be a table, not {_kind(data)}")
        self.data = dict(data)
        self.known: list[str] = []

    def path(self, key: str) -> str:
        return f"{shown(self.file)}: {self.where}.{key}" if self.where else f"{shown(self.file)}: {key}"

    def _take(self, key: str, default: Any) -> Any:
        self.known.append(key)
        if key not in self.data:
            if default is REQUIRED:
                raise UserError(f"{self.path(key)} is missing")
            return default
        return self.data.pop(key)

    def has(self, key: str) -> bool:
        return key in self.data

    def text(self, key: str, default: Any = ..., choices: Iterable[str] | None = None) -> Any:
        value = self._take(key, REQUIRED if default is ... else default)
        if value is default:
            return value
        if not isinstance(value, str):
            raise UserError(f"{self.path(key)} must be text in quotes, not {_kind(value)}")
        if any(ord(c) < 32 or ord(c) == 127 for c in value):
            raise UserError(f"{self.path(key)} must be one line without control characters")
        if not value.strip():
            raise UserError(f"{self.path(key)} must not be empty")
        if choices is not None and value not in choices:
            raise UserError(f'{self.path(key)} is "{value}"; known are: {", ".join(choices)}')
        return value

    def number(self, key: str, default: Any = ..., low: float = -math.inf, high: float = math.inf,
               above: float | None = None) -> Any:
        value = self._take(key, REQUIRED if default is ... else default)
        if value is default:
            return value
        return check_number(self.path(key), value, low, high, above)

    def integer(self, key: str, default: Any = ..., low: int = 0, high: int = 2**31 - 1) -> Any:
        value = self._take(key, REQUIRED if default is ... else default)
        if value is default:
            return value
        if isinstance(value, bool) or not isinstance(value, int):
            raise UserError(f"{self.path(key)} must be a whole number, not {_kind(value)}")
        return int(check_number(self.path(key), value, low, high))

    def boolean(self, key: str, default: bool) -> bool:
        value = self._take(key, default)
        if not isinstance(value, bool):
            raise UserError(f"{self.path(key)} must be true or false, not {_kind(value)}")
        return value

    def list(self, key: str, default: Any = ...) -> list[Any]:
        value = self._take(key, REQUIRED if default is ... else default)
        if not isinstance(value, list):
            raise UserError(f"{self.path(key)} must be a list in [ ], not {_kind(value)}")
        return value

    def texts(self, key: str, default: Any = ...) -> list[str]:
        values = self.list(key, default)
        for i, value in enumerate(values):
            if not isinstance(value, str):
                raise UserError(f"{self.path(key)}[{i}] must be text in quotes, not {_kind(value)}")
        return values

    def table(self, key: str) -> "Table":
        value = self._take(key, REQUIRED)
        return Table(value, self.file, f"{self.where}.{key}" if self.where else key)

    def table_of(self, key: str) -> "Table":
        """A table in this one, left where it is."""
        return Table(self.data[key], self.file, f"{self.where}.{key}")

    def read(self, key: Key, default: Any = ..., high: float | None = None, choices: Iterable[str] | None = None) -> Any:
        """The value of a key of a text, a number or a list; default, high and choices where they depend on other keys."""
        default = key.default if default is ... else default
        default = ... if default is REQUIRED else default
        match key.kind:
            case "text":
                return self.text(key.name, default, choices if choices is not None else key.choices)
            case "number":
                return self.number(key.name, default, key.low, key.high if high is None else high, key.above)
            case "whole number":
                return self.integer(key.name, default, int(key.low))
            case "true or false":
                return self.boolean(key.name, default)
            case "texts":
                return self.texts(key.name, default if default is ... else list(default))
        raise ValueError(f"{key.name} is a {key.kind}")

    def tables(self, key: str) -> list["Table"]:
        """An array of tables, [[key]]; absent means none. The first is number 1 in messages."""
        value = self._take(key, [])
        if not isinstance(value, list):
            raise UserError(f"{self.path(key)} must be written as [[{key}]], one for each")
        return [Table(item, self.file, f"{key}[{i + 1}]") for i, item in enumerate(value)]

    def numbers(self) -> dict[str, float]:
        """Everything left, name = number."""
        out = {}
        for key in list(self.data):
            out[key] = self.number(key)
        return out

    def done(self) -> None:
        for key in self.data:
            raise UserError(f"{self.path(key)} is not a known key; known are: "
                            f"{', '.join(sorted(set(self.known)))}")


def check_number(where: str, value: Any, low: float = -math.inf, high: float = math.inf,
                 above: float | None = None) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise UserError(f"{where} must be a number, not {_kind(value)}")
    if not math.isfinite(value):
        raise UserError(f"{where} is {value}; it must be a finite number")
    if above is not None and value <= above:
        raise UserError(f"{where} is {value}; it must be more than {above:g}")
    if value < low:
        raise UserError(f"{where} is {value}; it must be {low:g} or more")
    if value > high:
        raise UserError(f"{where} is {value}; it must be {high:g} or less")
    return float(value)


def _kind(value: Any) -> str:
    names = {str: "text", bool: "true or false", int: "a whole number", float: "a number",
             list: "a list", dict: "a table"}
    return names.get(type(value), "a date or time")
