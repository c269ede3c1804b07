/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of a run as a computation: the certificate of every state, the ledger, the scales that
 * grid, mesh and beam must resolve, the number of beams. Bounds are rules of thumb, reported
 * beside the numbers; the error budget measures the errors themselves. */
#include "findings.h"

#include <math.h>
#include <stdio.h>

/* Grid points that the shortest wave should have; two represent it. */
static const double POINTS_A_WAVE = 4;
/* Share of the total work that rounding may miss. */
static const double LEDGER_BOUND = 1e-8;
/* Share of a deflection at the free end that may reach the crack's tip. */
static const double END_BOUND = 0.01;
/* Half width of the mean's interval over the mean, and number of beams from which the interval
 * is trusted. */
static const double MEAN_BOUND = 0.02;
static const size_t BEAMS_LEAST = 10;

haft_status haft_study_correlation_length(double *length, const haft_case *c, double share,
                                          haft_error *error) {
    haft_surface_plan *plan = NULL;
    *length = NAN;
    HAFT_TRY(haft_study_surface_plan(&plan, c, 1, error));
    long last = lround(c->beam.width / c->surface.grid_step) - 1;
    double variance = haft_surface_covariance(plan, 0, 0);
    long lag = last;
    while (lag > 0 && fabs(haft_surface_covariance(plan, 0, lag)) < share * variance) {
        lag--;
    }
    *length = (double)(lag + 1) * c->surface.grid_step;
    haft_surface_plan_destroy(&plan);
    return HAFT_OK;
}

/* ---- the paths ---- */

/* The least pivot and eigenvalue of all accepted states of all beams. */
static haft_status find_certificates(haft_findings *out, const haft_evidence *e,
                                     haft_error *error) {
    double least_pivot = INFINITY, least_eigenvalue = INFINITY;
    size_t states = 0, beams = 0;
    haft_results_file *results = NULL;
    haft_status status = haft_results_open(&results, e->results_path, error);
    for (size_t k = 0; status == HAFT_OK && k < e->c->realizations; k++) {
        haft_path *path = NULL;
        if (e->summary[k].outcome < 0) {
            continue;
        }
        status = haft_results_take_path(&path, results, k, error);
        if (status != HAFT_OK) {
            break;
        }
        for (size_t i = 0; i < path->points; i++) {
            least_pivot = fmin(least_pivot, path->point[i].least_pivot);
            least_eigenvalue = fmin(least_eigenvalue, path->point[i].lambda_min);
        }
        states += path->points;
        beams++;
        haft_path_destroy(&path);
    }
    haft_results_close(&results);
    if (status != HAFT_OK) {
        return status;
    }
    bool stable = least_pivot > 0 && least_eigenvalue > 0;
    haft_findings_add(
        out,
        &(haft_finding){.subject = "every state is stable",
                        .verdict = stable ? HAFT_VERDICT_HOLDS : HAFT_VERDICT_BROKEN,
                        .value = least_eigenvalue,
                        .limit = 0},
        "A beam can only rest where every small push costs energy. All %zu states of %zu beams "
        "carry "
        "a certificate of that: the least stiffness against any movement is %.3g (scaled; must be "
        "above 0), the least pivot %.3g of the largest.",
        states, beams, least_eigenvalue, least_pivot);
    return HAFT_OK;
}

static void find_ledger(haft_findings *out, const haft_statistics *s) {
    haft_findings_add(
        out,
        &(haft_finding){.subject = "the energy ledger closes",
                        .verdict = s->ledger_error <= LEDGER_BOUND ? HAFT_VERDICT_HOLDS
                                                                   : HAFT_VERDICT_BROKEN,
                        .value = s->ledger_error,
                        .limit = LEDGER_BOUND},
        "Work of the load = energy stored + energy lost in jumps, at every step of every beam, to "
        "%.1e of the work (bound %.0e).",
        s->ledger_error, LEDGER_BOUND);
}

/* The first failed beam with its outcome and advice; nothing if there is none. */
static void describe_failure(const haft_evidence *e, size_t capacity, char *text) {
    text[0] = '\0';
    for (size_t k = 0; k < e->c->realizations; k++) {
        haft_outcome outcome = (haft_outcome)e->summary[k].outcome;
        if ((int)outcome >= 0 && outcome != HAFT_OUTCOME_STUCK && outcome != HAFT_OUTCOME_FREE) {
            snprintf(text, capacity,
                     ", and count in no statistics. The first is realization %zu: %s; %s", k,
                     haft_outcome_name(outcome), haft_outcome_advice(outcome));
            return;
        }
    }
}

