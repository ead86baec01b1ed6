"""Speed of contact: a capture, a net in flight, grains in nets, spheres on a cable.

Run it by `PYTHONPATH=build/python /usr/bin/python3 tests/bench/contact.py`, on a core with nothing else to
do; PYTHONPATH says which build is measured, public functions alone are used, so that builds of
other commits run it, too. --peers PYTHON takes a Python that has MuJoCo (pip install mujoco) and
runs its coarse net in turns with the capture. Every case is a process of its own with one thread.
"us" are microseconds of CPU time a step. Capture, flight and line take turns with what they are
compared with: trust their ratios, and other figures only on a machine with nothing else to do.
"""

import argparse
import csv
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np  # noqa: E402

import ancf  # noqa: E402
from machine import here, timed  # noqa: E402
from yade import O, Vector3, timing, utils, wrapper  # noqa: E402

# ---- parameters, SI units ----------------------------------------------------------------------
# Net and capture: those of yade-scripts/ball_capture.py.
MESHES = 6  # a side
MESH_LENGTH = 0.08  # [m]
DIAMETER = 1e-3  # of the cables [m]
CABLE = dict(young=4.456e8, poisson=0.3, density=1440)  # [Pa], -, [kg/m3]
BALL = dict(young=70e9, poisson=0.33, density=2700)
LAW = dict(
    impactDamping=0.2,  # [s/m]
    staticFriction=0.3,
    kineticFriction=0.2,
    transitionVelocity=1e-3,  # [m/s]
)
DAMPING = 5e-5  # Kelvin-Voigt time of the cables [s]
FOLD = 0.65
BULLET_MASS, BULLET_RADIUS = 0.05, 0.01  # [kg], [m]
BULLET_SPEED, BULLET_ANGLE = 1.5, 25.0  # [m/s], [deg]
BALL_DISTANCE, BALL_RADIUS = 1.0, 0.08  # [m]
DURATION = 1.5  # of the capture [s]

FLIGHT = 0.4  # the net opens, and is not yet where a ball would be [s]
FAR = 1000.0  # where the ball is in flight [m]
FLOOR_STEPS = 50000  # of the free sphere, each time
FLOOR_VERLET = 0.01  # sweep length of its collider [m]

GRAVITY = 9.81  # [m/s2]
GRAIN = dict(young=1e7, poisson=0.3, density=100, frictionAngle=0.4)  # light, so that nets hold
GRAIN_NET = dict(meshes=20, diameter=1e-3)
GRAINS, GRAIN_RADII = 300, (1.2, 2.0)  # -, in half meshes
HANGING_NET = dict(meshes=12, diameter=2e-3)
HANGING, HANGING_RADII = 2000, (1.2, 1.4)  # a heap of some 20 layers
SETTLE, SETTLE_DAMPING = 2.0, 0.3  # time with NewtonIntegrator.damping [s], -
CALM = 0.02  # time without, before the clock starts [s]
STILL = 0.02  # median speed of grains at rest; single ones still find their places [m/s]
DEEPEST = 0.5  # the heap never hangs so deep [m]
GRAIN_STEPS = 500  # in one go

SPHERES, FEW_SPHERES = (200, 800), (48, 192)  # on the cable; in the short form
SPHERE_RADIUS, SPHERE_DENSITY = 5e-3, 1000.0  # [m], [kg/m3]
LINE_DIAMETER = 4e-3  # [m]
LINE_SPACING = 0.016  # between spheres [m]
LINE_SPAN, LINE_ELEMENTS = 8, 4  # spheres, elements between two posts
LINE_SETTLE, LINE_CALM = 0.1, 0.01  # times with and without damping, as above [s]
LINE_STEPS = 200  # in one go

REPEATS = dict(capture=3, capture3=3, flight=15, grains=9, hanging=9, line=9)
LIMIT = 3600  # a case may take [s]
MARK = "result: "

