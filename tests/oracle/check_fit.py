"""Compares penalised least squares fits with an independent solution by SciPy (fit_*.json, see README.md).

The functional  sum w_i |F(p_i) - x_i|^2 + lambda a^(m-1) int |D^m F|^2  is solved as one overdetermined system, by orthogonal
transformations: no normal equations, so that the error is that of the compared program.
"""

import math

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import lstsq

from common import main

LIMIT = 1e-9
DEGREE = 3
LARGEST = 2500


def derivative_rows(knots, order):
    """A matrix R with |R c|^2 = int (d^order/dt^order sum_i c_i N_i)^2 dt, by Gauss quadrature in every cell."""
    count = len(knots) - DEGREE - 1
    points, weights = np.polynomial.legendre.leggauss(DEGREE + 1)
    rows = []
    basis = BSpline(knots, np.eye(count), DEGREE)
    if order:
        basis = basis.derivative(order)
    for a, b in zip(knots[DEGREE:count], knots[DEGREE + 1 : count + 1]):
        if b > a:
            at = (a + b) / 2 + (b - a) / 2 * points
            rows.append(np.sqrt((b - a) / 2 * weights)[:, None] * basis(at))
    return np.linalg.qr(np.vstack(rows), mode="r")


def energy_rows(knots_u, knots_v, order):
    """A matrix R with |R c|^2 = int |D^order F|^2 over the rectangle; second index of the net fastest."""
    return np.vstack(
        [
            math.sqrt(math.comb(order, k))
            * np.kron(derivative_rows(knots_u, order - k), derivative_rows(knots_v, k))
            for k in range(order + 1)
        ]
    )


def design(knots_u, knots_v, params):
    u = BSpline.design_matrix(params[:, 0], knots_u, DEGREE).toarray()
    v = BSpline.design_matrix(params[:, 1], knots_v, DEGREE).toarray()
    return (u[:, :, None] * v[:, None, :]).reshape(len(params), -1)


def check(_, data):
    knots_u = np.array(data["knots_u"], dtype=np.float64)
    knots_v = np.array(data["knots_v"], dtype=np.float64)
    params = np.array(data["params"], dtype=np.float64)
    points = np.array(data["points"], dtype=np.float64)
    weights = np.array(data["weights"], dtype=np.float64)
    net = np.array(data["net"], dtype=np.float64)
    order = data["order"]
    if order not in (2, 3):
        raise ValueError(f"order {order} is neither 2 nor 3")
    count = (len(knots_u) - DEGREE - 1) * (len(knots_v) - DEGREE - 1)
    if net.shape != (count, 3):
        raise ValueError(f"the net is {net.shape}, its knots ask for {(count, 3)}")
    if count > LARGEST:
        raise ValueError(f"{count} coefficients are too many for a dense solution: dump a fit of at most {LARGEST}")
    if not math.isclose(weights.sum(), 1.0, rel_tol=1e-12):
        raise ValueError(f"the weights sum to {weights.sum()!r}, expected 1")
    a = design(knots_u, knots_v, params)
    root = np.sqrt(weights)[:, None]
    smooth = math.sqrt(data["lambda"] * data["area"] ** (order - 1)) * energy_rows(knots_u, knots_v, order)
    system = np.vstack([root * a, smooth])
    right = np.vstack([root * points, np.zeros((len(smooth), 3))])
    want, _, rank, _ = lstsq(system, right, lapack_driver="gelsy")
    if rank < count:
        raise ValueError(f"rank {rank} of {count}: the fit is not unique")
    diagonal = np.linalg.norm(np.ptp(points, axis=0))
    distance = lambda x, y: np.linalg.norm(x - y, axis=1).max() / diagonal
    yield "surface at the data", distance(a @ net, a @ want), LIMIT
    yield "net", distance(net, want), LIMIT


if __name__ == "__main__":
    main("fit_*.json", check)
