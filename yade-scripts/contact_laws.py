"""What a contact does: normal force against penetration, friction against tangential velocity.

Draws Fig. 7 and Fig. 8 of Shan, Guo, Gill 2019 (doi 10.1016/j.asr.2019.10.041) from the forces that
act on two bodies in YADE while one hits the other, or is drawn over it. Run it by `/usr/bin/python3
contact_laws.py`; results go to out/contact-laws/.
"""

import argparse
import pathlib

import numpy as np

import ancf
import ball_capture as given
from ancf.plots import plt
from yade import O, Vector3, utils
from yade.wrapper import (
    Bo1_Box_Aabb,
    Bo1_Sphere_Aabb,
    ForceResetter,
    Ig2_Box_Sphere_ScGeom,
    InsertionSortCollider,
    InteractionLoop,
    NewtonIntegrator,
)

# ---- parameters, SI units ----------------------------------------------------------------------
RADIUS = 0.01  # of the ball [m]
MASS = 0.05  # of the ball [kg]
SPEED = 1.5  # of the impact [m/s]
ALPHAS = (0.08, 0.16, 0.24, 0.32)  # of the nonlinear damping [s/m]
LINEAR_STIFFNESS = 5.0e5  # of the spring-dashpot [N/m]
DASHPOTS = (5.0, 20.0)  # its damping [N s/m]
STEPS = 2000  # of an impact
FRICTION = ((0.3, 0.2), (0.3, 0.3), (0.5, 0.2))  # mu_s, mu_k
TRANSITION = 1e-3  # [m/s]
DEPTH = 1e-5  # at which bodies are drawn over each other [m]
FASTEST = 10 * TRANSITION  # [m/s]


def material(**values):
    O.materials.append(given.material("m", **{"impactDamping": 0.0, **values}))


def engines(**law):
    return [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Box_Aabb()], verletDist=RADIUS),
        InteractionLoop(
            [Ig2_Box_Sphere_ScGeom()],
            [ancf.Ip2_HollarsMat_HollarsMat_HollarsPhys()],
            [ancf.Law2_ScGeom_HollarsPhys_Hollars(**law)],
        ),
        NewtonIntegrator(damping=0),
    ]


def impact(normal, duration, **values):
    """A ball hits a fixed box. Returns penetration [m] and force on the ball [N] in every step, and
    the coefficient of restitution.
    """
    O.reset()
    material(**values)
    O.bodies.append(utils.box((0, 0, -0.1), (0.1, 0.1, 0.1), material="m", fixed=True))
    ball = utils.sphere((0, 0, RADIUS), RADIUS, material="m")
    ball.state.mass, ball.state.inertia = MASS, 0.4 * MASS * RADIUS**2 * Vector3(1, 1, 1)
    ball.state.vel = Vector3(0, 0, -SPEED)
    number = O.bodies.append(ball)
    O.engines = engines(normal=normal, friction="none")
    O.dt = duration / STEPS
    depth, force = [], []
    for _ in range(3 * STEPS):
        O.step()
        contact = [i for i in O.interactions if i.isReal]
        if contact and O.forces.f(number)[2] != 0:
            depth.append(contact[0].geom.penetrationDepth)
            force.append(O.forces.f(number)[2])
        elif depth:
            break
    return np.array(depth), np.array(force), ball.state.vel[2] / SPEED


def impacts():
    """{label: (depth, force, restitution)} of all laws."""
    hertz = 3e-4  # about the time that an impact takes [s]
    found = {"Hertz": impact("hertz", hertz)}
    for alpha in ALPHAS:
        label = f"nonlinear damping, α = {alpha} s/m"
        found[label] = impact("nonlinear", hertz, impactDamping=alpha)
    for c in DASHPOTS:
        values = dict(normalStiffness=LINEAR_STIFFNESS, normalExponent=1.0, dashpot=c)
        found[f"spring-dashpot, c = {c:g} N s/m"] = impact("linear", 1e-3, **values)
    return found