static void find_outcomes(haft_findings *out, const haft_evidence *e) {
    const haft_statistics *s = &e->statistics;
    char failure[400];
    describe_failure(e, sizeof failure, failure);
    haft_findings_add(
        out,
        &(haft_finding){.subject = "every beam was followed to its end",
                        .verdict = s->failed == 0       ? HAFT_VERDICT_HOLDS
                                   : s->failed < s->run ? HAFT_VERDICT_DOUBTFUL
                                                        : HAFT_VERDICT_BROKEN,
                        .value = (double)s->failed,
                        .limit = 0},
        "%zu of %zu beams were run; %zu of them could not be followed until the load was gone%s.",
        s->run, e->c->realizations, s->failed, failure);
}

/* ---- the scales ---- */

static void find_grid(haft_findings *out, const haft_case *c) {
    double wave = 2 * M_PI / c->surface.psd.zeta_max, points = wave / c->surface.grid_step;
    haft_findings_add(
        out,
        &(haft_finding){.subject = "the grid resolves the roughness",
                        .verdict =
                            points >= POINTS_A_WAVE ? HAFT_VERDICT_HOLDS : HAFT_VERDICT_DOUBTFUL,
                        .value = points,
                        .limit = POINTS_A_WAVE},
        "The shortest wave of the roughness, %.1f nm, has %.1f points of the %.3g nm grid; %.0f or "
        "more show its peaks (2 barely carry it).",
        wave * 1e9, points, c->surface.grid_step * 1e9, POINTS_A_WAVE);
}

/* Bending length of a beam on a foundation with the steepest slope of its laws' pull. */
static double foundation_length(const haft_evidence *e) {
    double steepest = 0;
    size_t n = 0;
    for (size_t r = 0; r < e->sites->sites; r++) {
        const haft_law *law = &e->sites->law[r];
        double range = haft_law_range(law);
        if (law->f_max > 0 && range > 0) {
            steepest += law->f_max / range;
            n++;
        }
    }
    double k = n > 0 ? steepest / (double)n * e->c->beam.width : 0;
    return k > 0 ? pow(4 * haft_beam_bending_stiffness(&e->c->beam) / k, 0.25) : INFINITY;
}

static void find_elements(haft_findings *out, const haft_evidence *e) {
    const haft_case *c = e->c;
    if (c->mesh.kind != HAFT_MESH_UNIFORM) {
        haft_findings_add(out,
                          &(haft_finding){.subject = "the elements resolve the beam",
                                          .verdict = HAFT_VERDICT_HOLDS,
                                          .value = 0,
                                          .limit = NAN},
                          "A node at every patch that can come into contact: between its nodes the "
                          "beam is exactly the cubic that the elements are.");
        return;
    }
    double bend = foundation_length(e), ratio = c->mesh.element_length / bend;
    haft_findings_add(
        out,
        &(haft_finding){.subject = "the elements resolve the beam",
                        .verdict = ratio <= 1   ? HAFT_VERDICT_HOLDS
                                   : ratio <= 4 ? HAFT_VERDICT_DOUBTFUL
                                                : HAFT_VERDICT_BROKEN,
                        .value = ratio,
                        .limit = 1},
        "Elements of %.3g µm against the %.3g µm over which the beam bends where its surfaces pull "
        "(a beam on a foundation as stiff as the laws): %.2g; 1 or less resolves it, and mesh: "
        "active leaves nothing to resolve.",
        c->mesh.element_length * 1e6, bend * 1e6, ratio);
}

static void find_end(haft_findings *out, const haft_evidence *e) {
    double influence = e->statistics.end_influence;
    haft_findings_add(
        out,
        &(haft_finding){.subject = "the beam is long enough",
                        .verdict = !(influence <= 0.1)      ? HAFT_VERDICT_BROKEN
                                   : influence <= END_BOUND ? HAFT_VERDICT_HOLDS
                                                            : HAFT_VERDICT_DOUBTFUL,
                        .value = influence,
                        .limit = END_BOUND},
        "Of a deflection at its free end, %.1e reach the crack's tip (bound %.0e). %s", influence,
        END_BOUND,
        influence <= END_BOUND
            ? "So little does it matter what the beam is like beyond its modelled end."
            : "If the real beam goes on beyond its modelled end, model more of it; if "
              "it ends there, this is no error.");
}

/* ---- the sample ---- */

