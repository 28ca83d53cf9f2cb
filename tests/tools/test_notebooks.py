"""Notebooks of docs/notebooks: files as Jupyter writes them, without stored output; their cells run in order, and the figures that the last one prints
make sense. In one fresh Python process for each notebook, without Jupyter; with the argument `all` (full tier) by nbclient in a virtual environment
too, where PyPI can be reached.
"""

import copy
import json
import os
import re
import resource
import subprocess
import sys
import unittest
from pathlib import Path

from support import ROOT, FolderTest, from_pypi

from reflux import build
from reflux.environment import clean
from reflux.paths import every

sys.path.append(str(ROOT / "tests" / "support"))
import sample  # noqa: E402

NOTEBOOKS = {path.stem: path for path in every(ROOT / "docs" / "notebooks", "*.ipynb")}
MARKDOWN = {"cell_type", "metadata", "source"}
CODE = {*MARKDOWN, "execution_count", "outputs"}
METADATA = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}, "language_info": {"name": "python"}}
WORDS_MAX = 400  # of prose
PROCESSOR_S_MAX = 30.0  # all notebooks together
HANG_S = 600
PICTURES = {"exercise": 6, "splitter": 2, "wood-berry": 5}
LAST = "==== last cell, pictures:"

# Runs the cells of argv[1] as a kernel does, and shows no window.
WITHOUT_JUPYTER = f"""
import json, sys
import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt

with open(sys.argv[1], encoding="utf-8") as file:
    cells = [cell for cell in json.load(file)["cells"] if cell["cell_type"] == "code"]
names, pictures = {{"__name__": "__main__"}}, 0
for number, cell in enumerate(cells, 1):
    if cell is cells[-1]:
        print("{LAST}", pictures)
    exec(compile("".join(cell["source"]), f"code cell {{number}}", "exec"), names)
    for k in plt.get_fignums():
        plt.figure(k).canvas.draw()
        pictures += 1
    plt.close("all")
"""

# The same by a kernel of Jupyter.
WITH_JUPYTER = f"""
import sys
import nbclient, nbformat

book = nbformat.read(sys.argv[1], as_version=nbformat.NO_CONVERT)
nbformat.validate(book)
nbclient.NotebookClient(book, timeout={HANG_S}, kernel_name="python3").execute()
outputs = [cell.outputs for cell in book.cells if cell.cell_type == "code"]
print("{LAST}", sum("image/png" in out.get("data", {{}}) for some in outputs for out in some))
print("".join(out.text for out in outputs[-1] if out.output_type == "stream" and out.name == "stdout"), end="")
"""


def faults(text: str) -> list[str]:
    """What is wrong with the text of a notebook, a sentence each."""
    book = json.loads(text)
    out = []
    if set(book) != {"cells", "metadata", "nbformat", "nbformat_minor"} or (book["nbformat"], book["nbformat_minor"]) != (4, 4):
        return ["it is not of the format 4.4"]
    if book["metadata"] != METADATA:
        out.append(f"its metadata are not {METADATA}")
    if not {cell["cell_type"] for cell in book["cells"]} == {"markdown", "code"}:
        out.append("it has no cells of prose, or none of code, or others")
    for number, cell in enumerate(book["cells"], 1):
        code = cell["cell_type"] == "code"
        if set(cell) != (CODE if code else MARKDOWN) or cell["metadata"]:
            out.append(f"cell {number} has other keys than {sorted(CODE if code else MARKDOWN)}, or metadata")
        if code and cell.get("outputs"):
            out.append(f"cell {number} has stored output")
        if code and cell.get("execution_count") is not None:
            out.append(f"cell {number} has an execution count")
        source = cell.get("source")
        if not (isinstance(source, list) and source and all(isinstance(line, str) for line in source)):
            out.append(f"cell {number} has no lines")
        elif not all(line.endswith("\n") and line.count("\n") == 1 for line in source[:-1]) or "\n" in source[-1]:
            out.append(f"the lines of cell {number} do not end as lines")
    if text != json.dumps(book, indent=1, sort_keys=True, ensure_ascii=False) + "\n":
        out.append("it is not written as Jupyter writes: one space of indent, keys in order")
    return out


