/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Adhesion so weak, or so soft, that the beam hardly feels it: beams that let go entirely, beams
 * that hold by their tip alone (a cantilever with one law at its end is a spring, with folds in
 * closed form), and laws that are nearly nothing (first-order perturbation). */
#include "check.h"
#include "from_rest.h"
#include "haft/solve.h"

static const haft_beam_spec BEAM = {600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};

static haft_model *make_beam(const haft_beam_spec *beam, double element, double meso,
                             double load_at) {
    haft_error error = {0};
    haft_mesh_spec mesh = {HAFT_MESH_UNIFORM, element, meso, load_at, 0};
    haft_model *model = NULL;
    check_ok(haft_model_create_beam(&model, beam, &mesh, &error), error);
    return model;
}

static haft_path *follow(const haft_model *model, const haft_law *law, double crack, double limit) {
    haft_error error = {0};
    haft_programme programme = {crack, 0.01, limit};
    haft_path_options options = {.keep_states = true};
    haft_path *path = NULL;
    check_ok(haft_solve_path(&path, model, law, &programme, &options, &error), error);
    return path;
}

static haft_law make_law(double e, double f_max, double d_max, double d_limit, double f_limit) {
    haft_law law;
    haft_law_vector v = {e, f_max, d_max, d_limit};
    assert_int_equal(haft_law_morse(&law, &v, f_limit), HAFT_LAW_SOUND);
    return law;
}

/* 1e-6 J/m2 holds 600 um nowhere (Griffith's crack is 2 mm): the cycle closes, and the load's work
 * is what was lost, but for the ledger's error in the work turned over, 30000 times the loss. */
static void a_microjoule_lets_a_short_beam_go(void **state) {
    (void)state;
    haft_model *model = make_beam(&BEAM, 15e-6, 3e-6, 60e-6);
    haft_law law[200];
    for (size_t r = 0; r < 200; r++) {
        double z[1];
        haft_random_normals((haft_random_key){9, HAFT_RANDOM_TEST}, 0, r, 0, 1, z);
        double scale = exp(0.2 * z[0]);
        law[r] = make_law(1e-6 * scale, 1e3 * scale, 2e-9, 1.2e-9, 5e3);
    }
    haft_path *path = follow(model, law, 150e-6, INFINITY);
    haft_path_point end = path->point[path->points - 1];
    double work = path->point[path->turn].work;
    assert_int_equal(path->outcome, HAFT_OUTCOME_FREE);
    assert_true(end.load == 0 && path->jumps > 0 && end.dissipated > 0);
    check_near((end.work - end.dissipated) / work, 0, 1e-12);
    check_near(end.internal_energy / work, 0, 1e-12);
    assert_true(end.crack_length ==
                haft_model_get(model)->node_x[haft_model_get(model)->nodes - 1]);
    check_less(path->ledger_error, 1e-10);
    print_message("  %zu jumps, lost %.3e of %.3e J, closed to %.1e of the loss\n", path->jumps,
                  end.dissipated, work, fabs(end.work / end.dissipated - 1));
    haft_path_destroy(&path);
    haft_model_destroy(&model);
}

/* And holds 4 mm: Griffith's crack as the range goes to zero, with order 1/2 (the zone at the tip
 * is (EI range / (width f_max))^(1/4) long, f_max going as 1 / range). */
static void a_microjoule_holds_a_long_beam(void **state) {
    (void)state;
    enum { SITES = 800 };
    static haft_law law[SITES];
    haft_beam_spec beam = BEAM;
    beam.length = 4e-3;
    double griffith = haft_beam_equilibrium_crack(&beam, 1e-6), last = 0;
    assert_true(griffith > 1.9e-3 && griffith < 2.1e-3);
    haft_model *model = make_beam(&beam, 20e-6, 5e-6, 400e-6);
    for (double range = 16e-9; range > 0.9e-9; range /= 4) {
        for (size_t r = 0; r < SITES; r++) {
            law[r] = make_law(1e-6, 0.5e-6 / range, range, 0.4 * range, 0.5e-6 / range);
        }
        haft_path *path = follow(model, law, griffith - 3e-4, INFINITY);
        haft_path_point end = path->point[path->points - 1];
        assert_int_equal(path->outcome, HAFT_OUTCOME_STUCK);
        check_less(path->ledger_error, 1e-10);
        double miss = fabs(end.crack_length / griffith - 1);
        print_message("  range %4.1f nm: crack %.4f mm, Griffith %.4f mm, %.2f %% off, %zu jumps, "
                      "ledger %.1e\n",
                      range * 1e9, end.crack_length * 1e3, griffith * 1e3, 100 * miss, path->jumps,
                      path->ledger_error);
        if (last > 0) {
            check_near(log(last / miss) / log(4), 0.5, 0.06);
        }
        last = miss;
        haft_path_destroy(&path);
    }
    haft_model_destroy(&model);
}

