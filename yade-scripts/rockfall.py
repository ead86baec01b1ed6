"""A rockfall drape stops a block: forces of its anchors over time, and where the block's energy goes.

A net of wire ropes hangs by its four corners from absorbers, ropes that yield and damp. A block of 50 kg flies
into it at 10 m/s, is stopped, and falls to the ground in front of it. Run it by `/usr/bin/python3 rockfall.py`;
--help tells the options. Results go to out/.
"""

import argparse
import sys

import numpy as np

import ancf
import grains
from yade import O, Vector3, utils

# ---- parameters, SI units ----------------------------------------------------------------------
GRAVITY = 9.81
MESHES, MESH, MIDDLE = 12, 0.25, 2.0  # a side, [m], height of the middle [m]
ROPE = 8e-3  # diameter [m]
ROPE_YOUNG, ROPE_DENSITY = 5e10, 4500  # of the full round, of which wires fill 60 % [Pa], [kg/m3]
ROPE_DAMPING = 1e-5  # Kelvin-Voigt time of the ropes [s]
ABSORBER_LENGTH, ABSORBER = 0.6, 0.03  # length, diameter [m]
STIFFNESS, DAMPING = 8e3, 0.2  # of an absorber [N/m] and its Kelvin-Voigt time [s]: 1.6 kN s/m
BLOCK, SPEED = 50.0, 10.0  # mass [kg], [m/s]
HALF, HEIGHT = 0.085, 1.6  # radius of its eight balls, height of its middle [m]
ROCK_YOUNG = 3e9  # a tenth of rock's; the contacts with ropes take steps of their own [Pa]
STATIC, KINETIC, TRANSITION, ALPHA = 0.4, 0.35, 1e-2, 0.2
DURATION, QUICK_DURATION = 1.6, 0.45  # [s]
SAMPLE = 1e-3  # [s]

ACCOUNTS = {
    "kinetic": "block moves",
    "cableKinetic": "net moves",
    "cableHalfStep": "net, half kicks",
    "cableElastic": "net and absorbers, strain",
    "contactElastic": "contacts, strain",
    "cableDamping": "damped in net and absorbers",
    "contactDamping": "damped in contacts",
    "cableFriction": "friction of ropes on the block",
    "contactFriction": "friction of block on ground",
    "gravWork": "lifted",
}


def materials():
    rock = dict(
        poisson=0.25,
        staticFriction=STATIC,
        kineticFriction=KINETIC,
        transitionVelocity=TRANSITION,
        impactDamping=ALPHA,
    )
    absorbs = STIFFNESS * ABSORBER_LENGTH / (np.pi * ABSORBER**2 / 4)
    for label, young, density in (
        ("rope", ROPE_YOUNG, ROPE_DENSITY),
        ("rock", ROCK_YOUNG, 2600),
        ("absorber", absorbs, 1100),
    ):
        O.materials.append(ancf.HollarsMat(label=label, young=young, density=density, **rock))


def build():
    """The scene at its start: (net, absorbers, block, ground)."""
    O.reset()
    materials()
    net = ancf.Net.square(
        MESHES,
        MESH,
        diameter=ROPE,
        material="rope",
        damping=ROPE_DAMPING,
        mass="lumped",
        center=(0, 0, MIDDLE),
        normal=(1, 0, 0),
    )
    absorbers = []
    for corner in net.corners:
        start = net.knots[corner]
        out = np.sign(start - [0, 0, MIDDLE]) / np.sqrt(2)
        absorber = ancf.Cable(
            [start, start + ABSORBER_LENGTH * out],
            model="springs",
            diameter=ABSORBER,
            material="absorber",
            damping=DAMPING,
            contactPoints=0,
        )
        absorber.tie(0, net, corner)
        absorber.fix(-1)
        absorbers.append(absorber)
    O.engines = ancf.engines(net, *absorbers, gravity=(0, 0, -GRAVITY))
    net.relax(1e-6)
    ground = utils.box((0, 0, -0.1), (8, 6, 0.1), material="rock", fixed=True)
    ground = O.bodies.append(ground)
    block = fly()
    O.dt = ancf.timeStep(speed=SPEED)
    ancf.check()
    return net, absorbers, block, ground


def fly():
    """The block, eight balls at the corners of a cube, just before the net. Returns its id."""
    middle = np.array([-2 * HALF - ROPE, 0.0, HEIGHT])
    corners = [HALF * np.array([i, j, k]) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]
    balls = [utils.sphere(middle + c, HALF, material="rock") for c in corners]
    block = O.bodies.appendClumped(balls)[0]
    state = O.bodies[block].state
    state.inertia = state.inertia * (BLOCK / state.mass)
    state.mass = BLOCK
    state.vel = Vector3(SPEED, 0, 0)
    return block


