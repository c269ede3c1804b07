/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A chain of six bistable springs against brute force that knows nothing of folds: the load rises
 * and falls by tiny increments, and after each the chain slides down its energy by small explicit
 * steps of M u' = -grad Pi until it rests. The same jumps, within an increment, and the same
 * states; then once more with finer increments, and the loads draw as much nearer. */
#include "check.h"
#include "haft/solve.h"

enum { N = 6 };
#define GAP 100e-9
#define AREA 1e-12
#define F_LIMIT 5e6

/* Scaled by the gap and by the first ground spring. */
typedef struct chain {
    haft_model *model;
    haft_law law[N];
    double ground[N], link[N - 1], share[N], unit;
} chain;

static chain make_chain(uint64_t seed) {
    chain c = {0};
    double stiffest = 0, z[4 * N];
    haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, 1, 0, 0, 4 * N, z);
    for (int i = 0; i < N; i++) {
        double d_max = 9e-9 + 1e-9 * z[4 * i];
        haft_law_vector v = {7e-3 * exp(0.2 * z[4 * i + 1]), 3e6 * exp(0.2 * z[4 * i + 2]), d_max,
                             d_max - 2e-9};
        assert_int_equal(haft_law_morse(&c.law[i], &v, F_LIMIT), HAFT_LAW_SOUND);
        stiffest = fmax(stiffest, AREA * v.f_max * c.law[i].a_right / 2);
    }
    double k = 0.15 * stiffest;
    c.unit = k * GAP * GAP;
    haft_element element[2 * N - 1];
    haft_site site[N], load = {.dof = {0, 2, 4, -1}, .shape = {0.5 * GAP, 0.3 * GAP, 0.2 * GAP}};
    for (int i = 0; i < N; i++) {
        c.ground[i] = exp(0.2 * z[4 * i + 3]);
        element[i] = (haft_element){
            .dof = {i, -1, -1, -1}, .mode = {{1}}, .stiffness = {c.ground[i]}, .mass = {1}};
        site[i] = (haft_site){.area = AREA, .dof = {i, -1, -1, -1}, .shape = {GAP}};
    }
    for (int i = 0; i + 1 < N; i++) {
        c.link[i] = 0.2 + 0.1 * i;
        element[N + i] =
            (haft_element){.dof = {i, i + 1, -1, -1}, .mode = {{1, -1}}, .stiffness = {c.link[i]}};
    }
    c.share[0] = 0.5, c.share[2] = 0.3, c.share[4] = 0.2;
    haft_model_parts parts = {.dofs = N,
                              .energy_unit = c.unit,
                              .gap = GAP,
                              .elements = 2 * N - 1,
                              .element = element,
                              .sites = N,
                              .site = site,
                              .load = load};
    haft_error error = {0};
    check_ok(haft_model_create(&c.model, &parts, &error), error);
    return c;
}

/* Forces on the chain, load in units of energy_unit / gap; @return the largest. */
static double forces(const chain *c, const double *u, double load, double *f) {
    double most = 0;
    for (int i = 0; i < N; i++) {
        haft_law_value law = haft_law_evaluate(&c->law[i], GAP * (1 - u[i]));
        f[i] = load * c->share[i] - c->ground[i] * u[i] - AREA * GAP / c->unit * law.force;
        f[i] += i > 0 ? c->link[i - 1] * (u[i - 1] - u[i]) : 0;
        f[i] += i + 1 < N ? c->link[i] * (u[i + 1] - u[i]) : 0;
        most = fmax(most, fabs(f[i]));
    }
    return most;
}

/* Slides until the forces are gone. Explicit Euler, its step safe for the stiffest state met. */
static void relax(const chain *c, double *u, double load) {
    double f[N];
    while (forces(c, u, load, f) > 1e-11) {
        double stiff = 0;
        for (int i = 0; i < N; i++) {
            double slope = haft_law_evaluate(&c->law[i], GAP * (1 - u[i])).slope;
            stiff = fmax(stiff, fabs(slope) * AREA * GAP * GAP / c->unit);
        }
        for (int i = 0; i < N; i++) {
            u[i] += 0.5 / (stiff + 25) * f[i];
        }
    }
}

typedef struct event {
    double load, before[N], after[N]; /* the increment's end; states on both sides */
} event;

/* Loads to `top` and back in `increments` each way; a jump is a move out of proportion. */
static size_t brute_force(const chain *c, double top, int increments, event *events, size_t room,
                          double *end) {
    double u[N] = {0};
    size_t count = 0;
    relax(c, u, 0);
    for (int i = 1; i <= 2 * increments; i++) {
        double load = top * (i <= increments ? i : 2 * increments - i) / increments;
        double before[N], most = 0;
        memcpy(before, u, sizeof before);
        relax(c, u, load);
        for (int k = 0; k < N; k++) {
            most = fmax(most, fabs(u[k] - before[k]));
        }
        if (most > 0.01) { /* a nanometre in an increment */
            assert_true(count < room);
            events[count].load = load;
            memcpy(events[count].before, before, sizeof before);
            memcpy(events[count++].after, u, sizeof u);
        }
    }
    memcpy(end, u, sizeof u);
    return count;
}

static double farthest(const double *u, const double *v) {
    double most = 0;
    for (int i = 0; i < N; i++) {
        most = fmax(most, fabs(u[i] - v[i]));
    }
    return most;
}

/* Jumps of the path against brute force's; @return the greatest difference of loads, in
 * increments. */
static void compare(const chain *c, const haft_path *path, double top, int increments) {
    event events[64];
    double end[N], unit = c->unit / GAP, worst = 0, worst_state = 0;
    size_t count = brute_force(c, top, increments, events, 64, end);
    assert_int_equal(path->jumps, count);
    for (size_t i = 0; i < path->points; i++) {
        int j = path->point[i].jump;
        if (j < 0) {
            continue;
        }
        /* found at the first increment past the fold; the landing has moved on by less than one */
        double late = (events[j].load - path->jump[j].load / unit) * increments / top;
        late *= path->jump[j].phase == 0 ? 1 : -1;
        worst = fmax(worst, late);
        assert_true(late > 0 && late < 1);
        double landed[N];
        memcpy(landed, path->state + N * i, sizeof landed);
        relax(c, landed, events[j].load);
        double miss = farthest(landed, events[j].after);
        worst_state = fmax(worst_state, miss);
        check_less(miss, 1e-9);
    }
    check_less(farthest(end, path->final_state), 1e-9);
    print_message("  %d increments: %zu jumps, found up to %.3f of an increment late, landings "
                  "within %.1e, end within %.1e\n",
                  increments, count, worst, worst_state, farthest(end, path->final_state));
}

static void a_chain_jumps_as_brute_force_does(void **state) {
    (void)state;
    size_t jumps = 0;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        chain c = make_chain(seed);
        double top = 7;
        haft_error error = {0};
        haft_programme programme = {-1, 0.01, top * c.unit / GAP};
        haft_path_options options = {.keep_states = true};
        haft_path *path = NULL;
        check_ok(haft_solve_path(&path, c.model, c.law, &programme, &options, &error), error);
        assert_true(path->outcome == HAFT_OUTCOME_STUCK || path->outcome == HAFT_OUTCOME_FREE);
        check_less(path->ledger_error, 1e-10);
        compare(&c, path, top, 3000);
        jumps += path->jumps;
        haft_path_destroy(&path);
        haft_model_destroy(&c.model);
    }
    assert_true(jumps >= 14);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_chain_jumps_as_brute_force_does)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
