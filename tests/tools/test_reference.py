"""tools/reference: the pages of docs/reference are those that the code makes today, and a table without its notes is refused."""

import contextlib
import itertools
import json
import re
import subprocess
import unittest
from unittest import mock

from support import ROOT, FolderTest, board, call

from dev import cmd_reference
from dev.reference import board_page, firmware_pages, markdown, plant_page, scenario_page, tables
from reflux import build, scenario_keys
from reflux.errors import RunFailed, UserError
from reflux.ports import Port
from reflux.session import Refused, Session

REFERENCE = ROOT / "docs" / "reference"


def made() -> dict[str, str]:
    return cmd_reference.pages(build.find_program("host", cmd_reference.PROGRAMS[0]).parent)


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.made = made()

    def test_the_pages_are_those_that_the_code_makes_today(self) -> None:
        for name, text in self.made.items():
            with self.subTest(name):
                self.assertEqual((REFERENCE / name).read_text(encoding="utf-8"), text, "run tools/reference")
        self.assertEqual(sorted(path.name for path in REFERENCE.glob("*.md")), sorted(self.made))

    def test_the_first_line_says_how_the_page_is_made_and_the_first_list_leads_to_its_families(self) -> None:
        for name, text in self.made.items():
            self.assertIn("tools/reference", text.splitlines()[0], name)
            titles = re.findall(r"^## (.*)$", text, re.MULTILINE)
            for title in titles:
                if title != "Boards that lack some":
                    self.assertIn(f"](#{markdown.anchor(title)})", text.split("\n## ")[0], name)

    def test_every_row_of_parameters_and_events_has_a_unit(self) -> None:
        rows = re.findall(r"^\| `[^|]*\| ([^|]*) \|.*0x[0-9a-f]+ \|$", self.made["parameters.md"], re.MULTILINE)
        self.assertGreater(len(rows), 300)
        self.assertNotIn("", [unit.strip() for unit in rows])
        rows = re.findall(r"^\| `[A-Z_]+` \|(?:[^|]*\|){4} ([^|]*) \| \d+ \|$", self.made["events.md"], re.MULTILINE)
        self.assertEqual(len(rows), len(tables.notes("events")["event"]))
        self.assertNotIn("", [unit.strip() for unit in rows])

    def test_each_row_says_what_the_firmware_says(self) -> None:
        self.assertIn("| `gain` | fraction/fraction | 1e-06 .. 100 | 1 | proportional gain, output span per measurement span | 0x4100 |", self.made["parameters.md"])
        self.assertIn("| `LINK_DOWN` | alarm | plant silent, s<br>`plant: plant silent 90 s (LINK_DOWN)` | plant | silent for | s | 2 |", self.made["events.md"])
        self.assertIn("`T1 usable again, 78.4 degC`", self.made["events.md"])
        self.assertIn("- `reboot` (engineers): ", self.made["commands.md"])
        self.assertIn("| `LOCKED` | needs the engineer level, which is locked; `unlock KEY` opens it |", self.made["errors.md"])


    def test_what_block_n_shows_stands_below_the_tables_of_its_kind(self) -> None:
        shown = {name: kind["values"] for name, kind in tables.notes("parameters")["kind"].items() if "values" in kind}
        self.assertGreaterEqual(len(shown), 6)
        for name, text in shown.items():
            section = self.made["parameters.md"].split(f"\n### kind {name}\n")[1].split("\n### ")[0]
            self.assertTrue(section.rstrip().endswith(text.strip()), name)


