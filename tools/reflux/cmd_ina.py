"""tools/ina: inverse Nyquist array of a plant, a constant compensator for diagonal dominance made by hand or found, and the settings of the
board's static decoupler that follow from it."""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from reflux import arrays, board_settings, build, ina_plant, ina_window, keys, table
from reflux.errors import RunFailed, UserError
from reflux.paths import named, shown, tool

MOST = 100  # largest element of the board's static decoupler

HELP = """\
operations, rows counted from 1 (a row of the inverse belongs to an input):
  add ROW OTHER BY     row ROW of the inverse array gets BY times row OTHER
  scale ROW BY         row ROW times BY
  swap ROW OTHER       they change places
  align OMEGA          G that makes the plant most like a diagonal at OMEGA, rad/s (0: its inverse at rest)
  auto [rows|columns]  G with the least of the largest ratio, searched from the present one
  set G11 G12 ...      G itself, row by row
  normalise            columns of G over their diagonal elements
  undo                 as it was before the last of these
  show, board, draw FILE
  write                the lines for the board to that of --to, all or none
"""


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog=tool("ina"), formatter_class=argparse.RawDescriptionHelpFormatter, epilog=HELP,
        description="Draws the inverse Nyquist array of a plant with Gershgorin's bands, does elementary operations, searches the constant compensator, "
        "and prints it for the board (docs/methods/ina.md).",
    )
    p.add_argument("plant", help="a linear plant of host_sim/plants by name, or a file NAME.json (docs/use/linear-plants.md)")
    p.add_argument("--do", action="append", default=[], metavar="'OPERATION'", help="one operation, as below; repeatable, in this order")
    p.add_argument("--auto", action="store_true", help="do `auto` after all other operations")
    p.add_argument("--prompt", action="store_true", help="then take operations from the terminal or stdin, and draw after each")
    p.add_argument("--by", choices=arrays.BY, default="rows", help="dominance by rows or columns, for picture, search and worst element (default rows)")
    p.add_argument("--view", choices=("inverse", "direct", "loci"), default="inverse", help="inverse array, direct array, characteristic loci (default inverse)")
    p.add_argument("--units", choices=("spans", "eu"), default="spans", help="units of the channels: fractions of span as on the board, or engineering units")
    p.add_argument("--pairs", metavar="Y=U,...", help="pairs of output and input, in the order of the loops (default: the order of the file)")
    p.add_argument("--loops", metavar="N,...", help="numbers of the loops on the board (default 1, 2, ..)")
    p.add_argument("--points", type=int, default=400, help="number of frequencies (default 400)")
    p.add_argument("--low", type=float, metavar="RAD/S", help="lowest frequency")
    p.add_argument("--high", type=float, metavar="RAD/S", help="highest frequency (default: half the rate of a sampled model)")
    p.add_argument("--starts", type=int, default=8, help="starting points of the search (default 8)")
    p.add_argument("--seed", type=int, default=1, help="seed of the search (default 1)")
    p.add_argument("--out", type=named, metavar="PNG", help="file of the picture of the last G; with --every one for each operation, NAME-1.png and so on")
    p.add_argument("--window", action="store_true", help="show a window and draw it again after each operation; without --prompt it stays until you close it")
    p.add_argument("--to", metavar="PORT", help="write the last G to a board (with --prompt: when you type `write`) and read it back; the board does not save it")
    keys.add_option(p, "with --to: ")
    p.add_argument("--every", action="store_true", help="draw after each --do")
    p.add_argument("--no-build", action="store_true", help="do not build; use what is there")
    return p


@dataclass
class Session:
    """G now and before; everything in the units chosen."""

    plant: ina_plant.SquarePlant
    options: argparse.Namespace
    omega: np.ndarray
    f: np.ndarray
    g: np.ndarray
    past: list[tuple[str, np.ndarray]] = field(default_factory=list)
    window: ina_window.Window | None = None

    def response(self, omega: np.ndarray) -> np.ndarray:
        f = self.plant.response(np.asarray(omega, float))
        return f * self.plant.spans() if self.options.units == "spans" else f

    def change(self, what: str, g: np.ndarray) -> None:
        self.past.append((what, self.g))
        self.g = g


