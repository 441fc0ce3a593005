"""The site: Sphinx, built without a network by `.ci/docs`. A warning is an error there."""

import os
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path[:0] = [str(ROOT), str(HERE / "extensions")]

import sk120stiff  # noqa: E402

project = "sk120stiff"
author = "the sk120stiff authors"
version = release = sk120stiff.__version__
copyright = author  # noqa: A001  (Sphinx calls it so)

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "commands",
    "from_root",
    "run",
    "without_scripts",
]
exclude_patterns = ["_build", "joss", "extensions", "gallery", "auto_gallery/*.ipynb"]
nitpicky = False  # types of signatures are no pages of their own
default_role = "code"  # docstrings speak Markdown's backticks
suppress_warnings = ["config.cache"]  # the gallery's order is a function

html_theme = "furo"
html_title = "sk120stiff"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_show_sourcelink = False
html_theme_options = {"navigation_with_keys": True}

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath", "amsmath"]
myst_heading_anchors = 3
myst_url_schemes = ["http", "https", "mailto"]

nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_execution_excludepatterns = ["auto_gallery/*"]

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # docstrings say them with shapes and units
napoleon_custom_sections = [("Warns", "returns_style")]

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "auto_gallery",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "show_memory": False,
    "min_reported_time": 1000,  # a page says the same on every machine
    "remove_config_comments": True,
    "write_computation_times": False,  # that page would fetch scripts
    "show_signature": False,
    "reset_modules": ("gallery_look.reset",),
    "download_all_examples": True,
}

# One core per process: the build runs in several, and so do the commands that pages show.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
