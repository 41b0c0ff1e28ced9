"""Settings of the dynamic filter: one default set for every capture, and what `mbkf tune` may change."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class DynamicSettings:
    """What the dynamic filter believes of motion, instruments and contacts.

    Attributes:
        acceleration_scale: Factor on the body's table of movement accelerations (``movement_sd``).
        quiet_share: σ_a of a joint that rests, as a share of the table.
        activity_gain, activity_rate: σ_a of one that moves is this times the root mean square of its recent
            acceleration and of its velocity times the rate (1/s); gain 0 keeps the table.
        activity_memory_s: Time over which that mean is taken.
        busy_shares: σ_a is at most this many times the table, for the pelvis's translation and for all else.
        decay_s: Time T in which an unseen acceleration fades (Singer).
        residual_force_n, residual_moment_nm: How exactly Newton's law holds at the pelvis, per component.
        plate_force_n, plate_moment_nm: Noise of a plate's reading, moment about the middle of the sole.
        wrench_force, wrench_moment: Random walk of a foot's wrench, N/√s and N m/√s, moment about the
            middle of the sole.
        air_force_n, air_moment_nm: How exactly a foot in the air carries nothing.
        free_force_share, free_lever_m: Spread of an unmeasured foot's force about its share of the weight, in body
            weights, and of its lever about the middle of the sole, m, per reading: what keeps two such feet from
            pulling against each other.
        pulling_force_n: How softly an unmeasured foot is kept from pulling at the floor, N.
        marker_noise_scale: Factor on the markers' own noise.
        innovation_share: Share of an independent reading that a frame's marker counts for, because skin moves slowly
            and the next frames repeat its error: the noise follows the mean square innovation divided by it, within
            ``noise_range``. 0 keeps the markers' own noise (white camera noise only).
        noise_memory_s: Time over which that mean square is taken.
        new_share, skin_rate_rad_s: Share of the marker noise that is new in every frame, and how fast the rest
            changes, for the standard deviations (:mod:`mbkf.filters.stated`).
        noise_range: Least and greatest factor on the markers' noise that follows.
        posture_scale: The posture prior's spread is the body's table times this, per reading.
        limit_sd_rad: Softness of a joint's limit.
        unseen_posture: Factor on the posture prior's weight for joints of segments without a marker in sight: said
            anew in every frame, it would soon outweigh what was known before.
        unseen_velocity_s, unseen_velocity_range, unseen_acceleration_share: What holds back joints of segments without
            a marker in sight: spread about rest per reading, their movement acceleration over that time, s, within the
            range, rad/s; and share of their movement acceleration.
        planted_speed_sd, planted_turn_sd: How still a loaded foot without a marker in sight stands, m/s and rad/s.
        skin_memory_s: How long a marker's skin artefact lasts where it is modelled as a Gauss–Markov process with the
            marker's noise as its spread (``mbkf.sensors.skin``); 0 for white noise.
        camera_noise_m: White noise besides the artefact.
        imu_rate_sd_rad_s, imu_force_sd_mps2: How far an inertial sensor's reading is from that of its segment, skin
            movement included.
        imu_residual_scale: Factor on the residual's spread where inertial sensors read and a limb is neither seen by
            markers nor felt by them.
        usual_posture_s: With inertial sensors, the time over which a joint's mean posture is taken while it is seen.
        usual_posture_sd_rad: Its spread about that when nothing shows it, per reading.
        habit_memory_s: How far back a joint's movement with trunk and legs is looked at, for when it is out of sight
            (:mod:`mbkf.filters.habit`); 0 for no such habits.
        habit_ridge_rad: What of trunk and legs varies by less than this hardly tells anything.
        habit_errs_s: How long what is read off them errs alike.
        gate: Squared Mahalanobis distance (3 readings) above which a marker is not believed.
        gate_radius_m: Distance below which no marker is refused, m.
    """

    acceleration_scale: float = 1.0
    quiet_share: float = 0.1
    activity_gain: float = 6.0
    activity_rate: float = 5.0
    activity_memory_s: float = 0.05
    busy_shares: tuple[float, float] = (2.0, 8.0)
    decay_s: float = 0.04
    residual_force_n: float = 2.0
    residual_moment_nm: float = 1.0
    plate_force_n: float = 3.0
    plate_moment_nm: float = 1.0
    wrench_force: float = 3000.0
    wrench_moment: float = 300.0
    air_force_n: float = 0.5
    air_moment_nm: float = 0.2
    free_force_share: float = 2.0
    free_lever_m: float = 0.3
    pulling_force_n: float = 10.0
    marker_noise_scale: float = 1.0
    innovation_share: float = 0.12
    noise_memory_s: float = 1.0
    new_share: float = 0.035
    skin_rate_rad_s: float = 4.0
    noise_range: tuple[float, float] = (0.5, 4.0)
    posture_scale: float = 1.0
    limit_sd_rad: float = 0.03
    unseen_posture: float = 0.05
    unseen_velocity_s: float = 0.075
    unseen_velocity_range: tuple[float, float] = (10.0, 30.0)
    unseen_acceleration_share: float = 10.0
    planted_speed_sd: float = 0.03
    planted_turn_sd: float = 0.2
    skin_memory_s: float = 0.0
    camera_noise_m: float = 0.001
    imu_rate_sd_rad_s: float = 0.05
    imu_force_sd_mps2: float = 0.5
    imu_residual_scale: float = 30.0
    usual_posture_s: float = 1.0
    usual_posture_sd_rad: float = 1.5
    habit_memory_s: float = 5.0
    habit_ridge_rad: float = 0.1
    habit_errs_s: float = 0.25
    gate: float = 60.0
    gate_radius_m: float = 0.03
