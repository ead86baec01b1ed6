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

extensions = ["sphinx.ext.autodoc", "sphinx.ext.mathjax", "docstrings", "formulas"]
mathjax_path = "mathjax/MathJax.js"
mathjax2_config = {
    "jax": ["input/TeX", "output/CommonHTML"],
    "extensions": ["tex2jax.js"],
    "TeX": {"extensions": ["AMSmath.js", "AMSsymbols.js"]},
    "messageStyle": "none",
}
default_role = "code"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "inherited-members": True}
add_module_names = False
exclude_patterns = ["images"]
html_theme = "sphinx_rtd_theme"
html_static_path = ["static"]
html_css_files = ["wide.css"]
html_show_sourcelink = False
