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

haft_status haft_study_write_summary(const haft_summary *summary, size_t n, const char *path,
                                     haft_error *error) {
    enum { COLUMNS = 9 };
    double *flat = haft_memory_alloc(n * COLUMNS, sizeof *flat, error);
    if (flat == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    static const char *const name[COLUMNS] = {
        "realization",     "outcome",   "crack length [um]", "loaded crack length [um]",
        "Gamma [mJ/m2]",   "work [pJ]", "dissipated [pJ]",   "jumps",
        "ledger error [1]"};
    haft_csv_column column[COLUMNS];
    for (size_t k = 0; k < n; k++) {
        const haft_summary *s = &summary[k];
        double row[COLUMNS] = {
            (double)k,      s->outcome,     s->crack_length * 1e6, s->loaded_crack_length * 1e6,
            s->gamma * 1e3, s->work * 1e12, s->dissipated * 1e12,  s->jumps,
            s->ledger_error};
        for (int i = 0; i < COLUMNS; i++) {
            flat[k * COLUMNS + (size_t)i] = row[i];
        }
    }
    for (int i = 0; i < COLUMNS; i++) {
        column[i] = (haft_csv_column){name[i], flat + i, COLUMNS, 1};
    }
    haft_status status = haft_csv_write(path, n, COLUMNS, column, error);
    haft_memory_free(flat);
    return status;
}