def sources(name: str, kind: str) -> list[str]:
    cells = json.loads(NOTEBOOKS[name].read_text(encoding="utf-8"))["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == kind]


def of_jupyter(folder: Path) -> dict[str, str]:
    """Nothing of the user's settings of Jupyter and matplotlib; pictures stand below their cells, as the kernel draws them by itself."""
    ours = clean(os.environ)
    del ours["MPLBACKEND"]
    places = ("MPLCONFIGDIR", "IPYTHONDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR")
    return {**ours, **dict.fromkeys(places, str(folder))}


def run(python: str, program: str, notebook: Path, folder: Path, environment: dict[str, str]) -> tuple[int, str]:
    """Number of pictures, and what the last cell printed."""
    said = subprocess.run([python, "-W", "error::SyntaxWarning", "-c", program, str(notebook)], cwd=folder, capture_output=True, text=True,
                          env={**environment, "PYTHONPATH": str(ROOT / "tools")}, timeout=HANG_S, check=False)
    if said.returncode != 0:
        raise AssertionError(f"{notebook.name}: {said.stderr}")
    pictures, _, printed = said.stdout.partition(LAST)[2].partition("\n")
    return int(pictures), printed


def setUpModule() -> None:
    build.build("host", ("reflux-sim", "libreflux", "libreflux_lab"), quiet=True)


class Files(unittest.TestCase):
    def test_the_three_are_there(self) -> None:
        self.assertEqual(sorted(NOTEBOOKS), sorted(PICTURES))

    def test_they_are_whole_and_hold_no_output(self) -> None:
        for name, path in NOTEBOOKS.items():
            self.assertEqual(faults(path.read_text(encoding="utf-8")), [], name)

    def test_faults_are_found(self) -> None:
        whole = json.loads(NOTEBOOKS["splitter"].read_text(encoding="utf-8"))
        first = next(k for k, cell in enumerate(whole["cells"]) if cell["cell_type"] == "code")
        for change, wanted in (({"outputs": [{"output_type": "stream", "name": "stdout", "text": ["1\n"]}]}, f"cell {first + 1} has stored output"),
                               ({"execution_count": 3}, f"cell {first + 1} has an execution count"),
                               ({"metadata": {"scrolled": True}}, f"cell {first + 1} has other keys than {sorted(CODE)}, or metadata"),
                               ({"source": ["import os", "print()"]}, f"the lines of cell {first + 1} do not end as lines"),
                               ({"source": []}, f"cell {first + 1} has no lines")):
            book = copy.deepcopy(whole)
            book["cells"][first].update(change)
            self.assertEqual(faults(json.dumps(book, indent=1, sort_keys=True, ensure_ascii=False) + "\n"), [wanted])
        self.assertEqual(faults(json.dumps(whole)), ["it is not written as Jupyter writes: one space of indent, keys in order"])
        self.assertEqual(faults(json.dumps({**whole, "nbformat": 3})), ["it is not of the format 4.4"])

    def test_the_prose_is_short(self) -> None:
        for name in NOTEBOOKS:
            self.assertLessEqual(sum(len(text.split()) for text in sources(name, "markdown")), WORDS_MAX, name)

    def test_the_model_is_that_of_the_plant(self) -> None:
        data = json.loads((ROOT / "host_sim" / "plants" / "wood-berry.json").read_text(encoding="utf-8"))
        (cell,) = [text for text in sources("wood-berry", "code") if text.startswith("gain = ")]
        for name, key in (("gain", "gain"), ("lag_s", "lags"), ("dead_s", "dead_time")):
            printed = re.search(rf"^{name} = (?:60 \* )?np\.array\((\[\[.*?\]\])\)", cell, re.M)
            assert printed is not None
            self.assertEqual(json.loads(printed[1]), [[element[key] for element in row] for row in data["elements"]], name)

    def test_the_exercise_asks_five_questions_and_hides_no_answer(self) -> None:
        prose, code = sources("exercise", "markdown"), sources("exercise", "code")
        self.assertEqual([title for text in prose for title in re.findall(r"^## (\d)\.", text, re.M)], list("12345"))
        self.assertEqual([title for text in prose for title in re.findall(r"^\*\*(\d)\.\*\*", text, re.M)], list("12345"))
        blanks = [k for k, text in enumerate(code) if "..." in text]
        self.assertEqual(blanks, list(range(1, 7)))  # after the imports; solutions have none
        self.assertLess(prose.index(next(text for text in prose if text.startswith("## 5."))), prose.index(next(text for text in prose if "## Solutions" in text)))


class Runs(FolderTest):
    """What each notebook prints in the end."""

    def judge(self, name: str, pictures: int, printed: str) -> None:
        self.assertEqual(pictures, PICTURES[name], name)
        getattr(self, f"judge_{name.replace('-', '_')}")(printed)

    def figures(self, pattern: str, printed: str, lines: int) -> dict[str, list[float]]:
        """Numbers of each line that the pattern matches, by its first group."""
        found = {match[1]: [float(x) for x in match.groups()[1:]] for match in re.finditer(pattern, printed, re.M)}
        self.assertEqual(len(found), lines, printed)
        return found

    def judge_wood_berry(self, printed: str) -> None:
        self.assertEqual(printed.splitlines()[0], "pairing R-xD, S-xB kept")
        iae = self.figures(r"^([\w-]+): IAE of xD (\S+) %w s, of xB (\S+) %w s$", printed, 2)
        for ours, theirs in zip(iae["start-up"], iae["designed"]):
            self.assertLess(ours, 1.1 * theirs)
            self.assertLess(theirs, 0.2 * 4 * 3600.0)  # a part of the error of 1 %w for four hours, which no control would leave

    def judge_splitter(self, printed: str) -> None:
        fast, slow = printed.split("lag of the thermometers 180 s\n")
        pattern = r"^(\w+): IAE (\S+) at the top, (\S+) at the bottom \(1e-3 h\), duty moved (\S+) Mcal/h$"
        laws, late = self.figures(pattern, fast, 4), self.figures(pattern, slow, 2)
        self.assertEqual(laws["manual"][2], 0.0)
        for law in ("PI", "cascade", "clf"):
            self.assertLess(laws[law][0], 0.1 * laws["manual"][0], law)
            self.assertLess(laws[law][1], 0.1 * laws["manual"][1], law)
        self.assertLess(laws["clf"][0], 0.95 * laws["PI"][0])
        self.assertLess(laws["cascade"][1], 0.9 * laws["PI"][1])
        self.assertLess(laws["PI"][2], laws["cascade"][2])
        self.assertLess(laws["cascade"][2], laws["clf"][2])
        for k in range(3):
            self.assertGreater(late["clf"][k], 1.5 * laws["clf"][k])

    def judge_exercise(self, printed: str) -> None:
        loops = self.figures(r"^(by hand|automatic): gain (\S+), ti (\S+) s, IAE (\S+) degC s, heater moved (\S+) kW$", printed, 2)
        self.assertLess(loops["automatic"][0], loops["by hand"][0])
        self.assertLess(loops["automatic"][1], loops["by hand"][1])
        self.assertLess(loops["automatic"][2], 0.8 * loops["by hand"][2])
        self.assertLess(loops["automatic"][3], loops["by hand"][3])
        hottest = self.figures(r"^hottest T10 (\w+) lock2: (\S+) degC$", printed, 2)
        self.assertGreater(hottest["without"][0], 118.0)
        self.assertLess(hottest["with"][0], 112.0)
        self.assertGreater(hottest["with"][0], 106.0)

    def test_each_runs_in_a_fresh_process_without_jupyter(self) -> None:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        for name, path in NOTEBOOKS.items():
            with self.subTest(name):
                self.judge(name, *run(sys.executable, WITHOUT_JUPYTER, path, self.folder, clean(os.environ)))
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.assertLess(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, PROCESSOR_S_MAX)

    def test_a_cell_that_fails_is_named(self) -> None:
        book = json.loads(NOTEBOOKS["splitter"].read_text(encoding="utf-8"))
        next(cell for cell in book["cells"] if cell["cell_type"] == "code")["source"] = ["1 / 0"]
        path = self.file("broken.ipynb", json.dumps(book))
        with self.assertRaisesRegex(AssertionError, r'(?s)^broken\.ipynb: .*"code cell 1", line 1.*ZeroDivisionError'):
            run(sys.executable, WITHOUT_JUPYTER, path, self.folder, clean(os.environ))

    @unittest.skipUnless(sample.EVERY, "in Jupyter in the full tier: test_notebooks.py all")
    def test_each_runs_in_jupyter_with_pandas(self) -> None:
        python = from_pypi(self.folder, "ipykernel", "nbclient", "nbformat")
        for name, path in NOTEBOOKS.items():
            with self.subTest(name):
                self.judge(name, *run(python, WITH_JUPYTER, path, self.folder, of_jupyter(self.folder)))


if __name__ == "__main__":
    unittest.main()
