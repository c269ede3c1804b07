/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random laws for the random-beam stress: numbers of a counter-based stream, Morse laws over wide
 * parameters, and tables with kinks, plateaus, several wells, outermost parts that push, stiff and
 * linear walls. */
#ifndef HAFT_TEST_STRESS_CURVES_H
#define HAFT_TEST_STRESS_CURVES_H

#include "stress_laws.h"

/* A stream of numbers that depends on a seed and an index alone. */
typedef struct stress_stream {
    uint64_t seed, index, next;
} stress_stream;

/* A number in (a, b). */
static inline double stress_between(stress_stream *s, double a, double b) {
    uint64_t words[4];
    haft_random_words((haft_random_key){s->seed, HAFT_RANDOM_TEST}, s->index, 0, s->next++, words);
    return a + (b - a) * haft_random_uniform(words[0]);
}

/* A number in (a, b) whose logarithm is uniform. */
static inline double stress_decades(stress_stream *s, double a, double b) {
    return exp(stress_between(s, log(a), log(b)));
}

static inline bool stress_chance(stress_stream *s, double share) {
    return stress_between(s, 0, 1) < share;
}

static inline size_t stress_pick(stress_stream *s, size_t n) {
    return (size_t)stress_between(s, 0, (double)n);
}

/* What a law is to be like. */
typedef struct stress_scale {
    double pull;  /* greatest pull [Pa] */
    double range; /* length over which it changes [m] */
    double near;  /* gap of the wall, about [m] */
    double most;  /* no table goes on beyond this gap [m] */
} stress_scale;

typedef enum stress_shape {
    STRESS_MORSE,
    STRESS_THIN_WALL,  /* Morse with a wall of 1e-9 to 1e-12 m */
    STRESS_KINKS,      /* a few points anywhere */
    STRESS_PLATEAUS,   /* stretches of one force */
    STRESS_WELLS,      /* several wells with barriers between them */
    STRESS_PUSH_LAST,  /* the outermost part pushes */
    STRESS_PUSH_ALONE, /* never pulls */
    STRESS_LINEAR,     /* straight pieces */
    STRESS_FINE,       /* a Morse law sampled at many points */
    STRESS_GREAT_WALL, /* a fine table whose wall holds all but a billionth of the energy */
    STRESS_SHAPES
} stress_shape;

static inline const char *stress_shape_name(stress_shape shape) {
    static const char *const name[STRESS_SHAPES] = {"Morse", "thin wall", "kinks",      "plateaus",
                                                    "wells", "push last", "push alone", "linear",
                                                    "fine",  "great wall"};
    return name[shape];
}

/* A curve in units of its range and its pull. */
typedef struct stress_curve {
    size_t n;
    double x[STRESS_POINTS], f[STRESS_POINTS];
} stress_curve;

static inline void stress_put(stress_curve *c, double step, double f) {
    c->x[c->n] = c->n == 0 ? 0 : c->x[c->n - 1] + step;
    c->f[c->n++] = f;
}

static inline void stress_make_kinks(stress_stream *s, stress_curve *c) {
    stress_put(c, 0, stress_decades(s, 0.5, 1e4));
    for (size_t i = 0, n = 3 + stress_pick(s, 12); i < n; i++) {
        double step = stress_chance(s, 0.2) ? stress_decades(s, 1e-3, 1) : 1;
        stress_put(c, stress_between(s, 0.1, 1) * step, stress_between(s, -1, 0.4));
    }
    stress_put(c, stress_between(s, 0.1, 2), stress_between(s, -0.9, 0.1));
    stress_put(c, stress_between(s, 0.1, 2), 0);
}

static inline void stress_make_plateaus(stress_stream *s, stress_curve *c) {
    stress_put(c, 0, stress_decades(s, 0.5, 1e3));
    for (size_t i = 0, n = 1 + stress_pick(s, 4); i < n; i++) {
        double level = stress_between(s, -1, 0.2);
        for (size_t k = 0, points = 2 + stress_pick(s, 3); k < points; k++) {
            stress_put(c, k == 0 ? stress_decades(s, 0.01, 1) : stress_between(s, 0.2, 2), level);
        }
    }
    stress_put(c, stress_decades(s, 0.01, 1), 0);
}

