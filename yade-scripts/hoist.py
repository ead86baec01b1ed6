"""A mine hoist: a cage on a heavy rope is let down by a drum, hauled up, and stopped by the brake on its way down again.

The mass of the rope grows with what is outside: tension at the drum against (M + rho A s)(g + a), how far the rope is
stretched at the bottom, the way of the emergency stop, and how fast the cage swings after it, each against theory.
Run it by `/usr/bin/python3 hoist.py`; --help tells the options. Results go to out/.
"""

import argparse
import math
import sys

import numpy as np
from scipy.optimize import brentq

import ancf
import grains
from yade import O, Vector3, utils

# ---- parameters, SI units ----------------------------------------------------------------------
GRAVITY = 9.81
ROPE = 0.03  # diameter [m]; of steel wires, with the air between them:
ROPE_YOUNG, ROPE_DENSITY = 1e11, 7000  # [Pa], [kg/m3]
ROPE_DAMPING = 5e-3  # Kelvin-Voigt time [s]
PART = 10.0  # length of its elements [m]
CAGE = dict(mass=5000.0, radius=1.0)  # [kg], [m]
TOP, BOTTOM, STOP = (
    40.0,
    400.0,
    200.0,
)  # lengths outside at the ends of the trips and at the emergency stop [m]
QUICK_BOTTOM = 220.0  # instead, with --quick
SPEED, RISE = 10.0, 10.0  # of the rope [m/s], and the time that it takes to get there [s]
FORCE = 2e5  # of the motor at most [N]
BRAKE = 9e4  # tension at which the drum slips in the emergency stop [N]
SWINGING, RESTING = 6.0, 3.0  # times after the emergency stop and at the bottom [s]
SAMPLE = 0.01  # [s]


def build():
    """The cage at the top, at rest: (rope, winch)."""
    O.reset()
    O.materials.append(
        ancf.HollarsMat(label="rope", young=ROPE_YOUNG, density=ROPE_DENSITY, poisson=0.3)
    )
    rope = ancf.Cable(
        [(0, 0, 0), (0, 0, -TOP)],
        midPoints=round(TOP / PART) - 1,
        model="springs",
        diameter=ROPE,
        material="rope",
        damping=ROPE_DAMPING,
        contactPoints=0,
    )
    winch = ancf.Winch(rope, BOTTOM - TOP + PART)
    rope.fix(0)
    cage = utils.sphere((0, 0, -TOP), CAGE["radius"], material="rope")
    cage.state.mass = CAGE["mass"]
    cage.state.inertia = Vector3(1, 1, 1) * 0.4 * CAGE["mass"] * CAGE["radius"] ** 2
    rope.carry(1, O.bodies.append(cage))
    O.engines = ancf.engines(rope, gravity=(0, 0, -GRAVITY))
    ancf.check()
    rope.relax()
    return rope, winch


def trip(way, start):
    """Speed [m/s] and acceleration [m/s2] of a trip of so long a way [m] as functions of the time [s], and its duration."""
    fast = min(SPEED, way / RISE)
    cruise = way / fast - RISE  # between the rise and the fall of the speed [s]
    duration = 2 * RISE + cruise

    def phase(t):
        t -= start
        return min(max(0.0, t), RISE) - min(max(0.0, t - RISE - cruise), RISE)

    def speed(t):
        return fast * 0.5 * (1 - math.cos(math.pi * phase(t) / RISE))

    def acceleration(t):
        sign = 1 if t - start < RISE + cruise / 2 else -1
        return sign * fast * 0.5 * math.pi / RISE * math.sin(math.pi * phase(t) / RISE)

    return speed, acceleration, duration


