/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables of results.h5, defined once for writer and reader. */
#include "hdf.h"

#define REAL(type, member, name, unit, text)                                                       \
    { name, HAFT_HDF_REAL, offsetof(type, member), unit, text }
#define INT(type, member, name, text)                                                              \
    { name, HAFT_HDF_INT, offsetof(type, member), "1", text }

const haft_hdf_column haft_hdf_point_columns[] = {
    REAL(haft_path_point, load, "load", "N", "load P, towards the substrate"),
    REAL(haft_path_point, deflection, "deflection", "m", "deflection of the load point"),
    REAL(haft_path_point, crack_length, "crack_length", "m",
         "from the clamp to the first attraction felt"),
    REAL(haft_path_point, internal_energy, "internal_energy", "J", "strain energy"),
    REAL(haft_path_point, contact_energy, "contact_energy", "J", "potential of all laws"),
    REAL(haft_path_point, work, "work", "J", "work of the load from the start"),
    REAL(haft_path_point, dissipated, "dissipated", "J", "energy lost in jumps from the start"),
    REAL(haft_path_point, lambda_min, "lambda_min", "1",
         "smallest eigenvalue of the Hessian against the mass, scaled; stable if > 0"),
    REAL(haft_path_point, least_pivot, "least_pivot", "1",
         "smallest pivot of the Hessian over its largest; stable if > 0"),
    INT(haft_path_point, phase, "phase", "0 loading, 1 unloading"),
    INT(haft_path_point, jump, "jump", "jump that led here, counted from 0; -1 if none"),
};
const size_t haft_hdf_point_column_count =
    sizeof haft_hdf_point_columns / sizeof *haft_hdf_point_columns;

_Static_assert(sizeof(haft_jump_kind) == sizeof(int), "enums are ints");
_Static_assert(sizeof(haft_departure) == sizeof(int), "enums are ints");
const haft_hdf_column haft_hdf_jump_columns[] = {
    REAL(haft_jump, load, "load", "N", "load of the fold; 0 of a flow from u = 0"),
    INT(haft_jump, site, "site", "site that moves most in the fold's null vector"),
    REAL(haft_jump, dissipated, "dissipated", "J", "fall of the potential at the fold's load"),
    INT(haft_jump, kind, "kind", "0 pull-in, 1 pull-out"),
    INT(haft_jump, phase, "phase", "0 loading, 1 unloading"),
    INT(haft_jump, departure, "departure",
        "how the branch ended: 0 fold, 1 bifurcation, 2 several null vectors at once; 3: it began "
        "with a flow from u = 0"),
    INT(haft_jump, sites_switched, "sites_switched", "sites that came into or went out of reach"),
    REAL(haft_jump, crack_before, "crack_before", "m", "crack length at the fold"),
    REAL(haft_jump, crack_after, "crack_after", "m", "crack length at the landing"),
    REAL(haft_jump, internal_before, "internal_before", "J", "strain energy at the fold"),
    REAL(haft_jump, internal_after, "internal_after", "J", "strain energy at the landing"),
    INT(haft_jump, flow_steps, "flow_steps", "steps of the gradient flow to the landing"),
    REAL(haft_jump, fold_defect, "fold_defect", "1",
         "dP/dtau left at the located fold, relative to the branch's own; 0 at other departures"),
};
const size_t haft_hdf_jump_column_count =
    sizeof haft_hdf_jump_columns / sizeof *haft_hdf_jump_columns;

const haft_hdf_column haft_hdf_summary_columns[] = {
    REAL(haft_summary, crack_length, "crack_length", "m",
         "after unloading; the beam's length if it is free; NaN if never computed"),
    REAL(haft_summary, loaded_crack_length, "loaded_crack_length", "m", "at the end of loading"),
    REAL(haft_summary, gamma, "gamma", "J/m^2", "effective adhesion energy; 0 if free"),
    INT(haft_summary, outcome, "status", "why the path ended; see `names`"),
    REAL(haft_summary, work, "work", "J", "work of the load"),
    REAL(haft_summary, dissipated, "dissipated", "J", "energy lost in jumps"),
    REAL(haft_summary, internal_energy, "internal_energy", "J", "strain energy at rest"),
    REAL(haft_summary, end_influence, "end_influence", "1",
         "of the free end on the crack's tip; small: the beam is long enough"),
    REAL(haft_summary, ledger_error, "ledger_error", "1",
         "greatest gap between work, energy and dissipation over the work"),
    INT(haft_summary, jumps, "jumps", "jumps of the path; -1 if never computed"),
    INT(haft_summary, steps, "steps", "accepted steps; -1 if never computed"),
    INT(haft_summary, unfit, "unfit", "sites whose curve no Morse law fits; -1 if never computed"),
    REAL(haft_summary, seconds, "seconds", "s",
         "time taken; everything else in this file is reproducible to the bit"),
};
const size_t haft_hdf_summary_column_count =
    sizeof haft_hdf_summary_columns / sizeof *haft_hdf_summary_columns;
