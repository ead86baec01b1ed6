"""Formulas that need no network: Debian's MathJax (libjs-mathjax) goes into the built pages."""

import pathlib
import shutil

MATHJAX = pathlib.Path("/usr/share/javascript/mathjax")
PARTS = (
    "MathJax.js",
    "extensions",
    "jax/element",
    "jax/input/TeX",
    "jax/output/CommonHTML",
    "fonts/HTML-CSS/TeX/woff",
)


def copy(app, error):
    if error or app.builder.format != "html":
        return
    target = pathlib.Path(app.outdir) / "_static" / "mathjax"
    for part in PARTS:
        to = target / part
        to.parent.mkdir(parents=True, exist_ok=True)
        if (MATHJAX / part).is_dir():
            shutil.copytree(MATHJAX / part, to, dirs_exist_ok=True)
        else:
            shutil.copy(MATHJAX / part, to)


def setup(app):
    app.connect("build-finished", copy)
    return {"parallel_read_safe": True}