class PlantKeys(FolderTest):
    @classmethod
    def setUpClass(cls) -> None:
        cls.tree = build.find_program("host", cmd_reference.PROGRAMS[0]).parent
        cls.rows = tables.rows_of(tables.said_by(cls.tree / "plant_tables"))

    def asked(self, plant: dict) -> str:
        path = self.file("mine.json", json.dumps(plant))
        return subprocess.run([str(self.tree / "reflux-sim"), "--steady", "--plant", str(path)], capture_output=True, text=True, check=False).stderr

    def test_the_reader_takes_no_more_than_the_page_allows(self) -> None:
        plant = json.loads((ROOT / "host_sim" / "plants" / "wood-berry.json").read_text(encoding="utf-8"))
        keys = {name: allowed for of, name, _, _, allowed, *_ in self.rows["key"] if of == "Output of a linear plant"}
        self.assertEqual(keys["lag_s"], "0 .. 86400")
        self.assertEqual(self.asked(plant), "")
        plant["outputs"][0]["lag_s"] = 86401
        self.assertIn("$.outputs[0].lag_s: 86401 must be 0 to 86400", self.asked(plant))
        del plant["outputs"][0]["lag_s"]
        plant["outputs"][0]["lags"] = 1
        self.assertIn(f"known are {', '.join(keys)}", self.asked(plant))

    def test_a_key_of_another_model_is_refused_and_the_page_names_the_models(self) -> None:
        plant = json.loads((ROOT / "host_sim" / "plants" / "wood-berry.json").read_text(encoding="utf-8"))
        self.assertEqual(plant["model"], "transfer")
        self.assertIn('the key "A" has no meaning in a model "transfer"', self.asked(plant | {"A": [[1]]}))
        page = {row[0]: row for row in plant_page.object_rows(self.rows, "Linear plant")}
        self.assertEqual(page["`A`"][1].split(": ")[0], "model state_space, discrete, polynomial")
        self.assertNotIn("model", page["`inputs`"][1])

    def test_a_quantity_of_the_page_drives_a_column_and_no_other_does(self) -> None:
        column = json.loads((ROOT / "host_sim" / "plants" / "column-a.json").read_text(encoding="utf-8"))
        column["inputs"][0]["is"] = "smell"
        said = self.asked(column)
        for name, *_ in self.rows["drive"]:
            self.assertIn(name, said)

    def test_a_unit_stands_with_its_size_in_si(self) -> None:
        units = {measure: words for measure, _, words in plant_page.unit_rows(self.rows)}
        self.assertIn("`bar` (100000 Pa)", units["pressure"])
        self.assertIn("`K`, `degC` (x + 273.15 K)", units["temperature"])
        self.assertIn("`%` (0.01)", units["mole fraction"])


class ScenarioKeys(unittest.TestCase):
    def test_the_page_has_every_key_that_the_reader_takes(self) -> None:
        text = made()["scenario-files.md"]
        for name, keys in scenario_keys.TABLES.items():
            section = text.split("\n## Table " + name if name else "\n## Keys of the file")[1].split("\n## ")[0]
            for key in keys:
                self.assertRegex(section, rf"(?m)^\| `(\[\[)?{key}(\]\])?` \|")

    def test_the_page_has_every_fault_that_the_simulator_takes(self) -> None:
        tree = build.find_program("host", cmd_reference.PROGRAMS[0]).parent
        said = subprocess.run([str(tree / "reflux-sim"), "--plant", "pilot", "--port", "newpty", "--event", "0:board.none=1"],
                              capture_output=True, text=True, check=False).stderr
        known = said.strip().split("it has ")[1].split(", ")
        rows = {name: (unit, limits) for name, _, unit, limits, _ in scenario_page.fault_rows(tables.rows_of(tables.said_by(tree / "plant_tables")))}
        self.assertEqual([f"`board.{name}`" for name in known], list(rows))
        self.assertEqual(rows["`board.supply`"], ("V", "0 .. 3.6"))

    def test_limits_defaults_and_choices_are_those_of_the_reader(self) -> None:
        top, loop = scenario_keys.TOP, scenario_keys.LOOP
        self.assertEqual((scenario_page.allowed(top["duration_s"]), scenario_page.default(top["duration_s"])), ("above 0", "required"))
        self.assertEqual((scenario_page.allowed(top["tick_s"]), scenario_page.default(top["tick_s"])), ("above 0, at most `duration_s`", "the plant's"))
        self.assertEqual((scenario_page.allowed(loop["band"]), scenario_page.default(loop["band"])), ("0 or more", "`0.0`"))
        self.assertIn("host|host-fixed|", scenario_page.allowed(top["firmware"]))


