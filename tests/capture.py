"""Fifty steps of a net that flies into a ball, for memcheck.sh."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "yade"))

import ancf
from helpers import ball, material, squareNet, steps
from yade import O, Vector3

material("cable")
ball((0.031, 0.004, 0.002), 0.03, mass=0.1, material="cable")
net = squareNet(2, 0.06, mass="lumped", damping=5e-5)
net.setVelocity(lambda p: Vector3(2, 0, 0))
O.engines = ancf.engines(net)
touched = 0
for _ in range(50):
    steps(1)
    touched += net.engine.contacts
print(f"{touched} contacts in {O.iter} steps")
assert touched > 0
