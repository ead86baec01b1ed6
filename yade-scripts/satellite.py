"""A whole mission: a free, tumbling satellite is caught by a net, a closing line draws its mouth shut, and the chaser
tows it away by a tether.

The net flies from the chaser, opened by four bullets; a winch in one of them draws the line through the rings of its
rim when the mouth has passed the satellite; then the chaser's engine burns for a minute. Nothing else acts: the momentum of
all is the thrust's, and until the burn the angular momentum is what it was. Both are checked. Run it by
`/usr/bin/python3 satellite.py`; results go to out/satellite/.
"""

import argparse
import csv
import pathlib
import sys

import numpy as np

import ancf
import ancf.render
from ancf.capture import Capture
from yade import O, Quaternion, Vector3, utils

# ---- parameters, SI units ------------------------------------------------------------------------
MESHES, MESH_LENGTH = 6, 0.14  # of the net, a side [m]
CORD = dict(young=5e7, density=1140)  # braided polyamide [Pa], [kg/m3]
CONTACT = dict(staticFriction=0.3, kineticFriction=0.2, transitionVelocity=1e-3, impactDamping=0.3)
DIAMETER = 1.5e-3  # of its cables [m]
DAMPING = 2e-4  # Kelvin-Voigt time of its cables [s]
BULLETS = dict(mass=0.1, radius=0.012, speed=2.0)  # [kg], [m], [m/s]
ANGLE = 30.0  # of the bullets [deg]
DISTANCE = 1.4  # from the net to the satellite [m]
BODY = (0.16, 0.16, 0.2)  # of the satellite: sides [m]
PANEL = (0.01, 0.18, 0.12)  # of each of its two panels [m]
SPIN = (0.25, 0.15, 0.4)  # of the satellite at the start [rad/s]
CHASER = dict(mass=20.0, radius=0.15)  # [kg], [m]
BEHIND = 0.4  # the chaser, from the net [m]
CLOSE = dict(speed=3.0, force=8.0)  # of the winch [m/s], [N]
CLOSED = 0.25  # part of the rim's length to which it draws the line
HELD = 0.25  # mouth, and share of the satellite that is not enclosed, at most
TOWED = 0.02  # by which the tether's mean tension in the last 10 s differs from thrust x mass ratio, at most
EXACT = 1e-8  # changes of momentum [kg m/s] and angular momentum [kg m2/s] without a cause, at most
BURN, THRUST, BURNING = 3.0, 2.0, 60.0  # start [s], force [N] and duration [s] of the towing
TETHER = 2.6  # unstressed length [m]
STRIP = (0.3, 0.8, 1.1, 1.5, 3.0, 8.0)  # times of its pictures [s]
SAMPLE = 0.01  # [s]; when towing five times as much
CATCHING = 0.25  # part of the step of engines() until the burn: energy is off by 0.1 %, by up to 2 % with whole ones


# ---- the scene -----------------------------------------------------------------------------------


def satellite():
    """Id of a clump: a box with a panel on either side, turned and tumbling."""
    reach, turn = 0.5 * (BODY[1] + PANEL[1]), Quaternion(Vector3(0.7, 0.7, 0.1).normalized(), 0.5)
    members = []
    for size, y in ((BODY, 0.0), (PANEL, reach), (PANEL, -reach)):
        place = Vector3(DISTANCE, 0, 0) + turn * Vector3(0, y, 0)
        half = Vector3(*size) / 2
        members.append(O.bodies.append(utils.box(place, half, orientation=turn, material="hull")))
    clump = O.bodies.clump(members)
    state = O.bodies[clump].state
    state.angVel = Vector3(*SPIN)
    state.angMom = angularMomentum(state)
    return clump


def angularMomentum(state):
    """Of a body about its centre, from its spin [kg m2/s]."""
    spin = state.ori.conjugate() * state.angVel
    return state.ori * Vector3(*(i * w for i, w in zip(state.inertia, spin)))


def chaser():
    body = O.bodies.append(
        utils.sphere((-BEHIND - CHASER["radius"], 0, 0), CHASER["radius"], material="hull")
    )
    state = O.bodies[body].state
    state.mass = CHASER["mass"]
    state.inertia = Vector3(1, 1, 1) * 0.4 * CHASER["mass"] * CHASER["radius"] ** 2
    return body


