/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A polynomial in place of an averaged dispersion force, fitted once and evaluated often. */
#include <math.h>

#include "haft/contact.h"

enum { TERMS = HAFT_FAR_FIELD_TERMS, HALF = TERMS / 2, SAMPLES = 600 };

/* t of a distance, and its derivatives. */
typedef struct place {
    double t, first, second, third;
} place;

HAFT_INLINE place place_of(double scale, double far, double d) {
    double q = 1 / (scale + d), t = scale * q;
    return (place){t - far, -t * q, 2 * t * q * q, -6 * t * q * q * q};
}

/* A polynomial's value and derivatives, those over their factorials. */
typedef struct series {
    double value, first, second, third;
} series;

/* HALF terms by Horner's scheme: their number is fixed, and small enough for compilers to unroll
 * them, without which the loop over distances stays plain. */
HAFT_INLINE series half_of(const double *coefficient, double u) {
    series s = {0};
    for (size_t k = HALF; k-- > 0;) {
        s.third = s.third * u + s.second;
        s.second = s.second * u + s.first;
        s.first = s.first * u + s.value;
        s.value = s.value * u + coefficient[k];
    }
    return s;
}

/* Both halves: neither waits for the other, which takes half the time. */
HAFT_INLINE series series_of(const double *coefficient, double u) {
    series low = half_of(coefficient, u), high = half_of(coefficient + HALF, u);
    double u2 = u * u, u4 = u2 * u2, u9 = u4 * u4 * u, u10 = u9 * u, v = u10 * u2;
    double v1 = HALF * u10 * u, v2 = HALF * (HALF - 1) / 2 * u10;
    double v3 = HALF * (HALF - 1) * (HALF - 2) / 6 * u9;
    return (series){low.value + v * high.value, low.first + v * high.first + v1 * high.value,
                    low.second + v * high.second + v1 * high.first + v2 * high.value,
                    low.third + v * high.third + v1 * high.second + v2 * high.first +
                        v3 * high.value};
}
_Static_assert(HALF == 12, "the power between the halves");

/* Which values are asked for. */
typedef enum asked { PRESSURE, NO_CURVATURE, ALL } asked;

/* t = 0 makes all vanish beyond d_out; slack is what d lacks of d_first. A distance that is no
 * number gives none. */
HAFT_INLINE void evaluate_asked(const haft_far_field *field, asked what, size_t n,
                                const double *restrict distance, double *restrict energy,
                                double *restrict pressure, double *restrict slope,
                                double *restrict curvature) {
    const haft_far_field f = *field;
    const double far = f.scale / (f.scale + f.out), k = f.stretch;
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        double d = distance[i] < f.first ? f.first : distance[i];
        double slack = distance[i] < f.first ? distance[i] - f.first : 0;
        place at = place_of(f.scale, far, d > f.out ? f.out : d);
        double t = d < f.out ? at.t : 0;
        series q = series_of(f.coefficient, k * t - 1);
        double c = q.value, c1 = q.first * k, c2 = q.second * 2 * k * k;
        double by_t = t * t * (3 * c + t * c1), by_tt = t * (6 * c + t * (6 * c1 + t * c2));
        double p = by_t * at.first, s = by_tt * at.first * at.first + by_t * at.second;
        pressure[i] = p + slack * s;
        if (what != PRESSURE) {
            energy[i] = t * t * t * c + slack * (p + slack / 2 * s);
            slope[i] = s;
        }
        if (what == ALL) {
            double c3 = q.third * 6 * k * k * k;
            double by_ttt = 6 * c + t * (18 * c1 + t * (9 * c2 + t * c3));
            double bend = by_ttt * at.first * at.first * at.first +
                          3 * by_tt * at.first * at.second + by_t * at.third;
            curvature[i] = distance[i] < f.first || d >= f.out ? 0 : bend;
        }
    }
}

HAFT_CLONES static void evaluate_pressure(const haft_far_field *field, size_t n,
                                          const double *distance,
                                          const haft_far_field_values *out) {
    evaluate_asked(field, PRESSURE, n, distance, NULL, out->pressure, NULL, NULL);
}

HAFT_CLONES static void evaluate_most(const haft_far_field *field, size_t n, const double *distance,
                                      const haft_far_field_values *out) {
    evaluate_asked(field, NO_CURVATURE, n, distance, out->energy, out->pressure, out->slope, NULL);
}

HAFT_CLONES static void evaluate_all(const haft_far_field *field, size_t n, const double *distance,
                                     const haft_far_field_values *out) {
    evaluate_asked(field, ALL, n, distance, out->energy, out->pressure, out->slope, out->curvature);
}

void haft_far_field_evaluate(const haft_far_field *field, size_t n, const double *distance,
                             const haft_far_field_values *out) {
    (out->slope == NULL       ? evaluate_pressure
     : out->curvature == NULL ? evaluate_most
                              : evaluate_all)(field, n, distance, out);
}

