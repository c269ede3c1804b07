/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Van der Waals attraction: the stress of finite range for a Hamaker constant, and the Maugis
 * sphere for an asperity of a patch. */
#include "contact/vdw.h"

#include <math.h>

static bool is_positive(double x) {
    return x > 0 && isfinite(x);
}

haft_status haft_vdw_from_spec(haft_vdw *out, const haft_vdw_spec *spec, haft_error *error) {
    if (!is_positive(spec->hamaker) || !is_positive(spec->r0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a Hamaker constant of %g J with an r0 of %g m; both must be "
                              "positive",
                              spec->hamaker, spec->r0);
    }
    double d0 = pow(2.0 / 15.0, 1.0 / 6.0) * spec->r0;
    double energy = spec->hamaker / (16 * M_PI * d0 * d0);
    double range = 0.97 * pow(2.0, 1.0 / 6.0) * spec->r0;
    *out = (haft_vdw){.energy = energy, .stress = energy / range, .range = range};
    return HAFT_OK;
}

haft_status haft_vdw_leave_tail(haft_vdw *vdw, const haft_dispersion *law, haft_error *error) {
    double tail = -haft_dispersion_at(law, law->cut_off).energy, left = vdw->energy - tail;
    if (!(left > 0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "dispersion beyond %.4g nm has %.4g mJ/m^2, and contact but %.4g: "
                              "nothing is left for contact; give a larger cut-off",
                              law->cut_off * 1e9, tail * 1e3, vdw->energy * 1e3);
    }
    vdw->energy = left;
    vdw->stress = left / vdw->range;
    return HAFT_OK;
}

static double lambda_of(const haft_vdw *vdw, double modulus, double radius) {
    return vdw->stress * cbrt(9 * radius / (2 * M_PI * vdw->energy * modulus * modulus));
}

/* Limits of asperity radii. No sampled asperity is sharper than the smallest;
 * haft_contact_summits() uses the largest for flat ones. */
static double least_radius(double step) {
    return 1e-3 * step;
}

static double most_radius(double rows, double columns, double step) {
    return 1e3 * step * hypot(rows, columns);
}

haft_status haft_contact_check_spheres(const haft_vdw *vdw, double modulus, double rows,
                                       double columns, double step, haft_error *error) {
    double sharp = least_radius(step), flat = most_radius(rows, columns, step);
    double least = lambda_of(vdw, modulus, sharp), most = lambda_of(vdw, modulus, flat);
    if (!(least >= HAFT_MAUGIS_LAMBDA_LEAST && most <= HAFT_MAUGIS_LAMBDA_MOST)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "asperities of radius %.3g to %.3g m would have a Maugis parameter "
                              "lambda of %.3g to %.3g with a modulus of %.3g Pa, an energy of %.3g "
                              "J/m^2 and a range of %.3g m; the table holds %g to %g",
                              sharp, flat, least, most, modulus, vdw->energy, vdw->range,
                              HAFT_MAUGIS_LAMBDA_LEAST, HAFT_MAUGIS_LAMBDA_MOST);
    }
    return HAFT_OK;
}

haft_status haft_adhesion_make(haft_adhesion *out, const haft_contact_spec *spec, double rows,
                               double columns, double step, haft_error *error) {
    const haft_vdw *vdw = &spec->vdw;
    if (!is_positive(vdw->energy) || !is_positive(vdw->stress) || !is_positive(vdw->range) ||
        spec->maugis == NULL) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "van der Waals forces of energy %g J/m^2, stress %g Pa and range %g "
                              "m; all must be positive, and a table of haft_maugis_table_create() "
                              "must be given",
                              vdw->energy, vdw->stress, vdw->range);
    }
    HAFT_TRY(haft_contact_check_spheres(vdw, spec->modulus, rows, columns, step, error));
    double w = vdw->energy, e = spec->modulus;
    *out = (haft_adhesion){
        .table = spec->maugis,
        .path = spec->path,
        .least_radius = least_radius(step),
        .most_radius = most_radius(rows, columns, step),
        .lambda = lambda_of(vdw, spec->modulus, 1),
        .approach = cbrt(9 * M_PI * M_PI * w * w / (16 * e * e)),
        .force = M_PI * w * 0.75 / e,
        .range = vdw->range,
        .strength = vdw->stress * 0.75 / e,
        .reach = vdw->range / (1 - 1 / M_PI),
    };
    return HAFT_OK;
}

haft_sphere haft_adhesion_sphere(const haft_adhesion *adhesion, double radius) {
    radius = fmin(fmax(radius, adhesion->least_radius), adhesion->most_radius);
    double root = cbrt(radius);
    return (haft_sphere){
        .curve = haft_maugis_curve_of(adhesion->table, adhesion->lambda * root, adhesion->path),
        .per_approach = 1 / (adhesion->approach * root),
        .force = adhesion->force * radius,
        .area = M_PI * radius * adhesion->approach * root,
    };
}
