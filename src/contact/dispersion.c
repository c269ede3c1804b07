/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dispersion forces of two plane faces: Hamaker constants of layers, and Gregory's retardation. */
#include "contact/dispersion.h"

#include <math.h>

static bool is_positive(double x) {
    return x > 0 && isfinite(x);
}

static haft_status check_layer(const char *name, double hamaker, const double *thickness,
                               haft_error *error) {
    for (int face = 0; face < 2; face++) {
        if (!(thickness[face] >= 0 && thickness[face] <= HAFT_DISPERSION_LENGTH_MOST)) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "the %s of face %d is %g m thick; give 0 to %g m", name, face + 1,
                                  thickness[face], HAFT_DISPERSION_LENGTH_MOST);
        }
    }
    if ((thickness[0] > 0 || thickness[1] > 0) && !is_positive(hamaker)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "the %s has a Hamaker constant of %g J; it must be positive", name,
                              hamaker);
    }
    return HAFT_OK;
}

haft_status haft_dispersion_check(const haft_dispersion *law, haft_error *error) {
    if (!is_positive(law->substrate)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "the substrate has a Hamaker constant of %g J; it must be positive",
                              law->substrate);
    }
    HAFT_TRY(check_layer("oxide", law->oxide, law->oxide_thickness, error));
    HAFT_TRY(check_layer("film", law->film, law->film_thickness, error));
    if (!(law->retardation >= 0 && isfinite(law->retardation))) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a retardation wavelength of %g m; give a positive one, or 0 for "
                              "none",
                              law->retardation);
    }
    if (!(law->cut_off >= HAFT_DISPERSION_CUT_OFF_LEAST &&
          law->cut_off <= HAFT_DISPERSION_LENGTH_MOST)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT, "a cut-off of %g m; give %g m, the distance of atoms, to %g m",
            law->cut_off, HAFT_DISPERSION_CUT_OFF_LEAST, HAFT_DISPERSION_LENGTH_MOST);
    }
    return HAFT_OK;
}

enum { INTERFACES = 3 };

typedef struct interfaces {
    size_t n;
    double amplitude[INTERFACES], depth[INTERFACES];
} interfaces;

/* The interface below what the face has so far, to a material of this Hamaker constant. */
static void add_interface(interfaces *face, double hamaker, double depth, double *above) {
    double root = sqrt(hamaker);
    face->amplitude[face->n] = root - *above;
    face->depth[face->n++] = depth;
    *above = root;
}

static interfaces interfaces_of(const haft_dispersion *law, int face) {
    interfaces all = {0};
    double above = 0, depth = 0; /* vacuum has no Hamaker constant */
    if (law->film_thickness[face] > 0) {
        add_interface(&all, law->film, depth, &above);
        depth += law->film_thickness[face];
    }
    if (law->oxide_thickness[face] > 0) {
        add_interface(&all, law->oxide, depth, &above);
        depth += law->oxide_thickness[face];
    }
    add_interface(&all, law->substrate, depth, &above);
    return all;
}

haft_dispersion_terms haft_dispersion_terms_of(const haft_dispersion *law) {
    interfaces one = interfaces_of(law, 0), other = interfaces_of(law, 1);
    haft_dispersion_terms terms = {.rate = law->retardation > 0 ? 5.32 / law->retardation : 0};
    for (size_t i = 0; i < one.n; i++) {
        for (size_t j = 0; j < other.n; j++) {
            terms.amount[terms.n] = one.amplitude[i] * other.amplitude[j] / (12 * M_PI);
            terms.depth[terms.n++] = one.depth[i] + other.depth[j];
        }
    }
    return terms;
}

haft_dispersion_value haft_dispersion_sum(const haft_dispersion_terms *terms, double gap) {
    haft_dispersion_value sum = {0};
    for (size_t i = 0; i < terms->n; i++) {
        double x = gap + terms->depth[i], u = terms->rate * x, v = 1 + u;
        double part = terms->amount[i] / (x * x * v);
        sum.energy -= part;
        part /= x * v;
        sum.pressure += part * (2 + 3 * u);
        sum.slope -= part / (x * v) * (6 + 16 * u + 12 * u * u);
    }
    return sum;
}

haft_dispersion_value haft_dispersion_at(const haft_dispersion *law, double gap) {
    haft_dispersion_terms terms = haft_dispersion_terms_of(law);
    return haft_dispersion_sum(&terms, gap);
}

/* ln(1/(1 - y))/y */
static double log_ratio(double y) {
    return y > 0 ? -log1p(-y) / y : 1;
}

/* The means are divided differences of the integral, of W and of dW/dg, with the factor b - a
 * cancelled by hand. With D(x) = x^2 + r x^3 and N = D':
 *     integral of 1/D = -1/x - r ln(x/(1 + r x)),    W = -1/D,    dW/dg = N/D^2. */
haft_dispersion_value haft_dispersion_mean(const haft_dispersion_terms *terms, double low,
                                           double high) {
    haft_dispersion_value sum = {0};
    double r = terms->rate;
    for (size_t i = 0; i < terms->n; i++) {
        double a = low + terms->depth[i], b = high + terms->depth[i], k = terms->amount[i];
        double va = 1 + r * a, vb = 1 + r * b, da = a * a * va, db = b * b * vb;
        double rise = a + b + r * (a * a + a * b + b * b); /* of D */
        double nb = b * (2 + 3 * r * b), bend = 2 + 3 * r * (a + b);
        sum.energy -= k * (1 / (a * b) - r / (b * va) * log_ratio((b - a) / (b * va)));
        sum.pressure += k * rise / (da * db);
        sum.slope += k * (bend / da - nb * rise * (1 / da + 1 / db) / db) / da;
    }
    return sum;
}
