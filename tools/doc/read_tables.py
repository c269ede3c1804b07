#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads CASE/out/budget.csv, greatest term first, and CASE/out/compare/compare.csv, with the standard
library alone; what is not there is passed over."""
import csv
import os
import sys


def rows(name):
    path = os.path.join(sys.argv[1], "out", name)
    if not os.path.exists(path):
        return []
    with open(path, newline="") as table:
        return list(csv.DictReader(table))


budget = rows("budget.csv")
terms = [row for row in budget if row["kind"].startswith("refinement")]
alone = [row for row in terms if row["term"] not in ("all refinements at once", "interaction")]
for row in sorted(alone, key=lambda row: -abs(float(row["shift [um]"]))):
    print(f"{row['term']:20} {float(row['shift [um]']):+8.3f} +- {float(row['half width [um]']):.3f} um"
          f"  {row['change']}")
for row in budget:
    if row["term"] == "sum of refinements":
        total = sum(abs(float(term["shift [um]"])) for term in alone)
        assert abs(total - float(row["shift [um]"])) <= 1e-9 * total
        print(f"{row['term']:20} {total:8.3f}")

for row in rows("compare/compare.csv"):
    print(f"case {row['case']}: mean {float(row['mean [um]']):.2f} um, {row['stuck']} of {row['beams']} stuck;"
          f" against case 0 {float(row['difference [um]']):+.2f} um,"
          f" {float(row['difference low [um]']):+.2f} to {float(row['difference high [um]']):+.2f}")
