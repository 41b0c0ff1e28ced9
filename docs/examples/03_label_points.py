"""Label raw points: a capture without names, shuffled in every frame, with ghost reflections and gaps."""

import numpy as np

import mbkf

subject, recorded = mbkf.synthesise("squat", seconds=1.0, seed=3)
points = recorded.raw.markers.positions_m
print(f"{points.shape[0]} frames with up to {points.shape[1]} points for {len(subject.markers)} markers")

labelled = mbkf.label(recorded.raw, subject)
print(
    f"{100 * labelled.assigned_fraction:.1f} % of the samples named, {int(labelled.ghosts.sum())} ghosts dropped"
)

# The labelled twin of the same capture tells which names are right.
truth = recorded.trial.markers.select(labelled.markers.names)
both = labelled.markers.present & truth.present
right = np.isclose(labelled.markers.positions_m, truth.positions_m, atol=1e-6).all(axis=2)
print(f"{100 * right[both].mean():.2f} % of them right")

assert right[both].mean() > 0.99
assert labelled.ghosts.sum() > 0
