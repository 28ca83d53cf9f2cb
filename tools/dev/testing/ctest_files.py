"""Reads the entries of a build tree from CMake's own files. ctest tells the command of a program only once it is built."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

ADDED = re.compile(r"^add_test\(\[=\[(.+?)\]=\] (.*)\)$", re.MULTILINE)
PROPERTIES = re.compile(r"^set_tests_properties\(\[=\[(.+?)\]=\] PROPERTIES (.*)\)$", re.MULTILINE)
PROPERTY = re.compile(r'(\w+) "([^"]*)"')


@dataclass
class Entry:
    """One test of one build tree. Properties are texts; ctest separates the items of a list by semicolons."""

    name: str
    command: tuple[str, ...]
    folder: Path
    properties: dict[str, str] = field(default_factory=dict)

    def items(self, name: str) -> list[str]:
        """A property that is a list, such as LABELS."""
        return [item for item in self.properties.get(name, "").split(";") if item]

    def programs(self, tree: Path) -> tuple[str, ...]:
        """Files of the build tree that the command names."""
        return tuple(word for word in self.command if word.startswith(f"{tree}/"))


def entries(tree: Path) -> list[Entry]:
    """Every test of a configured build tree, built or not."""
    found = []
    for listing in sorted(tree.rglob("CTestTestfile.cmake")):
        text = listing.read_text(encoding="utf-8")
        properties: dict[str, dict[str, str]] = {}
        for name, rest in PROPERTIES.findall(text):
            properties.setdefault(name, {}).update(PROPERTY.findall(rest))
        for name, rest in ADDED.findall(text):
            command = tuple(re.findall(r'"([^"]*)"', rest))
            found.append(Entry(name, command, listing.parent, properties.get(name, {})))
    return found
