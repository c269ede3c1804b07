/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many random beams, each on its exact, active and fine uniform mesh: followed, checked, held
 * against each other, and counted. */
#ifndef HAFT_TEST_STRESS_STUDY_H
#define HAFT_TEST_STRESS_STUDY_H

#include "stress_checks.h"

#include <omp.h>

enum { STRESS_EXACT, STRESS_ACTIVE, STRESS_UNIFORM, STRESS_MESHES };
enum { STRESS_STEPS = 20000, STRESS_REFUSAL = 200 };

static inline const char *stress_mesh_name(int mesh) {
    static const char *const name[STRESS_MESHES] = {"exact", "active", "uniform"};
    return name[mesh];
}

/* Which beams: `beams` from index `first` on. */
typedef struct stress_options {
    uint64_t seed, first, beams;
    size_t landings; /* compared a beam on its exact mesh, which costs most of the time: */
    size_t every;    /* of every so many beams of a family */
    bool told;       /* each beam is described */
} stress_options;

/* What came of a beam on one mesh. */
typedef struct stress_run {
    bool refused; /* the mesh or the programme was; then nothing else is known */
    char refusal[STRESS_REFUSAL];
    haft_outcome outcome;
    size_t points, jumps;
    double seconds, ledger_error;
    stress_finding finding;
} stress_run;

typedef struct stress_result {
    uint64_t index;
    stress_family family;
    stress_run run[STRESS_MESHES];
} stress_result;

/* Outcomes that say what is the case and what to do: an active mesh may be left, and pressing
 * without limit may not bring the crack asked for. */
static inline bool stress_is_explained(haft_outcome outcome, int mesh) {
    return outcome == HAFT_OUTCOME_STUCK || outcome == HAFT_OUTCOME_FREE ||
           outcome == HAFT_OUTCOME_CRACK_UNREACHED ||
           (outcome == HAFT_OUTCOME_ZONE_LEFT && mesh == STRESS_ACTIVE);
}

static inline bool stress_is_finished(const haft_path *path) {
    return path != NULL &&
           (path->outcome == HAFT_OUTCOME_STUCK || path->outcome == HAFT_OUTCOME_FREE);
}

/* A path with what it was followed on. */
typedef struct stress_followed {
    haft_model *model;
    haft_path *path;
    stress_oracle oracle;
} stress_followed;

/* Follows a beam on a mesh; run->refused if the library refuses that. */
static inline void stress_follow(const stress_beam *b, int mesh, stress_followed *out,
                                 stress_run *run) {
    static const haft_mesh_kind kind[STRESS_MESHES] = {HAFT_MESH_EXACT, HAFT_MESH_ACTIVE,
                                                       HAFT_MESH_UNIFORM};
    haft_mesh_spec spec = stress_beam_mesh(b, kind[mesh]);
    haft_path_options options = {.keep_states = true, .step_limit = STRESS_STEPS};
    haft_error *error = calloc(1, sizeof *error);
    double start = omp_get_wtime();
    if (haft_model_create_beam(&out->model, &b->spec, &spec, error) == HAFT_OK) {
        out->oracle = stress_oracle_make(b, out->model);
        haft_status status =
            haft_solve_path(&out->path, out->model, b->given, &b->programme, &options, error);
        run->refused = status != HAFT_OK;
    } else {
        run->refused = true;
    }
    run->seconds = omp_get_wtime() - start;
    snprintf(run->refusal, sizeof run->refusal, "%.*s", STRESS_REFUSAL - 1, error->message);
    free(error);
    if (!run->refused) {
        run->outcome = out->path->outcome;
        run->points = out->path->points;
        run->jumps = out->path->jumps;
        run->ledger_error = out->path->ledger_error;
    }
}

static inline void stress_followed_free(stress_followed *f) {
    stress_oracle_free(&f->oracle);
    haft_path_destroy(&f->path);
    haft_model_destroy(&f->model);
}

/* ---- meshes against each other ----------------------------------------------------------------
 */

/* The beams are the same but for the drag: all have a node at each site, and an Euler-Bernoulli
 * beam's displacements are exact at the nodes of Hermite elements wherever its forces act. So loads
 * of folds differ by the solver's tolerances alone; bifurcations are told within a step of 1e-6
 * lengths. */
#define STRESS_FOLD_LOAD 1e-7L
#define STRESS_EDGE_LOAD 1e-5L

static inline size_t stress_point_of_jump(const haft_path *path, size_t jump) {
    size_t i = 0;
    while (i < path->points && path->point[i].jump != (int)jump) {
        i++;
    }
    return i;
}

