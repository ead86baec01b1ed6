"""What the runs are measured against: made once with far finer settings, kept in references.json."""

import json
import pathlib

import numpy as np

FILE = pathlib.Path(__file__).with_name("references.json")


def reference(name):
    """The stored value (numpy)."""
    return np.array(json.loads(FILE.read_text())[name]["value"])


def store(made):
    """made: {name: (value, distance of a coarser one, how)}; keeps what is not made again."""
    known = json.loads(FILE.read_text()) if FILE.exists() else {}
    for name, (value, check, how) in made.items():
        known[name] = dict(value=np.asarray(value).tolist(), check=float(check), made=how)
        print(f"{name}: differs by {check:.1e} from the coarser one", flush=True)
    lines = (f"{json.dumps(name)}: {json.dumps(entry)}" for name, entry in known.items())
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n")


def check(name):
    """How far a coarser reference was from the stored one."""
    return json.loads(FILE.read_text())[name]["check"]