/* Weak in earnest: pulls that let the beam go, the closed cycle's work being what it lost. */
static void a_beam_let_go_gives_back_all_but_the_loss(void **state) {
    (void)state;
    haft_model *model = make_beam(&BEAM, 15e-6, 3e-6, 60e-6);
    haft_law law[200];
    for (uint64_t seed = 1; seed <= 3; seed++) {
        for (size_t r = 0; r < 200; r++) {
            double z[2];
            haft_random_normals((haft_random_key){seed, HAFT_RANDOM_TEST}, 3, r, 0, 2, z);
            double e = 1.5e-6 * exp(0.25 * z[0]);
            law[r] = make_law(e, 800 * exp(0.2 * z[0]), 9.5e-9 + 0.3e-9 * z[1], 7e-9, 5e6);
        }
        haft_path *path = follow(model, law, 500e-6, INFINITY);
        assert_int_equal(path->outcome, HAFT_OUTCOME_FREE);
        haft_path_point end = path->point[path->points - 1];
        double lost = 0;
        for (size_t j = 0; j < path->jumps; j++) {
            lost += path->jump[j].dissipated;
        }
        assert_true(path->jumps > 1);
        print_message("  %zu jumps, lost %.3e of %.3e J, work of the cycle to %.1e\n", path->jumps,
                      lost, path->point[path->turn].work, fabs(end.work / lost - 1));
        check_relative(end.work, lost, 1e-9);
        haft_path_destroy(&path);
    }
    haft_model_destroy(&model);
}

/* Cantilever compliance w(x) per unit force at a. */
static double compliance(double x, double a) {
    double ei = haft_beam_bending_stiffness(&BEAM);
    return x <= a ? x * x * (3 * a - x) / (6 * ei) : a * a * (3 * x - a) / (6 * ei);
}

/* The load at which the end's gap rests at d: gap - d = P c_sp - A f(d) c_ss. */
static double load_at_gap(const haft_law *law, double area, double xs, double xp, double d) {
    double f = area * haft_law_evaluate(law, d).force;
    return (BEAM.gap - d + f * compliance(xs, xs)) / compliance(xs, xp);
}

