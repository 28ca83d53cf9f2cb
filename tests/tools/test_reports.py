"""The pages that tools write, when the plant, the board and the scenario call themselves what a browser would run. Rebuilt from a public
report of a name that began with <span."""

import math
import re
import unittest
from html.parser import HTMLParser

from support import GOOD, FolderTest, call

from reflux import limits, logs, metrics, page_style, plots, report, run_plots, runner, scenario
from reflux.commission import results, results_text, second_opinions
from reflux.markup import element

HOSTILE = "<span/onclick=alert(1)>\"'&amp;</td><script>alert(1)</script>"
ATTRIBUTES = {"lang", "charset", "http-equiv", "content", "name", "class", "alt", "src", "data-label", "media", "srcset"}


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
        if tag not in ("meta", "img", "source"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag, tag

    def handle_data(self, data: str) -> None:
        self.text += data


def rgb(text: str) -> tuple[float, ...]:
    return tuple(int(text[k:k + 2], 16) / 255 for k in (1, 3, 5))


def turned_by_half(colour: tuple[float, ...]) -> tuple[float, ...]:
    """hue-rotate(180deg)"""
    grey = 2 * (0.213 * colour[0] + 0.715 * colour[1] + 0.072 * colour[2])
    return tuple(min(max(grey - c, 0.0), 1.0) for c in colour)


def contrast(one: tuple[float, ...], other: tuple[float, ...]) -> float:
    def luminance(colour: tuple[float, ...]) -> float:
        linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in colour]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


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
        said = [f"> version\n0 < {HOSTILE}\n0 < ok", f"> commission plant\n0 < plant tick s 60 name {HOSTILE}\n0 < output h unit kW lo 0 hi 4 safe 0\n0 < ok",
                f"< ! 1.0 alarm COMMISSION_ENDED - 1 {HOSTILE}", f"< ! 1.0 info {HOSTILE} {HOSTILE} 1 {HOSTILE}"]
        (self.folder / "transcript.txt").write_text("".join(f"0.000 {line}\n" for line in said))
        (self.folder / "answers.toml").write_text(HOSTILE)
        status, _, err = call("commission", "--report", str(self.folder))
        self.assertEqual((status, err), (0, ""))
        self.harmless((self.folder / "report.html").read_text(), 5)

    def test_text_is_escaped_whatever_it_looks_like_and_markup_is_not_escaped_twice(self) -> None:
        inner = element("b", "<i>", title='"')
        self.assertEqual(element("td", inner, "<b>").html, '<td><b title="&quot;">&lt;i&gt;</b>&lt;b&gt;</td>')

    def result(self, rows: int = 40) -> runner.Result:
        """A run whose loop is stepped at 100 s, and whose output cannot follow from then on."""
        self.file("trial.conf", "set meas1.name T1\nset meas1.unit degC\nset lock1.meas T1\nset lock1.mv Lr\nset lock1.side above\nset lock1.limit 88.5\n")
        trial = scenario.load(self.file("trial.toml", GOOD + """console = ["trial.conf"]
[[loop]]
name = "top"
pv = "T1"
mv = "Lr"
band = 0.5
[[line]]
at_s = 100
send = "sp top 90"
"""))
        columns = ["number", "time[s]", "T1.true[degC]", "T1.meas[degC]", "Lr.cmd[l/h]", "Lr.applied[l/h]", "xD[%w]", "fw.top.sp[degC]", "fw.xD_est[%w]",
                   "fw.xD_est.q"]
        lines = [[str(k), str(10 * k), "87", "87.1", "9" if k >= 10 else "4", "5" if k > 10 else "4", "99", "90" if k >= 10 else "87", "98.5", "0"]
                 for k in range(rows)]
        log = logs.Log(columns, lines)
        (self.folder / "transcript.txt").write_text("150.000 < ! 150.000 alarm INTERLOCK_ON Lr 121 interlock holds its output; measurement\n"
                                                    "200.000 < ! 200.000 info INTERLOCK_OFF Lr 118 interlock released; measurement\n")
        windows = metrics.windows(log, trial, trial.loops[0])
        facts = dict.fromkeys(("scenario_file", "plant", "firmware", "version", "image", "image_sha256", "samples", "wall_s"), "-")
        return runner.Result(trial, self.folder, log, windows, [], facts)

    def test_a_settling_time_of_never_is_explained(self) -> None:
        result = self.result()
        (words,) = report.never_settled(result)
        self.assertEqual(words, "top, from 100 s: never within \u00b10.5 degC for good before the window ended at 390 s; T1 was then 3 degC from its "
                                "setpoint. Lr did not follow: 9 l/h was commanded, 5 l/h applied.")
        self.assertIn(element("li", words).html, report.page(result, []))

    def test_a_picture_is_described_in_numbers_and_has_a_narrow_form(self) -> None:
        plots_of_run = run_plots.scenario_plots(self.result().log, self.result().scenario, runner.events_in(self.folder / "transcript.txt"))
        self.assertEqual([p.name for p in plots_of_run], ["loop-top", "estimates"])
        self.assertEqual(plots_of_run[0].alt, "Loop top over 0.1083 h: T1 at 87 degC, setpoint from 87 to 90 degC, Lr from 4 to 5 l/h. An interlock holds "
                                              "Lr from 150 s to 200 s.")
        self.assertEqual(plots_of_run[1].alt, "Estimates of the board: xD at 98.5 %w, at most 0.5 %w from the true value.")
        for plot in plots_of_run:
            width = [float(re.search(r'<svg [^>]*width="([\d.]+)pt"', text)[1]) for text in (plot.svg, plot.narrow)]
            self.assertGreater(width[0], 2 * width[1])
            self.assertLess(width[1] * 96 / 72, 400)  # px: on a phone of 390 px letters are hardly smaller than they were drawn
            page = report.drawing(plot).html
            self.assertIn(f'alt="{plot.alt}"', page)
            self.assertIn('<source media="(max-width: 700px)"', page)

    def test_an_estimate_that_the_board_calls_bad_is_drawn_apart(self) -> None:
        log = logs.Log(["number", "time[s]", "fw.xD_est[%w]", "fw.xD_est.q"],
                       [[str(k), str(100 * k), str(98 + k), q] for k, q in enumerate("0122103")])
        trusted, doubted = run_plots.by_quality(log, "fw.xD_est")
        self.assertEqual([k for k, v in enumerate(trusted) if math.isfinite(v)], [0, 1, 4, 5])
        self.assertEqual([(k, v) for k, v in enumerate(doubted) if math.isfinite(v)], [(1, 99), (2, 100), (3, 101), (4, 102), (5, 103), (6, 104)])
        plot = run_plots._estimates_plot(log, self.result().scenario, run_plots.estimates(log))
        self.assertIn("of bad quality in 3 of 7 samples", plot.alt)
        self.assertIn("Grey dashes: the board calls its estimate bad.", report.drawing(plot).html)
        good = run_plots.scenario_plots(self.result().log, self.result().scenario)[1]
        self.assertNotIn("Grey dashes", report.drawing(good).html)

    def test_a_scenario_without_limits_does_not_claim_to_have_kept_them(self) -> None:
        text = report.page(self.result(), [])
        self.assertNotIn("all limits kept", text)
        self.assertIn("This scenario sets no limits.", text)

    def test_a_setpoint_is_drawn_where_its_loop_acts_on_it(self) -> None:
        loop = self.result().scenario.loops[0]
        log = logs.Log(["number", "fw.top.mode"], [["0", "0"], ["1", "1"]])
        drawn = run_plots.acted_on(log, loop, [87.0, 88.0])
        self.assertTrue(math.isnan(drawn[0]) and drawn[1] == 88.0)
        self.assertEqual(run_plots.acted_on(logs.Log(["number"], [["0"]]), loop, [87.0]), [87.0])

    def test_what_a_broken_sensor_reads_does_not_set_the_scale(self) -> None:
        real, setpoint = [87.0, 87.5, 88.0, 88.0], [88.0] * 4
        seen, far = run_plots.near([87.1, -50.0, 88.1, math.nan], real, setpoint)
        self.assertEqual((seen[0], seen[2], far), (87.1, 88.1, [-50.0]))
        self.assertTrue(math.isnan(seen[1]) and math.isnan(seen[3]))
        self.assertEqual(run_plots.near([87.1, 87.4, 89.5, 88.0], real, setpoint)[1], [])
        self.assertEqual(run_plots.near([5.0, 9.0], [5.0, 5.0], [5.0, 5.0])[1], [])

    def test_a_page_has_a_dark_scheme_and_tables_that_are_lists_on_a_phone(self) -> None:
        page = report.page(self.result(), [])
        self.assertIn("(prefers-color-scheme: dark)", page)
        self.assertIn(f"@media screen and (max-width: {page_style.PHONE_PX}px)", page)
        self.assertNotIn("overflow-x", page)  # no table and no line is cut
        table = page_style.grid(["loop", "IAE"], [["top", "3"]], text_columns=1).html
        self.assertIn('<td data-label="loop">top</td><td class="n" data-label="IAE">3</td>', table)

    def test_trips_are_told_from_events_and_one_that_is_not_over_lasts_to_the_end(self) -> None:
        on, off = ("alarm", "INTERLOCK_ON", "Qrb 121 interlock holds"), ("info", "INTERLOCK_OFF", "Qrb 118 interlock released")
        self.assertEqual(run_plots.trips_of([(10.0, *on), (40.0, *off), (70.0, *on)], 100.0),
                         [run_plots.Trip("Qrb", 10.0, 40.0), run_plots.Trip("Qrb", 70.0, 100.0)])

    def test_curves_stand_out_from_the_page_in_both_schemes(self) -> None:
        """WCAG's contrast of 3:1 for parts of a picture, with the filter of the dark scheme as Filter Effects 1 defines it."""
        paper = re.findall(r"--paper: (#\w+)", page_style.CSS)
        self.assertEqual(len(paper), 2)
        self.assertIn("filter: invert(.9) hue-rotate(180deg)", page_style.CSS)
        for name in ("BLUE", "ORANGE", "GREY", "GREEN", "RED", "PALE_BLUE", "PALE_GREEN"):
            colour = rgb(getattr(plots, name))
            self.assertGreater(contrast(colour, rgb(paper[0].replace("#fff", "#ffffff"))), 3.0, name)
            self.assertGreater(contrast(turned_by_half(tuple(0.9 - 0.8 * c for c in colour)), rgb(paper[1])), 3.0, name)
        result = self.result()
        drawn = run_plots.scenario_plots(result.log, result.scenario)[0]
        for colour in (plots.PALE_BLUE, plots.PALE_GREEN):  # measured, commanded
            for picture in (drawn.svg, drawn.narrow):
                self.assertIn(f"stroke: {colour}; stroke-", picture)
                self.assertNotIn("stroke-opacity", picture)

    def test_a_legend_lies_outside_of_all_axes_and_within_the_picture(self) -> None:
        for size in (plots.WIDE, plots.NARROW):
            for above in (False, True):
                with plots.plt.rc_context(plots.STYLE):
                    figure, axes = plots.plt.subplots(2, 1, figsize=(size.inches, 5.0), sharex=True)
                    for ax in axes:
                        for name in ("Qrb applied", "Qrb trips above 121", "interlock holds"):
                            ax.plot([0, 1], [0, 1], label=name)
                    axes[1].set_xlabel("plant time [h]")
                    for ax in axes:
                        plots.legend_beside(ax, size, above=above, labelled=ax is axes[1])
                    figure.draw_without_rendering()
                    boxes = [ax.get_legend().get_window_extent() for ax in axes]
                    label = axes[1].xaxis.label.get_window_extent()
                    for box in boxes:
                        self.assertFalse(any(box.overlaps(ax.bbox) for ax in axes))
                        self.assertFalse(box.overlaps(label))
                        self.assertTrue(figure.bbox.y0 <= box.y0 and box.y1 <= figure.bbox.y1 and box.x1 <= figure.bbox.x1, (size, above))
                    self.assertFalse(boxes[0].overlaps(boxes[1]))
                    plots.plt.close(figure)

    def test_a_limit_has_the_unit_of_what_it_limits(self) -> None:
        result = self.result()
        for metric, told in (("iae", "IAE [degC s]"), ("settling_s", "settling time [s]"), ("tv", "total variation [l/h]"), ("overshoot_percent", "overshoot [%]")):
            result.checks[:] = [limits.Check("top", None, metric, 2.0, 1.0, False)]
            self.assertIn(f'<td data-label="metric">{told}</td>', report.page(result, []))

    def test_a_trip_lasts_until_no_interlock_holds_the_output(self) -> None:
        on, off = ("alarm", "INTERLOCK_ON", "Qrb 121 interlock holds"), ("info", "INTERLOCK_OFF", "Qrb 118 interlock released")
        other = ("alarm", "INTERLOCK_ON", "Lr 5 interlock holds")
        self.assertEqual(run_plots.trips_of([(10.0, *on), (20.0, *on), (25.0, *other), (30.0, *off), (40.0, *off), (60.0, *off), (70.0, *on)], 100.0),
                         [run_plots.Trip("Qrb", 10.0, 40.0), run_plots.Trip("Lr", 25.0, 100.0), run_plots.Trip("Qrb", 70.0, 100.0)])
        self.assertEqual(run_plots.trips_of([(10.0, *on), (20.0, *on), (50.0, "info", "STARTED", "watchdog 0 started"), (50.0, *on), (80.0, *off)], 100.0),
                         [run_plots.Trip("Qrb", 10.0, 50.0), run_plots.Trip("Qrb", 50.0, 80.0)])

    def test_what_happened_is_told_in_the_sentences_of_the_console(self) -> None:
        text = report.page(self.result(), [])
        self.assertIn("interlock holds Lr, T1 121 degC (INTERLOCK_ON)", text)
        self.assertIn("interlock releases Lr, T1 118 degC", text)
        self.assertNotIn("interlock released; measurement", text)

    def test_a_curve_with_fewer_points_keeps_its_extremes_and_its_ends(self) -> None:
        y = [math.sin(k / 50) for k in range(5000)]
        y[1234], y[4321], y[77] = 5.0, -5.0, math.nan
        t, thin = plots.thinned(range(5000), y, 200)
        self.assertLess(len(t), 220)
        self.assertEqual((t[0], t[-1], thin[t.index(1234)], thin[t.index(4321)]), (0, 4999, 5.0, -5.0))
        self.assertEqual(plots.thinned([1, 2], [3, 4], 200), ([1, 2], [3, 4]))

    def test_a_second_opinion_says_where_it_differs_and_why(self) -> None:
        model = results.model_of(["output T noise 0.05 degC",
                                  "element T h gain 20 sd 0.1 degC/kW T 100 sd 2 s L 0 sd 1 s flags -", "moments T h gain 15 T 90 L 3 plateau 20 flags negative_L short",
                                  "element T c gain 20 sd 0.1 degC/kW T 100 sd 2 s L 0 sd 1 s flags -", "moments T c gain 19 T 90 L 3 plateau 0 flags -"])
        _header, rows = second_opinions.second_opinion_rows(model)
        self.assertEqual(rows[0][5:], ["100", "-", "gain differs: moments 25 %; moments: a negative dead time came out, so its times mean nothing, the last test was short"])
        self.assertEqual(rows[1][5:], ["100", "93", "gains agree within 10 %"])
        self.assertNotIn("moments", " ".join(results_text.model_rows(model)[0]))

    def test_a_name_with_a_slash_stays_within_the_folder(self) -> None:
        (path,) = plots.write_pngs([plots.Plot("test-../../x", "", "", b"")], self.folder)
        self.assertEqual((path.parent, path.name), (self.folder, "plot-test-.._.._x.png"))


if __name__ == "__main__":
    unittest.main()
