/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Condensed water at a humidity, by Kelvin's law; a meniscus of constant pressure and range. */
#include <gsl/gsl_const_mksa.h>
#include <math.h>

#include "haft/contact.h"

static bool is_angle(double angle) {
    return angle >= 0 && angle < 0.5 * M_PI;
}

static bool is_positive(double x) {
    return x > 0 && isfinite(x);
}

haft_status haft_capillary_from_spec(haft_capillary *out, const haft_capillary_spec *spec,
                                     haft_error *error) {
    if (!(spec->humidity > 0 && spec->humidity < 1)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a relative humidity of %g has no menisci; give one between 0 and 1, "
                              "both excluded",
                              spec->humidity);
    }
    if (!is_positive(spec->temperature) || !is_positive(spec->surface_energy) ||
        !is_positive(spec->molar_volume)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "temperature (%g K), surface energy (%g N/m) and molar volume "
                              "(%g m^3/mol) must be positive",
                              spec->temperature, spec->surface_energy, spec->molar_volume);
    }
    if (!is_angle(spec->contact_angle_1) || !is_angle(spec->contact_angle_2)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "contact angles of %g and %g rad: each must be at least 0 and below "
                              "pi/2",
                              spec->contact_angle_1, spec->contact_angle_2);
    }
    double pressure =
        GSL_CONST_MKSA_MOLAR_GAS * spec->temperature * log(spec->humidity) / spec->molar_volume;
    double radius = spec->surface_energy / pressure;
    *out = (haft_capillary){
        .kelvin_radius = radius,
        .pressure = pressure,
        .range = -radius * (cos(spec->contact_angle_1) + cos(spec->contact_angle_2)),
    };
    return HAFT_OK;
}
