"""Every ``while`` of the computation states the bound after which it ends; a new one fails here until it does."""

import ast
from collections.abc import Iterator
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1] / "mbkf"

ROOMS = (
    "numerics", "kernel", "model", "sensors", "scaling", "labelling", "filters", "imu", "synthesis", "marker_sets",
    "trial",
)  # fmt: skip

BOUNDS = {
    "numerics/levenberg_marquardt.py minimise": "the damping grows faster than powers of 2, up to 1e10",
    "numerics/line_search.py maximise": "each round calls the function, of which calls are given, or shrinks a step",
    "sensors/observability.py observability_matrix": "n blocks",
    "filters/tracking_loop.py followed": "the frame grows by one, and goes back at most eight times",
    "sensors/supports/sharing.py shares": "each round leaves out one of the parts",
    "labelling/keyframes.py _differing": "count frames",
    "imu/turned_force.py mean_force": "each round doubles the reach",
    "imu/segment_course.py configurations": "goes up a tree, which check_body has checked",
    "synthesis/cameras.py ghosts": "the time grows by two frames or more",
    "model/body_checks.py _tree": "each round shortens the chain",
    "model/body_file.py _chain": "no segment stands twice in the chain",
    "trial/checks/orientation.py axes_findings": "each round settles one plate",
    "trial/gait/convention_angles.py _chain": "up the tree of segments to its root",
    "trial/inertial/mounted_reversed.py mounted_reversed": "one exchange, and each round takes one group away",
    "trial/labelling/single_pass.py LabellingPass.run": "the frame grows by one or more",
    "trial/labelling/single_pass.py LabellingPass._follow": "the frame grows by one",
    "trial/live/filter.py LiveFilter._due": "a frame is answered, or starts anew, which answers it",
    "trial/live/labels.py LiveLabels._named": "the frame moves through those that wait",
    "trial/live/labels.py LiveLabels._unnamed": "each round takes one frame that waits",
    "trial/protocol/from_osim.py _Skeleton._in_segment": "goes up a tree, which check_body has checked",
    "trial/protocol/osim_bodies.py poses_at_zero": "each round places one body",
    "model/symbolic/recursions.py mass_matrix": "goes up a tree, whose joints follow their parents",
    "model/symbolic/tree.py SymbolicTree.chain": "goes up a tree, whose joints follow their parents",
    "model/urdf_segments.py _chain": "three joints at most",
    "model/urdf_segments.py _grow": "each link of a tree comes once",
    "model/urdf_segments.py urdf_segments": "each joint of a tree comes once",
    "model/urdf_tree.py read_urdf_tree": "no link has two parents, so that each link below the root comes once",
    "model/skeleton.py joint_origin": "goes up a tree, which check_body has checked",
    "trial/results/validity.py joints_to_root": "goes up a tree, which check_body has checked",
}
"""Function of each loop, and why it ends."""


def loops(path: Path) -> Iterator[str]:
    """Names of the functions with a while loop, with their file."""

    def visit(node: ast.AST, name: str) -> Iterator[str]:
        for child in ast.iter_child_nodes(node):
            inner = f"{name}.{child.name}" if isinstance(child, ast.FunctionDef | ast.ClassDef) else name
            if isinstance(child, ast.While):
                yield f"{path.relative_to(PACKAGE).as_posix()} {inner.lstrip('.')}"
            yield from visit(child, inner)

    return visit(ast.parse(path.read_text(encoding="utf-8")), "")


def test_every_loop_has_a_bound_and_every_bound_a_loop():
    found = {one for room in ROOMS for path in (PACKAGE / room).rglob("*.py") for one in loops(path)}
    assert sorted(found) == sorted(BOUNDS)


def test_an_endless_iterator_is_used_nowhere_in_the_computation():
    """``itertools.count`` and ``cycle`` hide a loop without a bound."""
    texts = {
        path: path.read_text(encoding="utf-8") for room in ROOMS for path in (PACKAGE / room).rglob("*.py")
    }
    named = ("itertools.count", "itertools.cycle", "import count", "import cycle", "iter(int")
    assert [path for path, text in texts.items() if any(word in text for word in named)] == []
