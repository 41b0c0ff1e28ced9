"""A reference body as records: segments, joints, inertias, landmarks, roles, clinical angles, shapes and skin.

:mod:`mbkf.model.body_file` reads them from a file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import UnknownName
from mbkf.model.clinical_table import ClinicalJoint

JOINT_DOF = {"free": 6, "spherical": 3, "universal": 2, "hinge": 1}
"""Degrees of freedom of each kind of joint."""


@dataclass(frozen=True)
class Segment:
    """One rigid segment of the reference body, in its own frame (origin at its proximal joint).

    Attributes:
        name: Segment name, e.g. ``"right_thigh"``.
        parent: Proximal segment, ``"world"`` for the root.
        joint: Kind of its proximal joint, a key of :data:`JOINT_DOF`.
        axes: Axes that a hinge ("y") or a universal joint ("xy", in this order) turns about; "" for the others.
        origin_m: (3,) its proximal joint in the parent's frame, m.
        mass_kg: Reference mass.
        com_m: (3,) reference centre of mass, m.
        inertia_kg_m2: (3,) reference moments about the centre of mass and the segment's axes, kg m².
        scale_matrix: (3, K) rows that turn the K independent factors into the x, y, z factors.
        length_index: Index of the independent factor that is the length factor k: moments of inertia grow as k_m k²
            with the mass factor k_m.
        posture_sd_rad: (dof,) spread of the joint about the neutral standing posture, rad (0: no prior).
        acceleration_sd: (dof,) typical acceleration of each dof, m/s² or rad/s².
        movement_sd: (dof,) standard deviation of the acceleration of each dof over a movement, m/s² or rad/s².
        limits_rad: (dof, 2) least and greatest rotation about each axis; ±inf without a limit.
        products_kg_m2: (3,) entries xy, xz and yz of the inertia matrix; 0 where the axes are principal ones.
        axis: (3,) unit vector that an oblique hinge turns about, nearest to the axis of ``axes``; None where a joint
            turns about ``axes`` themselves.
    """

    name: str
    parent: str
    joint: str
    axes: str
    origin_m: Array
    mass_kg: float
    com_m: Array
    inertia_kg_m2: Array
    scale_matrix: Array
    length_index: int
    posture_sd_rad: Array
    acceleration_sd: Array
    movement_sd: Array
    limits_rad: Array
    products_kg_m2: Array = field(default_factory=lambda: read_only(np.zeros(3)))
    axis: Array | None = None

    @property
    def inertia_matrix_kg_m2(self) -> Array:
        """(3, 3) reference inertia about the centre of mass in the segment's axes."""
        xy, xz, yz = self.products_kg_m2
        return np.diag(self.inertia_kg_m2) + np.array([[0.0, xy, xz], [xy, 0.0, yz], [xz, yz, 0.0]])


@dataclass(frozen=True)
class Landmark:
    """A named point of a segment: reference ``position_m`` (3,) in the segment's frame."""

    name: str
    segment: str
    position_m: Array


@dataclass(frozen=True)
class Sole:
    """Rectangle under a foot, in the foot's frame, m.

    Attributes:
        segment: The foot.
        height_m: Its z.
        heel_x_m, ball_x_m, toe_x_m: Its rear end, the line where the toes bend, its front end.
        inner_y_m, outer_y_m: Its edges towards the midline and away from it.
    """

    segment: str
    height_m: float
    heel_x_m: float
    ball_x_m: float
    toe_x_m: float
    inner_y_m: float
    outer_y_m: float


@dataclass(frozen=True)
class Bearing:
    """A part of the body, besides the feet, that may bear load: a knee on the floor, the pelvis on a seat, a hand.

    Attributes:
        name: Its name, e.g. ``"right_knee"``.
        segment: The segment that the load acts on.
        position_m: (3,) middle of the part in the segment's frame.
        radius_m: From the middle to the surface that touches.
        lever_m: Greatest distance of the centre of pressure from the middle.
    """

    name: str
    segment: str
    position_m: Array
    radius_m: float
    lever_m: float


