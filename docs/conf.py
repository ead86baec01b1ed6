"""Sphinx: the reference pages are made from the docstrings of the built plugin (build/python)."""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "docs"), str(ROOT / "build" / "python")]

project = "yade-ancf"
copyright = "the authors of yade-ancf, GPL-2.0-or-later"
version = release = next(
    line.split("VERSION")[1].split()[0]
    for line in (ROOT / "CMakeLists.txt").read_text().splitlines()
    if line.startswith("project(")
)

extensions = ["sphinx.ext.autodoc", "sphinx.ext.mathjax", "docstrings"]
default_role = "code"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "inherited-members": True}
add_module_names = False
exclude_patterns = ["images"]
html_theme = "alabaster"
html_theme_options = {
    "description": "Cables and nets for YADE",
    "page_width": "1080px",
    "fixed_sidebar": True,
}
html_sidebars = {"**": ["about.html", "navigation.html", "searchbox.html"]}
html_show_sourcelink = False