/* Gaussian wells and barriers behind an exponential wall, on an even grid. */
static inline void stress_make_wells(stress_stream *s, stress_curve *c) {
    size_t wells = 2 + stress_pick(s, 3), n = 30 + stress_pick(s, STRESS_POINTS - 30);
    double at[4], width[4], depth[4], end = 1;
    for (size_t k = 0; k < wells; k++) {
        width[k] = stress_between(s, 0.2, 1);
        at[k] = end + 2 * width[k];
        end = at[k] + 3 * width[k];
        depth[k] = stress_chance(s, 0.25) ? -stress_between(s, 0, 1) : stress_between(s, 0.1, 1);
    }
    double wall = stress_decades(s, 1, 1e4), decay = stress_between(s, 3, 12);
    for (size_t i = 0; i < n; i++) {
        double x = end * 1.3 * (double)i / (double)(n - 1), f = wall * exp(-decay * x);
        for (size_t k = 0; k < wells; k++) {
            double y = (x - at[k]) / width[k];
            f -= depth[k] * exp(-y * y);
        }
        c->x[i] = x;
        c->f[i] = i == n - 1 ? 0 : f;
    }
    c->n = n;
}

static inline void stress_make_push_last(stress_stream *s, stress_curve *c) {
    stress_put(c, 0, stress_decades(s, 1, 100));
    stress_put(c, stress_between(s, 0.3, 1), -stress_between(s, 0.3, 1));
    if (stress_chance(s, 0.5)) {
        stress_put(c, stress_between(s, 0.2, 2), -stress_between(s, 0, 1));
    }
    for (size_t i = 0, n = 1 + stress_pick(s, 3); i < n; i++) {
        stress_put(c, stress_between(s, 0.3, 2), stress_decades(s, 1e-3, 3));
    }
    stress_put(c, stress_between(s, 0.3, 3), 0);
}

static inline void stress_make_push_alone(stress_stream *s, stress_curve *c) {
    double f = stress_decades(s, 1, 1e4);
    for (size_t i = 0, n = 3 + stress_pick(s, 6); i < n; i++) {
        stress_put(c, stress_between(s, 0.1, 1), f);
        f *= stress_between(s, 0.05, 0.95);
    }
    stress_put(c, 1, 0);
}

/* A straight wall, a straight well, nothing. */
static inline void stress_make_linear(stress_stream *s, stress_curve *c) {
    double wall = stress_decades(s, 1, 1e4), width = stress_decades(s, 1e-3, 1);
    for (int i = 0; i < 4; i++) {
        stress_put(c, width, wall * (4 - i));
    }
    if (stress_chance(s, 0.7)) {
        double half = stress_between(s, 0.2, 2);
        stress_put(c, width, 0);
        stress_put(c, half, -1);
        stress_put(c, half, 0);
    }
    stress_put(c, stress_between(s, 0.5, 3), 0);
}

/* A Morse law at even points; with a great wall, ever steeper towards it. */
static inline void stress_make_fine(stress_stream *s, stress_curve *c, bool great) {
    size_t n = 60 + stress_pick(s, STRESS_POINTS - 60);
    double wall = great ? stress_decades(s, 1e5, 1e9) : stress_decades(s, 1, 1e4);
    double start = -0.5 * log(1 + sqrt(1 + wall)), end = stress_between(s, 8, 20);
    for (size_t i = 0; i < n; i++) {
        double x = start + (end - start) * (double)i / (double)(n - 1);
        double E = exp(x < 0 ? -2 * x : -x);
        c->x[i] = x - start;
        c->f[i] = i == n - 1 ? 0 : E * E - 2 * E;
    }
    c->n = n;
}

/* Makes a random law of a shape. @return false if the library refuses it. */
static inline bool stress_law_draw(stress_law *l, stress_stream *s, stress_shape shape,
                                   stress_scale scale, haft_error *error) {
    if (shape == STRESS_MORSE || shape == STRESS_THIN_WALL) {
        double left = shape == STRESS_MORSE ? stress_decades(s, 0.3, 10) / scale.range
                                            : stress_decades(s, 1e9, 1e12);
        return stress_law_morse(l, scale.pull, scale.near, left, 1 / scale.range,
                                stress_decades(s, 0.3, 30));
    }
    stress_curve c = {0};
    switch (shape) {
    case STRESS_KINKS:
        stress_make_kinks(s, &c);
        break;
    case STRESS_PLATEAUS:
        stress_make_plateaus(s, &c);
        break;
    case STRESS_WELLS:
        stress_make_wells(s, &c);
        break;
    case STRESS_PUSH_LAST:
        stress_make_push_last(s, &c);
        break;
    case STRESS_PUSH_ALONE:
        stress_make_push_alone(s, &c);
        break;
    case STRESS_LINEAR:
        stress_make_linear(s, &c);
        break;
    default:
        stress_make_fine(s, &c, shape == STRESS_GREAT_WALL);
        break;
    }
    double reach = c.x[c.n - 1], near = fmin(scale.near, 0.5 * scale.most);
    double unit = fmin(scale.range, (scale.most - near) / reach);
    for (size_t i = 0; i < c.n; i++) {
        c.x[i] = near + unit * c.x[i];
        c.f[i] *= scale.pull;
    }
    return stress_law_table(l, c.n, c.x, c.f, error);
}

#endif
