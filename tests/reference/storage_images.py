#!/usr/bin/env python3
"""Flash images as earlier firmware left them, written from docs/inside/storage.md and storage-format.md alone: the second implementation of
the storage format. They are fixtures of tests/unit/test_storage.c and are kept as they are; a change of the format
gets new images beside them.

usage: storage_images.py [FOLDER]        (default: storage/ beside this script)

An image holds the bytes from the beginning of the area; what is missing at the end is erased (0xFF).
"""
import pathlib
import struct
import sys
import zlib

FLOAT, U32, U16, WORD, TEXT, ROW = 1, 2, 3, 4, 5, 6
SLOT = 16384


def mark(erases, flip=0, form=1):
    grain = b"RXSM" + struct.pack("<IB3x", erases, form)
    return grain + struct.pack("<I", zlib.crc32(grain) ^ flip)


def stored_set(sequence, records, schema=1, flip=0, tail_length=0, tail_sequence=0, form=1):
    """`flip` spoils the checksum of the head, the others are added to what the tail says: the checksum of the set is
    right all the same."""
    body = b"".join(records)
    head = b"RXSH" + struct.pack("<IHBB", sequence, len(body), form, schema)
    head += struct.pack("<I", zlib.crc32(head) ^ flip)
    padded = body + bytes(-len(body) % 16)
    tail = b"RXST" + struct.pack("<II", len(body) + tail_length, sequence + tail_sequence)
    return head + padded + tail + struct.pack("<I", zlib.crc32(head + padded + tail))


def confirmation(sequence, length):
    grain = b"RXSH" + struct.pack("<IHBB", sequence, length, 0, 0)
    return grain + struct.pack("<I", zlib.crc32(grain))


def confirmed(sequence, records):
    return stored_set(sequence, records) + confirmation(sequence, len(b"".join(records)))


