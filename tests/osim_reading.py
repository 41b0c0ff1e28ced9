"""A plain reader of OpenSim 4 model files with CustomJoints, for tests: transforms from OpenSim's own definitions.

A body's pose is X_parent · P · T(q) · C⁻¹ with the joint's offset frames P and C; T turns by body-fixed rotations 1, 2
and 3 after the translations along axes fixed in P.
"""

from xml.etree import ElementTree as ET

import numpy as np
from scipy.spatial.transform import Rotation


class OsimModel:
    """Bodies, joints and markers of a file."""

    def __init__(self, text):
        self.root = ET.fromstring(text).find("Model")
        self.bodies = {one.get("name"): one for one in self.root.iter("Body")}
        self.joints = list(self.root.iter("CustomJoint"))
        self.coordinates = {one.get("name"): one for one in self.root.iter("Coordinate")}

    def places(self, values):
        """(4, 4) pose in the ground of every body, for values of the coordinates by name."""
        found = {"/ground": np.eye(4)}
        for joint in self.joints:
            frames = {one.get("name"): one for one in joint.iter("PhysicalOffsetFrame")}
            parent, child = (frames[joint.findtext(f"socket_{end}_frame")] for end in ("parent", "child"))
            own = np.linalg.inv(_offset(child))
            found[child.findtext("socket_parent")] = (
                found[parent.findtext("socket_parent")] @ _offset(parent) @ _transform(joint, values) @ own
            )
        return {path.rpartition("/")[2]: pose for path, pose in found.items()}

    def markers(self, values):
        """(3,) place in the ground of every marker."""
        places = self.places(values)
        return {
            one.get("name"): places[one.findtext("socket_parent_frame").rpartition("/")[2]][:3]
            @ [*vector(one.findtext("location")), 1.0]
            for one in self.root.iter("Marker")
        }


def vector(text):
    """The numbers of a text."""
    return np.array(text.split(), float)


def _offset(frame):
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("XYZ", vector(frame.findtext("orientation"))).as_matrix()
    pose[:3, 3] = vector(frame.findtext("translation"))
    return pose


def _transform(joint, values):
    pose = np.eye(4)
    for one in joint.iter("TransformAxis"):
        axis, name = vector(one.findtext("axis")), (one.findtext("coordinates") or "").strip()
        if name:
            slope, start = vector(one.findtext("LinearFunction/coefficients"))
            amount = slope * values[name] + start
        else:
            amount = float(one.findtext("Constant/value"))
        if one.get("name").startswith("rotation"):
            pose[:3, :3] = pose[:3, :3] @ Rotation.from_rotvec(amount * axis).as_matrix()
        else:
            pose[:3, 3] += amount * axis
    return pose
