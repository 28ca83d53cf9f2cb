"""Pages that the tools write: HTML that is escaped unless its type says that it is markup already.

What a plant, a board or a file calls itself ends up on a page, so text never counts as markup by what it looks like.
"""

from __future__ import annotations

import base64
import hashlib
import html
from dataclasses import dataclass
from typing import Sequence, Union

VOID = ("img", "meta", "source")  # elements without an end


@dataclass(frozen=True)
class Markup:
    """HTML made by element() or join()."""

    html: str


Content = Union[Markup, str]


def escaped(content: Content) -> str:
    return content.html if isinstance(content, Markup) else html.escape(content)


def join(parts: Sequence[Content], between: str = "") -> Markup:
    return Markup(between.join(escaped(part) for part in parts))


def element(tag: str, *content: Content, **attributes: str) -> Markup:
    """A trailing underscore of an attribute's name is left out (class_), other underscores become hyphens; an empty attribute is
    left out."""
    words = "".join(f' {name.rstrip("_").replace("_", "-")}="{html.escape(value)}"' for name, value in attributes.items() if value)
    return Markup(f"<{tag}{words}>" + ("" if tag in VOID else f"{join(content).html}</{tag}>"))


def embedded(data: bytes, kind: str) -> str:
    """A file's bytes as an address. kind: svg+xml or png."""
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"


def picture(data: bytes, kind: str, caption: str, alt: str = "", narrow: bytes = b"", narrow_px: int = 0) -> Markup:
    """The file's bytes stand in the page. alt: what a reader who cannot see the picture hears. narrow: another drawing of the same kind
    for screens of at most narrow_px."""
    image = element("img", alt=alt or caption, src=embedded(data, kind))
    if narrow:
        source = element("source", media=f"(max-width: {narrow_px}px)", srcset=embedded(narrow, kind))
        image = element("picture", source, image)
    return element("figure", image, element("figcaption", caption))


def page(title: str, css: str, parts: Sequence[Content]) -> str:
    """A whole page. Its policy forbids scripts, forms and everything from elsewhere: only this style and pictures in the page."""
    style = base64.b64encode(hashlib.sha256(css.encode()).digest()).decode()
    policy = f"default-src 'none'; img-src data:; style-src 'sha256-{style}'; base-uri 'none'; form-action 'none'"
    head = join([element("meta", charset="utf-8"), element("meta", http_equiv="Content-Security-Policy", content=policy),
                 element("meta", name="viewport", content="width=device-width, initial-scale=1"), element("title", title),
                 Markup(f"<style>{css}</style>")])
    body = join(["\n", join([part for part in parts if escaped(part)], "\n"), "\n"])
    return "<!DOCTYPE html>\n" + element("html", element("head", head), element("body", body), lang="en").html + "\n"