/* The points to fit, what is scaled out of them, and room for the equations, a column a term. */
typedef struct fit {
    size_t points, terms;
    const double *distance, *energy, *pressure;
    double most_energy, most_pressure;
    double *weight, *matrix, *right, *value;
} fit;

/* Roots of the arcs of u = cos(angle) that the points stand for. */
static void set_weights(const fit *f, double scale) {
    size_t last = f->points - 1;
    const double *d = f->distance;
    double far = scale / (scale + d[last]), stretch = 2 / place_of(scale, far, d[0]).t;
    for (size_t i = 0; i <= last; i++) {
        double u = stretch * place_of(scale, far, d[i]).t - 1;
        f->value[i] = acos(fmin(fmax(u, -1), 1));
    }
    for (size_t i = 0; i <= last; i++) {
        double arc = f->value[i < last ? i + 1 : last] - f->value[i > 0 ? i - 1 : 0];
        f->weight[i] = sqrt(fmax(arc, 0));
    }
}

/* What an error of x is held against: its own size, lest nothing be left of the tail, but for a
 * share of the greatest. */
static double blend(double x, double most) {
    return fabs(x) + HAFT_FAR_FIELD_SHARE * most;
}

/* Equations 2 i and 2 i + 1 are energy and pressure of point i; the unknowns are those of Chebyshev
 * polynomials in u, which keeps the columns apart. The energy is the one above the last point's,
 * where the field's is nil: else the pressures near there would have to make up for what lies
 * beyond. */
static void set_equations(const fit *f, double scale) {
    size_t rows = 2 * f->points;
    const double *d = f->distance;
    double far = scale / (scale + d[f->points - 1]), stretch = 2 / place_of(scale, far, d[0]).t;
    for (size_t i = 0; i < f->points; i++) {
        place at = place_of(scale, far, d[i]);
        double t = at.t, u = stretch * t - 1, w = f->weight[i];
        double we = w / blend(f->energy[i], f->most_energy);
        double by_pressure = w / blend(f->pressure[i], f->most_pressure);
        double wp = by_pressure * at.first * t * t;
        double c = 1, c1 = 0, before = u, before1 = 1; /* T_0 and T_-1 = T_1 */
        for (size_t k = 0; k < f->terms; k++) {
            double *column = f->matrix + k * rows;
            column[2 * i] = we * t * t * t * c;
            column[2 * i + 1] = wp * (3 * c + t * stretch * c1);
            double next = 2 * u * c - before, next1 = 2 * (c + u * c1) - before1;
            before = c, before1 = c1, c = next, c1 = next1;
        }
        f->right[2 * i] = we * (f->energy[i] - f->energy[f->points - 1]);
        f->right[2 * i + 1] = by_pressure * f->pressure[i];
    }
}

