"""tools/console: a board's console, for people, for command files, and for watching channels."""

from __future__ import annotations

import argparse
import contextlib
import datetime
import sys
import time
from pathlib import Path
from typing import Iterator, TextIO

from reflux import build, keys, launch, live, session, simulator, textfile, watch
from reflux.errors import Ended, RunFailed, UserError
from reflux.paths import named, shown, tool
from reflux.ports import Port
from reflux.session import Session
from reflux.terminal import interactive


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog=tool("console"),
        description="Without an option for something else: a terminal on the board's console; ^] leaves. PORT is a "
        "serial device (/dev/ttyUSB0, /dev/ttyUSB0@115200), a pseudo-terminal, or socket:PATH.")
    p.add_argument("port", nargs="?", metavar="PORT")
    p.add_argument("--host", action="store_true", help="start the firmware as a process on this computer instead")
    p.add_argument("--plant", metavar="NAME", help="with --host: also start a simulated plant at its link, such as pilot")
    p.add_argument("--speed", default="10", metavar="max|X", help="speed of that plant as a multiple of real time "
                   "(default 10)")
    p.add_argument("--no-build", action="store_true", help="with --host: do not build; use what is there")
    p.add_argument("--log", type=named, metavar="FILE", help="append everything to FILE")
    keys.add_option(p)
    what = p.add_mutually_exclusive_group()
    what.add_argument("--run", type=named, metavar="FILE", help="send the lines of FILE (- for standard input), each "
                      "after the reply to the one before; stop at the first refusal")
    what.add_argument("--dump", type=named, metavar="FILE", help="save the configuration as commands (- prints it)")
    what.add_argument("--restore", type=named, metavar="FILE", help="send such a file, then compare; it replaces all settings")
    what.add_argument("--plot", metavar="T1,T10", help="plot channels as they come: a window, or a PNG file where "
                      "there is no display; ^C ends it")
    what.add_argument("--watch", action="store_true", help="loops, outputs and alarms above the line where you type; ^C or ^] leaves")
    what.add_argument("--spark", metavar="T1,T10", help="plot channels as lines in the terminal")
    p.add_argument("--keep-going", action="store_true", help="with --run: go on after a refusal")
    p.add_argument("--png", type=named, metavar="FILE", help="with --plot: draw into this file, without a window")
    p.add_argument("--every", type=float, default=2.0, metavar="S", help="with --plot: seconds between two PNGs "
                   "(default 2)")
    p.add_argument("--seconds", type=float, metavar="S", help="with --plot or --spark: end after this time")
    return p


def main(arguments: list[str]) -> int:
    options = parser().parse_args(arguments)
    if options.host == bool(options.port):
        raise UserError("which board? PORT, or --host for one on this computer")
    if options.plant and not options.host:
        raise UserError("--plant goes with --host")
    if options.every <= 0 or (options.seconds is not None and options.seconds <= 0):
        raise UserError("--every and --seconds must be more than 0")
    if options.key and not scripted_by(options):
        raise UserError("--key goes with --run, --dump, --restore, --plot and --spark; at the terminal type `unlock KEY`")
    options.key = keys.key_of(options.key)
    if options.watch:
        watch.check_terminal()
    text = read_commands(options.run or options.restore)
    with contextlib.ExitStack() as stack:
        where = stack.enter_context(host_board(options)) if options.host else options.port
        log = stack.enter_context(open_log(options.log)) if options.log else None
        port = stack.enter_context(contextlib.closing(Port(where)))
        if scripted_by(options):
            return scripted(port, log, options, text)
        if options.watch:
            return watch.run(Session(port, log))
        return interactive(port, log)


def scripted_by(options: argparse.Namespace) -> bool:
    return bool(options.run or options.dump or options.restore or options.plot or options.spark)


def read_commands(path: Path | None) -> str:
    """Read before anything is sent."""
    if path is None:
        return ""
    return textfile.decode(sys.stdin.buffer.read(), "stdin") if str(path) == "-" else textfile.read(path)


def open_log(path: Path) -> TextIO:
    try:
        return path.open("a", encoding="utf-8")
    except OSError as error:
        raise UserError(f"{shown(path)} cannot be written: {error.strerror}") from None


