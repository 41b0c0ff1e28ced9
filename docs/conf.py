"""How the documentation is built: ``sphinx-build -W docs build/docs``. Nothing is loaded from the network."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE / "_extensions")]

from mbkf.version import __version__  # noqa: E402, the path above comes first

project = "mbkf"
author = "The mbkf authors"
copyright = "The mbkf authors"
release = version = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "edited_files",
    "gallery",
    "mathml",
    "public_surface",
    "result_quantities",
    "step_files",
]
html_math_renderer = "mathml"
myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "none"
napoleon_use_ivar = True

html_theme = "furo"
html_title = f"mbkf {__version__}"
html_static_path = ["_static"]
html_css_files = ["mbkf.css"]
html_copy_source = False