class Stop:
    """One run and what is measured in it."""

    def __init__(self, pictures=False):
        self.net, self.absorbers, self.block, self.ground = build()
        self.time, self.anchors, self.place, self.energy = [], [], [], []
        self.impulse, self.film = np.zeros(3), None
        if pictures:
            from ancf.render import Film

            balls = O.bodies[self.block].shape.members
            self.film = Film([self.net, *self.absorbers], dict.fromkeys(balls, "#8d8371"))
        O.trackEnergy = True
        O.step()
        self.momentum, self.since = self._momentum(), O.time

    def forces(self):
        """Of each anchor on the net (4, 3) [N]."""
        return np.array([list(a.reaction(-1)) for a in self.absorbers])

    def _momentum(self):
        """Of block and net (3) [kg m/s]."""
        moved = np.array(list(self.net.engine.momentum()[0]))
        return moved + BLOCK * np.array(list(O.bodies[self.block].state.vel))

    def run(self, duration):
        every = max(1, round(SAMPLE / O.dt))
        for k, _ in enumerate(ancf.progress(duration, O.dt, "rockfall")):
            forces = self.forces()
            self.impulse += O.dt * (forces.sum(axis=0) - grains.force(self.ground))
            if k % every:
                continue
            self.time.append(O.time)
            self.anchors.append(np.linalg.norm(forces, axis=1))
            self.place.append(list(O.bodies[self.block].state.pos))
            self.energy.append({name: O.energy[name] for name in O.energy.keys()})
            if self.film and k % (20 * every) == 0:
                self.film.take()
        return self

    @property
    def far(self):
        """How far the net lets the block go [m]."""
        return max(p[0] for p in self.place)

    def impulseOff(self):
        """What the impulse of all forces differs by from the change of momentum, as part of the block's at
        the start.
        """
        mass = BLOCK + self.net.mass + sum(a.mass for a in self.absorbers)
        weight = np.array([0, 0, -GRAVITY * mass]) * (O.time - self.since)
        off = self.impulse + weight - (self._momentum() - self.momentum)
        return float(np.abs(off).max() / (BLOCK * SPEED))


def study(quick=False, pictures=False):
    """Runs it; returns Stop and its Summary."""
    stop, out = Stop(pictures), grains.Summary()
    start = 0.5 * BLOCK * SPEED**2
    cost = grains.Cost()
    stop.run(QUICK_DURATION if quick else DURATION)
    cost.stop()
    total = [sum(e.values()) for e in stop.energy]
    back = O.bodies[stop.block].state.vel
    out.tell("farthest place of the block, behind the net", stop.far, "m", most=2.5)
    out.tell("speed at the end, along", back[0], "m/s", least=-0.6 * SPEED, most=0.0)
    out.tell("largest force of an anchor", np.max(stop.anchors), "N")
    out.tell("energy, off by", np.abs(np.array(total) / total[0] - 1).max(), most=0.01)
    out.tell("impulse against momentum, off by", stop.impulseOff(), most=1e-3)
    print(f"where the {start:.0f} J of the block are, {O.time:.2f} s later:")
    last = stop.energy[-1]
    for name, told in ACCOUNTS.items():
        if name in last:
            print(f"    {last[name]:8.1f} J  {told}")
    print(
        f"    {total[-1]:8.1f} J  in all, {total[-1] - start:.1f} J of them strain of the net at rest"
    )
    cost.report()
    return stop, out


def plot(stop, path):
    from ancf.plots import plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 3.8), constrained_layout=True)
    for k, label in enumerate(("low", "up", "up, other side", "low, other side")):
        left.plot(stop.time, 1e-3 * np.array(stop.anchors)[:, k], lw=1, label=label)
    left.set_ylabel("force of an anchor [kN]")
    left.legend(fontsize=8)
    shown = {
        "block moves": ["kinetic"],
        "net moves": ["cableKinetic"],
        "strain": ["cableElastic", "contactElastic"],
        "damping": ["cableDamping", "contactDamping"],
        "friction": ["cableFriction", "contactFriction"],
    }
    parts = [
        [sum(e.get(name, 0.0) for name in names) for e in stop.energy] for names in shown.values()
    ]
    right.stackplot(stop.time, parts, labels=shown, alpha=0.85)
    gone = np.array([e.get("gravWork", 0.0) for e in stop.energy])
    total = np.array([sum(e.values()) for e in stop.energy])
    right.plot(stop.time, total - gone, "k", lw=1, label="total without gravity's")
    right.set_ylabel("energy [J]")
    right.set_ylim(top=1.5 * total[0])
    right.legend(fontsize=8, loc="upper left", ncols=2)
    for ax in (left, right):
        ax.set_xlabel("time [s]")
        ax.grid(alpha=0.3)
    figure.savefig(path, dpi=100)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="smaller and shorter")
    args = grains.options(parser)
    stop, out = study(args.quick, not args.no_pictures)
    if stop.film:
        from ancf.render import View

        times = [t for t in (0.0, 0.1, 0.28, 0.8) if t <= O.time]
        view = View((-0.55, 0.8, -0.15), tension=(0, 2000), ground=0.0)
        stop.film.strip(args.out / "rockfall.png", times, view)
        plot(stop, args.out / "rockfall_forces.png")
    return out.code


if __name__ == "__main__":
    sys.exit(main())
