"""Hooks of MkDocs (mkdocs.yml). Pages are written for GitHub's Markdown and may link to any file of the repository; the site has Python's Markdown,
and has only pages."""

from __future__ import annotations

import itertools
import os
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
OF_THE_ROOT = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")  # pages of the site that stand beside docs/
LIST, LIST_ON_SITE = "README.md", "pages.md"  # docs/README.md: on the site, the README of the root has that name
LINK = re.compile(r"\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(([^()\s]+)\)")


def on_files(files: Any, config: Any) -> Any:
    """Adds the pages of the root folder, and leaves out what tools/reference has made pages of."""
    from mkdocs.structure.files import File  # here, because the tests of this file do without MkDocs

    if pages := files.get_file_from_path(LIST):
        files.remove(pages)
        renamed = File(LIST_ON_SITE, str(DOCS), config["site_dir"], config["use_directory_urls"])
        renamed.abs_src_path = str(DOCS / LIST)
        files.append(renamed)
    for name in OF_THE_ROOT:
        files.append(File(name, str(ROOT), config["site_dir"], config["use_directory_urls"]))
    for file in [file for file in files if file.src_uri.startswith("reference/notes/")]:
        files.remove(file)
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """The page in the Markdown of the site, with the paths of the site."""
    name = page.file.src_uri
    folder = ROOT if name in OF_THE_ROOT else (DOCS / name).parent
    fenced, code = False, []
    for line in markdown.split("\n"):
        fenced ^= line.startswith("```")
        code.append((fenced or line.startswith("    "), line))
    out = []
    for is_code, lines in itertools.groupby(code, key=lambda pair: pair[0]):  # a link may go over two lines
        text = "\n".join(line for _, line in lines)
        out.append(text if is_code else for_site(text, folder))
    return "\n".join(out)


def for_site(text: str, folder: Path) -> str:
    """Lines of a page that stands in this folder, none of them of a block of code."""
    lines = []
    for line in text.split("\n"):
        if line.startswith("|"):  # GitHub wants a bar escaped that stands in a cell's code; Python's Markdown would show the backslash
            line = re.sub(r"`[^`]*`", lambda cell: cell[0].replace("\\|", "|"), line)
        lines.append(re.sub(r"^ {2,3}(?=[-*] )", "    ", line))  # a list within a list
    return LINK.sub(lambda match: _link(match[1], match[2], folder), "\n".join(lines))


def _link(text: str, target: str, folder: Path) -> str:
    path, mark, anchor = target.partition("#")
    if not path or re.match(r"\w+:", target):
        return f"[{text}]({target})"
    to = Path(os.path.normpath(folder / path))
    name = to.relative_to(ROOT).as_posix()
    if not to.is_relative_to(DOCS) and name not in OF_THE_ROOT:
        return f"`{name}`" if text.split("/")[-1] == to.name else f"{text} (`{name}`)"
    place = DOCS / name if name in OF_THE_ROOT else DOCS / LIST_ON_SITE if to == DOCS / LIST else to  # on the site, the pages of the root stand in docs/
    start = DOCS if folder == ROOT else folder
    return f"[{text}]({Path(os.path.relpath(place, start)).as_posix()}{mark}{anchor})"
