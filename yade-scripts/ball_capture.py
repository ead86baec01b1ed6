"""A stowed net, shot by four bullets, opens, meets a fixed ball and embraces it: Table 2 of Shan, Guo and
Gill 2019.

Nothing draws its mouth shut, so its own recoil opens it again; with --close a line through the rings of its rim does,
and it holds the ball. Run it by `/usr/bin/python3 ball_capture.py` or `yade -n -x ball_capture.py`;
--help tells the options. Results go to out/.
Source: Shan, Guo, Gill, Advances in Space Research (2019), doi 10.1016/j.asr.2019.10.041.
"""

import argparse
import csv
import pathlib
import sys
import time

import numpy as np

import ancf
from ancf.capture import HOLD, Capture
from yade import O, utils

# ---- parameters, SI units ----------------------------------------------------------------------
MESHES = 6  # a side
MESH_LENGTH = 0.08  # [m]
AROUND = 4 * MESHES * MESH_LENGTH  # length of the open rim [m]
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
CLOSED_FOR = 10.0  # with --close [s]

# Not given by the study: chosen here, and printed as assumed.
ASSUMED = dict(
    diameter=1e-3,  # of the cables [m]
    density=1440.0,  # of the cables [kg/m3]
    fold=0.1,  # size of the stowed net as part of the open one
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
LINE = dict(  # with --close; by a winch in one of the bullets
    slack=0.02,  # of the line, beside the open rim [-]
    speed=4.0,  # of the winch [m/s]
    force=10.0,  # at most [N]
    left=0.15,  # of the rim's length, at which it stops [-]
    step=0.5,  # part of O.dt while it is drawn: with all of it, energy is off by 2.6 %
)
HELD = 0.9  # share of the ball that a net must enclose to hold it
MASS = "lumped"
SELF_CONTACT = True  # cables of the net do not pass through each other

SAMPLE = 5e-3  # time between two samples [s]
STRIP_TIMES = (0.25, 0.5, 0.7, 1.1, 1.4)  # of the pictures: the study's, and the open net [s]
FILM_EVERY = 2  # samples between two pictures of the film
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


def build(nudge, close=False, **assumed):
    """The scene; nudge (4) changes speed, angle and the ball's y and z a little, `assumed` what is in ASSUMED.

    Returns the net and the ball's id. close: with a closing line, ancf.lines()[0].
    """
    a = {**ASSUMED, **assumed}
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
    parts = [net, closingLine(net, a["diameter"])] if close else [net]
    O.engines = ancf.engines(*parts, gravity=(0, 0, -a["gravity"]))
    ancf.check()
    return net, ball


def closingLine(net, diameter):
    """From the first bullet through the rings of the rim and back to it."""
    return ancf.Line(
        [(net, knot) for knot in [*net.rim[::2], net.rim[0]]],
        diameter=diameter,
        material="cable",
        length=(1 + LINE["slack"]) * AROUND,
        label="closing line",
    )


class Run:
    """One run and what is measured in it."""

    def __init__(self, nudge, pictures, duration, title, close=False, **assumed):
        from ancf.plots import Film, History

        self.net, self.ball = build(nudge, close, **assumed)
        self.line = ancf.lines()[0] if close else None
        self.history = History(self.net)
        left = {"line_left_m": lambda: self.line.length} if close else {}
        self.capture = Capture(self.net, self.ball, also=left)
        shown = [self.net, self.line] if close else [self.net]
        self.film = Film(shown, [self.ball]) if pictures else None
        self.closing = self.drawn = None  # when the line began to be drawn, and was
        self.energy = []
        self.duration, self.title = duration, title
        O.trackEnergy = True

    def sample(self):
        self.history.sample()
        self.capture.sample()
        self.energy.append(O.energy.total())
        if self.line and self.closing is None and self.capture.beyond[-1] == 1:
            self.closing = O.time
            self.line.haul(LINE["speed"], LINE["force"], to=LINE["left"] * AROUND)
            O.dt *= LINE["step"]
        if self.closing is not None and self.drawn is None and self.line.winch() == "stopped":
            self.drawn = O.time
            O.dt /= LINE["step"]
        if self.film and len(self.energy) % FILM_EVERY:
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
    def penetration(self):
        """Deepest penetration of a contact point [m]."""
        return self.net.engine.maxPenetration

    @property
    def embraced(self):
        """Four bullets beyond the ball's centre and a mouth below a quarter, for HOLD, and nothing deeper than a
        cable is thick.
        """
        return self.capture.embraced is not None and self.penetration < ASSUMED["diameter"]

    @property
    def held(self):
        """Whether the net, drawn shut, still encloses the ball."""
        return self.closing is not None and self.capture.row()["enclosed_end"] >= HELD

    @property
    def good(self):
        """Whether it did what it is to do."""
        return self.held if self.line else self.embraced

    def stages(self):
        """(what, when) of the stages that it came to."""
        c, row = self.capture, self.capture.row()
        flat = (MESHES * MESH_LENGTH) ** 2
        yield "open", f"{c.open:.3f} s, {100 * row['mouth_open_m2'] / flat:.0f} % of the flat net"
        if c.contact is not None:
            yield "first contact", f"{c.contact:.3f} s"
        if c.embraced is not None:
            since, until = c.embraced
            yield "embraced", f"{since:.3f} to {until:.3f} s"
            tight = 100 * row["mouth_tightest"]
            yield "tightest", f"{c.tightest:.3f} s, mouth {tight:.0f} % of its largest"
        if c.recoil is not None:
            yield "recoil", f"{c.recoil:.3f} s"

    def report(self):
        for what, when in self.stages():
            print(f"{what:21}{when}")
        row = self.capture.row()
        total = np.array(self.energy[1:])  # tracked from the first step on
        work = self.line.energy()["winches"] if self.line else 0.0
        balance = np.abs(total - total[0]).max() / (total[0] + work)
        step = 1e6 * self.wall / O.iter
        print(
            f"at the end           {4 * row['beyond_end']:.0f} of 4 bullets beyond the ball's centre, "
            f"mouth {100 * row['mouth_end']:.0f} %"
        )
        print(
            f"enclosed             {100 * row['enclosed_most']:.0f} % of the ball at most", end=""
        )
        print(f", {100 * row['enclosed_end']:.0f} % at the end")
        print(f"quality index        {row['quality_best']:.2f} at best (0: as large as the ball)")
        print(f"largest tension      {row['tension_most_N']:.1f} N")
        if self.line:
            drawn = f"{self.line.tensions.max():.1f} N, {self.line.length:.2f} m left"
            times = f"from {self.closing or 0:.3f} to {self.drawn or self.duration:.3f} s"
            print(f"closing line         drawn {times}; {drawn}, {self.line.winch()}")
        print(f"given to the ball    {row['momentum_end_Ns']:.3f} N s")
        print(
            f"deepest penetration  {self.penetration:.3g} m of {ASSUMED['diameter']:g} m diameter"
        )
        given = "of the energy at the start" + (" and the winch's work" if self.line else "")
        print(f"energy balance       within {balance:.1e} {given}")
        print(f"step                 {O.dt:.3g} s, {O.iter} steps, {step:.1f} us each")
        print(f"wall time            {self.wall:.2f} s for {O.time:.2f} s simulated")
        print(f"=> {self.verdict}", flush=True)

    @property
    def verdict(self):
        """What came out, in a sentence."""
        if self.line:
            enclosed = 100 * self.capture.row()["enclosed_end"]
            return f"{'held' if self.held else 'NOT held'} at {O.time:.1f} s, {enclosed:.0f} % enclosed"
        if not self.embraced:
            return f"NOT embraced for {HOLD} s"
        since, until = self.capture.embraced
        told = f"embraced for {until - since:.2f} s"
        if self.capture.recoil is None:
            return f"{told}, and still at the end"
        return f"{told}, then opened by its own recoil: nothing draws its mouth shut"

    def pictures(self, folder):
        c = self.capture
        since = c.embraced and c.embraced[0]
        events = {"open": c.open, "contact": c.contact, "embraced": since, "recoil": c.recoil}
        events = {name: t for name, t in events.items() if t is not None}
        self.history.plot(folder / "bullets.png", events)
        times = [t for t in STRIP_TIMES if t <= self.duration] or [self.duration]
        self.film.strip(folder / "strip.png", times, cell=(420, 420))
        return self.film.animate(folder / "capture.mp4", slower=1 / (25 * FILM_EVERY * SAMPLE))


def head():
    print("A net is shot at a ball (Shan, Guo, Gill 2019, Table 2)")
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
    parser = argparse.ArgumentParser(description=" ".join(__doc__.split("\n\n")[0].split()))
    parser.add_argument(
        "--runs", type=int, default=0, help="perturbed runs, all to embrace the ball"
    )
    parser.add_argument("--close", action="store_true", help="draw the mouth shut by a line")
    parser.add_argument("--time", type=float, help=f"to simulate [s], {DURATION}, or {CLOSED_FOR}")
    parser.add_argument(
        "--damping",
        type=float,
        default=ASSUMED["damping"],
        help="Kelvin-Voigt time of the cables [s], %(default)g",
    )
    parser.add_argument("--no-pictures", action="store_true", help="no plots, strip or animation")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out"), help="folder")
    return parser.parse_args()


def nudges(number):
    """What build() takes in perturbed run 1, 2, ..."""
    return NUDGE * np.random.default_rng(number).normal(size=4)


def checkRuns(runs, duration, folder, close):
    """Perturbed runs, a row each in captures.csv; True if all embraced the ball, or hold it."""
    rows, good = [], 0
    for k in range(1, runs + 1):
        run = Run(nudges(k), False, duration, f"run {k} of {runs}", close).run()
        good += run.good
        rows.append({"run": k, **run.capture.row()})
        stages = ", ".join(" ".join(stage) for stage in run.stages())
        print(f"run {k}: {run.verdict}\n  {stages}; {run.wall:.2f} s wall", flush=True)
    with open(folder / "captures.csv", "w", newline="", encoding="utf-8") as file:
        out = csv.DictWriter(file, rows[0])
        out.writeheader()
        out.writerows(rows)
    print(f"{good} of {runs} runs {'held' if close else 'embraced'}")
    return good == runs


def main():
    args = options()
    ASSUMED["damping"] = args.damping
    head()
    args.out.mkdir(parents=True, exist_ok=True)
    duration = args.time or (CLOSED_FOR if args.close else DURATION)
    if args.runs:
        return 0 if checkRuns(args.runs, duration, args.out, args.close) else 1
    run = Run(np.zeros(4), not args.no_pictures, duration, "capture", args.close).run()
    run.report()
    run.history.save(args.out / "bullets.csv")
    if not args.no_pictures:
        film = run.pictures(args.out)
        print(f"pictures             {args.out}/bullets.png, {args.out}/strip.png, {film}")
    return 0 if run.good or duration < DURATION else 1


if __name__ == "__main__":
    sys.exit(main())
