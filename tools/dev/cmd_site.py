"""tools/site: the pages as a site with search, built by MkDocs."""

from __future__ import annotations

import argparse
import importlib.util
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

from reflux import packages
from reflux.errors import RunFailed, UserError
from reflux.paths import ROOT, build_root, named, shown

LOADED = {"script": "src", "img": "src", "iframe": "src", "source": "src", "link": "href"}  # what a browser fetches unasked
NOT_FETCHED = {"canonical", "prev", "next", "alternate"}  # relations of a <link>
MODULES = ("mkdocs", "material", "pymdownx")  # of Debian's packages, or of PyPI's mkdocs-material


class Page(HTMLParser):
    """What a page of the site fetches, where its links lead, and its anchors."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Called by the parser for each tag."""
        values = {name: value or "" for name, value in attrs}
        self.anchors.add(values.get("id", ""))
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
        if LOADED.get(tag) in values and values.get("rel") not in NOT_FETCHED:
            self.fetched.append(values[LOADED[tag]])


def faults(folder: Path) -> list[str]:
    """A line for each request to another host, and for each link that leads to no page or heading of the site."""
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))}
    if not pages:
        return [f"{shown(folder)} has no page"]
    out = []
    for path, page in pages.items():
        name = path.relative_to(folder)
        out += [f"{name} requests {address}" for address in page.fetched if urlsplit(address).netloc]
        if name.name == "404.html":  # its links begin at the root of the server
            continue
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            to = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            to = to / "index.html" if to.is_dir() else to
            if not to.is_file():
                out.append(f"{name} links to {link}, which is not there")
            elif parts.fragment and to in pages and unquote(parts.fragment) not in pages[to].anchors:
                out.append(f"{name} links to {link}, which is no heading there")
    return out


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/site",
        description="Builds the pages of docs/, README, CONTRIBUTING and CHANGELOG as a site with search, and checks that it requests nothing "
        "from other hosts and that every link leads to a page and a heading. Takes some seconds.")
    p.add_argument("--out", type=named, metavar="FOLDER", help="where the site is put; what is in there is deleted (default build/site)")
    options = p.parse_args(arguments)
    folder = (options.out or build_root() / "site").resolve()
    if folder.is_dir() and any(folder.iterdir()) and not (folder / "sitemap.xml").is_file():
        raise UserError(f"--out {shown(folder)} is not empty and no site: name another folder")
    if not all(importlib.util.find_spec(module) for module in MODULES):
        packages.need("site")
    answer = subprocess.run([sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)], cwd=ROOT, check=False)
    if answer.returncode:
        raise RunFailed("mkdocs built no site, see above")
    wrong = faults(folder)
    print("".join(f"{line}\n" for line in wrong), end="")
    print(f"{len(list(folder.rglob('*.html')))} pages, {len(wrong)} faults: {shown(folder / 'index.html')}; "
          f"for the search: python3 -m http.server -b localhost -d {shown(folder)}")
    return 1 if wrong else 0
