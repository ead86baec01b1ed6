"""The cable element as textbooks write it, in numpy, integrated by DOP853 of scipy.

References are made by it: it shares no line with the plugin, neither the element (Gauss points and
virtual work here, closed forms of dot products there) nor the integrator.
"""

import numpy as np
from scipy.integrate import solve_ivp

GAUSS = 5  # points of an element, for axial strain and curvature both


class Rod:
    """A cable along x from 0 to `length`, straight and without strain at the start.

    ea [N], ei [N m2], rhoA [kg/m]; strain: 'green' or 'engineering'. State: (2 (n + 1), 3), position
    and slope of each node in turn.
    """

    def __init__(self, n, length, ea, ei, rhoA, gravity=(0, 0, 0), strain="green"):
        self.n, self.ea, self.ei, self.strain = n, ea, ei, strain
        h = length / n
        x, w = np.polynomial.legendre.leggauss(GAUSS)
        xi, self.weight = 0.5 * (x + 1), 0.5 * h * w
        self.shape = np.array(
            [
                1 - 3 * xi**2 + 2 * xi**3,
                h * (xi - 2 * xi**2 + xi**3),
                3 * xi**2 - 2 * xi**3,
                h * (xi**3 - xi**2),
            ]
        )
        self.slope = np.array(
            [
                (6 * xi**2 - 6 * xi) / h,
                1 - 4 * xi + 3 * xi**2,
                (6 * xi - 6 * xi**2) / h,
                3 * xi**2 - 2 * xi,
            ]
        )
        self.bend = np.array(
            [(12 * xi - 6) / h**2, (6 * xi - 4) / h, (6 - 12 * xi) / h**2, (6 * xi - 2) / h]
        )
        self.rows = 2 * np.arange(n)[:, None] + np.arange(4)
        count = 2 * (n + 1)
        self.mass, self.weightForce = np.zeros((count, count)), np.zeros((count, 3))
        local = rhoA * np.einsum("ig,jg,g->ij", self.shape, self.shape, self.weight)
        load = rhoA * np.outer(self.shape @ self.weight, gravity)
        for rows in self.rows:
            self.mass[np.ix_(rows, rows)] += local
            self.weightForce[rows] += load
        self.start = np.zeros((count, 3))
        self.start[::2, 0] = np.linspace(0, length, n + 1)
        self.start[1::2, 0] = 1

    def force(self, q):
        """Generalised forces (2 (n + 1), 3): minus the derivative of the elastic energy, weight."""
        e = q[self.rows]
        g = np.einsum("ig,eic->egc", self.slope, e)
        k = np.einsum("ig,eic->egc", self.bend, e)
        gg, kk, gk = (
            np.einsum("egc,egc->eg", a, b)[..., None] for a, b in ((g, g), (k, k), (g, k))
        )
        if self.strain == "green":
            alongSlope = self.ea * 0.5 * (gg - 1) * g
        else:
            alongSlope = self.ea * (1 - 1 / np.sqrt(gg)) * g
        # kappa^2 = |g x k|^2/|g|^4, |g x k|^2 = |g|^2 |k|^2 - (g.k)^2
        alongBend = self.ei * (gg * k - gk * g) / gg**2
        alongSlope = alongSlope + self.ei * (kk * g - gk * k) / gg**2
        alongSlope = alongSlope - 2 * self.ei * (gg * kk - gk**2) * g / gg**3
        local = np.einsum("ig,egc,g->eic", self.slope, alongSlope, self.weight)
        local += np.einsum("ig,egc,g->eic", self.bend, alongBend, self.weight)
        f = self.weightForce.copy()
        np.subtract.at(f, self.rows, local)
        return f

    def run(self, duration, rates, held, tolerance=1e-9):
        """Position of the nodes (n + 1, 3) at the end; rates: of the state at the start, held: rows of
        it that do not move.
        """
        count = len(self.start)
        free = np.setdiff1d(np.arange(count), held)
        inverse = np.linalg.inv(self.mass[np.ix_(free, free)])
        q, size = self.start.copy(), 3 * len(free)

        def slope(t, y):
            q[free] = y[:size].reshape(-1, 3)
            return np.concatenate([y[size:], (inverse @ self.force(q)[free]).ravel()])

        y = np.concatenate([self.start[free].ravel(), np.asarray(rates, float)[free].ravel()])
        done = solve_ivp(
            slope, (0, duration), y, method="DOP853", rtol=tolerance, atol=1e-3 * tolerance
        )
        q[free] = done.y[:size, -1].reshape(-1, 3)
        return q[::2].copy()
