/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statistics of a campaign. Free beams have no crack length within the beam: they are counted, not
 * averaged. */
#include "haft/study.h"

#include <math.h>

static void take_in(haft_statistics *s, const haft_summary *one) {
    s->run++;
    s->jumps += one->jumps;
    s->seconds += one->seconds;
    s->ledger_error = fmax(s->ledger_error, one->ledger_error);
    s->unfit += (size_t)one->unfit;
    if (one->outcome == HAFT_OUTCOME_FREE) {
        s->free++;
    } else if (one->outcome != HAFT_OUTCOME_STUCK) {
        s->failed++;
    } else {
        double delta = one->crack_length - s->mean; /* Welford's running mean and squares */
        s->stuck++;
        s->mean += delta / (double)s->stuck;
        s->deviation += delta * (one->crack_length - s->mean);
        s->least = fmin(s->least, one->crack_length);
        s->greatest = fmax(s->greatest, one->crack_length);
    }
}

haft_statistics haft_study_statistics(const haft_case *c, const haft_summary *summary, size_t n) {
    haft_statistics s = {.least = INFINITY, .greatest = -INFINITY};
    for (size_t k = 0; k < n; k++) {
        if (summary[k].outcome >= 0) {
            take_in(&s, &summary[k]);
        }
    }
    double stuck = (double)s.stuck;
    s.deviation = s.stuck > 1 ? sqrt(s.deviation / (stuck - 1)) : NAN;
    s.standard_error = s.deviation / sqrt(stuck);
    if (s.stuck == 0) {
        s.mean = s.least = s.greatest = NAN;
    }
    s.gamma = haft_beam_effective_energy(&c->beam, s.mean);
    if (s.run > 0) {
        s.jumps /= (double)s.run;
        s.seconds /= (double)s.run;
    }
    return s;
}