@contextlib.contextmanager
def host_board(options: argparse.Namespace) -> Iterator[str]:
    if not options.no_build:
        build.build("host", ("reflux-host", "reflux-sim"), quiet=True)
    if options.plant:
        simulator.check_plant(options.plant)
    with contextlib.ExitStack() as stack:
        firmware = stack.enter_context(launch.start("host"))
        if options.plant:
            stack.enter_context(launch.plant(firmware, options.plant, "--speed", options.speed))
        yield firmware.console


def scripted(port: Port, log: TextIO | None, options: argparse.Namespace, text: str) -> int:
    channels = live.Channels([n.strip() for n in (options.plot or options.spark or "").split(",") if n.strip()])
    talk = Session(port, log, lambda line: aside(line, channels, options))
    if options.key:
        talk.ask(f"unlock {options.key}")
    try:
        if options.run:
            refused = session.run_file(talk, options.run, text, lambda line: print(line, flush=True),
                                       options.keep_going)
            return 1 if refused else 0
        if options.dump:
            return save(talk, options.dump)
        if options.restore:
            return restore(talk, options.restore, text)
        return show(talk, channels, options)
    finally:
        with contextlib.suppress(RunFailed):
            talk.write("mode human")


def aside(line: str, channels: live.Channels, options: argparse.Namespace) -> None:
    if options.plot or options.spark:
        channels.take(line)
    elif options.run:
        print(line, flush=True)


def save(talk: Session, path: Path) -> int:
    lines = session.dump(talk)
    version = talk.ask("version")[:1]
    if str(path) == "-":
        print("\n".join(lines))
        return 0
    now = datetime.datetime.now().astimezone().isoformat(timespec="seconds")
    head = [f"# {now}, {version[0] if version else 'reflux'}"]
    fresh = path.with_name(path.name + ".new")
    try:
        fresh.write_text("\n".join([*head, *lines]) + "\n", encoding="latin-1")
        fresh.replace(path)
    except OSError as error:
        raise UserError(f"{shown(path)} cannot be written: {error.strerror}") from None
    print(f"{shown(path)}: {sum(line.startswith('set ') for line in lines)} parameters")
    return 0


def restore(talk: Session, path: Path, text: str) -> int:
    """All or nothing: refused lines leave the board as it was."""
    commands = [line for _, line in session.commands_in(path, text)]
    if not any(line.startswith("set ") for line in commands):
        raise UserError(f"{shown(path)} holds no `set` line; is it a saved configuration?")
    session.run_file(talk, path, text, lambda line: None)
    wrong = session.differences(commands, session.dump(talk))
    # The board does not list a default value: one that stands in the file is no difference.
    wrong = [line for line in wrong if "is at its default" not in line]
    if wrong:
        raise RunFailed(f"the board took {shown(path)}, but {len(wrong)} parameters differ: {wrong[0]}")
    print(f"{shown(path)}: {sum(line.startswith('set ') for line in commands)} parameters restored and compared")
    return 0


def show(talk: Session, channels: live.Channels, options: argparse.Namespace) -> int:
    if not channels.names:
        raise UserError("which channels? such as T1,T10")
    if options.plot:
        view: live.PictureView | live.SparkView = live.PictureView(channels, options.png, options.every)
        if view.png:
            print(f"{shown(view.png)}: written every {options.every:g} s; ^C ends", flush=True)
    else:
        view = live.SparkView(channels)
    end = time.monotonic() + options.seconds if options.seconds else None
    try:
        talk.ask("log on")
        while end is None or time.monotonic() < end:
            with contextlib.suppress(TimeoutError):
                talk.line(0.2)
            view.update()
    except Ended:
        raise
    except KeyboardInterrupt:  # Ctrl-C is how this is ended
        pass
    finally:
        with contextlib.suppress(RunFailed):
            talk.ask("log off")
    view.update(final=True)
    if not channels.rows:
        raise RunFailed("no telemetry came: is a plant connected and the configuration applied?")
    print(f"{channels.rows} rows")
    return 0