# MuJoCo's coarse net of springs on the same task: one 1-D flex, no bending, corners of 50 g, a fixed
# ball, no contact among its own springs. Arguments: duration [s].
PEER = """
import json, math, sys, time
import mujoco, numpy as np

dt, n, l, EA, rhoA = 1e-4, 7, 0.08, 350.0, 1.131e-3
points = [(0, (i - 3) * l, (j - 3) * l) for i in range(n) for j in range(n)]
links = []
for i in range(n):
    for j in range(n):
        links += [(i * n + j, i * n + j + 1)] * (j + 1 < n) + [(i * n + j, (i + 1) * n + j)] * (i + 1 < n)
text = " ".join
model = mujoco.MjModel.from_xml_string(f'''<mujoco>
<option timestep="{dt}" integrator="implicitfast" gravity="0 0 0" cone="elliptic"/>
<worldbody>
<geom type="sphere" size=".08" pos="1 0 0" friction=".3"/>
<flexcomp name="net" type="direct" dim="1" point="{text('%g %g %g' % p for p in points)}"
    element="{text('%d %d' % e for e in links)}" radius=".0005" mass="{84 * l * rhoA}">
<contact selfcollide="none" friction=".3"/>
<edge stiffness="{EA / l}" damping="0.05"/>
</flexcomp>
</worldbody></mujoco>''')
ends = (0, 6, 42, 48)
corners = [model.flex_vertbodyid[i] for i in ends]
model.body_mass[corners] += 0.05
mujoco.mj_setConst(model, mujoco.MjData(model))
data = mujoco.MjData(model)
for i, p in enumerate(points):  # folded to 0.3 of its size
    q = model.jnt_qposadr[model.body_jntadr[model.flex_vertbodyid[i]]]
    data.qpos[q + 1 : q + 3] = -0.7 * np.array(p[1:])
angle = math.radians(25)
for body, i in zip(corners, ends):
    outward = np.array(points[i]) / np.linalg.norm(points[i])
    a = model.body_dofadr[body]
    data.qvel[a : a + 3] = 1.5 * (math.cos(angle) * np.array([1, 0, 0]) + math.sin(angle) * outward)
steps = int(float(sys.argv[1]) / dt)
wall, cpu = time.perf_counter(), time.process_time()
mujoco.mj_step(model, data, steps)
wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
rows = [["CPU time", cpu, "s"], ["wall time", wall, "s"], ["simulated / wall", data.time / wall, "-"]]
rows += [["dt", dt, "s"], ["CPU a step", 1e6 * cpu / steps, "us"]]
rows += [["bullets beyond the centre", int((data.xpos[corners, 0] > 1).sum()), "-"]]
rows += [["MuJoCo", mujoco.__version__, ""]]
print("result: " + json.dumps(rows))
"""


def cpuOf(steps):
    """CPU time of O.run(steps) [s]."""
    start = time.process_time()
    O.run(steps, True)
    return time.process_time() - start


def hollars(label, values):
    O.materials.append(ancf.HollarsMat(label=label, **values, **LAW))


# ---- capture and flight ------------------------------------------------------------------------


def shotNet(distance, selfContact=True):
    """The scene of the capture with its ball at a distance [m]; returns the net."""
    O.reset()
    O.trackEnergy = False
    hollars("cable", CABLE)
    hollars("ball", BALL)
    O.bodies.append(utils.sphere((distance, 0, 0), BALL_RADIUS, material="ball", fixed=True))
    net = ancf.Net.square(
        MESHES,
        MESH_LENGTH,
        diameter=DIAMETER,
        material="cable",
        damping=DAMPING,
        mass="lumped",
        fold=FOLD,
        selfContact=selfContact,
    )
    net.addBullets(BULLET_MASS, BULLET_RADIUS, BULLET_SPEED, np.radians(BULLET_ANGLE))
    O.engines = ancf.engines(net)
    return net


def capture(quick, inside=1):
    """Whole capture of the study's ball, cables of the net touch each other, in one go; with so many
    steps of the cables in O.dt.
    """
    net = shotNet(BALL_DISTANCE)
    net.engine.substeps = inside
    O.dt = ancf.timeStep()
    steps = int(np.ceil(DURATION / O.dt))
    cpu, wall = timed(steps)
    yield "CPU time", cpu, "s"
    yield "wall time", wall, "s"
    yield "simulated / wall", O.time / wall, "-"
    yield "dt", O.dt, "s"
    yield "steps", steps, "-"
    yield "CPU a step", 1e6 * cpu / steps, "us"
    behind = sum(O.bodies[i].state.pos[0] > BALL_DISTANCE for i in net.bullets)
    yield "bullets beyond the centre", behind, "-"
    yield "mouth", net.mouthArea() / (MESHES * MESH_LENGTH) ** 2, "of the flat net"
    yield "deepest penetration", 1e3 * net.engine.maxPenetration, "mm"


