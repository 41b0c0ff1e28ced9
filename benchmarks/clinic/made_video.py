"""A made video whose pictures carry their own number, so that the picture shown is known from its pixels."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

VIDEO_HZ = 25
BITS, CELL_PX = 8, 16
HEIGHT_PX = 48

CODECS = {".mp4": "libx264", ".webm": "libvpx", ".avi": "mpeg4"}
"""Coding by suffix; browsers do not know that of the last."""

READ_NUMBER = f"""() => {{
  const video = document.querySelector("#film video"), canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [{BITS * CELL_PX}, {HEIGHT_PX}];
  const g = canvas.getContext("2d");
  g.drawImage(video, 0, 0);
  let number = 0;
  for (let k = 0; k < {BITS}; k++) {{
    const [red] = g.getImageData(k * {CELL_PX} + {CELL_PX // 2}, {HEIGHT_PX // 2}, 1, 1).data;
    if (red > 127) number += 1 << k;
  }}
  return number;
}}"""
"""Reads the number of the picture that the page's video shows."""


def numbered_video(path: Path, seconds: float) -> Path:
    """Writes a video of vertical bars, white for the ones of the picture's number.

    Args:
        path: File to write; its suffix chooses the coding.
        seconds: Length, at most 2^8 pictures.

    Returns:
        The path.
    """
    import av

    with av.open(str(path), "w") as file:
        stream: Any = file.add_stream(CODECS[path.suffix], rate=VIDEO_HZ)
        stream.width, stream.height, stream.pix_fmt = BITS * CELL_PX, HEIGHT_PX, "yuv420p"
        stream.codec_context.gop_size = VIDEO_HZ
        stream.codec_context.time_base = Fraction(1, VIDEO_HZ)
        for number in range(round(seconds * VIDEO_HZ)):
            frame = av.VideoFrame.from_ndarray(_picture(number), format="rgb24")
            frame.pts = number
            file.mux(stream.encode(frame))
        file.mux(stream.encode())
    return path


def _picture(number: int) -> NDArray[np.uint8]:
    """The picture of a number, (HEIGHT_PX, BITS * CELL_PX, 3)."""
    bits = [255 * (number >> k & 1) for k in range(BITS)]
    row = np.repeat(np.array(bits, dtype=np.uint8), CELL_PX)
    return np.repeat(np.tile(row, (HEIGHT_PX, 1))[:, :, None], 3, axis=2)
