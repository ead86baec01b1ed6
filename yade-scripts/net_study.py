"""Two targets, four models of a net's flexibility: the study of Shan, Guo and Gill 2019, remade.

`/usr/bin/python3 net_study.py` remakes Table 3 and Figs. 10-19 in less than two minutes on two cores; --quick is a
short form for tests. Results go to out/net-study/. The other figures of docs/net-study are those of
contact_laws.py, deployment.py, recoil.py and chains.py. Source: Shan, Guo, Gill, Advances in Space Research
(2019), doi 10.1016/j.asr.2019.10.041.
"""

import argparse
import csv
import pathlib
import sys
import time

from jobs import addOption, insist, runAll  # first: see there

import ancf
import ball_capture as given
import numpy as np
from ancf.capture import Capture
from yade import O, Vector3, utils

# ---- parameters, SI units; those of the net and its bullets are ball_capture's -------------------
CUBE_EDGE = 0.12  # [m]
DURATION = 1.5  # [s]
SAMPLE = 5e-3  # time between two samples [s]
BEFORE, COMPARED = (
    0.6,
    1.4,
)  # models are compared up to these times: before contact, and the study's [s]
RUNS = 4  # perturbed runs a case, besides the unperturbed one
NUDGE = 1e-6  # relative, of the bullets' velocities; of the target's place in its size
RESERVE = 0.8  # of the stable step
PICTURES = given.STRIP_TIMES  # [s]
PER_EDGE = 24  # places on each cable at which its penetration is looked at

TARGETS = ("ball", "cube")
MODELS = {  # the study's: contact points at the nodes and, in ANCF, three inside each cable
    "springs 0": dict(model="springs", contact="points"),
    "springs 3": dict(model="springs", midPoints=3, contact="points"),
    "ANCF 1": dict(elements=1, contactPoints=3, mass="lumped", contact="points"),
    "ANCF 2": dict(elements=2, contactPoints=1, mass="lumped", contact="points"),
}
CURVE = {"ANCF 1, curve": {**MODELS["ANCF 1"], "contact": "curve"}}  # touches along its true curve
CONSISTENT = {  # show what lumping the mass changes; ball only
    "ANCF 1, consistent": {**MODELS["ANCF 1"], "mass": "consistent"},
    "ANCF 2, consistent": {**MODELS["ANCF 2"], "mass": "consistent"},
}
FINE = {"ANCF 1, 15 points": {**MODELS["ANCF 1"], "contactPoints": 15}}  # cube only
ALL = {**MODELS, **CURVE, **CONSISTENT, **FINE}
ONCE = ("ANCF 2, consistent", "ANCF 1, 15 points")  # without perturbed runs
COLORS = dict(
    zip(
        ALL,
        ("#c0392b", "#e08e0b", "#1f6fb2", "#2e8b57", "#111111", "#7d5ba6", "#d17fb0", "#555555"),
    )
)


def build(target, model, nudge=0, integrator="leapfrog", gap=None):
    """The scene; nudge: 0, or the number of a perturbed run. Returns net, id of the target."""
    a, rng = given.ASSUMED, np.random.default_rng(nudge)
    small = NUDGE if nudge else 0.0
    O.reset()
    given.appendMaterials("target")
    size = given.BALL_RADIUS if target == "ball" else 0.5 * CUBE_EDGE
    y, z = small * size * rng.normal(size=2)
    center = Vector3(given.TARGET_DISTANCE if gap is None else gap, y, z)
    if target == "ball":
        body = utils.sphere(center, size, material="target", fixed=True)
    else:
        body = utils.box(center, (size, size, size), material="target", fixed=True)
    number = O.bodies.append(body)
    net = ancf.Net.square(
        given.MESHES,
        given.MESH_LENGTH,
        diameter=a["diameter"],
        material="cable",
        damping=a["damping"],
        normal=(1, 0, 0),
        fold=a["fold"],
        **ALL[model],
    )
    net.addBullets(
        given.BULLET_MASS,
        a["bulletRadius"],
        given.BULLET_SPEED,
        np.radians(given.BULLET_ANGLE),
    )
    O.engines = ancf.engines(net, gravity=(0, 0, -a["gravity"]), integrator=integrator)
    O.dt = step(net)
    if nudge:
        nudgeBullets(net, small * given.BULLET_SPEED * rng.normal(size=(4, 3)))
    ancf.check()
    return net, number


