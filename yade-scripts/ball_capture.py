"""A net, shot at a fixed ball by four bullets, wraps it: Table 2 of Shan, Guo and Gill 2019.

Run it by `/usr/bin/python3 ball_capture.py` or `yade -n -x ball_capture.py`; --help tells the options.
Results go to out/. Source: Shan, Guo, Gill, Advances in Space Research (2019), doi
10.1016/j.asr.2019.10.041.
"""

import argparse
import pathlib
import sys
import time

import numpy as np

import ancf
from yade import O, utils

# ---- parameters, SI units ----------------------------------------------------------------------
MESHES = 6  # a side
MESH_LENGTH = 0.08  # [m]
ELEMENTS = 1  # ANCF elements an edge
CONTACT_POINTS = 3  # inside each element
YOUNG = 4.456e8  # of the cables [Pa]
POISSON = 0.3
BULLET_MASS = 0.05  # [kg]
BULLET_SPEED = 1.5  # [m/s]
BULLET_ANGLE = 25.0  # between velocity and x [deg]
TARGET_DISTANCE = 1.0  # from the net to the centre of the ball, along x [m]
BALL_RADIUS = 0.08  # [m]
DURATION = 1.5  # [s]

# Not given by the study: chosen here, and printed as assumed.
ASSUMED = dict(
    diameter=1e-3,  # of the cables [m]
    density=1440.0,  # of the cables [kg/m3]
    # Size of the folded net as part of the open one. Of folds from 0.05 to 0.9, the one that still
    # holds the ball at 1.5 s: the net opens early, closes before the ball and wraps it from the
    # front. Nets folded smaller open at 0.5 s, wrap at 0.9 to 1.3 s, and their elastic recoil takes
    # the bullets back before the end.
    fold=0.65,
    bulletRadius=0.01,  # [m]
    ballYoung=70e9,  # [Pa]
    ballPoisson=0.33,
    alpha=0.2,  # damping of the normal force [s/m]
    staticFriction=0.3,
    kineticFriction=0.2,
    transitionVelocity=1e-3,  # [m/s]
    damping=5e-5,  # Kelvin-Voigt time of the cables [s]
    gravity=0.0,  # [m/s2]
)
MASS = "lumped"
SELF_CONTACT = True  # cables of the net do not pass through each other

SAMPLE = 5e-3  # time between two samples [s]
STRIP_TIMES = (0.25, 0.7, 1.1, 1.4)  # of the pictures [s]
NUDGE = 1e-3  # relative, of speed, angle and place of the ball in perturbed runs


def material(label, young=YOUNG, poisson=POISSON, density=ASSUMED["density"], **others):
    """That of the cables, but for what is given."""
    contact = dict(
        impactDamping=ASSUMED["alpha"],
        staticFriction=ASSUMED["staticFriction"],
        kineticFriction=ASSUMED["kineticFriction"],
        transitionVelocity=ASSUMED["transitionVelocity"],
    )
    contact.update(others)
    return ancf.HollarsMat(label=label, young=young, poisson=poisson, density=density, **contact)


def appendMaterials(target="ball"):
    """Those of the cables and of the target."""
    O.materials.append(material("cable"))
    O.materials.append(material(target, ASSUMED["ballYoung"], ASSUMED["ballPoisson"], 2700))


def build(nudge):
    """The scene; nudge (4) changes speed, angle and the ball's y and z a little.

    Returns the net and the ball's id.
    """
    a = ASSUMED
    O.reset()
    appendMaterials()
    center = (TARGET_DISTANCE, nudge[2] * BALL_RADIUS, nudge[3] * BALL_RADIUS)
    ball = O.bodies.append(utils.sphere(center, BALL_RADIUS, material="ball", fixed=True))
    net = ancf.Net.square(
        MESHES,
        MESH_LENGTH,
        ELEMENTS,
        diameter=a["diameter"],
        material="cable",
        contactPoints=CONTACT_POINTS,
        damping=a["damping"],
        mass=MASS,
        normal=(1, 0, 0),
        fold=a["fold"],
        selfContact=SELF_CONTACT,
    )
    net.addBullets(
        BULLET_MASS,
        a["bulletRadius"],
        BULLET_SPEED * (1 + nudge[0]),
        np.radians(BULLET_ANGLE) * (1 + nudge[1]),
    )
    O.engines = ancf.engines(net, gravity=(0, 0, -a["gravity"]))
    ancf.check()
    return net, ball


