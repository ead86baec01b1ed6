"""Saved scenes whose bytes were changed: refused with an exception, or run on soundly; no signal comes from our code.

Each is loaded in a fork. XML by every kind of damage; binary files are YADE's own archives (Boost), which check
nothing: what they do is compared with a scene without any object of ours. By command line many more:
    python3 tests/yade/test_damaged_saves.py --count 2000 --seed 1 [--kind xml|bz2|binary|stock]
"""

import argparse
import collections
import os
import pathlib
import random
import re
import sys
import tempfile
import time

import numpy as np
import pytest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import ancf
from ancf import pulleys
from forks import forked
from helpers import ball, bodyEngines, material, plane, squareNet, steps
from yade import O, utils, wrapper

FILES = {"xml": "scene.xml", "bz2": "scene.xml.bz2", "binary": "scene.yade", "stock": "stock.yade"}
TYPES = ("ValueError", "RuntimeError", "IndexError", "TypeError", "MemoryError")


def ours():
    """A net that touches a ball, a sheave that turns, a slider on a guide."""
    O.reset()
    material("cable")
    ball((0, 0, -0.0105), 0.01, material="cable")
    net = squareNet(2, 0.02, normal=(0, 0, 1), mass="lumped", damping=5e-5)
    net.carry(0, ball((-0.02, -0.02, 0), 0.002, mass=1e-3, material="cable"))
    sheave = pulleys.sheave((0, 0, -2), 0.05, axis=(0, 1, 0), width=0.01, material="cable")
    slider = ball((0, 1, 0), 0.01, mass=0.1, material="cable", mask=4)
    turning, guide = ancf.SheaveEngine(), ancf.GuideEngine()
    turning.add(sheave, viscous=1e-3, torque=1e-3)
    guide.add(slider, (1, 0, 0), friction=0.1)
    O.engines = pulleys.engines(net, turning, guide, gravity=(0, 0, -9.81))
    O.dt *= 0.5
    steps(20)
    assert net.engine.contacts > 0


def stock():
    """Spheres on a box, nothing of ours."""
    O.reset()
    O.materials.append(wrapper.FrictMat(label="stock"))
    plane((0, 0, -0.1), (1, 1, 0.1), material="stock")
    for i in range(4):
        O.bodies.append(utils.sphere((0.05 * i, 0, 0.0099), 0.01, material="stock"))
    O.engines = [*bodyEngines((0, 0, -9.81))]
    O.engines[2].physDispatcher.functors = [wrapper.Ip2_FrictMat_FrictMat_FrictPhys()]
    O.engines[2].lawDispatcher.functors = [wrapper.Law2_ScGeom_FrictPhys_CundallStrack()]
    O.dt = 1e-5
    steps(20)


def saved(folder):
    """{kind: its bytes}"""
    kept = {}
    for kind, file in FILES.items():
        (stock if kind == "stock" else ours)()
        path = str(folder / file)
        O.save(path)
        kept[kind] = pathlib.Path(path).read_bytes()
    O.reset()
    return kept


# ---- damage ----------------------------------------------------------------------------------------


def flip(data, chance):
    """Some bits."""
    some = bytearray(data)
    for _ in range(chance.choice([1, 1, 2, 8])):
        some[chance.randrange(len(some))] ^= 1 << chance.randrange(8)
    return bytes(some)


def truncate(data, chance):
    return data[: chance.randrange(len(data))]


def cut(data, chance):
    start = chance.randrange(len(data))
    return data[:start] + data[start + chance.choice([1, 10, 1000]) :]


def double(data, chance):
    start = chance.randrange(len(data))
    end = start + chance.choice([1, 10, 1000])
    return data[:end] + data[start:]


VALUES = (
    "0 -1 1 64 1000000 2147483647 -2147483648 1099511627776 1e-300 1e300 -1e300 nan inf x".split()
)