def main(arguments: list[str]) -> int:
    options = parser().parse_args(arguments)
    if not 2 <= options.points <= 2000:
        raise UserError("--points must be 2 to 2000")
    if options.every and not options.out:
        raise UserError("--every needs --out")
    board_settings.check_options(options)
    if not options.to and any(text.split() == ["write"] for text in options.do):
        raise UserError("write: --to PORT says to which board")
    if not options.no_build:
        build.build("host", ("libreflux",), quiet=True)
    plant = ina_plant.read(options.plant, options.pairs)
    loops(options, plant)  # refused before anything is done
    session = begin(plant, options)
    print(f"{plant.name}, {plant.n} loops: {', '.join(f'{y.name} by {u.name}' for y, u in zip(plant.outputs, plant.inputs))}; in "
          f"{'fractions of span' if options.units == 'spans' else 'engineering units'}, {len(session.omega)} frequencies from {session.omega[0]:.3g} to "
          f"{session.omega[-1]:.4g} rad/s, {'z' if plant.period_s else 's'}-plane\n")
    show(session, "G = 1")
    try:
        if options.window:
            session.window = ina_window.window(picture_size(plant.n))
            redraw(session)
        work(session)
    finally:
        if session.window:
            session.window.close()
    return 0


def work(session: Session) -> None:
    options = session.options
    for number, text in enumerate([*options.do, *(["auto"] if options.auto else [])], start=1):
        operate(session, text)
        redraw(session)
        if options.every:
            draw(session, options.out.with_name(f"{options.out.stem}-{number}{options.out.suffix}"))
    if options.prompt:
        prompt(session)
    board(session)
    if options.out and not options.every:
        draw(session, options.out)
    if options.to and not options.prompt and options.do[-1:] != ["write"]:
        write(session)
    if session.window and not options.prompt:
        session.window.wait()


def begin(plant: ina_plant.SquarePlant, options: argparse.Namespace) -> Session:
    omega = plant.omega(options.points, options.low, options.high)
    session = Session(plant, options, omega, np.zeros(0), np.eye(plant.n))
    session.f = session.response(omega)
    if not np.isfinite(session.f).all():
        raise UserError(f"{plant.name} has no finite response at {omega[~np.isfinite(session.f).all(axis=(1, 2))][0]:g} rad/s")
    return session


# ---- operations ----


def operate(session: Session, text: str) -> None:
    words = text.split()
    what = words[0] if words else ""
    if what == "show":
        show(session, "now")
    elif what == "board":
        board(session)
    elif what == "draw":
        draw(session, Path(only(words, text)))
    elif what == "write" and len(words) == 1:
        write(session)
    elif what == "undo":
        if not session.past:
            raise UserError("undo: there is nothing to undo")
        done, session.g = session.past.pop()
        show(session, f"without {done}")
    else:
        session.change(text, changed(session, what, words, text))
        show(session, text)


def changed(session: Session, what: str, words: list[str], text: str) -> np.ndarray:
    """G after the operation."""
    n = session.plant.n
    if what == "add" and len(words) == 4:
        return arrays.operate(session.g, "add", row(words[1], n, text), row(words[2], n, text), number(words[3], text))
    if what == "scale" and len(words) == 3:
        return arrays.operate(session.g, "scale", row(words[1], n, text), 0, number(words[2], text))
    if what == "swap" and len(words) == 3:
        return arrays.operate(session.g, "swap", row(words[1], n, text), row(words[2], n, text))
    if what == "align" and len(words) == 2:
        omega = number(words[1], text)
        if omega < 0 or (session.plant.period_s and omega > np.pi / session.plant.period_s * (1 + 1e-9)):
            raise UserError(f"{text}: rad/s, 0 or more, of a sampled model at most half its rate")
        return arrays.normalise(arrays.align(session.response(np.array([omega]))[0]))[0]
    if what == "auto" and len(words) <= 2 and (len(words) == 1 or words[1] in arrays.BY):
        by = words[1] if len(words) == 2 else session.options.by
        try:
            found, _ = arrays.search(session.f, session.g, by, session.options.starts, session.options.seed)
        except arrays.Refused as refused:
            raise RunFailed(f"{text}: the most dominant by {by} is next to singular, its relative gains beyond 100: {refused}") from None
        return found
    if what == "set" and len(words) == 1 + n * n:
        return np.array([number(w, text) for w in words[1:]]).reshape(n, n)
    if what == "normalise" and len(words) == 1:
        return arrays.normalise(session.g)[0]
    raise UserError(f"'{text}' is not an operation:\n{HELP}".rstrip())


def only(words: list[str], text: str) -> str:
    if len(words) != 2:
        raise UserError(f"{text}: one file")
    return words[1]


