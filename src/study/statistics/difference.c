/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Comparison of two sets of beams. With a common seed, beam k of both sets has the same random
 * numbers, and the differences of pairs are more precise than the difference of means. The test
 * of distributions assumes independent sets; for paired sets it rejects too rarely. The distance
 * of two samples is positive even if they have the same distribution. So it is reported beside
 * its mean under permutation of the beams, with a standard error by the bootstrap (Efron 1979). */
#include "haft/study_report.h"

#include <math.h>

enum { EXACT_MOST = 200, EXACT_PATHS = 1000000, ROUNDS = 400 };

/* Sorted crack lengths of the beams that were followed to the end; a free beam counts as longer
 * than any other. */
typedef struct lengths {
    size_t n, stuck;
    double *value;
} lengths;

static haft_status gather(lengths *l, const haft_summary *beam, size_t beams, haft_error *error) {
    *l = (lengths){.value = haft_memory_alloc(beams > 0 ? beams : 1, sizeof(double), error)};
    if (l->value == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    for (size_t k = 0; k < beams; k++) {
        bool stuck = beam[k].outcome == HAFT_OUTCOME_STUCK;
        if (stuck || beam[k].outcome == HAFT_OUTCOME_FREE) {
            l->value[l->n++] = stuck ? beam[k].crack_length : INFINITY;
            l->stuck += stuck;
        }
    }
    haft_chaos_sort(l->n, l->value);
    return HAFT_OK;
}

/* P(distance >= d) by counting. All orders of the n1 + n2 values are equally likely, and an
 * order is a path on the lattice of the two counts; paths that go too far from the diagonal are
 * excluded (Hodges 1958). One row of the lattice is kept, as shares of all paths to it. */
static double count_paths(double distance, size_t n1, size_t n2) {
    double kept[EXACT_MOST + 1];
    double a = (double)n1, b = (double)n2, bound = (0.5 + floor(distance * a * b - 1e-7)) / (a * b);
    for (size_t j = 0; j <= n2; j++) {
        kept[j] = (double)j / b > bound ? 0 : 1;
    }
    for (size_t i = 1; i <= n1; i++) {
        double share = (double)i / ((double)i + b);
        kept[0] = (double)i / a > bound ? 0 : share * kept[0];
        for (size_t j = 1; j <= n2; j++) {
            bool lost = fabs((double)i / a - (double)j / b) > bound;
            kept[j] = lost ? 0 : share * kept[j] + kept[j - 1];
        }
    }
    return fmin(1, fmax(0, 1 - kept[n2]));
}

double haft_study_kolmogorov(double distance, size_t n1, size_t n2) {
    size_t few = n1 < n2 ? n1 : n2, many = n1 < n2 ? n2 : n1;
    if (few == 0 || !isfinite(distance)) {
        return NAN;
    }
    if (few <= EXACT_MOST && many <= EXACT_PATHS / few) {
        return count_paths(distance, many, few);
    }
    double root = sqrt((double)n1 * (double)n2 / ((double)n1 + (double)n2));
    double x = (root + 0.12 + 0.11 / root) * distance, sum = 0;
    if (x < 0.2) {
        return 1; /* to 1e-12, where the series below is slow */
    }
    for (int k = 1; k <= 100; k++) {
        double term = exp(-2.0 * k * k * x * x);
        sum += k % 2 == 1 ? term : -term;
        if (term < 1e-17) {
            break;
        }
    }
    return fmin(1, fmax(0, 2 * sum));
}

/* Newcombe's rule: the distance of each bound is the root of the sum of squares of two single
 * distances. */
static haft_interval newcombe(const double share[2], const haft_interval bound[2]) {
    double difference = share[1] - share[0];
    double down = hypot(share[1] - bound[1].low, bound[0].high - share[0]);
    double up = hypot(bound[1].high - share[1], share[0] - bound[0].low);
    return (haft_interval){difference - down, difference + up};
}

static void compare_pairs(haft_difference *out, const haft_summary *a, const haft_summary *b,
                          size_t beams) {
    double mean[2] = {0}, square[2] = {0}, product = 0, squares = 0;
    size_t n = 0;
    for (size_t k = 0; k < beams; k++) {
        bool stuck[2] = {a[k].outcome == HAFT_OUTCOME_STUCK, b[k].outcome == HAFT_OUTCOME_STUCK};
        bool free[2] = {a[k].outcome == HAFT_OUTCOME_FREE, b[k].outcome == HAFT_OUTCOME_FREE};
        out->switched += (stuck[0] && free[1]) || (free[0] && stuck[1]);
        if (!stuck[0] || !stuck[1]) {
            continue;
        }
        n++;
        double value[2] = {a[k].crack_length, b[k].crack_length}, off[2];
        double d = value[1] - value[0] - (mean[1] - mean[0]);
        for (int i = 0; i < 2; i++) {
            off[i] = value[i] - mean[i];
            mean[i] += off[i] / (double)n;
            square[i] += off[i] * (value[i] - mean[i]);
        }
        product += off[0] * (value[1] - mean[1]);
        squares += d * (value[1] - value[0] - (mean[1] - mean[0]));
    }
    out->pairs = n;
    out->pair_difference = n > 0 ? mean[1] - mean[0] : NAN;
    out->pair_deviation = n > 1 ? sqrt(fmax(0, squares) / (double)(n - 1)) : NAN;
    out->pair_interval =
        haft_study_mean_interval(out->pair_difference, out->pair_deviation, n, out->confidence);
    double spread = sqrt(square[0] * square[1]);
    out->correlation = n > 1 && spread > 0 ? product / spread : NAN;
}

/* ---- what chance does ---- */

/* A random index below n that depends only on the round and the place. */
static size_t draw_below(size_t n, uint64_t round, uint64_t place, uint64_t draw) {
    uint64_t words[4];
    haft_random_words((haft_random_key){0, HAFT_RANDOM_RESAMPLE}, round, place, draw, words);
    size_t k = (size_t)(haft_random_uniform(words[0]) * (double)n);
    return k < n ? k : n - 1;
}

/* Standard error of a standard deviation s, for any distribution: sqrt((m4 - s^4) / (4 s^2 n)). */
static double error_of_deviation(const lengths *l, const haft_statistics *of) {
    double s = of->deviation, fourth = 0;
    for (size_t k = 0; k < l->stuck; k++) {
        fourth += pow(l->value[k] - of->mean, 4) / (double)l->stuck;
    }
    return s > 0 ? sqrt(fmax(0, fourth - pow(s, 4)) / (double)l->stuck) / (2 * s) : 0;
}

/* Shuffles the pooled samples (Fisher and Yates). */
static void deal(size_t n, double *x, uint64_t round) {
    for (size_t k = n; k > 1; k--) {
        size_t j = draw_below(k, round, k, 0);
        double swap = x[k - 1];
        x[k - 1] = x[j];
        x[j] = swap;
    }
}

static void measure_by_chance(haft_difference *out, const double *x, size_t n, const double *y,
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

/* Only for beams that stuck, which come first among the sorted lengths. */
static haft_status compare_stuck(haft_difference *out, const lengths l[2],
                                 const haft_statistics s[2], haft_error *error) {
    size_t n = l[0].stuck, m = l[1].stuck;
    if (n < 2 || m < 2) {
        return HAFT_OK;
    }
    double *room = haft_memory_alloc(n + m, sizeof *room, error);
    if (room == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    out->mean_error = hypot(s[0].standard_error, s[1].standard_error);
    out->deviation_shift = s[1].deviation - s[0].deviation;
    out->deviation_error =
        hypot(error_of_deviation(&l[0], &s[0]), error_of_deviation(&l[1], &s[1]));
    out->w1 = haft_chaos_distance_of_samples(n, l[0].value, m, l[1].value).w1;
    measure_by_chance(out, l[0].value, n, l[1].value, m, room);
    haft_memory_free(room);
    return HAFT_OK;
}

haft_status haft_study_differ(haft_difference *out, const haft_case *first,
                              const haft_summary *first_beam, size_t first_beams,
                              const haft_case *second, const haft_summary *second_beam,
                              size_t second_beams, haft_error *error) {
    haft_statistics s[2] = {haft_study_statistics(first, first_beam, first_beams),
                            haft_study_statistics(second, second_beam, second_beams)};
    double mean[2], deviation[2], share[2];
    size_t n[2];
    haft_interval bound[2];
    lengths l[2] = {{0}, {0}};
    *out = (haft_difference){.confidence = s[0].confidence,
                             .paired = first->seed == second->seed,
                             .mean_error = NAN,
                             .deviation_shift = NAN,
                             .deviation_error = NAN,
                             .w1 = NAN,
                             .w1_error = NAN,
                             .w1_by_chance = NAN,
                             .pair_difference = NAN,
                             .pair_deviation = NAN,
                             .pair_interval = {NAN, NAN},
                             .correlation = NAN};
    haft_status status = gather(&l[0], first_beam, first_beams, error);
    HAFT_THEN(status, gather(&l[1], second_beam, second_beams, error));
    for (int i = 0; i < 2 && status == HAFT_OK; i++) {
        mean[i] = s[i].mean;
        deviation[i] = s[i].deviation;
        n[i] = s[i].stuck;
        share[i] = s[i].stuck_share;
        bound[i] = haft_study_share_interval(l[i].stuck, l[i].n, out->confidence);
    }
    if (status == HAFT_OK) {
        out->difference = mean[1] - mean[0];
        out->difference_interval =
            haft_study_difference_interval(mean, deviation, n, out->confidence);
        bool both = l[0].n > 0 && l[1].n > 0;
        out->distance =
            both ? haft_chaos_distance_of_samples(l[0].n, l[0].value, l[1].n, l[1].value).ks : NAN;
        out->p_value = haft_study_kolmogorov(out->distance, l[0].n, l[1].n);
        out->share_difference = share[1] - share[0];
        out->share_interval = newcombe(share, bound);
        if (out->paired) {
            size_t common = first_beams < second_beams ? first_beams : second_beams;
            compare_pairs(out, first_beam, second_beam, common);
        }
        status = compare_stuck(out, l, s, error);
    }
    haft_memory_free(l[0].value);
    haft_memory_free(l[1].value);
    return status;
}
