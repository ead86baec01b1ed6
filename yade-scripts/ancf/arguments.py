"""What the arguments mean that Cable and Net have in common: one text for both."""

import inspect

SHARED = """\
elements         ANCF elements per edge
diameter         [m]; gives area and bending stiffness E pi d^4/64
material         HollarsMat, or its label or id in O.materials
length           unstressed length [m]; or
slack            by how much of the length as laid the unstressed one is longer [-], 0.02: 2 %;
                 below 0: pre-strained; or
tension          as laid [N]. A slack cable of ANCF elements starts compressed: relax() lets it
                 hang; springs go slack without force
model            'ancf', or 'springs': tension-only springs, midPoints + 1 per edge, mass
                 lumped, no bending
midPoints        of an edge of springs, evenly
contact          'curve': it touches where its true curve is nearest, at one place in each
                 segment; 'points': at fixed points, by spheres of its thickness, as in the
                 study (Fig. 5), between which small things pass
contactPoints    inside each element, evenly: they divide it into contactPoints + 1 segments
                 (springs: one); 0: it touches nothing, whatever contact= says
damping          Kelvin-Voigt time [s]
massDamping      mass-proportional damping alpha [1/s]: a force -alpha M v, which lets swinging
                 die away as exp(-alpha t/2), and free flight as exp(-alpha t)
area, bending    [m2], EI [N m2] instead of those of the diameter
mass             'consistent' or 'lumped'
axialRule        'exact', or 'reduced' (3 Gauss points: softer in bending-dominated cables)
curvature        'fast' (|r''|) or 'exact' (|r' x r''|/|r'|^2)
strain           'green', (|r'|^2 - 1)/2, or 'engineering', |r'| - 1; springs: always the latter
selfContact      whether it touches itself; other cables and nets it always touches
mask             groupMask of its bodies
label            its name in messages

Raises ValueError, TypeError or IndexError that names the attribute."""


def documented(cls):
    """The class, with SHARED in the place of the line {arguments} of its docstring."""
    cls.__doc__ = inspect.cleandoc(cls.__doc__ or "").replace("{arguments}", SHARED)
    return cls