def drawnBall(friction, mu, speeds):
    """Friction on a ball over normal force while it is drawn over a box at some speeds."""
    O.reset()
    material(staticFriction=mu[0], kineticFriction=mu[1], transitionVelocity=TRANSITION)
    O.bodies.append(utils.box((0, 0, -0.1), (0.1, 0.1, 0.1), material="m", fixed=True))
    ball = O.bodies.append(utils.sphere((0, 0, RADIUS - DEPTH), RADIUS, material="m", fixed=True))
    O.bodies[ball].dynamic = True
    O.bodies[ball].state.blockedDOFs = "xyzXYZ"
    O.engines = engines(friction=friction)
    O.dt = 1e-6
    return drawn(ball, speeds)


def drawnBox(mu, speeds):
    """The same on a cable that is held, and a box that is drawn along below it."""
    O.reset()
    material(staticFriction=mu[0], kineticFriction=mu[1], transitionVelocity=TRANSITION)
    box = O.bodies.append(utils.box((0, 0, -0.1), (0.5, 0.1, 0.1), material="m", fixed=True))
    O.bodies[box].dynamic = True
    O.bodies[box].state.blockedDOFs = "xyzXYZ"
    z = 5e-4 - DEPTH
    cable = ancf.Cable([(-0.02, 0, z), (0.02, 0, z)], diameter=1e-3, material="m", contactPoints=3)
    cable.fix(0)
    cable.fix(-1)
    cable.setVelocity(lambda p: Vector3(0, 0, 0))
    O.engines = ancf.engines(cable)
    state = list(cable.engine.position)

    def again():  # the cable's inner points would give way
        cable.engine.position = state
        cable.engine.velocity = [0.0] * len(state)

    O.dt = 1e-12  # so that the cable has no time to follow the box
    return drawn(box, speeds, again)


def drawn(number, speeds, before=None):
    """Tangential over normal force on a body at each speed [m/s] along x."""
    ratio = []
    for speed in speeds:
        O.bodies[number].state.vel = Vector3(speed, 0, 0)
        for _ in range(3):
            if before:
                before()
            O.step()
        force = O.forces.f(number)
        ratio.append(-force[0] / abs(force[2]))
    return np.array(ratio)


def plot(folder):
    figure, axes = plt.subplots(1, 2, figsize=(13, 4.8))
    for label, (depth, force, e) in impacts().items():
        style = dict(lw=1.5, color="k") if label == "Hertz" else dict(lw=1.2)
        if label.startswith("spring"):
            style["ls"] = "--"
        axes[0].plot(1e3 * depth, force, label=f"{label}: restitution {e:.2f}", **style)
    axes[0].set_xlabel("penetration [mm]")
    axes[0].set_ylabel("force on the ball [N]")
    axes[0].set_title(f"a ball of {MASS} kg hits a box at {SPEED} m/s (Fig. 7)", fontsize=11)
    axes[0].legend(fontsize=8)
    speeds = np.linspace(-FASTEST, FASTEST, 401)
    for mu in FRICTION:
        ratio = drawnBall("hollars", mu, speeds)
        axes[1].plot(
            speeds / TRANSITION,
            ratio,
            lw=1.4,
            label=f"Hollars, $\\mu_s$ = {mu[0]}, $\\mu_k$ = {mu[1]}",
        )
    axes[1].plot(
        speeds / TRANSITION,
        drawnBall("coulomb", FRICTION[0], speeds),
        "k--",
        lw=1,
        label="Coulomb, $\\mu_k$ = 0.2",
    )
    few = speeds[10::20]
    axes[1].plot(
        few / TRANSITION,
        drawnBox(FRICTION[0], few),
        "o",
        ms=3,
        color="0.3",
        label="Hollars, box under a held cable",
    )
    axes[1].set_xlabel("tangential velocity / $v_{t0}$")
    axes[1].set_ylabel("friction on what is drawn / normal force")
    axes[1].set_title("a ball drawn over a box, a box under a cable (Fig. 8)", fontsize=11)
    axes[1].legend(fontsize=8)
    for ax in axes:
        ax.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(folder / "contact-laws.png", dpi=100)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="no difference: it takes seconds")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/contact-laws"))
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    plot(args.out)
    print(f"figures: {args.out}/contact-laws.png")


if __name__ == "__main__":
    main()