def phases(quick):
    """What each engine takes of the capture: on the way, and from there on."""
    shotNet(BALL_DISTANCE)
    O.dt = ancf.timeStep()
    O.timingEnabled = True
    for phase, until in (("on the way", FLIGHT), ("at the ball", DURATION)):
        times = shared(int(np.ceil((until - O.time) / O.dt)))
        yield f"all engines, {phase}", sum(times.values()), "us"
        for name, value in times.items():
            yield f"{name}, {phase}", value, "us"
    O.timingEnabled = False


def freeSphere():
    """YADE's own floor: one free sphere, four engines."""
    O.reset()
    O.trackEnergy = False
    O.bodies.append(utils.sphere((0, 0, 0), BULLET_RADIUS))
    O.bodies[0].state.vel = Vector3(BULLET_SPEED, 0, 0)
    O.engines = [
        wrapper.ForceResetter(),
        wrapper.InsertionSortCollider([wrapper.Bo1_Sphere_Aabb()], verletDist=FLOOR_VERLET),
        wrapper.InteractionLoop(
            [wrapper.Ig2_Sphere_Sphere_ScGeom()],
            [wrapper.Ip2_FrictMat_FrictMat_FrictPhys()],
            [wrapper.Law2_ScGeom_FrictPhys_CundallStrack()],
        ),
        wrapper.NewtonIntegrator(damping=0),
    ]
    O.dt = 1e-5


def flight(quick):
    """The capture's net on its way, nothing within reach; in turns with YADE's floor."""
    cost = {"floor": [], "self-contact on": [], "self-contact off": []}
    for _ in range(3 if quick else REPEATS["flight"]):
        freeSphere()
        O.run(100, True)
        cost["floor"].append(1e6 * cpuOf(FLOOR_STEPS) / FLOOR_STEPS)
        for name in list(cost)[1:]:
            net = shotNet(FAR, name == "self-contact on")
            O.run(100, True)
            steps = round(FLIGHT / O.dt)
            cost[name].append(1e6 * cpuOf(steps) / steps)
            if net.engine.contacts:
                raise RuntimeError(f"flight: {net.engine.contacts} contacts at its end")
    yield "dt", O.dt, "s"
    for name, values in cost.items():
        yield f"CPU a step, {name}", statistics.median(values), "us"
    for name in list(cost)[1:]:
        ratios = [a / b for a, b in zip(cost[name], cost["floor"])]
        yield f"ratio to the floor, {name}", statistics.median(ratios), "-"


# ---- grains ------------------------------------------------------------------------------------


def heap(count, radii, side):
    """Grains within a square of a side [m] above z = 0, in layers of a cubic close packing whose
    places fit the largest of them. Radii [m].
    """
    rng, a = np.random.default_rng(1), 1.005 * radii[1]
    n, places, layer = int(side / (2 * a)), [], 0
    while len(places) < count:
        m = n - layer % 2  # every second layer in the gaps of the one below
        row = 2 * a * (np.arange(m) - 0.5 * (m - 1))
        z = radii[1] + 0.02 * a + layer * np.sqrt(2) * a
        places += [(x, y, z) for x in row for y in row]
        layer += 1
    return places[:count], rng.uniform(*radii, count)


