"""Does another Debian's yade still have the binary interface that plugin/wrap/yade-abi declares? By its libraries alone:

    abi.py BUILD OTHER      folder of our build, and of the other libyade's package with the libraries out of it

Every symbol that the plugin takes from YADE is exported there; virtual functions stand in the order that they have in the YADE
that the plugin was built with, where ancf checks it at each import; classes have the size that our declarations give them.
"""

import json
import pathlib
import re
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
LIBRARIES = ("libyade.so", "libpkg_common.so", "libpkg_dem.so")
POINTER = 8  # bytes


def lines(*command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=True)
    return [line.split() for line in done.stdout.splitlines()]


class Library:
    """What one shared library exports."""

    def __init__(self, path):
        self.path = path
        self.symbols = {}  # name: (address, size)
        self.names = {}  # address: names
        for words in lines("nm", "-D", "-S", "--defined-only", path):
            if len(words) == 4:
                address, size = int(words[0], 16), int(words[1], 16)
                self.symbols[words[3]] = (address, size)
                self.names.setdefault(address, set()).add(words[3])
        self._pointers = None

    def slots(self, table):
        """Names of what each entry of a vtable may be called; None for a number."""
        if self._pointers is None:
            self._pointers = dict(self._relocations())
        start, size = self.symbols[table]
        return [self._pointers.get(at) for at in range(start, start + size, POINTER)]

    def _relocations(self):
        for words in lines("readelf", "-rW", self.path):
            if "R_X86_64_64" in words:
                yield int(words[0], 16), {words[4].split("@")[0]}
            elif "R_X86_64_RELATIVE" in words:
                yield int(words[0], 16), self.names.get(int(words[3], 16), set())

    def sizeMade(self, name):
        """Bytes that the class's factory asks operator new for; None without a factory here."""
        factory = (
            f"_ZN5boost13serialization7factoryIN4yade{mangled(name)}ELi0EEEPT_P13__va_list_tag"
        )
        if factory not in self.symbols:
            return None
        start, length = self.symbols[factory]
        bounds = (f"--start-address={start}", f"--stop-address={start + length}")
        bytes_ = None
        for words in lines("objdump", "-d", "--no-show-raw-insn", *bounds, self.path):
            size = re.fullmatch(r"\$0x([0-9a-f]+),%edi", words[-1]) if words else None
            if size:
                bytes_ = int(size[1], 16)
            elif words and "_Znwm" in words[-1]:
                return bytes_
        raise SystemExit(f"{self.path.name}: no size of {name} found")


def mangled(name):
    return f"{len(name)}{name}"


class Yade:
    def __init__(self, folder):
        self.libraries = [Library(pathlib.Path(folder) / name) for name in LIBRARIES]

    def exported(self):
        return set().union(*(library.symbols for library in self.libraries))

    def vtable(self, name):
        table = f"_ZTVN4yade{mangled(name)}E"
        return next((one.slots(table) for one in self.libraries if table in one.symbols), None)

    def sizeMade(self, name):
        sizes = (library.sizeMade(name) for library in self.libraries)
        return next((size for size in sizes if size), None)


def sameSlot(ours, theirs):
    if ours is None or theirs is None:
        return ours is theirs
    return bool(ours & theirs) or not (ours or theirs)


def vtableFaults(name, ours, theirs):
    if ours is None or theirs is None:
        return [] if ours is theirs else [f"vtable of {name}: in one of the two only"]
    if len(ours) != len(theirs):
        return [f"vtable of {name}: {len(ours)} entries, there {len(theirs)}"]
    return [
        f"vtable of {name}, entry {i}: {a and sorted(a)}, there {b and sorted(b)}"
        for i, (a, b) in enumerate(zip(ours, theirs))
        if not sameSlot(a, b)
    ]


