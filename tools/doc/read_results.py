#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads CASE/out/results.h5: crack lengths, jumps, and the energy ledger of every path."""
import sys

import h5py
import numpy as np

with h5py.File(sys.argv[1] + "/out/results.h5") as results:
    status = results["summary/status"][:]
    crack = results["summary/crack_length"][:]
    stuck = status == 0
    print(f"{len(crack)} beams, {stuck.sum()} stuck")
    if stuck.any():
        print(f"mean crack length {1e6 * crack[stuck].mean():.1f} um")
    worst = 0
    for realization in results["realizations"].values():
        path = {name: data[:] for name, data in realization["path"].items()}
        energy = path["internal_energy"] + path["contact_energy"]
        gap = path["work"] - path["dissipated"] - (energy - energy[0])
        worst = max(worst, np.abs(gap).max() / np.abs(path["work"]).max())
        lost = realization["jumps/dissipated"][:].sum()
        assert abs(lost - path["dissipated"][-1]) <= 1e-12 * lost
        assert (path["lambda_min"] > 0).all()
    print(f"work = energy + what the jumps lose, to {worst:.0e} of the work")
    assert worst < 1e-9