def grainScene(count, radii, meshes, diameter):
    """Grains on a net with its rim fixed, between smooth walls that only they touch; returns the
    net and the ids of the grains.
    """
    O.reset()
    O.trackEnergy = False
    hollars("cable", CABLE)
    O.materials.append(wrapper.FrictMat(label="grain", **GRAIN))
    O.materials.append(wrapper.FrictMat(label="wall", **{**GRAIN, "frictionAngle": 0}))
    side = meshes * MESH_LENGTH
    places, radii = heap(count, [r * MESH_LENGTH / 2 for r in radii], side)
    grains = []
    for place, radius in zip(places, radii):
        grains.append(O.bodies.append(utils.sphere(place, radius, material="grain", mask=3)))
    for axis in (0, 1):
        for sign in (-1, 1):
            at = [0, 0, 0]
            at[axis] = sign * side / 2
            wall = utils.wall(Vector3(*at), axis, sense=-sign, material="wall", mask=2)
            O.bodies.append(wall)
    net = ancf.Net.square(
        meshes,
        MESH_LENGTH,
        diameter=diameter,
        material="cable",
        damping=DAMPING,
        mass="lumped",
        normal=(0, 0, 1),
        mask=1,
    )
    for knot in net.rim:
        net.fix(knot)
    O.engines = ancf.engines(net, gravity=(0, 0, -GRAVITY))
    return net, grains


def settle(ids, duration, calm):
    """Brings bodies to rest; returns their speeds (n) [m/s]."""
    newton = next(e for e in O.engines if isinstance(e, wrapper.NewtonIntegrator))
    newton.damping = SETTLE_DAMPING
    O.run(round(duration / O.dt), True)
    newton.damping = 0
    O.run(round(calm / O.dt), True)
    return np.array([O.bodies[i].state.vel.norm() for i in ids])


def shared(steps):
    """CPU time of a step in so many, shared among the engines as O.timingEnabled has it [us]."""
    timing.reset()
    cpu = cpuOf(steps)
    wall = np.array([e.execTime for e in O.engines])
    return dict(zip([type(e).__name__ for e in O.engines], 1e6 * cpu / steps * wall / wall.sum()))


def engineTimes(repeats):
    """Medians of shared()."""
    O.timingEnabled = True
    runs = [shared(GRAIN_STEPS) for _ in range(repeats)]
    O.timingEnabled = False
    return {name: np.median([run[name] for run in runs]) for name in runs[0]}


def alone(ids):
    """The same grains and walls at the same places without a net, held there by a step of 1e-12 s."""
    places = [(tuple(O.bodies[i].state.pos), O.bodies[i].shape.radius) for i in ids]
    walls = [
        (b.state.pos, b.shape.axis, b.shape.sense)
        for b in O.bodies
        if isinstance(b.shape, wrapper.Wall)
    ]
    O.reset()
    O.materials.append(wrapper.FrictMat(label="grain", **GRAIN))
    for place, radius in places:
        O.bodies.append(utils.sphere(place, radius, material="grain"))
    for position, axis, sense in walls:
        O.bodies.append(utils.wall(position, axis, sense=sense, material="grain"))
    O.engines = [
        wrapper.ForceResetter(),
        wrapper.InsertionSortCollider(
            [wrapper.Bo1_Sphere_Aabb(), wrapper.Bo1_Wall_Aabb()], verletDist=FLOOR_VERLET
        ),
        wrapper.InteractionLoop(
            [wrapper.Ig2_Sphere_Sphere_ScGeom(), wrapper.Ig2_Wall_Sphere_ScGeom()],
            [wrapper.Ip2_FrictMat_FrictMat_FrictPhys()],
            [wrapper.Law2_ScGeom_FrictPhys_CundallStrack()],
        ),
        wrapper.NewtonIntegrator(damping=0, gravity=Vector3(0, 0, -GRAVITY)),
    ]
    O.dt = 1e-12
    O.run(GRAIN_STEPS, True)


