"""What only several threads can do to a scene."""

import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]

SCRIPT = """
import ancf
from yade import O, utils

O.materials.append(ancf.HollarsMat(label="m", young=1e8, density=1000))
given = dict(diameter=2e-3, material="m", mass="lumped")
below, above = (
    ancf.Cable([(0.05 * i, 0, z) for i in range(41)], **given) for z in (0, 0.012)
)
below.append()
above.append(engine=below.engine)
for k in range(41):  # spheres on knots, with numbers above those of the elements that they meet
    below.carry(k, O.bodies.append(utils.sphere((0.05 * k, 0, 0), 0.0104, material="m")))
for _ in range(500):
    O.interactions.clear()
    O.engines = ancf.engines(below, above)
    O.step()
print(len(O.interactions.all()), "pairs")
"""


def test_functors_that_are_new_to_yade(tmp_path):
    """In the first step of an InteractionLoop two threads may ask YADE at once for the functor of a
    sphere on a knot and an element: one may get it with both in the wrong order.
    """
    (tmp_path / "scene.py").write_text(SCRIPT)
    command = ["yade", "-j2", "-n", "-x", "scene.py"]
    env = {"PYTHONPATH": str(ROOT / "build" / "python"), **os.environ}
    done = subprocess.run(
        command, cwd=tmp_path, env=env, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert int(done.stdout.split("\n")[-2].split()[0]) > 40
