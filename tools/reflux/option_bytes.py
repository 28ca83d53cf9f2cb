"""Option bytes of the STM32F405, as FLASH_OPTCR shows them (RM0090 Rev 21 3.9.9): brown-out reset, watchdog, write protection of sectors."""

from __future__ import annotations

from reflux.errors import UserError

OPTCR = 0x40023C14
OPTKEYR = 0x40023C08
KEYS = (0x08192A3B, 0x4C5D6E7F)
START = 1 << 1
CHANGEABLE = 0x0FFFFFEC  # without the lock and the start
BROWN_OUT = 3 << 2
WATCHDOG_SOFTWARE = 1 << 5
READ_OPEN = 0xAA  # RDP: no read protection
LEVELS = ("level 3", "level 2", "level 1", "OFF")
SECTOR_KIB = (16, 16, 16, 16, 64, *(128,) * 7)


def sectors_of(size: int) -> int:
    """A bit of each sector that holds something of an image of that many bytes."""
    bits, end = 0, 0
    for sector, kib in enumerate(SECTOR_KIB):
        if end < size:
            bits |= 1 << sector
        end += kib * 1024
    return bits


def closed(value: int) -> int:
    """Sectors that are write-protected."""
    return ~(value >> 16) & 0xFFF


def protected(value: int, size: int) -> int:
    """Brown-out reset at level 3, hardware watchdog, and the sectors of the program write-protected; all else as it was."""
    return with_open(value & ~BROWN_OUT & ~WATCHDOG_SOFTWARE, 0) & ~(sectors_of(size) << 16)


def with_open(value: int, sectors: int) -> int:
    return value | sectors << 16


def check(value: int) -> None:
    """Writes nothing over a read protection: to lift one erases the chip, and its highest level is for ever."""
    if value >> 8 & 0xFF != READ_OPEN:
        raise UserError(f"option bytes {value:#010x}: the board is read-protected, or they were read wrong; this tool leaves such a board alone")


def names(sectors: int) -> str:
    found = [str(k) for k in range(12) if sectors >> k & 1]
    return f"{found[0]} to {found[-1]}" if len(found) > 2 and int(found[-1]) - int(found[0]) == len(found) - 1 else " and ".join(found) or "none"


def text(value: int) -> str:
    return (f"brown-out reset {LEVELS[value >> 2 & 3]}, watchdog "
            f"{'only from start-up on' if value & WATCHDOG_SOFTWARE else 'from reset on'}, write-protected sectors: {names(closed(value))}")