def inNet(count, radii, net, repeats):
    """Grains at rest in a net: steps in a second, each engine's time, and what of it is YADE's for
    the grains alone.
    """
    net, ids = grainScene(count, radii, **net)
    speeds = settle(ids, SETTLE, CALM)
    lowest = min(O.bodies[i].state.pos[2] for i in ids)
    yield "dt", O.dt, "s"
    yield "elements", len(net.edges), "-"
    yield "contacts of the net", net.engine.contacts, "-"
    yield "speed of grains, median", np.median(speeds), "m/s"
    yield "speed of grains, fastest", max(speeds), "m/s"
    yield "lowest grain", lowest, "m"
    if lowest < -DEEPEST:
        raise RuntimeError(f"a grain fell through the net: it is at z = {lowest:g} m")
    if np.median(speeds) > STILL:
        raise RuntimeError(f"grains are not at rest: {np.median(speeds):g} m/s in the median")
    step = statistics.median(cpuOf(GRAIN_STEPS) for _ in range(repeats)) / GRAIN_STEPS
    yield "CPU a step", 1e6 * step, "us"
    yield "steps / CPU second", 1 / step, "1/s"
    yield "simulated / CPU second", O.dt / step, "-"
    whole, engines = yield from engineRows("", repeats)
    alone(ids)
    wholeAlone, enginesAlone = yield from engineRows(", grains alone", repeats)
    newton = next(name for name in engines if "Newton" in name)
    cables = engines["CableEngine"]
    yield "share of CableEngine", 100 * cables / whole, "%"
    cables += max(0, engines[newton] - enginesAlone["NewtonIntegrator"])
    yield "share of CableEngine, and Newton beyond grains alone", 100 * cables / whole, "%"
    yield "share of the step that is beyond grains alone", 100 * (1 - wholeAlone / whole), "%"


def engineRows(scene, repeats):
    """Rows of the time of each engine in a step; returns their sum and the times [us]."""
    engines = engineTimes(repeats)
    whole = sum(engines.values())
    yield f"all engines{scene}", whole, "us"
    for name, value in engines.items():
        yield f"{name}{scene}", value, "us"
    yield f"interactions{scene}", len(O.interactions), "-"
    yield f"interactions, real{scene}", O.interactions.countReal(), "-"
    return whole, engines


def grains(quick):
    """Grains that rest in a net of 20 x 20 meshes."""
    small = 60, {**GRAIN_NET, "meshes": 9}
    count, net = small if quick else (GRAINS, GRAIN_NET)
    return inNet(count, GRAIN_RADII, net, 3 if quick else REPEATS["grains"])


def hanging(quick):
    """Two thousand grains in a hanging net: what cables take of a step."""
    small = 200, {**HANGING_NET, "meshes": 6}
    count, net = small if quick else (HANGING, HANGING_NET)
    return inNet(count, HANGING_RADII, net, 3 if quick else REPEATS["hanging"])


# ---- spheres on a cable ------------------------------------------------------------------------


