"""Clients that others wrote read a simulator: a program for an interpreter in which they are installed.

    PYTHON third_party.py qtm-rt PORT FRAMES
    PYTHON third_party.py motioncapture ADDRESS FRAMES

It needs neither mbkf nor this package, and prints one line of JSON. Clients: qtm-rt 3 (MIT), motioncapture 1.1 (MIT).
"""

from __future__ import annotations

import asyncio
import json
import sys
import threading
import time
import xml.etree.ElementTree as ET
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


def motioncapture(address: str, frames: int) -> dict[str, object]:
    """Rigid bodies as motioncapture's back end for Qualisys reads them."""
    import motioncapture as library  # type: ignore[import-not-found, unused-ignore]

    client = library.connect("qualisys", {"hostname": address})
    seen = []
    for _ in range(frames):
        client.waitForNextFrame()
        bodies = client.rigidBodies
        seen.append({name: [float(value) for value in body.position] for name, body in bodies.items()})
    return {"frames": seen}


def main(words: list[str]) -> None:
    """Reads so many frames and prints them."""
    client, place, frames = words
    threading.Thread(target=_give_up, daemon=True).start()
    print(
        json.dumps({"qtm-rt": qtm_rt, "motioncapture": motioncapture}[client](place, int(frames))), flush=True
    )


def _give_up() -> None:
    time.sleep(2 * PATIENCE_S)
    print(json.dumps({"failed": "no frames"}), flush=True)
    import os

    os._exit(1)


if __name__ == "__main__":
    main(sys.argv[1:])
