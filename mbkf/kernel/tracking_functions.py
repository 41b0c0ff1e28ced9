"""Functions of the compiled kernel that take a whole frame through a filter (grammar: ``declaration.py``)."""

from __future__ import annotations

from typing import Annotated as In
from typing import Annotated as Made
from typing import Protocol

from mbkf.conventions import Array, BoolArray, Int32Array
from mbkf.kernel.body_functions import Tree


class TrackingFunctions(Protocol):
    """Steps of filters on a tree of joints."""

    def move_state(
        self,
        tree: Tree,
        q: In[Array, "nq"],
        v: In[Array, "nv"],
        a: In[Array, "nv"],
        w: In[Array, "m"],
        extra: In[Array, "k"],
        step: In[Array, "3*nv+m+k"],
        /,
    ) -> tuple[
        Made[Array, "q_after: nq"],
        Made[Array, "v_after: nv"],
        Made[Array, "a_after: nv"],
        Made[Array, "w_after: m"],
        Made[Array, "extra_after: k"],
    ]:
        """A state moved along its tangent space.

        Args:
            tree: The body.
            q, v, a, w, extra: The state.
            step: Tangent vector.
        """

    def follow_markers(
        self,
        tree: Tree,
        joints: In[Int32Array, "J 2 in 0:nv+1"],
        dt: float,
        noise: In[Array, "2 2 nv"],
        joint_ids: In[Int32Array, "M in 0:joints"],
        local: In[Array, "M 3"],
        weights: In[Array, "M"],
        radius: float,
        least: int,
        start: In[Array, "nq"],
        postures: In[Array, "nv"],
        P: In[Array, "2*nv 2*nv symmetric"],
        q: In[Array, "nq"],
        v: In[Array, "nv"],
        measured: In[Array, "M 3"],
        /,
    ) -> tuple[
        bool,
        Made[Array, "P_before: 2*nv 2*nv"],
        Made[Array, "q_before: nq"],
        Made[Array, "innovation: M 3"],
        Made[Array, "squared: M"],
        Made[BoolArray, "seen: M"],
        Made[Array, "by_markers: nv nv"],
        Made[Array, "towards_markers: nv"],
        Made[Array, "matrix: nv nv"],
        Made[Array, "vector: nv"],
        Made[Array, "P_after: 2*nv 2*nv"],
        Made[Array, "q_after: nq"],
        Made[Array, "v_after: nv"],
        Made[float, "size"],
    ]:
        """A state (q, v) one frame later, corrected by markers and posture where all is in sight and near.

        True where all seen markers lie within a radius of their prediction, and enough are seen, one of each segment
        that carries any; else only prediction, innovations and seen markers are written. After the prediction come
        innovations as :meth:`BodyFunctions.marker_innovations` has them, information of the markers alone and with the
        posture's, the state after the frame, and yᵀR⁻¹y.

        Args:
            tree: The body.
            joints: First dof and end of each joint.
            dt: Δt, s.
            noise: Diagonals of the blocks of Q.
            joint_ids, local: Joints that carry the markers, and places in their frames, m.
            weights: 1/sd² of the markers, 1/m².
            radius: Greatest distance of a marker that is near, m.
            least: Least number of markers.
            start: Configuration from which postures deviate.
            postures: 1/sd of each dof's deviation, 1/rad.
            P, q, v: The state.
            measured: Markers, m; NaN where missing.
        """
