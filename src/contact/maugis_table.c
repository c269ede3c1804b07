/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Table of the touching branch: polynomials in two variables on a grid of cells.
 *
 * The branch begins with a square root of the approach, so the variables are log(lambda) and (1 +
 * s)^(-1/2). s^2 is the approach above the beginning of the branch: its fold or, if that is on the
 * other branch, the point contact. The table contains force and radius minus their growth with s.
 * At one lambda, the meeting, both beginnings coincide, and the branch is not a smooth function of
 * s. Strips end there. Cells that do not reach the stated accuracy at points between their nodes,
 * as some near the meeting, are marked and solved directly. So are approaches beyond the last
 * cell. */
#include <math.h>

#include "contact/maugis.h"

enum {
    NODES = 6, /* of a cell, in each direction */
    CHECKS = 5,
    BELOW = 54, /* strips below and above the meeting */
    ABOVE = 26,
    STRIPS = BELOW + ABOVE,
    CELLS = 24, /* of a strip, along s */
    FIRST_NODES = 10,
};
static const double S_END = 40;
/* Half of the stated accuracy, because a cell is checked only at some points. */
static const double TOLERANCE = 0.5 * HAFT_MAUGIS_ACCURACY;

/* Coefficients of powers of the place in lambda (first index) and in s; those of force and radius
 * alternate. */
typedef struct table_cell {
    bool sound;
    double c[NODES][2 * NODES];
} table_cell;

typedef struct table_strip {
    double first[FIRST_NODES]; /* first angle, as powers of the place in lambda */
    table_cell cell[CELLS];
} table_strip;

struct haft_maugis_table {
    table_strip strip[STRIPS];
};

/* Chebyshev nodes, and the conversion of values there to coefficients of powers, in place. */
static double node(int i, int n) {
    return cos(M_PI * (i + 0.5) / n);
}

static void make_powers(double *values, int n, int stride) {
    double powers[FIRST_NODES] = {0}, t[2][FIRST_NODES] = {{1}, {0, 1}};
    for (int k = 0; k < n; k++) {
        double sum = 0;
        for (int i = 0; i < n; i++) {
            sum += values[i * stride] * cos(M_PI * k * (i + 0.5) / n);
        }
        double weight = sum * (k == 0 ? 1.0 : 2.0) / n;
        double *now = t[k % 2], *last = t[(k + 1) % 2];
        for (int i = 0; i < n; i++) {
            powers[i] += weight * now[i];
        }
        if (k > 0) { /* T_{k+1} = 2 x T_k - T_{k-1} replaces T_{k-1} */
            for (int i = n - 1; i >= 0; i--) {
                last[i] = (i > 0 ? 2 * now[i - 1] : 0) - last[i];
            }
        }
    }
    for (int i = 0; i < n; i++) {
        values[i * stride] = powers[i];
    }
}

/* The strip of a lambda and the place in it, -1 to 1. */
static int find_strip(double lambda, double *place) {
    double meeting = haft_maugis_meeting();
    bool below = lambda <= meeting;
    double from = below ? HAFT_MAUGIS_LAMBDA_LEAST : meeting;
    double to = below ? meeting : HAFT_MAUGIS_LAMBDA_MOST;
    int strips = below ? BELOW : ABOVE;
    double x = log(lambda / from) / log(to / from) * strips;
    int k = x > 0 ? (int)x : 0;
    k = k < strips ? k : strips - 1;
    *place = 2 * (x - k) - 1;
    return below ? k : BELOW + k;
}

static double lambda_at(int k, double place) {
    double meeting = haft_maugis_meeting();
    bool below = k < BELOW;
    double from = below ? HAFT_MAUGIS_LAMBDA_LEAST : meeting;
    double to = below ? meeting : HAFT_MAUGIS_LAMBDA_MOST;
    double x = ((below ? k : k - BELOW) + 0.5 * (1 + place)) / (below ? BELOW : ABOVE);
    return from * pow(to / from, x);
}

/* The cells are uniform in t = (1 + s)^(-1/2). */
static double cell_width(void) {
    return (1 - 1 / sqrt(1 + S_END)) / CELLS;
}

static double s_at(int k, double place) {
    double t = 1 - (k + 0.5 * (1 + place)) * cell_width();
    return 1 / (t * t) - 1;
}

/* The growth of force and radius with s, which is not tabulated. */
static void growth(double begin, double s, double out[2]) {
    out[0] = s * (s * s + 1.5 * begin);
    out[1] = s;
}

/* Force and radius minus their growth, by direct solution; `first` is the first angle. */
static void solve(double lambda, double first, double begin, double s, double out[2]) {
    double theta = s > 0 ? haft_maugis_angle(lambda, first, begin + s * s) : first;
    haft_maugis_point point = haft_maugis_at(lambda, theta);
    double less[2];
    growth(begin, s, less);
    out[0] = point.force - less[0];
    out[1] = point.radius - less[1];
}

static inline void evaluate(const table_cell *cell, double place_s, double place, double out[2]) {
    double row[2 * NODES];
    for (int i = 0; i < 2 * NODES; i++) {
        row[i] = cell->c[NODES - 1][i];
    }
    for (int j = NODES - 2; j >= 0; j--) {
        for (int i = 0; i < 2 * NODES; i++) {
            row[i] = row[i] * place + cell->c[j][i];
        }
    }
    double force = row[2 * NODES - 2], radius = row[2 * NODES - 1];
    for (int i = 2 * NODES - 4; i >= 0; i -= 2) {
        force = force * place_s + row[i];
        radius = radius * place_s + row[i + 1];
    }
    out[0] = force;
    out[1] = radius;
}

