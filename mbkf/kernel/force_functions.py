"""Functions of the compiled kernel on a body moved by forces, q, v and u (grammar: ``declaration.py``)."""

from __future__ import annotations

from typing import Annotated as In
from typing import Annotated as Made
from typing import Protocol

from mbkf.conventions import Array, BoolArray, Int32Array
from mbkf.kernel.body_functions import Tree
from mbkf.kernel.declaration import requires, unlocked


class ForceFunctions(Protocol):
    """Forward dynamics of a tree of joints, and covariances of a state (q, v, u) of N components."""

    def mass_inverse(
        self, tree: Tree, q: In[Array, "nq"], moving: In[BoolArray, "nv"], /
    ) -> tuple[int, Made[Array, "mass: nv nv"], Made[Array, "inverse: nv nv"]]:
        """0, or 1 where the mass matrix is not positive; mass matrix M, and the inverse of its part of the moving dofs.

        Args:
            tree: The body.
            q: Configuration.
            moving: True for dofs that forces move; rows and columns of the others are 0 in the inverse.
        """

    def foot_wrenches(
        self,
        tree: Tree,
        q: In[Array, "nq"],
        joint_ids: In[Int32Array, "2 in 1:joints"],
        levers: In[Array, "2 3"],
        own_axes: bool,
        state: In[Array, "12"],
        points: In[Array, "2 3"],
        /,
    ) -> tuple[Made[Array, "wrench: 12"], Made[Array, "by_state: 12 12"], Made[Array, "by_q: 12 nv"]]:
        """Wrenches of the feet about points in the world, and derivatives by their states and the configuration.

        Args:
            tree: The body.
            q: Configuration.
            joint_ids: Joints of right and left foot.
            levers: Where a force acts, in the foot's axes, m.
            own_axes: The states' forces are in the foot's axes, else in the world's; moments are in the foot's.
            state: Force N and moment N m of right and left foot.
            points: Points in the world about which the moments are taken, m.
        """

    @requires("2*nv + nu == N")
    @unlocked
    def propagate_forces(
        self,
        P: In[Array, "N N symmetric"],
        A: In[Array, "nv nv"],
        B: In[Array, "nv nv"],
        by_u: In[Array, "nv nu fortran"],
        joints: In[Int32Array, "J 2 in 0:nv+1"],
        dt: float,
        push: float,
        own: In[Array, "nv"],
        forces: In[Array, "nu nu symmetric"],
        /,
    ) -> Made[Array, "after: N N"]:
        """Φ P Φᵀ + Q of a state (q, v, u) with Φ = [[A, B, p U], [0, 1, Δt U], [0, 0, 1]], Q of thesis eq. 2.45.

        Args:
            P: Covariance.
            A, B: Derivatives of the next configuration by this one and by the velocity; zero between joints.
            by_u: U, accelerations by forces.
            joints: First dof and end of each joint.
            dt: Δt, s.
            push: p, s².
            own: Spectral density of the accelerations' own noise.
            forces: Spectral density of the forces.
        """

    @requires("m == 2*nv", "m + nu == N", "most >= 2")
    @unlocked
    def exact_forces(
        self,
        P: In[Array, "N N symmetric"],
        A: In[Array, "m m fortran"],
        by_u: In[Array, "nv nu fortran"],
        joints: In[Int32Array, "J 2 in 0:nv+1"],
        dt: float,
        own: In[Array, "nv"],
        forces: In[Array, "nu nu symmetric"],
        rules: In[Array, "most most 2"],
        /,
    ) -> tuple[
        int,
        Made[Array, "motion: m m fortran"],
        Made[Array, "push: m nu fortran"],
        Made[Array, "after: N N"],
    ]:
        """Exact Φ = [[E, G], [0, 1]] of a state (q, v, u), and Φ P Φᵀ + Q; first, the terms of a series or 0.

        Where 0 is returned, A Δt is too large for one series, and nothing is written.

        Args:
            P: Covariance.
            A: Rates of (q, v), [[T, 1], [K, D]]; T is zero between joints.
            by_u: Accelerations by forces.
            joints: First dof and end of each joint.
            dt: Δt, s.
            own: Spectral density of the accelerations' own noise.
            forces: Spectral density of the forces.
            rules: Gauss's rules of 1, 2, … points by rows: points in 0 … 1 and weights.
        """
