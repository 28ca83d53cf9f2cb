"""How reports look: the style of a page, its tables, marks and notes. Readable on a phone, on a dark screen and on paper."""

from __future__ import annotations

from typing import Sequence

from reflux.markup import Content, Markup, element

NUMBER_MOST = 16  # characters of a number with its unit; longer ones are words, whose lines may break
MANY_COLUMNS = 9  # from here on a table is set closer
# Below this width a table shows each row as a list of names and values, because columns would be cut. Pictures change to their narrow form there.
PHONE_PX = 700

CSS = """
:root { color-scheme: light dark; --ink: #22292f; --paper: #fff; --dim: #55606b; --line: #d8dde3; --faint: #e4e7eb; --strong: #aab3bd;
  --box: #f5f7f9; --good: #14532d; --good-box: #dcf3e3; --bad: #7f1d1d; --bad-box: #fbdede; --doubt: #713f12; --doubt-box: #fdf0c4; }
@media screen and (prefers-color-scheme: dark) { :root { --ink: #dfe4e8; --paper: #16191d; --dim: #a3adb6; --line: #3a424a; --faint: #2b3238;
  --strong: #66717b; --box: #20252a; --good: #a7e8bf; --good-box: #14402a; --bad: #f6b3b3; --bad-box: #531d1d; --doubt: #f3dc8f; --doubt-box: #4d3a0b; }
  figure img { filter: invert(.9) hue-rotate(180deg); } }
html { color: var(--ink); background: var(--paper); }
body { font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1.2rem; overflow-wrap: break-word; }
h1 { font-size: 1.55rem; line-height: 1.25; margin: 0 0 .2rem; }
h2 { font-size: 1.1rem; margin: 2.2rem 0 .6rem; border-bottom: 1px solid var(--line); padding-bottom: .2rem; }
.verdict { display: inline-block; padding: .15rem .7rem; border-radius: .9rem; font-weight: 600; }
.pass { color: var(--good); background: var(--good-box); } .fail { color: var(--bad); background: var(--bad-box); }
.doubt { color: var(--doubt); background: var(--doubt-box); }
.what { color: var(--dim); margin: .2rem 0 1rem; }
table { border-collapse: collapse; font-size: .88rem; width: 100%; margin: .6rem 0; }
th { text-align: left; font-weight: 600; border-bottom: 2px solid var(--strong); padding: .3rem .6rem; vertical-align: bottom; }
td { border-bottom: 1px solid var(--faint); padding: .26rem .6rem; vertical-align: top; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; } td.n { white-space: nowrap; }
tr.total td { font-weight: 600; background: var(--box); }
.facts td:first-child { color: var(--dim); width: 12rem; } .facts td { overflow-wrap: anywhere; }
.many { font-size: .78rem; } .many th, .many td { padding: .2rem .25rem; }
figure { margin: 1rem 0 1.6rem; } figure img { width: 100%; height: auto; }
figcaption { font-size: .86rem; color: var(--dim); }
pre { background: var(--box); padding: .7rem .9rem; font-size: .8rem; line-height: 1.4; white-space: pre-wrap; overflow-wrap: anywhere;
  border-radius: .3rem; }
pre.columns { columns: 3 14rem; }
summary { cursor: pointer; } .note { font-size: .84rem; color: var(--dim); }
@media screen and (max-width: 700px) {
  body { margin: .8rem auto; padding: 0 .8rem; }
  table.named, .named tbody, .named tr, .named td { display: block; width: auto; } .named thead { display: none; }
  .named tr { border-bottom: 2px solid var(--strong); padding: .3rem 0; }
  .named td, .named td.n { display: flex; justify-content: space-between; gap: 1rem; border: 0; padding: .12rem .2rem; text-align: right;
    white-space: normal; overflow-wrap: anywhere; }
  .named td::before { content: attr(data-label); color: var(--dim); text-align: left; flex: none; max-width: 50%; }
  .facts td, .facts td:first-child { display: block; width: auto; } .facts td:first-child { border: 0; padding-bottom: 0; }
}
@media print { body { max-width: none; margin: 0; font-size: 11pt; } figure, table, tr { break-inside: avoid; } h2 { break-after: avoid; } }
"""


def grid(header: list[str], rows: Sequence[Sequence[Content]], text_columns: int = 2, total: str = "", kind: str = "") -> Markup:
    """A table; columns after the first few hold numbers, unless one has words in it. total: rows whose second cell says so stand out. On a phone each cell of a
    table with a header has its column's name before it."""
    wordy = {i for row in rows for i, cell in enumerate(row) if isinstance(cell, str) and len(cell) > NUMBER_MOST}
    classes = ["" if i < text_columns or i in wordy else "n" for i in range(len(header))]
    named = any(header)

    def line(cells: Sequence[Content], mark: str) -> Markup:
        return element("tr", *(element("td", cell, class_=c, data_label=name if named else "")
                               for c, name, cell in zip(classes, header, cells)), class_=mark)

    body = [line(row, "total" if total and len(row) > 1 and row[1] == total else "") for row in rows]
    head = [element("thead", element("tr", *(element("th", cell, class_=c) for c, cell in zip(classes, header))))] if named else []
    look = " ".join(word for word in (kind, "named" if named else "", "many" if len(header) >= MANY_COLUMNS else "") if word)
    return element("table", *head, element("tbody", *body), class_=look)


def badge(passed: bool, yes: str = "pass", no: str = "fail") -> Markup:
    return element("span", yes if passed else no, class_="verdict pass" if passed else "verdict fail")


def doubtful(words: str) -> Markup:
    """A badge between pass and fail."""
    return element("span", words, class_="verdict doubt")


def note(*content: Content) -> Markup:
    return element("p", *content, class_="note")


def listed(lines: Sequence[str]) -> Markup:
    """A list; nothing where there are no lines."""
    return element("ul", *(element("li", line) for line in lines)) if lines else Markup("")


def folded(title: str, *content: Content) -> Markup:
    """Opens when the reader clicks its title."""
    return element("details", element("summary", title), *content)
