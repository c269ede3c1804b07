/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The one interface to every kind of law. */
#include <math.h>

#include "law/far.h"
#include "law/table.h"
#include "law/wings.h"

haft_law_value haft_law_evaluate(const haft_law *law, double d) {
    haft_law_value x =
        law->kind == HAFT_LAW_MORSE
            ? haft_law_wings_evaluate(haft_law_wings(law), d, haft_law_wings_bounds(), true)
            : haft_law_table_evaluate(law->table, d);
    if (law->far != NULL) {
        haft_law_values at = {&x.force, &x.slope, &x.curvature, &x.potential};
        haft_law_add_far(law->far, 1, &d, &at, 0);
    }
    return x;
}

double haft_law_range(const haft_law *law) {
    if (law->kind == HAFT_LAW_TABLE) {
        return haft_law_table_range(law->table);
    }
    return 1 / fmax(law->a_left, law->a_right);
}

haft_law_lengths haft_law_find_lengths(const haft_law *law) {
    if (law->kind == HAFT_LAW_TABLE) {
        return haft_law_table_lengths(law->table);
    }
    double left = 1 / law->a_left, right = 1 / law->a_right;
    return (haft_law_lengths){fmin(left, right), law->d_max,
                              right >= HAFT_LAW_WIDER * left ? right : fmin(left, right)};
}

const char *haft_law_fault_name(haft_law_fault fault) {
    switch (fault) {
    case HAFT_LAW_SOUND:
        return "sound";
    case HAFT_LAW_NO_ATTRACTION:
        return "no attraction";
    case HAFT_LAW_TWO_WELLS:
        return "two wells";
    case HAFT_LAW_RANGE_LEFT:
        return "range too short on the left";
    case HAFT_LAW_RANGE_RIGHT:
        return "range too short on the right";
    case HAFT_LAW_BOUND:
        return "energy below the bound";
    case HAFT_LAW_INVALID:
        return "invalid numbers";
    case HAFT_LAW_FAULTS:
        break;
    }
    return "unknown";
}
