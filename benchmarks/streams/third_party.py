"""Clients that others wrote read a simulator: a program for an interpreter in which they are installed.

    PYTHON third_party.py qtm-rt PORT FRAMES
    PYTHON third_party.py motioncapture ADDRESS FRAMES
    PYTHON third_party.py motioncapture-vicon ADDRESS FRAMES
    PYTHON third_party.py pyvicon ADDRESS FRAMES

It needs neither mbkf nor this package, and prints one line of JSON. Clients: qtm-rt 3 (MIT), motioncapture 1.1 (MIT),
pyvicon-datastream 0.2.4 (MIT), the DataStream SDK's own client.
"""

from __future__ import annotations

import asyncio
import json
import sys
import threading
import time
import xml.etree.ElementTree as ET
from collections.abc import Callable
from functools import partial
from typing import Any

PATIENCE_S = 20.0


def qtm_rt(port: str, frames: int) -> dict[str, object]:
    """Markers and forces as qtm-rt reads them."""
    import qtm_rt  # type: ignore[import-not-found, unused-ignore]

    seen: list[dict[str, Any]] = []

    async def follow() -> dict[str, object]:
        connection = await qtm_rt.connect("127.0.0.1", int(port) + 1, version="1.25")
        if connection is None:
            return {"failed": "no connection"}
        root = ET.fromstring(await connection.get_parameters(["general", "3d", "force"]))
        enough = asyncio.Event()

        def take(packet: Any) -> None:
            _, markers = packet.get_3d_markers_residual()
            _, plates = packet.get_force()
            forces = [[list(one) for one in samples] for _, samples in plates]
            first = [plate.force_number for plate, _ in plates]
            points = [[one.x, one.y, one.z, one.residual] for one in markers]
            seen.append({"frame": packet.framenumber, "markers": points, "forces": forces, "first": first})
            if len(seen) >= frames:
                enough.set()

        await connection.stream_frames(components=["3dres", "3dnolabelsres", "force"], on_packet=take)
        await asyncio.wait_for(enough.wait(), PATIENCE_S)
        await connection.stream_frames_stop()
        connection.disconnect()
        return {
            "labels": [one.text for one in root.iter("Name") if one.text][: len(seen[0]["markers"])],
            "rate": root.findtext("General/Frequency"),
            "plates": len(root.findall("Force/Plate")),
            "frames": seen[:frames],
        }

    return asyncio.run(follow())


def motioncapture(address: str, frames: int, back_end: str = "qualisys") -> dict[str, object]:
    """Rigid bodies as one of motioncapture's back ends reads them.

    Args:
        address: Address of the server.
        frames: How many frames are read.
        back_end: Its name.
    """
    import motioncapture as library  # type: ignore[import-not-found, unused-ignore]

    client = library.connect(back_end, {"hostname": address})
    seen = []
    for _ in range(frames):
        client.waitForNextFrame()
        bodies = client.rigidBodies
        seen.append({name: [float(value) for value in body.position] for name, body in bodies.items()})
    return {"frames": seen}


def pyvicon(address: str, frames: int) -> dict[str, object]:
    """Markers as the DataStream SDK's client reads them; it counts frames from 1."""
    import pyvicon_datastream as library  # type: ignore[import-not-found, unused-ignore]

    client = library.PyViconDatastream()
    client.connect(address)
    client.enable_marker_data()
    client.set_stream_mode(library.StreamMode.ServerPush)
    seen: list[dict[str, object]] = []
    while len(seen) < frames:
        if client.get_frame() != library.Result.Success or not client.get_subject_count():
            continue
        name = client.get_subject_name(0)
        markers = [client.get_marker_name(name, k) for k in range(client.get_marker_count(name))]
        places = {one: client.get_marker_global_translation(name, one) for one in markers}
        plain = {one: None if at is None else [float(x) for x in at] for one, at in places.items()}
        seen.append({"frame": client.get_frame_number() - 1, "markers": plain})
    return {"frames": seen, "rate": client.get_frame_rate()}


CLIENTS: dict[str, Callable[[str, int], dict[str, object]]] = {
    "qtm-rt": qtm_rt,
    "motioncapture": motioncapture,
    "motioncapture-vicon": partial(motioncapture, back_end="vicon"),
    "pyvicon": pyvicon,
}


def main(words: list[str]) -> None:
    """Reads so many frames and prints them."""
    client, place, frames = words
    threading.Thread(target=_give_up, daemon=True).start()
    try:
        found = CLIENTS[client](place, int(frames))
    except ImportError as error:
        found = {"missing": str(error)}
    print(json.dumps(found), flush=True)


def _give_up() -> None:
    time.sleep(2 * PATIENCE_S)
    print(json.dumps({"failed": "no frames"}), flush=True)
    import os

    os._exit(1)


if __name__ == "__main__":
    main(sys.argv[1:])
