"""The Cable and Net objects of a scene, also after O.load.

What an object knows beyond the CableEngine's attributes is saved with these, as one line of JSON
each in CableEngine.record.
"""

import json

import numpy as np
from yade import O

from .cables import Cable
from .nets import Net
from .structure import WOUND, Section, Structure, cableEngines, chained, slidingClaim

KINDS = {"Cable": Cable, "Net": Net}


def structures():
    """The Cable and Net objects of the scene, in the order in which they were appended.

    They are made anew at each call, also after O.load and in another process, and do all that those
    of the script do that made the scene. Raises ValueError if CableEngine.record was damaged.
    """
    return [made for engine in cableEngines() for made in _structures(engine)]


def _structures(engine):
    made = []
    for i, text in enumerate(engine.record):
        try:
            made.append(_made(engine, i, json.loads(text)))
        except (KeyError, IndexError, TypeError, ValueError, AttributeError) as error:
            where = f"CableEngine {engine.family}.record[{i}] = {text[:60]!r}"
            raise ValueError(
                f"{where}: does not describe a Cable or Net of this engine ({error}): load another "
                "save"
            ) from error
    _claim(engine, made)
    return made


def _made(engine, number, known):
    made = object.__new__(KINDS[known["class"]])
    knots, edges, parts = known["knots"], np.array(known["edges"]), known["parts"]
    firstNode, firstElement = known["first"]
    layout = chained(knots, edges, parts)
    layout.runs = made._runs(edges, parts)
    stored = known["own"].get("stored")
    if stored:
        layout.wind(*stored, 1.0)
    count = len(layout.ends)
    elements = slice(firstElement, firstElement + count)
    layout.length = np.array((engine.winchLengths if stored else engine.length)[elements])
    follows = np.array(engine.next[elements])
    if len(layout.length) != count or firstNode + layout.nodes > engine.nNodes:
        raise ValueError(f"{count} elements from {firstElement} on, of {engine.nElements}")
    layout.next = np.where(follows < 0, -1, follows - firstElement)
    section = Section(
        material=O.materials[known["material"]],
        kind=engine.kind[firstElement] & ~WOUND,
        **known["section"],
    )
    Structure.__init__(made, known["label"], section, layout, **known["shows"])
    made._engine, made._family, made._number = engine, engine.family, number
    made._first = (firstNode, firstElement)
    made.bodies = [b for b in engine.elementIds[elements] if b >= 0]
    made._recall(known["own"])
    return made


def _claim(engine, structures):
    """Tells structures what holds their knots, by the engine's lists."""
    knots = {}  # node -> (structure, knot)
    for one in structures:
        knots |= {one._first[0] + knot: (one, knot) for knot in range(one._layout.knots)}
    wound = {node for node, kind in zip(engine.winchNodes, engine.kind) if kind & WOUND}
    standing = {}  # node -> those that it stands for
    for node in engine.tiedNodes:
        if node not in wound:
            standing.setdefault(engine.tied(node), []).append(node)
    for node, others in standing.items():
        first, at = knots[node]
        for other in others:
            one, knot = knots[other]
            one._claims[knot] = f"tied to knot {at} of {first.name}"
    holds = [(node, "fixed") for node in engine.fixedNodes]
    ends = engine.ends
    turned = {ends[end] for end in engine.followEnds}
    for node, body in zip(engine.followNodes, engine.followIds):
        holds.append((node, f"{'clamped to' if node in turned else 'following'} body {body}"))
    holds += [(n, f"carrying body {b}") for n, b in zip(engine.carryNodes, engine.carryIds)]
    clamped = {ends[end] for end in engine.clampedEnds}
    for node, direction in zip(engine.slideNodes, engine.slideAlong):
        holds.append((node, slidingClaim(direction, node in clamped)))
    for node, what in holds:
        for held in {node, *standing.get(node, [])} & knots.keys():
            one, knot = knots[held]
            one._claims[knot] = "clamped" if what == "fixed" and node in clamped else what
