"""OpenSim files made for tests: one skeleton in the forms of version 3 and of version 4, and marker sets."""

from __future__ import annotations

from collections.abc import Iterable

Joint = tuple[str, str, tuple[float, float, float]]
Marker = tuple[str, str, tuple[float, float, float], bool]

LEG: tuple[Joint, ...] = (
    ("femur", "tibia", (0.0, -0.4, 0.0)),
    ("tibia", "talus", (0.0, -0.4, 0.0)),
    ("talus", "calcn", (-0.05, -0.04, 0.01)),
    ("calcn", "toes", (0.18, 0.0, 0.0)),
)
ARM: tuple[Joint, ...] = (
    ("humerus", "ulna", (0.01, -0.3, -0.01)),
    ("ulna", "radius", (-0.01, -0.01, 0.03)),
    ("radius", "hand", (0.0, -0.24, 0.01)),
)


def skeleton(arms: bool = True) -> list[Joint]:
    """A person's joints: parent, child, and the child's origin in the parent."""
    found: list[Joint] = [("ground", "pelvis", (0.0, 0.0, 0.0)), ("pelvis", "torso", (-0.1, 0.08, 0.0))]
    for side, z in (("r", 1.0), ("l", -1.0)):
        found.append(("pelvis", f"femur_{side}", (-0.07, -0.07, z * 0.08)))
        limbs = LEG
        if arms:
            found.append(("torso", f"humerus_{side}", (0.0, 0.37, z * 0.17)))
            limbs = LEG + ARM
        found += [(f"{p}_{side}", f"{c}_{side}", (at[0], at[1], z * at[2])) for p, c, at in limbs]
    return found


def _said(values: Iterable[float]) -> str:
    return " ".join(f"{value:g}" for value in values)


def marker_set(markers: Iterable[Marker], version: int) -> str:
    """A MarkerSet element."""
    made = []
    for name, body, at, fixed in markers:
        on = (
            f"<body> {body} </body>"
            if version < 4
            else f"<socket_parent_frame>/bodyset/{body}</socket_parent_frame>"
        )
        made.append(
            f'<Marker name="{name}">{on}<location> {_said(at)} </location><fixed>{str(fixed).lower()}</fixed></Marker>'
        )
    return f'<MarkerSet name="set"><objects>\n{chr(10).join(made)}\n</objects></MarkerSet>'


def osim_3(joints: Iterable[Joint], markers: Iterable[Marker]) -> str:
    """A model as versions 2 and 3 write it: a body holds the joint to its parent."""
    bodies = '<Body name="ground"><mass>0</mass><Joint/></Body>' + "\n".join(
        f'<Body name="{child}"><mass>1</mass><Joint><CustomJoint name="to_{child}"><parent_body>{parent}</parent_body>'
        f"<location_in_parent>{_said(at)}</location_in_parent><orientation_in_parent>0 0 0</orientation_in_parent>"
        "<location>0 0 0</location><orientation>0 0 0</orientation></CustomJoint></Joint></Body>"
        for parent, child, at in joints
    )
    return (
        '<?xml version="1.0" encoding="UTF-8" ?><OpenSimDocument Version="30000"><Model name="made">'
        f"<BodySet><objects>{bodies}</objects></BodySet>{marker_set(markers, 3)}</Model></OpenSimDocument>"
    )


def osim_4(joints: Iterable[Joint], markers: Iterable[Marker], turn: str = "0 0 0") -> str:
    """A model as version 4 writes it; both frames of a joint are turned alike, which changes nothing."""
    joints = list(joints)
    bodies = "".join(f'<Body name="{child}"><mass>1</mass></Body>' for _, child, _ in joints)

    def offset(body: str, at: Iterable[float]) -> str:
        path = "/ground" if body == "ground" else f"/bodyset/{body}"
        return (
            f'<PhysicalOffsetFrame name="{body}_offset"><socket_parent>{path}</socket_parent>'
            f"<translation>{_said(at)}</translation><orientation>{turn}</orientation></PhysicalOffsetFrame>"
        )

    made = "".join(
        f'<PinJoint name="to_{child}"><socket_parent_frame>{parent}_offset</socket_parent_frame>'
        f"<socket_child_frame>{child}_offset</socket_child_frame>"
        f"<frames>{offset(parent, at)}{offset(child, (0, 0, 0))}</frames></PinJoint>"
        for parent, child, at in joints
    )
    return (
        '<?xml version="1.0" encoding="UTF-8" ?><OpenSimDocument Version="40000"><Model name="made">'
        f"<BodySet><objects>{bodies}</objects></BodySet><JointSet><objects>{made}</objects></JointSet>"
        f"{marker_set(markers, 4)}</Model></OpenSimDocument>"
    )
