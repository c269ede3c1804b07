/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Condensed water at a humidity, by Kelvin's law: a meniscus of constant pressure and range. And
 * the adsorbed film on a hydrophilic surface, by a table. */
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

haft_adsorption haft_adsorption_silica(void) {
    static const double humidity[] = {0.30, 0.60, 0.75, 0.90};
    static const double thickness[] = {3 * 0.282e-9, 4 * 0.282e-9, 4.5 * 0.282e-9, 6.5 * 0.282e-9};
    return (haft_adsorption){4, humidity, thickness};
}

haft_status haft_adsorption_check(const haft_adsorption *film, haft_error *error) {
    for (size_t i = 0; i < film->n; i++) {
        double before = i > 0 ? film->humidity[i - 1] : 0,
               thinner = i > 0 ? film->thickness[i - 1] : 0;
        if (!(film->humidity[i] > before && film->humidity[i] < 1) ||
            !(film->thickness[i] >= thinner && isfinite(film->thickness[i]))) {
            return haft_error_set(
                error, HAFT_ERROR_INPUT,
                "point %zu of the adsorbed film, %g m at RH %g: humidities must rise "
                "between 0 and 1, and the thickness must not fall",
                i + 1, film->thickness[i], film->humidity[i]);
        }
    }
    return film->n > 0 ? HAFT_OK
                       : haft_error_set(error, HAFT_ERROR_INPUT, "the adsorbed film has no points");
}

double haft_adsorption_thickness(const haft_adsorption *film, double humidity) {
    double from = 0, thin = 0;
    for (size_t i = 0; i < film->n; i++) {
        if (humidity <= film->humidity[i]) {
            double share = (humidity - from) / (film->humidity[i] - from);
            return thin + share * (film->thickness[i] - thin);
        }
        from = film->humidity[i];
        thin = film->thickness[i];
    }
    return thin;
}
