#!/usr/bin/python3
"""Files of the firmware that one line at the console enters, beside those of a turn without a line: how far a reader has to go to see
what `set` does. With --repository, of another version of this repository."""

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent


def run(*command: str) -> str:
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    if answer.returncode:
        sys.exit(f"{' '.join(command)}\n{answer.stdout[-2000:]}{answer.stderr[-2000:]}")
    return answer.stdout


def files_of(program: Path, firmware: Path, addresses: list[str]) -> set[str]:
    """Sources below firmware/; functions that headers define are none."""
    out = run("addr2line", "-e", str(program), *addresses) if addresses else ""
    found = set()
    for line in out.splitlines():
        path = re.sub(r":(\d+|\?).*$", "", line)
        place = Path(path).resolve()
        if place.suffix == ".c" and place.is_relative_to(firmware):
            found.add(str(place.relative_to(firmware)))
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("line", nargs="?", default="set loop1.gain 2", help="what is typed, in an open transaction (default: %(default)s)")
    parser.add_argument("--repository", type=Path, default=HERE.parents[1], help="another version of this repository")
    arguments = parser.parse_args()
    source = arguments.repository.resolve()
    with tempfile.TemporaryDirectory() as folder:
        print("building the firmware with its functions recorded ...", file=sys.stderr)
        run("cmake", "-S", str(source), "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug",
            "-DCMAKE_C_FLAGS=-O0 -g -finstrument-functions -fno-pie", "-DCMAKE_EXE_LINKER_FLAGS=-no-pie", f"-DCMAKE_PROJECT_reflux_INCLUDE={HERE / 'entered.cmake'}")
        run("cmake", "--build", folder, "--target", "entered")
        program = Path(folder) / "entered"
        rows = [line.split() for line in run(str(program), arguments.line).splitlines() if re.match(r"(idle|line) 0x", line)]
        firmware = source / "firmware"
        idle = files_of(program, firmware, [address for during, address in rows if during == "idle"])
        entered = files_of(program, firmware, [address for during, address in rows if during == "line"])
    for path in sorted(entered - idle):
        print(path)
    print(f"`{arguments.line}` enters {len(entered - idle)} files beside the {len(entered & idle)} that a turn without a line enters too")


if __name__ == "__main__":
    main()
