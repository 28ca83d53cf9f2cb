"""tools/wheel: the wheel has programs, the libraries they need and their licences. It works in a root that has Python and nothing else: no
compiler, no headers, none of these libraries. Needs PyPI."""

import ctypes.util
import functools
import os
import re
import resource
import shutil
import subprocess
import tempfile
import time
import unittest
import zipfile
from pathlib import Path

from support import ROOT

from reflux.paths import build_root, every

FIRST_BLOCK = re.compile(r"^```python\n(.*?)^```$", re.M | re.S)
LIBRARIES = ("libjansson", "libserialport", "libsundials_cvode", "libsundials_kinsol")
PROGRAMS = ("libreflux.so", "libreflux_lab.so", "reflux-host", "reflux-sim")
OF_THE_ROOT = ("python3", "python3-venv", "libstdc++6")  # the last is for numpy of PyPI; apt brings it to every Debian
OF_THE_NETWORK = ("/etc/resolv.conf", "/etc/hosts", "/etc/nsswitch.conf", "/etc/pip.conf", "/etc/ssl/certs/ca-certificates.crt")
MERGED = ("bin", "sbin", "lib", "lib32", "lib64", "libx32")
LEFT_OUT = re.compile(r"/usr/share/(doc|man|locale|info|lintian)/")
FIRST_PLOT_S = 60
# Mounts exist in the namespace of this process alone, and go with it.
ENTER = 'mount --rbind /dev "$1/dev" && mount --rbind /proc "$1/proc" && exec chroot "$@"'


@functools.cache
def wheel() -> Path:
    """The wheel, built once."""
    folder = Path(tempfile.mkdtemp(prefix="reflux-wheel-"))
    unittest.addModuleCleanup(shutil.rmtree, folder, ignore_errors=True)
    said = subprocess.run([str(ROOT / "tools" / "wheel"), "--out", str(folder)], capture_output=True, text=True, check=False)
    if said.returncode:
        raise AssertionError(said.stdout + said.stderr)
    print(said.stdout, end="", flush=True)
    return every(folder, "*.whl")[0]


def ten_lines() -> str:
    """The first block of the page on Python."""
    found = FIRST_BLOCK.search((ROOT / "docs" / "use" / "python.md").read_text(encoding="utf-8"))
    assert found and "from reflux import Lab" in found[1] and "savefig" in found[1]
    return found[1]


class Contents(unittest.TestCase):
    def test_it_has_programs_that_may_be_run_plants_and_scenarios(self) -> None:
        with zipfile.ZipFile(wheel()) as archive:
            names = set(archive.namelist())
            modes = {name: archive.getinfo(name).external_attr >> 16 for name in names}
        for name in PROGRAMS:
            self.assertIn(f"reflux/programs/{name}", names)
        self.assertTrue(all(modes[name] & 0o111 for name in names if "/programs/reflux-" in name))
        for folder in ("plants", "scenarios"):
            files = {path.name for path in every(ROOT / "host_sim" / folder, "*.json", "*.toml", "*.conf", "*.wiring")}
            self.assertEqual({name.split("/")[-1] for name in names if name.startswith(f"reflux/{folder}/")}, files)
        modules = {path.relative_to(ROOT / "tools").as_posix() for path in every(ROOT / "tools" / "reflux", "**/*.py")}
        self.assertEqual({name for name in names if name.endswith(".py")}, modules)

    def test_it_has_the_libraries_and_a_licence_of_each(self) -> None:
        with zipfile.ZipFile(wheel()) as archive:
            names = archive.namelist()
            text = "".join(archive.read(name).decode() for name in names if ".dist-info/licenses/" in name)
        grafted = sorted(name.split("/")[1].rsplit("-", 1)[0] for name in names if name.startswith("reflux.libs/"))
        self.assertEqual(grafted, list(LIBRARIES))
        for words in ("Lawrence Livermore National Security", "Petri Lehtinen", "GNU LESSER GENERAL PUBLIC LICENSE", "GNU GENERAL PUBLIC LICENSE\n",
                      "libserialport", "Apache License"):
            self.assertIn(words, text)

    def test_it_is_built_without_unity_and_without_a_compiler_for_boards(self) -> None:
        wheel()
        tree = build_root() / "wheel" / "tree"
        self.assertIn("reflux_lab.so", (tree / "build.ninja").read_text(encoding="utf-8"))
        for file in ("build.ninja", "CMakeCache.txt"):
            for name in ("unity", "arm-none-eabi", "qemu"):
                self.assertNotIn(name, (tree / file).read_text(encoding="utf-8").lower().replace(str(ROOT).lower(), ""))

    def test_it_needs_nothing_else_than_the_c_library(self) -> None:
        self.assertRegex(wheel().name, r"^reflux-[0-9.]+-py3-none-manylinux_2_\d+_\w+\.whl$")