class Hoist:
    """The cage's trips and what is measured in them."""

    def __init__(self, bottom):
        self.rope, self.winch = build()
        self.bottom = bottom
        self.line = self.rope.section.rhoA  # mass of a metre
        self.rows = (
            []
        )  # time, length, tension, acceleration as the drum's law is or nan, depth of the cage
        self.acceleration = lambda t: 0.0

    def go(self, until):
        """Steps until it returns True."""
        every = max(1, round(SAMPLE / O.dt))
        while not until():
            for _ in range(every):
                O.step()
            a = self.acceleration(O.time - O.dt / 2)
            depth = -self.rope.knots[1][2]
            self.rows.append((O.time, self.winch.length, self.winch.tension, a, depth))

    def wait(self, duration):
        end = O.time + duration
        self.go(lambda: O.time >= end)

    def lower(self, to, until=None):
        """Lets the cage down until there is so much outside, or until it returns True."""
        speed, down, duration = trip(to - self.winch.length, O.time)
        self.acceleration = lambda t: -down(t)
        self.winch.payOut(speed)
        end = O.time + duration
        self.go(until or (lambda: O.time >= end))
        if until is None:
            self.stand()

    def stand(self, brake=math.inf):
        """The drum stops, as far as its brake can."""
        slips = math.isfinite(brake)
        self.acceleration = (lambda t: math.nan) if slips else (lambda t: 0.0)
        self.winch.hold(brake)

    def stop(self):
        """Emergency: the brake falls in. Where it does, where the drum stands, and the speed before."""
        at, speed = self.winch.length, self.winch.rate
        self.stand(BRAKE)
        self.go(lambda: self.winch.state() == "holds")
        return at, self.winch.length, speed

    def raiseTo(self, to):
        speed, self.acceleration, duration = trip(self.winch.length - to, O.time)
        self.winch.haul(speed, FORCE)
        self.wait(duration)
        self.stand()

    def column(self, k):
        return np.array([row[k] for row in self.rows])

    def mass(self, length):
        """Mass of the cage and of so much rope [kg]."""
        return CAGE["mass"] + self.line * length

    def law(self):
        """Tension of a rope that does not stretch [N]."""
        return self.mass(self.column(1)) * (GRAVITY + self.column(3))

    def run(self):
        self.lower(self.bottom)
        begin = len(self.rows)
        self.wait(RESTING)
        self.below = self.column(4)[begin:].mean()
        self.raiseTo(TOP)
        self.wait(RESTING)
        self.trips = slice(0, len(self.rows))
        self.lower(self.bottom, lambda: self.winch.length >= STOP)
        self.stopped = self.stop()
        begin = len(self.rows)
        self.wait(SWINGING)
        self.swung = slice(begin, len(self.rows))
        return self

    # ---- theory ----------------------------------------------------------------------------------

    def stoppingWay(self):
        """Rope that runs out until the brake has stopped it, from m v dv/ds = m g - F with m = M + rho A s [m]."""
        at, _, speed = self.stopped
        heavy = self.mass(at)

        def left(way):
            more = math.log1p(self.line * way / heavy)
            return 0.5 * speed**2 + GRAVITY * way - BRAKE / self.line * more

        return brentq(left, 0.0, speed**2)

    def swing(self, length):
        """Lowest frequency of a rod with a mass at its end [Hz]: x tan x = rho A s / M, f = x c / (2 pi s)."""
        heavy = self.line * length / CAGE["mass"]
        x = brentq(lambda x: x * math.tan(x) - heavy, 0.0, 1.57)
        return x * math.sqrt(ROPE_YOUNG / ROPE_DENSITY) / (2 * math.pi * length)

    def measuredSwing(self):
        """Frequency of the tension after the emergency stop [Hz], by its zero crossings."""
        time, tension = self.column(0)[self.swung], self.column(2)[self.swung]
        off = tension - self.mass(self.stopped[1]) * GRAVITY
        up = np.nonzero((off[:-1] < 0) & (off[1:] >= 0))[0]
        cross = time[up] - off[up] * (time[up + 1] - time[up]) / (off[up + 1] - off[up])
        return (len(cross) - 1) / (cross[-1] - cross[0])

    def stretched(self):
        """How far a rope at rest is longer than unstressed [m]."""
        s = self.bottom
        tension = GRAVITY * (CAGE["mass"] + self.line * s / 2)
        return tension * s / (ROPE_YOUNG * math.pi / 4 * ROPE**2)


def study(quick=False):
    """Runs it; returns Hoist and its Summary."""
    out, cost = grains.Summary(), grains.Cost()
    hoist = Hoist(QUICK_BOTTOM if quick else BOTTOM).run()
    cost.stop()
    tension, law = hoist.column(2)[hoist.trips], hoist.law()[hoist.trips]
    at, end, _ = hoist.stopped
    out.tell("largest tension", hoist.column(2).max() / 1e3, "kN")
    out.tell("tension in trips / law, least", (tension / law).min(), least=0.97, most=1.03)
    out.tell("tension in trips / law, most", (tension / law).max(), least=0.97, most=1.03)
    out.tell("emergency stop, way", end - at, "m")
    out.tell("way / theory", (end - at) / hoist.stoppingWay(), least=0.97, most=1.03)
    swing = hoist.measuredSwing()
    out.tell("swings after it at", swing, "Hz")
    out.tell("frequency / theory", swing / hoist.swing(end), least=0.99, most=1.01)
    out.tell("stretch at the bottom", hoist.below - hoist.bottom, "m")
    stretch = (hoist.below - hoist.bottom) / hoist.stretched()
    out.tell("stretch / theory", stretch, least=0.99, most=1.01)
    cost.report()
    return hoist, out


def plot(hoist, path):
    from ancf.plots import plt

    figure, axes = plt.subplots(2, 1, figsize=(6, 5), sharex=True, constrained_layout=True)
    time = hoist.column(0)
    axes[0].plot(time, hoist.column(1))
    axes[0].invert_yaxis()
    axes[0].set_ylabel("rope outside [m]")
    axes[1].plot(time, hoist.column(2) / 1e3, lw=0.8, label="at the drum")
    axes[1].plot(time, hoist.law() / 1e3, "k--", lw=0.8, label=r"$(M+\rho A s)(g+a)$")
    axes[1].set_ylabel("tension [kN]")
    axes[1].set_xlabel("time [s]")
    axes[1].legend(fontsize=8)
    for ax in axes:
        ax.grid(alpha=0.3)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a shaft of 220 m")
    args = grains.options(parser)
    hoist, out = study(args.quick)
    if not args.no_pictures:
        plot(hoist, args.out / "hoist.png")
    return out.code


if __name__ == "__main__":
    sys.exit(main())