def edit(data, chance):
    """A value between two tags."""
    places = [m.span(1) for m in re.finditer(rb">([^<>\n]+)<", data)]
    for _ in range(chance.choice([1, 1, 2])):
        start, end = chance.choice(places)
        data = data[:start] + chance.choice(VALUES).encode() + data[end:]
        places = [m.span(1) for m in re.finditer(rb">([^<>\n]+)<", data)]
    return data


def damaged(kind, data, chance):
    """(what was done, the file)."""
    ways = [flip, truncate, cut, double] + ([edit] * 4 if kind == "xml" else [])
    way = chance.choice(ways)
    return way.__name__, way(data, chance)


# ---- what comes of it ------------------------------------------------------------------------------


def loaded(path):
    """Loads, and goes on a little: how that ended, and the text of an exception."""
    try:
        O.load(path)
        steps(12)  # what is not finite is told within ten
    except Exception as error:
        return type(error).__name__, str(error)
    moving = [[*b.state.pos, *b.state.vel] for b in O.bodies if b]
    for engine in O.engines:
        if isinstance(engine, ancf.CableEngine):
            moving += [engine.position, engine.velocity]
    return "ran" if all(np.isfinite(m).all() for m in moving) else "not finite", ""


def one(kind, data, folder, chance):
    """(what was done, how it ended, text) of a file at random."""
    way, bad = damaged(kind, data, chance)
    path = folder / ("damaged-" + FILES[kind])
    path.write_bytes(bad)
    return (way, *forked(lambda: loaded(str(path))))


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    yield saved(tmp_path_factory.mktemp("saves"))
    O.reset()


def test_undamaged(files, tmp_path):
    for kind, data in files.items():
        path = tmp_path / FILES[kind]
        path.write_bytes(data)
        assert forked(lambda: loaded(str(path))) == ("ran", ""), kind


def test_damaged_xml(files, tmp_path):
    """Told, or a scene that runs on; what is not finite comes from a body that YADE itself moves."""
    ends, bad = collections.Counter(), []
    for number in range(60):
        way, how, text = one("xml", files["xml"], tmp_path, random.Random(f"short/{number}"))
        ends[how] += 1
        if how not in ("ran", *TYPES):
            bad.append(f"{number}: {way}: {how}: {text}")
    assert ends["ran"] > 0 and ends["RuntimeError"] + ends["ValueError"] > 0
    assert not bad, "\n".join(bad)


@pytest.mark.parametrize(
    "there, instead, words",
    [
        ("<id>0</id>", "<id>2147483647</id>", "body 0 says that its id is 2147483647"),
        ("<clumpId>-1<", "<clumpId>1000000<", "member of clump 1000000, which is none"),
        ("<clumpId>-1<", "<clumpId>2<", "member of clump 2, which is none"),
    ],
)
def test_numbers_of_bodies(files, tmp_path, there, instead, words):
    path = tmp_path / "numbers.xml"
    text = files["xml"].decode()
    assert there in text
    path.write_text(text.replace(there, instead, 1))
    how, told = forked(lambda: loaded(str(path)))
    assert how == "RuntimeError" and words in told


# ---- at random, by command line --------------------------------------------------------------------


def long(kind, count, seed):
    """Files of a kind; prints how they ended. Returns the number of signals, hangs and the like."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        data, ends, bad, start = saved(folder)[kind], collections.Counter(), 0, time.time()
        for number in range(count):
            chance = random.Random(f"{kind}/{seed}/{number}")
            way, how, text = one(kind, data, folder, chance)
            ends[how] += 1
            if how not in ("ran", *TYPES):
                bad += 1
                print(f"{kind}, seed {seed}, file {number}: {way}: {how}: {text}", flush=True)
                if kind == "xml":
                    (folder / ("damaged-" + FILES[kind])).rename(
                        f"/tmp/damaged-{seed}-{number}.xml"
                    )
    print(f"{kind}, seed {seed}: {count} files in {time.time() - start:.0f} s: {dict(ends)}")
    return bad


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", choices=FILES, default="xml")
    options = parser.parse_args()
    bad = long(options.kind, options.count, options.seed)
    sys.stdout.flush()
    os._exit(1 if bad else 0)
