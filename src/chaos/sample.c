/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The samplers. A draw has four words and a germ at most four components, so draw 0 contains a
 * whole germ. The samplers gpce and exact read the same germ: their difference is only the
 * truncation. */
#include <math.h>

#include "chaos/model.h"

enum { N = HAFT_CHAOS_DIMENSION };

typedef struct stream {
    haft_random_key key;
    uint64_t realization;
} stream;

static void draw_uniforms(const stream *s, uint64_t site, uint64_t draw, double u[N]) {
    uint64_t words[N];
    haft_random_words(s->key, s->realization, site, draw, words);
    for (int i = 0; i < N; i++) {
        u[i] = haft_random_uniform(words[i]);
    }
}

static haft_law_vector vector_from_eta(const haft_chaos *chaos, const double *eta) {
    double q[N];
    haft_chaos_q_from_eta(chaos, eta, q);
    return haft_chaos_vector_from_q(chaos, q);
}

static void sample_gpce(const haft_chaos *chaos, const stream *s, uint64_t first, size_t n,
                        haft_law_vector *vector) {
    const haft_chaos_parts *p = &chaos->parts;
    double x[N][HAFT_SIMD_WIDTH] = {{0}}, out[N][HAFT_SIMD_WIDTH];
    for (size_t start = 0; start < n; start += HAFT_SIMD_WIDTH) {
        size_t count = n - start < HAFT_SIMD_WIDTH ? n - start : HAFT_SIMD_WIDTH;
        for (size_t l = 0; l < count; l++) {
            double u[N];
            draw_uniforms(s, first + start + l, 0, u);
            for (size_t i = 0; i < p->components; i++) {
                x[i][l] = haft_chaos_germ_quantile(p->germ, u[i]);
            }
        }
        haft_chaos_expand_together(chaos, x, out);
        for (size_t l = 0; l < count; l++) {
            double eta[N];
            for (size_t i = 0; i < p->components; i++) {
                eta[p->component_order[i]] = out[i][l];
            }
            vector[start + l] = vector_from_eta(chaos, eta);
        }
    }
}

static haft_law_vector sample_exact(const haft_chaos *chaos, haft_chaos_work *work, const stream *s,
                                    uint64_t site) {
    const haft_chaos_parts *p = &chaos->parts;
    double u[N], x[N], eta[N];
    draw_uniforms(s, site, 0, u);
    for (size_t i = 0; i < p->components; i++) {
        chaos_line line = haft_chaos_mixture_condition(&chaos->mixture, work, i, x);
        x[i] = haft_chaos_line_quantile(&line, u[i], 1 - u[i]);
        eta[p->component_order[i]] = x[i];
    }
    return vector_from_eta(chaos, eta);
}

static size_t draw_index(const stream *s, uint64_t site, size_t m) {
    double u[N];
    draw_uniforms(s, site, 0, u);
    size_t k = (size_t)(u[0] * (double)m);
    return k < m ? k : m - 1;
}

size_t haft_chaos_draw_patch(uint64_t seed, uint64_t realization, uint64_t site, size_t m) {
    stream s = {{seed, HAFT_RANDOM_LAW_SAMPLE}, realization};
    return draw_index(&s, site, m);
}

static haft_law_vector sample_kernel(const haft_chaos *chaos, const stream *s, uint64_t site) {
    const haft_chaos_parts *p = &chaos->parts;
    double u[N], eta[N];
    size_t k = draw_index(s, site, p->m);
    draw_uniforms(s, site, 1, u);
    for (size_t i = 0; i < p->components; i++) {
        eta[p->component_order[i]] =
            chaos->mixture.axis[i].centre[k] + chaos->mixture.h * haft_random_normal_quantile(u[i]);
    }
    return vector_from_eta(chaos, eta);
}

haft_status haft_chaos_sample(const haft_chaos *chaos, haft_chaos_work *work,
                              haft_chaos_sampler sampler, uint64_t seed, uint64_t realization,
                              uint64_t first, size_t n, haft_law_vector *vector,
                              haft_error *error) {
    stream s = {{seed, HAFT_RANDOM_LAW_SAMPLE}, realization};
    switch (sampler) {
    case HAFT_CHAOS_SAMPLER_GPCE:
        sample_gpce(chaos, &s, first, n, vector);
        return HAFT_OK;
    case HAFT_CHAOS_SAMPLER_EXACT:
        if (work == NULL) {
            return haft_error_set(error, HAFT_ERROR_ARGUMENT,
                                  "the exact sampler needs a work (haft_chaos_work_create)");
        }
        for (size_t k = 0; k < n; k++) {
            vector[k] = sample_exact(chaos, work, &s, first + k);
        }
        return HAFT_OK;
    case HAFT_CHAOS_SAMPLER_KERNEL:
        for (size_t k = 0; k < n; k++) {
            vector[k] = sample_kernel(chaos, &s, first + k);
        }
        return HAFT_OK;
    case HAFT_CHAOS_SAMPLER_BOOTSTRAP:
        for (size_t k = 0; k < n; k++) {
            vector[k] = chaos->vector[draw_index(&s, first + k, chaos->parts.m)];
        }
        return HAFT_OK;
    case HAFT_CHAOS_SAMPLER_MEAN:
        for (size_t k = 0; k < n; k++) {
            vector[k] = haft_chaos_vector_from_q(chaos, chaos->parts.mean);
        }
        return HAFT_OK;
    }
    return haft_error_set(error, HAFT_ERROR_ARGUMENT, "there is no sampler %d", (int)sampler);
}
