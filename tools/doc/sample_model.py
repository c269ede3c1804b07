#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws N law vectors from the polynomial chaos expansion in CASE/out/laws.h5, as CSV."""
import sys

import h5py
import numpy as np


def polynomials(germ, order, x):
    """Orthonormal polynomials of degree 0 .. order, by their three-term recurrence."""
    psi = np.ones((order + 1, x.size))
    for k in range(order):
        before = psi[k - 1] if k > 0 else 0
        if germ == "hermite":
            psi[k + 1] = (x * psi[k] - np.sqrt(k) * before) / np.sqrt(k + 1)
        else:  # on (0, 1): Legendre a = 0, Beta(2,2) a = 1, as Jacobi polynomials of t = 2 x - 1
            a = 0 if germ == "legendre" else 1
            b = [np.sqrt(n * (n + 2 * a) / ((2 * n + 2 * a - 1) * (2 * n + 2 * a + 1)))
                 for n in (k, k + 1)]
            psi[k + 1] = ((2 * x - 1) * psi[k] - b[0] * before) / b[1]
    return psi


count, random = int(sys.argv[2]), np.random.default_rng(1)
with h5py.File(sys.argv[1] + "/out/laws.h5") as laws:
    model = laws["chaos"]
    attribute = {name: value.decode() if isinstance(value, bytes) else value
                 for name, value in model.attrs.items()}
    size, order = int(attribute["components"]), int(attribute["order"])
    draw = {"legendre": lambda: random.random(count), "hermite": lambda: random.normal(size=count),
            "jacobi": lambda: random.beta(2, 2, count)}[attribute["germ"]]
    psi = [polynomials(attribute["germ"], order, draw()) for _ in range(size)]
    term = np.ones((model["index"].shape[0], count))
    for i in range(size):
        term *= psi[i][model["index"][:, i]]
    eta = model["coefficient"][:].T @ term
    spread = model["eigenvector"][:, :size] * np.sqrt(model["eigenvalue"][:size])
    q = model["mean"][:][:, None] + spread @ eta
    raw = q * model["sigma"][:][:, None]
    f_max, d_max = np.exp(raw[1]), raw[2]
    d_limit = d_max - np.exp(raw[3])
    e = np.exp(raw[0])
    if attribute["bounds"] == "strict":
        unit = f_max if attribute["f_limit_unit"] in ("f_max", b"f_max") else 1
        a_left = np.log1p(np.sqrt(1 + attribute["f_limit"] * unit / f_max)) / (d_max - d_limit)
        e += f_max / (2 * a_left)
    print("e [mJ/m2],f_max [MPa],d_max [nm],d_limit [nm]")
    np.savetxt(sys.stdout, np.stack([1e3 * e, 1e-6 * f_max, 1e9 * d_max, 1e9 * d_limit], 1),
               fmt="%.9g", delimiter=",")
