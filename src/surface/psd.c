/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The self-affine PSD and its moments. Each piece is a power of zeta, so the moments are closed
 * forms. The power law's integral uses expm1, which stays accurate where the exponent approaches -1
 * and the integral becomes a logarithm. */
#include "haft/surface.h"

#include <math.h>

haft_status haft_psd_check(const haft_psd *psd, haft_error *error) {
    if (!(isfinite(psd->zeta_max) && psd->zeta_max > 0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "zeta_max = %g rad/m: must be positive and finite", psd->zeta_max);
    }
    if (!(psd->zeta_0 > 0 && psd->zeta_0 < psd->zeta_max)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "zeta_0 = %g rad/m: must lie between 0 and zeta_max = %g rad/m",
                              psd->zeta_0, psd->zeta_max);
    }
    if (!(isfinite(psd->s_0) && psd->s_0 > 0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "s_0 = %g m^4: must be positive and finite",
                              psd->s_0);
    }
    if (!(psd->s_1 > 0 && psd->s_1 <= psd->s_0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "s_1 = %g m^4: must be positive and at most s_0 = %g m^4", psd->s_1,
                              psd->s_0);
    }
    return HAFT_OK;
}

static double psd_exponent(const haft_psd *psd) {
    return log(psd->s_1 / psd->s_0) / log(psd->zeta_max / psd->zeta_0);
}

double haft_psd_value(const haft_psd *psd, double zeta) {
    if (zeta <= psd->zeta_0) {
        return psd->s_0;
    }
    if (zeta > psd->zeta_max) {
        return 0;
    }
    return psd->s_0 * pow(zeta / psd->zeta_0, psd_exponent(psd));
}

/* Integral of s zeta^power from 0 to zeta_max. */
static double power_integral(const haft_psd *psd, int power) {
    double span = log(psd->zeta_max / psd->zeta_0);
    double exponent = psd_exponent(psd) + power + 1;
    double law = exponent == 0 ? span : expm1(exponent * span) / exponent;
    return psd->s_0 * pow(psd->zeta_0, power + 1) * (1.0 / (power + 1) + law);
}

haft_psd_moments haft_psd_get_moments(const haft_psd *psd) {
    return (haft_psd_moments){
        .m0 = 2 * M_PI * power_integral(psd, 1),
        .m2 = M_PI * power_integral(psd, 3),
        .m4 = 0.75 * M_PI * power_integral(psd, 5),
    };
}

haft_gw haft_gw_from_moments(haft_psd_moments moments) {
    double alpha = moments.m0 * moments.m4 / (moments.m2 * moments.m2);
    return (haft_gw){
        .alpha = alpha,
        .radius = 0.375 * sqrt(M_PI / moments.m4),
        .density = moments.m4 / (6 * M_PI * sqrt(3.0) * moments.m2),
        .summit_deviation = sqrt(1 - 0.8968 / alpha) * sqrt(moments.m0),
    };
}
