"""tools/style: clang-format, clang-tidy and the static analyzer of clang-tidy over the C sources.

The analyzer takes nine tenths of clang-tidy's time, so it is a check of its own. A file that passed is not looked at again
until it, a header it includes, its compile command or the configuration changes.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from reflux import build
from reflux.boards import BOARDS
from reflux.errors import RunFailed
from reflux.paths import ROOT, build_root

FORMATTED = ("firmware", "hal", "host_sim", "tests", "tools/libreflux")
TIDIED = ("firmware", "hal", "host_sim", "tools/libreflux")
PRESETS = ("host", *BOARDS)
CHECKS = {"clang-tidy": "-clang-analyzer-*", "clang-analyzer": "-*,clang-analyzer-*,-clang-analyzer-security.insecureAPI.DeprecatedOrUnsafeBufferHandling"}
CROSS = ["--target=arm-none-eabi", "-isystem", "/usr/lib/picolibc/arm-none-eabi/include"]
UNKNOWN_TO_CLANG = ("--specs=", "-fcallgraph-info", "-fstack-usage", "-fno-math-errno", "-fanalyzer",
                    "-Wa,", "-fno-tree-",
                    "-fno-inline-functions-called-once", "-fconserve-stack")


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(prog="tools/style", description="Checks the C sources' style. Changes nothing.")
    p.add_argument("what", choices=("clang-format", *CHECKS), help="clang-analyzer: the checks clang-analyzer-* of clang-tidy; clang-tidy: all others")
    p.add_argument("-j", "--jobs", type=int, default=os.cpu_count() or 2, metavar="N")
    p.add_argument("--changed", action="store_true", help="only sources that differ from the upstream branch, or from the last commit but one")
    options = p.parse_args(arguments)
    if options.what == "clang-format":
        return check_format()
    return check_tidy(options.what, max(1, options.jobs), options.changed)


def check_format() -> int:
    files = [str(f) for folder in FORMATTED for f in sorted((ROOT / folder).rglob("*.[ch]"))]
    if not files:
        return 0
    _need("clang-format")
    status = subprocess.run(["clang-format", "--dry-run", "-Werror", *files], cwd=ROOT, check=False).returncode
    print(f"clang-format: {len(files)} files, {'all as .clang-format says' if status == 0 else 'see above'}")
    return 1 if status else 0


def check_tidy(what: str, jobs: int, only_changed: bool) -> int:
    _need("clang-tidy")
    work = [entry for preset in PRESETS for entry in compile_commands(preset)]
    seen: set[str] = set()
    unique = [e for e in work if not (e["file"] in seen or seen.add(e["file"]))]
    if only_changed:
        files = changed_sources()
        unique = [e for e in unique if os.path.relpath(e["file"], ROOT) in files]
    folder = build_root() / "tidy"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "compile_commands.json").write_text(json.dumps(unique), encoding="utf-8")
    with ThreadPoolExecutor(jobs) as pool:
        results = list(pool.map(lambda entry: tidy(what, entry, folder), unique))
    failed = [entry["file"] for entry, good in zip(unique, results) if not good]
    for name in failed:
        print(f"{what}: {os.path.relpath(name, ROOT)} failed")
    print(f"{what}: {len(unique)} files, {len(failed)} with findings")
    return 1 if failed else 0


def changed_sources() -> set[str]:
    """Sources that differ from where this branch left its upstream; where it has none, or is there, from the last commit but one.

    Without git, and in a clone without that commit, nothing has changed.
    """
    def git(*words: str) -> list[str]:
        try:
            answer = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False)
        except FileNotFoundError:
            return []
        return answer.stdout.splitlines() if answer.returncode == 0 else []

    head, base = git("rev-parse", "HEAD"), git("merge-base", "HEAD", "@{upstream}")
    since = base[0] if base and base != head else "HEAD~1"
    return set(git("diff", "--name-only", since, "--")) | set(git("ls-files", "--others", "--exclude-standard"))


def compile_commands(preset: str) -> list[dict[str, str]]:
    """The entries of our own sources, with what clang does not understand left out. Sources of a layer are
    compiled more than once (float, double); the first way counts."""
    path = build.configure(preset) / "compile_commands.json"
    try:
        entries = json.loads(path.read_text(encoding="utf-8"))
    except OSError:
        raise RunFailed(f"there is no {path}, though {preset} was configured") from None
    folders = tuple(f"{ROOT}/{name}/" for name in TIDIED)
    out = []
    for entry in entries:
        if not entry["file"].startswith(folders) or not entry["file"].endswith(".c"):
            continue
        words = [w for w in build.compiler_words(entry["command"]) if not w.startswith(UNKNOWN_TO_CLANG)]
        if "arm-none-eabi" in words[0]:
            words[1:1] = CROSS
        words[0] = "clang"
        out.append({"directory": entry["directory"], "file": entry["file"], "command": shlex.join(words)})
    return out


def tidy(what: str, entry: dict[str, str], folder: Path) -> bool:
    stamp = folder / f"{key(what, entry)}.passed"
    if stamp.exists():
        return True
    # gcc's own optimisation flags mean nothing to clang, and gcc judges the warnings of compilation.
    answer = subprocess.run(["clang-tidy", "--quiet", f"--checks={CHECKS[what]}", "--extra-arg=-Wno-ignored-optimization-argument",
                             "--extra-arg=-Wno-error", "-p",
                             str(folder), entry["file"]], capture_output=True, text=True, check=False)
    if answer.returncode == 0:
        stamp.touch()
        return True
    sys.stdout.write(answer.stdout + ("" if answer.stdout.strip() else answer.stderr))
    return False


def key(what: str, entry: dict[str, str]) -> str:
    """A digest of everything the verdict depends on."""
    digest = hashlib.sha256(f"{what}\0{entry['command']}".encode())
    for path in [ROOT / ".clang-tidy", *dependencies(entry)]:
        digest.update(path.read_bytes() if path.is_file() else b"?")
    return digest.hexdigest()[:32]


def dependencies(entry: dict[str, str]) -> list[Path]:
    """The source and the headers of ours it includes, as clang's preprocessor finds them."""
    words = shlex.split(entry["command"])
    for option in ("-o", "-MF", "-MT", "-MQ"):
        while option in words:
            at = words.index(option)
            del words[at:at + 2]
    words = [w for w in words if w not in ("-c", "-MD", "-MMD")]
    answer = subprocess.run([_preprocessor(words), *words[1:], "-MM"], cwd=entry["directory"], capture_output=True,
                            text=True, check=False)
    names = answer.stdout.replace("\\\n", " ").split(":", 1)[-1].split()
    return [Path(entry["directory"], name) for name in names] or [Path(entry["file"])]


def _preprocessor(words: list[str]) -> str:
    """clang itself need not be installed: clang-tidy brings its own. Then the compiler in use lists the headers."""
    if CROSS[0] in words:
        words.remove(CROSS[0])
        return "arm-none-eabi-gcc"
    return "gcc"


def _need(program: str) -> None:
    from shutil import which
    if which(program) is None:
        raise RunFailed(f"there is no program {program}; tools/bootstrap test installs it")