@dataclass(frozen=True)
class Roles:
    """Roles of segments in the algorithms; paired ones right side first.

    Attributes:
        root: The segment whose joint is free: it carries the residual force and moment.
        feet: The two segments that take ground reactions.
        toes: The segments that bend on the feet, in the order of the feet; empty where feet are rigid. Ground reactions
            act on the foot as a whole, so that toes have no torque of their own.
        soles: The soles of the feet, in their order.
        legs: The segments from the root (without it) to the feet.
        leading: Segments whose joints, with the root, lead those that no marker shows (arms swing with the legs).
        steady: Segments whose markers the skin moves little, from the floor to the root.
        knees: Thigh and shank of each leg: the shank bends one way only.
    """

    root: str
    feet: tuple[str, str]
    toes: tuple[str, ...]
    soles: tuple[Sole, Sole]
    legs: tuple[str, ...]
    leading: tuple[str, ...]
    steady: tuple[str, ...]
    knees: tuple[tuple[str, str], ...]

    @property
    def lower_body(self) -> frozenset[str]:
        """The root, and the segments of legs, feet and toes."""
        return frozenset((self.root, *self.legs, *self.feet, *self.toes))


@dataclass(frozen=True)
class SegmentShape:
    """A simple shape of a segment of the reference body, for drawing only, in the segment's frame.

    Attributes:
        segment: The segment.
        kind: "limb" (tapered, from the segment's origin to the joint of ``to``), "ellipsoid", "tube" (elliptic
            sections), "foot" or "toes" (drawn from the sole).
        numbers: limb: its radii at both ends, m; ellipsoid: centre and semi-axes, m; tube: x, z of the centre, half
            depth and half breadth of each section, m; otherwise empty.
        to: The segment at whose joint a limb ends, "" for other shapes.
    """

    segment: str
    kind: str
    numbers: Array
    to: str = ""


@dataclass(frozen=True)
class SegmentSkin:
    """Movement of a segment's skin on its bone as neighbouring joints flex.

    Attributes:
        segment: The segment.
        flexions: For each flexion that moves the skin, the distal segments of its joints, which turn about y; of
            several joints their mean counts.
        common_m: Spread of the displacement that all markers of the segment share, per coordinate, at
            :data:`mbkf.sensors.flexed_skin.FLEXED_RAD`, m.
        own_m: The same of one marker's own, m.
    """

    segment: str
    flexions: tuple[tuple[str, ...], ...]
    common_m: float
    own_m: float


@dataclass(frozen=True)
class JointCentre:
    """Spread of a joint's centre about the place that the scale factors give.

    Attributes:
        segment: The segment after the joint.
        sd_m: (3,) spread along the axes of the segment before it, m.
    """

    segment: str
    sd_m: Array


@dataclass(frozen=True)
class TrunkLevel:
    """A level of the spine inside the root segment, at which the trunk's net moment is stated.

    The section cuts the root segment: its part above the level counts with the trunk and moves with the root.

    Attributes:
        name: Its name, e.g. "L5/S1".
        above: The segment that all segments above the level hang on; its spherical joint hangs on the root.
        position_m: (3,) middle of the section in the root's frame; None at the joint of the segment above.
        sd_m: (3,) spread of that place among persons.
        part_mass_kg: Mass of the root segment's part above the level; 0 without one.
        part_com_m: (3,) its centre of mass in the root's frame.
        part_inertia_kg_m2: (3,) its principal moments about that.
        opensim: OpenSim's name of the coordinates of a joint at that level, e.g. "lumbar"; "" where it has none.
    """

    name: str
    above: str
    position_m: Array | None
    sd_m: Array
    part_mass_kg: float
    part_com_m: Array
    part_inertia_kg_m2: Array
    opensim: str

    @property
    def column(self) -> str:
        """Beginning of its columns in tables: OpenSim's name, else its own, e.g. "l5_s1"."""
        return self.opensim or self.name.replace("/", "_").lower()


