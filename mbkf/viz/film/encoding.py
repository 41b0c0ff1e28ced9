"""Pictures as a film's file: MP4 (H.264) or GIF."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path

from mbkf.io.written import MARK
from mbkf.stream.libraries import library
from mbkf.viz.film.pictures import Picture

QUALITY = {"crf": "20", "preset": "medium"}
"""Settings of H.264: text stays sharp, and ten seconds take about a megabyte."""

COLOURS = 128
"""Colours of a GIF's picture."""


def write_mp4(pictures: Iterable[Picture], rate_hz: int, path: Path) -> None:
    """Writes an MP4 file that plays before it is fully loaded.

    Args:
        pictures: Pictures of one even size.
        rate_hz: Pictures per second.
        path: The file.

    Raises:
        MissingDependency: PyAV is not installed.
        OSError: The file cannot be written.
    """
    av = library("av", "a film as MP4", "film")
    with av.open(str(path), "w", format="mp4", options={"movflags": "+faststart"}) as file:
        file.metadata["comment"] = MARK
        stream = None
        for number, picture in enumerate(pictures):
            if stream is None:
                stream = file.add_stream("libx264", rate=rate_hz, options=QUALITY)
                stream.height, stream.width = picture.shape[:2]
                stream.pix_fmt = "yuv420p"
            frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
            frame.pts, frame.time_base = number, Fraction(1, rate_hz)
            file.mux(stream.encode(frame))
        if stream is not None:
            file.mux(stream.encode(None))


def write_gif(pictures: Iterable[Picture], rate_hz: int, path: Path) -> None:
    """Writes a GIF file that repeats forever.

    Args:
        pictures: Pictures of one size.
        rate_hz: Pictures per second; GIF counts whole hundredths of a second.
        path: The file.

    Raises:
        OSError: The file cannot be written.
    """
    from PIL import Image

    reduced = (
        Image.fromarray(picture).quantize(COLOURS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
        for picture in pictures
    )
    first = next(reduced)
    first.save(
        path,
        "GIF",
        save_all=True,
        append_images=reduced,
        duration=1000 // rate_hz,
        loop=0,
        disposal=1,
        comment=MARK.encode(),
    )
