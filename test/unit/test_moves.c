/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far gaps move by their laws' lengths, against a division a site: on every number of sites
 * about whole vectors, those that are inert left out. */
#include "check.h"

#include "solve/tracker.h"

enum { MOST = 80 };

typedef struct sites {
    double range[MOST], edge[MOST], wide[MOST], far[MOST], wall[MOST], gap[MOST], motion[MOST],
        to[MOST];
    haft_model model;
    haft_tracker tracker;
} sites;

/* Gaps near and far, moves of all sizes; which of them is the greatest is left to chance. */
static void draw(sites *s, size_t inert, size_t n, uint64_t which) {
    double z[4];
    for (size_t r = 0; r < MOST; r++) {
        haft_random_normals((haft_random_key){5, HAFT_RANDOM_TEST}, which, r, 0, 4, z);
        s->range[r] = 1e-9 * exp(z[0]);
        s->edge[r] = 1.7e-8;
        s->wide[r] = s->range[r] * (r % 3 == 0 ? 30 : 1);
        s->far[r] = 2e-8;
        s->wall[r] = 1.5e-8;
        s->gap[r] = s->far[r] + 1e-8 * z[1];
        s->motion[r] = 1e-9 * z[2] * exp(z[3]);
        s->to[r] = s->gap[r] + s->motion[r];
    }
    s->model = (haft_model){.inert = inert, .sites = n};
    s->tracker = (haft_tracker){.model = &s->model,
                                .range = s->range,
                                .edge = s->edge,
                                .wide = s->wide,
                                .far = s->far,
                                .wall = s->wall};
}

static double length_of(const sites *s, size_t r) {
    double past = fmax(s->gap[r] - s->edge[r], 0), beyond = fmax(s->gap[r] - s->far[r], 0);
    return fmin(s->range[r] + past, s->wide[r]) + beyond;
}

static double step_length_of(const sites *s, size_t r) {
    return length_of(s, r) + fmax(s->wall[r] - s->gap[r], 0); /* the gap is before the edge then */
}

static void the_greatest_move_is_found(void **state) {
    (void)state;
    for (size_t n = 1; n <= 60; n++) {
        for (size_t inert = 0; inert < n && inert < 11; inert++) {
            sites s;
            draw(&s, inert, n, 100 * n + inert);
            double most = 0, way = 0;
            size_t whose = MOST, found = MOST;
            for (size_t r = inert; r < n; r++) {
                double share = fabs(s.motion[r]) / step_length_of(&s, r);
                whose = share > most ? r : whose;
                most = fmax(most, share);
                way = fmax(way, fabs(s.to[r] - s.gap[r]) / length_of(&s, r));
            }
            assert_true(haft_tracker_greatest(&s.tracker, s.gap, s.motion, &found) == most);
            assert_int_equal(found, whose);
            assert_true(haft_tracker_way(&s.tracker, s.gap, s.to) == way);
        }
    }
}

static void what_does_not_move_is_no_move(void **state) {
    (void)state;
    for (size_t r = 3; r < 39; r++) { /* in whole vectors and behind them */
        sites s;
        draw(&s, 3, 40, 1);
        memset(s.motion, 0, sizeof s.motion);
        size_t found = MOST;
        assert_true(haft_tracker_greatest(&s.tracker, s.gap, s.motion, &found) == 0);
        assert_int_equal(found, MOST);
        s.motion[r] = NAN; /* passed over: what it comes of is told elsewhere */
        s.motion[r + 1] = -1e-9;
        double move = haft_tracker_greatest(&s.tracker, s.gap, s.motion, &found);
        assert_true(move == 1e-9 / step_length_of(&s, r + 1));
        assert_int_equal(found, r + 1);
    }
}

/* The sites up to the last that goes far enough. */
static void the_last_that_moves_is_found(void **state) {
    (void)state;
    for (size_t n = 4; n <= 60; n++) {
        sites s;
        draw(&s, 3, n, n);
        for (double least = 1e-3; least < 30; least *= 1.7) {
            size_t moved = 3;
            for (size_t r = 3; r < n; r++) {
                moved = fabs(s.to[r] - s.gap[r]) > least * length_of(&s, r) ? r + 1 : moved;
            }
            assert_int_equal(haft_tracker_moved(&s.tracker, s.gap, s.to, least), moved);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_greatest_move_is_found),
        cmocka_unit_test(what_does_not_move_is_no_move),
        cmocka_unit_test(the_last_that_moves_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
