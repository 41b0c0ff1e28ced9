"""Functions of the compiled kernel on feet, plates and their wrenches (grammar: ``declaration.py``)."""

from __future__ import annotations

from typing import Annotated as In
from typing import Annotated as Made
from typing import Annotated as Out
from typing import NamedTuple, Protocol

from mbkf.conventions import Array, BoolArray, Int32Array
from mbkf.kernel.body_functions import Tree
from mbkf.kernel.declaration import Handle, requires


class Feet(Handle):
    """Both feet of a body and the plates below them (``feet.h``); a memory holds so many numbers."""

    nq: int
    nv: int
    plates: int
    memory: int


class ContactLimits(NamedTuple):
    """Limits of contact in m, m/s, m/s², s and shares: :mod:`mbkf.sensors.contact.rules` explains each."""

    reach_m: float
    keep_m: float
    belt_from_m_s: float
    lower_m: float
    stand_height_m: float
    stand_speed_m_s: float
    stand_after_s: float
    alone_height_m: float
    alone_speed_m_s: float
    leave_slack: float
    floor_share: float
    level_m: float
    parted_m_s: float
    faces_down: float
    fall_m_s2: float


class PossibleLoads(NamedTuple):
    """Bounds of a person's load on a plate (:mod:`mbkf.sensors.contact.possible`); all but the first are shares."""

    weight_n: float
    most: float
    pull: float
    friction: float
    slack: float