/* One law, under the last patch; nothing elsewhere. */
static void a_tip_alone_sticks_by_closed_form(void **state) {
    (void)state;
    static const double pull[] = {150, 1e3, 1e4, 1e6}; /* Pa on 30 um x 30 um */
    enum { SITES = 20 };
    for (size_t p = 0; p < sizeof pull / sizeof *pull; p++) {
        haft_model *model = make_beam(&BEAM, 15e-6, 30e-6, 60e-6);
        assert_int_equal(haft_model_get(model)->sites, SITES);
        haft_law law[SITES];
        for (size_t r = 0; r < SITES; r++) {
            law[r] = make_law(1e-3, 1e6, -1.0, -1.0 - 1e-9, 1e6);
        }
        double range = 2e-9, area = haft_model_get(model)->site[SITES - 1].area,
               xs = haft_model_get(model)->site[SITES - 1].x;
        haft_law *tip = &law[SITES - 1];
        *tip = make_law(2 * pull[p] * range, pull[p], 9e-9, 6e-9, 5 * pull[p]);
        double k = 1 / compliance(xs, xs), c = k / (2 * area * pull[p] * tip->a_right);
        assert_true(c < 0.25);
        double root = sqrt(1 - 4 * c), near_e = (1 + root) / 2, far_e = 2 * c / (1 + root);
        double in = load_at_gap(tip, area, xs, 60e-6, tip->d_max - log(far_e) / tip->a_right);
        double out = load_at_gap(tip, area, xs, 60e-6, tip->d_max - log(near_e) / tip->a_right);
        haft_path *path = follow(model, law, -1, 1.001 * in);
        check_relative(path->jump[0].load, in, 1e-11);
        assert_int_equal(path->jump[0].site, SITES - 1);
        assert_int_equal(path->jumps, out > 0 ? 2 : 1);
        assert_int_equal(path->outcome, out > 0 ? HAFT_OUTCOME_FREE : HAFT_OUTCOME_STUCK);
        haft_path_point end = path->point[path->points - 1];
        if (out > 0) {
            check_near(path->jump[1].load, out, 1e-11 * in);
            check_relative(end.work, end.dissipated, 1e-9);
        } else {
            /* the beam hangs in an arc by the force at its end: w = F c(x, x_s) */
            double w =
                haft_model_displacement(&haft_model_get(model)->site[SITES - 1], path->final_state);
            double force = w * k, d = BEAM.gap - w;
            check_relative(-area * haft_law_evaluate(tip, d).force, force, 1e-9);
            check_relative(end.internal_energy, 0.5 * force * w, 1e-9);
            for (double x = 20e-6; x < 600e-6; x += 37e-6) {
                double shape, slope;
                haft_model_shape(model, path->final_state, x, &shape, &slope);
                check_relative(shape, force * compliance(x, xs), 1e-9);
            }
            /* the tip of the crack: where the arc comes into the last law's reach, or the patch's
             * border if it is there already */
            double level = BEAM.gap - haft_law_reach(tip, 0.01), low = 570e-6, high = 600e-6;
            assert_true(force * compliance(high, xs) > level);
            for (int i = 0; i < 100; i++) {
                double middle = 0.5 * (low + high);
                *(force * compliance(middle, xs) < level ? &low : &high) = middle;
            }
            check_relative(end.crack_length, high, 1e-9);
        }
        check_less(path->ledger_error, 1e-10);
        print_message("  pull %g Pa: in at %.4e N, out at %+.4e N, %s, crack %.3f um\n", pull[p],
                      in, out, haft_outcome_name(path->outcome), end.crack_length * 1e6);
        haft_path_destroy(&path);
        haft_model_destroy(&model);
    }
}

/* Nearly nothing: pulls of a hundredth of a pascal and less over half a micrometre. No jump and no
 * loss but on the way from u = 0, and the rest position is the sum of the pulls at the undeformed
 * gap times the compliance, to first order. */
static void laws_that_are_nearly_nothing_only_perturb(void **state) {
    (void)state;
    haft_model *model = make_beam(&BEAM, 30e-6, 6e-6, 60e-6);
    haft_law law[100];
    double last = 0;
    double strongest = 1;
    for (double pull = strongest; pull > 0.9e-4; pull /= 100) {
        double f0 = 0, tip = 0, range = 0.5e-6;
        for (size_t r = 0; r < 100; r++) {
            law[r] = make_law(2 * pull * range, pull, 10e-9, -40e-9, 2 * pull);
            f0 = haft_model_get(model)->site[r].area * haft_law_evaluate(&law[r], BEAM.gap).force;
            tip -= f0 * compliance(597e-6, haft_model_get(model)->site[r].x);
        }
        haft_path *path = follow(model, law, -1, 1e-5);
        assert_int_equal(path->jumps, jumps_from_rest(path));
        assert_true(path->turned_by_load);
        haft_path_point top = path->point[path->turn], end = path->point[path->points - 1];
        assert_true(end.dissipated == path->point[0].dissipated);
        check_near(end.work / top.work, 0, 1e-10);
        double w = haft_model_displacement(&haft_model_get(model)->site[99], path->final_state);
        double miss = fabs(w / tip - 1);
        print_message("  pull %.0e Pa: tip at %.6e m, first order %.6e, off by %.1e; ledger %.1e\n",
                      pull, w, tip, miss, path->ledger_error);
        check_less(miss, 10 * pull); /* of first order in the pull */
        if (last > 0) {
            check_near(log10(last / miss), 2, 0.02);
        }
        last = miss;
        haft_path_destroy(&path);
    }
    haft_model_destroy(&model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_microjoule_lets_a_short_beam_go),
        cmocka_unit_test(a_microjoule_holds_a_long_beam),
        cmocka_unit_test(a_beam_let_go_gives_back_all_but_the_loss),
        cmocka_unit_test(a_tip_alone_sticks_by_closed_form),
        cmocka_unit_test(laws_that_are_nearly_nothing_only_perturb),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
