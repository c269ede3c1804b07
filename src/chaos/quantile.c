/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CDF and quantile of a line of normals of one bandwidth.
 *
 * The quantile is the root of g = ln(P / p), where P is the CDF or its complement, whichever is
 * to be at most 1/2. Both are sums of positive terms, accurate to rounding in either tail, and g
 * is nearly linear there. Halley's iteration needs only the densities that come with the CDF. It
 * starts from the same root for the centres gathered in bins, which costs at most a tenth and is
 * good to about 1e-5 h, so that one or two evaluations are enough. For a distribution with
 * several modes, every second evaluation must halve the bracket, by bisection if necessary. The
 * initial bracket is exact: a quantile lies between those of the outermost kernels. This
 * iteration is faster than haft_root_find(). */
#include <math.h>

#include "chaos/mixture.h"
#include "chaos/normal.h"

enum { EVALUATIONS = 400, FREE = 4 };

/* Errors in units of h that the last step may leave: of the result, and of the guess from bins. */
#define FINE 1e-15
#define ROUGH 1e-8
#define LAST_BITS 4.5e-16
#define STRONG 0.75

typedef struct root {
    size_t n;
    const double *centre, *weight;
    double h, target;
    double side; /* 1: the CDF, -1: its complement */
    double low, high, x;
} root;

typedef struct step {
    double length;    /* in h */
    double curvature; /* relative difference of Halley's step from Newton's */
    double miss;
} step;

static step look(const root *r) {
    chaos_sums s = haft_chaos_normal_sums(r->n, r->centre, r->weight, r->x, r->side / r->h);
    double ratio = s.pdf / s.cdf;
    double g = log(s.cdf / r->target);
    double curvature = 0.5 * g * (-s.moment / s.cdf - ratio * ratio) / (ratio * ratio);
    return (step){.length = -g / ratio / (1 - curvature), .curvature = curvature, .miss = g};
}

static void solve(root *r, double tolerance) {
    double width[EVALUATIONS];
    for (int k = 0; k < EVALUATIONS; k++) {
        step s = look(r);
        if (s.miss == 0) {
            return;
        }
        if ((s.miss > 0) == (r->side > 0)) {
            r->high = r->x;
        } else {
            r->low = r->x;
        }
        double last = r->x, next = last + r->side * r->h * s.length;
        width[k] = r->high - r->low;
        /* False for NaN. A strongly curved step comes from the flat part between two modes. */
        bool good = next >= r->low && next <= r->high && fabs(s.curvature) <= STRONG;
        /* the next step, because Halley's method is of third order */
        double left = fabs(s.length) * (s.length * s.length + s.curvature * s.curvature);
        if (good && left <= tolerance) {
            r->x = next;
            return;
        }
        if (!good || (k >= FREE && width[k] > 0.5 * width[k - 2])) {
            next = r->low + 0.5 * width[k];
        }
        r->x = next;
        if (fabs(next - last) <= LAST_BITS * (fabs(next) + r->h)) {
            return;
        }
    }
}

double haft_chaos_line_quantile(const chaos_line *line, double p, double q) {
    bool lower = p <= q;
    double tail = lower ? p : q;
    double z = haft_random_normal_quantile(tail);
    root r = {.n = line->n,
              .centre = line->centre,
              .weight = line->weight,
              .h = line->h,
              .target = tail * line->total,
              .side = lower ? 1 : -1};
    double shift = r.side * z * line->h;
    /* Widened by the rounding of the quantile and of the sums. */
    double slack = 1e-13 * (fabs(shift) + fabs(line->low) + fabs(line->high)) + 1e-13 * line->h;
    r.low = line->low + shift - slack;
    r.high = line->high + shift + slack;
    r.x = 0.5 * (r.low + r.high);
    if (line->rough != NULL) {
        root rough = r;
        rough.n = line->rough->n;
        rough.centre = line->rough->centre;
        rough.weight = line->rough->weight;
        solve(&rough, ROUGH);
        r.x = rough.x;
    }
    solve(&r, FINE);
    return r.x;
}

void haft_chaos_line_cdf(const chaos_line *line, double x, double *p, double *q) {
    double below = haft_chaos_normal_sums(line->n, line->centre, line->weight, x, 1 / line->h).cdf;
    double above = haft_chaos_normal_sums(line->n, line->centre, line->weight, x, -1 / line->h).cdf;
    *p = below / line->total;
    *q = above / line->total;
}

double haft_chaos_line_value(const chaos_line *line, double x, double *density) {
    chaos_sums s = haft_chaos_normal_sums(line->n, line->centre, line->weight, x, 1 / line->h);
    *density = s.pdf / (line->total * line->h);
    return s.cdf / line->total;
}
