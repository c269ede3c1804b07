/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two campaigns against each other. A distance of two samples is never 0, even if their laws are
 * one: so it stands beside what it would then be, found by dealing the beams out anew
 * (permutation), and its own error is found by drawing beams with repetition (bootstrap; Efron
 * 1979). */
#include "moments.h"

#include "haft/study_report.h"

#include <math.h>

enum { ROUNDS = 400 };

/* Index below n, of a stream that hangs on nothing but the round and the place. */
static size_t draw_below(size_t n, uint64_t round, uint64_t place, uint64_t draw) {
    uint64_t words[4];
    haft_random_words((haft_random_key){0, HAFT_RANDOM_RESAMPLE}, round, place, draw, words);
    size_t k = (size_t)(haft_random_uniform(words[0]) * (double)n);
    return k < n ? k : n - 1;
}

static size_t gather(const haft_summary *summary, size_t n, double *x, haft_moments *moments) {
    size_t stuck = 0;
    for (size_t k = 0; k < n; k++) {
        haft_moments_add(moments, &summary[k]);
        if (summary[k].outcome == HAFT_OUTCOME_STUCK) {
            x[stuck++] = summary[k].crack_length;
        }
    }
    return stuck;
}

/* Standard error of a standard deviation s, whatever the law: sqrt((m4 - s^4) / (4 s^2 n)). */
static double error_of_deviation(const double *x, const haft_moments *moments) {
    double s = haft_moments_deviation(moments), fourth = 0;
    for (size_t k = 0; k < moments->n; k++) {
        fourth += pow(x[k] - moments->mean, 4) / (double)moments->n;
    }
    return s > 0 ? sqrt(fmax(0, fourth - pow(s, 4)) / (double)moments->n) / (2 * s) : 0;
}

/* Deals the pooled samples out anew (Fisher and Yates). */
static void deal(size_t n, double *x, uint64_t round) {
    for (size_t k = n; k > 1; k--) {
        size_t j = draw_below(k, round, k, 0);
        double swap = x[k - 1];
        x[k - 1] = x[j];
        x[j] = swap;
    }
}

static void measure_by_chance(haft_comparison *out, const double *x, size_t n, const double *y,
                              size_t m, double *room) {
    double sum = 0, squares = 0, chance = 0, mean = 0;
    for (uint64_t round = 0; round < ROUNDS; round++) {
        for (size_t k = 0; k < n; k++) {
            room[k] = x[draw_below(n, round, k, 1)];
        }
        for (size_t k = 0; k < m; k++) {
            room[n + k] = y[draw_below(m, round, k, 2)];
        }
        haft_chaos_sort(n, room);
        haft_chaos_sort(m, room + n);
        double w = haft_chaos_distance_of_samples(n, room, m, room + n).w1, delta = w - mean;
        sum += 1;
        mean += delta / sum;
        squares += delta * (w - mean);
        for (size_t k = 0; k < n + m; k++) {
            room[k] = k < n ? x[k] : y[k - n];
        }
        deal(n + m, room, round);
        haft_chaos_sort(n, room);
        haft_chaos_sort(m, room + n);
        chance += haft_chaos_distance_of_samples(n, room, m, room + n).w1;
    }
    out->w1_error = sqrt(squares / (ROUNDS - 1));
    out->w1_by_chance = chance / ROUNDS;
}

static void compare(haft_comparison *out, double *x, const haft_moments *of_x, double *y,
                    const haft_moments *of_y, double *room) {
    double s = haft_moments_deviation(of_x), r = haft_moments_deviation(of_y);
    size_t n = of_x->n, m = of_y->n;
    out->mean_shift = of_y->mean - of_x->mean;
    out->mean_error = sqrt(s * s / (double)n + r * r / (double)m);
    out->deviation_shift = r - s;
    out->deviation_error = hypot(error_of_deviation(x, of_x), error_of_deviation(y, of_y));
    haft_chaos_sort(n, x);
    haft_chaos_sort(m, y);
    haft_chaos_distance d = haft_chaos_distance_of_samples(n, x, m, y);
    out->ks = d.ks;
    out->ks_chance = haft_study_kolmogorov(d.ks, n, m);
    out->w1 = d.w1;
    measure_by_chance(out, x, n, y, m, room);
}

haft_status haft_study_compare(haft_comparison *out, const haft_summary *reference,
                               size_t references, const haft_summary *summary, size_t n,
                               haft_error *error) {
    haft_moments of_x = {0}, of_y = {0};
    double *x = haft_memory_alloc(2 * (references + n), sizeof *x, error);
    *out = (haft_comparison){0};
    if (x == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    double *y = x + references, *room = y + n;
    out->references = gather(reference, references, x, &of_x);
    out->beams = gather(summary, n, y, &of_y);
    haft_status status = HAFT_OK;
    if (out->references < 2 || out->beams < 2) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "a comparison needs two beams that stuck on either side; there are "
                                "%zu, and %zu of the reference",
                                out->beams, out->references);
    } else {
        compare(out, x, &of_x, y, &of_y, room);
    }
    haft_memory_free(x);
    return status;
}
