/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Convergence in the length of a patch, l_meso, on one fixed surface a beam: Fig. 13a of Hoang et
 * al. (2017). Exact meshes, so that nothing else changes. Three questions, from the safe one on:
 *
 * 1. Is it the same surface however it is cut? The noise lattice and the grid do not depend on
 *    l_meso, so heights must agree to round-off, and what is counted by area (the menisci) must be
 *    the mean over the sub-patches, point for point.
 * 2. One smooth law everywhere: what is left of l_meso is a midpoint rule along the beam. Its error
 *    must vanish, and with it the grid's own little barriers, jumps and losses, until the beam
 * peels reversibly at the crack length of its work of adhesion.
 * 3. The laws of the patches themselves. Finer patches are other laws: each sees fewer asperities,
 *    and the barriers they make are those of the surface. No order is owed; it is printed.
 *
 * l_meso may go down to the surface's correlation length, 0.7 um; below it patches are no longer
 * what a law f(d) stands for. */
#include "check.h"
#include "haft/study.h"

static const double lengths[] = {24e-6, 12e-6, 6e-6, 3e-6, 2e-6, 1.5e-6};
enum { LENGTHS = sizeof lengths / sizeof *lengths, BEAMS = 3 };

static haft_case *read_case(void) {
    haft_error error = {0};
    haft_case *c = NULL;
    check_ok(haft_case_read(&c, HAFT_SOURCE_DIR "/cases/delrio-rh85/case.yaml", &error), error);
    c->surface.grid_step = 10e-9; /* a quarter of the work; the same lattice as 5 nm */
    c->realizations = BEAMS;
    c->mesh.kind = HAFT_MESH_EXACT;
    return c;
}

/* ---- 1. the same surface ---- */

enum { ROWS = 2400, COLUMNS = 3000, DISTANCES = 45 };

/* The first 24 um of beam 0, block by block as the laws are built. */
static double *generate(haft_case *c, double l_meso) {
    haft_error error = {0};
    haft_surface_plan *plan = NULL;
    haft_surface_work *work = NULL;
    double *z = haft_memory_alloc((size_t)ROWS * COLUMNS, sizeof *z, &error);
    assert_non_null(z);
    c->mesh.l_meso = l_meso;
    size_t patches = haft_study_block_patches(c);
    size_t rows = patches * (size_t)llround(l_meso / c->surface.grid_step);
    check_ok(haft_study_surface_plan(&plan, c, patches, &error), error);
    check_ok(haft_surface_work_create(&work, plan, &error), error);
    for (size_t first = 0; first < ROWS; first += rows) {
        check_ok(haft_surface_prepare(work, 0, 0, (long)first, &error), error);
        check_ok(haft_surface_rows(work, 0, rows, z + first * COLUMNS, &error), error);
    }
    haft_surface_work_destroy(&work);
    haft_surface_plan_destroy(&plan);
    return z;
}

typedef struct means {
    double distance[DISTANCES], force[DISTANCES], wet[DISTANCES];
} means;

/* f and wet area averaged over the patches of those 24 um. */
static void average(const haft_case *c, const double *z, means *m) {
    haft_error error = {0};
    haft_contact_spec spec;
    haft_contact_work *work = NULL;
    size_t rows = (size_t)llround(c->mesh.l_meso / c->surface.grid_step);
    check_ok(haft_study_contact_spec(&spec, c, &error), error);
    check_ok(haft_contact_work_create(&work, rows, COLUMNS, &error), error);
    memset(m, 0, sizeof *m);
    for (int i = 0; i < DISTANCES; i++) {
        m->distance[i] = 6e-9 + 0.5e-9 * i;
    }
    for (size_t first = 0; first < ROWS; first += rows) {
        double force[DISTANCES], wet[DISTANCES];
        haft_curve curve = {
            .n = DISTANCES, .distance = m->distance, .force = force, .wet_area = wet};
        check_ok(haft_contact_curve(work, &spec, z + first * COLUMNS, rows, COLUMNS,
                                    c->surface.grid_step, &curve, &error),
                 error);
        for (int i = 0; i < DISTANCES; i++) {
            m->force[i] += force[i] * (double)rows / ROWS;
            m->wet[i] += wet[i] * (double)rows / ROWS;
        }
    }
    haft_contact_work_destroy(&work);
}

