"""Draws the gallery's pictures: ``python docs/gallery/make.py [NAME …]``, with ``MBKF_DATA`` set.

Runs every example, or those named, and keeps its picture, ``NAME.png``, and the lines that it prints, ``NAME.txt``.
"""

import io
import runpy
import sys
from contextlib import chdir, redirect_stdout
from pathlib import Path

from PIL import Image

HERE = Path(__file__).resolve().parent
EXAMPLES = sorted(path for path in HERE.glob("*.py") if path.name != "make.py")
COLOURS = 64  # few colours make small files


def draw(example: Path, folder: Path) -> None:
    """Writes picture and printed lines of an example into a folder."""
    with chdir(folder), redirect_stdout(io.StringIO()) as printed:
        runpy.run_path(str(example), run_name="__main__")
    (folder / f"{example.stem}.txt").write_text(printed.getvalue(), encoding="utf-8")
    picture = folder / f"{example.stem}.png"
    with Image.open(picture) as drawn:
        reduced = drawn.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    reduced.save(picture, optimize=True)


if __name__ == "__main__":
    for one in EXAMPLES:
        if not sys.argv[1:] or one.stem in sys.argv[1:]:
            draw(one, HERE)
            print(f"{one.stem}: {one.with_suffix('.png').stat().st_size / 1000:.0f} kB")
