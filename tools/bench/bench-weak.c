/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the push limit of Morse laws does to weak pulls. For all curves in CASE/out/laws.h5 compares
 * their energy with the least energy of a Morse law that has the same greatest pull and wall: that
 * of its left wing alone, f_max / (2 a_left). If this bound is greater than the curve's energy, no
 * Morse law has that energy; a fit that makes one nevertheless has at least the energy of the wing.
 *
 *     bench-weak CASE [LIMIT in MPa, 5 if left out]
 *
 * Prints a line of means to the error output, and the law vectors as CSV for haft-laws fit.
 * Energies below the bound are raised to just above it, so that each vector has a Morse law. */
#include "bench.h"

#include "haft/io.h"

#include <math.h>

/* Factor from the bound to a raised energy. With it the right wing falls 50 times as fast as the
 * left. */
static const double ABOVE = 1.03;

/* Reads the vector of a curve, at its deepest well if there are several. @return false if it has no
 * wall */
static bool read_off(const haft_laws *laws, const double *force, double limit, haft_law_vector *v) {
    size_t at = 0;
    for (size_t i = 1; i < laws->n; i++) {
        at = force[i] < force[at] ? i : at;
    }
    size_t wall = at;
    while (wall > 0 && force[wall] < limit) {
        wall--;
    }
    if (!(force[at] < 0) || force[wall] < limit) {
        return false;
    }
    const double *d = laws->distance;
    double part = (force[wall] - limit) / (force[wall] - force[wall + 1]);
    *v = (haft_law_vector){.e = haft_law_energy(laws->n, d, force),
                           .f_max = -force[at],
                           .d_max = d[at],
                           .d_limit = d[wall] + part * (d[wall + 1] - d[wall])};
    return v->e > 0;
}

static double wing(const haft_law_vector *v, double limit) {
    return 0.5 * v->f_max * (v->d_max - v->d_limit) / log1p(sqrt(1 + limit / v->f_max));
}

int main(int count, char **arguments) {
    double limit = 1e6 * (count > 2 ? atof(arguments[2]) : 5);
    if (count < 2 || !(limit > 0)) {
        fprintf(stderr, "bench-weak: bench-weak CASE [LIMIT in MPa]\n");
        return 2;
    }
    haft_error error = {0};
    haft_laws *laws = NULL;
    char digest[HAFT_DIGEST_CAPACITY], path[HAFT_PATH_CAPACITY];
    snprintf(path, sizeof path, "%s/out/laws.h5", arguments[1]);
    must(haft_laws_read(&laws, digest, path, &error), &error);
    double own = 0, least = 0, raised = 0;
    size_t n = 0, below = 0;
    printf("e [J/m2],f_max [Pa],d_max [m],d_limit [m]\n");
    for (size_t k = 0; k < laws->m; k++) {
        const double *curve = haft_laws_curve(laws, k);
        haft_law_vector v;
        if (curve == NULL || !read_off(laws, curve, limit, &v)) {
            continue;
        }
        double bound = wing(&v, limit);
        own += v.e;
        least += bound;
        below += v.e <= bound;
        v.e = fmax(v.e, ABOVE * bound);
        raised += v.e;
        n++;
        printf("%.12g,%.12g,%.12g,%.12g\n", v.e, v.f_max, v.d_max, v.d_limit);
    }
    fprintf(stderr,
            "push limit %g MPa: %zu curves of %zu; energy %.3g mJ/m2 on average, of the left wing "
            "%.3g; %zu below the wing's, raised %.3g\n",
            1e-6 * limit, n, laws->m, 1e3 * own / (double)n, 1e3 * least / (double)n, below,
            1e3 * raised / (double)n);
    haft_laws_destroy(&laws);
    return n > 0 ? 0 : 1;
}
