"""Our plain docstrings as reStructuredText, and the directive `yadeclasses` for classes of the plugin in C++."""

import re

from docutils import nodes
from docutils.parsers.rst import Directive
from docutils.statemachine import StringList

ITEM = re.compile(r"^(\w[\w, ]*?) {2,}(\S.*)$")  # "name      what it is"
FLAGS = {"2": "read-only"}  # of YADE's attributes


def escape(text):
    """Text with code in backticks kept and all else that means something to reStructuredText escaped."""
    parts = re.split(r"(`[^`]*`)", text)
    return "".join(p if p.startswith("`") else re.sub(r"([\\*|_])", r"\\\1", p) for p in parts)


def restructured(lines):
    """Lines of a docstring in which "name   text" opens an item that goes on in indented lines."""
    out = []
    inItem = False
    for line in lines:
        item = ITEM.match(line)
        if item:
            if not inItem:
                out.append("")
            names = ", ".join(f"`{name.strip()}`" for name in item.group(1).split(","))
            out += [names, "    " + escape(item.group(2))]
            inItem = True
        elif inItem and line.startswith(" "):
            out.append("    " + escape(line.strip()))
        else:
            if inItem and line.strip():
                out.append("")
            inItem = inItem and not line.strip()
            out.append(escape(line.strip()))
    return out


def processDocstring(app, what, name, obj, options, lines):
    lines[:] = restructured(lines)


def fromYade(text):
    """YADE's markup as Sphinx's: mathematics in dollars, references to classes."""
    text = re.sub(r":yref:`([^`]*)`", r"`\1`", text)
    parts = re.split(r"(\$[^$]*\$)", text)
    return "".join(f":math:`{p[1:-1]}`" if p.startswith("$") else escape(p) for p in parts)


def attribute(name, doc):
    """One line of the list of attributes."""
    kind = re.search(r":yattrtype:`([^`]*)`", doc)
    default = re.search(r":ydefault:`([^`]*)`", doc)
    flags = re.search(r":yattrflags:`([^`]*)`", doc)
    text = fromYade(re.split(r":y(?:default|attrtype|attrflags):", doc)[0].strip())
    notes = [f"`{kind.group(1)}`"] if kind else []
    if default and default.group(1):
        value = default.group(1).replace("std::numeric_limits<Real>::quiet_NaN()", "NaN")
        notes.append(f"default `{value}`")
    if flags and flags.group(1) in FLAGS:
        notes.append(FLAGS[flags.group(1)])
    return f"- **{name}** -- {text}" + (f" ({', '.join(notes)})" if notes else "")


def method(name, doc):
    """One line of the list of methods."""
    found = re.search(r"\((.*)\) -> (\w+) :\s*(.*)", doc, re.S)
    arguments = re.findall(r"\(\w+\)(\w+)", found.group(1))[1:]
    return f"- **{name}** ({', '.join(arguments)}) -- {fromYade(' '.join(found.group(3).split()))}"


class YadeClasses(Directive):
    """.. yadeclasses:: documents every class of the plugin, without what it has from its base."""

    def run(self):
        from ancf import _load

        return [self._section(cls) for cls in _load.classes.values()]

    def _section(self, cls):
        own = {k: v for k, v in vars(cls).items() if not k.startswith("_") and v.__doc__}
        attributes = [attribute(k, v.__doc__) for k, v in own.items() if isinstance(v, property)]
        methods = [method(k, v.__doc__) for k, v in own.items() if not isinstance(v, property)]
        lines = [f"*Derived from* `{cls.__mro__[1].__name__}`.", "", fromYade(cls.__doc__), ""]
        for title, items in (("Attributes", attributes), ("Methods", methods)):
            if items:
                lines += [f"{title}:", "", *items, ""]
        section = nodes.section(ids=[nodes.make_id(cls.__name__)], names=[cls.__name__.lower()])
        section += nodes.title(text=cls.__name__)
        self.state.document.note_implicit_target(section)
        self.state.nested_parse(StringList(lines, source="docstrings"), 0, section)
        return section


def setup(app):
    app.connect("autodoc-process-docstring", processDocstring)
    app.add_directive("yadeclasses", YadeClasses)
    return {"version": "1", "parallel_read_safe": True}