def step(net):
    """Stable step of the cables [s], with a reserve for their strain when they are caught."""
    return RESERVE * net.criticalTimeStep()


def nudgeBullets(net, by):
    """Changes the velocities of the corner knots, and so of the bullets, by (4, 3) [m/s]."""
    engine = net.engine
    v = np.array(engine.velocity).reshape(3, -1)
    v[:, net.corners] += by.T
    engine.velocity = v.ravel().tolist()
    for number, change in zip(net.bullets, by):
        O.bodies[number].state.vel += Vector3(*change)


def depth(points, body, radius):
    """How deep a round cable of that radius is in a sphere or box at points of its axis, (n) [m];
    below zero: outside.
    """
    local = np.asarray(points).reshape(-1, 3) - np.array(list(body.state.pos))
    if hasattr(body.shape, "radius"):
        return radius + body.shape.radius - np.linalg.norm(local, axis=1)
    turn = body.state.ori.toRotationMatrix()
    local = local @ np.array([[turn[i, j] for j in range(3)] for i in range(3)])
    beyond = np.abs(local) - np.array(list(body.shape.extents))
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
    return radius - outside - np.minimum(beyond.max(axis=1), 0)


class Run:
    """One capture, and what is measured in it."""

    def __init__(self, target, model, nudge=0, duration=DURATION, pictures=(), smaller=1.0):
        from ancf.plots import History
        from ancf.render import Frame

        self.target, self.model, self.nudge = target, model, nudge
        net, number = build(target, model, nudge)
        O.dt *= smaller
        body = O.bodies[number]
        self.nodes, self.edges = net.nodeCount, len(net.spans)
        self.dof = unknowns(net)
        self.stable, self.step = net.criticalTimeStep(), O.dt
        history, self.capture = History(net), Capture(net, number)
        self.penetration, self.frames = [], []
        perElement = PER_EDGE * len(net.spans) // net.elementCount
        steps, every = int(np.ceil(duration / O.dt)), max(1, round(SAMPLE / O.dt))
        ahead, wall = list(pictures), 0.0
        while True:
            history.sample()
            self.capture.sample()
            self.penetration.append(depth(net.curve(perElement), body, net.radius).max())
            while ahead and O.time >= ahead[0] - 0.5 * SAMPLE:
                self.frames.append(Frame([net], [number]))
                ahead.pop(0)
            if O.iter >= steps:
                break
            start = time.process_time()
            for _ in range(min(every, steps - O.iter)):
                O.step()
            wall += time.process_time() - start
        self.wall, self.microseconds = wall, 1e6 * wall / O.iter
        self.time = np.array(history.time)
        self.displacement, self.speed = history.displacement, history.speed
        self.row, self.share = self.capture.row(), self.capture.share
        del self.capture  # belongs to the scene, and stays in its process
        self.pointPenetration = net.engine.maxPenetration
        self.diameter = 2 * net.radius

    @property
    def deepest(self):
        """Deepest penetration of the true curve, in diameters of the cable."""
        return max(0.0, max(self.penetration)) / self.diameter

    @property
    def embraced(self):
        """As ball_capture has it: for HOLD, and no contact point deeper than a diameter."""
        return self.row["embraced_from_s"] is not None and self.pointPenetration < self.diameter

    @property
    def whole(self):
        """Embraced, and the true curve never deeper than a diameter either."""
        return self.embraced and self.deepest < 1

    @property
    def why(self):
        """Why it did not embrace its target, or why not whole."""
        reasons = []
        if not self.embraced:
            reasons.append(f"not embraced for {given.HOLD} s")
        if self.deepest >= 1:
            reasons.append(f"true curve {self.deepest:.2f} diameters deep")
        return ", ".join(reasons)