class Capture:
    """One run and what is measured in it."""

    def __init__(self, nudge, pictures, duration, title):
        from ancf.plots import Film, History

        self.net, self.ball = build(nudge)
        self.history = History(self.net)
        self.film = Film([self.net], [self.ball]) if pictures else None
        self.contacts, self.energy = [], []
        self.duration, self.title = duration, title
        O.trackEnergy = True

    def sample(self):
        self.history.sample()
        self.contacts.append(self.net.engine.contacts)
        self.energy.append(O.energy.total())
        if self.film and len(self.contacts) % 2:
            self.film.take()

    def run(self):
        self.wall = 0.0
        self.sample()
        start = time.perf_counter()
        for _ in ancf.progress(self.duration, SAMPLE, self.title):
            self.wall += time.perf_counter() - start
            self.sample()
            start = time.perf_counter()
        return self

    # ---- what came out

    @property
    def deployed(self):
        """Time of the largest mouth area before the first contact [s]."""
        touching = np.flatnonzero(self.contacts)
        free = self.history.area[: touching[0]] if len(touching) else self.history.area
        return self.history.time[int(np.argmax(free))]

    @property
    def firstContact(self):
        """Time of the first contact, within a sample [s]; None: there was none."""
        touching = np.flatnonzero(self.contacts)
        return self.history.time[touching[0]] if len(touching) else None

    @property
    def mouth(self):
        """Mouth area at the end as part of the largest."""
        return self.history.area[-1] / max(self.history.area)

    @property
    def penetration(self):
        """Deepest penetration of a contact point [m]."""
        return self.net.engine.maxPenetration

    @property
    def behind(self):
        """Bullets beyond the ball's centre at the end."""
        center = O.bodies[self.ball].state.pos[0]
        return sum(p[0] > center for p in self.history.position[-1])

    @property
    def wrapped(self):
        """All bullets beyond the centre, mouth below 25 %, penetration below one diameter."""
        deep = self.penetration >= ASSUMED["diameter"]
        return self.behind == 4 and self.mouth < 0.25 and not deep

    def report(self):
        total = np.array(self.energy[1:])  # tracked from the first step on
        balance = np.abs(total / total[0] - 1).max()
        first = "none" if self.firstContact is None else f"{self.firstContact:.3f} s"
        step = 1e6 * self.wall / O.iter
        print(f"full deployment      {self.deployed:.3f} s, {max(self.history.area):.4f} m2")
        print(f"first contact        {first}")
        print(f"contacts             {max(self.contacts)} at most, {self.contacts[-1]} at the end")
        print(
            f"deepest penetration  {self.penetration:.3g} m of {ASSUMED['diameter']:g} m diameter"
        )
        print(f"energy balance       within {balance:.1e} of the energy at the start")
        print(
            f"bullets behind ball  {self.behind} of 4, mouth {100 * self.mouth:.0f} % of the largest"
        )
        print(f"step                 {O.dt:.3g} s, {O.iter} steps, {step:.1f} us each")
        print(f"wall time            {self.wall:.2f} s for {O.time:.2f} s simulated")
        print(f"wrapped              {'yes' if self.wrapped else 'NO'}", flush=True)

    def pictures(self, folder):
        events = {"open": self.deployed}
        if self.firstContact is not None:
            events["contact"] = self.firstContact
        self.history.plot(folder / "bullets.png", events)
        times = [t for t in STRIP_TIMES if t <= self.duration] or [self.duration]
        self.film.strip(folder / "strip.png", times)
        return self.film.animate(folder / "capture.mp4", slower=1 / (25 * 2 * SAMPLE))


def head():
    print("A net catches a ball (Shan, Guo, Gill 2019, Table 2)")
    print(
        f"  net {MESHES} x {MESHES} meshes of {MESH_LENGTH} m, {ELEMENTS} element(s) an edge,",
        end=" ",
    )
    print(f"{CONTACT_POINTS} contact points in each; E = {YOUNG:g} Pa, nu = {POISSON}")
    print(f"  bullets 4 x {BULLET_MASS} kg at {BULLET_SPEED} m/s, {BULLET_ANGLE} deg;", end=" ")
    print(f"ball of radius {BALL_RADIUS} m at {TARGET_DISTANCE} m")
    print(f"  assumed, not given by the study: mass = {MASS}, self-contact = {SELF_CONTACT}")
    for name, value in ASSUMED.items():
        print(f"    {name} = {value:g}")
    print(flush=True)


def options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--runs", type=int, default=0, help="perturbed runs to check 'wrapped' with"
    )
    parser.add_argument("--time", type=float, default=DURATION, help="to simulate [s]")
    parser.add_argument("--no-pictures", action="store_true", help="no plots, strip or animation")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out"), help="folder")
    return parser.parse_args()


def checkRuns(runs, duration):
    """Perturbed runs; True if at most one in eight is not wrapped."""
    wrapped = 0
    for k in range(runs):
        nudge = NUDGE * np.random.default_rng(k + 1).normal(size=4)
        capture = Capture(nudge, False, duration, f"run {k + 1} of {runs}").run()
        wrapped += capture.wrapped
        print(
            f"run {k + 1}: {'wrapped' if capture.wrapped else 'NOT wrapped'}, "
            f"bullets behind {capture.behind}, mouth {100 * capture.mouth:.0f} %, "
            f"penetration {capture.penetration:.2g} m, open at {capture.deployed:.2f} s, "
            f"{capture.wall:.2f} s wall",
            flush=True,
        )
    print(f"{wrapped} of {runs} runs wrapped")
    return wrapped >= runs - runs // 8


def main():
    args = options()
    head()
    if args.runs:
        return 0 if checkRuns(args.runs, args.time) else 1
    args.out.mkdir(parents=True, exist_ok=True)
    capture = Capture(np.zeros(4), not args.no_pictures, args.time, "capture").run()
    capture.report()
    capture.history.save(args.out / "bullets.csv")
    if not args.no_pictures:
        film = capture.pictures(args.out)
        print(f"pictures             {args.out}/bullets.png, {args.out}/strip.png, {film}")
    return 0 if capture.wrapped or args.time < DURATION else 1


if __name__ == "__main__":
    sys.exit(main())
