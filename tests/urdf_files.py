"""URDF files written for tests: links with boxes' inertias, joints, and the side file of a small body."""

from pathlib import Path

SIDE = """\
reference_height_m = 1.2

[roles]
feet = ["right_foot", "left_foot"]

[sole]
height_m = -0.05
heel_x_m = -0.06
ball_x_m = 0.1
toe_x_m = 0.16
inner_y_m = 0.04
outer_y_m = -0.04
"""


def link(name, mass=1.0, moments=(0.02, 0.03, 0.04), products=(0.0, 0.0, 0.0), com="0 0 -0.1", turn="0 0 0"):
    """A link; without <inertial> where its mass is None."""
    if mass is None:
        return f'<link name="{name}"/>'
    (xx, yy, zz), (xy, xz, yz) = moments, products
    return (
        f'<link name="{name}"><inertial><origin xyz="{com}" rpy="{turn}"/><mass value="{mass}"/>'
        f'<inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="{xy}" ixz="{xz}" iyz="{yz}"/></inertial></link>'
    )


def joint(name, parent, child, kind="revolute", at="0 0 0", axis="0 1 0", turn="0 0 0", extra=""):
    if kind == "revolute" and "<limit" not in extra:
        extra += '<limit lower="-10" upper="10" effort="1" velocity="1"/>'
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{at}" rpy="{turn}"/><axis xyz="{axis}"/>{extra}</joint>'
    )


def leg(side, y):
    """Thigh, shank and foot with hinges about y, and a sensor that is fixed to the shank."""
    thigh, shank, foot = (f"{side}_{name}" for name in ("thigh", "shank", "foot"))
    limit = '<limit lower="0" upper="2.5" effort="1" velocity="1"/>'
    return [
        link(thigh, 4.0), link(shank, 2.0), link(foot, 0.5), link(f"{side}_sensor", None),
        joint(f"{side}_hip", "pelvis", thigh, at=f"0 {y} -0.1"),
        joint(f"{side}_knee", thigh, shank, at="0 0 -0.4", extra=limit),
        joint(f"{side}_ankle", shank, foot, "continuous", at="0 0 -0.4"),
        joint(f"{side}_strap", shank, f"{side}_sensor", "fixed", at="0.05 0 -0.2"),
    ]  # fmt: skip


def biped(*more):
    return [link("pelvis", 20.0), *leg("right", -0.1), *leg("left", 0.1), *more]


def written(folder: Path, parts, side: str | None = SIDE, name="small"):
    """The path of a URDF file of these parts, with its side file."""
    path = folder / f"{name}.urdf"
    path.write_text(f'<?xml version="1.0"?>\n<robot name="{name}">{"".join(parts)}</robot>\n', "utf-8")
    if side is not None:
        (folder / f"{name}.urdf.toml").write_text(side, "utf-8")
    return path