def unknowns(net):
    """Degrees of freedom, 3 a node and 3 a slope; slopes that go on smoothly count once."""
    engine = net.engine
    springs = bool(engine.kind[0] & 1)
    slopes = 0 if springs else 2 * engine.nElements - sum(k >= 0 for k in engine.next)
    return 3 * (engine.nNodes + slopes)


def makeRun(job):
    return insist(Run, job)


# ---- Table 3 -------------------------------------------------------------------------------------


def stepTime(model, integrator, steps=2000):
    """Microseconds a step of the deploying net takes, whole loop of YADE, best of three."""
    build("ball", model, integrator=integrator)
    best = np.inf
    for _ in range(3):
        start = time.process_time()
        for _ in range(steps // 3):
            O.step()
        best = min(best, (time.process_time() - start) / (steps // 3))
    return 1e6 * best


def spread(values, digits):
    """Mean and standard deviation of those that are there, as text."""
    values = np.array([x for x in values if x is not None])
    if not len(values):
        return "-"
    one = f"{values.mean():.{digits}f}"
    return f"{one} ± {values.std():.{digits}f}" if len(values) > 1 else one


def of(runs, name, factor=1.0):
    """A measure of all runs, None where it is none."""
    return [None if r.row[name] is None else factor * r.row[name] for r in runs]


def table(runs, folder):
    """Writes table.csv (what a model costs), stages.csv (when each case did what) and captures.csv (what came
    of it); runs: {(target, model): [Run, ...]}.
    """
    cost, stages, ends = {}, [], []
    flat = 100 / (given.MESHES * given.MESH_LENGTH) ** 2
    for (target, model), all_ in runs.items():
        if model not in cost:
            cost[model] = costs(model, all_)
        count = len(all_)
        stages.append(
            [
                target,
                model,
                spread(of(all_, "open_s"), 2),
                spread(of(all_, "mouth_open_m2", flat), 0),
                spread(of(all_, "contact_s"), 2),
                spread(of(all_, "embraced_from_s"), 2),
                spread(of(all_, "embraced_until_s"), 2),
                spread(of(all_, "mouth_tightest", 100), 0),
                spread(of(all_, "enclosed_most", 100), 0),
                f"{sum(r.embraced for r in all_)} of {count}",
            ]
        )
        reasons = sorted({r.why for r in all_} - {""})
        ends.append(
            [
                target,
                model,
                spread([r.deepest for r in all_], 2),
                f"{max(r.pointPenetration for r in all_) / all_[0].diameter:.2f}",
                spread(of(all_, "momentum_end_Ns"), 3),
                spread(of(all_, "tension_most_N"), 1),
                spread(of(all_, "quality_best"), 2),
                f"{sum(r.whole for r in all_)} of {count}",
                "; ".join(reasons[:2]) + ("; ..." if len(reasons) > 2 else ""),
            ]
        )
    head = (
        "model,nodes,dof,stable step of the cables [s],step taken [s],us a step (leapfrog),"
        "us a step (RK4),us a step (whole capture),capture [s]"
    ).split(",")
    writeTable(folder / "table.csv", head, list(cost.values()))
    head = (
        "target,model,open [s],mouth then [% of flat],first contact [s],embraced from [s],until [s],"
        "mouth at the tightest [%],enclosed at most [%],embraced"
    ).split(",")
    writeTable(folder / "stages.csv", head, stages)
    head = (
        "target,model,true curve [diameters],contact points [diameters],impulse on the target [N s],"
        "largest tension [N],quality index at best,embraced by true curve,why not"
    ).split(",")
    writeTable(folder / "captures.csv", head, ends)


def costs(model, runs):
    """Row of table.csv."""
    first = runs[0]
    sizes = [
        model,
        first.nodes,
        first.dof,
        f"{first.stable:.2e}",
        f"{max(r.step for r in runs):.2e}",
    ]
    free = [f"{stepTime(model, i):.1f}" for i in ("leapfrog", "rk4")]
    whole = [f"{first.microseconds:.1f}", f"{np.median([r.wall for r in runs]):.1f}"]
    return [*sizes, *free, *whole]


def writeTable(file, head, rows):
    """Writes a CSV and prints it."""
    with open(file, "w", newline="", encoding="utf-8") as out:
        csv.writer(out).writerows([head, *rows])
    print(f"\n{file}")
    widths = [max(len(str(r[i])) for r in [head, *rows]) for i in range(len(head))]
    if sum(widths) > 180:
        for row in rows:
            print("  " + "; ".join(f"{h} {x}" for h, x in zip(head, row) if x != ""))
    else:
        for row in [head, *rows]:
            print("  " + "  ".join(str(x).ljust(w) for x, w in zip(row, widths)))
    sys.stdout.flush()


# ---- differences between models ------------------------------------------------------------------


def apart(a, b, until):
    """Largest difference of bullet 1's displacement between two runs up to a time [m]."""
    t = np.arange(0, min(until, a.time[-1], b.time[-1]), SAMPLE)
    one, other = (np.interp(t, r.time, r.displacement[:, 0]) for r in (a, b))
    return np.abs(one - other).max()


def differences(runs, file):
    """Table of differences between and inside models over all pairs of runs; returns {(target, until):
    ([inside], [between])}, means in metres.
    """
    rows, answer = [], {}
    for until in (BEFORE, COMPARED):
        for target in dict.fromkeys(t for t, _ in runs):
            models = [m for t, m in runs if t == target]
            inside, between = answer.setdefault((target, until), ([], []))
            for i, one in enumerate(models):
                for other in models[i:]:
                    a, b = runs[target, one], runs[target, other]
                    same = one == other
                    pairs = [(x, y) for k, x in enumerate(a) for y in (a[k + 1 :] if same else b)]
                    if not pairs:
                        continue
                    d = np.array([apart(x, y, until) for x, y in pairs])
                    if one in MODELS and other in MODELS:
                        (inside if same else between).append(d.mean())
                    travel = max(r.displacement[r.time <= until, 0].max() for r in a)
                    cm = [f"{100 * x:.2f}" for x in (d.mean(), d.std(), d.max())]
                    part = f"{100 * d.mean() / travel:.2f}"
                    rows.append([until, target, one, other, *cm, part, len(d)])
    head = (
        "until [s],target,model,other model,mean difference [cm],its spread [cm],largest [cm],"
        "mean [% of travel],pairs"
    ).split(",")
    writeTable(file, head, rows)
    return answer


# ---- figures -------------------------------------------------------------------------------------


def plotBullet(runs, target, file):
    """Displacement and velocity of bullet 1, all models: Figs. 16-17 (ball), 18-19 (cube)."""
    from ancf.plots import plt

    figure, axes = plt.subplots(1, 3, figsize=(16, 4.6))
    models = [m for t, m in runs if t == target]
    reference = runs[target, models[-1]][0]
    for model in models:
        all_, color = runs[target, model], COLORS[model]
        for ax, what in zip(axes, ("displacement", "speed")):
            for run in all_[1:]:
                ax.plot(run.time, getattr(run, what)[:, 0], color=color, lw=0.4, alpha=0.35)
            ax.plot(all_[0].time, getattr(all_[0], what)[:, 0], color=color, lw=1.6, label=model)
        for run in all_[1:] or all_:
            gap = run.displacement[:, 0] - np.interp(
                run.time, reference.time, reference.displacement[:, 0]
            )
            axes[2].plot(run.time, 100 * gap, color=color, lw=0.7, alpha=0.6)
        axes[0].axvline(all_[0].row["contact_s"] or np.nan, color=color, lw=0.6, ls=":")
    axes[0].set_ylabel("displacement of bullet 1 [m]")
    axes[1].set_ylabel("speed of bullet 1 [m/s]")
    axes[2].set_ylabel(f"displacement less that of {models[-1]}, unperturbed [cm]")
    for ax in axes:
        ax.set_xlabel("time [s]")
        ax.set_xlim(0, reference.time[-1])
        ax.grid(alpha=0.3)
    axes[0].legend(fontsize=9)
    figure.suptitle(
        f"{target}: unperturbed runs (thick) and perturbed ones (thin); dotted: first contact",
        fontsize=11,
    )
    figure.tight_layout()
    figure.savefig(file, dpi=100)
    plt.close(figure)


def plotPenetration(runs, file):
    """Depth of the true curve in the target over time."""
    from ancf.plots import plt

    targets = list(dict.fromkeys(t for t, _ in runs))
    figure, axes = plt.subplots(1, len(targets), figsize=(6.5 * len(targets), 4.4), squeeze=False)
    for ax, target in zip(axes[0], targets):
        for (t, model), all_ in runs.items():
            if t != target:
                continue
            for run in all_:
                deep = np.maximum(run.penetration, 1e-9) / run.diameter
                label = model if run is all_[0] else None
                ax.plot(run.time, deep, color=COLORS[model], lw=0.9, alpha=0.7, label=label)
        ax.axhline(1, color="k", lw=0.8, ls=":")
        ax.annotate("one diameter", (0.02, 0.65), fontsize=8)
        ax.set_yscale("log")
        ax.set_ylim(1e-3, 200)
        ax.set_title(target)
        ax.set_xlabel("time [s]")
        ax.set_ylabel("deepest point of the cables' true curve [diameters]")
        ax.grid(alpha=0.3)
        ax.legend(fontsize=9)
    figure.tight_layout()
    figure.savefig(file, dpi=100)
    plt.close(figure)


def plotPictures(runs, target, file):
    """Pictures of the unperturbed run, a row a model: Figs. 10-15."""
    from ancf.render import CABLE, View, sheet

    models = [m for t, m in runs if t == target and runs[t, m][0].frames]
    rows = [runs[target, m][0].frames for m in models]
    titles = [f"{frame.time:.2f} s" for frame in max(rows, key=len)]
    view = View(direction=(-0.60, 0.71, -0.37), cables=CABLE)
    sheet(file, rows, view, titles, models, cell=(300, 300))


# ---- the whole -----------------------------------------------------------------------------------


def study(folder, runs, workers, duration, targets, models, more=True):
    """All captures; returns {(target, model): [Run, ...]}, the unperturbed first."""
    cases = [(t, m) for t in targets for m in models]
    if more:
        cases += [(t, m) for t in TARGETS for m in CURVE]
        cases += [("ball", m) for m in CONSISTENT] + [("cube", m) for m in FINE]
    pictures = [t for t in PICTURES if t <= duration] or [duration]
    jobs = []
    for target, model in reversed(cases):  # the longest first, so that both processes end together
        many = 0 if model in ONCE else runs
        jobs += [(target, model, k, duration, pictures if k == 0 else ()) for k in range(many + 1)]
    done = runAll(makeRun, jobs, workers, "captures")
    result = {case: [r for r in done if (r.target, r.model) == case] for case in cases}
    table(result, folder)
    answer = differences(result, folder / "differences.csv")
    conclude(answer)
    main_ = {case: r for case, r in result.items() if case[1] in models}
    for target in targets:
        plotBullet(main_, target, folder / f"bullet-{target}.png")
        plotPictures(main_, target, folder / f"pictures-{target}.png")
    plotPenetration(result, folder / "penetration.png")
    return result


def conclude(answer):
    """Says how differences between models compare with those inside one."""
    print()
    for (target, until), (inside, between) in answer.items():
        if inside and between:
            a, b = ([100 * x for x in part] for part in (between, inside))
            print(
                f"{target}, up to {until} s: between models {min(a):.2f} to {max(a):.2f} cm, inside one "
                f"model {min(b):.2f} to {max(b):.2f} cm; the study: 6 cm"
            )


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="short form, under a minute")
    parser.add_argument("--runs", type=int, default=RUNS, help="perturbed runs a case")
    addOption(parser)
    parser.add_argument("--time", type=float, default=DURATION, help="to simulate [s]")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/net-study"))
    return parser.parse_args()


def main():
    args = arguments()
    args.out.mkdir(parents=True, exist_ok=True)
    given.head()
    start = time.perf_counter()
    if args.quick:
        study(args.out, 1, args.workers, 0.9, ("ball",), ("springs 0", "ANCF 1"), more=False)
    else:
        study(args.out, args.runs, args.workers, args.time, TARGETS, MODELS)
    print(f"\nit took {time.perf_counter() - start:.0f} s; results are in {args.out}/")


if __name__ == "__main__":
    main()
