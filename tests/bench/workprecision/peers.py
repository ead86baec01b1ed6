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

    if "loading" in given:
        yield from belt(given)
        return
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


# Of the belt, as Exudyn's example has them: of its strength [m], bending stiffness [N m2], axial damping [N s]; of
# contact and of friction's bristles [N/m3], [N s/m3]; segments of an element that touch.
STRONG, STIFF, DAMPED = 1e-4, 1.333e-3, 1.0
PRESS, DASH, BRISTLE, WIDTH, SEGMENTS = 4e9, 8e4, 5e9, 0.08, 2


def belt(given):
    """Cable2D on two circles, with contact and bristles for friction; trapezoidal rule of index 2. Speeds
    of both wheels, tensions of both spans, from the time on when all is steady.
    """
    import exudyn as exu
    import exudyn.utilities as part
    from exudyn.beams import CreateReevingCurve, PointsAndSlopes2ANCFCable2D

    radius, distance, kind = given["radius"] - STRONG / 2, given["distance"], exu.OutputVariableType

    def build(n):
        system = exu.SystemContainer().AddSystem()
        curve = CreateReevingCurve(
            [[[0, 0], radius, "L"], [[distance, 0], radius, "L"]],
            radialOffset=STRONG / 2,
            closedCurve=True,
            numberOfANCFnodes=n,
        )
        fixed = system.AddMarker(
            part.MarkerNodeCoordinate(
                nodeNumber=system.AddNode(part.NodePointGround()), coordinate=0
            )
        )
        element = part.Cable2D(
            physicsMassPerLength=given["rhoA"],
            physicsBendingStiffness=STIFF,
            physicsAxialStiffness=given["ea"],
            physicsAxialDamping=DAMPED,
            physicsReferenceAxialStrain=-given["strain"],
            useReducedOrderIntegration=2,
            strainIsRelativeToReference=0.0,
        )
        _, elements, _, _, held = PointsAndSlopes2ANCFCable2D(
            system,
            curve["ancfPointsSlopes"],
            curve["elementLengths"],
            element,
            massProportionalLoad=[0, -given["gravity"], 0],
            fixedConstraintsNode0=[1, 0, 0, 0],
            firstNodeIsLastNode=True,
        )
        length = curve["totalLength"] / n
        area = WIDTH * length / SEGMENTS
        rough = 10 * math.sqrt(BRISTLE / 50 * area * given["rhoA"] * length / SEGMENTS)
        wheels, stops, touching = [], [], []
        for x in (0, distance):
            node = system.AddNode(part.NodeRigidBody2D(referenceCoordinates=[x, 0, 0]))
            body = system.AddObject(
                part.ObjectRigidBody2D(
                    physicsMass=50, physicsInertia=given["inertia"], nodeNumber=node
                )
            )
            place = [
                system.AddMarker(part.MarkerNodeCoordinate(nodeNumber=node, coordinate=k))
                for k in range(3)
            ]
            for k in range(3):
                stops.append(
                    system.AddObject(part.CoordinateConstraint(markerNumbers=[fixed, place[k]]))
                )
            wheels.append((node, place[2], stops.pop()))
            rim = system.AddMarker(part.MarkerBodyRigid(bodyNumber=body))
            for e in elements:
                side = system.AddMarker(
                    part.MarkerBodyCable2DShape(
                        bodyNumber=e, numberOfSegments=SEGMENTS, verticalOffset=-STRONG / 2
                    )
                )
                states = [0.1] * SEGMENTS + [-2] * SEGMENTS + [0] * SEGMENTS
                data = system.AddNode(
                    part.NodeGenericData(
                        initialCoordinates=states, numberOfDataCoordinates=len(states)
                    )
                )
                touching.append(
                    system.AddObject(
                        part.ObjectContactFrictionCircleCable2D(
                            markerNumbers=[rim, side],
                            nodeNumber=data,
                            numberOfContactSegments=SEGMENTS,
                            contactStiffness=PRESS * area,
                            contactDamping=DASH * area,
                            frictionVelocityPenalty=rough,
                            frictionStiffness=BRISTLE * area,
                            frictionCoefficient=given["friction"],
                            circleRadius=radius,
                        )
                    )
                )
        (_, led, _), (_, driven, _) = wheels
        start, end = given["speeding"]
        lead = system.AddObject(
            part.CoordinateConstraint(
                markerNumbers=[fixed, led],
                velocityLevel=True,
                offsetUserFunction_t=lambda s, t, i, o: given["speed"]
                * min(1.0, max(0.0, (t - start) / (end - start))),
            )
        )
        system.AddObject(
            part.CoordinateSpringDamper(markerNumbers=[fixed, driven], damping=given["viscous"])
        )
        system.AddLoad(
            part.LoadCoordinate(
                markerNumber=driven,
                load=0,
                loadUserFunction=lambda s, t, load: -given["torque"]
                * part.SmoothStep(t, *given["loading"], 0.0, 1.0),
            )
        )
        look = [
            system.AddSensor(
                part.SensorBody(
                    bodyNumber=e,
                    storeInternal=True,
                    localPosition=[length / 2, 0, 0],
                    outputVariableType=what,
                )
            )
            for what in (kind.Position, kind.ForceLocal)
            for e in elements
        ]
        look += [
            system.AddSensor(
                part.SensorNode(
                    nodeNumber=wheel[0], storeInternal=True, outputVariableType=kind.AngularVelocity
                )
            )
            for wheel in wheels
        ]
        system.Assemble()
        rest(system, lead, touching, [stop for _, _, stop in wheels], held, BRISTLE * area)
        return system, look

    def settings(step):
        made = exu.SimulationSettings()
        made.linearSolverType = exu.LinearSolverType.EigenSparse
        made.solutionSettings.writeSolutionToFile = False
        made.solutionSettings.sensorsWritePeriod = 2e-3
        made.parallel.numberOfThreads = 1
        march, still = made.timeIntegration, made.staticSolver
        march.endTime, march.numberOfSteps = given["duration"], round(given["duration"] / step)
        march.newton.useModifiedNewton = True
        march.discontinuous.iterationTolerance, march.discontinuous.maxIterations = 1e-3, 3
        still.adaptiveStep, still.numberOfLoadSteps, still.stabilizerODE2term = False, 10, 1e5
        still.loadStepGeometric, still.loadStepGeometricRange = True, 1e4
        still.newton.relativeTolerance = still.newton.absoluteTolerance = 1e-6
        march.verboseMode = still.verboseMode = 0
        return made

    def rest(system, lead, touching, stops, held, bristle):
        """Equilibrium without friction, wheels and belt held; then all is let go."""

        def friction(coefficient, stiffness):
            for contact in touching:
                system.SetObjectParameter(contact, "frictionCoefficient", coefficient)
                system.SetObjectParameter(contact, "frictionStiffness", stiffness)

        system.SetObjectParameter(lead, "activeConnector", False)
        friction(0.0, 1e-8)
        system.SolveStatic(settings(1e-4), updateInitialValues=True)
        friction(given["friction"], bristle)
        for stop in (*held, *stops):
            system.SetObjectParameter(stop, "activeConnector", False)
        system.SetObjectParameter(lead, "activeConnector", True)

    def spans(places, forces, t):
        """Mean tensions of the free spans above and below."""
        found = []
        for side in (1, -1):
            x, y = places[..., 0], side * places[..., 1]
            free = (x > 0.25 * distance) & (x < 0.75 * distance) & (y > 0.6 * radius)
            found.append(float(forces[free & (t > given["steady"])].mean()))
        return found

    for n in given["elements"]:
        for step in given["steps"]:
            system, look = build(n)
            begin = time.process_time()
            system.SolveDynamic(settings(step), solverType=exu.DynamicSolverType.TrapezoidalIndex2)
            cpu = time.process_time() - begin
            seen = [system.GetSensorStoredData(k) for k in look]
            places, forces, spin = np.array(seen[:n]), np.array(seen[n : 2 * n]), seen[2 * n :]
            t = spin[0][:, 0]
            speeds = [float(w[t > given["steady"], -1].mean()) for w in spin]
            found = [speeds, spans(places[..., 1:], forces[..., 1], t)]
            yield "Exudyn implicit", n, "implicit", step, cpu, found


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
            found.append((shape.node_positions()[rows] - [0, 0, HIGH]).tolist())
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