/* The farthest that two meshes' states have a site apart, in units of what may be. */
static inline long double stress_meshes_apart(const stress_oracle *a, const double *u,
                                              const stress_oracle *b, const double *v) {
    long double most = 0, gap = a->beam->spec.gap;
    for (size_t r = 0; r < a->beam->sites; r++) {
        long double miss =
            fabsl(stress_displacement(&a->site[r], u) - stress_displacement(&b->site[r], v));
        long double least = STRESS_LANDED * stress_beam_law(a->beam, r)->range;
        most = fmaxl(most, miss / fmaxl(least, 1e-9L * gap));
    }
    return most;
}

/* Where Newton leads from the state in which jump j landed, at a load nearby. To be freed. */
static inline double *stress_settle(stress_followed *on, size_t j, double load) {
    size_t bytes = on->oracle.dofs * sizeof(double);
    const double *u = on->path->state + stress_point_of_jump(on->path, j) * on->oracle.dofs;
    double *settled = malloc(bytes);
    if (!stress_flow_rests(&(stress_flow){&on->oracle, on->model, load}, u, settled, 1)) {
        memcpy(settled, u, bytes);
    }
    return settled;
}

/* The same of the states that jump j landed in, at the one's load. */
static inline long double stress_landings_apart(stress_followed *a, stress_followed *b, size_t j) {
    double load = a->path->jump[j].load;
    double *u = stress_settle(a, j, load), *v = stress_settle(b, j, load);
    long double apart = stress_meshes_apart(&a->oracle, u, &b->oracle, v);
    free(u);
    free(v);
    return apart;
}

/* What the oracle says of where a jump landed. */
typedef enum stress_verdict { STRESS_CONFIRMED, STRESS_LOST, STRESS_REFUTED } stress_verdict;

/* Whether the flow on a mesh leads where its jump j landed; lost where the oracle gives up, or the
 * jump began in no simple fold. */
static inline stress_verdict stress_judge(stress_followed *on, size_t j) {
    stress_finding found = {0};
    size_t i = stress_point_of_jump(on->path, j);
    bool agrees = false;
    if (i == 0) {
        agrees = stress_check_start(&on->oracle, on->model, on->path, &found);
    } else if (on->path->jump[j].departure == HAFT_DEPARTURE_FOLD) {
        agrees = stress_check_landing(&on->oracle, on->model, on->path, i, &found);
    }
    bool wrong = found.worst[STRESS_LANDING] > 1 || found.worst[STRESS_START] > 1;
    return agrees ? STRESS_CONFIRMED : wrong ? STRESS_REFUTED : STRESS_LOST;
}

/* What a force out of balance makes of a fold's load, at most: as much more as the sites move
 * beside the load's own point where the load moves them, in the last state before jump j. And what
 * may be out of balance there [N]. */
static inline long double stress_load_slack(stress_followed *on, size_t j) {
    stress_oracle *o = &on->oracle;
    size_t i = stress_point_of_jump(on->path, j), at = i > 0 ? i - 1 : 0;
    stress_evaluate(o, on->path->state + at * o->dofs, on->path->point[at].load);
    long double slack = stress_slack(o), most = 0;
    stress_factorize(o, 0);
    memset(o->gradient, 0, o->dofs * sizeof *o->gradient);
    stress_add(o, &o->load, -1, 0);
    stress_newton(o);
    for (size_t r = 0; r < o->beam->sites; r++) {
        most = fmaxl(most, fabsl(stress_step_of(o, &o->site[r])));
    }
    return slack * (1 + most / fabsl(stress_step_of(o, &o->load)));
}

/* What the loads of a jump differ by, in units of what may be. */
static inline long double stress_loads_apart(stress_followed *a, stress_followed *b, size_t j) {
    const haft_jump *x = &a->path->jump[j], *y = &b->path->jump[j];
    bool fold = x->departure == HAFT_DEPARTURE_FOLD && y->departure == HAFT_DEPARTURE_FOLD;
    long double most = fmaxl(fabs(x->load), fabs(y->load));
    long double allowed = (fold ? STRESS_FOLD_LOAD : STRESS_EDGE_LOAD) * most +
                          stress_load_slack(a, j) + stress_load_slack(b, j);
    return x->phase == y->phase ? fabsl((long double)x->load - y->load) / allowed : INFINITY;
}

