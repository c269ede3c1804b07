/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Folds of a beam over random laws against an independent solve in extended precision. From the
 * last accepted state before a jump the load is raised by dense Newton, law and stiffness written
 * out once more in long double, until no equilibrium is left; from there Newton solves
 * grad Pi = 0, H v = 0, v'v = 1 for (u, v, P). The recorded load is never used. Then the smallest
 * eigenvalue must fall like the square root of the distance to the fold. */
#include "check.h"
#include "haft/solve.h"

enum { N = 40, BORDERED = 2 * N + 1, MESO = 100 };

static const haft_beam_spec BEAM = {600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};
static const double F_LIMIT = 5e6;

typedef struct scene {
    haft_model *model;
    haft_law law[MESO];
    haft_law_vector vector[MESO];
    long double k[N][N]; /* stiffness, from the elements' modes */
} scene;

static void assemble(scene *s) {
    memset(s->k, 0, sizeof s->k);
    for (size_t e = 0; e < haft_model_get(s->model)->elements; e++) {
        const haft_element *el = &haft_model_get(s->model)->element[e];
        for (int i = 0; i < HAFT_SPAN; i++) {
            for (int j = 0; j < HAFT_SPAN; j++) {
                if (el->dof[i] < 0 || el->dof[j] < 0) {
                    continue;
                }
                long double a0 = el->mode[0][i], a1 = el->mode[1][i];
                long double b0 = el->mode[0][j], b1 = el->mode[1][j];
                s->k[el->dof[i]][el->dof[j]] +=
                    a0 * (el->stiffness[0] * b0 + el->stiffness[1] * b1) +
                    a1 * (el->stiffness[1] * b0 + el->stiffness[2] * b1);
            }
        }
    }
}

static void make_scene(scene *s, uint64_t seed) {
    haft_error error = {0};
    haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, 30e-6, 6e-6, 60e-6, 0};
    check_ok(haft_model_create_beam(&s->model, &BEAM, &mesh, &error), error);
    assert_int_equal(haft_model_get(s->model)->dofs, N);
    assert_int_equal(haft_model_get(s->model)->sites, MESO);
    for (size_t r = 0; r < MESO; r++) {
        double z[4];
        haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, 0, r, 0, 4, z);
        double d_max = 11e-9 + 0.4e-9 * z[2];
        s->vector[r] =
            (haft_law_vector){3.6e-3 * exp(0.3 * z[0]), 1e6 * exp(0.25 * z[0] + 0.1 * z[1]), d_max,
                              d_max - 2.8e-9 * exp(0.1 * z[3])};
        assert_int_equal(haft_law_morse(&s->law[r], &s->vector[r], F_LIMIT), HAFT_LAW_SOUND);
    }
    assemble(s);
}

static haft_path *follow(const scene *s, double limit, double residual, bool states) {
    haft_error error = {0};
    haft_programme programme = {150e-6, 0.01, limit};
    haft_path_options options = {.keep_states = states, .residual_tolerance = residual};
    haft_path *path = NULL;
    check_ok(haft_solve_path(&path, s->model, s->law, &programme, &options, &error), error);
    return path;
}

/* f, f', f'' of a law vector, from the definition. */
static void law_at(const haft_law_vector *v, long double d, long double f[3]) {
    long double top = v->f_max, rise = sqrtl(1 + F_LIMIT / top);
    long double left = logl(1 + rise) / ((long double)v->d_max - v->d_limit);
    long double right = 1.5L / (v->e / top - 0.5L / left), y = d - v->d_max;
    long double a = y < 0 ? left : right, e = expl(-a * y), t = d - v->d_limit;
    if (t < 0) {
        f[1] = -2 * top * left * (1 + rise) * rise;
        f[0] = F_LIMIT + f[1] * t;
        f[2] = 0;
        return;
    }
    f[0] = top * (e * e - 2 * e);
    f[1] = -2 * a * top * (e * e - e);
    f[2] = 2 * a * a * top * (2 * e * e - e);
}

typedef struct system {
    long double g[N], h[N][N], third[N][N]; /* gradient, Hessian, d(H v)/du */
    long double b[N];                       /* -dg/dP */
} system_t;

static void evaluate(const scene *s, const long double *u, const long double *v, long double load,
                     system_t *out) {
    const haft_model_data *m = haft_model_get(s->model);
    memset(out, 0, sizeof *out);
    memcpy(out->h, s->k, sizeof out->h);
    for (int k = 0; k < HAFT_SPAN; k++) {
        if (m->load.dof[k] >= 0) {
            out->b[m->load.dof[k]] = m->load.shape[k] / (long double)m->energy_unit;
        }
    }
    for (int i = 0; i < N; i++) {
        out->g[i] = -load * out->b[i];
        for (int j = 0; j < N; j++) {
            out->g[i] += s->k[i][j] * u[j];
        }
    }
    for (size_t r = 0; r < MESO; r++) {
        const haft_site *site = &m->site[r];
        long double d = m->gap, motion = 0, f[3];
        for (int k = 0; k < HAFT_SPAN; k++) {
            if (site->dof[k] >= 0) {
                d -= site->shape[k] * u[site->dof[k]];
                motion += v == NULL ? 0 : site->shape[k] * v[site->dof[k]];
            }
        }
        law_at(&s->vector[r], d, f);
        long double weight = site->area / (long double)m->energy_unit;
        for (int i = 0; i < HAFT_SPAN; i++) {
            if (site->dof[i] < 0) {
                continue;
            }
            out->g[site->dof[i]] += weight * f[0] * site->shape[i];
            for (int j = 0; j < HAFT_SPAN; j++) {
                if (site->dof[j] >= 0) {
                    long double ss = weight * site->shape[i] * (long double)site->shape[j];
                    out->h[site->dof[i]][site->dof[j]] -= ss * f[1];
                    out->third[site->dof[i]][site->dof[j]] += ss * f[2] * motion;
                }
            }
        }
    }
}