def row(word: str, n: int, text: str) -> int:
    if not word.isdecimal() or not 1 <= int(word) <= n:
        raise UserError(f"{text}: {word} must be a row, 1 to {n}")
    return int(word) - 1


def number(word: str, text: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value):
        raise UserError(f"{text}: {word} is not a number")
    return value


def prompt(session: Session) -> None:
    terminal = sys.stdin.isatty()
    read = ina_window.Lines(session.window).read if session.window and terminal else sys.stdin.readline
    while True:
        if terminal:
            print("ina> ", end="", flush=True)
        line = read()
        if not line or line.strip() == "quit":
            return
        if not line.strip():
            continue
        try:
            operate(session, line.strip())
            redraw(session)
            if session.options.out:
                draw(session, session.options.out)
        except (UserError, RunFailed) as error:
            if not terminal:
                raise
            print(error)


# ---- shown ----


def show(session: Session, title: str) -> None:
    """G, and how dominant the inverse array is with it."""
    found = arrays.array(session.f, session.g)
    plant, by = session.plant, session.options.by
    place = found.ratio[by].argmax(axis=0)
    rows = [[f"{k + 1} {plant.inputs[k].name}", *(f"{x:.5g}" for x in session.g[k]), f"{found.worst('rows')[k]:.3f}", f"{found.worst('columns')[k]:.3f}",
             f"{session.omega[place[k]]:.3g}"] for k in range(plant.n)]
    print(title)
    print(table.columns(["row", *(f"G.{k + 1}" for k in range(plant.n)), "by rows", "by columns", "worst at rad/s"], rows))
    worst = found.worst(by).max()
    print(f"by {by} {'dominant at every frequency' if worst < 1 else 'not dominant'}: largest ratio {worst:.3f}; relative gains of G to "
          f"{np.abs(session.g * np.linalg.pinv(session.g).T).max():.3g}\n")


def loops(options: argparse.Namespace, plant: ina_plant.SquarePlant) -> list[int]:
    if options.loops is None:
        return list(range(1, plant.n + 1))
    found = [int(x) if x.isdecimal() else 0 for x in options.loops.split(",")]
    if len(found) != plant.n or len(set(found)) < len(found) or not all(1 <= x <= ina_plant.MOST for x in found):
        raise UserError(f"--loops {options.loops}: {plant.n} different numbers, 1 to {ina_plant.MOST}")
    return found


def on_board(session: Session) -> np.ndarray:
    """D in fractions of span of the inputs, which are what the loops' outputs are."""
    if session.options.units == "spans":
        return session.g
    spans = np.array([u.span for u in session.plant.inputs])
    return session.g * spans[None, :] / spans[:, None]


def board(session: Session) -> None:
    """Console lines of the static decoupler."""
    try:
        print("\n".join(board_lines(session)) + "\n")
    except RunFailed as error:
        print(f"# {error}")


def board_lines(session: Session) -> list[str]:
    numbers, d = loops(session.options, session.plant), on_board(session)
    if np.abs(d).max() > MOST:
        d, _ = arrays.normalise(d)
    if not np.abs(d).max() <= MOST:
        raise RunFailed(f"the board takes elements to {MOST}, and one is {np.abs(d).max():.3g}: not this compensator")
    lines = []
    for i, loop in enumerate(numbers):
        lines.append(f"set loop{loop}.decouple on")
        lines += [f"set decouple{loop}.d{other} {d[i, k]:.5g}" for k, other in enumerate(numbers)]
    return lines


def write(session: Session) -> None:
    """To the board of --to."""
    options = session.options
    if not options.to:
        raise UserError("write: --to PORT says to which board")
    board_settings.to_board(options, board_lines(session))


def picture_size(n: int) -> tuple[float, float]:
    from reflux import ina_picture

    return ina_picture.size(n)


def redraw(session: Session) -> None:
    """The window, where there is one."""
    if session.window:
        from reflux import ina_picture

        done = [what for what, _ in session.past]
        session.window.draw(lambda figure: ina_picture.fill(figure, session.plant, session.omega, session.f, session.g, session.options.by,
                                                            session.options.view, done))


def draw(session: Session, place: Path) -> None:
    from reflux import ina_picture  # matplotlib takes a second to load

    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(ina_picture.draw(session.plant, session.omega, session.f, session.g, session.options.by, session.options.view,
                                           [what for what, _ in session.past]))
    except OSError as error:
        raise UserError(f"{shown(place)} cannot be written: {error.strerror}") from None
    print(shown(place))