/* Holds the path on a mesh against that on the exact one, up to the first jump that differs. */
static inline void stress_compare(stress_followed *exact, stress_followed *other,
                                  stress_finding *f) {
    const haft_path *a = exact->path, *b = other->path;
    size_t jumps = a->jumps < b->jumps ? a->jumps : b->jumps;
    for (size_t j = 0; j < jumps; j++) {
        long double miss = stress_loads_apart(exact, other, j);
        stress_note(f, STRESS_MESH_JUMPS, miss, j);
        if (!(miss <= 1)) {
            return;
        }
        long double apart = stress_landings_apart(exact, other, j);
        if (!(apart <= 1)) {
            stress_verdict x = stress_judge(exact, j), y = stress_judge(other, j);
            if (x == STRESS_REFUTED || y == STRESS_REFUTED) {
                stress_note(f, STRESS_MESH_LANDED, apart, j);
            } else {
                bool both = x == STRESS_CONFIRMED && y == STRESS_CONFIRMED;
                f->dragged += both;
                f->undecided += !both;
            }
            return;
        }
        stress_note(f, STRESS_MESH_LANDED, apart, j);
    }
    if (a->jumps != b->jumps) {
        stress_note(f, STRESS_MESH_JUMPS, INFINITY, jumps);
        return;
    }
    long double apart =
        stress_meshes_apart(&exact->oracle, a->final_state, &other->oracle, b->final_state);
    stress_note(f, STRESS_MESH_END, a->outcome == b->outcome ? apart : INFINITY, jumps);
}

/* ---- one beam ----------------------------------------------------------------------------------
 */

static inline void stress_check_meshes(const stress_beam *b, size_t landings,
                                       stress_result *result) {
    stress_followed on[STRESS_MESHES] = {{0}};
    for (int m = 0; m < STRESS_MESHES; m++) {
        stress_run *run = &result->run[m];
        stress_follow(b, m, &on[m], run);
        if (!run->refused) {
            stress_check_path(&on[m].oracle, on[m].model, on[m].path,
                              m == STRESS_EXACT ? landings : 0, &run->finding);
        }
        if (m != STRESS_EXACT && stress_is_finished(on[STRESS_EXACT].path) &&
            stress_is_finished(on[m].path)) {
            stress_compare(&on[STRESS_EXACT], &on[m], &run->finding);
        }
    }
    for (int m = 0; m < STRESS_MESHES; m++) {
        stress_followed_free(&on[m]);
    }
}

static inline void stress_describe(const stress_beam *b);

static inline stress_result stress_beam_run(const stress_options *options, uint64_t index) {
    haft_error *error = calloc(1, sizeof *error);
    stress_result result = {.index = index};
    stress_beam b;
    bool drawn = stress_beam_draw(&b, options->seed, index, error);
    result.family = b.family;
    if (options->told) {
        stress_describe(&b);
    }
    for (int m = 0; m < STRESS_MESHES && !drawn; m++) {
        result.run[m].refused = true;
        snprintf(result.run[m].refusal, STRESS_REFUSAL, "%.*s", STRESS_REFUSAL - 1, error->message);
    }
    if (drawn) {
        bool sampled = index / STRESS_FAMILIES % options->every == 0;
        stress_check_meshes(&b, sampled ? options->landings : 0, &result);
    }
    stress_beam_free(&b);
    free(error);
    return result;
}

static inline void stress_describe(const stress_beam *b) {
    const haft_beam_spec *s = &b->spec;
    print_message(
        "  beam %llu of seed %llu: %s; length %.17g width %.17g thickness %.17g gap %.17g "
        "m, E %.17g Pa, %zu sites, load at %.17g m, crack to %.17g m, load to %.17g N, "
        "active from %.17g m\n",
        (unsigned long long)b->index, (unsigned long long)b->seed, stress_family_name(b->family),
        s->length, s->width, s->thickness, s->gap, s->young_modulus, b->sites, b->load_position,
        b->programme.crack_length, b->programme.load_limit, b->active_from);
    for (size_t k = 0; k < b->laws; k++) {
        const stress_law *l = &b->law[k];
        if (l->points == 0) {
            print_message(
                "    law %zu: Morse e %.17g f_max %.17g d_max %.17g d_limit %.17g f_limit "
                "%.17g, range %.3g m\n",
                k, l->vector.e, l->vector.f_max, l->vector.d_max, l->vector.d_limit, l->f_limit,
                l->range);
            continue;
        }
        print_message("    law %zu: table of %zu, range %.3g m:", k, l->points, l->range);
        for (size_t i = 0; i < l->points && l->points < 40; i++) {
            print_message(" (%.17g, %.17g)", l->x[i], l->f[i]);
        }
        print_message("\n");
    }
}

#endif