def sizeFaults(build, sizes, version):
    """What the compiler says of our declarations for that version, told the sizes found there."""
    check = ROOT / "plugin" / "wrap" / "LayoutCheck.cpp"
    commands = json.loads((build / "compile_commands.json").read_text())
    command = next(c for c in commands if pathlib.Path(c["file"]) == check)
    words = shlex.split(command["command"])
    words = words[next(i for i, word in enumerate(words) if word.startswith("-")) :]
    for option in ("-o", "-c"):
        at = words.index(option)
        del words[at : at + 2]
    words = [word for word in words if "ANCF_YADE_VERSION" not in word]
    source = build / "sizes.cpp"
    headers = sorted((check.parent / "yade-abi").glob("*/**/*.hpp"))
    text = [f'#include "{header}"' for header in headers]
    text += [
        f'static_assert(sizeof(yade::{name}) == {size}, "size");' for name, size in sizes.items()
    ]
    source.write_text("\n".join(text) + "\n")
    done = subprocess.run(
        ["g++", *words, f"-DANCF_YADE_VERSION={version}", "-fsyntax-only", str(source)],
        capture_output=True,
        text=True,
        cwd=command["directory"],
    )
    if done.returncode == 0:
        return []
    wrong = re.findall(r"static_assert\(sizeof\(yade::(\w+)\) == (\d+)", done.stderr)
    return [f"size of {name} is {size} there" for name, size in wrong] or [done.stderr]


def main(build, other):
    package = next(pathlib.Path(other).glob("libyade_*.deb")).name
    year, month = map(int, re.match(r"libyade_(\d+)\.(\d+)", package).groups())
    version = 100 * year + month  # as CMake has it
    build = pathlib.Path(build).resolve()
    plugin = next((build / "python" / "ancf").glob("_ancf.*.so"))
    cache = (build / "CMakeCache.txt").read_text()
    here = Yade(re.search(r"^YADE_LIBRARY_DIR:\w+=(.*)$", cache, re.MULTILINE)[1])
    there = Yade(other)

    imported = [words[-1] for words in lines("nm", "-D", "--undefined-only", plugin)]
    imported = sorted(name for name in imported if "N4yade" in name or "K4yade" in name)
    faults = [f"not exported: {name}" for name in imported if name not in there.exported()]

    layout = (ROOT / "plugin" / "wrap" / "LayoutCheck.cpp").read_text()
    tables = dict(re.findall(r'addVtable\(f, "(\w+)", (\d+)\)', layout))
    for name, size in tables.items():
        entries = there.vtable(name)
        if entries is None or POINTER * len(entries) != int(size):
            faults.append(f"vtable of {name}: LayoutCheck.cpp says {size} bytes")
    used = {
        found[1]
        for found in (re.fullmatch(r"_ZT[IV]N4yade\d+(\w+)E", n) for n in imported)
        if found
    }
    used |= set(tables)
    for name in sorted(used):
        faults += vtableFaults(name, here.vtable(name), there.vtable(name))

    headers = (ROOT / "plugin" / "wrap" / "yade-abi").glob("*/**/*.hpp")
    begun = {n for h in headers for n in re.findall(r"(\w+)\(\) = delete", h.read_text())}
    for name in sorted(begun & used):  # only the first part is declared, since nobody makes one
        if here.sizeMade(name) != there.sizeMade(name):
            faults.append(
                f"size of {name}: {here.sizeMade(name)} here, {there.sizeMade(name)} there"
            )
    classes = sorted({*re.findall(r"addSize<(\w+)>", layout), *used} - begun)
    sizes = {name: size for name in classes if (size := there.sizeMade(name))}
    faults += sizeFaults(build, sizes, version)

    if not (imported and tables and sizes):
        faults.append("nothing was compared")
    if faults:
        raise SystemExit("\n".join(faults))
    print(f"=> {package}: {len(imported)} symbols, {len(used)} vtables, {len(sizes)} sizes agree")


if __name__ == "__main__":
    main(*sys.argv[1:])