class Rows(unittest.TestCase):
    def test_parameters_that_differ_in_name_alone_share_a_row(self) -> None:
        same = [["k", f"a{i}", "s", "0 .. 1", "0", "what", f"0x{i}", "1", "1"] for i in range(1, 4)]
        self.assertEqual(firmware_pages.parameter_rows(same), [("`a1` to `a3`", "s", "0 .. 1", "0", "what", "0x1 to 0x3")])
        other = [*same[:2], ["k", "b", "s", "0 .. 2", "0", "what", "0x9", "1", "1"]]
        self.assertEqual([row[0] for row in firmware_pages.parameter_rows(other)], ["`a1`", "`a2`", "`b`"])

    def test_a_table_of_a_kind_has_the_names_of_its_rows(self) -> None:
        row = firmware_pages.parameter_rows([["k", "delay", "steps", "0 .. 8", "1", "what", "0x1", "2", "2"]])
        self.assertEqual(row[0][0], "`delay.1` to `delay.2`")

    def test_what_has_no_unit_says_what_stands_there(self) -> None:
        for allowed, wanted in (("off|on", "word"), ("up to 15 letters, digits or _, - for none", "name"), ("names with commas between them", "names"), ("0 .. 1", "-")):
            self.assertEqual(firmware_pages.unit_of("", allowed), wanted)

    def test_a_bar_does_not_end_a_cell(self) -> None:
        self.assertEqual(markdown.table(("a",), [("x|y",)])[-1], "| x\\|y |")


class Notes(unittest.TestCase):
    def test_an_item_without_note_one_too_many_and_one_noted_twice_are_refused(self) -> None:
        tables.check_same("event", "events", ["A", "B"], ["A", "B"])
        for noted, known, wrong in ((["A"], ["A", "B"], "B has no note"), (["A", "B"], ["A"], "B is not in the code"), (["A", "A"], ["A"], "A is noted twice")):
            with self.assertRaisesRegex(RunFailed, wrong):
                tables.check_same("event", "events", noted, known)

    def test_a_note_stands_in_the_row_of_its_parameter_and_one_on_no_parameter_is_refused(self) -> None:
        row = ["loop", "pv", "", "a name", "-", "measurement", "0x1", "1", "1"]
        self.assertEqual(firmware_pages.with_notes(row, {"loop.pv": "in manual only"})[5], "measurement; in manual only")
        self.assertEqual(firmware_pages.with_notes(row, {"loop.out": "in manual only"}), row)
        noted = tables.notes("parameters")
        noted["note"]["loop.colour"] = "red"
        with mock.patch.object(firmware_pages, "notes", return_value=noted), self.assertRaisesRegex(RunFailed, "no parameter loop.colour"):
            firmware_pages.parameters(tables.rows_of(tables.said_by(build.find_program("host", cmd_reference.PROGRAMS[0]))))

    def test_a_word_of_a_command_that_no_form_has_is_refused_and_one_that_only_a_form_has(self) -> None:
        rows = {"command": [["log", "on|off [TICKS]", "telemetry"]]}
        noted = {"family": [{"title": "Look", "commands": ["log"]}], "command": {"log": {"forms": [["log on [TICKS]", "everybody", "rows"]]}}}
        with mock.patch.object(firmware_pages, "notes", return_value=noted), self.assertRaisesRegex(RunFailed, "no form of log has off"):
            firmware_pages.commands(rows)
        noted["command"]["log"]["forms"].append(["log off", "everybody", "no more rows"])
        with mock.patch.object(firmware_pages, "notes", return_value=noted):
            self.assertIn("- `log off`: no more rows.", firmware_pages.commands(rows))
        noted["command"]["log"]["forms"].append(["log twice", "everybody", "two rows"])
        with mock.patch.object(firmware_pages, "notes", return_value=noted), self.assertRaisesRegex(RunFailed, "the row of log .* lacks twice"):
            firmware_pages.commands(rows)


