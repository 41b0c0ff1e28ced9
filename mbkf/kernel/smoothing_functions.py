"""Functions of the compiled kernel on a smoother's backward pass (grammar: ``declaration.py``)."""

from __future__ import annotations

from typing import Annotated as In
from typing import Annotated as Made
from typing import Annotated as Out
from typing import Protocol

from mbkf.conventions import Array, Int32Array
from mbkf.kernel.declaration import requires


class SmoothingFunctions(Protocol):
    """Gradient and curvature of later readings (``smoothing.c``)."""

    @requires("nv + orders*nv <= N")
    def curvature_before_motion(
        self,
        L: In[Array, "N N symmetric"],
        A: In[Array, "nv nv"],
        B: In[Array, "nv nv"],
        joints: In[Int32Array, "J 2 in 0:nv+1"],
        push: In[Array, "orders"],
        rates: In[Array, "orders orders"],
        before: Out[Array, "N N symmetric"],
        /,
    ) -> None:
        """Writes Φᵀ L Φ with the transition Φ of :mod:`mbkf.numerics.transition`.

        Args:
            L: Curvature after the step.
            A, B: Derivatives of the next configuration by this one and by the step.
            joints: First dof and end of each joint.
            push: Step's share of each order of rates.
            rates: Transition of the rates of a dof.
            before: Curvature before the step.
        """

    @requires("nv + orders*nv <= N", "n <= N")
    def gradient_before(
        self,
        P: In[Array, "N N symmetric"],
        gradient: In[Array, "N"],
        vector: In[Array, "N"],
        information: In[Array, "n n symmetric"],
        rows: In[Array, "m N"],
        A: In[Array, "nv nv"],
        B: In[Array, "nv nv"],
        joints: In[Int32Array, "J 2 in 0:nv+1"],
        push: In[Array, "orders"],
        rates: In[Array, "orders orders"],
        /,
    ) -> tuple[Made[Array, "step: N"], Made[Array, "before: N"]]:
        """−P g and Φᵀ (g − λ − Λ P (g − λ)) for a gradient g of later readings.

        Args:
            P: Posterior covariance.
            gradient: g after the readings.
            vector: λ of the readings.
            information: Part of Λ on the first n components.
            rows: Whitened Jacobian H of further readings, which add HᵀH to Λ.
            A, B, joints, push, rates: Φ, as :meth:`curvature_before_motion` takes it.
        """

    @requires("nv + orders*nv <= N", "n <= N")
    def linear_step(
        self,
        P: In[Array, "N N symmetric"],
        before: In[Array, "N"],
        offset: In[Array, "N"],
        information: In[Array, "n n symmetric"],
        vector: In[Array, "n"],
        rows: In[Array, "m N"],
        values: In[Array, "m"],
        added: In[Array, "N"],
        A: In[Array, "nv nv"],
        B: In[Array, "nv nv"],
        joints: In[Int32Array, "J 2 in 0:nv+1"],
        push: In[Array, "orders"],
        rates: In[Array, "orders orders"],
        /,
    ) -> tuple[Made[Array, "gradient: N"], Made[Array, "after: N"]]:
        """Gives g = λ − Λ d and d + P g with d = Φ δ + o (``linear_step.c``).

        Args:
            P: Posterior covariance.
            before: δ, correction of the trajectory in the frame before.
            offset: o, from the trajectory to its prediction of the frame.
            information: Part of Λ on the first n components.
            vector: Its λ.
            rows: Whitened Jacobian H of further readings, which add HᵀH to Λ.
            values: Their innovations y, which add Hᵀy to λ.
            added: Added to λ.
            A, B, joints, push, rates: Φ, as :meth:`curvature_before_motion` takes it.
        """

    def smoothed_covariance(
        self,
        P: In[Array, "N N symmetric"],
        L: In[Array, "N N symmetric"],
        smoothed: Out[Array, "N N symmetric"],
        LP: Out[Array, "N N"],
        /,
    ) -> None:
        """Writes P − P L P and, column by column, L P.

        Args:
            P: Posterior covariance.
            L: Curvature of later readings.
            smoothed: Smoothed covariance.
            LP: Product that :meth:`curvature_before_readings` takes.
        """

    @requires("n <= N")
    def curvature_before_readings(
        self,
        L: In[Array, "N N symmetric"],
        smoothed: In[Array, "N N symmetric"],
        LP: In[Array, "N N"],
        information: In[Array, "n n symmetric"],
        rows: In[Array, "m N"],
        before: Out[Array, "N N symmetric"],
        /,
    ) -> None:
        """Writes L + Λ − Z Λ − (Z Λ)ᵀ with Z = L P + Λ S / 2, S the smoothed covariance.

        Args:
            L: Curvature after the readings.
            smoothed, LP: Those of :meth:`smoothed_covariance`.
            information: Part of Λ on the first n components.
            rows: Whitened Jacobian H of further readings, which add HᵀH to Λ.
            before: Curvature before the readings.
        """

    @requires("n <= N")
    def curvature_before_readings_alone(
        self,
        L: In[Array, "N N symmetric"],
        P: In[Array, "N N symmetric"],
        information: In[Array, "n n symmetric"],
        rows: In[Array, "m N"],
        before: Out[Array, "N N symmetric"],
        /,
    ) -> None:
        """Writes the answer of :meth:`curvature_before_readings` where the smoothed covariance is not wanted.

        Only products of L and P with the readings' n + m columns are made.

        Args:
            L: Curvature after the readings.
            P: Posterior covariance.
            information: Part of Λ on the first n components.
            rows: Whitened Jacobian H of further readings, which add HᵀH to Λ.
            before: Curvature before the readings.
        """

    @requires("nv + orders*nv <= N", "n <= N")
    def information_forward(
        self,
        Y: In[Array, "N N symmetric"],
        y: In[Array, "N"],
        offset: In[Array, "N"],
        A: In[Array, "nv nv"],
        B: In[Array, "nv nv"],
        joints: In[Int32Array, "J 2 in 0:nv+1"],
        push: In[Array, "orders"],
        rates: In[Array, "orders orders"],
        share: In[Array, "orders+1"],
        sd: In[Array, "nv"],
        noise: In[Array, "N N symmetric"],
        active: In[Int32Array, "K in 0:N"],
        information: In[Array, "n n symmetric"],
        vector: In[Array, "n"],
        rows: In[Array, "m N"],
        values: In[Array, "m"],
        added: In[Array, "N"],
        after: Out[Array, "N N symmetric"],
        gain: Out[Array, "N nv+K"],
        spread: Out[Array, "nv+K nv+K symmetric"],
        /,
    ) -> tuple[int, Made[Array, "vector_after: N"], Made[Array, "mean: nv+K"]]:
        """A frame of an information filter in corrections of a trajectory (``information_smoothing.c``); 0, or failure.

        Noise of the step, given the next error d, is N(G d + mean, spread) with Gᵀ the gain.

        Args:
            Y, y: P⁻¹ and P⁻¹ δ of the frame before.
            offset: From the trajectory to its prediction of the frame.
            A, B, joints, push, rates: Φ, as :meth:`curvature_before_motion` takes it.
            share: By which a dof's noise moves its position and each of its rates.
            sd: Standard deviation of each dof's noise.
            noise: Covariance of the noise of the components ``active``, zero for all others.
            active: Those components.
            information, vector: Λ and its λ on the first n components.
            rows, values: Whitened Jacobian H of further readings and their innovations, which add HᵀH and Hᵀy.
            added: Added to λ.
            after: Y of the frame.
            gain, spread: The noise's.
        """

    @requires("nv + orders*nv <= N")
    def information_backward(
        self,
        S: In[Array, "N N symmetric"],
        d: In[Array, "N"],
        offset: In[Array, "N"],
        A: In[Array, "nv nv"],
        B: In[Array, "nv nv"],
        joints: In[Int32Array, "J 2 in 0:nv+1"],
        push: In[Array, "orders"],
        rates: In[Array, "orders orders"],
        share: In[Array, "orders+1"],
        active: In[Int32Array, "K in 0:N"],
        gain: In[Array, "N nv+K"],
        spread: In[Array, "nv+K nv+K symmetric"],
        mean: In[Array, "nv+K"],
        before: Out[Array, "N N symmetric"],
        /,
    ) -> tuple[int, Made[Array, "step: N"]]:
        """The smoothed error of a frame and its covariance ``before`` from the next frame's d and S; 0, or failure.

        Args:
            S, d: Smoothed covariance and error of the frame after.
            offset, A, B, joints, push, rates, share, active: As :meth:`information_forward` took them.
            gain, spread, mean: Its results.
            before: Smoothed covariance.
        """
