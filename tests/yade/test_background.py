"""O.run goes on in a thread of its own: what is changed or read meanwhile, and Python called from within a step."""

import os
import subprocess
import sys
import textwrap
import traceback

import numpy as np
import pytest

import ancf
from helpers import ball, material, steps
from yade import O, Vector3

pytestmark = pytest.mark.usefixtures("scene")

# A ball lies in a net that its corners hold, and O.run goes on.
RUNNING = """
import time
import ancf
from yade import O, Vector3, utils
from yade.wrapper import *

def build():
    O.materials.append(ancf.HollarsMat(young=4e8, poisson=.3, density=1440, label="cable"))
    net = ancf.Net.square(4, .08, normal=(0, 0, 1), diameter=2e-3, material="cable", damping=1e-4)
    for corner in net.corners:
        net.fix(corner)
    body = utils.sphere(Vector3(0, 0, -.0412), .04, fixed=True, material="cable")
    O.bodies.append(body)
    O.engines = ancf.engines(net, gravity=(0, 0, -9.81))
    return net

def during(seconds, change):
    count, end = 0, time.time() + seconds
    while time.time() < end:
        change(count)
        count += 1
        time.sleep(1e-4)
    return count
"""


def inChild(code, seconds=60):
    """The last line that a process of its own prints; a signal, a hang or an exception fails."""
    program = RUNNING + textwrap.dedent(code)
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=seconds
    )
    assert done.returncode == 0, f"ended with {done.returncode}: {done.stderr[-2000:]}"
    return done.stdout.splitlines()[-1]


CHANGES = {
    "ea": "engine.ea = [ea * (1 + .01 * (i % 2)) for ea in EA]",
    "kelvinVoigt": "engine.kelvinVoigt = [1e-4 * (1 + i % 2)] * engine.nElements",
    "normal": "engine.normal = ('hertz', 'nonlinear')[i % 2]",
    "position": "engine.position = engine.position",
    "velocity": "engine.velocity = engine.velocity",
    "updateAttrs": "engine.updateAttrs(dict(ea=EA, position=engine.position))",
    "fix": "net.fix(12) if i % 2 == 0 else net.release(12)",
    "clamp": "net.clamp(0)",
    "load": "net.load(6, (0, 0, -.01 * (i % 2)))",
    "setVelocity": "net.setVelocity(lambda p: Vector3(0, 0, 0))",
    "build": "engine.build()",
    "reading": "engine.ea = EA; engine.momentum(); net.reaction(0); net.edge(0).tension(.5)",
}


@pytest.mark.parametrize("name", CHANGES)
def test_change_waits_for_the_end_of_the_step(name):
    out = inChild(
        f"""
        net = build()
        engine = net.engine
        EA = engine.ea
        def change(i):
            {CHANGES[name]}
        O.run()
        count = during(.5, change)
        running, done = O.running, O.iter
        O.pause()
        assert running, "the run ended"
        assert count > 20 and done > 20, (count, done)
        print("lives")
        """
    )
    assert out == "lives"


def test_what_yade_cannot_do_meanwhile_is_refused():
    out = inChild(
        """
        net = build()
        def other():
            return ancf.Cable([(0, 0, 1), (1, 0, 1)], 4, diameter=1e-3, material="cable")
        hung = utils.sphere(Vector3(0, 0, 1), .01, material="cable")
        O.bodies.append(hung)
        told = 0
        O.run()
        time.sleep(.1)
        for what in (
            lambda: other().append(),
            lambda: other().append(engine=net.engine),
            lambda: net.carry(12, hung.id),
            lambda: net.follow(13, hung.id),
            net.relax,
        ):
            try:
                what()
            except RuntimeError as error:
                assert "O.pause() first" in str(error), error
                told += 1
        time.sleep(.1)
        assert O.running
        O.pause()
        print(told)
        """
    )
    assert out.split() == ["5"]


def test_appended_by_a_runner_within_the_run():
    """Its thread is that of the run, where YADE can do it."""
    out = inChild(
        """
        net = build()
        def more():
            if O.iter == 20:
                other = ancf.Cable([(0, 0, 1), (1, 0, 1)], 4, diameter=1e-3, material="cable")
                other.append(engine=net.engine)
        O.engines = [PyRunner(command="more()", iterPeriod=1), *O.engines]
        O.run(100, True)
        print(net.engine.nElements, O.iter)
        """
    )
    assert out.split() == ["44", "100"]


def test_readings_are_not_torn():
    """All of a cable that flies as one is at one height at any time."""
    out = inChild(
        """
        O.materials.append(ancf.HollarsMat(young=4e8, poisson=.3, density=1440, label="cable"))
        cable = ancf.Cable([(0, 0, 0), (50, 0, 0)], 1000, diameter=1e-3, material="cable", contactPoints=0)
        cable.setVelocity(lambda p: Vector3(0, 0, 100))
        O.engines = ancf.engines(cable)
        engine, n = cable.engine, cable.nodeCount
        momentum = cable.mass * 100
        worst = [0, 0]
        def look(i):
            z = engine.position[2 * engine.stride:][:n]
            knots = cable.curve(1)[:, 2]
            for heights in (z, knots):
                worst[0] = max(worst[0], (max(heights) - min(heights)) / max(1, abs(max(heights))))
            worst[1] = max(worst[1], abs(engine.momentum()[0][2] / momentum - 1))
        O.run()
        count = during(1.5, look)
        O.pause()
        assert count > 20 and O.iter > 1000, (count, O.iter)
        print(*worst)
        """
    )
    apart, momentum = map(float, out.split())
    assert apart < 1e-9  # a step moves it by 1e-3
    assert momentum < 1e-9


