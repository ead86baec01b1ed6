"""Other programs on the same cases, run by a Python that has them: peers.py PROGRAM, the case as
JSON on stdin (smooth.forPeers, nets.forPeers). The last line of stdout is a list of runs:
[method, elements, integrator, step [s], CPU time [s], what was measured].
"""

import json
import math
import pathlib
import sys
import tempfile
import time

import numpy as np

LEAST, REPEATS = 0.3, 3  # runs that take less [s] are made so many times
HIGH, DEEP, THIN = (
    20.0,
    100.0,
    1e-6,
)  # of CableDyn's lines, its sea's depth [m], its density [kg/m3]


def timed(build, run):
    """CPU time of run(build()), the median of a few if it is short, and its last result."""
    times = []
    while not times or (times[0] < LEAST and len(times) < REPEATS):
        made = build()
        begin = time.process_time()
        result = run(made)
        times.append(time.process_time() - begin)
    return sorted(times)[len(times) // 2], result


# ---- Exudyn --------------------------------------------------------------------------------------


def exudyn(given):
    """ObjectANCFCable, engineering strain, exact curvature; generalised-alpha and Verlet."""
    import exudyn as exu
    import exudyn.utilities as part

    solvers = {
        "implicit": exu.DynamicSolverType.GeneralizedAlpha,
        "leapfrog": exu.DynamicSolverType.VelocityVerlet,
    }

    def build(case, n):
        system = exu.SystemContainer().AddSystem()
        stretch, h = case["stretch"], 1 / n
        nodes = []
        for i in range(n + 1):
            x = i * h
            z, slope = np.interp(x, case["x"], case["z"]), np.interp(x, case["x"], case["slope"])
            nodes.append(
                system.AddNode(
                    part.NodePointSlope1(
                        referenceCoordinates=[x, 0, 0, stretch, 0, 0],
                        initialCoordinates=[0, 0, z, 0, 0, stretch * slope],
                        initialVelocities=[0, 0, case["turn"] * x, 0, 0, case["turn"]],
                    )
                )
            )
        for first, second in zip(nodes, nodes[1:]):
            element = system.AddObject(
                part.ObjectANCFCable(
                    nodeNumbers=[first, second],
                    length=h / stretch,
                    massPerLength=case["rhoA"],
                    bendingStiffness=case["ei"],
                    axialStiffness=case["ea"],
                )
            )
            marker = system.AddMarker(part.MarkerBodyMass(bodyNumber=element))
            system.AddLoad(
                part.LoadMassProportional(markerNumber=marker, loadVector=case["gravity"])
            )
        ground = system.AddNode(part.NodePointGround())
        ground = system.AddMarker(part.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
        for end, held in zip((nodes[0], nodes[-1]), case["held"]):
            for k in range(held):
                marker = system.AddMarker(part.MarkerNodeCoordinate(nodeNumber=end, coordinate=k))
                system.AddObject(part.CoordinateConstraint(markerNumbers=[ground, marker]))
        system.Assemble()
        return system, nodes

    def solve(made, integrator, step, duration):
        system, nodes = made
        settings = exu.SimulationSettings()
        march = settings.timeIntegration
        march.numberOfSteps, march.endTime = round(duration / step), duration
        march.verboseMode, march.adaptiveStep = 0, False
        march.generalizedAlpha.spectralRadius = 0.9
        march.newton.useModifiedNewton = True
        settings.solutionSettings.writeSolutionToFile = False
        settings.parallel.numberOfThreads = 1
        settings.linearSolverType = exu.LinearSolverType.EigenSparse
        system.SolveDynamic(settings, solverType=solvers[integrator])
        where = exu.OutputVariableType.Position
        return [list(system.GetNodeOutput(node, where)) for node in nodes]

    duration = given["duration"]
    for n in given["elements"]:
        for step in given["steps"]:
            cpu, found = timed(
                lambda: build(given, n), lambda made: solve(made, "implicit", step, duration)
            )
            yield "Exudyn implicit", n, "implicit", step, cpu, found
        step = 0.1 / n * math.sqrt(given["rhoA"] / given["ea"])
        cpu, found = timed(
            lambda: build(given, n), lambda made: solve(made, "leapfrog", step, duration)
        )
        yield "Exudyn explicit", n, "leapfrog", step, cpu, found


# ---- PyElastica ----------------------------------------------------------------------------------


def elastica(given):
    """Cosserat rods, sheared as well; position Verlet. Its first steps compile, and are not counted."""
    import elastica as ea

    class System(ea.BaseSystemCollection, ea.Constraints, ea.Forcing):
        pass

    class Held(ea.ConstraintBase):
        def __init__(self, ends, clamped, **rest):
            super().__init__(**rest)
            self.ends, self.clamped, self.at = ends, clamped, None

        def constrain_values(self, system, time):
            if self.at is None:
                self.at = system.position_collection[:, self.ends].copy()
                self.turned = system.director_collection[..., 0].copy()
            system.position_collection[:, self.ends] = self.at
            if self.clamped:
                system.director_collection[..., 0] = self.turned

        def constrain_rates(self, system, time):
            system.velocity_collection[:, self.ends] = 0
            if self.clamped:
                system.omega_collection[:, 0] = 0

    def build(case, n):
        axis, normal = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])
        rod = ea.CosseratRod.straight_rod(
            n,
            np.zeros(3),
            axis,
            normal,
            1 / case["stretch"],
            case["radius"],
            case["density"],
            youngs_modulus=case["young"],
            shear_modulus=case["young"] / 2.6,
        )
        x = np.linspace(0, 1, n + 1)
        rod.position_collection[0] = x
        rod.position_collection[2] = np.interp(x, case["x"], case["z"])
        rod.velocity_collection[2] = case["turn"] * x
        for k in range(n):
            tangent = rod.position_collection[:, k + 1] - rod.position_collection[:, k]
            tangent /= np.linalg.norm(tangent)
            rod.director_collection[:, :, k] = [normal, np.cross(tangent, normal), tangent]
            spin = np.array([0, -case["turn"], 0])
            rod.omega_collection[:, k] = rod.director_collection[:, :, k] @ spin
        system = System()
        system.append(rod)
        system.add_forcing_to(rod).using(ea.GravityForces, acc_gravity=np.array(case["gravity"]))
        ends = [k for k, held in zip((0, -1), case["held"]) if held]
        system.constrain(rod).using(Held, ends=ends, clamped=case["held"][0] == 6)
        system.finalize()
        return system, rod

    def march(made, step, steps):
        system, rod = made
        stepper, now = ea.PositionVerlet(), np.float64(0)
        for _ in range(steps):
            now = stepper.step(system, now, np.float64(step))
        return rod.position_collection.T.tolist()

    march(build(given, 8), 1e-7, 3)
    speed = math.sqrt(given["ea"] / given["rhoA"])
    for n in given["segments"]:
        longest = min(0.5 / n, 1.2 * given["radius"]) / speed  # waves along it, turning of sections
        steps = math.ceil(given["duration"] / longest)
        step = given["duration"] / steps
        cpu, found = timed(lambda: build(given, n), lambda made: march(made, step, steps))
        yield "PyElastica", n, "leapfrog", step, cpu, found


