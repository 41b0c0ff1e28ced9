"""Settings of the dynamic filter: those of its plant and blocks, one default set for every capture."""

from __future__ import annotations

from dataclasses import dataclass, field

from mbkf.filters.dynamic.plant import SingerSettings
from mbkf.filters.error_covariance import ErrorSettings
from mbkf.sensors.coordination.prior import CoordinationSettings
from mbkf.sensors.foot_contact import FootContactSettings
from mbkf.sensors.inertial import InertialSettings
from mbkf.sensors.joint_limits import JointLimitSettings
from mbkf.sensors.markers import MarkerSettings
from mbkf.sensors.mean_posture import MeanPostureSettings
from mbkf.sensors.newton_euler import NewtonEulerSettings
from mbkf.sensors.planted import PlantedSettings
from mbkf.sensors.posture import PostureSettings
from mbkf.sensors.root_residual import RootResidualSettings
from mbkf.sensors.supports.block import SupportSettings
from mbkf.sensors.unobserved import UnobservedSettings


@dataclass(frozen=True)
class DynamicSettings:
    """Settings of the dynamic filter's motion, instruments and contacts.

    Attributes:
        motion: Process noise.
        markers: Noise and gate of the markers.
        law: How exactly Newton's law holds.
        residual: Load at the pelvis that nothing explains.
        contact: Noise of plates and of feet that stand elsewhere.
        supports: When other parts than the feet bear.
        unobserved: Damping of joints that nothing observes.
        planted: How still a loaded foot stands.
        inertial: Noise of inertial sensors.
        mean_posture: Mean posture of unobserved limbs, beside inertial sensors.
        coordination: How unobserved limbs go with trunk and legs.
        posture: Weight of the posture prior.
        limits: Softness of joint limits.
        errors: How the stated error covariance follows from the filter's.
    """

    motion: SingerSettings = field(default_factory=SingerSettings)
    markers: MarkerSettings = field(default_factory=MarkerSettings)
    law: NewtonEulerSettings = field(default_factory=NewtonEulerSettings)
    residual: RootResidualSettings = field(default_factory=RootResidualSettings)
    contact: FootContactSettings = field(default_factory=FootContactSettings)
    supports: SupportSettings = field(default_factory=SupportSettings)
    unobserved: UnobservedSettings = field(default_factory=UnobservedSettings)
    planted: PlantedSettings = field(default_factory=PlantedSettings)
    inertial: InertialSettings = field(default_factory=InertialSettings)
    mean_posture: MeanPostureSettings = field(default_factory=MeanPostureSettings)
    coordination: CoordinationSettings = field(default_factory=CoordinationSettings)
    posture: PostureSettings = field(default_factory=lambda: PostureSettings(unseen_posture=0.05))
    limits: JointLimitSettings = field(default_factory=JointLimitSettings)
    errors: ErrorSettings = field(default_factory=ErrorSettings)
