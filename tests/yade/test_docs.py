"""Pages of docs that speak of the sources: errors.rst quotes messages that they still have, gallery.rst shows every script."""

import ast
import inspect
import pathlib
import re

import ancf
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
GAP = "\0"  # between the parts of a message, where a name or number comes in
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')


def ofC(text):
    """The string literals of C or C++, those that the compiler joins as one."""
    joined = re.sub(r'(?<!\\)"[ \t]*\\?\n?\s*"(?=[^,)])', "", text)
    return GAP.join(LITERAL.findall(joined))


def ofPython(text):
    """The strings of Python, with a gap for each {value}."""

    def parts(node):
        if isinstance(node, ast.JoinedStr):
            return "".join(v.value if isinstance(v, ast.Constant) else GAP for v in node.values)
        return node.value

    inside = set()
    found = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.JoinedStr):
            inside |= set(map(id, node.values))
        if isinstance(node, ast.JoinedStr) or (
            isinstance(node, ast.Constant)
            and isinstance(node.value, str)
            and id(node) not in inside
        ):
            found.append(parts(node))
    return GAP.join(found)


def messages():
    """The strings of each source file."""
    for folder in ("plugin/wrap", "plugin/c", "yade-scripts/ancf"):
        for file in sorted((ROOT / folder).rglob("*")):
            if file.suffix in (".c", ".h", ".cpp", ".hpp"):
                yield ofC(file.read_text())
            elif file.suffix == ".py":
                yield ofPython(file.read_text())


def quoted():
    """The messages that the page quotes, from its definition list."""
    page = (ROOT / "docs" / "errors.rst").read_text()
    return re.findall(r"^``(.*)``$", page, re.M)


def said(quote, texts):
    """Whether the fragments of a quote come one after the other in the strings of a file."""
    fragments = [part.strip() for part in quote.split("...") if part.strip(" ,")]
    pattern = re.compile("(?s)" + ".{0,900}?".join(map(re.escape, fragments)))
    return any(pattern.search(text) for text in texts)


TEXTS = list(messages())


@pytest.mark.parametrize("quote", quoted())
def test_quoted_message_is_in_the_sources(quote):
    assert said(quote, TEXTS)


def test_a_message_that_nobody_sends_is_found_out():
    assert len(quoted()) > 40
    assert not said("the energy is out of balance: ... apples", TEXTS)
    assert not said("no such message", TEXTS)


def test_gallery_shows_every_script():
    """Under the name of each script stand its command and a picture that is there, and no others."""
    page = (ROOT / "docs" / "gallery.rst").read_text()
    parts = re.split(r"^(\w+\.py)\n-+$", page, flags=re.M)[1:]
    shown = dict(zip(parts[::2], parts[1::2]))
    scripts = [p for p in (ROOT / "yade-scripts").glob("*.py") if "__main__" in p.read_text()]
    assert sorted(shown) == sorted(path.name for path in scripts)
    for script, text in shown.items():
        assert f"python3 yade-scripts/{script}" in text
        pictures = re.findall(r"\.\. image:: (\S+)", text)
        assert pictures and all((ROOT / "docs" / picture).is_file() for picture in pictures)


@pytest.mark.parametrize(
    "page", sorted((ROOT / "docs" / "developers").glob("*.rst")), ids=lambda p: p.stem
)
def test_developers_pages_name_files_that_are_there(page):
    named = re.findall(r"`((?:plugin|tests|docs|yade-scripts|\.ci)/[^`\s]*)`", page.read_text())
    assert [path for path in named if not (ROOT / path).exists()] == []


@pytest.mark.parametrize("cls", [ancf.Cable, ancf.Line, ancf.Net, ancf.Winch])
def test_docstrings_name_all_arguments_and_no_others(cls):
    told = re.findall(r"^(\w[\w, ]*?) {2,}\S", inspect.getdoc(cls), re.M)
    told = [name for names in told for name in names.split(", ")]
    assert sorted(told) == sorted(set(inspect.signature(cls).parameters))
