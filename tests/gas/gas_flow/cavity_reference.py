"""Velocities in the lid-driven cavity by another method than Talcum's, for the tables in cavity.rs.

Steady streamfunction psi and vorticity w on nodes (u = dpsi/dy, v = -dpsi/dx):

    lap psi + w = 0,    (1/Re) lap w - u dw/dx - v dw/dy = 0,

central differences, Thom's vorticity in the walls (-2 psi_1/h^2, at the lid -2/h more), solved by Newton's
method on 64^2 and 128^2 cells; the result is extrapolated as of second order. Needs NumPy and SciPy.

    python3 cavity_reference.py 100
"""

import sys

import numpy as np
import scipy.interpolate
import scipy.sparse as sparse
import scipy.sparse.linalg

U_PLACES = [125, 124, 123, 122, 109, 94, 79, 64, 58, 36, 22, 13, 9, 8, 7]
V_PLACES = [124, 123, 122, 121, 116, 110, 103, 64, 30, 29, 20, 12, 10, 9, 8]


class Grid:
    """Differences on the inner nodes of a square, x fastest."""

    def __init__(self, cells):
        self.cells, self.h = cells, 1.0 / cells
        n = cells - 1
        one = np.ones(n)
        second = sparse.diags([one[1:], -2.0 * one, one[1:]], [-1, 0, 1]) / self.h**2
        first = sparse.diags([-one[1:], one[1:]], [-1, 1]) / (2.0 * self.h)
        identity = sparse.identity(n)
        self.laplacian = sparse.kron(second, identity) + sparse.kron(identity, second)
        self.along_x = sparse.kron(identity, first)
        self.along_y = sparse.kron(first, identity)
        self.set_walls(n)

    def set_walls(self, n):
        """What vorticity in the walls adds to the differences of w: a diagonal times psi, and a constant."""
        node = np.arange(n * n).reshape(n, n)
        self.wall = {name: [np.zeros(n * n), np.zeros(n * n)] for name in ("laplacian", "along_x", "along_y")}
        sides = [(node[:, 0], "along_x", -1, 0.0), (node[:, -1], "along_x", 1, 0.0),
                 (node[0, :], "along_y", -1, 0.0), (node[-1, :], "along_y", 1, 1.0)]
        for nodes, name, sign, speed in sides:
            of_psi, constant = -2.0 / self.h**2, -2.0 * speed / self.h
            for which, weight in (("laplacian", 1.0 / self.h**2), (name, sign / (2.0 * self.h))):
                self.wall[which][0][nodes] += weight * of_psi
                self.wall[which][1][nodes] += weight * constant


def newton(grid, reynolds, psi, w):
    diagonal = sparse.diags
    wall = grid.wall
    for _ in range(30):
        u, v = grid.along_y @ psi, -(grid.along_x @ psi)
        w_x = grid.along_x @ w + wall["along_x"][0] * psi + wall["along_x"][1]
        w_y = grid.along_y @ w + wall["along_y"][0] * psi + wall["along_y"][1]
        viscous = (grid.laplacian @ w + wall["laplacian"][0] * psi + wall["laplacian"][1]) / reynolds
        residual = np.concatenate([grid.laplacian @ psi + w, viscous - u * w_x - v * w_y])
        by_psi = (diagonal(wall["laplacian"][0] / reynolds - u * wall["along_x"][0] - v * wall["along_y"][0])
                  - diagonal(w_x) @ grid.along_y + diagonal(w_y) @ grid.along_x)
        by_w = grid.laplacian / reynolds - diagonal(u) @ grid.along_x - diagonal(v) @ grid.along_y
        jacobian = sparse.bmat([[grid.laplacian, sparse.identity(len(w))], [by_psi, by_w]]).tocsc()
        change = scipy.sparse.linalg.splu(jacobian).solve(-residual)
        psi, w = psi + change[: len(w)], w + change[len(w):]
        if np.abs(change).max() < 1e-9:
            return psi, w
    raise SystemExit("Newton's method did not converge")


def middle_lines(cells, reynolds):
    """u on the vertical, v on the horizontal line through the middle, on nodes."""
    grid = Grid(cells)
    psi = w = np.zeros((cells - 1) ** 2)
    for step in sorted({min(100.0, reynolds), reynolds}):
        psi, w = newton(grid, step, psi, w)
    whole = np.zeros((cells + 1, cells + 1))
    whole[1:-1, 1:-1] = psi.reshape(cells - 1, cells - 1)
    middle = cells // 2
    u, v = np.zeros(cells + 1), np.zeros(cells + 1)
    u[-1] = 1.0
    u[1:-1] = (whole[2:, middle] - whole[:-2, middle]) / (2.0 * grid.h)
    v[1:-1] = -(whole[middle, 2:] - whole[middle, :-2]) / (2.0 * grid.h)
    return u, v


def main():
    reynolds = float(sys.argv[1])
    coarse, fine = middle_lines(64, reynolds), middle_lines(128, reynolds)
    for name, places, on_coarse, on_fine in zip("uv", (U_PLACES, V_PLACES), coarse, fine):
        extrapolated = on_fine[::2] + (on_fine[::2] - on_coarse) / 3.0
        curve = scipy.interpolate.CubicSpline(2 * np.arange(65), extrapolated)
        for place in places:
            print(f"{name} at {place}/128: {curve(place):.5f}")


if __name__ == "__main__":
    main()
