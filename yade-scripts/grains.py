"""What the scenes of cables and grains share: their options, grains, cost and summary."""

import contextlib
import pathlib
import time
import warnings

import numpy as np

from yade import O, Vector3, timing, utils

PARTS = {
    "CableEngine": "cables and their contacts",
    "InteractionLoop": "grains' contacts, and finding cables'",
    "InsertionSortCollider": "who is near whom",
    "CableNewton": "grains' motion",
    "NewtonIntegrator": "motion",
}


def options(parser):
    """Adds --no-pictures and --out, reads all options, and makes the folder."""
    parser.add_argument("--no-pictures", action="store_true", help="no pictures or plots")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out"), help="folder")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    return args


APART, UP = 2.3, 2.9  # of grains in a pile, aside and upwards, in radii
CLUMPS = 4  # every fourth is one
SPREAD = 0.1  # of the radii, upwards


def pile(count, radius, low, side, material):
    """Layers of side x side loose grains, centred above z = low; every fourth is two balls, one 0.8
    radii above the other.

    Radii are from `radius` to 1.1 times it [m]. Returns the grains' ids.
    """
    rng = np.random.default_rng(1)
    pitch, height = APART * radius, UP * radius
    ids = []
    for k in range(count):
        layer, place = divmod(k, side * side)
        i, j = divmod(place, side)
        p = np.array([pitch * (i - (side - 1) / 2), pitch * (j - (side - 1) / 2), low])
        p += [0, 0, height * (layer + 0.5)] + 0.02 * radius * rng.uniform(-1, 1, 3)
        r = radius * (1 + SPREAD * rng.uniform())
        if k % CLUMPS == 0:
            up = np.array([0, 0, 0.4 * radius])
            balls = [utils.sphere(p + q, radius, material=material) for q in (-up, up)]
            ids.append(O.bodies.appendClumped(balls)[0])
        else:
            ids.append(O.bodies.append(utils.sphere(p, r, material=material)))
    return ids


@contextlib.contextmanager
def damped(part):
    """NewtonIntegrator.damping while a scene comes to rest; what it was afterwards."""
    newton = O.engines[-1]
    before, newton.damping = newton.damping, part
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="NewtonIntegrator.damping")
            yield
    finally:
        newton.damping = before


def places(ids):
    """Centres of bodies (n, 3) [m]."""
    return np.array([list(O.bodies[i].state.pos) for i in ids]).reshape(-1, 3)


def mass(ids):
    """Of bodies together [kg]."""
    return sum(O.bodies[i].state.mass for i in ids)


def force(body):
    """On a body in the last step (3) [N]."""
    return np.array(list(O.forces.f(body)))


def held(structure, knots):
    """Sum of the forces that hold knots (3) [N]."""
    return sum(np.array(list(structure.reaction(k))) for k in knots)


class Crane:
    """Bodies without contacts that lead knots at one velocity; counts the work that they do."""

    def __init__(self, structure, knots):
        self.structure, self.knots, self.hooks = structure, list(knots), []
        self.velocity, self.work = Vector3(0, 0, 0), 0.0
        for knot in self.knots:
            hook = utils.sphere(structure.knots[knot], 3 * structure.radius, fixed=True)
            hook.bounded = False
            self.hooks.append(O.bodies.append(hook))
            structure.follow(knot, self.hooks[-1])

    def force(self):
        """That all hooks together bear (3) [N]."""
        return held(self.structure, self.knots)

    def letGo(self, knots):
        for knot in knots:
            self.structure.release(knot)
            self.hooks.pop(self.knots.index(knot))
            self.knots.remove(knot)

    def move(self, velocity):
        self.velocity = Vector3(*velocity)
        for hook in self.hooks:
            O.bodies[hook].state.vel = self.velocity

    def count(self):
        """After each step: adds the work of that step [J]."""
        if self.velocity.norm() > 0:
            self.work += O.dt * float(self.force() @ np.array(list(self.velocity)))


class Cost:
    """CPU time from now on, and which engines took it."""

    def __init__(self):
        timing.reset()
        O.timingEnabled = True
        self._start, self._steps = time.process_time(), O.iter

    def stop(self):
        """Takes the time, and turns the clocks of the engines off."""
        self.seconds = time.process_time() - self._start
        self.steps, self.dt = O.iter - self._steps, O.dt
        O.timingEnabled = False
        took = [(PARTS[e.__class__.__name__], e.execTime) for e in O.engines if self._known(e)]
        whole = sum(t for _, t in took)
        self.shares = {name: t / whole for name, t in took}
        return self

    @staticmethod
    def _known(engine):
        return engine.__class__.__name__ in PARTS

    @property
    def step(self):
        """CPU time of a step [s]."""
        return self.seconds / self.steps

    def report(self, title="cost"):
        print(f"{title}: {self.seconds:.1f} s CPU, {self.steps} steps of {self.dt:.3g} s, ", end="")
        print(f"{1e3 * self.step:.3f} ms each")
        for name, share in self.shares.items():
            print(f"    {100 * share:4.1f} %  {1e3 * share * self.step:7.3f} ms  {name}")


class Summary:
    """What came out, and whether it is as it should be."""

    def __init__(self):
        self.values, self.failed = {}, []

    def tell(self, name, value, unit="", least=None, most=None):
        """Prints a value, and what it must be if it must."""
        self.values[name] = value
        wanted, good = "", True
        if least is not None or most is not None:
            good = (least is None or value >= least) and (most is None or value <= most)
            wanted = " ".join(
                f"{word} {bound:.4g}"
                for word, bound in (("at least", least), ("at most", most))
                if bound is not None
            )
            wanted = f"  ({wanted}{'' if good else ': FAILED'})"
        if not good:
            self.failed.append(name)
        print(f"{name:48s} {value:10.5g} {unit}{wanted}", flush=True)

    @property
    def code(self):
        """Exit code of the script."""
        return 1 if self.failed else 0
