/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The crack's tip in the beam's own shape. The beam is cubic in each piece between nodes and patch
 * borders, so the tip is the first root of a cubic, found by Newton's steps and bisection inside
 * monotone stretches: exact to round-off and free of the cubic formula's cancellation. */
#include "sites.h"

#include <math.h>
#include <stdint.h>

static double node_value(const haft_model *model, const double *u, size_t node, int rotation) {
    if (node == 0) {
        return 0;
    }
    size_t i = 2 * (node - 1) + (size_t)rotation;
    return model->data.scale[i] * u[i];
}

/* Coefficients of w in powers of xi = (x - node) / length over element e. */
static void element_cubic(const haft_model *model, const double *u, size_t e, double c[4]) {
    double l = model->data.node_x[e + 1] - model->data.node_x[e];
    double w0 = node_value(model, u, e, 0), w1 = node_value(model, u, e + 1, 0);
    double s0 = l * node_value(model, u, e, 1), s1 = l * node_value(model, u, e + 1, 1);
    c[0] = w0;
    c[1] = s0;
    c[2] = 3 * (w1 - w0) - 2 * s0 - s1;
    c[3] = -2 * (w1 - w0) + s0 + s1;
}

static double cubic(const double c[4], double xi) {
    return ((c[3] * xi + c[2]) * xi + c[1]) * xi + c[0];
}

void haft_model_shape(const haft_model *model, const double *u, double x, double *deflection,
                      double *rotation) {
    size_t e = haft_beam_find_element(model->data.node_x, model->data.nodes, x);
    double l = model->data.node_x[e + 1] - model->data.node_x[e];
    double xi = (x - model->data.node_x[e]) / l;
    double c[4];
    element_cubic(model, u, e, c);
    *deflection = cubic(c, xi);
    *rotation = ((3 * c[3] * xi + 2 * c[2]) * xi + c[1]) / l;
}

void haft_model_carry(const haft_model *from, const haft_model *to, const double *u, double *out) {
    size_t at = 1;
    for (size_t node = 1; node < to->data.nodes; node++) {
        double x = to->data.node_x[node], value[2];
        while (at + 1 < from->data.nodes && from->data.node_x[at] < x) {
            at++;
        }
        if (from->data.node_x[at] == x) {
            value[0] = node_value(from, u, at, 0);
            value[1] = node_value(from, u, at, 1);
        } else {
            haft_model_shape(from, u, x, &value[0], &value[1]);
        }
        size_t i = 2 * (node - 1);
        out[i] = value[0] / to->data.scale[i];
        out[i + 1] = value[1] / to->data.scale[i + 1];
    }
}

typedef struct reached {
    const double *c;
    double level;
} reached;

static double above_level(const void *data, double x, double *slope) {
    const reached *r = data;
    *slope = (3 * r->c[3] * x + 2 * r->c[2]) * x + r->c[1];
    return cubic(r->c, x) - r->level;
}

/* First xi in [a, b] with w(xi) >= level, or NaN. */
static double first_reach(const double c[4], double level, double a, double b) {
    if (cubic(c, a) >= level) {
        return a;
    }
    double stop[4] = {a, b, b, b};
    int stops = 1;
    double p = 2 * c[2], q = p * p - 12 * c[3] * c[1];
    if (q > 0) {
        double t = -0.5 * (p + copysign(sqrt(q), p));
        double r1 = t / (3 * c[3]), r2 = t == 0 ? NAN : c[1] / t;
        double low = fmin(r1, r2), high = fmax(r1, r2);
        if (low > a && low < b) {
            stop[stops++] = low;
        }
        if (high > a && high < b && high > low) {
            stop[stops++] = high;
        }
    }
    stop[stops] = b;
    for (int i = 0; i < stops; i++) {
        if (cubic(c, stop[i + 1]) >= level) {
            return haft_root_find(above_level, &(reached){c, level}, stop[i], stop[i + 1], true);
        }
    }
    return NAN;
}

/* No less than the greatest w over an element: that of its cubic's control polygon, and a margin
 * for rounding. */
static double bound(const double c[4], double gap) {
    const double third = 1.0 / 3;
    double start = c[0], first = c[0] + c[1] * third, second = first + (c[1] + c[2]) * third;
    double end = c[0] + c[1] + c[2] + c[3];
    return larger(larger(start, first), larger(second, end)) + 1e-12 * gap;
}

double haft_model_crack_length(const haft_model *model, const double *reach, const double *u) {
    double end = model->data.nodes > 0 ? model->data.node_x[model->data.nodes - 1] : 0;
    double left = 0, c[4], most = 0;
    size_t e = 0, known = SIZE_MAX;
    for (size_t r = 0; r < model->data.sites && model->data.nodes > 0; r++) {
        double right = r + 1 < model->data.sites
                           ? 0.5 * (model->data.site[r].x + model->data.site[r + 1].x)
                           : end;
        double level = model->data.gap - reach[r];
        if (known == e && most < level && right < model->data.node_x[e + 1]) {
            left = right; /* nowhere on the element does the beam come so near */
            continue;
        }
        while (left < right) {
            while (e + 2 < model->data.nodes && model->data.node_x[e + 1] <= left) {
                e++;
            }
            if (e != known) {
                element_cubic(model, u, e, c);
                most = bound(c, model->data.gap);
                known = e;
            }
            double x0 = model->data.node_x[e], l = model->data.node_x[e + 1] - x0;
            double stop = fmin(right, model->data.node_x[e + 1]);
            double xi = NAN;
            if (!(most < level)) {
                xi = first_reach(c, level, (left - x0) / l, fmin(1, (stop - x0) / l));
            }
            if (!isnan(xi)) {
                return x0 + xi * l;
            }
            left = stop;
        }
    }
    return end;
}
