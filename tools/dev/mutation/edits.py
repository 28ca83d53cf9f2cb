"""Finds the places where a C source could be wrong by one token or one statement, and the wrong text.

Four kinds. constant: a number one more or one less, a real number twice or half, true for false. comparison: another
one, also && for ||, or a negation left out. arithmetic: another operator, also num_add for num_sub and their like, or a
sign left out. dropped: a statement that is not there.

Looked at are the bodies of functions and, in .c files, initialised tables and #define lines. Not looked at are texts,
declarations, and one more for the size of an array in a declaration, which nothing could notice.
"""

from __future__ import annotations

import bisect
import re
from dataclasses import dataclass
from pathlib import Path

KINDS = ("constant", "comparison", "arithmetic", "dropped")

TOKEN = re.compile(
    r"(?P<space>[ \t\r\n]+|\\\n)"
    r"|(?P<comment>/\*.*?\*/|//[^\n]*)"
    r"|(?P<directive>(?m:^[ \t]*\#)(?:[^\n\\]|\\.|\\\n)*)"
    r'|(?P<text>"(?:[^"\\\n]|\\.)*")'
    r"|(?P<char>'(?:[^'\\\n]|\\.)+')"
    r"|(?P<number>\.?\d(?:[eEpP][+-]|[\w.])*)"
    r"|(?P<word>[A-Za-z_]\w*)"
    r"|(?P<sign><<=|>>=|\.\.\.|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|.)", re.DOTALL)
DEFINE = re.compile(r"[ \t]*#[ \t]*define[ \t]+\w+(\([^)\n]*\))?")
INTEGER = re.compile(r"(0[xX][0-9a-fA-F]+|\d+)([uUlL]*)")
REAL = re.compile(r"((?:\d+\.\d*|\.\d+|\d+(?=[eE]))(?:[eE][+-]?\d+)?)([fFlL]?)")

COMPARISONS = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"), "==": ("!=",), "!=": ("==",),
               "&&": ("||",), "||": ("&&",)}
BINARY = {"+": ("-",), "-": ("+",), "*": ("/",), "/": ("*",), "%": ("*",), "&": ("|",), "|": ("&",), "^": ("|",),
          "<<": (">>",), ">>": ("<<",)}
ASSIGNMENTS = {"+=": ("-=", "="), "-=": ("+=", "="), "*=": ("/=", "="), "/=": ("*=", "="), "|=": ("&=", "="),
               "&=": ("|=", "="), "^=": ("|=",), "<<=": (">>=",), ">>=": ("<<=",), "%=": ("*=",), "++": ("--",), "--": ("++",)}
FUNCTIONS = {"num_add": "num_sub", "num_sub": "num_add", "num_mul": "num_div", "num_div": "num_mul",
             "num_min": "num_max", "num_max": "num_min"}
NEGATED = ("num_lt", "num_eq")
KEYWORDS = {"return", "if", "else", "for", "while", "do", "switch", "case", "default", "goto", "sizeof", "typedef", "static",
            "const", "struct", "union", "enum", "extern", "inline", "register", "volatile", "_Static_assert"}
TYPES = {"void", "char", "short", "int", "long", "float", "double", "signed", "unsigned", "bool", "const", "struct", "enum"}


@dataclass(frozen=True)
class Token:
    kind: str
    text: str
    start: int
    macro: bool = False

    @property
    def end(self) -> int:
        return self.start + len(self.text)


@dataclass(frozen=True)
class Edit:
    """One way to be wrong. first..last are the lines of the statement it stands in, line is its own; from 1."""

    kind: str
    function: str  # or empty: a table or a macro
    line: int
    first: int
    last: int
    start: int
    end: int
    new: str

    def apply(self, text: str) -> str:
        return text[:self.start] + self.new + text[self.end:]

    def shown(self, text: str) -> tuple[str, str]:
        """The whole lines it touches, before and after, with single blanks."""
        start = text.rfind("\n", 0, self.start) + 1
        end = text.find("\n", self.end)
        end = len(text) if end < 0 else end
        after = text[start:self.start] + self.new + text[self.end:end]
        return " ".join(text[start:end].split()), " ".join(after.split())


def edits_of(path: Path, text: str) -> list[Edit]:
    tokens = tokens_of(text, path.suffix == ".c")
    return Reader(text, tokens, path.suffix == ".c").edits()


