/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statistics of a campaign. A free beam has no crack length, so means leave it out. For
 * quantiles it is a length that is censored at the beam's end. As all are censored at the same
 * place, the product-limit estimate (Kaplan and Meier 1958) is the empirical distribution below
 * it, and its quantiles are order statistics of all beams with the free ones last. */
#include "moments.h"

#include <math.h>
#include <string.h>

const double haft_study_quantiles[HAFT_STUDY_QUANTILES] = {0.05, 0.5, 0.95};

void haft_moments_add(haft_moments *moments, const haft_summary *one) {
    if (one->outcome == HAFT_OUTCOME_STUCK) {
        double delta = one->crack_length - moments->mean;
        moments->n++;
        moments->mean += delta / (double)moments->n;
        moments->squares += delta * (one->crack_length - moments->mean);
    }
}

double haft_moments_deviation(const haft_moments *moments) {
    return moments->n > 1 ? sqrt(moments->squares / (double)(moments->n - 1)) : NAN;
}

double haft_moments_half_width(const haft_moments *moments, double confidence) {
    haft_interval i =
        haft_study_mean_interval(0, haft_moments_deviation(moments), moments->n, confidence);
    return moments->n > 1 ? i.high : INFINITY;
}

static void take_in(haft_statistics *s, haft_moments *moments, const haft_summary *one) {
    s->run++;
    s->jumps += one->jumps;
    s->seconds += one->seconds;
    s->ledger_error = fmax(s->ledger_error, one->ledger_error);
    s->unfit += (size_t)one->unfit;
    if (isfinite(one->internal_energy)) { /* followed to the end */
        s->internal_energy += one->internal_energy;
        s->dissipated += one->dissipated;
        s->end_influence = fmax(s->end_influence, one->end_influence);
    }
    if (one->outcome == HAFT_OUTCOME_FREE) {
        s->free++;
    } else if (one->outcome != HAFT_OUTCOME_STUCK) {
        s->failed++;
    } else {
        haft_moments_add(moments, one);
        s->least = fmin(s->least, one->crack_length);
        s->greatest = fmax(s->greatest, one->crack_length);
    }
}

/* ---- quantiles ---- */

/* The crack length of a rank, counted from 1, among the beams that stuck: by bisection on the
 * bits of a double, which have the order of positive numbers. This needs no sorted copy, so it
 * cannot fail. */
static double find_ranked(const haft_summary *summary, size_t n, size_t rank) {
    uint64_t low = 0, high = 0x7ff0000000000000; /* +0 and infinity */
    double value;
    while (low < high) {
        uint64_t middle = low + (high - low) / 2;
        size_t below = 0;
        memcpy(&value, &middle, sizeof value);
        for (size_t k = 0; k < n; k++) {
            below += summary[k].outcome == HAFT_OUTCOME_STUCK && summary[k].crack_length <= value;
        }
        if (below >= rank) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    memcpy(&value, &low, sizeof value);
    return value;
}

/* The same among all beams that were followed to the end: free beams come last, at `beyond`. */
static double find_length(const haft_summary *summary, size_t n, size_t stuck, size_t rank,
                          double beyond) {
    return rank == 0 ? -INFINITY : rank > stuck ? beyond : find_ranked(summary, n, rank);
}

static void find_quantiles(haft_statistics *s, const haft_summary *summary, size_t n,
                           double beam_length) {
    size_t followed = s->stuck + s->free;
    for (size_t i = 0; i < HAFT_STUDY_QUANTILES; i++) {
        double p = haft_study_quantiles[i];
        s->quantile[i] = s->quantile_interval[i].low = s->quantile_interval[i].high = NAN;
        if (followed > 0) {
            size_t low, high, rank = (size_t)ceil(p * (double)followed);
            haft_study_quantile_ranks(followed, p, s->confidence, &low, &high);
            s->quantile[i] = find_length(summary, n, s->stuck, rank > 0 ? rank : 1, INFINITY);
            s->quantile_interval[i] = (haft_interval){
                find_length(summary, n, s->stuck, low, beam_length), /* a free one is longer */
                find_length(summary, n, s->stuck, high, INFINITY)};
        }
    }
}

haft_statistics haft_study_statistics(const haft_case *c, const haft_summary *summary, size_t n) {
    haft_statistics s = {.least = INFINITY,
                         .greatest = -INFINITY,
                         .confidence =
                             c->stop.confidence > 0 ? c->stop.confidence : HAFT_STUDY_CONFIDENCE};
    haft_moments moments = {0};
    for (size_t k = 0; k < n; k++) {
        if (summary[k].outcome >= 0) {
            take_in(&s, &moments, &summary[k]);
        }
    }
    s.stuck = moments.n;
    s.mean = moments.mean;
    s.deviation = haft_moments_deviation(&moments);
    s.standard_error = s.deviation / sqrt((double)s.stuck);
    if (s.stuck == 0) {
        s.mean = s.least = s.greatest = NAN;
    }
    s.mean_interval = haft_study_mean_interval(s.mean, s.deviation, s.stuck, s.confidence);
    s.deviation_interval = haft_study_deviation_interval(s.deviation, s.stuck, s.confidence);
    find_quantiles(&s, summary, n, c->beam.length);
    s.stuck_share = (double)s.stuck / (double)(s.stuck + s.free);
    s.stuck_interval = haft_study_share_interval(s.stuck, s.stuck + s.free, s.confidence);
    s.gamma = haft_beam_effective_energy(&c->beam, s.mean);
    double followed = (double)(s.stuck + s.free);
    s.internal_energy = followed > 0 ? s.internal_energy / followed : NAN;
    s.dissipated = followed > 0 ? s.dissipated / followed : NAN;
    if (s.run > 0) {
        s.jumps /= (double)s.run;
        s.seconds /= (double)s.run;
    }
    return s;
}