static void the_surface_is_the_same(void **state) {
    (void)state;
    haft_case *c = read_case();
    double *whole = generate(c, lengths[0]);
    means big, sub;
    average(c, whole, &big);
    double pull = 0;
    for (int i = 0; i < DISTANCES; i++) {
        pull = fmax(pull, -big.force[i]);
    }
    print_message("\n  The first 24 um of a beam, cut into patches: distance from the uncut\n"
                  "  %6s %14s %12s %22s\n  %6s %14s %12s %22s\n",
                  "l_meso", "heights", "wet area", "mean force, most", "[um]", "[m]", "",
                  "[of greatest pull]");
    for (int k = 0; k < LENGTHS; k++) {
        double *z = generate(c, lengths[k]), height = 0, wet = 0, force = 0;
        average(c, z, &sub);
        for (size_t i = 0; i < (size_t)ROWS * COLUMNS; i++) {
            height = fmax(height, fabs(z[i] - whole[i]));
        }
        for (int i = 0; i < DISTANCES; i++) {
            wet = fmax(wet, fabs(sub.wet[i] - big.wet[i]));
            if (big.force[i] < 0) { /* where it pulls: the wall's push is no scale for it */
                force = fmax(force, fabs(sub.force[i] - big.force[i]) / pull);
            }
        }
        print_message("  %6.1f %14.1e %12.1e %22.1e\n", 1e6 * lengths[k], height, wet, force);
        check_less(height, 1e-20);                       /* heights are nanometres */
        check_less(wet, 2.5 / ((double)ROWS * COLUMNS)); /* two points on the edge at most */
        haft_memory_free(z);
    }
    haft_memory_free(whole);
    haft_case_destroy(&c);
}

/* ---- cycles ---- */

typedef struct end {
    double strain, crack, dissipated;
    double jumps, seconds;
} end;

static end follow(const haft_case *c, const haft_law *law) {
    haft_error error = {0};
    haft_model *model = NULL;
    haft_path *path = NULL;
    check_ok(haft_model_create_beam(&model, &c->beam, &c->mesh, &error), error);
    double start = haft_clock_seconds();
    check_ok(haft_solve_path(&path, model, law, &c->programme, &c->path, &error), error);
    assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
    check_less(path->ledger_error, 1e-9);
    haft_path_point last = path->point[path->points - 1];
    end e = {last.internal_energy, last.crack_length, last.dissipated, (double)path->jumps,
             haft_clock_seconds() - start};
    haft_path_destroy(&path);
    haft_model_destroy(&model);
    return e;
}

/* ---- 2. one law everywhere ---- */

/* An S-shaped beam over a crack a lies 6 EI h^2 / a^3 from rest; that falls by Gamma w da for each
 * da, Gamma = 18 EI h^2 / (w a^4): Eq. 36. The height is the one above where the pull vanishes. */
static double sharp_crack_energy(const haft_beam_spec *beam, double adhesion, double zero) {
    haft_beam_spec lowered = *beam;
    lowered.gap -= zero;
    double a = haft_beam_equilibrium_crack(&lowered, adhesion);
    return 6 * haft_beam_bending_stiffness(beam) * lowered.gap * lowered.gap / (a * a * a);
}

