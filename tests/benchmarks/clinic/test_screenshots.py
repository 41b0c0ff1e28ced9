"""Pictures of pages: each is in the table, shown once or more and kept; a blank or another one is found."""

from itertools import pairwise

import numpy as np

from benchmarks.clinic.screenshots import coloured, different, shown_pictures
from benchmarks.screenshots.picture import MOST_BYTES, keep, pixels, stacked
from benchmarks.screenshots.table import FOLDER, PICTURES


def test_every_picture_of_readme_and_docs_is_in_the_table_and_kept():
    kept = {file.stem: file for file in FOLDER.glob("screenshot_*.png")}
    assert set(PICTURES) == shown_pictures() == set(kept)
    assert all(one < other for one, other in pairwise(PICTURES))
    for name, (width, height) in PICTURES.items():
        assert pixels(kept[name]).shape == (height, width, 3)
        assert kept[name].stat().st_size <= MOST_BYTES


def test_a_kept_picture_looks_as_it_was_taken(tmp_path):
    from PIL import Image

    made = np.zeros((40, 300, 3), dtype=np.uint8)
    made[..., 0] = np.arange(300) * 255 // 299
    made[:20, :, 2] = made[:20, ::-1, 0]
    made[0, 0] = (0, 255, 0)
    Image.fromarray(made).save(tmp_path / "a.png")
    png = (tmp_path / "a.png").read_bytes()
    keep(stacked([png, png], 5, beside=True), tmp_path / "b.png")
    found = pixels(tmp_path / "b.png")
    assert found.shape == (50, 615, 3)
    apart = np.abs(found[5:45, 5:305].astype(int) - made)
    assert apart.max() <= 12 and list(found[5, 5]) == [0, 255, 0], "a rare colour stays"


def test_a_blank_picture_and_another_one_are_found():
    blank = np.full((10, 10, 3), 250, dtype=np.uint8)
    marked = blank.copy()
    marked[:5] = 10
    assert (coloured(blank), coloured(marked)) == (0.0, 50.0)
    assert (different(blank, blank - 20), different(blank, marked), different(blank, blank[:5])) == (
        0.0,
        50.0,
        100.0,
    )