def test_readings_in_the_first_step():
    inChild(
        """
        for _ in range(30):
            net = build()
            O.run()
            for _ in range(20):
                net.engine.momentum(), net.energy(), net.edge(0).tension(.5)
            O.pause()
            while O.running:
                pass
            time.sleep(.005)
            O.reset()
        print("lives")
        """
    )


@pytest.mark.parametrize("pause", ["O.pause()", ""])
def test_reset_while_it_runs(pause):
    """No step waits for Python, which O.reset holds. (Before its first step, a run may not have begun,
    where YADE itself ends.)
    """
    out = inChild(
        f"""
        for i in range(20):
            net = build()
            O.run()
            while O.iter == 0:
                time.sleep(1e-4)
            time.sleep(.002 * (i % 4))
            {pause}
            O.reset()
        print("lives")
        """
    )
    assert out == "lives"


def test_saved_while_it_runs(tmp_path):
    inChild(
        f"""
        net = build()
        O.run()
        during(.5, lambda i: O.save({str(tmp_path / 'a.xml')!r}))
        O.pause()
        print("lives")
        """
    )


# ---- functions of time that change what they are called in ------------------------------------------


@pytest.fixture
def driven():
    """A cable between a fixed end and a body on a guide, whose motion is set by the test."""
    material("cable")
    cable = ancf.Cable([(0, 0, 0), (1, 0, 0)], 4, diameter=2e-3, material="cable", contactPoints=0)
    cable.fix(0)
    number = ball((1, 0, 0), 0.01, mass=0.1, material="cable", mask=2)
    guide = ancf.GuideEngine()
    guide.add(number, direction=(1, 0, 0), motion=lambda t: 0)
    *engines, newton = ancf.engines(cable)
    O.engines = [*engines, guide, newton]
    cable.carry(-1, number)
    return cable, guide, number


CALLED = {
    "fix": (lambda c, g, n: c.engine.fix(2), None),
    "ea": (lambda c, g, n: setattr(c.engine, "ea", [0.5 * ea for ea in c.engine.ea]), None),
    "build": (lambda c, g, n: c.engine.build(), None),
    "tension": (lambda c, g, n: c.tension(0.5), None),
    "setMotion": (lambda c, g, n: g.setMotion(n, lambda t: 0), None),
    "erase": (lambda c, g, n: O.bodies.erase(n), "was erased"),
    "reset": (lambda c, g, n: O.reset(), "left the scene"),
    "add": (
        lambda c, g, n: g.add(ball((2, 0, 0), 0.01, mass=0.1, material="cable"), (1, 0, 0)),
        "added a body",
    ),
}


def inFork(act):
    """Carries out what may end the process."""
    child = os.fork()
    if child == 0:
        try:
            act()
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            os._exit(1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


@pytest.mark.parametrize("what", CALLED)
def test_function_of_time_that_changes_the_scene(driven, what):
    """Is carried out before the step, or refused by name; never taken halfway."""
    cable, guide, number = driven
    change, refused = CALLED[what]
    done = []

    def motion(t):
        if O.iter == 3 and not done:
            done.append(True)
            change(cable, guide, number)
        return 0.0

    def act():
        guide.setMotion(number, motion)
        steps(3)
        if refused:
            with pytest.raises(RuntimeError, match=refused):
                O.step()
            return
        steps(5)
        assert O.iter == 8 and np.isfinite(cable.knots).all() and done
        if what == "fix":
            assert 2 in cable.engine.fixedNodes
        if what == "ea":
            assert cable.engine.ea[0] == 0.5 * cable.section.ea

    inFork(act)


def test_drive_goes_on_after_its_clock_was_reset(driven):
    """x(t) = t: every step moves the body by O.dt, though a number of steps comes again."""
    cable, guide, number = driven
    guide.setMotion(number, lambda t: 0.01 * t)
    O.step()
    assert guide.position(number) == pytest.approx(0.01 * O.time, rel=1e-9)
    O.resetTime()
    before = guide.position(number)
    steps(1)
    assert O.bodies[number].state.vel[0] == pytest.approx((0.01 * O.dt - before) / O.dt, rel=1e-6)
    steps(1)
    assert guide.position(number) == pytest.approx(0.01 * O.time, rel=1e-9)


# ---- what the lock costs ----------------------------------------------------------------------------


def test_readings_do_not_stop_the_run():
    """A reader that asks all the time leaves the steps their turn, and the other way round."""
    out = inChild(
        """
        net = build()
        O.run()
        begin, count = O.iter, 0
        end = time.time() + .5
        while time.time() < end:
            net.engine.momentum()
            count += 1
        print(count, O.iter - begin)
        O.pause()
        """
    )
    readings, done = map(int, out.split())
    assert readings > 100 and done > 100