# ---- MuJoCo --------------------------------------------------------------------------------------


def mujoco(given):
    """A chain of capsules on springs, which cannot stretch; a net of springs as a flex."""
    import mujoco as mj

    def chain(case, n, step, integrator):
        h, inner = 1 / n, ""
        for i in reversed(range(n)):
            joint = f'<joint type="ball" stiffness="{case["ei"] / h if i else 0}"/>'
            if i == 0 and case["held"][0] == 6:  # half an element's bending up to the clamp
                joint = f'<joint type="ball" stiffness="{2 * case["ei"] / h}"/>'
            tip = '<site name="tip" pos="%g 0 0"/>' % h if i == n - 1 else ""
            inner = (
                f'<body pos="{h if i else 0} 0 0">{joint}<geom type="capsule" contype="0" '
                f'conaffinity="0" size="{case["radius"]}" fromto="0 0 0 {h} 0 0" '
                f'mass="{case["rhoA"] * h}"/>{tip}{inner}</body>'
            )
        gravity = " ".join(map(str, case["gravity"]))
        model = mj.MjModel.from_xml_string(
            f'<mujoco><option timestep="{step}" integrator="{integrator}" gravity="{gravity}"/>'
            f"<worldbody>{inner}</worldbody></mujoco>"
        )
        data = mj.MjData(model)
        data.qvel[1] = -case["turn"]
        return model, data

    def march(made, steps):
        model, data = made
        mj.mj_step(model, data, steps)
        mj.mj_forward(model, data)
        return [data.site("tip").xpos.tolist()]

    if "nets" in given:
        yield from flexes(given)
        return
    for n in given["elements"][1:]:
        for integrator, step in (("Euler", 1e-3), ("Euler", 2e-4), ("RK4", 1e-3)):
            steps = round(given["duration"] / step)
            cpu, found = timed(
                lambda: chain(given, n, step, integrator), lambda made: march(made, steps)
            )
            yield "MuJoCo capsules", n, integrator, step, cpu, found