static double dot(const double *a, const double *b, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* Takes column j's Householder vector v off another column: x -= 2 v (v.x)/(v.v). */
static void reflect(const double *v, double square, double *x, size_t n) {
    double part = square > 0 ? 2 * dot(v, x, n) / square : 0;
    for (size_t i = 0; i < n; i++) {
        x[i] -= part * v[i];
    }
}

/* Least squares by Householder's QR (Golub and Van Loan 2013, sec. 5.3.2). A column that depends on
 * those before it, to rounding, gets no part. */
static void solve(const fit *f, double *unknown) {
    size_t rows = 2 * f->points, n = f->terms;
    double corner[TERMS], most = 0;
    for (size_t j = 0; j < n; j++) {
        double *v = f->matrix + j * rows + j;
        size_t rest = rows - j;
        corner[j] = v[0] > 0 ? -sqrt(dot(v, v, rest)) : sqrt(dot(v, v, rest));
        v[0] -= corner[j];
        double square = dot(v, v, rest);
        for (size_t k = j + 1; k < n; k++) {
            reflect(v, square, f->matrix + k * rows + j, rest);
        }
        reflect(v, square, f->right + j, rest);
        most = fmax(most, fabs(corner[j]));
    }
    for (size_t j = n; j-- > 0;) {
        double rest = f->right[j];
        for (size_t k = j + 1; k < n; k++) {
            rest -= f->matrix[k * rows + j] * unknown[k];
        }
        unknown[j] = fabs(corner[j]) > 1e-14 * most ? rest / corner[j] : 0;
    }
}

/* A sum of Chebyshev polynomials as one of powers. */
static void to_powers(const double *part, size_t n, double *power) {
    double now[TERMS] = {1}, before[TERMS] = {0};
    for (size_t k = 0; k < n; k++) {
        double next[TERMS] = {0}, factor = k == 0 ? 1 : 2;
        for (size_t j = 0; j < n; j++) {
            power[j] += part[k] * now[j];
            next[j] = (j > 0 ? factor * now[j - 1] : 0) - before[j];
        }
        for (size_t j = 0; j < n; j++) {
            before[j] = now[j];
            now[j] = next[j];
        }
    }
}

static void set_errors(const fit *f, haft_far_field *out) {
    double *energy = f->value, *pressure = energy + f->points, *slope = pressure + f->points;
    evaluate_most(out, f->points, f->distance,
                  &(haft_far_field_values){energy, pressure, slope, NULL});
    for (size_t i = 0; i < f->points; i++) {
        double e = fabs(energy[i] - f->energy[i]) / f->most_energy;
        double p = fabs(pressure[i] - f->pressure[i]) / f->most_pressure;
        out->energy_error = fmax(out->energy_error, e);
        out->pressure_error = fmax(out->pressure_error, p);
        double own = fabs(pressure[i] - f->pressure[i]) / blend(f->pressure[i], f->most_pressure);
        out->own_error = fmax(out->own_error, own);
    }
}

static haft_far_field fit_at(const fit *f, double scale) {
    haft_far_field out = {
        .first = f->distance[0], .out = f->distance[f->points - 1], .scale = scale, .n = f->terms};
    out.stretch = 2 / place_of(scale, scale / (scale + out.out), out.first).t;
    double part[TERMS];
    set_weights(f, scale);
    set_equations(f, scale);
    solve(f, part);
    to_powers(part, f->terms, out.coefficient);
    set_errors(f, &out);
    return out;
}

static double worst(const haft_far_field *field) {
    return fmax(field->energy_error, field->pressure_error);
}

/* The best of 2 half + 1 scales about a middle, each a factor above the one before. */
static haft_far_field best_of(const fit *f, double middle, double factor, int half) {
    haft_far_field best = fit_at(f, middle);
    for (int i = -half; i <= half; i++) {
        if (i != 0) {
            haft_far_field other = fit_at(f, middle * pow(factor, i));
            best = worst(&other) < worst(&best) ? other : best;
        }
    }
    return best;
}

static haft_status check_points(fit *f, haft_error *error) {
    for (size_t i = 0; i < f->points; i++) {
        double d = f->distance[i], u = f->energy[i], p = f->pressure[i];
        if (!isfinite(d) || !isfinite(u) || !isfinite(p)) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "a far field of %g J/m^2 and %g Pa at %g m", u, p, d);
        }
        if (i == 0 ? d < 0 : d <= f->distance[i - 1]) {
            return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                                  "distance %zu of a far field, %g m, is not above %g m", i + 1, d,
                                  i == 0 ? 0 : f->distance[i - 1]);
        }
        f->most_energy = fmax(f->most_energy, fabs(u));
        f->most_pressure = fmax(f->most_pressure, fabs(p));
    }
    if (!(f->most_energy > 0 && f->most_pressure > 0)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a far field without energy, or without pressure, at all distances");
    }
    return HAFT_OK;
}

haft_status haft_far_field_fit(haft_far_field *out, size_t terms, size_t points,
                               const double *distance, const double *energy, const double *pressure,
                               haft_error *error) {
    fit f = {points, terms, distance, energy, pressure, 0, 0, NULL, NULL, NULL, NULL};
    if (terms < 1 || terms > TERMS || points < 2 || points < terms || points > INT32_MAX) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "a far field of %zu terms through %zu points; give 1 to %d terms and "
                              "as many points, two at least",
                              terms, points, TERMS);
    }
    HAFT_TRY(check_points(&f, error));
    f.matrix = haft_memory_alloc(points * (2 * terms + 6), sizeof *f.matrix, error);
    if (f.matrix == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    f.right = f.matrix + 2 * points * terms;
    f.weight = f.right + 2 * points;
    f.value = f.weight + points;
    double span = distance[points - 1] - distance[0];
    haft_far_field coarse = best_of(&f, span / sqrt(1e3), sqrt(2), 10);
    *out = best_of(&f, coarse.scale, pow(2, 1.0 / 16), 8);
    haft_memory_free(f.matrix);
    return HAFT_OK;
}

/* Distances at which t lies as Chebyshev's points, for a scale between those that are tried. */
static double sample_place(double first, double far, size_t i) {
    double scale = 0.1 * (far - first), end = scale / (scale + far);
    double share = 0.5 + 0.5 * cos(M_PI * (double)i / SAMPLES);
    double t = end + share * (scale / (scale + first) - end);
    return i == 0 ? first : i == SAMPLES ? far : scale / t - scale;
}

haft_status haft_far_field_make(haft_far_field *out, size_t terms, double first, double far,
                                haft_far_field_source *source, const void *context,
                                haft_error *error) {
    double data[3 * (SAMPLES + 1)];
    double *distance = data, *energy = data + SAMPLES + 1, *pressure = energy + SAMPLES + 1;
    if (!(first >= 0 && far > first && isfinite(far))) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                              "a far field from %g to %g m; the first must not be negative, the "
                              "second greater",
                              first, far);
    }
    for (size_t i = 0; i <= SAMPLES; i++) {
        distance[i] = sample_place(first, far, i);
        haft_dispersion_value value = source(context, distance[i]);
        energy[i] = value.energy;
        pressure[i] = value.pressure;
    }
    return haft_far_field_fit(out, terms, SAMPLES + 1, distance, energy, pressure, error);
}
