/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rough patches made without the surface room, and their curves: what the contact tests share. */
#ifndef HAFT_TEST_ROUGH_PATCH_H
#define HAFT_TEST_ROUGH_PATCH_H

#include "check.h"

#include "haft/contact.h"

enum { LEVELS = 24, MOST = 80 * 96 };

typedef struct answer {
    haft_curve curve;
    double distance[LEVELS], force[LEVELS], contact[LEVELS], wet[LEVELS], number[LEVELS];
} answer;

static const haft_contact_spec wet_spec = {.modulus = 80e9,
                                           .has_capillary = true,
                                           .pressure = -22.5e6,
                                           .capillary_range = 0x1p-27}; /* 7.45 nm */

static inline haft_contact_spec spec_of(haft_asperity_model model) {
    haft_contact_spec spec = wet_spec;
    spec.asperities = model;
    return spec;
}

static inline haft_status try_curve(answer *a, const haft_contact_spec *spec, const double *z,
                                    size_t rows, size_t columns, double step, double low,
                                    double high, haft_error *error) {
    for (int i = 0; i < LEVELS; i++) {
        a->distance[i] = low + (high - low) * i / (LEVELS - 1);
    }
    a->curve = (haft_curve){LEVELS, a->distance, a->force, a->contact, a->wet, a->number};
    haft_contact_work *work = NULL;
    check_ok(haft_contact_work_create(&work, rows, columns, error), *error);
    haft_status status = haft_contact_curve(work, spec, z, rows, columns, step, &a->curve, error);
    haft_contact_work_destroy(&work);
    assert_null(work);
    return status;
}

static inline void get_curve(answer *a, const haft_contact_spec *spec, const double *z, size_t rows,
                             size_t columns, double step, double low, double high) {
    haft_error error = {0};
    check_ok(try_curve(a, spec, z, rows, columns, step, low, high, &error), error);
}

/* A rough patch of 60 random waves, 3 nm rms, the shortest of `shortest` steps, rounded to
 * multiples of `quantum`. */
static inline void make_waves(double *z, size_t rows, size_t columns, uint64_t which,
                              double shortest, double quantum) {
    static double sum[MOST];
    memset(sum, 0, sizeof sum);
    for (uint64_t k = 0; k < 60; k++) {
        uint64_t words[4];
        haft_random_words((haft_random_key){11, HAFT_RANDOM_TEST}, which, k, 0, words);
        double number = 2 * M_PI / shortest * sqrt(haft_random_uniform(words[0]));
        double angle = 2 * M_PI * haft_random_uniform(words[1]);
        double phase = 2 * M_PI * haft_random_uniform(words[2]);
        double c[100], d[100];
        for (size_t j = 0; j < columns; j++) {
            c[j] = cos(number * sin(angle) * (double)j);
            d[j] = sin(number * sin(angle) * (double)j);
        }
        for (size_t i = 0; i < rows; i++) {
            double a = cos(number * cos(angle) * (double)i + phase);
            double b = sin(number * cos(angle) * (double)i + phase);
            for (size_t j = 0; j < columns; j++) {
                sum[i * columns + j] += 3e-9 * sqrt(2.0 / 60) * (a * c[j] - b * d[j]);
            }
        }
    }
    for (size_t p = 0; p < rows * columns; p++) {
        z[p] = round(sum[p] / quantum) * quantum;
    }
}

static inline void make_patch(double *z, size_t rows, size_t columns, uint64_t which,
                              double quantum) {
    make_waves(z, rows, columns, which, 5.7, quantum);
}

#endif
