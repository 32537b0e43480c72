"""Sphinx configuration; the reference pages are made from the code before each build."""

import os
import sys
from pathlib import Path

import bondcell

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

from reference_pages import write_pages  # noqa: E402

# Notebooks run in the root of the checkout, where results/ is.
os.environ.setdefault("OMP_NUM_THREADS", "1")

project = "bondcell"
author = "bondcell developers"
copyright = "bondcell developers, BSD-3-Clause"
version = release = bondcell.__version__

extensions = ["sphinx.ext.autodoc", "numpydoc", "myst_nb"]
exclude_patterns = ["reference/README.md"]
default_role = "code"
nitpicky = False

autodoc_typehints = "none"
numpydoc_show_class_members = False

myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 3
nb_execution_mode = "cache"
nb_execution_cache_path = str(HERE.parent / "build" / "notebooks")
nb_execution_in_temp = False
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True

html_theme = "furo"
html_title = f"bondcell {version}"
html_static_path = []
html_copy_source = False


def setup(app):
    """Make the reference pages before the sources are read."""
    app.connect("builder-inited", lambda _: write_pages(HERE / "reference"))
