"""An OpenSim model made for tests in which every kind of joint and function moves something."""

from __future__ import annotations

from collections.abc import Sequence

SPLINE = "<SimmSpline><x>-1 -0.4 0.3 1 2</x><y>0.1 -0.2 0.15 0.4 0.1</y></SimmSpline>"
AXES = ("1 0 0", "0 0.6 0.8", "0 0 1")


def _frame(name: str, body: str, at: str, turn: str) -> str:
    path = "/ground" if body == "ground" else f"/bodyset/{body}"
    return (
        f'<PhysicalOffsetFrame name="{name}"><socket_parent>{path}</socket_parent><translation>{at}</translation>'
        f"<orientation>{turn}</orientation></PhysicalOffsetFrame>"
    )


def joint(kind: str, parent: str, child: str, coordinates: Sequence[str], more: str = "") -> str:
    """A joint of version 4 with both frames moved and turned."""
    listed = "".join(
        f'<Coordinate name="{name}"><default_value>0.1</default_value><range>-2 2</range><clamped>true</clamped>'
        f"<locked>{str(name == 'held').lower()}</locked></Coordinate>"
        for name in coordinates
    )
    return (
        f'<{kind} name="to_{child}"><socket_parent_frame>p</socket_parent_frame>'
        "<socket_child_frame>c</socket_child_frame>"
        f"<coordinates>{listed}</coordinates><frames>{_frame('p', parent, '0.1 0.2 -0.3', '0.3 -0.5 0.8')}"
        f"{_frame('c', child, '0.02 -0.1 0.05', '-0.2 0.4 1.1')}</frames>{more}</{kind}>"
    )


def spatial_transform(turns: Sequence[tuple[str, str]], shifts: Sequence[tuple[str, str]]) -> str:
    """A spatial transform of (coordinate, function) pairs along :data:`AXES`."""
    made = ""
    for kind, pairs in (("rotation", turns), ("translation", shifts)):
        for k, (coordinate, function) in enumerate(pairs):
            made += (
                f'<TransformAxis name="{kind}{k + 1}"><coordinates>{coordinate}</coordinates><axis>{AXES[k]}</axis>'
                f"{function}</TransformAxis>"
            )
    return f"<SpatialTransform>{made}</SpatialTransform>"


LINE = "<LinearFunction><coefficients>1 0</coefficients></LinearFunction>"
BACK = "<LinearFunction><coefficients>-1 0.2</coefficients></LinearFunction>"
CURVE = "<PolynomialFunction><coefficients>0.3 -0.2 0.1 0.05</coefficients></PolynomialFunction>"
MULTIPLE = f"<MultiplierFunction><function>{SPLINE}</function><scale>1.3</scale></MultiplierFunction>"
BROKEN = "<PiecewiseLinearFunction><x>-1 0 1</x><y>0 0.2 -0.1</y></PiecewiseLinearFunction>"
STILL = "<Constant><value>0.07</value></Constant>"

COUPLER = (
    '<CoordinateCouplerConstraint name="follows"><isEnforced>true</isEnforced><coupled_coordinates_function>'
    f"{SPLINE}</coupled_coordinates_function><independent_coordinate_names>knee</independent_coordinate_names>"
    "<dependent_coordinate_name>patella</dependent_coordinate_name><scale_factor>2</scale_factor>"
    "</CoordinateCouplerConstraint>"
)

JOINTS = (
    joint("FreeJoint", "ground", "root", ("rx", "ry", "rz", "tx", "ty", "tz")),
    joint("BallJoint", "root", "ball", ("b1", "b2", "b3")),
    joint("GimbalJoint", "ball", "gimbal", ("g1", "g2", "g3")),
    joint("UniversalJoint", "gimbal", "universal", ("u1", "u2")),
    joint("PlanarJoint", "root", "planar", ("p1", "p2", "p3")),
    joint("SliderJoint", "planar", "slider", ("held",)),
    joint("WeldJoint", "slider", "welded", ()),
    joint(
        "CustomJoint",
        "welded",
        "shin",
        ("knee", "twist"),
        spatial_transform(
            (("knee", LINE), ("knee", CURVE), ("twist", BACK)),
            (("knee", MULTIPLE), ("", STILL), ("knee", BROKEN)),
        ),
    ),
    joint("PinJoint", "welded", "kneecap", ("patella",)),
)

BODIES = ("root", "ball", "gimbal", "universal", "planar", "slider", "welded", "shin", "kneecap")


def mechanism(joints: Sequence[str] = JOINTS, constraints: str = COUPLER) -> str:
    """The model's text; a marker on every body."""
    bodies = "".join(
        f'<Body name="{name}"><mass>1</mass><mass_center>0 0 0</mass_center><inertia>1 1 1 0 0 0</inertia></Body>'
        for name in BODIES
    )
    markers = "".join(
        f'<Marker name="on_{name}"><socket_parent_frame>/bodyset/{name}</socket_parent_frame>'
        "<location>0.1 -0.3 0.2</location></Marker>"
        for name in BODIES
    )
    return (
        '<?xml version="1.0" encoding="UTF-8" ?><OpenSimDocument Version="40000"><Model name="every_joint">'
        f'<BodySet name="bodyset"><objects>{bodies}</objects></BodySet>'
        f'<JointSet name="jointset"><objects>{"".join(joints)}</objects></JointSet>'
        f'<ConstraintSet name="constraintset"><objects>{constraints}</objects></ConstraintSet>'
        f'<MarkerSet name="markerset"><objects>{markers}</objects></MarkerSet></Model></OpenSimDocument>'
    )
