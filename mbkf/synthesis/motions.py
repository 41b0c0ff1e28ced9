"""Registry of the motions that can be synthesised: each has a name, a plan, a usual duration and a random stream.

A motion of one's own joins the built-in ones by a decorator, and then has its place in :func:`motion_names`, in error
messages and in :func:`mbkf.synthesis.motion.synthesise_motion`::

    @register_motion("sway", seconds=5.0)
    def sway_plan(model, seconds, rng): ...

The plans of the built-in motions are imported when they are first asked for, so that this module stays light.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from mbkf.errors import InvalidInput, UnknownName

if TYPE_CHECKING:
    import numpy as np

    from mbkf.model.human import HumanModel
    from mbkf.synthesis.plan import MotionPlan

    Planner = Callable[[HumanModel, float, np.random.Generator], MotionPlan]


@dataclass(frozen=True)
class RegisteredMotion:
    """A motion that can be synthesised.

    Attributes:
        name: Its name on the command line and in files.
        planner: Makes the plan from a body, a duration in s and a random generator; or where it is, "module:name".
        seconds: Usual duration, s.
        stream: Number that, with the seed, starts the motion's random generator.
        trial: Whether it is offered as a trial; a motion for static captures is not.
    """

    name: str
    planner: Planner | str
    seconds: float
    stream: int
    trial: bool = True

    def plan(self, model: HumanModel, seconds: float, rng: np.random.Generator) -> MotionPlan:
        """The plan of a motion of this kind.

        Args:
            model: The body that moves.
            seconds: Duration, s.
            rng: Source of the differences between persons.

        Raises:
            InvalidInput: The duration does not suit the motion.
        """
        planner = self.planner
        if isinstance(planner, str):
            module, _, name = planner.partition(":")
            planner = getattr(import_module(module), name)
        return planner(model, seconds, rng)


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
        _add(RegisteredMotion(name, planner, seconds, own, trial))
        return planner

    return register


def _add(motion: RegisteredMotion) -> None:
    if not motion.name or motion.name in _MOTIONS:
        raise InvalidInput(f"a motion '{motion.name}' cannot be registered: the name is empty or taken")
    _MOTIONS[motion.name] = motion


def registered_motion(name: str) -> RegisteredMotion:
    """The motion of a name.

    Raises:
        UnknownName: There is no such motion; lists the known ones.
    """
    if name not in _MOTIONS:
        raise UnknownName("motion", name, _MOTIONS)
    return _MOTIONS[name]


def motion_names(*, static: bool = False) -> tuple[str, ...]:
    """Names of the motions offered as trials, in the order of registration; with ``static`` the others as well."""
    return tuple(name for name, motion in _MOTIONS.items() if motion.trial or static)


for _motion in (
    RegisteredMotion("squat", "mbkf.synthesis.squat:squat_plan", 5.0, stream=1),
    RegisteredMotion("walk", "mbkf.synthesis.walk:walk_plan", 4.0, stream=3),
    RegisteredMotion("jump", "mbkf.synthesis.jump:jump_plan", 3.0, stream=0),
    RegisteredMotion("stand", "mbkf.synthesis.stand:stand_plan", 1.5, stream=2, trial=False),
):
    _add(_motion)
