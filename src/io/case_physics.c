/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which forces act in a case, and the push that defines the walls of its laws. */
#include "case.h"

haft_physics haft_case_physics(const haft_case *c) {
    double humidity = c->contact.has_capillary ? c->contact.capillary.humidity : 0;
    haft_physics physics = {
        .capillary = c->contact.has_capillary, .vdw = c->contact.has_vdw, .humid = humidity > 0};
    if (c->contact.forces == HAFT_FORCES_AUTO) {
        physics.capillary = humidity > 0;
        physics.vdw = humidity < HAFT_VDW_HUMIDITY;
    }
    physics.vdw = physics.vdw && c->contact.forces != HAFT_FORCES_CAPILLARY;
    physics.capillary = physics.capillary && c->contact.forces != HAFT_FORCES_VDW;
    return physics;
}

const char *haft_physics_name(haft_physics physics) {
    if (physics.capillary) {
        return physics.vdw ? "capillary and van der Waals" : "capillary";
    }
    return physics.vdw ? "van der Waals" : "contact alone";
}

double haft_case_limit(const haft_case *c) {
    return c->law.f_limit > 0 ? c->law.f_limit : haft_law_share(c->law.f_limit_share);
}
