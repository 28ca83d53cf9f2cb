"""The page on what the virtual board takes from memory: the sentences of its sources that end with "(unverified)"."""

from __future__ import annotations

import re
from pathlib import Path

from dev.reference.markdown import code, contents, page, table
from reflux.errors import UserError
from reflux.paths import ROOT

SOURCES = ROOT / "host_sim" / "virtual_board"
MARK = "(unverified)"
SECTIONS = ("Both chips", "STM32F405", "STM32F100")
OF_CHIP = {"STM32F405": ("_f4.c", "_stm32f405.c"), "STM32F100": ("_f1.c", "_stm32f100.c")}
COMMENT = re.compile(r"/\*(.*?)\*/", re.DOTALL)
SENTENCE_END = re.compile(r"(?<=[.;:]) (?=[A-Z0-9])")


def statements(text: str, name: str) -> list[str]:
    """Marked sentences of a source's comments, in its order."""
    found = []
    for comment in COMMENT.findall(text):
        lines = (re.sub(r"^\s*\* ?", "", line).strip() for line in comment.splitlines())
        paragraphs = (" ".join(paragraph.split()) for paragraph in "\n".join(lines).split("\n\n"))
        for sentence in (sentence for paragraph in paragraphs for sentence in SENTENCE_END.split(paragraph)):
            said, mark, rest = sentence.partition(MARK)
            if not mark:
                continue
            if rest not in ("", ".") or not said[:1].isupper():
                raise UserError(f'{name}: "{sentence}": a sentence that is not verified begins with a capital and ends with {MARK}')
            found.append(said.strip())
    return found


def chip_of(name: str) -> str:
    return next((chip for chip, ends in OF_CHIP.items() if name.endswith(ends)), SECTIONS[0])


def virtual_board(folder: Path = SOURCES) -> str:
    rows: dict[str, list[tuple[str, ...]]] = {section: [] for section in SECTIONS}
    for path in sorted([*folder.rglob("*.c"), *folder.rglob("*.h")]):
        name = path.relative_to(folder).as_posix()
        rows[chip_of(name)] += [(said, code(name)) for said in statements(path.read_text(encoding="utf-8"), name)]
    parts = [part for section in SECTIONS for part in ([f"## {section}"], table(("taken from memory", "source"), rows[section]))]
    return page(
        ["# What the virtual board takes from memory"],
        ["Look up here what nobody has read about the two chips: each line is a statement that a model of the virtual board rests on, from memory of the manual.",
         "All else was read, in RM0090 Rev 21 (STM32F405), RM0041 Rev 6 (STM32F100), PM0214 Rev 10 (core of the STM32F405), table 19 of DS8626, or the register",
         "files of the vendor; the head of each source in `host_sim/virtual_board/` says where. [boards.md](../inside/boards.md#what-has-run-where) says what has",
         "run on the board."],
        contents([(section, []) for section in SECTIONS]), *parts)
