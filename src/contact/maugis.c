/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sphere against a plane with adhesion of constant stress and finite range (Maugis 1992), and the
 * same without contact (Kim, McMeeking and Johnson 1998).
 *
 * With m = c/a = 1/cos(theta) the energy balance is a quadratic in c whose coefficients are entire
 * functions of theta. So approach, force and radii are explicit in theta and smooth through a = 0,
 * where the touching branch continues in the other one. Only the inverse, from an approach to its
 * theta, is iterated, by Newton's method within a shrinking bracket. The approach decreases with
 * theta up to the fold, which is found by bisection. Without contact everything is in closed
 * form. */
#include "contact/maugis.h"

#include <math.h>

enum { TERMS = 10 };

/* A = sin(2 theta)/2 - theta cos(2 theta) and B = theta sin(theta) + cos(theta) - 1, given sine and
 * cosine. At small angles, where the terms cancel, their series are used, with a remainder below
 * 1e-17 of the first term. */
static void energy_terms(double theta, double s, double u, double *a, double *b) {
    static const double SERIES = 0.7;
    static const double A[TERMS] = {4.0 / 3,
                                    -8.0 / 15,
                                    8.0 / 105,
                                    -16.0 / 2835,
                                    8.0 / 31185,
                                    -16.0 / 2027025,
                                    16.0 / 91216125,
                                    -32.0 / 10854718875,
                                    8.0 / 206239658625,
                                    -16.0 / 38979295480125};
    static const double B[TERMS] = {1.0 / 2,
                                    -1.0 / 8,
                                    1.0 / 144,
                                    -1.0 / 5760,
                                    1.0 / 403200,
                                    -1.0 / 43545600,
                                    1.0 / 6706022400,
                                    -1.0 / 1394852659200,
                                    1.0 / 376610217984000,
                                    -1.0 / 128047474114560000};
    if (theta > SERIES) {
        *a = s * u - theta * (2 * u * u - 1);
        *b = theta * s + u - 1;
        return;
    }
    double square = theta * theta, sum_a = 0, sum_b = 0;
    for (int k = TERMS; k-- > 0;) {
        sum_a = sum_a * square + A[k];
        sum_b = sum_b * square + B[k];
    }
    *a = sum_a * square * theta;
    *b = sum_b * square;
}

haft_maugis_point haft_maugis_at(double lambda, double theta) {
    double a = 0, b = 0, s = sin(theta), u = cos(theta);
    energy_terms(theta, s, u, &a, &b);
    double k = 4.0 / 3.0 * lambda * lambda, half = 0.5 * k * b;
    double c = 1 / (half + sqrt(half * half + 0.5 * lambda * a));
    double c_slope = -theta * c * u * (2 * lambda * c * s + k) / (lambda * a * c + k * b);
    double radius = c * u, radius_slope = c_slope * u - c * s;
    double pulled = s * u + theta;
    return (haft_maugis_point){
        .approach = radius * radius - 4.0 / 3.0 * lambda * c * s,
        .force = radius * radius * radius - lambda * c * c * pulled,
        .radius = radius,
        .reach = c,
        .approach_slope = 2 * radius * radius_slope - 4.0 / 3.0 * lambda * (c_slope * s + c * u),
        .force_slope =
            3 * radius * radius * radius_slope - 2 * lambda * c * (c_slope * pulled + c * u * u),
    };
}

double haft_maugis_meeting(void) {
    return cbrt(9.0 / 16.0 / (1 - 1 / M_PI));
}

static double approach_slope(const void *lambda, double theta, double *slope) {
    *slope = NAN;
    return haft_maugis_at(*(const double *)lambda, theta).approach_slope;
}

double haft_maugis_first_angle(double lambda) {
    if (lambda <= haft_maugis_meeting()) {
        return 0.5 * M_PI;
    }
    double theta = haft_root_find(approach_slope, &lambda, 0, 0.5 * M_PI, true);
    while (approach_slope(&lambda, theta, &(double){0}) >= 0) { /* the branch is before the fold */
        theta = nextafter(theta, 0);
    }
    return theta;
}

typedef struct sought {
    double lambda, approach;
} sought;

/* Over log(theta), because the approach is close to a power of theta, theta^-3 in the limit. */
static double approach_missed(const void *data, double log_theta, double *slope) {
    const sought *s = data;
    double theta = exp(log_theta);
    haft_maugis_point point = haft_maugis_at(s->lambda, theta);
    *slope = point.approach_slope * theta;
    return point.approach - s->approach;
}

double haft_maugis_angle(double lambda, double first, double approach) {
    double low = log(first), high = low;
    do {
        low -= 1;
    } while (haft_maugis_at(lambda, exp(low)).approach < approach);
    return exp(haft_root_find(approach_missed, &(sought){lambda, approach}, low, high, false));
}

double haft_maugis_fold_reach(double lambda) {
    return 8.0 / (3 * M_PI) * lambda;
}

double haft_maugis_untouched(double lambda, double approach) {
    double fold = haft_maugis_fold_reach(lambda);
    double square = fold * fold + 2 * (approach + 2 / (M_PI * lambda));
    return fold + sqrt(fmax(square, 0));
}

haft_status haft_maugis_limits(haft_maugis_range *out, double lambda, haft_error *error) {
    if (!(lambda >= HAFT_MAUGIS_LAMBDA_LEAST && lambda <= HAFT_MAUGIS_LAMBDA_MOST)) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "lambda = %g is outside the range from %g to %g", lambda,
                              HAFT_MAUGIS_LAMBDA_LEAST, HAFT_MAUGIS_LAMBDA_MOST);
    }
    double jump = -2 / (M_PI * lambda), fold = haft_maugis_fold_reach(lambda);
    out->jump = jump;
    out->touch = haft_maugis_at(lambda, haft_maugis_first_angle(lambda)).approach;
    out->fold = lambda < haft_maugis_meeting() ? jump - 0.5 * fold * fold : out->touch;
    return HAFT_OK;
}

haft_status haft_maugis_solve(haft_maugis *out, double lambda, double approach, haft_vdw_path path,
                              haft_error *error) {
    haft_maugis_range range;
    HAFT_TRY(haft_maugis_limits(&range, lambda, error));
    if (!(fabs(approach) <= HAFT_MAUGIS_APPROACH_MOST)) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT, "an approach of %g is not within +-%g",
                              approach, HAFT_MAUGIS_APPROACH_MOST);
    }
    *out = (haft_maugis){0};
    if (approach < (path == HAFT_VDW_APPROACH ? range.jump : range.fold)) {
        return HAFT_OK;
    }
    if (approach <= range.touch && lambda < haft_maugis_meeting()) {
        double c = haft_maugis_untouched(lambda, approach);
        *out = (haft_maugis){.force = -0.5 * M_PI * lambda * c * c,
                             .slope = -M_PI * lambda * c / (c - haft_maugis_fold_reach(lambda)),
                             .reach = c};
        return HAFT_OK;
    }
    double first = haft_maugis_first_angle(lambda);
    double theta = approach > range.touch ? haft_maugis_angle(lambda, first, approach) : first;
    haft_maugis_point point = haft_maugis_at(lambda, theta);
    *out = (haft_maugis){.force = point.force,
                         .slope = point.force_slope / point.approach_slope,
                         .radius = point.radius,
                         .reach = point.reach};
    return HAFT_OK;
}
