"""The pictures of a film: the 3-D view of a result at a constant rate, however long each takes to draw."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, StageCallback
from mbkf.errors import InvalidInput
from mbkf.io.results import Reconstruction
from mbkf.viz.film.browser import shown_page
from mbkf.viz.page import asset, page
from mbkf.viz.scene.recording import recording

Picture = NDArray[np.uint8]
"""(height, width, 3) red, green, blue."""


STARTED = "() => window.mbkf || document.getElementById('trouble').textContent"
"""True in a page whose view has started or has stated why it cannot."""

STARTS_WITHIN_MS = 120_000.0
"""A view starts in 1 to 2 s; one whose script ended in an error never does."""


@dataclass(frozen=True)
class FilmSettings:
    """Rate and size of a film.

    Attributes:
        rate_hz: Pictures per second; GIF counts hundredths of a second, so a divisor of 100 is exact.
        width, height: Pixels, both even for most players.
    """

    rate_hz: int = 25
    width: int = 1280
    height: int = 720


def film_pictures(
    r: Reconstruction, settings: FilmSettings, progress: StageCallback | None = None
) -> Iterator[Picture]:
    """The pictures, one after another, from the first frame in which the body is tracked.

    Args:
        r: The result.
        settings: Rate and size.
        progress: Called with the stage, pictures drawn and their total.

    Raises:
        MissingDependency: playwright is not installed.
        InvalidInput: The result tracks the body in no frame, or no browser draws it.
    """
    if not r.tracked.any():
        raise InvalidInput(
            f"the result of '{r.trial}' tracks the body in no frame, so there is no motion to film"
        )
    played = recording(r)
    scene = cast(dict[str, Any], played["scene"])
    times = r.times_s[:: round(r.rate_hz / scene["rate_hz"])]
    size = settings.width, settings.height
    with shown_page(page(played), *size) as shown:
        shown.wait_for_function(STARTED, timeout=STARTS_WITHIN_MS)
        shown.evaluate(asset("film.js"))
        shown.evaluate("words => film.begin(words)", [*size, scene["title"]])
        rows = film_rows(times, scene["first_tracked"], settings.rate_hz)
        for drawn, row in enumerate(rows):
            if progress is not None:
                progress("Drawing", drawn, len(rows))
            yield _decoded(shown.evaluate("words => film.picture(words)", [int(row), float(times[row])]))


def film_rows(times_s: Array, first: int, rate_hz: float) -> NDArray[np.intp]:
    """(P,) row of each picture, the nearest in time.

    Args:
        times_s: (T,) times of the rows, s, rising.
        first: Row of the first picture.
        rate_hz: Pictures per second.
    """
    count = int(np.floor((times_s[-1] - times_s[first]) * rate_hz + 1e-6)) + 1
    wanted = times_s[first] + np.arange(count) / rate_hz
    after = np.clip(np.searchsorted(times_s, wanted), 1, max(1, len(times_s) - 1))
    if len(times_s) == 1:
        return np.zeros(count, dtype=np.intp)
    return np.asarray(after - (wanted - times_s[after - 1] < times_s[after] - wanted), dtype=np.intp)


def _decoded(address: str) -> Picture:
    """The picture in a data address of PNG."""
    from PIL import Image

    with Image.open(io.BytesIO(base64.b64decode(address.partition(",")[2]))) as image:
        return np.asarray(image.convert("RGB"))