def renewal(sequence, image, address):
    """Closes the set at that address of the image again."""
    length = struct.unpack_from("<H", image, address + 8)[0]
    grain = b"RXSR" + struct.pack("<IHH", sequence, length, address // 16)
    whole = image[address:address + 16 + (length + 15) // 16 * 16] + grain
    return grain + struct.pack("<I", zlib.crc32(whole)) + confirmation(sequence, length)


def renewed():
    """A set, one that was cut and reads whole after all, and what the start between them has decided."""
    image = mark(1) + confirmed(1, plant(gain=2.5)) + stored_set(2, plant(gain=9.0)) + b"\xff" * 16
    return image + renewal(2, image, 16)


def identity(group, field, index=1):
    return group << 12 | field << 6 | (index - 1)


def record(where, kind, value):
    data = {FLOAT: lambda: struct.pack("<f", value), U32: lambda: struct.pack("<I", value),
            U16: lambda: struct.pack("<H", value), WORD: lambda: struct.pack("<B", value),
            TEXT: lambda: value if isinstance(value, bytes) else value.encode()}[kind]()
    return struct.pack("<HBB", where, kind, len(data)) + data


TICK, MEAS, MV, LOOP = 1, 2, 3, 4


def plant(gain=1.5, **more):
    """One measurement, one output, one loop; `more` replaces records by name."""
    fields = {
        "meas_name": record(identity(MEAS, 1), TEXT, "T1"),
        "meas_unit": record(identity(MEAS, 2), TEXT, "degC"),
        "meas_lo": record(identity(MEAS, 3), FLOAT, 60.0),
        "meas_hi": record(identity(MEAS, 4), FLOAT, 160.0),
        "mv_name": record(identity(MV, 1), TEXT, "heat"),
        "mv_unit": record(identity(MV, 2), TEXT, "kW"),
        "mv_hi": record(identity(MV, 4), FLOAT, 2.0),
        "mv_max": record(identity(MV, 6), FLOAT, 2.0),
        "mv_safe": record(identity(MV, 8), FLOAT, 0.5),
        "loop_name": record(identity(LOOP, 1), TEXT, "bottom"),
        "loop_pv": record(identity(LOOP, 2), TEXT, "T1"),
        "loop_out": record(identity(LOOP, 3), TEXT, "heat"),
        "loop_gain": record(identity(LOOP, 4), FLOAT, gain),
        "loop_ti": record(identity(LOOP, 5), FLOAT, 300.0),
        "loop_action": record(identity(LOOP, 19), WORD, 0),
        "loop_divisor": record(identity(LOOP, 23), U16, 2),
    }
    fields.update(more)
    return [r for r in fields.values() if r]


UNKNOWN_LONG = struct.pack("<HBB", identity(15, 62, 3), 9, 200) + bytes(range(200))
UNKNOWN_SHORT = struct.pack("<HBB", identity(15, 63), 77, 0)
BEYOND = record(identity(LOOP, 4, 60), FLOAT, 7.0)  # a loop this build has not



def wide(field, index, kind, value, row=0):
    """A record of a block: its id has 32 bits, in front of the value."""
    data = {FLOAT: lambda: struct.pack("<f", value), U16: lambda: struct.pack("<H", value),
            WORD: lambda: struct.pack("<B", value), TEXT: lambda: value.encode(),
            ROW: lambda: struct.pack(f"<{len(value)}f", *value)}[kind]()
    identifier = 16 << 24 | field << 16 | row << 6 | index - 1
    return struct.pack("<HBBI", 0, kind, 4 + len(data), identifier) + data


KIND, LOOPS, INPUTS, POINTS, OWN = 1, 2, 3, 4, 64
# Rows of a kind that only the test has (tests/support/made_up_kinds.h), with a parameter and a row more than it knows.
BLOCK = [
    wide(KIND, 1, TEXT, "gmv"), wide(LOOPS, 1, TEXT, "bottom"), wide(INPUTS, 1, TEXT, ""), wide(POINTS, 1, TEXT, ""),
    wide(OWN + 1, 1, FLOAT, 0.5),
    wide(OWN + 2, 1, ROW, [1.0, 0.25, 0.0]), wide(OWN + 2, 1, ROW, [0.0, 2.0, 0.5], row=1),
    wide(OWN + 2, 1, ROW, [0.125, 0.0, 4.0], row=2), wide(OWN + 2, 1, ROW, [7.0, 8.0, 9.0], row=3),
    wide(OWN + 3, 1, U16, 3), wide(OWN + 4, 1, WORD, 0), wide(OWN + 60, 1, FLOAT, 60.0),
]
# Rows of a kind that nobody has.
UNKNOWN_BLOCK = [
    wide(KIND, 3, TEXT, "mystery"), wide(LOOPS, 3, TEXT, "bottom"), wide(INPUTS, 3, TEXT, "T1"), wide(POINTS, 3, TEXT, ""),
    wide(OWN + 1, 3, FLOAT, 0.75), wide(OWN + 9, 3, ROW, [1.5, 2.5], row=7),
]

IMAGES = {
    # Rows that any firmware of format 1 understands.
    "plain": mark(1) + stored_set(1, plant()),
    # Three saves, the last is the newest.
    "three": mark(4) + stored_set(7, plant(gain=1.0)) + stored_set(8, plant(gain=2.0)) + stored_set(9, plant(gain=3.0)),
    # Power was cut in the last save.
    "torn": mark(1) + stored_set(1, plant(gain=2.5)) + stored_set(2, plant(gain=9.0))[:100],
    # Written by firmware that knows more: ids, types and lengths of which we know nothing.
    "unknown": mark(1) + stored_set(5, [UNKNOWN_LONG] + plant() + [UNKNOWN_SHORT, BEYOND], schema=9),
    # Values no longer allowed: one by one they are clipped, or take their default.
    "ranges": mark(1) + stored_set(1, plant(
        loop_gain=record(identity(LOOP, 4), FLOAT, 1e6),
        loop_b=record(identity(LOOP, 8), FLOAT, -3.0),
        loop_n=record(identity(LOOP, 7), FLOAT, float("nan")),
        loop_divisor=record(identity(LOOP, 23), U16, 65535),
        loop_action=record(identity(LOOP, 19), WORD, 17),
        miss=record(identity(TICK, 2), U32, 4000000000),
        name2=record(identity(MEAS, 1, 2), TEXT, "not a name"),
        unit2=record(identity(MEAS, 2, 2), TEXT, "much_too_long_for_a_unit"))),
    # Written when other types were declared.
    "types": mark(1) + stored_set(1, plant(
        loop_gain=record(identity(LOOP, 4), TEXT, "1.25"),
        loop_ti=record(identity(LOOP, 5), U32, 450),
        loop_divisor=record(identity(LOOP, 23), FLOAT, 3.0),
        loop_action=record(identity(LOOP, 19), TEXT, "direct"),
        loop_track=record(identity(LOOP, 21), U32, 0),
        loop_pv=record(identity(LOOP, 2), TEXT, "T1"),
        miss=record(identity(TICK, 2), FLOAT, 12.0),
        loop_filter=record(identity(LOOP, 18), TEXT, "nonsense"),
        name3=record(identity(MEAS, 1, 3), FLOAT, 5.0))),
    # The test's own table says: group 15 field 60 has become loop.gain, field 61 loop.td. The gain is there twice.
    "renamed": mark(1) + stored_set(1, plant(
        old_gain=record(identity(15, 60), FLOAT, 77.0),
        old_td=record(identity(15, 61), FLOAT, 25.0))),
    # Every value allowed, but the loop's measurement does not exist.
    "inconsistent": mark(1) + stored_set(3, plant(meas_name=record(identity(MEAS, 1), TEXT, "T9"))),
    # Records that end in nothing: a length beyond the end of the set.
    "overrun": mark(1) + stored_set(1, plant() + [struct.pack("<HBB", identity(LOOP, 6), FLOAT, 250) + bytes(4)]),
    # Nothing whole, in a slot that was written.
    "ruined": mark(1) + stored_set(1, plant())[:-1],
    # The checksum of the newest set is right, and it is not whole all the same: its head's checksum, or what its tail
    # says, is not.
    "head": mark(1) + stored_set(1, plant(gain=2.5)) + stored_set(2, plant(gain=9.0), flip=1),
    "tail_length": mark(1) + stored_set(1, plant(gain=2.5)) + stored_set(2, plant(gain=9.0), tail_length=16),
    "tail_sequence": mark(1) + stored_set(1, plant(gain=2.5)) + stored_set(2, plant(gain=9.0), tail_sequence=1),
    # A slot whose mark is not right: what it holds counts, but nothing is appended.
    "mark": mark(1, flip=0x80000000) + stored_set(1, plant(gain=2.5)),
    # The newest set is in the second slot.
    # With a block; with its records the other way round, its kind last; and with one that is not known.
    "block": mark(1) + confirmed(1, plant() + BLOCK),
    "block_reversed": mark(1) + confirmed(1, plant() + BLOCK[::-1]),
    "block_unknown": mark(1) + confirmed(1, plant() + UNKNOWN_BLOCK),
    # As this firmware leaves it: confirmed.
    "confirmed": mark(1) + confirmed(1, plant()),
    "renewed": renewed(),
    # The sequence goes round.
    "round": mark(1) + confirmed(0xFFFFFFFE, plant(gain=1.0)) + confirmed(0xFFFFFFFF, plant(gain=2.0)) + confirmed(1, plant(gain=3.0)),
    # Newer firmware has begun to use the second slot, or has appended to the first.
    "newer_slot": (mark(3) + confirmed(40, plant(gain=4.0))).ljust(SLOT, b"\xff") + mark(4, form=2) + b"newer firmware's",
    "newer_set": mark(3) + confirmed(40, plant(gain=4.0)) + stored_set(41, plant(gain=5.0), form=2),
    "newer_both": (mark(3, form=3) + b"newer firmware's").ljust(SLOT, b"\xff") + mark(4, form=2),
    "second": (mark(3) + stored_set(40, plant(gain=4.0))).ljust(SLOT, b"\xff") + mark(3) + stored_set(41, plant(gain=5.0)),
}


def main():
    if len(sys.argv) > 2 or "--help" in sys.argv:
        print(__doc__.strip())
        return
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) == 2 else pathlib.Path(__file__).with_name("storage"))
    folder.mkdir(exist_ok=True)
    for name, image in IMAGES.items():
        (folder / f"{name}.bin").write_bytes(image)
    print(f"images: {len(IMAGES)} in {folder}")


if __name__ == "__main__":
    main()