/* Gauss with partial pivoting, in place; row i of `a` has n coefficients and the right side. */
static bool gauss(int n, long double a[][BORDERED + 1], long double *x) {
    for (int c = 0; c < n; c++) {
        int best = c;
        for (int i = c + 1; i < n; i++) {
            best = fabsl(a[i][c]) > fabsl(a[best][c]) ? i : best;
        }
        if (!(fabsl(a[best][c]) > 0)) {
            return false;
        }
        for (int j = c; best != c && j <= n; j++) {
            long double swap = a[c][j];
            a[c][j] = a[best][j];
            a[best][j] = swap;
        }
        for (int i = c + 1; i < n; i++) {
            long double factor = a[i][c] / a[c][c];
            for (int j = c; factor != 0 && j <= n; j++) {
                a[i][j] -= factor * a[c][j];
            }
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        x[i] = a[i][n];
        for (int j = i + 1; j < n; j++) {
            x[i] -= a[i][j] * x[j];
        }
        x[i] /= a[i][i];
    }
    return true;
}

static bool is_definite(const system_t *at) {
    long double l[N][N];
    for (int j = 0; j < N; j++) {
        for (int i = j; i < N; i++) {
            long double sum = at->h[i][j];
            for (int k = 0; k < j; k++) {
                sum -= l[i][k] * l[j][k];
            }
            if (i == j && !(sum > 0)) {
                return false;
            }
            l[i][j] = i == j ? sqrtl(sum) : sum / l[j][j];
        }
    }
    return true;
}

/* Stable equilibrium at a load by Newton from u, whose gaps may move little in all; u becomes it.
 */
static bool settle(const scene *s, long double *u, long double load) {
    static long double a[BORDERED][BORDERED + 1];
    long double x[N], step[N], most = 1;
    system_t at;
    memcpy(x, u, sizeof x);
    for (int turn = 0; turn < 12 && most > 1e-14L; turn++) {
        evaluate(s, x, NULL, load, &at);
        for (int i = 0; i < N; i++) {
            memcpy(a[i], at.h[i], sizeof at.h[i]);
            a[i][N] = -at.g[i];
        }
        if (!gauss(N, a, step)) {
            return false;
        }
        most = 0;
        for (int i = 0; i < N; i++) {
            x[i] += step[i];
            most = fmaxl(most, fabsl(step[i]));
            if (!(fabsl(x[i] - u[i]) < 1e-3L)) {
                return false;
            }
        }
    }
    evaluate(s, x, NULL, load, &at);
    if (!(most <= 1e-14L) || !is_definite(&at)) {
        return false;
    }
    memcpy(u, x, sizeof x);
    return true;
}

/* Eigenvector of the smallest eigenvalue, by inverse iteration. */
static void softest(const scene *s, const long double *u, long double load, long double *v) {
    static long double a[BORDERED][BORDERED + 1];
    system_t at;
    evaluate(s, u, NULL, load, &at);
    for (int i = 0; i < N; i++) {
        v[i] = at.b[i];
    }
    for (int turn = 0; turn < 12; turn++) {
        long double norm = 0;
        for (int i = 0; i < N; i++) {
            memcpy(a[i], at.h[i], sizeof at.h[i]);
            a[i][N] = v[i];
        }
        assert_true(gauss(N, a, v));
        for (int i = 0; i < N; i++) {
            norm += v[i] * v[i];
        }
        for (int i = 0; i < N; i++) {
            v[i] /= sqrtl(norm);
        }
    }
}

/* Newton on the extended system; @return the size of its last step, loads in the given unit: the
 * greatest of the programme, for that of a fold near rest is a difference of such. */
static long double extended_newton(const scene *s, long double *u, long double *v,
                                   long double *load, double unit) {
    static long double a[BORDERED][BORDERED + 1];
    long double x[BORDERED], last = INFINITY;
    for (int turn = 0; turn < 30 && last > 1e-17L; turn++) {
        system_t at;
        evaluate(s, u, v, *load, &at);
        memset(a, 0, sizeof a);
        a[2 * N][BORDERED] = 1;
        for (int i = 0; i < N; i++) {
            a[i][2 * N] = -at.b[i] * unit;
            a[i][BORDERED] = -at.g[i];
            for (int j = 0; j < N; j++) {
                a[i][j] = at.h[i][j];
                a[N + i][j] = at.third[i][j];
                a[N + i][N + j] = at.h[i][j];
                a[N + i][BORDERED] -= at.h[i][j] * v[j];
            }
            a[2 * N][N + i] = 2 * v[i];
            a[2 * N][BORDERED] -= v[i] * v[i];
        }
        assert_true(gauss(BORDERED, a, x));
        last = 0;
        for (int i = 0; i < N; i++) {
            u[i] += x[i];
            v[i] += x[N + i];
            last = fmaxl(last, fabsl(x[i]));
        }
        last = fmaxl(last, fabsl(x[2 * N]));
        *load += x[2 * N] * unit;
    }
    return last;
}

/* The load of the fold ahead of a state. */
static double fold_ahead(const scene *s, const double *from, double load, int phase,
                         double largest) {
    long double u[N], v[N], p = load, size = (phase == 0 ? 1 : -1) * 1e-3L * load;
    for (int i = 0; i < N; i++) {
        u[i] = from[i];
    }
    assert_true(settle(s, u, p));
    while (fabsl(size) > 1e-10L * p) {
        if (settle(s, u, p + size)) {
            p += size;
        } else {
            size /= 2;
        }
    }
    softest(s, u, p, v);
    assert_true(extended_newton(s, u, v, &p, largest) < 1e-13L);
    return (double)p;
}

/* A fold's load is a small difference of contact forces, whose gaps are known to the rounding of
 * the beam's height (1.9 um / 2^52, 4e-13 of a law's range): so its error is measured against the
 * largest load of the programme and, where its own is a fair share of that, against its own. */
static size_t compare_folds(const scene *s, double *worst) {
    haft_path *path = follow(s, INFINITY, 0, true);
    assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
    size_t folds = 0;
    double largest = path->point[path->turn].load;
    for (size_t i = 1; i < path->points; i++) {
        const haft_path_point *p = &path->point[i];
        if (p->jump < 0) {
            continue;
        }
        const haft_jump *jump = &path->jump[p->jump];
        assert_int_equal(jump->departure, HAFT_DEPARTURE_FOLD);
        double fold =
            fold_ahead(s, path->state + (i - 1) * N, path->point[i - 1].load, p->phase, largest);
        double miss = fabs(jump->load - fold);
        check_less(miss, 1e-11 * largest);
        if (fold > 0.25 * largest) {
            check_less(miss, 1e-11 * fold);
            worst[0] = fmax(worst[0], miss / fold);
        }
        worst[1] = fmax(worst[1], miss / largest);
        folds++;
    }
    haft_path_destroy(&path);
    return folds;
}

static void fold_loads_are_those_of_the_extended_system(void **state) {
    (void)state;
    static scene s;
    double worst[2] = {0};
    size_t folds = 0;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        make_scene(&s, seed);
        folds += compare_folds(&s, worst);
        haft_model_destroy(&s.model);
    }
    print_message("  %zu folds, loads within %.1e of their own, %.1e of the largest\n", folds,
                  worst[0], worst[1]);
    assert_true(folds > 30);
}