class Levels(unittest.TestCase):
    """A board whose engineer level is locked refuses the forms that the page marks, and no other."""

    WORDS = {"PARAMETER": "tick.miss_limit", "VALUE": "6", "NEW": "other", "LOOP": "y1", "MV": "u1", "COMMAND": "help", "PREFIX": "loop", "TICKS": "1",
             "ALARM": "alarm1", "SECONDS": "10", "HOURS": "1", "BLOCK": "1", "VERB": "tune", "NUMBER": "1", "RULE": "simc", "GAIN": "1", "DEAD": "1",
             "LAG": "10", "LAMBDA": "1"}
    CHANGE_THE_SESSION = ("mode ", "unlock ", "log on")

    def lines(self, form: str) -> list[str]:
        """Each way to type a form, with a word for each name and value."""
        words = [[self.WORDS.get(word, word) for word in place.split("|")] for place in re.sub(r"[\[\]]", "", form).split()]
        return [" ".join(line) for line in itertools.product(*words)]

    def test_who_may_type_what(self) -> None:
        found: dict[str, set[str]] = {"everybody": set(), "engineers": set()}
        with board(str(build.find_program("host", "reflux-host")), key="pot_still") as console, contextlib.closing(Port(console)) as port:
            session = Session(port)
            session.machine_mode()
            for note in tables.notes("commands")["command"].values():
                for form, who, _ in note["forms"]:
                    for line in self.lines(form):
                        if not line.startswith(self.CHANGE_THE_SESSION):
                            found[who].add(self.answer(session, line))
        self.assertEqual(found["engineers"], {"LOCKED"})
        self.assertNotIn("LOCKED", found["everybody"])
        self.assertIn("ok", found["everybody"])

    @staticmethod
    def answer(session: Session, line: str) -> str:
        try:
            session.ask(line)
        except Refused as refusal:
            return str(refusal).split()[1]
        return "ok"


class Command(FolderTest):
    def setUp(self) -> None:
        super().setUp()
        tree = build.find_program("host", cmd_reference.PROGRAMS[0]).parent
        self.enterContext(mock.patch.object(build, "build", return_value=tree))

    def test_it_writes_the_pages_and_check_names_those_that_differ(self) -> None:
        self.assertEqual(call("reference", "--check", "--out", str(self.folder))[0], 1)
        self.assertEqual(call("reference", "--out", str(self.folder))[0], 0)
        self.assertEqual(call("reference", "--check", "--out", str(self.folder)), (0, "", ""))
        page = self.folder / "events.md"
        page.write_text(page.read_text(encoding="utf-8").replace("LINK_DOWN", "LINK_GONE"), encoding="utf-8")
        status, said, _ = call("reference", "--check", "--out", str(self.folder))
        self.assertEqual(status, 1)
        self.assertIn("events.md differs from the code", said)
        self.assertNotIn("commands.md", said)

    def test_a_file_is_no_folder(self) -> None:
        status, _, said = call("reference", "--out", str(self.file("x", "")))
        self.assertEqual(status, 2)
        self.assertIn("is a file", said)


class FromMemory(FolderTest):
    def test_each_marked_sentence_is_a_row_of_its_chip(self) -> None:
        (self.folder / "a_f1.c").write_text("/* Read in RM0041 6.1. It bites\n * at once (unverified). So\n * it is.\n *\n * Two sleep (unverified).\n */\n/* no (mark) */\n")
        (self.folder / "b.h").write_text("int x; /* It waits (unverified) */\n")
        text = board_page.virtual_board(self.folder)
        both, large, small = (text.split(f"\n## {section}\n")[1].split("\n## ")[0] for section in board_page.SECTIONS)
        self.assertIn("| It waits | `b.h` |", both)
        self.assertNotIn("`", large)
        self.assertIn("| It bites at once | `a_f1.c` |\n| Two sleep | `a_f1.c` |", small)

    def test_a_mark_that_ends_no_sentence_is_refused(self) -> None:
        for comment in ("/* It waits (unverified) and sleeps. */", "/* it waits (unverified). */"):
            with self.subTest(comment), self.assertRaisesRegex(UserError, "a.c: .*begins with a capital and ends with"):
                board_page.statements(comment, "a.c")

    def test_every_model_says_what_was_read_or_what_was_not(self) -> None:
        folder = board_page.SOURCES / "models"
        for path in folder.glob("*.c"):
            self.assertRegex(path.read_text(encoding="utf-8"), r"RM00\d\d Rev \d|\(unverified\)", path.name)


if __name__ == "__main__":
    unittest.main()