def flexes(net):
    """Nets of springs on a ball in MuJoCo."""
    import mujoco as mj

    def text(rows):
        return " ".join(" ".join(f"{value:.9g}" for value in row) for row in rows)

    def flex(parts, step, damping):
        it = net["nets"][parts]
        pull = net["ea"] / net["edge"] * int(parts)
        mass = net["rhoA"] * net["edge"] / int(parts) * len(it["pairs"])
        model = mj.MjModel.from_xml_string(
            f"""<mujoco><option timestep="{step}" integrator="implicitfast" gravity="0 0 0"/>
<worldbody><geom type="sphere" size="{net["ballRadius"]}" pos="{text([net["ball"]])}" friction="0"/>
<flexcomp name="net" type="direct" dim="1" point="{text(it["points"])}"
element="{text(it["pairs"])}" radius="{net["radius"]}" mass="{mass}">
<contact selfcollide="none" friction="0" condim="1"/><edge stiffness="{pull}" damping="{damping}"/>
</flexcomp></worldbody></mujoco>"""
        )
        # A flex shares its mass evenly; the corners' bullets come on top.
        bodies = [model.flex_vertbodyid[k] for k in range(len(it["points"]))]
        for k in it["corners"]:
            model.body_mass[bodies[k]] += net["bullet"]
        data = mj.MjData(model)
        mj.mj_setConst(model, data)
        for body in bodies:
            data.qvel[model.body_dofadr[body] + 2] = -net["speed"]
        return model, data, bodies

    def meet(made, steps):
        model, data, bodies = made
        down = [model.body_dofadr[body] + 2 for body in bodies]
        before = model.body_mass[bodies] @ data.qvel[down]
        mj.mj_step(model, data, steps)
        return float(model.body_mass[bodies] @ data.qvel[down] - before)

    for parts in net["nets"]:
        for step in (1e-4, 5e-5, 2e-5):
            for damping in net["dampings"]:
                steps = round(net["duration"] / step)
                cpu, found = timed(
                    lambda: flex(parts, step, damping), lambda made: meet(made, steps)
                )
                method = "MuJoCo flex of springs"
                yield method, int(parts), "implicitfast", step, cpu, found


# ---- CableDyn ------------------------------------------------------------------------------------


def cabledyn(given):
    """Elements of positions and slopes, generalised-alpha, far above a sea of next to no density; without
    bending, two-node elements. It starts from equilibrium, which it finds itself.
    """
    yield from (moved if "way" in given else lying)(given)


def line(given, n, first, last, **options):
    """File of one line between two points, the first of which can be led."""
    from cabledyn import DeckModel

    deck = DeckModel.new()
    stiffness = dict(ea=given["ea"], ei=given["ei"])
    kind = deck.add_line_type("cable", diam=given["diameter"], mass=given["rhoA"], **stiffness)
    ends = deck.add_point(1, "Coupled", *first), deck.add_point(2, "Fixed", *last)
    deck.add_line(1, *ends, kind, length=given["length"], num_segs=n)
    for name, value in dict(g=given["gravity"], rhow=THIN, WtrDpth=DEEP, **options).items():
        deck.options.set(name, value)
    file = pathlib.Path(tempfile.mkdtemp()) / "line.dat"
    deck.save(file)
    return file


def moved(given):
    """Two Gauss points for the axial strain: with three, as it comes, stiff cables lock."""
    from cabledyn import CableDyn

    def build(n, step):
        ends = (0, 0, HIGH), (given["span"], 0, HIGH)
        options = dict(dtM=step, TMax=given["times"][-1], axial_quadrature=2)
        return CableDyn(line(given, n, *ends, **options))

    def march(model, n, step):
        """CPU time of all steps and the places at the times asked for."""
        led, shape = model.host_dofs(), model.lines[0]
        (q, v, a), now, cpu, found = model.get_coupled_motion(), 0, 0.0, []
        origin, turn = q[led].copy(), 2 * math.pi * given["frequency"]
        way, rows = np.array(given["way"]), [round(n * place) for place in given["places"]]
        for until in given["times"]:
            begin = time.process_time()
            while now < round(until / step):
                now += 1
                phase = turn * now * step
                q[led] = origin + way * (math.cos(phase) - 1)
                v[led], a[led] = -way * turn * math.sin(phase), -way * turn**2 * math.cos(phase)
                model.step(step, q, v, a)
            cpu += time.process_time() - begin
            found.append(shape.node_positions()[rows].tolist())
        return cpu, found

    for n in given["elements"]:
        for step in given["steps"]:
            times = []
            while not times or (times[0] < LEAST and len(times) < REPEATS):
                cpu, found = march(build(n, step), n, step)
                times.append(cpu)
            yield "CableDyn", n, "implicit", step, sorted(times)[len(times) // 2], found


def lying(given):
    """At rest on the ground of its sea; reading the file is in the time."""
    from cabledyn import CableDyn

    first, last = ((x, y, z - DEEP) for x, y, z in given["ends"])
    for n in given["elements"]:
        file = line(given, n, last, first, kbot=given["floor"])
        cpu, found = timed(lambda: file, lambda made: CableDyn(made).lines[0].node_positions())
        yield "CableDyn", n, "statics", 0.0, cpu, (found[::-1] + [0, 0, DEEP]).tolist()


def main():
    program = dict(exudyn=exudyn, elastica=elastica, mujoco=mujoco, cabledyn=cabledyn)[sys.argv[1]]
    runs = list(program(json.load(sys.stdin)))
    print("result: " + json.dumps(runs))


if __name__ == "__main__":
    main()