static void the_smallest_eigenvalue_falls_as_a_square_root(void **state) {
    (void)state;
    static scene s;
    make_scene(&s, 1);
    haft_path *whole = follow(&s, INFINITY, 1e-14, false);
    size_t looked_at = 0;
    for (size_t j = 0; j < whole->jumps && looked_at < 3; j++) {
        if (whole->jump[j].phase != 0) {
            continue;
        }
        double lambda[10];
        for (int k = 3; k <= 9; k++) {
            haft_path *path = follow(&s, whole->jump[j].load * (1 - pow(10, -k)), 1e-14, false);
            assert_true(path->turned_by_load);
            assert_int_equal(path->point[path->turn].phase, 0);
            lambda[k] = path->point[path->turn].lambda_min;
            haft_path_destroy(&path);
        }
        print_message("  jump %zu at %.4g N: lambda %.3e to %.3e, orders", j, whole->jump[j].load,
                      lambda[3], lambda[9]);
        for (int k = 3; k < 9; k++) {
            print_message(" %.4f", log10(lambda[k] / lambda[k + 1]));
        }
        print_message("\n");
        /* lambda = c sqrt(distance) (1 + O(sqrt(distance))): the order is 0.5 near the fold, and
         * farther off once the next term, which shrinks by sqrt(10), is extrapolated away. */
        for (int k = 4; k < 9; k++) {
            double far = log10(lambda[k - 1] / lambda[k]), near = log10(lambda[k] / lambda[k + 1]);
            check_near((near - far / sqrt(10)) / (1 - 1 / sqrt(10)), 0.5, 0.02);
            if (k > 4) {
                check_near(near, 0.5, 0.02);
            }
        }
        looked_at++;
    }
    assert_int_equal(looked_at, 3);
    haft_path_destroy(&whole);
    haft_model_destroy(&s.model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fold_loads_are_those_of_the_extended_system),
        cmocka_unit_test(the_smallest_eigenvalue_falls_as_a_square_root),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