class Mission:
    """The scene, and what is measured in it."""

    def __init__(self):
        O.reset()
        O.materials.append(ancf.HollarsMat(label="cord", poisson=0.3, **CORD, **CONTACT))
        O.materials.append(
            ancf.HollarsMat(label="hull", young=3e8, poisson=0.33, density=800, **CONTACT)
        )
        self.satellite, self.chaser = satellite(), chaser()
        self.net = ancf.Net.square(
            MESHES,
            MESH_LENGTH,
            diameter=DIAMETER,
            material="cord",
            damping=DAMPING,
            mass="lumped",
            normal=(1, 0, 0),
            fold=0.15,
        )
        self.net.addBullets(angle=np.radians(ANGLE), **BULLETS)
        self.around = 4 * MESHES * MESH_LENGTH
        rings = [*self.net.rim[::2], self.net.rim[0]]  # from a bullet and back to it
        self.line = ancf.Line(
            [(self.net, knot) for knot in rings],
            diameter=DIAMETER,
            material="cord",
            length=1.02 * self.around,
            label="closing line",
        )
        middle = (MESHES + 1) ** 2 // 2
        side = Vector3(CHASER["radius"], 0, 0)
        self.tether = ancf.Line(
            [(self.chaser, tuple(side)), (self.net, middle)],
            diameter=2 * DIAMETER,
            material="cord",
            length=TETHER,
            label="tether",
        )
        O.engines = ancf.engines(self.net, self.line, self.tether)
        O.dt *= CATCHING
        ancf.check()
        self.capture = Capture(self.net, self.satellite)
        self.start = self.momenta()
        self.rows, self.closing, self.burning = [], None, None

    # ---- control ---------------------------------------------------------------------------------

    def command(self):
        """What the chaser's computer decides, at every sample."""
        if self.closing is None and self.capture.beyond[-1] == 1:
            self.closing = O.time
            self.line.haul(CLOSE["speed"], CLOSE["force"], to=CLOSED * self.around)
        if self.burning is None and O.time >= BURN:
            self.burning = O.time
            O.forces.setPermF(self.chaser, Vector3(-THRUST, 0, 0))
            O.dt /= CATCHING

    # ---- measures --------------------------------------------------------------------------------

    def momenta(self):
        """Momentum and angular momentum about the origin of everything."""
        linear, angular = self.net.engine.momentum()
        for body in (self.satellite, self.chaser):
            state = O.bodies[body].state
            turning = state.angMom if body == self.satellite else angularMomentum(state)
            linear += state.mass * state.vel
            angular += turning + state.pos.cross(state.mass * state.vel)
        for bullet in self.net.bullets:  # the engine counts them as points
            angular += angularMomentum(O.bodies[bullet].state)
        return linear, angular

    def sample(self):
        state = O.bodies[self.satellite].state
        linear, angular = (now - start for now, start in zip(self.momenta(), self.start))
        burnt = 0.0 if self.burning is None else THRUST * (O.time - self.burning)
        self.rows.append(
            dict(
                time=O.time,
                tether=self.tether.tensions[0],
                closing=self.line.tensions.max(),
                left=self.line.length,
                spin=state.angVel.norm(),
                speed=state.vel[0],
                pushed=(linear + Vector3(burnt, 0, 0)).norm(),  # besides the thrust
                turned=angular.norm(),
            )
        )

    def run(self, duration, pictures):
        """Flies the mission: samples, decides. Returns a film of all and one of the net, or None."""
        everything = [self.net, self.line, self.tether]
        film = ancf.render.Film(everything, [self.satellite, self.chaser]) if pictures else None
        closer = ancf.render.Film([self.net, self.line], [self.satellite]) if pictures else None
        times = [time for time in STRIP if time <= duration]
        self.capture.sample()
        self.sample()
        for i, _ in enumerate(ancf.progress(duration, SAMPLE, "mission")):
            near = self.burning is None
            if near or i % 5 == 0:
                self.capture.sample()
                self.sample()
                self.command()
            if film and i % (4 if near else 50) == 0:
                film.take()
            if closer and times and O.time >= times[0]:
                closer.take()
                times.pop(0)
        return film, closer

    def column(self, name):
        return np.array([row[name] for row in self.rows])

    def report(self):
        """Prints what came out; True if the satellite was caught, is held, and is towed steadily once it has been for long,
        and no momentum came from nowhere.
        """
        row, time = self.capture.row(), self.column("time")
        towing = time > time[-1] - 10
        mass = sum(O.bodies[b].state.mass for b in (self.satellite, self.chaser))
        mass += self.net.mass + 4 * BULLETS["mass"]
        caught = 1 - CHASER["mass"] / mass  # share of the mass that the tether pulls
        pushed, turned = self.column("pushed").max(), self.column("turned")[time < BURN].max()
        mean = self.column("tether")[towing].mean()
        held = row["mouth_end"] < HELD and row["enclosed_end"] > 1 - HELD
        towed = abs(mean / (THRUST * caught) - 1) < TOWED
        exact = max(pushed, turned) < EXACT
        if row["contact_s"] is not None:
            print(f"first contact        {row['contact_s']:.3f} s")
        if self.closing is not None:
            print(f"closing line drawn   from {self.closing:.3f} s,", end=" ")
            print(f"{self.line.length:.3f} m left, winch {self.line.winch()}")
        print(f"at the end           mouth {100 * row['mouth_end']:.1f} %,", end=" ")
        print(f"{100 * row['enclosed_end']:.0f} % enclosed")
        print(f"spin of the satellite {self.rows[0]['spin']:.3f} rad/s,", end=" ")
        print(f"at the end {self.rows[-1]['spin']:.3f} rad/s")
        print(f"tether               {mean:.3f} N in the last 10 s,", end=" ")
        print(f"thrust x mass ratio {THRUST * caught:.3f} N")
        print(f"momentum             off the thrust's by {pushed:.1e} kg m/s")
        print(f"angular momentum     kept until the burn within {turned:.1e} kg m2/s")
        print(f"step                 {O.dt:.3g} s, {O.iter} steps")
        if not exact:
            print("=> momentum NOT kept")
        what = "caught, closed and towed" if towed else "caught and closed, not yet towed steadily"
        print(f"=> {what if held else 'NOT held'}", flush=True)
        return held and exact and (towed or O.time < BURN + 0.5 * BURNING)

    def save(self, folder):
        with open(folder / "mission.csv", "w", newline="", encoding="utf-8") as file:
            out = csv.DictWriter(file, self.rows[0])
            out.writeheader()
            out.writerows(self.rows)

    def plot(self, path):
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots(3, 1, figsize=(7, 7), sharex=True, layout="constrained")
        time = self.column("time")
        axes[0].plot(time, self.column("tether"), label="tether")
        axes[0].plot(time, self.column("closing"), label="closing line")
        axes[0].set_ylabel("tension [N]")
        axes[0].legend()
        axes[1].plot(time, self.column("spin"))
        axes[1].set_ylabel("spin of the satellite [rad/s]")
        axes[2].plot(time, self.column("speed"))
        axes[2].set_ylabel("its speed along x [m/s]")
        axes[2].set_xlabel("time [s]")
        figure.savefig(path, dpi=150)
        plt.close(figure)


def options():
    parser = argparse.ArgumentParser(description=" ".join(__doc__.split("\n\n")[0].split()))
    parser.add_argument("--quick", action="store_true", help="tow for 2 s only, no film")
    parser.add_argument("--no-pictures", action="store_true", help="no film, strip or plots")
    parser.add_argument(
        "--out", type=pathlib.Path, default=pathlib.Path("out/satellite"), help="folder"
    )
    return parser.parse_args()


def main():
    args = options()
    args.out.mkdir(parents=True, exist_ok=True)
    duration = BURN + (2.0 if args.quick else BURNING)
    mission, pictures = Mission(), not (args.quick or args.no_pictures)
    film, closer = mission.run(duration, pictures)
    good = mission.report()
    mission.save(args.out)
    if pictures:
        mission.plot(args.out / "mission.png")
        closer.strip(args.out / "strip.png", STRIP, cell=(420, 420))
        print("film                ", film.animate(args.out / "mission.mp4", follow=True))
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
