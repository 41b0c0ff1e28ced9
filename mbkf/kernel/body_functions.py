"""Functions of the compiled kernel on a body: its joints and the markers on it (grammar: ``declaration.py``)."""

from __future__ import annotations

from typing import Annotated as In
from typing import Annotated as Made
from typing import Protocol

from mbkf.conventions import Array, BoolArray, Int32Array
from mbkf.kernel.declaration import Handle, requires


class Tree(Handle):
    """A body as a tree of joints (``tree.h``); joint 0 is the world."""

    nq: int
    nv: int
    joints: int


class BodyFunctions(Protocol):
    """Kinematics and dynamics of a tree of joints, and markers on it.

    Configurations q, velocities v and accelerations a are those of Pinocchio; a wrench is force N, moment N m about the
    world's origin.
    """

    @requires("joints >= 2", "nq >= 7", "nv >= 6")
    def make_tree(
        self,
        nq: int,
        nv: int,
        parent: In[Int32Array, "joints in 0:joints"],
        kind: In[Int32Array, "joints in 0:3"],
        first_q: In[Int32Array, "joints in 0:nq"],
        first_v: In[Int32Array, "joints in 0:nv"],
        axis: In[Array, "joints 3"],
        rotation: In[Array, "joints 3 3"],
        origin: In[Array, "joints 3"],
        mass: In[Array, "joints"],
        lever: In[Array, "joints 3"],
        inertia: In[Array, "joints 3 3"],
        gravity: In[Array, "6"],
        /,
    ) -> Tree:
        """Tree of joints, of which the first after the world is free.

        Args:
            nq, nv: Sizes of configuration and velocity.
            parent: Joint that carries a joint; it comes before it.
            kind: Free, spherical or hinge (:data:`mbkf.kernel.tree.KINDS`).
            first_q, first_v: First component of a joint in q and v.
            axis: Unit axis of a hinge in its own frame.
            rotation, origin: Axes, row by row, and origin of a joint in its parent's frame, m.
            mass, lever, inertia: Of a segment: kg, centre of mass in the joint's frame, m, and inertia about it, kg m².
            gravity: Linear and angular acceleration, m/s².

        Raises:
            ValueError: The joints do not make a tree.
        """

    def frames_and_jacobian(
        self, tree: Tree, q: In[Array, "nq"], /
    ) -> tuple[Made[Array, "frames: 4*joints 3"], Made[Array, "jacobian: 6 nv fortran"]]:
        """Three axes and origin of every joint, and the spatial Jacobian of all dofs."""

    def frames_and_jacobians(
        self, tree: Tree, q: In[Array, "T nq"], /
    ) -> tuple[Made[Array, "frames: T 4*joints 3"], Made[Array, "jacobians: T nv 6"]]:
        """:meth:`frames_and_jacobian` of many configurations, Jacobians column by column."""

    def root_dynamics(
        self,
        tree: Tree,
        q: In[Array, "nq"],
        v: In[Array, "nv"],
        a: In[Array, "nv"],
        wrench: In[Array, "6"],
        /,
    ) -> tuple[Made[Array, "residual: 6"], Made[Array, "by_state: 6 3*nv+12"]]:
        """The root's six equations ID(q, v, a) − Jᵀ w in its own axes; derivatives by q, v, a and two wrenches.

        Args:
            tree: The body.
            q, v, a: Motion.
            wrench: w, sum of both wrenches.
        """

    def law_rows(
        self,
        tree: Tree,
        q: In[Array, "nq"],
        v: In[Array, "nv"],
        a: In[Array, "nv"],
        wrenches: In[Array, "12"],
        extra: In[Array, "m"],
        by_extra: In[Array, "6 m"],
        sharp: In[Array, "6"],
        /,
    ) -> tuple[Made[Array, "rows: 6 3*nv+12+m"], Made[Array, "innovation: 6"]]:
        """Newton's law at the root as whitened readings of zero: rows on (q, v, a, wrenches, extra) and innovations.

        Args:
            tree: The body.
            q, v, a: Motion.
            wrenches: Of the right, the left foot.
            extra: Further states.
            by_extra: Whitened rows on them.
            sharp: 1/sd of the residual of :meth:`root_dynamics`.
        """

    def centre_of_mass(self, tree: Tree, q: In[Array, "nq"], /) -> Made[Array, "centre: 3"]:
        """Centre of mass at a configuration, m."""

    def generalised_forces(
        self,
        tree: Tree,
        q: In[Array, "nq"],
        v: In[Array, "nv"],
        a: In[Array, "nv"],
        moves: In[BoolArray, "2 nv"],
        wrenches: In[Array, "12"],
        /,
    ) -> Made[Array, "tau: nv"]:
        """Generalised forces ID(q, v, a) − Σ J_fᵀ w_f.

        Args:
            tree: The body.
            q, v, a: Motion.
            moves: True where a dof moves the right, the left foot.
            wrenches: w_f of the right, the left foot.
        """

    def motion_forces(
        self,
        tree: Tree,
        q: In[Array, "T nq"],
        v: In[Array, "T nv"],
        a: In[Array, "T nv"],
        moves: In[BoolArray, "2 nv"],
        wrenches: In[Array, "T 12"],
        /,
    ) -> Made[Array, "tau: T nv"]:
        """:meth:`generalised_forces` of the frames of a motion.

        Args:
            tree: The body.
            q, v, a: Motion.
            moves: True where a dof moves the right, the left foot.
            wrenches: w_f of the right, the left foot.
        """

    def torque_derivatives(
        self,
        tree: Tree,
        q: In[Array, "nq"],
        v: In[Array, "nv"],
        a: In[Array, "nv"],
        moves: In[BoolArray, "2 nv"],
        wrenches: In[Array, "12"],
        /,
    ) -> tuple[
        Made[Array, "tau: nv"],
        Made[Array, "by_state: nv 3*nv+12 fortran"],
        Made[Array, "jacobian: 6 nv fortran"],
    ]:
        """Generalised forces, their derivatives by q, v, a and wrenches, and the spatial Jacobian.

        Args:
            tree: The body.
            q, v, a: Motion.
            moves: True where a dof moves the right, the left foot.
            wrenches: w_f of the right, the left foot.
        """

    def load_derivatives(
        self,
        tree: Tree,
        q: In[Array, "nq"],
        v: In[Array, "nv"],
        a: In[Array, "nv"],
        moves: In[BoolArray, "2 nv"],
        wrenches: In[Array, "12"],
        above: In[Int32Array, "L in 1:joints"],
        transports: In[Array, "L 3 6"],
        parts: In[Array, "L 13"],
        /,
    ) -> tuple[Made[Array, "tau: nv"], Made[Array, "by_state: 6*L+nv 3*nv+12 fortran"]]:
        """Generalised forces, and derivatives of the trunk's moments and of these forces by q, v, a and wrenches.

        Rows are three moments of each section top-down, the same bottom-up, then the forces.

        Args:
            tree: The body.
            q, v, a: Motion.
            moves: True where a dof moves the right, the left foot.
            wrenches: w_f of the right, the left foot, which are below the sections.
            above: Joint of the segment above each section, on the root; where it is spherical, moments turn with it.
            transports: Moment about the section by a wrench about the root's origin, in its axes.
            parts: Mass, centre of mass and inertia about it, row by row, of the root segment's part above.
        """

    def upper_forces(
        self,
        tree: Tree,
        q: In[Array, "T nq"],
        v: In[Array, "T nv"],
        a: In[Array, "T nv"],
        above: In[Int32Array, "L in 1:joints"],
        parts: In[Array, "L 13"],
        /,
    ) -> Made[Array, "upper: T L 6"]:
        """Wrenches on the parts above sections in T frames without loads, as generalised forces of the root.

        Args:
            tree: The body.
            q, v, a: Motion.
            above, parts: As of :meth:`load_derivatives`.
        """

    @requires("above >= 1", "above < joints", "N >= 3*nv")
    def section_state(
        self,
        tree: Tree,
        q: In[Array, "nq"],
        v: In[Array, "nv"],
        a: In[Array, "nv"],
        carried: In[Array, "6"],
        transport: In[Array, "3 6"],
        above: int,
        residual: In[Array, "6"],
        by_state: In[Array, "6 N"],
        /,
    ) -> tuple[
        Made[Array, "wrench: 2 6"],
        Made[Array, "moment: 2 3"],
        Made[Array, "rows: 2 3 N"],
        Made[Array, "by_root: 3 6"],
    ]:
        """Loads at a section of the trunk by way, top-down and bottom-up, with derivatives.

        Args:
            tree: The segments above the section.
            q, v, a: Motion.
            carried: Wrench of all loads on them.
            transport: Moment about the section by a wrench about the root's origin, in its axes.
            above: Joint of the segment above, in whose axes moments are; where it is spherical, they turn with it.
            residual, by_state: The whole body's residual at the root, and its derivatives by the state.
        """

    def height_jacobian(
        self, tree: Tree, q: In[Array, "nq"], joint_ids: In[Int32Array, "n in 1:joints"], /
    ) -> Made[Array, "heights: n nv"]:
        """Derivatives of the heights of joints' origins by the configuration.

        Args:
            tree: The body.
            q: Configuration.
            joint_ids: The joints.
        """

    def integrate(self, tree: Tree, q: In[Array, "nq"], step: In[Array, "nv"], /) -> Made[Array, "moved: nq"]:
        """Configuration reached by a tangent vector.

        Args:
            tree: The body.
            q: Configuration.
            step: Tangent vector.
        """

    def integration_derivatives(
        self, tree: Tree, step: In[Array, "nv"], /
    ) -> tuple[Made[Array, "by_q: nv nv"], Made[Array, "by_step: nv nv"]]:
        """Derivatives of :meth:`integrate` by q and by the step."""

    def deviation(
        self, tree: Tree, start: In[Array, "nq"], q: In[Array, "nq"], /
    ) -> tuple[Made[Array, "angles: nv"], Made[Array, "jacobian: nv nv"]]:
        """Rotation vectors of all joints but free ones from a start, rad, and their derivative by q.

        Args:
            tree: The body.
            start: Configuration from which joints rotate.
            q: Configuration.
        """

    def posture_information(
        self,
        tree: Tree,
        residual: In[Array, "nv"],
        jacobian: In[Array, "nv nv"],
        weights: In[Array, "nv"],
        /,
    ) -> tuple[Made[Array, "matrix: nv nv"], Made[Array, "vector: nv"]]:
        """JᵀW²J and −JᵀW²r of a Jacobian that is zero between joints.

        Args:
            tree: The body.
            residual: r, rotation less its reading, rad.
            jacobian: J; between joints it is not read.
            weights: Diagonal of W, 1/sd of each reading, 1/rad.
        """

    def limit_excess(
        self,
        tree: Tree,
        angles: In[Array, "nv"],
        lower: In[Array, "nv"],
        upper: In[Array, "nv"],
        /,
    ) -> tuple[int, Made[Array, "excess: nv"]]:
        """Number of dofs beyond their limits, and their excess in rad.

        Args:
            tree: The body.
            angles: Those of :meth:`deviation`.
            lower, upper: Limits, rad.
        """

    def marker_places(
        self,
        tree: Tree,
        joint_ids: In[Int32Array, "M in 0:joints"],
        local: In[Array, "M 3"],
        q: In[Array, "nq"],
        /,
    ) -> tuple[Made[Array, "places: M 3"], Made[Array, "jacobian: 6 nv fortran"]]:
        """Markers in the world, m, and the spatial Jacobian of all dofs.

        Args:
            tree: The body.
            joint_ids: Joints that carry the markers.
            local: Places in their frames, m.
            q: Configuration.
        """

    def marker_innovations(
        self, measured: In[Array, "M 3"], places: In[Array, "M 3"], radius: float, /
    ) -> tuple[bool, Made[Array, "innovation: M 3"], Made[Array, "squared: M"], Made[BoolArray, "seen: M"]]:
        """True where all seen markers lie within a radius; innovations, their squared lengths, and seen markers.

        Args:
            measured: Measured places, m; NaN where missing.
            places: Predicted ones.
            radius: Greatest distance, m.
        """

    def plausible_points(
        self, points: In[Array, "n 3"], farthest: float, /
    ) -> tuple[int, Made[int, "absent"], Made[Array, "shown: n 3"]]:
        """Number of implausible points, that of implausible or missing ones, and the points with NaN for these.

        Args:
            points: Places, m; NaN where missing.
            farthest: Bound of a coordinate, m.
        """

    def marker_information(
        self,
        tree: Tree,
        joint_ids: In[Int32Array, "M in 0:joints"],
        weights: In[Array, "M"],
        trusted: In[BoolArray, "M"],
        jacobian: In[Array, "6 nv fortran"],
        places: In[Array, "M 3"],
        innovation: In[Array, "M 3"],
        /,
    ) -> tuple[float, Made[Array, "matrix: nv nv"], Made[Array, "vector: nv"]]:
        """yᵀR⁻¹y, HᵀR⁻¹H and HᵀR⁻¹y of the trusted markers.

        Args:
            tree: The body.
            joint_ids: Joints that carry the markers.
            weights: 1/sd², 1/m².
            trusted: True for the markers that count.
            jacobian, places: Those of :meth:`marker_places`.
            innovation: y, m.
        """