/* Fills a column of values in all cells of a strip, at one lambda. */
static void fill_column(table_strip *strip, int k, int j) {
    double lambda = lambda_at(k, node(j, NODES)), first = haft_maugis_first_angle(lambda);
    double begin = haft_maugis_at(lambda, first).approach;
    for (int l = 0; l < CELLS; l++) {
        for (int i = 0; i < NODES; i++) {
            solve(lambda, first, begin, s_at(l, node(i, NODES)), &strip->cell[l].c[j][2 * i]);
        }
    }
}

/* Marks the cells of a strip as unsound that are not accurate enough between the nodes. */
static void check_column(table_strip *strip, int k, double place) {
    double lambda = lambda_at(k, place), first = haft_maugis_first_angle(lambda);
    double begin = haft_maugis_at(lambda, first).approach;
    for (int l = 0; l < CELLS; l++) {
        for (int i = 0; i < CHECKS && strip->cell[l].sound; i++) {
            double place_s = -1 + 2.0 * i / (CHECKS - 1), exact[2], found[2];
            solve(lambda, first, begin, s_at(l, place_s), exact);
            evaluate(&strip->cell[l], place_s, place, found);
            strip->cell[l].sound =
                fabs(found[0] - exact[0]) <= TOLERANCE && fabs(found[1] - exact[1]) <= TOLERANCE;
        }
    }
}

static void fill_strip(table_strip *strip, int k) {
    for (int i = 0; i < FIRST_NODES; i++) {
        strip->first[i] = haft_maugis_first_angle(lambda_at(k, node(i, FIRST_NODES)));
    }
    make_powers(strip->first, FIRST_NODES, 1);
    for (int j = 0; j < NODES; j++) {
        fill_column(strip, k, j);
    }
    for (int l = 0; l < CELLS; l++) {
        table_cell *cell = &strip->cell[l];
        for (int i = 0; i < 2 * NODES; i++) {
            make_powers(&cell->c[0][i], NODES, 2 * NODES);
        }
        for (int j = 0; j < NODES; j++) {
            make_powers(&cell->c[j][0], NODES, 2);
            make_powers(&cell->c[j][1], NODES, 2);
        }
        cell->sound = true;
    }
    for (int j = 0; j < CHECKS; j++) {
        check_column(strip, k, -1 + 2.0 * j / (CHECKS - 1));
    }
}

haft_status haft_maugis_table_create(haft_maugis_table **out, haft_error *error) {
    *out = haft_memory_alloc(1, sizeof **out, error);
    if (*out == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (int k = 0; k < STRIPS; k++) {
        fill_strip(&(*out)->strip[k], k);
    }
    return HAFT_OK;
}

void haft_maugis_table_destroy(haft_maugis_table **table) {
    if (table != NULL && *table != NULL) {
        haft_memory_free(*table);
        *table = NULL;
    }
}

double haft_maugis_table_gaps(const haft_maugis_table *table) {
    double gaps = 0;
    for (int k = 0; k < STRIPS; k++) {
        for (int l = 0; l < CELLS; l++) {
            gaps += !table->strip[k].cell[l].sound;
        }
    }
    return gaps / (STRIPS * CELLS);
}

/* The approach at which the touching branch begins. Below the meeting it is exact. Above, its error
 * is the square of the angle's, since the approach has a minimum there. */
static double find_begin(const table_strip *strip, bool below, double lambda, double place) {
    double first = 0.5 * M_PI;
    if (!below) {
        first = strip->first[FIRST_NODES - 1];
        for (int i = FIRST_NODES - 2; i >= 0; i--) {
            first = first * place + strip->first[i];
        }
    }
    return haft_maugis_at(lambda, first).approach;
}

haft_maugis_curve haft_maugis_curve_of(const haft_maugis_table *table, double lambda,
                                       haft_vdw_path path) {
    lambda = fmin(fmax(lambda, HAFT_MAUGIS_LAMBDA_LEAST), HAFT_MAUGIS_LAMBDA_MOST);
    haft_maugis_curve curve = {.table = table, .lambda = lambda};
    curve.strip = find_strip(lambda, &curve.place);
    const table_strip *strip = &table->strip[curve.strip];
    curve.begin = find_begin(strip, curve.strip < BELOW, lambda, curve.place);
    double jump = -2 / (M_PI * lambda), fold = haft_maugis_fold_reach(lambda);
    if (path == HAFT_VDW_APPROACH) {
        curve.end = jump;
    } else {
        curve.end = curve.strip < BELOW ? jump - 0.5 * fold * fold : curve.begin;
    }
    return curve;
}

double haft_maugis_force(const haft_maugis_curve *curve, double approach, double *radius) {
    *radius = 0;
    if (approach < curve->end) {
        return 0;
    }
    double square = approach - curve->begin;
    if (square < 0) {
        double c = haft_maugis_untouched(curve->lambda, approach);
        return -0.5 * M_PI * curve->lambda * c * c;
    }
    double s = sqrt(square), x = (1 - 1 / sqrt(1 + s)) / cell_width(), value[2], grown[2];
    const table_cell *cell = x < CELLS ? &curve->table->strip[curve->strip].cell[(int)x] : NULL;
    if (cell != NULL && cell->sound) {
        evaluate(cell, 2 * (x - (int)x) - 1, curve->place, value);
    } else {
        double first = haft_maugis_first_angle(curve->lambda);
        solve(curve->lambda, first, haft_maugis_at(curve->lambda, first).approach, s, value);
    }
    growth(curve->begin, s, grown);
    *radius = value[1] + grown[1];
    return value[0] + grown[0];
}

double haft_maugis_lookup(const haft_maugis_table *table, double lambda, double approach,
                          haft_vdw_path path, double *radius) {
    haft_maugis_curve curve = haft_maugis_curve_of(table, lambda, path);
    return haft_maugis_force(&curve, approach, radius);
}