class Root:
    """A root folder with the files of these Debian packages, of what they depend on, and no other file of this system."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name in MERGED:
            if (Path("/") / name).is_symlink():
                (folder / "usr" / name).mkdir(parents=True)
                (folder / name).symlink_to(f"usr/{name}")
        for path in files_of(packages_below(OF_THE_ROOT)) + [Path(path) for path in OF_THE_NETWORK]:
            if path.is_file() and not LEFT_OUT.match(str(path)):
                copy = folder / path.relative_to("/")
                copy.parent.mkdir(parents=True, exist_ok=True)
                if not copy.exists():
                    follow = not path.is_symlink() or str(path) in OF_THE_NETWORK
                    shutil.copy2(path, copy, follow_symlinks=follow)
        for name in ("dev", "proc", "tmp", "root"):
            (folder / name).mkdir(exist_ok=True)

    def run(self, *command: str, **environment: str) -> subprocess.CompletedProcess:
        """Runs a command with this folder as its root."""
        user = [] if os.getuid() == 0 else ["--user", "--map-root-user"]
        network = {name: value for name, value in os.environ.items() if name.startswith("PIP_") or name.lower().endswith("_proxy") or "CERT" in name}
        return subprocess.run(["unshare", *user, "--mount", "sh", "-c", ENTER, "sh", str(self.folder), *command], stdin=subprocess.DEVNULL,
                              env={**network, "PATH": "/usr/bin:/bin:/usr/sbin:/sbin", "HOME": "/root", "LC_ALL": "C.UTF-8", **environment},
                              capture_output=True, text=True, errors="replace", check=False)


def packages_below(names: tuple[str, ...]) -> list[str]:
    """These packages and all that are installed of what they depend on."""
    said = subprocess.run(["dpkg-query", "-W", "-f", "${db:Status-Abbrev}\t${binary:Package}\t${Package}\t${Pre-Depends}, ${Depends}\n"],
                          capture_output=True, text=True, check=True).stdout
    rows = [line.split("\t") for line in said.splitlines() if line.startswith("ii")]
    full, needs = {row[2]: row[1] for row in rows}, {row[2]: row[3] for row in rows}
    found, todo = [], list(names)
    while todo:
        name = todo.pop()
        if name in full and full[name] not in found:
            found.append(full[name])
            todo += re.findall(r"(?:^|[,|])\s*([a-z0-9][a-z0-9+.-]+)", needs[name])
    return found


def files_of(packages: list[str]) -> list[Path]:
    said = subprocess.run(["dpkg-query", "-L", *packages], capture_output=True, text=True, check=True).stdout
    return [Path(line) for line in said.splitlines() if line.startswith("/")]


@unittest.skipUnless(shutil.which("dpkg-query"), "the root is made of Debian's packages, and this is another system")
class Installed(unittest.TestCase):
    """The wheel installed by pip into a virtual environment of that root."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.root = Root(Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="reflux-root-"))))
        said = cls.root.run("/usr/bin/python3", "--version")
        if said.returncode and re.search(r"[Pp]ermission denied|not permitted|unshare failed", said.stderr):
            raise unittest.SkipTest(f"this system does not let a process have a root of its own: {said.stderr.strip()}")
        shutil.copy(wheel(), cls.root.folder / "tmp")
        cls.must("/usr/bin/python3", "-m", "venv", "/opt/reflux")
        before, begun = processor_s(), time.monotonic()
        cls.must("/opt/reflux/bin/pip", "install", "--no-cache-dir", f"/tmp/{wheel().name}")
        installed = time.monotonic()
        (cls.root.folder / "tmp" / "first.py").write_text(ten_lines(), encoding="utf-8")
        cls.must("/opt/reflux/bin/python", "/tmp/first.py", MPLBACKEND="Agg")
        took_s, cls.processor_s = time.monotonic() - begun, processor_s() - before
        print(f"from pip install to the first plot: {took_s:.1f} s ({installed - begun:.1f} s of it pip), {cls.processor_s:.1f} s of processor "
              f"time; the wheel has {wheel().stat().st_size / 1e6:.1f} MB", flush=True)

    @classmethod
    def must(cls, *command: str, **environment: str) -> str:
        """What a command says in the root, in which it must not fail."""
        said = cls.root.run(*command, **environment)
        if said.returncode:
            raise AssertionError(f"{' '.join(command)}: status {said.returncode}\n{said.stdout[-3000:]}{said.stderr[-3000:]}")
        return said.stdout

    def within(self, path: Path) -> str:
        return f"/{path.relative_to(self.root.folder)}"

    def test_the_root_has_no_compiler_no_headers_and_none_of_the_libraries(self) -> None:
        own = "/usr/bin:/bin:/usr/sbin:/sbin".split(":")
        for name in ("cc", "gcc", "c99", "ld", "cmake", "ninja", "make", "pkg-config", "qemu-system-arm", "arm-none-eabi-gcc"):
            self.assertIsNone(shutil.which(name, path=os.pathsep.join(f"{self.root.folder}{place}" for place in own)), name)
        self.assertFalse((self.root.folder / "usr" / "include").exists())
        for name in LIBRARIES:
            self.assertTrue(ctypes.util.find_library(name.removeprefix("lib")), f"{name} is not on this system either: the test proves nothing")
            outside = [path for path in self.root.folder.rglob(f"{name}*.so*") if "reflux.libs" not in path.parts]
            self.assertEqual(outside, [])

    def test_the_ten_lines_of_the_page_leave_their_picture_in_time(self) -> None:
        """Processor time, because a test does not need the machine to be idle."""
        self.assertTrue((self.root.folder / "first.png").read_bytes().startswith(b"\x89PNG"))
        self.assertLess(self.processor_s, FIRST_PLOT_S)

    def test_the_programs_load_the_libraries_of_the_wheel(self) -> None:
        place = every(self.root.folder / "root/reflux/lib", "python3*/site-packages/reflux/programs")[0]
        loader = every(self.root.folder / "usr", "lib*/ld-linux*", "lib/*/ld-linux*")[0]
        for name in ("reflux-sim", "reflux-sim-memory", "libreflux_lab.so"):
            said = self.must(self.within(loader), "--list", self.within(place / name))
            self.assertNotIn("not found", said)
            self.assertEqual(len(re.findall(r"=> /opt/reflux/\S*/reflux\.libs/lib", said)), len(LIBRARIES), said)

    def test_the_command_has_the_tools_of_users_and_the_rest_is_refused(self) -> None:
        said = self.must("/opt/reflux/bin/reflux", "--help")
        for name in ("run", "demo", "play", "commission", "console", "column"):
            self.assertRegex(said, rf"(?m)^  {name} ")
        self.assertNotIn("development", said)
        self.assertIn("usage: reflux commission", self.must("/opt/reflux/bin/reflux", "commission", "--help"))
        refused = self.root.run("/opt/reflux/bin/reflux", "test")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("an installed package does not have it", refused.stderr)

    def test_a_run_has_the_log_of_the_repository_bit_for_bit(self) -> None:
        said = self.must("/opt/reflux/bin/reflux", "run", "demo", "--out", "/tmp/demo")
        self.assertIn("the host build runs the scenario", said)
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            here = subprocess.run([str(ROOT / "tools" / "run"), "demo", "--firmware", "host", "--out", folder, "--no-report"], capture_output=True, check=False)
            self.assertEqual(here.returncode, 0, here.stderr)
            same = subprocess.run([str(ROOT / "tools" / "run"), "--compare", folder, str(self.root.folder / "tmp" / "demo")], capture_output=True,
                                  text=True, check=False)
        self.assertEqual(same.returncode, 0, same.stdout)
        self.assertIn("reflux run demo --firmware host", (self.root.folder / "tmp" / "demo" / "report.html").read_text(encoding="utf-8"))

    def test_a_start_up_keeps_its_loops(self) -> None:
        said = self.must("/opt/reflux/bin/reflux", "commission", "--plant", "wood-berry", "--yes", "--out", "/tmp/start-up")
        self.assertRegex(said, r"(?m)^xD auto .*\nxB auto ")
        self.assertNotIn("tools/", said)

    def test_the_console_of_a_board_in_a_process_answers(self) -> None:
        script = "from reflux import Lab; import reflux; lab = Lab('wood-berry'); print(lab.command('status')); print(reflux.rga([[2, 1], [1, 2]]))"
        self.assertIn("1.333", self.must("/opt/reflux/bin/python", "-c", script))


def processor_s() -> float:
    """Processor time of everything that was started here and has ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    unittest.main()
