"""Puts the checksum behind a linked image (hal/image.h) and makes the file that is flashed.

    image_crc.py OBJCOPY ELF BIN

Section .image_crc of the ELF file, the last four bytes of what is flashed, becomes the CRC-32 of all bytes before it.
"""

import subprocess
import sys
import tempfile
import zlib
from pathlib import Path


def main(objcopy: str, elf: str, flat: str) -> int:
    subprocess.run([objcopy, "-O", "binary", elf, flat], check=True)
    body = Path(flat).read_bytes()[:-4]
    crc = zlib.crc32(body).to_bytes(4, "little")
    with tempfile.TemporaryDirectory() as folder:
        section = Path(folder) / "crc"
        section.write_bytes(crc)
        subprocess.run([objcopy, "--update-section", f".image_crc={section}", elf], check=True)
    subprocess.run([objcopy, "-O", "binary", elf, flat], check=True)
    if Path(flat).read_bytes() != body + crc:
        print(f"{elf}: .image_crc is not the last four bytes of what is flashed", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