static void find_beams(haft_findings *out, const haft_evidence *e) {
    const haft_statistics *s = &e->statistics;
    double half = 0.5 * (s->mean_interval.high - s->mean_interval.low);
    double wanted =
        e->c->stop.crack_length_mean > 0 ? e->c->stop.crack_length_mean : MEAN_BOUND * s->mean;
    bool enough = s->stuck >= BEAMS_LEAST && half <= wanted;
    if (s->stuck == 0) {
        haft_findings_add(
            out,
            &(haft_finding){.subject = "enough beams",
                            .verdict =
                                s->free >= BEAMS_LEAST ? HAFT_VERDICT_HOLDS : HAFT_VERDICT_DOUBTFUL,
                            .value = s->stuck_interval.high,
                            .limit = NAN},
            "None of %zu beams stuck: with %.4g %% confidence the probability to stick is between "
            "0 and %.3g %%. There is no crack length to average.",
            s->free, 100 * s->confidence, 100 * s->stuck_interval.high);
        return;
    }
    haft_findings_add(
        out,
        &(haft_finding){.subject = "enough beams",
                        .verdict = enough ? HAFT_VERDICT_HOLDS : HAFT_VERDICT_DOUBTFUL,
                        .value = half,
                        .limit = wanted},
        "The mean of %zu beams is known to ±%.3g µm with %.4g %% confidence (%.2g %% "
        "of it; %.3g µm or less from %zu beams or more counts as enough). To halve "
        "that takes four times as many.",
        s->stuck, half * 1e6, 100 * s->confidence, 100 * half / s->mean, wanted * 1e6, BEAMS_LEAST);
}

static void find_sampler(haft_findings *out, const haft_case *c, const haft_laws *laws) {
    if (laws->chaos == NULL) {
        return;
    }
    const haft_chaos_errors *errors = &laws->errors;
    double worst = 0;
    for (size_t i = 0; i < HAFT_CHAOS_DIMENSION; i++) {
        if (isfinite(errors->variance_error[i])) {
            worst = fmax(worst, fabs(errors->variance_error[i]));
        }
    }
    bool used = c->law.sampler == HAFT_SAMPLER_GPCE;
    haft_findings_add(
        out,
        &(haft_finding){.subject = "the stochastic model is converged",
                        .verdict = !used || worst <= 0.05 ? HAFT_VERDICT_HOLDS
                                   : worst <= 0.2         ? HAFT_VERDICT_DOUBTFUL
                                                          : HAFT_VERDICT_BROKEN,
                        .value = worst,
                        .limit = 0.05},
        "Laws are drawn from a model of %zu patches. Its polynomial expansion lacks %.2g %% of the "
        "variance of a law's numbers at most and differs from the density it stands for by %.2g "
        "(relMISE); the components left out hold %.2g %% of their variance.%s",
        laws->m, 100 * worst, errors->relmise_total, 100 * errors->reduction,
        used ? "" : " This case's sampler does not use the expansion.");
}

/* ---- all of them ---- */

static haft_status gather(haft_evidence *e, size_t realization, haft_error *error) {
    haft_summary again;
    HAFT_TRY(haft_model_create_beam(&e->model, &e->c->beam, &e->c->mesh, error));
    HAFT_TRY(haft_study_site_laws(&e->sites, e->c, e->laws, realization, error));
    HAFT_TRY(haft_study_realize(&e->path, &again, e->c, e->model, e->sites, true, error));
    return haft_study_correlation_length(&e->correlation, e->c, 0.01, error);
}

haft_status haft_study_find(haft_findings *out, const haft_case *c, const haft_laws *laws,
                            const char *results_path, const haft_summary *summary,
                            size_t realization, haft_error *error) {
    haft_evidence e = {.c = c,
                       .laws = laws,
                       .results_path = results_path,
                       .summary = summary,
                       .statistics = haft_study_statistics(c, summary, c->realizations)};
    *out = (haft_findings){0};
    haft_status status = gather(&e, realization, error);
    HAFT_THEN(status, find_certificates(out, &e, error));
    if (status == HAFT_OK) {
        find_ledger(out, &e.statistics);
        find_outcomes(out, &e);
        find_grid(out, c);
        find_elements(out, &e);
        find_end(out, &e);
        find_beams(out, &e);
        find_sampler(out, c, laws);
        status = haft_findings_of_model(out, &e, error);
    }
    haft_path_destroy(&e.path);
    haft_site_laws_destroy(&e.sites);
    haft_model_destroy(&e.model);
    return status;
}
