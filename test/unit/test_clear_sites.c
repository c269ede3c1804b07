/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How many of the sites that an active mesh leaves out are clear, against asking one by one. */
#include "random_beam.h"

enum { MOST = 400 };

static size_t count(const haft_model *model, const double *u, const double *reach) {
    const haft_model_data *m = haft_model_get(model);
    size_t r = 0;
    while (r < m->inert && m->gap - haft_model_displacement(&m->site[r], u) > reach[r]) {
        r++;
    }
    return r;
}

/* Free spans of every length, of one element and of two (with the load on them), reached first by
 * any of their sites or by none. */
static void counts_as_one_by_one(void **state) {
    (void)state;
    for (int from = 30; from <= 540; from += 30) {
        haft_mesh_spec mesh = {HAFT_MESH_ACTIVE, 0, 3e-6, 60e-6, 1e-6 * from};
        random_beam b = random_beam_create(3, mesh);
        double u[MOST], reach[MOST];
        for (size_t i = 0; i < haft_model_get(b.model)->dofs; i++) {
            u[i] = 0.4 * sin(0.7 * (double)i);
        }
        for (size_t touched = 0; touched <= haft_model_get(b.model)->inert; touched++) {
            for (size_t r = 0; r < haft_model_get(b.model)->sites; r++) {
                double d = haft_model_get(b.model)->gap -
                           haft_model_displacement(&haft_model_get(b.model)->site[r], u);
                reach[r] = r == touched ? d : 0.999 * d; /* at it is not clear of it */
            }
            size_t clear = haft_model_clear_sites(b.model, u, reach);
            assert_int_equal(clear, touched);
            assert_int_equal(clear, count(b.model, u, reach));
        }
        reach[haft_model_get(b.model)->inert / 2] = NAN;
        assert_int_equal(haft_model_clear_sites(b.model, u, reach),
                         haft_model_get(b.model)->inert / 2);
        random_beam_destroy(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(counts_as_one_by_one)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
