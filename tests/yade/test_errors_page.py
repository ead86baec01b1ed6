"""docs/errors.rst quotes messages that the sources still have."""

import ast
import pathlib
import re

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
