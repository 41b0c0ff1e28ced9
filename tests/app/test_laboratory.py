"""The laboratory of the page: entries are changed one by one, and a logo is a picture."""

import base64

import pytest

from mbkf.app.laboratory import change_laboratory, laboratory_of, plain_laboratory
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.io.laboratory import LABORATORY_FILE, Laboratory

PNG = b"\x89PNG\r\n\x1a\n" + b"\0" * 8


def test_entries_are_changed_one_by_one(tmp_path):
    workspace = Workspace(tmp_path)
    assert plain_laboratory(workspace) == {"name": "", "address": "", "logo": False}
    (tmp_path / LABORATORY_FILE).write_text('trend = ["Speed"]\n')
    change_laboratory(workspace, {"name": "Ours"})
    (tmp_path / "logo.png").write_text("another picture")
    change_laboratory(workspace, {"logo": base64.b64encode(PNG).decode()})
    assert change_laboratory(workspace, {"address": "Road"}) == {
        "name": "Ours",
        "address": "Road",
        "logo": True,
    }
    assert laboratory_of(workspace) == Laboratory(
        "Ours", "Road", PNG, "image/png", ("Speed",), "logo-d9c9bcbb.png"
    )
    assert change_laboratory(workspace, {"logo": ""})["logo"] is False
    assert (tmp_path / "logo.png").read_text() == "another picture"


@pytest.mark.parametrize(
    "sent", [3, {"name": 3}, {"logo": "?"}, {"logo": base64.b64encode(b"<svg/>").decode()}]
)
def test_other_entries_are_refused(tmp_path, sent):
    with pytest.raises(InvalidInput, match=r"the page sent|the logo must be a picture"):
        change_laboratory(Workspace(tmp_path), sent)
    assert not (tmp_path / LABORATORY_FILE).exists()
