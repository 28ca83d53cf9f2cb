"""Plants of link tests put to the board's own pins: the wiring of chips and loads, and the settings that go with it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from reflux.scenario import Line, Scenario

BUSES = {"max31865": "spi1", "ads1115": "i2c1"}
DEGC = ("PA4", "PB12", "PC4", "PC5", "PC7")  # selects on spi1
SIGNALS = ("PB0", "PB1", "PB8", "PB9")  # pins with a pulse width, and for relays
REFERENCE_V = (0.4, 2.0)  # of 4 and 20 mA over 100 ohm


@dataclass(frozen=True)
class Channel:
    name: str
    unit: str
    lo: float
    hi: float


@dataclass(frozen=True)
class Pins:
    """Temperatures by platinum thermometers, other measurements by 4 to 20 mA; heaters (kW) by a relay that switches whole cycles of the mains, other
    outputs by 0 to 10 V. A reflux that is switched would not do: the column's model has no drum that could supply the whole flow for seconds."""

    measurements: tuple[Channel, ...]
    outputs: tuple[Channel, ...]
    tick_s: float
    plant_tick_s: float = 1.0  # sensors get a new value so often: a reading is a second old, and not a base tick

    def wiring(self, folder: Path) -> Path:
        rows = []
        for k, c in enumerate(self.measurements):
            rows.append(f"{c.name} max31865 spi1 {DEGC[k]} reference=430 wires=3" if c.unit == "degC" else
                        f"{c.name} ads1115 i2c1 0x{0x48 + k // 4:x} {k % 4} lo={c.lo:g} hi={c.hi:g} lo_in={REFERENCE_V[0]} hi_in={REFERENCE_V[1]}")
        rows += [f"{c.name} {'ssr' if c.unit == 'kW' else 'pwm'} {pin} lo={c.lo:g} hi={c.hi:g}" for c, pin in zip(self.outputs, SIGNALS)]
        path = folder / "pins.wiring"
        path.write_text("\n".join(rows) + "\n", encoding="utf-8")
        return path

    def settings(self) -> list[str]:
        """Lines for between begin and apply."""
        out = ["set io.source board", f"set tick.base {self.tick_s:g}"]
        for k, c in enumerate(self.measurements):
            device = "max31865" if c.unit == "degC" else "ads1115"
            rows = {"name": c.name, "unit": c.unit, "device": device, "bus": BUSES[device]}
            rows |= {"select": DEGC[k]} if c.unit == "degC" else {"select": f"0x{0x48 + k // 4:x}", "input": k % 4, "type": "4-20mA", "lo": c.lo, "hi": c.hi}
            out += [f"set chan{k + 1}.{name} {value}" for name, value in rows.items()]
        for k, (c, pin) in enumerate(zip(self.outputs, SIGNALS), 1):
            rows = {"name": c.name, "unit": c.unit, "kind": "burst" if c.unit == "kW" else "analog", "pin": pin, "lo": c.lo, "hi": c.hi}
            out += [f"set out{k}.{name} {value}" for name, value in rows.items()]
        return out

    def put(self, wanted: Scenario, folder: Path) -> Scenario:
        """The scenario at these pins."""
        rows = [Line(0.0, row) for row in ("begin", *self.settings(), "apply")]
        return replace(wanted, wiring=self.wiring(folder), tick_s=self.plant_tick_s, firmware="memory", config=(*wanted.config, *rows))


PILOT = (Channel("Lr", "l/h", 0, 12), Channel("Qrb", "kW", 0, 1.5))


def pilot(*thermometers: str, tick_s: float) -> Pins:
    return Pins(tuple(Channel(name, "degC", 0, 200) for name in thermometers), PILOT, tick_s)
