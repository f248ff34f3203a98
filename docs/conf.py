"""The documentation site: `make docs` writes it to out/site. Sources are the pages of the whole repository, so that the
links between them hold in a checkout too."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "kernels"), str(ROOT / "docs"), str(ROOT / "tests" / "conformance")]

import warpffrf  # noqa: E402

project = "warpffrf"
author = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["authors"][0]["name"]
copyright = author
version = release = warpffrf.__version__

root_doc = "docs/index"
include_patterns = ["docs/**", "README.md", "CHANGELOG.md", "CONTRIBUTING.md", "bench/README.md"]
exclude_patterns = ["docs/site_pages/**"]
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx_design",
    "site_pages.api",
    "site_pages.gallery",
    "site_pages.docstrings",
    "site_pages.mathml",
]

default_role = "py:obj"
python_maximum_signature_line_length = 80
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
add_module_names = False
toc_object_entries_show_parents = "hide"

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_dmath_double_inline = True
html_math_renderer = "mathml"
myst_heading_anchors = 4
nb_execution_mode = "cache"  # a notebook runs again where its code has changed
nb_execution_cache_path = str(ROOT / "out" / "notebooks")
nb_execution_raise_on_error = True
nb_execution_timeout = 600
nb_execution_in_temp = True
nb_merge_streams = True  # prints of a cell in one block

WIDE = ("docs/verification", "docs/method/symbols", "docs/arrays", "docs/made/quantities")  # pages of wide tables
html_theme = "pydata_sphinx_theme"
html_title = f"warpffrf {release}"
html_extra_path = ["site_pages/root"]  # the first page of the folder leads to that of the site
html_static_path = ["site_pages/static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {
    "navigation_with_keys": False,
    "show_prev_next": False,
    "navbar_align": "left",
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": {"**": ["page-toc"], **dict.fromkeys(WIDE, [])},
    "header_links_before_dropdown": 7,
}
html_sidebars = dict.fromkeys((*WIDE, "docs/install", "docs/reading_a_report"), [])
