"""The pages that tools write, when the plant, the board and the scenario call themselves what a browser would run. Rebuilt from a public
report of a name that began with <span."""

import unittest
from html.parser import HTMLParser

from support import GOOD, FolderTest, call

from reflux import limits, logs, metrics, plots, report, runner, scenario
from reflux.markup import element

HOSTILE = "<span/onclick=alert(1)>\"'&amp;</td><script>alert(1)</script>"
ATTRIBUTES = {"lang", "charset", "http-equiv", "content", "name", "class", "alt", "src"}


class Page(HTMLParser):
    """Elements and attributes of a page, and its text."""

    def __init__(self, text: str):
        super().__init__()
        self.tags: set[str] = set()
        self.attributes: set[str] = set()
        self.policy = ""
        self.open: list[str] = []
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.attributes |= {name for name, _ in attrs}
        if ("http-equiv", "Content-Security-Policy") in attrs:
            self.policy = dict(attrs)["content"] or ""
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag, tag

    def handle_data(self, data: str) -> None:
        self.text += data


class Reports(FolderTest):
    def harmless(self, text: str, times: int) -> None:
        page = Page(text)
        self.assertEqual(page.open, [])
        self.assertFalse(page.tags & {"script", "a", "iframe", "svg"})
        self.assertLessEqual(page.attributes, ATTRIBUTES)
        self.assertGreaterEqual(page.text.count(HOSTILE), times)
        self.assertRegex(page.policy, r"^default-src 'none'; img-src data:; style-src 'sha256-[\w+/]{43}='; ")

    def test_nothing_that_a_run_calls_itself_becomes_markup(self) -> None:
        trial = scenario.load(self.file("trial.toml", GOOD + "[[event]]\nat_s = 1\nset = { F = 5 }\n"))
        object.__setattr__(trial, "title", HOSTILE)
        (self.folder / "transcript.txt").write_text(f"0.000 > version\n0.000 < {HOSTILE}\n0.000 < ok\n0 < ! 1.0 info {HOSTILE} {HOSTILE}\n")
        window = metrics.Window(HOSTILE, "overall", HOSTILE, 0.0, 1.0, 1.0, 1.0, None, None, 1.0, 1.0)
        check = limits.Check(HOSTILE, None, "iae", 2.0, 1.0, False)
        facts = dict.fromkeys(("scenario_file", "plant", "firmware", "version", "image", "image_sha256", "samples", "wall_s"), HOSTILE)
        result = runner.Result(trial, self.folder, logs.Log([], []), [window], [check], facts)
        self.harmless(report.page(result, [plots.Plot("x", HOSTILE, "<svg/>", b"")]), 12)

    def test_nothing_that_a_board_calls_itself_becomes_markup(self) -> None:
        (self.folder / "telemetry.csv").write_text("H,1,number,time[s]\nT,1,0,0.000\n")
        said = [f"> version\n0 < {HOSTILE}\n0 < ok", f"> commission plant\n0 < plant tick s 60 name {HOSTILE}\n0 < input h unit kW lo 0 hi 4 safe 0\n0 < ok",
                f"< ! 1.0 alarm COMMISSION_ENDED - 1 {HOSTILE}", f"< ! 1.0 info {HOSTILE} {HOSTILE} 1 {HOSTILE}"]
        (self.folder / "transcript.txt").write_text("".join(f"0.000 {line}\n" for line in said))
        (self.folder / "answers.toml").write_text(HOSTILE)
        status, _, err = call("commission", "--report", str(self.folder))
        self.assertEqual((status, err), (0, ""))
        self.harmless((self.folder / "report.html").read_text(), 5)

    def test_text_is_escaped_whatever_it_looks_like_and_markup_is_not_escaped_twice(self) -> None:
        inner = element("b", "<i>", title='"')
        self.assertEqual(element("td", inner, "<b>").html, '<td><b title="&quot;">&lt;i&gt;</b>&lt;b&gt;</td>')

    def test_a_name_with_a_slash_stays_within_the_folder(self) -> None:
        (path,) = plots.write_pngs([plots.Plot("test-../../x", "", "", b"")], self.folder)
        self.assertEqual((path.parent, path.name), (self.folder, "plot-test-.._.._x.png"))


if __name__ == "__main__":
    unittest.main()