def tokens_of(text: str, macros: bool) -> list[Token]:
    out: list[Token] = []
    for match in TOKEN.finditer(text):
        kind, at = match.lastgroup or "", match.start()
        if kind in ("space", "comment"):
            continue
        if kind == "directive":
            define = DEFINE.match(match.group()) if macros else None
            if define:
                body = match.group()[define.end():]
                out += [Token(m.lastgroup or "", m.group(), at + define.end() + m.start(), True)
                        for m in TOKEN.finditer(body) if m.lastgroup not in ("space", "comment", "directive")]
            continue
        out.append(Token(kind, match.group(), at))
    return out


class Reader:
    """Goes once through the tokens, knowing whether it is in a function, in a table or in a declaration."""

    def __init__(self, text: str, tokens: list[Token], tables: bool):
        self.text, self.tables = text, tables
        self.plain = [t for t in tokens if not t.macro]
        self.macros = [t for t in tokens if t.macro]
        self.starts = [0] + [m.end() for m in re.finditer("\n", text)]
        self.function = ""
        self.out: list[Edit] = []

    def edits(self) -> list[Edit]:
        i = 0
        while i < len(self.plain):
            token = self.plain[i]
            if token.text != "{":
                i += 1
                continue
            end = self._matching(self.plain, i, "{", "}")
            before = self.plain[i - 1].text if i else ""
            if before == ")":
                self.function = self._name(i - 1)
                self._body(self.plain[i + 1:end])
                self.function = ""
            elif before == "=" and self.tables:
                self._table(self.plain[i + 1:end])
            i = end + 1
        for i in range(len(self.macros)):
            self._single(self.macros, i, self.macros[i], self.macros[i], dims=False)
        return sorted(self.out, key=lambda e: (e.start, e.end, e.new))

    def _name(self, closing: int) -> str:
        depth = 0
        for k in range(closing, 0, -1):
            depth += (self.plain[k].text == ")") - (self.plain[k].text == "(")
            if depth == 0:
                return self.plain[k - 1].text
        return ""

    def _line(self, at: int) -> int:
        return bisect.bisect_right(self.starts, at)

    @staticmethod
    def _matching(tokens: list[Token], i: int, opening: str, closing: str) -> int:
        depth = 0
        for k in range(i, len(tokens)):
            depth += (tokens[k].text == opening) - (tokens[k].text == closing)
            if depth == 0:
                return k
        return len(tokens)

    def _body(self, tokens: list[Token]) -> None:
        first = depth = 0
        for i, token in enumerate(tokens):
            if token.kind == "sign":
                depth += (token.text in "([") - (token.text in ")]")
            ends = depth == 0 and token.text in ("{", "}", ";", ":") and not (token.text == ":" and self._chosen(tokens, first, i))
            if not ends:
                continue
            self._statement(tokens, first, i + 1)
            first = i + 1
        self._statement(tokens, first, len(tokens))

    @staticmethod
    def _chosen(tokens: list[Token], first: int, i: int) -> bool:
        """True if this colon belongs to a question mark of its statement."""
        return any(t.text == "?" for t in tokens[first:i])

    def _table(self, tokens: list[Token]) -> None:
        for i, token in enumerate(tokens):
            self._single(tokens, i, token, token, dims=False)

    def _statement(self, tokens: list[Token], first: int, end: int) -> None:
        if first >= end:
            return
        declares = self._declares(tokens[first:end])
        for i in range(first, end):
            self._single(tokens, i, tokens[first], tokens[end - 1], dims=declares)
        if tokens[end - 1].text != ";":
            return
        start = self._after_head(tokens, first, end)
        if start < end - 1 and self._droppable(tokens[start:end]):
            self._add("dropped", tokens[start].start, tokens[end - 1].end, ";", tokens[start], tokens[end - 1])

    def _after_head(self, tokens: list[Token], first: int, end: int) -> int:
        """Past if (...), else, for (...), while (...), do: to the statement that hangs on them."""
        i = first
        while i < end:
            if tokens[i].text in ("else", "do"):
                i += 1
            elif tokens[i].text in ("if", "for", "while", "switch"):
                i = self._matching(tokens, i + 1, "(", ")") + 1
            else:
                return i
        return end

    @staticmethod
    def _declares(tokens: list[Token]) -> bool:
        words = [t.text for t in tokens[:3]]
        if not words or words[0] in TYPES or words[0] in ("static", "union"):
            return True
        return len(tokens) > 2 and tokens[0].kind == "word" and words[0] not in KEYWORDS and tokens[1].kind == "word"

    def _droppable(self, tokens: list[Token]) -> bool:
        if tokens[0].text in ("break", "continue"):
            return True
        if tokens[0].text in KEYWORDS or self._declares(tokens):
            return False
        return any(t.text == "=" or t.text in ASSIGNMENTS or t.text == "(" for t in tokens)

    def _add(self, kind: str, start: int, end: int, new: str, first: Token, last: Token) -> None:
        lines = self.text.count("\n", start, end)  # the lines below keep their numbers
        line = self._line(start)
        self.out.append(Edit(kind, self.function, line, self._line(first.start), self._line(last.start), start, end, new + "\n" * lines))

    def _single(self, tokens: list[Token], i: int, first: Token, last: Token, dims: bool) -> None:
        token = tokens[i]
        before = tokens[i - 1] if i else None
        after = tokens[i + 1] if i + 1 < len(tokens) else None

        def add(kind: str, new: str) -> None:
            self._add(kind, token.start, token.end, new, first, last)

        if token.kind == "number":
            size = dims and before is not None and before.text == "[" and after is not None and after.text == "]"
            for new in _other_numbers(token.text):
                if not (size and not _smaller(new, token.text)):
                    add("constant", new)
        elif token.kind == "char" and len(token.text) == 3 and token.text[1] not in "&[~":
            add("constant", f"'{chr(ord(token.text[1]) + 1)}'")
        elif token.text in ("true", "false"):
            add("constant", "false" if token.text == "true" else "true")
        elif token.text in COMPARISONS:
            for new in COMPARISONS[token.text]:
                add("comparison", new)
        elif token.text == "!" or (token.text in NEGATED and after is not None and after.text == "("):
            add("comparison", "" if token.text == "!" else f"!{token.text}")
        elif token.text in FUNCTIONS:
            add("arithmetic", FUNCTIONS[token.text])
        elif token.text == "num_neg":
            add("arithmetic", "")
        elif token.text in ASSIGNMENTS:
            for new in ASSIGNMENTS[token.text]:
                add("arithmetic", new)
        elif token.text in BINARY and self._joins_two(tokens, i) and not (dims and self._declarator(tokens, i, first)):
            for new in BINARY[token.text]:
                add("arithmetic", new)
        elif token.text in "-~" and token.kind == "sign":
            add("arithmetic", "")

    def _joins_two(self, tokens: list[Token], i: int) -> bool:
        """Between two values, and not a sign, an address, or what a pointer points to."""
        if i == 0:
            return False
        before = tokens[i - 1]
        if before.text == ")":
            return not self._cast_or_head(tokens, i - 1)
        if before.text == "]":
            return True
        if before.kind == "word":
            return before.text not in KEYWORDS and before.text not in TYPES and not before.text.endswith("_t")
        return before.kind in ("number", "char")

    @staticmethod
    def _declarator(tokens: list[Token], i: int, first: Token) -> bool:
        """The star of a pointer that a declaration declares: nothing of its statement so far is a value."""
        k = i
        while k > 0 and tokens[k] is not first:
            k -= 1
        return tokens[i].text == "*" and not any(t.text in ("=", "[", "(") for t in tokens[k:i])

    @staticmethod
    def _cast_or_head(tokens: list[Token], closing: int) -> bool:
        """True if this parenthesis ends a cast, or the head of an if or a loop."""
        depth = 0
        for k in range(closing, -1, -1):
            depth += (tokens[k].text == ")") - (tokens[k].text == "(")
            if depth == 0:
                inside = [t.text for t in tokens[k + 1:closing]]
                if k > 0 and tokens[k - 1].text in ("if", "for", "while", "switch"):
                    return True
                called = k > 0 and tokens[k - 1].kind == "word" and tokens[k - 1].text not in KEYWORDS
                return not called and bool(inside) and all(
                    w in TYPES or w.endswith("_t") or w == "*" or (n and inside[n - 1] == "struct")
                    for n, w in enumerate(inside))
        return False


def _other_numbers(text: str) -> list[str]:
    if match := INTEGER.fullmatch(text):
        digits, suffix = match.groups()
        hexadecimal = digits[:2] in ("0x", "0X")
        if not hexadecimal and len(digits) > 1 and digits[0] == "0":
            return []
        value = int(digits, 16 if hexadecimal else 10)
        others = [value + 1] + ([value - 1] if value > 0 else [])
        return [(f"0x{v:X}" if hexadecimal else str(v)) + suffix for v in others]
    if match := REAL.fullmatch(text):
        digits, suffix = match.groups()
        value = float(digits)
        others = [1.0] if value == 0.0 else [2.0 * value, 0.5 * value]
        return [_real(v) + suffix for v in others]
    return []


def _real(value: float) -> str:
    text = repr(value)
    return text if "." in text or "e" in text or "E" in text else text + ".0"


def _smaller(new: str, old: str) -> bool:
    a, b = INTEGER.fullmatch(new), INTEGER.fullmatch(old)
    return bool(a and b) and int(a.group(1), 0) < int(b.group(1), 0)
