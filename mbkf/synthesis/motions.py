"""Registry of the motions that can be synthesised: each has a name, a plan, a usual duration and a random stream.

A motion of one's own joins the built-in ones by a decorator, and then has its place in :func:`motion_names`, in error
messages and in :func:`mbkf.synthesis.motion.synthesise_motion`::

    @register_motion("sway", seconds=5.0)
    def sway_plan(model, seconds, rng): ...

The built-in motions are imported when one is planned, so that this module stays light; modules of other installed
packages (group ``mbkf.motions``, :mod:`mbkf.io.installed`) when an unknown name or all names are asked for.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbkf.errors import InvalidInput, UnknownName
from mbkf.io.installed import MOTIONS, import_installed

if TYPE_CHECKING:
    import numpy as np

    from mbkf.model.body import Body
    from mbkf.synthesis.plan import MotionPlan

    Planner = Callable[[Body, float, np.random.Generator], MotionPlan]


@dataclass(frozen=True)
class RegisteredMotion:
    """A motion that can be synthesised.

    Attributes:
        name: Its name on the command line and in files.
        planner: Makes the plan from a body, a duration in s and a random generator.
        seconds: Usual duration, s.
        stream: Number that, with the seed, starts the motion's random generator.
        trial: Whether it is offered as a trial; a motion for static captures is not.
    """

    name: str
    planner: Planner
    seconds: float
    stream: int
    trial: bool = True


_MOTIONS: dict[str, RegisteredMotion] = {}


def register_motion(
    name: str, *, seconds: float, stream: int | None = None, trial: bool = True
) -> Callable[[Planner], Planner]:
    """Decorator that registers the planner of a motion.

    Args:
        name: Name of the motion.
        seconds: Usual duration, s.
        stream: Number of its random stream; by default one made from the name.
        trial: Whether it is offered as a trial.

    Raises:
        InvalidInput: The name is empty or taken.
    """

    def register(planner: Planner) -> Planner:
        own = zlib.crc32(name.encode()) if stream is None else stream
        if not name or name in _MOTIONS:
            raise InvalidInput(f"a motion '{name}' cannot be registered: the name is empty or taken")
        _MOTIONS[name] = RegisteredMotion(name, planner, seconds, own, trial)
        return planner

    return register


def registered_motion(name: str) -> RegisteredMotion:
    """The motion of a name.

    Raises:
        UnknownName: The motion does not exist; lists the known ones.
    """
    if name not in _MOTIONS:
        import_installed(MOTIONS)
    if name not in _MOTIONS:
        raise UnknownName("motion", name, _MOTIONS)
    return _MOTIONS[name]


def motion_names(*, static: bool = False, installed: bool = True) -> tuple[str, ...]:
    """Names of the motions offered as trials, in the order of registration.

    Args:
        static: Other motions as well.
        installed: Import the motions of other installed packages first.
    """
    if installed:
        import_installed(MOTIONS)
    return tuple(name for name, motion in _MOTIONS.items() if motion.trial or static)


@register_motion("squat", seconds=5.0, stream=1)
def _squat(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.squat import squat_plan

    return squat_plan(model, seconds, rng)


@register_motion("walk", seconds=4.0, stream=3)
def _walk(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.walk import walk_plan

    return walk_plan(model, seconds, rng)


@register_motion("jump", seconds=3.0, stream=0)
def _jump(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.jump import jump_plan

    return jump_plan(model, seconds, rng)


@register_motion("turn", seconds=4.5, stream=4)
def _turn(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.turn import turn_plan

    return turn_plan(model, seconds, rng)


@register_motion("one_foot", seconds=5.5, stream=5)
def _one_foot(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.one_foot import one_foot_plan

    return one_foot_plan(model, seconds, rng)


@register_motion("reach", seconds=5.5, stream=6)
def _reach(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.reach import reach_plan

    return reach_plan(model, seconds, rng)


@register_motion("step_up", seconds=4.0, stream=7)
def _step_up(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.step_up import step_up_plan

    return step_up_plan(model, seconds, rng)


@register_motion("general", seconds=10.0, stream=8)
def _general(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.general import general_plan

    return general_plan(model, seconds, rng)


@register_motion("sit_to_stand", seconds=6.0, stream=9)
def _sit_to_stand(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.sit_to_stand import sit_to_stand_plan

    return sit_to_stand_plan(model, seconds, rng)


@register_motion("rail", seconds=5.0, stream=10)
def _rail(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.rail import rail_plan

    return rail_plan(model, seconds, rng)


@register_motion("kneel", seconds=7.0, stream=11)
def _kneel(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.kneel import kneel_plan

    return kneel_plan(model, seconds, rng)


@register_motion("belt_walk", seconds=4.0, stream=12)
def _belt_walk(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.treadmill import treadmill_plan

    return treadmill_plan(model, seconds, rng, belts=1)


@register_motion("split_belt_walk", seconds=4.0, stream=13)
def _split_belt_walk(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.treadmill import treadmill_plan

    return treadmill_plan(model, seconds, rng, belts=2)


@register_motion("star_arc", seconds=24.0, stream=14)
def _star_arc(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.star_arc import star_arc_plan

    return star_arc_plan(model, seconds, rng)


@register_motion("stand", seconds=1.5, stream=2, trial=False)
def _stand(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    from mbkf.synthesis.stand import stand_plan

    return stand_plan(model, seconds, rng)