def lineScene(count):
    """A cable on posts with spheres lying on it in a row; returns the cable and their ids."""
    O.reset()
    O.trackEnergy = False
    hollars("cable", CABLE)
    hollars("sphere", {**BALL, "young": CABLE["young"], "density": SPHERE_DENSITY})
    height = SPHERE_RADIUS + LINE_DIAMETER / 2 + 1e-6
    ids = []
    for k in range(count):  # between beads where a cable has some
        at = ((k + 0.25) * LINE_SPACING, 0, height)
        ids.append(O.bodies.append(utils.sphere(at, SPHERE_RADIUS, material="sphere")))
    posts = np.arange(count // LINE_SPAN + 1) * LINE_SPAN * LINE_SPACING
    cable = ancf.Cable(
        [(x, 0, 0) for x in posts],
        LINE_ELEMENTS,
        diameter=LINE_DIAMETER,
        material="cable",
        damping=DAMPING,
        mass="lumped",
    )
    for knot in range(len(posts)):
        cable.fix(knot)
    O.engines = ancf.engines(cable, gravity=(0, 0, -GRAVITY))
    return cable, ids


def line(quick):
    """Spheres on a cable that is as long as their row: how a step grows with their number."""
    numbers = FEW_SPHERES if quick else SPHERES
    with tempfile.TemporaryDirectory() as folder:
        files = {count: f"{folder}/{count}.yade" for count in numbers}
        for count, file in files.items():
            cable, ids = lineScene(count)
            speeds = settle(ids, LINE_SETTLE, LINE_CALM)
            lowest = min(O.bodies[i].state.pos[2] for i in ids)
            if lowest < 0:
                raise RuntimeError(f"line: a sphere of {count} fell off, it is at z = {lowest:g} m")
            yield f"contacts, {count} spheres", cable.engine.contacts, "-"
            yield f"fastest of {count} spheres", max(speeds), "m/s"
            O.save(file)
        yield "dt", O.dt, "s"
        cost = {count: [] for count in numbers}
        for _ in range(3 if quick else REPEATS["line"]):
            for count, file in files.items():
                O.load(file)
                O.run(LINE_STEPS, True)
                cost[count].append(1e6 * cpuOf(LINE_STEPS) / LINE_STEPS)
    for count, values in cost.items():
        yield f"CPU a step, {count} spheres", statistics.median(values), "us"
    few, many = cost.values()
    yield "ratio", statistics.median(b / a for a, b in zip(few, many)), "-"


# ---- the run -----------------------------------------------------------------------------------

CASES = dict(
    capture=capture,
    capture3=lambda quick: capture(quick, 3),
    phases=phases,
    flight=flight,
    grains=grains,
    hanging=hanging,
    line=line,
)


def child(name, quick):
    """One case, in this process; its rows go to the last line of stdout, an error's, too."""
    rows = []
    try:
        rows.extend([n, float(v), u] for n, v, u in CASES[name](quick))
    except Exception as error:
        rows.append(["ERROR", f"{type(error).__name__}: {error}", ""])
    print(MARK + json.dumps(rows), flush=True)
    os._exit(0)  # nothing is left to do, and YADE may end badly


def process(command):
    """Rows of a process, or the row of its error."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT)
    except subprocess.TimeoutExpired:
        return [["ERROR", f"no result within {LIMIT} s", ""]]
    for text in done.stdout.splitlines():
        if text.startswith(MARK):
            return json.loads(text[len(MARK) :])
    said = " | ".join((done.stderr + done.stdout).strip().splitlines()[-3:])
    return [["ERROR", f"ended with {done.returncode}: {said}", ""]]


def medians(runs):
    """Rows of several runs as one: the median of each; the first error as it is."""
    for run in runs:
        if any(name == "ERROR" for name, _, _ in run):
            return run
    rows = []
    for same in zip(*runs):
        values = [value for _, value, _ in same]
        number = not isinstance(values[0], str)
        rows.append([same[0][0], statistics.median(values) if number else values[0], same[0][2]])
    return rows


def measure(name, args):
    """Yields (case, rows)."""
    own = [sys.executable, __file__, "--child", name] + ["--quick"] * args.quick
    if not name.startswith("capture"):
        yield name, process(own)
        return
    ours, theirs = [], []
    for _ in range(1 if args.quick else REPEATS[name]):
        ours.append(process(own))
        if args.peers:
            theirs.append(process([args.peers, "-c", PEER, str(DURATION)]))
    yield name, medians(ours)
    if not theirs:
        return
    yield "MuJoCo", medians(theirs)
    if any(r[0] == "ERROR" for run in ours + theirs for r in run):
        return
    times = {what: [] for what in ("CPU time", "wall time")}
    for mine, peer in zip(ours, theirs):
        a, b = ({n: v for n, v, _ in run} for run in (mine, peer))
        for what in times:
            times[what].append(a[what] / b[what])
    yield f"{name} / MuJoCo", [[what, statistics.median(r), "-"] for what, r in times.items()]


def options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a short form: fewer runs and grains")
    parser.add_argument("--only", choices=CASES, action="append", help="this case; may be repeated")
    parser.add_argument("--peers", metavar="PYTHON", help="a Python that has MuJoCo")
    parser.add_argument("--out", metavar="CSV", help="file for the results")
    parser.add_argument("--child", choices=CASES, help=argparse.SUPPRESS)
    return parser.parse_args()


def main():
    args = options()
    if args.child:
        child(args.child, args.quick)
    facts = {**here(), "form": "quick" if args.quick else "whole"}
    print(f"{'load':10}{os.getloadavg()[0]:.2f} before the start", flush=True)
    table, failed = [], False
    for name in args.only or CASES:
        for case, rows in measure(name, args):
            for quantity, value, unit in rows:
                shown = value if isinstance(value, str) else f"{value:.4g}"
                print(f"{case:18}{quantity:58}{shown:>12} {unit}", flush=True)
                table.append(dict(**facts, case=case, quantity=quantity, value=shown, unit=unit))
                failed = failed or quantity == "ERROR"
    if args.out:
        with open(args.out, "w", newline="") as file:
            writer = csv.DictWriter(file, table[0].keys())
            writer.writeheader()
            writer.writerows(table)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
