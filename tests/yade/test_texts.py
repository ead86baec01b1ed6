"""Every refusal of the Python classes says object, attribute, value and remedy: one line each."""

import warnings

import numpy as np
import pytest

from ancf import pulleys
from helpers import O, Vector3, ancf, ball, material, steps, utils
from yade import wrapper

LINE = [(0, 0, 0), (1, 0, 0)]
SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
AROUND = [(0, 1), (1, 2), (2, 3), (3, 0)]
GOOD = dict(diameter=1e-3, material="cable")
NAN, INF = float("nan"), float("inf")


def cable(points=LINE, **options):
    return ancf.Cable(points, 2, **{**GOOD, **options})


def appended():
    made = cable()
    made.append()
    return made


def running():
    made = cable()
    O.engines = ancf.engines(made)
    return made


def net(edges=AROUND, **options):
    return ancf.Net(SQUARE, edges, **{**GOOD, **options})


def square(**options):
    return ancf.Net.square(2, 0.1, **{**GOOD, **options})


def withCorners(corners):
    made = square()
    made.corners = corners
    return made


def shoot(made, **options):
    made.addBullets(**{**dict(mass=0.1, radius=0.005, speed=1.0, angle=0.4), **options})


def mouth(rim=None, axis=None):
    made = square()
    made.rim = made.rim if rim is None else rim
    return made.mouthArea(axis)


def sheave(**options):
    return pulleys.sheave(
        (0, 0, 0), **{**dict(radius=0.05, width=0.01, material="cable"), **options}
    )


def path(stops=None, **options):
    ends = dict(start=(-0.051, 0, -1), end=(0.051, 0, -1))
    return pulleys.Path(
        [(sheave(), 1)] if stops is None else stops, **{**dict(diameter=1e-3), **ends, **options}
    )


def lay(tension=0.0, elements=20):
    return pulleys.lay(path(), elements, tension=tension, **GOOD)


def moving(velocity):
    number = ball((5, 5, 5), 0.1, mass=1.0, material="cable")
    O.bodies[number].state.vel = velocity


def erasedWhileCarried():
    made = cable()
    number = ball((1, 0, 0), 0.01, mass=0.1, material="cable")
    made.carry(1, number)
    O.engines = ancf.engines(made)
    O.step()
    O.bodies.erase(number)
    made.setVelocity(lambda p: Vector3(0, 0, 1))


def sand():
    O.materials.append(wrapper.Material(label="sand"))
    return "sand"