class ContactFunctions(Protocol):
    """Contact of the feet, and readings of plates. A wrench is force N, moment N m about the world's origin."""

    @requires("root_joint >= 1", "root_joint < joints", "window >= 1", "still >= 1", "fall >= 4")
    def make_feet(
        self,
        tree: Tree,
        point_joints: In[Int32Array, "6 in 1:joints"],
        foot_joints: In[Int32Array, "2 in 1:joints"],
        root_joint: int,
        points: In[Array, "6 3"],
        window: int,
        still: int,
        fall: int,
        floor_m: float,
        dt_s: float,
        limits: ContactLimits,
        plate_known: In[BoolArray, "plates"],
        plate_least_n: In[Array, "plates"],
        plate_surface_m: In[Array, "plates"],
        plate_box: In[Array, "plates 4"],
        plate_edges: In[Array, "plates 4 4"],
        /,
    ) -> Feet:
        """Feet and plates for :meth:`decide_contact`.

        Args:
            tree: The body.
            point_joints, points: Joints, and places in their frames, m, of heel, ball and toe end, right before left.
            foot_joints, root_joint: Joints of the right and the left foot, and of the root.
            window, still, fall: Numbers of frames: of the floor's velocity, of a floor that stands still, of a fall.
            floor_m: Height of the lowest plate; NaN without plates.
            dt_s: Time between frames.
            limits: Limits of contact.
            plate_known: True for plates with an outline.
            plate_least_n: Least vertical force that counts as a load.
            plate_surface_m: Heights.
            plate_box, plate_edges: Outlines from above: least x and y, greatest x and y; and x, y, length along x and
                along y of each edge.
        """

    def decide_contact(
        self,
        feet: Feet,
        q: In[Array, "nq"],
        v: In[Array, "nv"],
        a: In[Array, "nv"],
        wrench: In[Array, "plates 6"],
        supported: bool,
        before: In[Array, "memory"],
        /,
    ) -> tuple[
        int,
        Made[Array, "after: memory"],
        Made[Array, "foot_wrench: 2 6"],
        Made[Array, "middles: 2 3"],
        Made[Array, "below: 6"],
        Made[Array, "soles: 2 3 3"],
        Made[Array, "pelvis: 3"],
        Made[Array, "near: 2"],
        Made[Array, "floor_velocity: 2"],
    ]:
        """Contact of the feet in one frame: flags and arrays of :class:`mbkf.kernel.contact.Stand`.

        Args:
            feet: Feet and plates.
            q, v, a: Predicted motion.
            wrench: Readings of the plates; NaN where not recorded.
            supported: True if another part than the feet bears load.
            before: Memory from the frame before.

        Raises:
            ValueError: The memory's counts exceed it: it belongs to other feet.
        """

    def wrench_rows(
        self,
        middles: In[Array, "2 3"],
        right: In[Array, "6"],
        left: In[Array, "6"],
        expected: In[Array, "2 6"],
        w: In[Array, "2 6"],
        left_first: bool,
        /,
    ) -> tuple[Made[Array, "rows: 12 12"], Made[Array, "values: 12"]]:
        """Whitened rows and innovations of the feet's wrenches (:mod:`mbkf.sensors.foot_contact`).

        Args:
            middles: Of the soles, m.
            right, left: 1/sd of each foot's rows.
            expected: Wrenches as read.
            w: Predicted wrenches.
            left_first: Rows of the left foot come first.
        """

    @requires("first >= 0", "first + 12 <= N")
    def add_wrench_walk(
        self,
        P: Out[Array, "N N symmetric"],
        first: int,
        middles: In[Array, "2 3"],
        sd: In[Array, "2"],
        belt: In[Array, "2"],
        /,
    ) -> None:
        """Adds the random walk of the feet's wrenches to P.

        Args:
            P: Covariance, changed in place.
            first: First component of the wrenches.
            middles: Of the soles, m.
            sd: Of force and moment.
            belt: Root of a belt's part of the horizontal moments.
        """

    def wrenches_possible(
        self, readings: In[Array, "*n plates 6"], reach: In[Array, "plates"], limits: PossibleLoads, /
    ) -> bool:
        """True if a person can load plates like this in all readings.

        Args:
            readings: Wrenches about the plates' origins.
            reach: Farthest that a foot can press from a plate's origin, m.
            limits: Bounds.
        """

    @requires("first >= 0", "size >= 1")
    def wrench_means(
        self,
        ring: In[Array, "size 6*plates"],
        first: int,
        weights: In[Array, "n"],
        width: float,
        origins: In[Array, "plates 3"],
        /,
    ) -> Made[Array, "means: plates 6"]:
        """Means of plates' readings over a window, about the world's origin.

        Args:
            ring: Latest readings, about the plates' origins.
            first: Row of the window's first sample.
            weights: Of the samples from there on.
            width: Width of the window, in samples.
            origins: Of the plates, m.
        """

    def plate_total(self, wrenches: In[Array, "plates 6"], /) -> tuple[bool, Made[Array, "force: 3"]]:
        """True where plates read finite numbers alone, and the sum of their forces, those not read counted as 0."""

    def plate_loads(
        self, origins: In[Array, "plates 3"], wrenches: In[Array, "plates 6"], /
    ) -> tuple[Made[Array, "force: plates 3"], Made[Array, "moment: plates 3"]]:
        """Forces of plates, and their moments about their own origins.

        Args:
            origins: Of the plates, m.
            wrenches: About the world's origin; NaN where not read.
        """

    def plate_spreads(
        self, origins: In[Array, "K 3"], points: In[Array, "n 3"], force: float, moment: float, /
    ) -> Made[Array, "spreads: n 6"]:
        """Spreads of wrenches about the world's origin that are independent about the origins nearest to points.

        Args:
            origins: Of plates, m; without one, a point stands for its own.
            points: The points, m.
            force, moment: Spreads about the origins, per component, N and N m.
        """

    def plate_changes(
        self,
        change: In[Array, "2 n 6"],
        noise: In[Array, "n 6"],
        white: float,
        share: float,
        share_of_second: float,
        /,
    ) -> Made[Array, "within: 2 n 6"]:
        """Shares of wrenches' changes, and of these changes' changes beyond those of white noise.

        Args:
            change: Both, N and N m.
            noise: Standard deviation of the noise of the wrenches.
            white: Standard deviation of second differences of white noise of standard deviation 1.
            share, share_of_second: The shares.
        """

    @requires("l*longer == w", "longer >= 1")
    def missing_forces(
        self,
        by_position: In[Array, "w n"],
        by_force: In[Array, "w n"],
        lengths: In[Int32Array, "w in 0:n+1"],
        limits: In[Array, "l longer"],
        held: In[Array, "n 6"],
        known: int,
        mass: float,
        gravity: In[Array, "3"],
        level: bool,
        /,
    ) -> tuple[Made[Array, "missing: w 3"], Made[Array, "exceeded: l"], Made[Array, "swings: l"]]:
        """Mean forces that act besides weight and contacts over windows that end now, N; 0 where frames are missing.

        Of each limit, the share that all of its windows exceed in one direction, and the largest share of the first.

        Args:
            by_position, by_force: Weights of the frames in each window, the latest last.
            lengths: Frames of each window.
            limits: Force that counts as missing in each window, N.
            held: Centre of mass, m, and force of all contacts, N, by frame.
            known: Number of the latest frames that count.
            mass: Of the body, kg.
            gravity: Acceleration, m/s².
            level: True where level forces are judged, too, and not the vertical one alone.
        """