@dataclass(frozen=True)
class ShoulderGirdle:
    """Displacement of a shoulder on the trunk as its arm is raised, with the clavicle and the shoulder blade.

    Attributes:
        segment: The segment after the shoulder, a spherical joint.
        mean_m: (3,) expected displacement along the axes of the segment before it, the arm horizontal, m.
        sd_m: (3,) its spread among people, m.
        held_m: (3,) spread of the displacement in which the shoulder is held throughout a trial, m.
    """

    segment: str
    mean_m: Array
    sd_m: Array
    held_m: Array


@dataclass(frozen=True)
class Approximation:
    """A joint of another program's model that the body has in a simpler form.

    Attributes:
        segment: The segment whose markers it displaces.
        rms_m: Distance by which it does, RMS.
        text: The approximation in words.
    """

    segment: str
    rms_m: float
    text: str


@dataclass(frozen=True, eq=False)
class BodyDescription:
    """A reference body; equal to itself only, so that results for it can be cached.

    Attributes:
        name: Its name.
        reference_mass_kg: Mass of the reference person; the segments' masses sum to it.
        reference_height_m: Height of the reference person.
        scale_factors: Names of the independent scale factors.
        split_factors: By name of a factor, the one that it was part of, whose value it has where it is not stated.
        segments: The segments, depth-first.
        landmarks: Landmarks by name.
        roles: Roles of segments in the algorithms.
        clinical_joints: The clinical coordinates of every segment's joint, in the order of the segments.
        shapes: Shapes for drawing, by segment; segments without one are drawn as plain limbs.
        bearings: Parts that may bear load besides the feet, by name.
        joint_centres: Joint centres that differ from the scale factors' by a spread.
        skin: Movement of the skin, by segment; that of other segments does not depend on the posture.
        levels: Levels of the spine at which the trunk's net moment is stated, from the highest one down.
        girdle: Shoulders that are displaced as the arms are raised.
        approximations: Joints that another program's model has in another form.
        text: The file it was read from, word for word; "" for the bodies that come with mbkf.
    """

    name: str
    reference_mass_kg: float
    reference_height_m: float
    scale_factors: tuple[str, ...]
    split_factors: dict[str, str]
    segments: tuple[Segment, ...]
    landmarks: dict[str, Landmark]
    roles: Roles
    clinical_joints: tuple[ClinicalJoint, ...]
    shapes: dict[str, SegmentShape]
    bearings: dict[str, Bearing]
    joint_centres: tuple[JointCentre, ...]
    skin: dict[str, SegmentSkin]
    levels: tuple[TrunkLevel, ...] = ()
    girdle: tuple[ShoulderGirdle, ...] = ()
    approximations: tuple[Approximation, ...] = ()
    text: str = ""

    @property
    def sole(self) -> Sole:
        """The right foot's sole; the left one mirrors it in y."""
        return self.roles.soles[0]

    def segment(self, name: str) -> Segment:
        """The segment of that name.

        Raises:
            UnknownName: There is none.
        """
        for segment in self.segments:
            if segment.name == name:
                return segment
        raise UnknownName("segment", name, [s.name for s in self.segments])

    def scale(self, factors: Mapping[str, float]) -> Array:
        """(K,) scale factors from named ones: a split factor has the value of its origin, another one 1 by default.

        Args:
            factors: Scale factors by name.
        """
        origin = {name: self.split_factors.get(name, name) for name in self.scale_factors}
        return np.array([factors.get(name, factors.get(origin[name], 1.0)) for name in self.scale_factors])

    def landmark(self, name: str) -> Landmark:
        """The landmark of that name (``right_``/``left_`` prefix for paired ones).

        Raises:
            UnknownName: There is none.
        """
        if name not in self.landmarks:
            raise UnknownName("landmark", name, self.landmarks)
        return self.landmarks[name]
