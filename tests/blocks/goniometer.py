"""The goniometer of docs/own_sensor.md, word for word, so that the tests of every block hold for it."""

from pathlib import Path

EXAMPLE = Path(__file__).resolve().parents[2] / "docs" / "examples" / "15_goniometer.py"


def block_source():
    """Imports and class of the example, as far as its script."""
    text = EXAMPLE.read_text(encoding="utf-8")
    return text[text.index("import numpy") : text.index("\n\n\nperson")]


exec(block_source())
