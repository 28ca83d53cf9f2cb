"""Build trees for faults: what the tests run, with single objects replaced, and nothing built that is not run.

A fault never touches the sources. The changed text is compiled beside them (a .c file with #line, a header by a folder
that is looked into first), and the programs of a test are linked once more with the changed objects.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import resource
import shlex
import shutil
import signal
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path

from reflux import build
from reflux.errors import RunFailed
from reflux.paths import ROOT, build_root, shown
from dev.testing import ctest_files

# Notice at once what the sanitizers of tools/test would notice, for little time and without their libraries.
CHECKED = ("-O1", "-fstack-protector-strong", "-D_FORTIFY_SOURCE=2", "-fsanitize=undefined",
           "-fsanitize-undefined-trap-on-error")
COMPARED = ("-O2", "-g0")
FORMATS = {"float": "OFF", "fixed": "ON"}
LONGEST_OUTPUT = 256 << 20
STALLED_S = 60.0  # no processor time for so long: it waits for something that does not come


@dataclass(frozen=True)
class Test:
    """One entry of ctest; programs are those files of the build tree that its command names."""

    name: str
    command: tuple[str, ...]
    folder: str
    environment: tuple[str, ...]
    programs: tuple[str, ...]


@dataclass
class Outcome:
    """passed, or what happened instead; and the processor time of the test and of all it started."""

    trouble: str | None
    cpu_s: float


@dataclass
class Unit:
    """One object of the tree and how it is compiled."""

    source: Path
    target: str
    command: list[str]
    inputs: set[Path] = field(default_factory=set)


def unity() -> Path:
    folder = ROOT / "build" / "unity"
    if not (folder / "unity.c").is_file():
        build.configure("host")
    return folder


class Tree:
    """build/mutants/NAME: NAME is float or fixed, with -lines where the lines that are reached are counted."""

    compared = COMPARED
    strip = "strip"

    def __init__(self, name: str):
        self.name = name
        self.format, _, self.counts_lines = name.partition("-")
        self.folder = build_root() / "mutants" / name
        self._links: dict[str, list[str]] = {}
        self._units: list[Unit] | None = None
        self.built = False

    def configure(self) -> None:
        """Makes the build tree, or brings what CMake wrote there up to date."""
        with build.locked(self.folder):
            self._configure()

    def _configure(self) -> None:
        if (self.folder / "build.ninja").is_file():
            self._must(["ninja", "-C", str(self.folder), "build.ninja"], f"bringing {shown(self.folder)} up to date")
            return
        flags = ["--coverage"] if self.counts_lines else CHECKED
        command = ["cmake", "-S", str(ROOT), "-B", str(self.folder), "-G", "Ninja", f"-DCMAKE_C_FLAGS=-w {' '.join(flags)}",
                   "-DCMAKE_BUILD_TYPE=", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON",
                   f"-DREFLUX_FIXED_POINT={FORMATS[self.format]}", f"-DUNITY_DIR={unity()}"]
        if self.counts_lines:
            command.append("-DCMAKE_EXE_LINKER_FLAGS=-Wl,-u,__gcov_dump")
        self._must(command, f"configuring {shown(self.folder)}")

    def build(self, targets: tuple[str, ...] = ()) -> None:
        """Builds the targets, or everything."""
        command = ["cmake", "--build", str(self.folder)] + (["--target", *targets] if targets else [])
        with build.locked(self.folder):
            self._configure()
            progress = build.Progress(f"building {self.name}")
            progress.show("...")
            self._must(command, f"building {shown(self.folder)}")
            progress.end("done")
        self.built = not targets
        self._units = None
        self._links.clear()

    @staticmethod
    def _must(command: list[str], what: str) -> str:
        answer = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
        if answer.returncode != 0:
            lines = [x for x in (answer.stdout + answer.stderr).splitlines() if x.strip()]
            told = next((x for x in lines if "error:" in x.lower()), lines[-1] if lines else "?")
            raise RunFailed(f"{what}: {told}")
        return answer.stdout

    # --- what there is -------------------------------------------------------------------------------

    def tests(self) -> list[Test]:
        """Tests that ctest knows here and that run something of this tree. Read from its files: of a program that is not
        built yet ctest itself tells no command."""
        self.configure()
        out = []
        for entry in ctest_files.entries(self.folder):
            if programs := entry.programs(self.folder):
                out.append(Test(entry.name, entry.command, entry.properties.get("WORKING_DIRECTORY", str(entry.folder)),
                                tuple(entry.items("ENVIRONMENT")), programs))
        return out

    def target_of(self, program: str) -> str:
        return os.path.relpath(program, self.folder)

    def units(self) -> list[Unit]:
        """All objects; their headers are known once they are built."""
        if self._units is None:
            with (self.folder / "compile_commands.json").open(encoding="utf-8") as f:
                entries = json.load(f)
            found = {}
            for entry in entries:
                command = build.compiler_words(entry["command"])
                target = command[command.index("-o") + 1]
                found[target] = Unit(Path(entry["file"]).resolve(), target, command)
            for target, inputs in self._dependencies().items():
                if target in found:
                    found[target].inputs = inputs
            self._units = list(found.values())
        return self._units

    def _dependencies(self) -> dict[str, set[Path]]:
        text = self._must(["ninja", "-C", str(self.folder), "-t", "deps"], "reading what depends on what")
        out: dict[str, set[Path]] = {}
        current: set[Path] = set()
        known: dict[str, Path] = {}
        for line in text.splitlines():
            if line.startswith("    "):
                name = line.strip()
                if name.startswith(("/usr/", "/lib/")):
                    continue
                if name not in known:
                    known[name] = (self.folder / name).resolve()
                current.add(known[name])
            elif ": #deps" in line:
                current = out.setdefault(line.split(":")[0], set())
        return out

    def units_of(self, source: Path) -> list[Unit]:
        """The objects that contain this file; those of the firmware's own libraries first. Of a header this is known
        only once everything is built."""
        if source.suffix == ".h" and not self.built:
            self.build()
        found = [u for u in self.units() if u.source == source or source in u.inputs]
        return sorted(found, key=lambda u: (not u.target.startswith("firmware/"), "_double.dir" in u.target, u.target))

    # --- building with a fault -----------------------------------------------------------------------

    def compile(self, unit: Unit, changed: Path, text: str, place: Path, compared: bool = False) -> Path | None:
        """The object of this unit with text in place of the file changed; None where it does not compile."""
        place.mkdir(parents=True, exist_ok=True)
        name = hashlib.sha256(unit.target.encode()).hexdigest()[:16]
        target = place / f"{name}{'-compared' if compared else ''}.o"
        command = [c for c in unit.command if not (compared and (c.startswith(("-fsanitize", "-D_FORTIFY")) or c in CHECKED))]
        first, source = [], unit.source
        if unit.source == changed:
            source = place / unit.source.name
            source.write_text(f'#line 1 "{unit.source}"\n{text}', encoding="utf-8")
            first = ["-iquote", str(unit.source.parent)]
        else:
            overlay = place / "overlay" / changed.parent.name
            overlay.mkdir(parents=True, exist_ok=True)
            (overlay / changed.name).write_text(f'#line 1 "{changed}"\n{text}', encoding="utf-8")
            first = ["-I", str(overlay.parent)]
            if changed.suffix == ".c":  # a test has it in its own file
                first += ["-iquote", str(overlay)]
        out = [command[0], *first]
        at = 1
        while at < len(command):
            if command[at] == "-o":
                out += ["-o", str(target)]
                at += 2
                continue
            if command[at] in ("-MD", "-MMD"):
                at += 1
                continue
            if command[at] in ("-MT", "-MF"):
                at += 2
                continue
            out.append(str(source) if _same(command[at], unit.source) else command[at])
            at += 1
        out += ("-w", *(self.compared if compared else ()))
        answer = subprocess.run(out, cwd=self.folder, stdin=subprocess.DEVNULL, capture_output=True, check=False)
        return target if answer.returncode == 0 else None

    def code(self, unit: Unit, changed: Path, text: str, place: Path) -> bytes | None:
        """The machine code and data of this unit with that text, without names and line numbers. None: not C."""
        target = self.compile(unit, changed, text, place, compared=True)
        if target is None:
            return None
        subprocess.run([self.strip, "--strip-unneeded", str(target)], check=True, capture_output=True)
        content = target.read_bytes()
        target.unlink()
        return content

    def link_command(self, program: str) -> list[str]:
        target = self.target_of(program)
        if target not in self._links:
            line = self._must(["ninja", "-C", str(self.folder), "-t", "commands", "-s", target], f"linking {target}").strip()
            line = re.sub(r"^: && | && :$", "", line)
            self._links[target] = shlex.split(line)
        return self._links[target]

    def linked(self, program: str, units: list[Unit]) -> list[Unit]:
        """Those of the units that could be in this program."""
        words = set(self.link_command(program))
        return [u for u in units if u.target in words or _archive(u.target) in words]

    def link(self, program: str, objects: dict[str, Path], place: Path) -> Path | None:
        """The program with these objects in place of its own; None where it does not link. Those of an archive stand in a copy of
        it, so that of it the program has what it asks for, as ever."""
        place.mkdir(parents=True, exist_ok=True)
        target = place / Path(program).name
        out: list[str] = []
        words = self.link_command(program)
        archives = {word: self._archived(word, objects, place) for word in words if word.endswith(".a")}
        at = 0
        while at < len(words):
            word = words[at]
            if word == "-o":
                out += ["-o", str(target)]
                at += 2
                continue
            out.append(str(objects[word]) if word in objects else archives.get(word, word))
            at += 1
        answer = subprocess.run(out, cwd=self.folder, stdin=subprocess.DEVNULL, capture_output=True, check=False)
        return target if answer.returncode == 0 else None

    def _archived(self, archive: str, objects: dict[str, Path], place: Path) -> str:
        """This archive, or a copy of it with these objects in place of its own members."""
        members = {Path(name).name: path for name, path in objects.items() if _archive(name) == archive}
        if not members:
            return archive
        made = place / archive.replace("/", "-")
        shutil.copyfile(self.folder / archive, made)
        for member, path in members.items():
            shutil.copyfile(path, place / member)
        subprocess.run(["ar", "rs", str(made), *(str(place / member) for member in members)], check=True, capture_output=True)
        return str(made)

    # --- running -------------------------------------------------------------------------------------

    def run(self, test: Test, place: Path, instead: dict[str, Path] | None = None, cpu_limit_s: float | None = None) -> Outcome:
        """Runs a test, with other programs where instead names them. The limit is processor time, of each process."""
        command = [str((instead or {}).get(c, c)) for c in test.command]
        environment = {**os.environ, **dict(pair.split("=", 1) for pair in test.environment)}

        def limits() -> None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (LONGEST_OUTPUT, LONGEST_OUTPUT))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            if cpu_limit_s is not None:
                seconds = int(cpu_limit_s + 1.0)
                resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))

        place.mkdir(parents=True, exist_ok=True)
        with (place / "output.txt").open("wb") as output:
            process = subprocess.Popen(command, cwd=test.folder, env=environment, stdin=subprocess.DEVNULL, stdout=output,
                                       stderr=subprocess.STDOUT, preexec_fn=limits, start_new_session=True)
            try:
                stalled, status, used = self._wait(process.pid)
            finally:
                _end_group(process.pid)
            process.returncode = os.waitstatus_to_exitcode(status)
        trouble = None
        if stalled:
            trouble = "waits for ever"
        elif process.returncode == -signal.SIGXCPU or (process.returncode == -signal.SIGKILL and cpu_limit_s is not None):
            trouble = f"does not end within {cpu_limit_s:.0f} s of processor time"
        elif process.returncode < 0:
            trouble = signal.Signals(-process.returncode).name
        elif process.returncode > 0:
            trouble = _first_failure(place / "output.txt")
        return Outcome(trouble, used)

    @staticmethod
    def _wait(pid: int) -> tuple[bool, int, float]:
        """Until the process ends; a group that has used no processor time for STALLED_S seconds is ended."""
        last_used, since, pause = -1.0, time.monotonic(), 0.002
        stalled = False
        while True:
            ended, status, usage = os.wait4(pid, os.WNOHANG)
            if ended:
                return stalled, status, usage.ru_utime + usage.ru_stime
            time.sleep(pause)
            pause = min(0.05, 1.2 * pause)
            now = time.monotonic()
            if now - since < STALLED_S:
                continue
            used, ready = _group_use(pid)
            if used - last_used < 0.1 and not ready and last_used >= 0.0:
                stalled = True
                _end_group(pid)
            last_used, since = used, now


def _same(word: str, source: Path) -> bool:
    return word.endswith(source.name) and Path(word).resolve() == source


def _archive(target: str) -> str:
    """firmware/num/CMakeFiles/reflux_num.dir/svd.c.o goes into firmware/num/libreflux_num.a."""
    folder, _, rest = target.partition("/CMakeFiles/")
    return f"{folder}/lib{rest.partition('.dir/')[0]}.a"


def _group_use(pid: int) -> tuple[float, bool]:
    """Processor time of the process group so far, s; and whether one of it could run now."""
    ticks, ready = 0, False
    for entry in os.listdir("/proc"):
        if not entry.isdigit():
            continue
        try:
            with open(f"/proc/{entry}/stat", encoding="utf-8", errors="replace") as f:
                fields = f.read().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[2]) == pid:
            ticks += sum(int(x) for x in fields[11:15])
            ready = ready or fields[0] == "R"
    return ticks / os.sysconf("SC_CLK_TCK"), ready


def _end_group(pid: int) -> None:
    try:
        os.killpg(pid, signal.SIGKILL)
    except (ProcessLookupError, PermissionError):
        pass


def _first_failure(output: Path) -> str:
    for line in output.read_text(encoding="utf-8", errors="replace").splitlines():
        if ":FAIL" in line or line.startswith(("FAIL:", "ERROR:")) or "Error" in line:
            return " ".join(line.split(":")[-3:]).strip()[:160] if ":FAIL" in line else line.strip()[:160]
    return "fails"


def clear(place: Path) -> None:
    shutil.rmtree(place, ignore_errors=True)
