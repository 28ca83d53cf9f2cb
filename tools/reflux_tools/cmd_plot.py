"""tools/plot: chosen columns of a log, as a picture."""

from __future__ import annotations

import argparse

from reflux_tools.compare import log_of
from reflux_tools.errors import UserError
from reflux_tools.logs import bare, read_csv
from reflux_tools.paths import named, shown


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(prog="tools/plot", description="Plots columns of a log.csv into a PNG file.")
    p.add_argument("log", type=named, metavar="LOG", help="a log.csv, or a folder that holds one")
    p.add_argument("columns", nargs="*", metavar="COLUMN",
                   help="names without their unit, such as T1.meas (default: measurements, setpoints, outputs)")
    p.add_argument("-o", "--out", type=named, metavar="PNG", help="default: plot.png beside the log")
    p.add_argument("--list", action="store_true", help="print the columns of the log and stop")
    options = p.parse_args(arguments)
    path = log_of(options.log)
    log = read_csv(path)
    if options.list:
        print("\n".join(log.columns))
        return 0
    from reflux_tools import plots  # matplotlib takes a second to load
    names = [bare(c) for c in options.columns] or plots.default_columns(log)
    for name in names:
        log.place(name)
    out = options.out or path.parent / "plot.png"
    try:
        out.write_bytes(plots.column_plot(log, names, shown(path)).png)
    except OSError as error:
        raise UserError(f"{shown(out)} cannot be written: {error.strerror}") from None
    print(shown(out))
    return 0
