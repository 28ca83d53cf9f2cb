"""Finds the places where the code of a port could be wrong about a register, a barrier or a wait, and the wrong text.

Kinds beside the constants and comparisons of edits.py. write: a write of a register that is not there. swap: two writes, one
after the other, the other way round. bit: a named bit one place higher, or |= for &= ~ and back. wait: a loop that waits, or a
call of a function wait_..., or a read for the time it takes, that is not there. barrier: a DSB or ISB that is not there.
"""

from __future__ import annotations

import re
from pathlib import Path

from dev.mutation.edits import ASSIGNMENTS, Edit, Reader, Token, tokens_of
from reflux.paths import ROOT

KINDS = ("write", "swap", "bit", "wait", "barrier")
COMMON = ("comparison", "constant")  # of edits.py

SHARED = ROOT / "hal" / "stm32"
REGISTER = re.compile(r"^#define (\w+)(?:\([^)]*\))?[ \t]+REG(?:32|16|8)\(", re.MULTILINE)
NAMED = re.compile(r"^#define (\w+)", re.MULTILINE)
GENERIC = ("REG32", "REG16", "REG8")
OF_SEVERAL = ("TIM",)  # TIM_CR1_CEN is a bit of each TIM's CR1
NO_BITS = ("_ADDRESS", "_BASE", "_IRQ")
BARRIER = re.compile(r"(?<![a-su-z])(?:dsb|isb|dmb)\b(?:\\n\\t|\\n)?")  # a t may be that of \t
ASM_WRITE = re.compile(r'"str r\d+, \[r6\]')  # ram_test.c, which has no stack for C


def sources(board: str) -> list[Path]:
    return sorted([*SHARED.glob("*.c"), *(ROOT / "hal" / board).glob("*.c")])


def edits_of(path: Path, text: str) -> list[Edit]:
    headers = [SHARED / "common.h", *(ROOT / "hal").glob("stm32f*/registers.h" if path.parent == SHARED else f"{path.parent.name}/registers.h")]
    return edits_in(text, "\n".join(h.read_text(encoding="utf-8") for h in headers))


def edits_in(text: str, headers: str) -> list[Edit]:
    """headers: their text, which names registers and bits."""
    return _Reader(text, headers).edits()


class _Reader(Reader):
    def __init__(self, text: str, headers: str):
        super().__init__(text, tokens_of(text, True), True)
        self.registers = {*REGISTER.findall(headers), *GENERIC}
        owners = tuple(f"{name}_" for name in (*self.registers, *OF_SEVERAL))
        self.bits = {name for name in NAMED.findall(headers)
                     if name.startswith(owners) and name not in self.registers and not name.endswith(NO_BITS)}

    def edits(self) -> list[Edit]:
        return [e for e in super().edits() if e.kind in (*KINDS, *COMMON)]

    def _body(self, tokens: list[Token]) -> None:
        self.previous: tuple[int, int] | None = None  # of the write that ends where the next statement begins
        super()._body(tokens)

    def _statement(self, tokens: list[Token], first: int, end: int) -> None:
        super()._statement(tokens, first, end)
        if first >= end:
            return
        self._bits(tokens, first, end)
        self._waits(tokens, first, end)
        self._barriers(tokens[first:end])
        start = self._after_head(tokens, first, end)
        write = tokens[end - 1].text == ";" and self._assignment(tokens, start, end)
        if not write:
            self.previous = None
            return
        self._add("write", tokens[start].start, tokens[end - 1].end, ";", tokens[start], tokens[end - 1])
        self._turned(tokens, start, end, write)
        if start != first:
            self.previous = None  # it hangs on an if
            return
        span = tokens[start].start, tokens[end - 1].end
        if self.previous is not None and "#" not in self.text[self.previous[1]:span[0]]:
            begin, gap = self.previous
            new = self.text[span[0]:span[1]] + self.text[gap:span[0]] + self.text[begin:gap]
            self.out.append(Edit("swap", self.function, self._line(begin), self._line(begin), self._line(span[1]), begin, span[1], new))
        self.previous = span

    def _assignment(self, tokens: list[Token], start: int, end: int) -> int:
        """Number of the token that assigns to a register; 0: none does."""
        if tokens[start].text not in self.registers:
            return 0
        at = start + 1
        if at < end and tokens[at].text == "(":
            at = self._matching(tokens, at, "(", ")") + 1
        return at if at < end and (tokens[at].text == "=" or tokens[at].text in ASSIGNMENTS) else 0

    def _turned(self, tokens: list[Token], start: int, end: int, assignment: int) -> None:
        sign, rest = tokens[assignment], self.text[tokens[assignment].end:tokens[end - 1].start]
        target = self.text[tokens[start].start:sign.start]
        if sign.text == "|=":
            new = f"{target}&= ~({rest.strip()});"
        elif sign.text == "&=" and tokens[assignment + 1].text == "~":
            new = f"{target}|= {self.text[tokens[assignment + 1].end:tokens[end - 1].end]}"
        else:
            return
        new = new.replace("\n", " ")
        self._add("bit", tokens[start].start, tokens[end - 1].end, new, tokens[start], tokens[end - 1])

    def _bits(self, tokens: list[Token], first: int, end: int) -> None:
        for i in range(first, end):
            if tokens[i].text not in self.bits:
                continue
            last = i
            if i + 1 < end and tokens[i + 1].text == "(":
                last = self._matching(tokens, i + 1, "(", ")")
            name = self.text[tokens[i].start:tokens[last].end].replace("\n", " ")
            self._add("bit", tokens[i].start, tokens[last].end, f"({name} << 1)", tokens[first], tokens[end - 1])

    def _waits(self, tokens: list[Token], first: int, end: int) -> None:
        start = self._after_head(tokens, first, end)
        if [t.text for t in tokens[start:start + 3]] == ["(", "void", ")"] and tokens[start + 3].text in self.registers:
            self._add("wait", tokens[start].start, tokens[end - 1].end, ";", tokens[start], tokens[end - 1])
        for i in range(first, end):
            if tokens[i].kind == "word" and tokens[i].text.startswith("wait_") and i + 1 < end and tokens[i + 1].text == "(":
                last = self._matching(tokens, i + 1, "(", ")")
                alone = i == start and tokens[last + 1].text == ";"
                new = "" if alone else "ERR_OK" if tokens[i].text == "wait_done" else "true"
                self._add("wait", tokens[i].start, tokens[last].end, new, tokens[first], tokens[end - 1])
        if tokens[first].text in ("while", "for"):
            self._loop(tokens, first)

    def _loop(self, tokens: list[Token], first: int) -> None:
        """A loop that reads a register, or what a pointer points to, and writes none."""
        head = self._matching(tokens, first + 1, "(", ")")
        if head + 1 >= len(tokens) or tokens[head + 1].text != "{":
            return
        last = self._matching(tokens, head + 1, "{", "}")
        inside = tokens[first:last]
        reads = any(t.text in self.registers or t.text == "reg" for t in inside)
        writes = any(self._assignment(inside, i, len(inside)) for i in range(len(inside)))
        if reads and not writes:
            self._add("wait", tokens[first].start, tokens[last].end, ";", tokens[first], tokens[last])

    def _barriers(self, tokens: list[Token]) -> None:
        for token in tokens:
            if token.kind != "text":
                continue
            for match in BARRIER.finditer(token.text):
                self._add("barrier", token.start + match.start(), token.start + match.end(), "", tokens[0], tokens[-1])
            if ASM_WRITE.match(token.text):
                self._add("write", token.start, token.end, '""', tokens[0], tokens[-1])
