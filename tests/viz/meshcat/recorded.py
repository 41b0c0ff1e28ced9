"""A MeshCat viewer without a server: it keeps what it is sent."""

import meshcat
import numpy as np
from meshcat.path import Path


class Window:
    """The last object, transform, properties and animation of every path."""

    def __init__(self):
        self.objects, self.transforms, self.properties, self.animations = {}, {}, {}, []
        self.opened = 0

    def send(self, command):
        sent = command.lower()
        path = sent.get("path")
        if sent["type"] == "set_object":
            self.objects[path] = sent["object"]
        elif sent["type"] == "set_transform":
            self.transforms[path] = np.reshape(sent["matrix"], (4, 4)).T
        elif sent["type"] == "set_property":
            self.properties[path, sent["property"]] = sent["value"]
        else:
            assert sent["type"] == "set_animation"
            self.animations.append({clip["path"]: clip["clip"] for clip in sent["animations"]})

    def open(self):
        self.opened += 1


def viewer():
    return meshcat.Visualizer(window=Window())


def path(*names):
    found = Path(("meshcat",))
    for name in names:
        found = found.append(name)
    return found.lower()


def keys(clip, name):
    """Times and values of a clip's track."""
    (track,) = (track for track in clip["tracks"] if track["name"] == f".{name}")
    return [key["time"] for key in track["keys"]], [key["value"] for key in track["keys"]]
