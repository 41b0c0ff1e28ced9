"""A person and a result in MeshCat, with Pinocchio's visualiser: from a script or as a notebook's cell."""

from pathlib import Path

import mbkf

subject, recorded = mbkf.synthesise("squat", seconds=1.0, seed=3)
result = mbkf.reconstruct(recorded.trial, subject)

# Without open=False a browser opens; in a notebook, "shown" as the last line of a cell displays the viewer.
shown = mbkf.show(subject, open=False)
print(f"{shown.visual_model.ngeoms} shapes at {shown.viewer.url()}")
shown.display(result.q[-1])  # any configuration

played = mbkf.play(result, speed=0.5, open=False)
page = Path("squat.html")
page.write_text(played.viewer.static_html(), encoding="utf-8")  # a page of its own, with the animation
print(f"{page} holds {result.frames} frames in {page.stat().st_size / 1e6:.1f} MB")

shown.close()
played.close()
assert shown.visual_model.ngeoms == len(mbkf.HumanModel.of(subject).joints) + len(subject.markers)
assert "MeshCat" in page.read_text(encoding="utf-8")
