"""Materials of ropes, by what a catalogue tells of them."""

import math

from yade import wrapper

from . import values
from .structure import checkMaterial


def ropeMaterial(diameter, ea, rhoA, **others):
    """The HollarsMat that a full round of a diameter [m] has an axial stiffness `ea` [N] and a mass
    `rhoA` [kg/m] with: young = ea/area, density = rhoA/area.

    Cables of it take the same diameter. Their bending stiffness is that of a full round of it, of
    which a rope of many wires has little: give them bending=. others: attributes of HollarsMat, such
    as label. Raises ValueError, TypeError or AttributeError that names the argument.
    """
    where = "ropeMaterial"
    diameter = values.positive(f"{where}: diameter", diameter, "m")
    ea = values.positive(f"{where}: ea", ea, "N")
    rhoA = values.positive(f"{where}: rhoA", rhoA, "kg/m")
    for name in {"young", "density"} & others.keys():
        values.refuse(f"{where}: {name}", others[name], "follows from ea and rhoA: leave it out")
    area = math.pi * diameter**2 / 4
    material = wrapper.HollarsMat(young=ea / area, density=rhoA / area, **others)
    checkMaterial(material)
    return material
