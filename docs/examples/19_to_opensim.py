"""A result in OpenSim: its model, its motion and its loads give the torques of mbkf."""

import os
from pathlib import Path

import numpy as np

import mbkf
from mbkf.io.storage import read_storage

subject, recorded = mbkf.synthesise("squat", seconds=1.0, seed=3)
result = mbkf.reconstruct(recorded.trial, subject)

folder = Path("squat_opensim")
mbkf.export_result(result, "opensim", folder)
motion = read_storage(folder / "motion.mot")
print(f"{len(motion.times_s)} frames of {len(motion.names)} coordinates in {folder}")
assert motion.in_degrees and len(motion.times_s) == result.frames

try:
    import opensim
except ImportError:
    print("not compared: needs opensim (pip install 'mbkf[peers]')")
else:
    os.chdir(folder)
    assert opensim.InverseDynamicsTool("setup_id.xml").run()
    table = read_storage("inverse_dynamics.sto")
    for joint in ("hip_flexion_r", "knee_angle_r", "ankle_angle_r"):
        theirs = table.column(f"{joint}_moment")
        ours = result.moments[:, result.coordinate_names.index(joint)]
        print(
            f"{joint}: peak {np.abs(ours).max():.1f} N m, largest difference {np.abs(theirs - ours).max():.2f} N m"
        )
        assert np.corrcoef(theirs, ours)[0, 1] > 0.999
