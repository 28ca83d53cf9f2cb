"""The images under tests/reference/storage are what storage_images.py writes today, byte for byte."""
import pathlib
import sys

reference = pathlib.Path(__file__).resolve().parent.parent / "reference"
sys.path.insert(0, str(reference))
import storage_images  # noqa: E402

kept = {path.stem: path.read_bytes() for path in (reference / "storage").glob("*.bin")}
assert kept == storage_images.IMAGES, sorted(
    name for name in kept.keys() | storage_images.IMAGES.keys()
    if kept.get(name) != storage_images.IMAGES.get(name))
print(f"storage images: {len(kept)}")
