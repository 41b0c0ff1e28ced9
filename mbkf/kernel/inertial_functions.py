"""Functions of the compiled kernel on a body that inertial sensors alone show (grammar: ``declaration.py``)."""

from __future__ import annotations

from typing import Annotated as In
from typing import Annotated as Made
from typing import Protocol

from mbkf.conventions import Array, Int32Array
from mbkf.kernel.body_functions import Tree
from mbkf.kernel.declaration import requires


class InertialFunctions(Protocol):
    """Readings of worn sensors, and of points that rest, with their derivatives."""

    @requires("first_bias >= 3*nv", "first_turn >= first_bias + 3*S", "N >= first_turn + 3*S")
    def worn_readings(
        self,
        tree: Tree,
        q: In[Array, "nq"],
        v: In[Array, "nv"],
        a: In[Array, "nv"],
        joint_ids: In[Int32Array, "S in 1:joints"],
        places: In[Array, "S 3"],
        mounted: In[Array, "S 3 3"],
        weights: In[Array, "6*S"],
        biases: In[Array, "S 3"],
        turns: In[Array, "S 3"],
        measured: In[Array, "S 6"],
        first_bias: int,
        first_turn: int,
        N: int,
        /,
    ) -> tuple[Made[Array, "rows: 6*S N"], Made[Array, "innovation: 6*S"]]:
        """Whitened rows and innovations of sensors whose biases and turns are states; NaN of missing readings.

        Args:
            tree: The body.
            q, v, a: Motion.
            joint_ids: Joints that carry the sensors.
            places: Places in the joints' frames, m.
            mounted: Rotations sensor → segment as calibrated, row by row.
            weights: 1/sd of each reading.
            biases: Of the gyroscopes, rad/s.
            turns: Rotation vectors of the mounts since, in the segments' axes, rad.
            measured: Angular velocity rad/s and specific force m/s² of each sensor.
            first_bias, first_turn: Components of the state where biases and turns begin; q, v and a come first.
            N: Size of the state.
        """

    def carried_points(
        self,
        tree: Tree,
        q: In[Array, "nq"],
        v: In[Array, "nv"],
        joint_ids: In[Int32Array, "n in 1:joints"],
        points: In[Array, "n 3"],
        /,
    ) -> tuple[
        Made[Array, "velocities: n 6"], Made[Array, "by_motion: n 6 2*nv"], Made[Array, "by_q: n 3 nv"]
    ]:
        """Velocities of points of segments with their derivatives by q and v, and derivatives of their places.

        Args:
            tree: The body.
            q, v: Motion.
            joint_ids: Joints that carry the points.
            points: Their places in the world, m. Velocities, m/s and rad/s, are in the joint's axes, places in the
                world's.
        """
