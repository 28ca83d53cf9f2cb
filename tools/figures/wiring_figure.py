#!/usr/bin/python3
"""Draws docs/figures/pilot-wiring.svg: the pilot column at a board's own pins, from host_sim/scenarios/pilot-pins.conf.

usage: tools/figures/wiring_figure.py
"""

import sys
from pathlib import Path
from xml.sax.saxutils import escape

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import paths  # noqa: E402

SETTINGS = ROOT / "host_sim" / "scenarios" / "pilot-pins.conf"
BUS_LINES = {"spi1": (("PA5", "CLK"), ("PA6", "SDO"), ("PA7", "SDI"))}
WIDTH, HEIGHT, ROW = 760, 520, 26
BLACK, BLUE, RED, GREEN, GREY = "#222222", "#1f6fb4", "#c0392b", "#2e8b57", "#777777"


def settings() -> dict[str, dict[str, str]]:
    """Rows `chanN` and `outN` of the pilot column."""
    rows: dict[str, dict[str, str]] = {}
    for line in SETTINGS.read_text(encoding="utf-8").splitlines():
        words = line.split()
        if words[:1] == ["set"] and words[1].startswith(("chan", "out")):
            group, _, what = words[1].partition(".")
            rows.setdefault(group, {})[what] = words[2]
    return rows


class Drawing:
    """Shapes of an SVG; x and y in pixels from the upper left corner."""

    def __init__(self) -> None:
        self.shapes: list[str] = []

    def box(self, x: float, y: float, width: float, height: float, title: str) -> None:
        self.shapes.append(f'<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="#f7f7f7" stroke="{BLACK}" rx="4"/>')
        self.text(x + width / 2, y + 18, title, "middle", "bold")

    def text(self, x: float, y: float, words: str, anchor: str = "start", weight: str = "normal", colour: str = BLACK) -> None:
        self.shapes.append(f'<text x="{x}" y="{y}" text-anchor="{anchor}" font-weight="{weight}" fill="{colour}">{escape(words)}</text>')

    def wire(self, colour: str, *corners: tuple[float, float]) -> None:
        points = " ".join(f"{x},{y}" for x, y in corners)
        self.shapes.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>')

    def joint(self, x: float, y: float, colour: str) -> None:
        self.shapes.append(f'<circle cx="{x}" cy="{y}" r="3.5" fill="{colour}"/>')

    def resistor(self, x: float, y: float, words: str, to: str) -> None:
        """From a wire at x, y downwards."""
        self.shapes.append(f'<rect x="{x - 5}" y="{y + 8}" width="10" height="20" fill="white" stroke="{BLACK}"/>')
        self.wire(BLACK, (x, y), (x, y + 8))
        self.wire(BLACK, (x, y + 28), (x, y + 36))
        self.text(x + 9, y + 24, f"{words} to {to}", colour=GREY)

    def svg(self, title: str) -> str:
        return "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13">',
                          f"<title>{escape(title)}</title>", f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>', *self.shapes, "</svg>", ""])


def draw() -> str:
    rows = settings()
    channels, outputs = ([own for name, own in rows.items() if name.startswith(kind)] for kind in ("chan", "out"))
    drawing = Drawing()
    drawing.box(20, 20, 130, 480, "board")
    pin_y = {"3V3": 60.0, "GND": 60.0 + ROW}
    for name, y in pin_y.items():
        drawing.text(140, y + 4, name, "end")
    y = 60.0 + 2.5 * ROW
    lines = BUS_LINES[channels[0]["bus"]]
    for pin in (*(pin for pin, _ in lines), *(own["select"] for own in channels)):
        pin_y[pin] = y
        drawing.text(140, y + 4, pin, "end")
        y += ROW
    bus_x = {pin: 230.0 + 18 * k for k, (pin, _) in enumerate(lines)}
    chip_y = [50.0, 230.0]
    for own, top, k in zip(channels, chip_y, range(2)):
        drawing.box(430, top, 150, 160, own["device"].upper())
        for n, (pin, word) in enumerate(lines):
            at = top + 42 + n * 24
            drawing.text(438, at + 4, word)
            drawing.wire(BLUE, (bus_x[pin], at), (430, at))
            drawing.joint(bus_x[pin], at, BLUE)
        select = top + 42 + 3 * 24
        drawing.text(438, select + 4, "CS")
        column = 300.0 + 18 * k
        drawing.wire(GREEN, (150, pin_y[own["select"]]), (column, pin_y[own["select"]]), (column, select), (430, select))
        drawing.resistor(column + 12, select, "10 kΩ", "3V3")
        drawing.text(438, top + 42 + 4 * 24 + 4, "VIN 3V3, GND", colour=GREY)
        drawing.box(640, top + 50, 100, 60, own["name"])
        drawing.text(690, top + 92, "PT100", "middle")
        drawing.wire(BLACK, (580, top + 70), (640, top + 70))
        drawing.wire(BLACK, (580, top + 90), (640, top + 90))
    for pin, x in bus_x.items():
        drawing.wire(BLUE, (150, pin_y[pin]), (x, pin_y[pin]), (x, chip_y[1] + 42 + 24 * list(bus_x).index(pin)))
        drawing.wire(BLUE, (x, pin_y[pin]), (x, chip_y[0] + 42 + 24 * list(bus_x).index(pin)))
    for k, own in enumerate(outputs):
        at = 430.0 + 44 * k
        drawing.text(140, at + 4, own["pin"], "end")
        drawing.box(430, at - 18, 150, 36, f"relay: {own['name']}")
        drawing.wire(RED, (150, at), (430, at))
        drawing.resistor(180 + 120 * k, at, "10 kΩ", "GND")
    drawing.text(640, 434, "minus of both", colour=GREY)
    drawing.text(640, 452, "inputs to GND", colour=GREY)
    return drawing.svg("The pilot column at a board's own pins")


def main() -> int:
    if sys.argv[1:]:
        print(__doc__.strip())
        return 0 if sys.argv[1] in ("-h", "--help") else 2
    path = paths.figures() / "pilot-wiring.svg"
    path.write_text(draw(), encoding="utf-8")
    print(paths.shown(path))
    return 0


if __name__ == "__main__":
    sys.exit(main())