static void one_law_everywhere_converges(void **state) {
    (void)state;
    static const double patch[] = {24e-6, 12e-6, 6e-6, 4e-6, 3e-6, 2e-6, 1.5e-6, 1e-6, 0.75e-6};
    enum { PATCHES = sizeof patch / sizeof *patch };
    haft_case *c = read_case();
    haft_law law[800];
    haft_law_vector v = {3.6e-3, 1e6, 11e-9, 8.2e-9};
    for (int r = 0; r < 800; r++) {
        assert_int_equal(haft_law_morse(&law[r], &v, 5e6), HAFT_LAW_SOUND);
    }
    double zero = v.d_max - log(2) / law[0].a_left; /* E = 2 there */
    print_message("\n  One law everywhere\n  %6s %10s %10s %6s %12s %8s\n  %6s %10s %10s %6s %12s "
                  "%8s\n",
                  "l_meso", "strain", "crack", "jumps", "dissipated", "time", "[um]", "[pJ]",
                  "[um]", "", "[pJ]", "[s]");
    end e[PATCHES];
    for (int k = 0; k < PATCHES; k++) {
        c->mesh.l_meso = patch[k];
        e[k] = follow(c, law);
        print_message("  %6.1f %10.5f %10.4f %6.0f %12.5f %8.3f\n", 1e6 * patch[k],
                      1e12 * e[k].strain, 1e6 * e[k].crack, e[k].jumps, 1e12 * e[k].dissipated,
                      e[k].seconds);
    }
    double sharp = sharp_crack_energy(&c->beam, v.e, zero);
    print_message("  a sharp crack of the law's work of adhesion: %.5f pJ\n", 1e12 * sharp);
    const end *last = &e[PATCHES - 1];
    check_near(last->strain, sharp, 0.03 * sharp); /* the pull reaches over 4 % of the crack */
    for (int k = PATCHES - 3; k < PATCHES; k++) {
        assert_true(e[k].jumps == 1); /* the pull-in, and then no barrier is left */
        check_relative(e[k].dissipated, last->dissipated, 1e-3);
        check_relative(e[k].strain, last->strain, 2e-3);
        check_relative(e[k].crack, last->crack, 1e-3);
    }
    haft_case_destroy(&c);
}

/* ---- 3. the laws of the patches ---- */

static void study(haft_case *c, haft_laws *const *laws, haft_law_kind kind, int count) {
    haft_error error = {0};
    end all[LENGTHS][BEAMS];
    size_t unfit[LENGTHS] = {0};
    c->law.kind = kind;
    for (int k = 0; k < count; k++) {
        c->mesh.l_meso = lengths[k];
        for (size_t b = 0; b < BEAMS; b++) {
            haft_site_laws *s = NULL;
            check_ok(haft_study_site_laws(&s, c, laws[k], b, &error), error);
            all[k][b] = follow(c, s->law);
            unfit[k] += s->unfit;
            haft_site_laws_destroy(&s);
        }
    }
    print_message(
        "\n  %s laws of %d fixed surfaces: strain energy and crack length at rest, a beam "
        "each; means of the rest\n  %6s %25s %25s %6s %10s %6s %8s\n"
        "  %6s %25s %25s %6s %10s %6s %8s\n",
        kind == HAFT_LAW_MORSE ? "Morse" : "Table", BEAMS, "l_meso", "strain energy",
        "crack length", "jumps", "lost", "unfit", "cycle", "[um]", "[pJ]", "[um]", "", "[pJ]", "",
        "[s]");
    for (int k = 0; k < count; k++) {
        double jumps = 0, lost = 0, seconds = 0;
        print_message("  %6.1f ", 1e6 * lengths[k]);
        for (int b = 0; b < BEAMS; b++) {
            print_message(" %8.4f", 1e12 * all[k][b].strain);
            jumps += all[k][b].jumps / BEAMS;
            lost += 1e12 * all[k][b].dissipated / BEAMS;
            seconds += all[k][b].seconds / BEAMS;
        }
        for (int b = 0; b < BEAMS; b++) {
            print_message(" %8.2f", 1e6 * all[k][b].crack);
        }
        print_message(" %6.1f %10.4f %6zu %8.3f\n", jumps, lost, unfit[k], seconds);
    }
}

static void the_patches_own_laws(void **state) {
    (void)state;
    haft_error error = {0};
    haft_case *c = read_case();
    haft_laws *laws[LENGTHS];
    print_message("\n  laws built:");
    for (int k = 0; k < LENGTHS; k++) {
        double start = haft_clock_seconds();
        c->mesh.l_meso = lengths[k];
        check_ok(haft_study_build_laws(&laws[k], c, NULL, &error), error);
        print_message(" %.1f um %.1f s;", 1e6 * lengths[k], haft_clock_seconds() - start);
    }
    print_message("\n");
    study(c, laws, HAFT_LAW_MORSE, LENGTHS);
    study(c, laws, HAFT_LAW_TABLE, LENGTHS - 1); /* at 1.5 um a cycle takes many minutes */
    for (int k = 0; k < LENGTHS; k++) {
        haft_laws_destroy(&laws[k]);
    }
    haft_case_destroy(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_surface_is_the_same),
                                       cmocka_unit_test(one_law_everywhere_converges),
                                       cmocka_unit_test(the_patches_own_laws)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
