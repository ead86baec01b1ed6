"""Runs what the pages of docs print, as it is printed: `printed.py FOLDER` leaves the scripts in FOLDER.

Of each page the pieces of Python are, in a row, one script. Those with a file's name as caption are that file instead, in
out/first, and the shell commands of the page are run there in a row; from the folder of the repository on the page that makes
out/first.
"""

import os
import pathlib
import re
import subprocess
import sys
import textwrap

DOCS = pathlib.Path(__file__).resolve().parent
FIRST = DOCS.parent / "out" / "first"
BLOCK = re.compile(r"^\.\. code-block:: (\w+)\n((?: +.*\n|\s*\n)+)", re.M)
MPI = {  # more processes than cores, which wait for each other without load, on this machine alone, also as root
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_btl_tcp_if_include": "lo",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
}
CAPTION = re.compile(r" +:caption: (\S+)\n")


def blocks(page):
    """(language, file's name or None, text) of each piece of code of a page."""
    for language, body in BLOCK.findall(page.read_text() + "\n"):
        caption = CAPTION.match(body)
        body = body[caption.end() :] if caption else body
        yield language, caption and caption[1], textwrap.dedent(body).strip() + "\n"


def commands(page, folder):
    """What runs a page: (command, working folder), or None where there is no Python on it."""
    found = list(blocks(page))
    named = {name: text for _, name, text in found if name}
    inRow = [text for language, name, text in found if language == "python" and not name]
    if named:
        FIRST.mkdir(parents=True, exist_ok=True)
        for name, text in named.items():
            (FIRST / name).write_text(text)
        script = folder / f"{page.stem}.sh"
        script.write_text("".join(text for language, _, text in found if language == "sh"))
        where = DOCS.parent if "cd out/first" in script.read_text() else FIRST
        return ["bash", "-e", str(script)], where
    if inRow:
        script = folder / f"{page.stem}.py"
        script.write_text("".join(inRow))
        return [sys.executable, str(script)], folder
    return None


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    pages = [pathlib.Path(p).resolve() for p in sys.argv[2:]] or sorted(DOCS.rglob("*.rst"))
    failed = []
    for page in pages:
        todo = commands(page, folder)
        if todo:
            name = str(page.relative_to(DOCS))
            print("==", name, flush=True)
            command, where = todo
            if subprocess.run(command, cwd=where, env=os.environ | MPI).returncode:
                failed.append(name)
    if failed:
        sys.exit("failed: " + ", ".join(failed))


if __name__ == "__main__":
    main()
