/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Convergence in the element length l_e, the laws held fixed (sites every 3 um), against the mesh
 * that is exact for them: Fig. 13b of Hoang et al. (2017), and beyond it the order theory gives.
 *
 * Theory. A stable state minimizes Pi; the mesh's state minimizes it over less, so to leading order
 * Pi_h - Pi is half the squared energy norm of the error. The exact beam is cubic between sites and
 * its third derivative jumps by F_r / EI at each. Hermite cubics are exact at their nodes (EI w''''
 * is a sum of forces), so what is left is, element by element, the deflection of a beam clamped at
 * both nodes under the forces of the sites within:
 *
 *     Pi_h - Pi = 1/2 sum_e F' G_e F + higher,      G_e(a, a) = a^3 (l - a)^3 / (3 EI l^3).
 *
 * With the sites in the middles of elements that is sum F_r^2 l_e^3 / (384 EI): order 3 in the
 * energy, 3/2 in the energy norm. The strain energy alone is a smooth functional whose dual
 * solution has the same kinks, so it is of order 3 too. Next come terms smaller by the stiffest
 * site's times the clamped beam's compliance, which falls by l_e^3.
 *
 * That holds along a branch. Which branch a path ends on is no continuous function of the mesh:
 * for whole cycles no order is owed, and what comes out is printed. */
#include "evaluate.h"
#include "haft/study.h"
#include "random_beam.h"

#include <klu.h>

static const double lengths[] = {30e-6, 15e-6, 10e-6, 7.5e-6, 5e-6, 3e-6, 1.5e-6};
enum { LENGTHS = sizeof lengths / sizeof *lengths, DELRIO_BEAMS = 3, RANDOM_BEAMS = 12 };

/* Beams over fixed laws, all of one structure. */
typedef struct family {
    const char *name;
    haft_beam_spec beam;
    haft_programme programme;
    double load_position;
    size_t beams;
    const haft_law *law[RANDOM_BEAMS];
} family;

static haft_model *make_model(const family *f, double element_length) {
    haft_mesh_spec mesh = {HAFT_MESH_EXACT, 0, 3e-6, f->load_position, 0};
    if (element_length > 0) {
        mesh.kind = HAFT_MESH_UNIFORM;
        mesh.element_length = element_length;
    }
    haft_model *model = NULL;
    haft_error error = {0};
    check_ok(haft_model_create_beam(&model, &f->beam, &mesh, &error), error);
    return model;
}

static haft_path *cycle(const family *f, const haft_model *model, size_t beam) {
    haft_path_options options = {0};
    haft_path *path = NULL;
    haft_error error = {0};
    check_ok(haft_solve_path(&path, model, f->law[beam], &f->programme, &options, &error), error);
    assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
    check_less(path->ledger_error, 1e-10);
    return path;
}

/* ---- whole cycles ---- */

static void check_same_path(const haft_path *path, const haft_path *exact) {
    haft_path_point a = path->point[path->points - 1], b = exact->point[exact->points - 1];
    assert_int_equal(path->jumps, exact->jumps);
    double greatest =
        0; /* a fold's load balances contact forces of this size, small as it may be */
    for (size_t j = 0; j < exact->jumps; j++) {
        greatest = fmax(greatest, exact->jump[j].load);
    }
    for (size_t j = 0; j < exact->jumps; j++) {
        assert_int_equal(path->jump[j].site, exact->jump[j].site);
        check_near(path->jump[j].load, exact->jump[j].load, 1e-8 * greatest);
    }
    check_relative(a.internal_energy, b.internal_energy, 1e-8);
    check_relative(a.crack_length, b.crack_length, 1e-8);
    check_relative(a.dissipated, b.dissipated, 1e-8);
}

static void print_row(const family *f, double element_length, haft_path *const *exact) {
    haft_model *model = make_model(f, element_length);
    double n = (double)f->beams, energy = 0, crack = 0, jumps = 0, fold = 0;
    double energy_off = 0, crack_off = 0, fold_off = 0, second_off = 0;
    int same = 0;
    double start = haft_clock_seconds();
    for (size_t k = 0; k < f->beams; k++) {
        haft_path *path = cycle(f, model, k);
        haft_path_point a = path->point[path->points - 1];
        haft_path_point b = exact[k]->point[exact[k]->points - 1];
        energy += a.internal_energy / n;
        crack += a.crack_length / n;
        jumps += (double)path->jumps / n;
        fold += path->jump[0].load / n;
        energy_off += fabs(a.internal_energy / b.internal_energy - 1) / n;
        crack_off += fabs(a.crack_length - b.crack_length) / n;
        fold_off += fabs(path->jump[0].load / exact[k]->jump[0].load - 1) / n;
        second_off += fabs(path->jump[1].load / exact[k]->jump[1].load - 1) / n;
        same += path->jumps == exact[k]->jumps;
        if (element_length > 0 && element_length <= 1.5e-6) {
            check_same_path(path, exact[k]); /* a node at every site */
        }
        haft_path_destroy(&path);
    }
    char label[32] = "exact";
    if (element_length > 0) {
        snprintf(label, sizeof label, "%.1f", 1e6 * element_length);
    }
    print_message("  %6s %9.4f %9.2e %8.2f %8.2e %6.1f %5d %10.6f %8.1e %8.1e %8.3f\n", label,
                  1e12 * energy, energy_off, 1e6 * crack, 1e6 * crack_off, jumps, same, 1e6 * fold,
                  fold_off, second_off, (haft_clock_seconds() - start) / n);
    haft_model_destroy(&model);
}

static void print_cycles(const family *f) {
    haft_path *exact[RANDOM_BEAMS];
    haft_model *model = make_model(f, 0);
    for (size_t k = 0; k < f->beams; k++) {
        exact[k] = cycle(f, model, k);
    }
    haft_model_destroy(&model);
    print_message("\n  %s, %zu beams: whole cycles; means, and mean distances from the exact mesh\n"
                  "  %6s %9s %9s %8s %8s %6s %5s %10s %8s %8s %8s\n"
                  "  %6s %9s %9s %8s %8s %6s %5s %10s %8s %8s %8s\n",
                  f->name, f->beams, "l_e", "strain", "off", "crack", "off", "jumps", "same",
                  "1st fold", "off", "2nd off", "time", "[um]", "[pJ]", "", "[um]", "[um]", "", "",
                  "[uN]", "", "", "[s]");
    for (int i = 0; i < LENGTHS; i++) {
        print_row(f, lengths[i], exact);
    }
    print_row(f, 0, exact);
    for (size_t k = 0; k < f->beams; k++) {
        haft_path_destroy(&exact[k]);
    }
}

/* ---- along a branch: the state at rest, followed from mesh to mesh ---- */

/* Newton with KLU, undamped: it starts next to where it ends. */
static void settle(const haft_model *m, const haft_law *law, double *u) {
    const haft_model_data *data = haft_model_get(m);
    haft_error error = {0};
    double *gradient = haft_memory_alloc(data->dofs, sizeof *gradient, &error);
    double *hessian = haft_memory_alloc(data->nonzeros, sizeof *hessian, &error);
    klu_common common;
    klu_defaults(&common);
    klu_symbolic *symbolic = klu_analyze((int)data->dofs, data->column, data->row, &common);
    assert_true(gradient != NULL && hessian != NULL && symbolic != NULL);
    double step = INFINITY;
    for (int i = 0; i < 40 && step > 1e-14; i++) {
        evaluate(m, law, u, 0, gradient, hessian, NULL);
        klu_numeric *numeric = klu_factor(data->column, data->row, hessian, symbolic, &common);
        assert_non_null(numeric);
        assert_true(klu_solve(symbolic, numeric, (int)data->dofs, 1, gradient, &common));
        klu_free_numeric(&numeric, &common);
        double last = step;
        step = 0;
        for (size_t k = 0; k < data->dofs; k++) {
            u[k] -= gradient[k];
            step = fmax(step, fabs(gradient[k]));
        }
        if (step < 1e-9 && step >= last) {
            break; /* rounding */
        }
    }
    check_less(step, 1e-9);
    klu_free_symbolic(&symbolic, &common);
    haft_memory_free(gradient);
    haft_memory_free(hessian);
}

/* The state of one mesh as the unknowns of another. */
static double *carry_over(const haft_model *to, const haft_model *from, const double *u) {
    const haft_model_data *m = haft_model_get(to);
    haft_error error = {0};
    double *v = haft_memory_alloc(m->dofs, sizeof *v, &error);
    assert_non_null(v);
    for (size_t i = 1; i < m->nodes; i++) {
        double w, rotation;
        haft_model_shape(from, u, m->node_x[i], &w, &rotation);
        v[2 * (i - 1)] = w / m->scale[2 * (i - 1)];
        v[2 * (i - 1) + 1] = rotation / m->scale[2 * (i - 1) + 1];
    }
    return v;
}

/* Deflection at x of a beam clamped at 0 and l under a unit force at a, times EI. */
static double clamped(double l, double a, double x) {
    if (x > a) {
        return clamped(l, l - a, l - x);
    }
    double b = l - a;
    return b * b * x * x * (3 * a * l - (3 * a + b) * x) / (6 * l * l * l);
}

/* 1/2 sum_e F' G_e F with the forces of the exact state. */
static double predict(const family *f, const haft_model *exact, const haft_law *law,
                      const double *u, double l) {
    const haft_model_data *m = haft_model_get(exact);
    double sum = 0, half = 0.5 / haft_beam_bending_stiffness(&f->beam);
    for (size_t r = 0; r < m->sites; r++) {
        double first = floor(m->site[r].x / l + 1e-9) * l;
        for (size_t s = 0; s < m->sites; s++) {
            double a = m->site[r].x - first, b = m->site[s].x - first;
            if (b > 0 && b < l) {
                const haft_site *p = &m->site[r], *q = &m->site[s];
                double d = m->gap - haft_model_displacement(p, u);
                double e = m->gap - haft_model_displacement(q, u);
                sum += half * p->area * haft_law_evaluate(&law[r], d).force * q->area *
                       haft_law_evaluate(&law[s], e).force * clamped(l, a, b);
            }
        }
    }
    return sum;
}

/* The last three keep every site in the middle of an element. */
static const double branch_lengths[] = {30e-6, 15e-6, 10e-6, 7.5e-6, 5e-6, 3e-6, 1e-6, 0.6e-6};
enum { BRANCH = sizeof branch_lengths / sizeof *branch_lengths };

typedef struct excess {
    double total, strain, predicted; /* relative to the strain energy */
    double moved;                    /* largest change of a gap [m] */
} excess;

static void measure_branch(const family *f, size_t beam, excess *out) {
    haft_model *exact = make_model(f, 0);
    const haft_law *law = f->law[beam];
    haft_path *path = cycle(f, exact, beam);
    double *u = path->final_state;
    settle(exact, law, u);
    haft_energy rest = evaluate(exact, law, u, 0, NULL, NULL, NULL);
    for (int i = 0; i < BRANCH; i++) {
        haft_model *model = make_model(f, branch_lengths[i]);
        double *v = carry_over(model, exact, u);
        settle(model, law, v);
        haft_energy here = evaluate(model, law, v, 0, NULL, NULL, NULL);
        double strain = here.strain - rest.strain;
        out[i].strain = strain / rest.strain;
        out[i].total = (strain + (here.contact - rest.contact)) / rest.strain;
        out[i].predicted = predict(f, exact, law, u, branch_lengths[i]) / rest.strain;
        out[i].moved = 0;
        for (size_t r = 0; r < haft_model_get(exact)->sites; r++) {
            double move = haft_model_displacement(&haft_model_get(model)->site[r], v) -
                          haft_model_displacement(&haft_model_get(exact)->site[r], u);
            out[i].moved = fmax(out[i].moved, fabs(move));
        }
        haft_memory_free(v);
        haft_model_destroy(&model);
    }
    haft_path_destroy(&path);
    haft_model_destroy(&exact);
}

static double order(double coarse, double fine, int i) {
    return log(fabs(coarse / fine)) / log(branch_lengths[i - 1] / branch_lengths[i]);
}

/* Bands: the next terms, 0.3 % at 3 um here and falling by l^3, for a contact three times as stiff;
 * 2e-4 for round-off. */
static void check_branch(const excess *x) {
    for (int i = 0; i < BRANCH; i++) {
        assert_true(x[i].total > 0); /* the exact state is the least of all */
    }
    for (int i = BRANCH - 3; i < BRANCH; i++) {
        double shrink = pow(branch_lengths[i] / 3e-6, 3);
        check_near(x[i].total / x[i].predicted, 1, fmax(0.01 * shrink, 2e-4));
    }
    for (int i = BRANCH - 2; i < BRANCH; i++) {
        check_near(order(x[i - 1].total, x[i].total, i), 3, 0.02);
        check_near(order(x[i - 1].strain, x[i].strain, i), 3, 0.1);
    }
}

static void study_branch(const family *f) {
    for (size_t k = 0; k < f->beams; k++) {
        excess x[BRANCH];
        measure_branch(f, k, x);
        print_message("\n  %s, beam %zu: the state at rest, one branch; excess energy over the "
                      "strain energy\n  %6s %11s %6s %11s %8s %12s %6s %12s\n",
                      f->name, k, "l_e", "Pi", "order", "theory", "ratio", "strain", "order",
                      "moved [nm]");
        for (int i = 0; i < BRANCH; i++) {
            double p = i > 0 ? order(x[i - 1].total, x[i].total, i) : NAN;
            double q = i > 0 ? order(x[i - 1].strain, x[i].strain, i) : NAN;
            print_message("  %6.1f %11.3e %6.2f %11.3e %8.5f %12.3e %6.2f %12.5f\n",
                          1e6 * branch_lengths[i], x[i].total, p, x[i].predicted,
                          x[i].total / x[i].predicted, x[i].strain, q, 1e9 * x[i].moved);
        }
        check_branch(x);
    }
}

/* ---- the tests ---- */

static void random_laws(void **state) {
    (void)state;
    family f = {"random laws", random_beam_spec, {150e-6, 0.01, INFINITY},
                60e-6,         RANDOM_BEAMS,     {0}};
    random_beam drawn[RANDOM_BEAMS];
    for (size_t k = 0; k < f.beams; k++) {
        drawn[k] =
            random_beam_create(k + 1, (haft_mesh_spec){HAFT_MESH_UNIFORM, 15e-6, 3e-6, 60e-6, 0});
        f.law[k] = drawn[k].law;
    }
    print_cycles(&f);
    f.beams = 2;
    study_branch(&f);
    for (size_t k = 0; k < RANDOM_BEAMS; k++) {
        random_beam_destroy(&drawn[k]);
    }
}

static void delrio_laws(void **state) {
    (void)state;
    haft_error error = {0};
    haft_case *c = NULL;
    haft_laws *laws = NULL;
    check_ok(haft_case_read(&c, HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml", &error), error);
    c->realizations = DELRIO_BEAMS;
    assert_true(c->mesh.l_meso == 3e-6);
    check_ok(haft_study_build_laws(&laws, c, NULL, &error), error);
    family f = {"DelRio laws", c->beam, c->programme, c->mesh.load_position, DELRIO_BEAMS, {0}};
    haft_site_laws *site[DELRIO_BEAMS];
    for (size_t k = 0; k < f.beams; k++) {
        check_ok(haft_study_site_laws(&site[k], c, laws, k, &error), error);
        f.law[k] = site[k]->law;
    }
    print_cycles(&f);
    study_branch(&f);
    for (size_t k = 0; k < f.beams; k++) {
        haft_site_laws_destroy(&site[k]);
    }
    haft_laws_destroy(&laws);
    haft_case_destroy(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(random_laws),
                                       cmocka_unit_test(delrio_laws)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