TEXTS = [
    # ---- Cable
    (
        lambda: cable(material=None),
        TypeError,
        "Cable.material = None: must be a HollarsMat, or the label",
    ),
    (lambda: cable(material=3.5), TypeError, "Cable.material = 3.5: must be a HollarsMat"),
    (lambda: cable(material=[]), TypeError, r"Cable.material = \[\]: must be a HollarsMat"),
    (lambda: cable(material=True), TypeError, "Cable.material = True: must be a HollarsMat"),
    (lambda: cable(closed="no"), TypeError, "Cable.closed = 'no': must be True or False"),
    (lambda: cable(closed=None), TypeError, "Cable.closed = None: must be True or False"),
    (lambda: cable(selfContact="no"), TypeError, "Cable.selfContact = 'no': must be True or False"),
    (lambda: cable(mask=2**29), ValueError, "Cable.mask = 536870912: has bit 29"),
    (
        lambda: cable(mask=2**31),
        ValueError,
        "Cable.mask = 2147483648: must be at most 2147483647",
    ),
    (lambda: cable(mask=2**40), ValueError, "Cable.mask = 1099511627776: must be at most"),
    (lambda: cable(mask=0), ValueError, "Cable.mask = 0: must be at least 1"),
    (lambda: cable(mask=1.0), TypeError, "Cable.mask = 1.0: must be a whole number"),
    (
        lambda: cable(model=["ancf"]),
        ValueError,
        r"Cable.model = \['ancf'\]: choose one of 'ancf', 'springs'",
    ),
    (
        lambda: cable(mass=np.array([1, 2])),
        ValueError,
        "Cable.mass = array.*choose one of 'consistent'",
    ),
    (
        lambda: cable(["000", "100"]),
        TypeError,
        r"Cable.points = \['000', '100'\]: must be a list of points",
    ),
    (
        lambda: cable([(0, 0, 0), (1e308, 0, 0)]),
        ValueError,
        r"points\[1\] = .*within 1e\+09 m of the origin",
    ),
    (
        lambda: cable([(0, 0, 0), (1e160, 0, 0)]),
        ValueError,
        r"points\[1\] = .*within 1e\+09 m of the origin",
    ),
    (
        lambda: cable([(0, 0, 0), (1e150, 0, 0)]),
        ValueError,
        r"points\[1\] = .*within 1e\+09 m of the origin",
    ),
    (
        lambda: cable(diameter=1e-300),
        ValueError,
        "Cable: ea = young x area = 0 N.*diameter = 1e-300 m",
    ),
    (
        lambda: cable(diameter=1e300),
        (ValueError),
        r"Cable.diameter = 1e[+]300: must be at most 1e[+]09 \[m\]",
    ),
    (lambda: cable(area=1e300), ValueError, "Cable: ea = young x area.*area = 1e[+]300 m2"),
    (lambda: cable(area=1e-300), ValueError, "Cable: ea = young x area.*area = 1e-300 m2"),
    (lambda: cable(bending=1e300), ValueError, "Cable: EI = 1e[+]300 N m2, must be below 1e[+]30"),
    (
        lambda: cable(damping=1e300),
        ValueError,
        r"Cable.damping = 1e[+]300: must be at most 1e[+]06 \[s\]",
    ),
    (
        lambda: cable().setVelocity(None),
        TypeError,
        "Cable.setVelocity: f = None: must be a function of a point",
    ),
    (
        lambda: cable().setVelocity((0, 0, 1)),
        TypeError,
        r"Cable.setVelocity: f = \(0, 0, 1\): must be a function",
    ),
    (
        lambda: cable(diameter=np.float64(-3)),
        ValueError,
        r"Cable.diameter = -3\.0: must be",  # whatever numpy calls it
    ),
    (
        lambda: cable().setVelocity(lambda p: 3),
        TypeError,
        r"setVelocity: f\(\(0.*= 3: must be a vector",
    ),
    (
        erasedWhileCarried,
        IndexError,
        "Cable.setVelocity: knot 1 carries: bodyId = 0: there is no such body",
    ),
    (
        lambda: appended().relax(iterations=None),
        TypeError,
        "Cable.relax: iterations = None: must be a whole number",
    ),
    (
        lambda: appended().relax(iterations=2**40),
        ValueError,
        "Cable.relax: iterations = 1099511627776: must be at most",
    ),
    (
        lambda: appended().relax(iterations=0),
        ValueError,
        "Cable.relax: iterations = 0: must be at least 1",
    ),
    (
        lambda: appended().relax(tolerance="fine"),
        TypeError,
        "Cable.relax: tolerance = 'fine': must be a number",
    ),
    (lambda: appended().tensions(0), ValueError, "Cable.tensions = 0: must be at least 1"),
    (lambda: appended().tensions(1.5), TypeError, "Cable.tensions = 1.5: must be a whole number"),
    (lambda: cable().spans[0].stations(0), ValueError, "Cable.stations = 0: must be at least 1"),
    (lambda: cable().curve(0), ValueError, "Cable.curve = 0: must be at least 1"),
    (lambda: cable().point("a"), TypeError, "Cable: s = 'a': must be a number"),
    (lambda: cable().tensions(), RuntimeError, r"Cable.tensions: append\(\) first"),
    (lambda: cable().load(0, "012"), TypeError, "Cable.load: force = '012': must be a vector"),
    (
        lambda: cable().carry(0, 0, at=(NAN, 0, 0)),
        IndexError,
        "Cable.carry: bodyId = 0: there is no such body",
    ),
    (
        lambda: cable().carry(0, ball((0, 0, 0), 0.01, mass=1.0, material="cable"), at=(NAN, 0, 0)),
        ValueError,
        "Cable.carry: at = .*must be finite",
    ),
    # ---- Net
    (lambda: net(None), TypeError, "Net.edges = None: must be a list of pairs of knot numbers"),
    (lambda: net(3), TypeError, "Net.edges = 3: must be a list of pairs of knot numbers"),
    (lambda: net("0123"), TypeError, "Net.edges = '0123': must be a list of pairs"),
    (lambda: net([3]), TypeError, r"Net.edges\[0\] = 3: must be a list of two knot numbers"),
    (lambda: net(["01"]), TypeError, r"Net.edges\[0\] = '01': must be a list of two knot numbers"),
    (lambda: net([(0.5, 1)]), TypeError, r"Net.edges\[0\] = 0.5: must be a whole number"),
    (
        lambda: net([(0, 4)]),
        IndexError,
        r"Net.edges\[0\] = \(0, 4\): must be two knot numbers from 0 to 3",
    ),
    (
        lambda: net([(0, 1, 2)]),
        IndexError,
        r"Net.edges\[0\] = \(0, 1, 2\): must be two knot numbers",
    ),
    (lambda: net(rim=None), TypeError, "Net.rim = None: must be a list of knot numbers"),
    (lambda: net(rim=[99]), IndexError, "Net: knot = 99: there are 4 knots"),
    (lambda: square(rim=[1]), ValueError, r"Net.rim = \[1\]: a square has its own: leave it out"),
    (lambda: mouth([99]), IndexError, "Net: knot = 99: there are 9 knots"),
    (lambda: mouth([0, 1]), ValueError, r"Net.rim = \[0, 1\]: name the knots around the mouth"),
    (lambda: mouth(3), TypeError, "Net.rim = 3: must be a list of knot numbers"),
    (lambda: mouth(axis=(0, 0, 0)), ValueError, r"mouthArea: axis = \(0, 0, 0\): has no direction"),
    (lambda: mouth(axis="xyz"), TypeError, "mouthArea: axis = 'xyz': must be a vector"),
    (lambda: shoot(withCorners([99])), IndexError, "Net: knot = 99: there are 9 knots"),
    (lambda: shoot(withCorners(None)), TypeError, "Net.corners = None: must be a list of knots"),
    (
        lambda: shoot(square(), material="nosuch"),
        ValueError,
        "addBullets: material = 'nosuch': no such material",
    ),
    (
        lambda: shoot(square(), material=3.5),
        TypeError,
        "addBullets: material = 3.5: must be a HollarsMat",
    ),
    # ---- the scene
    (
        lambda: ancf.engines(cable(), contact="hertz"),
        TypeError,
        "engines: contact = 'hertz': must be a dict",
    ),
    (lambda: ancf.engines(cable(), contact=3), TypeError, "engines: contact = 3: must be a dict"),
    (
        lambda: ancf.engines(cable(), contact=["normal"]),
        TypeError,
        r"engines: contact = \['normal'\]: must be a dict",
    ),
    (
        lambda: ancf.engines(cable(), contact={"normal": "soft"}),
        ValueError,
        r"contact\['normal'\] = 'soft': choose one of",
    ),
    (
        lambda: ancf.engines(cable(), substeps=2**31),
        ValueError,
        "engines: substeps = 2147483648: must be at most 1000",
    ),
    (
        lambda: ancf.engines(cable(), substeps=1e3),
        TypeError,
        "engines: substeps = 1000.0: must be a whole number",
    ),
    (
        lambda: ancf.engines(cable(), speed=NAN),
        ValueError,
        "engines: speed = nan: must be finite and above zero",
    ),
    (
        lambda: ancf.engines(cable(), integrator=None),
        ValueError,
        "engines: integrator = None: choose one of",
    ),
    (
        lambda: (running(), ancf.timeStep([None])),
        TypeError,
        r"timeStep: engines\[0\] = None: must be a CableEngine",
    ),
    (lambda: ancf.timeStep(3), TypeError, "timeStep: engines = 3: must be a list of CableEngines"),
    (
        lambda: (moving(Vector3(NAN, 0, 0)), ancf.engines(cable())),
        ValueError,
        r"O.bodies\[0\].state.vel = \(nan, .*must be finite",
    ),
    (
        lambda: ancf.ropeMaterial(0, 5e3, 0.02),
        ValueError,
        "ropeMaterial: diameter = 0: must be finite and above zero",
    ),
    (
        lambda: ancf.ropeMaterial(1e-3, "x", 0.02),
        TypeError,
        "ropeMaterial: ea = 'x': must be a number",
    ),
    (
        lambda: ancf.ropeMaterial(1e-3, 5e3, NAN),
        ValueError,
        r"ropeMaterial: rhoA = nan: must be finite and above zero \[kg/m\]",
    ),
    (
        lambda: ancf.ropeMaterial(1e-3, 5e3, 0.02, young=1e9),
        ValueError,
        "ropeMaterial: young = 1000000000.0: follows from ea and rhoA",
    ),
    # ---- pulleys
    (lambda: sheave(material=None), TypeError, "sheave: material = None: must be a HollarsMat"),
    (
        lambda: sheave(material="nosuch"),
        ValueError,
        "sheave: material = 'nosuch': no such material",
    ),
    (
        lambda: sheave(material=sand()),
        TypeError,
        "sheave: material = 'sand': is a Material, but sheaves need",
    ),
    (lambda: sheave(color=None), TypeError, "sheave: color = None: must be a vector"),
    (lambda: sheave(mask=2**40), ValueError, "sheave: mask = 1099511627776: must be at most"),
    (lambda: sheave(fixed="no"), TypeError, "sheave: fixed = 'no': must be True or False"),
    (lambda: sheave(axis=(0, 0, 0)), ValueError, "sheave: axis = .*has no direction"),
    (lambda: sheave(grooveAngle=NAN), ValueError, "Sheave.grooveAngle = nan: must be"),
    (lambda: sheave(radius=1e300), ValueError, "Sheave.radius = 1e[+]300: must be"),
    (lambda: sheave(width=1e300), ValueError, "Sheave.width = 1e[+]300: must be"),
    (lambda: path(3), TypeError, "Path: stops = 3: must be a list"),
    (lambda: path([3]), TypeError, r"Path: stops\[0\] = 3: must be a list of a sheave id"),
    (
        lambda: path([(0,)]),
        ValueError,
        r"Path: stops\[0\] = \(0,\): must be \(sheave id, direction\)",
    ),
    (lambda: path([(99, 1)]), IndexError, "sheave id = 99: there is no such body"),
    (
        lambda: path([(ball((0, 0, 0), 0.1, material="cable"), 1)]),
        ValueError,
        "sheave id = 0: is a Sphere, no Sheave",
    ),
    (
        lambda: path([(sheave(), 1, -1)]),
        ValueError,
        "further turns at sheave 0 = -1: must be at least 0",
    ),
    (lambda: path([(sheave(), 2)]), ValueError, "Path: direction at sheave 0 = 2: must be 1 or -1"),
    (lambda: path(start="abc"), TypeError, "Path: start = 'abc': must be a vector"),
    (lambda: path(start=(1e200, 0, -1)), ValueError, "Path: its length is inf"),
    (lambda: path(gap=NAN), ValueError, "Path: gap = nan: must be finite"),
    (lambda: path(gap=-1), ValueError, "Path: gap = -0.99.*inside the axle of sheave 0"),
    (lambda: pulleys.lay(None, 20, **GOOD), TypeError, "lay: path = None: must be a Path"),
    (
        lambda: lay(tension=1e300),
        ValueError,
        "lay: tension = 1e[+]300: it would be laid .* times as long",
    ),
    (lambda: lay(tension=NAN), ValueError, "lay: tension = nan: must be finite"),
    (lambda: lay(tension=lambda s: "a"), TypeError, "lay: tension.0. = 'a': must be a number"),
    (lambda: lay(elements=2), ValueError, "lay: elements = 2: must be at least 3"),
    (lambda: pulleys.axisOf(99), IndexError, "axisOf: sheave id = 99: there is no such body"),
    (lambda: pulleys.wrap(cable(), 99), IndexError, "wrap: sheave id = 99: there is no such body"),
    (lambda: pulleys.wrap(cable(), sheave()), RuntimeError, r"Cable.wrap: append\(\) first"),
    (
        lambda: pulleys.settle(running(), NAN),
        ValueError,
        "settle: time = nan: must be finite and above zero",
    ),
    (
        lambda: pulleys.settle(running(), 1, every=0),
        ValueError,
        "settle: every = 0: must be finite and above zero",
    ),
    (
        lambda: pulleys.BackAndForth(NAN, 1),
        ValueError,
        "BackAndForth: distance = nan: must be finite",
    ),
    (
        lambda: ancf.SheaveEngine().add(sheave(), speed="a"),
        ValueError,
        "SheaveEngine: speed = 'a' of body .*: must be a number, a function of time, or None",
    ),
    (
        lambda: ancf.SheaveEngine().add(sheave(), speed=1.0, torque="a"),
        ValueError,
        "SheaveEngine: torque = 'a' of body .*: must be a number or a function of time",
    ),
    (
        lambda: O.bodies[sheave()].shape.touch(Vector3(NAN, 0, 0), 0.001),
        ValueError,
        "Sheave.touch: .*must be finite",
    ),
]


@pytest.mark.parametrize("act, error, text", TEXTS, ids=[text for _, _, text in TEXTS])
def test_text(scene, act, error, text):
    material("cable")
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of numpy, before the refusal
        with pytest.raises(error, match=text):
            act()
    O.reset()
    material("cable")
    running()
    steps(2)


def test_step_of_an_empty_scene(scene):
    """Nothing limits it."""
    assert ancf.timeStep() == INF


def test_many_elements(scene):
    """300,000 in one cable, along lines and arcs, within a second or two."""
    import time

    material("cable")
    angle = np.linspace(0, 3, 301)
    arc = np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    for points, elements, length in ((LINE, 300_000, 1), (arc, 1000, 3)):
        start = time.process_time()
        made = ancf.Cable(points, elements, diameter=1e-6, material="cable")
        assert time.process_time() - start < 10
        assert made.elementCount == 300_000
        assert made.length == pytest.approx(length, rel=1e-7)
