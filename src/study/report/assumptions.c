/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of the assumptions of a run's model: separated scales, elastic asperities, separate
 * menisci, and laws that are used within the distances they were computed for. Each is judged
 * from the laws of all patches or from the states of one beam. A bound is where the assumption
 * begins to fail, not a proof. */
#include "findings.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

/* Number of correlation lengths that a patch should span. */
static const double LENGTHS_A_PATCH = 3;
/* Mean pressure at which a spherical asperity begins to yield, over its hardness (Tabor 1951: Y is
 * H / 2.8 and yield begins at 1.1 Y). */
static const double YIELD_SHARE = 0.4;
/* Wet share of the area beyond which menisci are no longer separate. */
static const double WET_BOUND = 0.5;

static haft_verdict judge(double value, double good, double bad) {
    return value <= good  ? HAFT_VERDICT_HOLDS
           : value <= bad ? HAFT_VERDICT_DOUBTFUL
                          : HAFT_VERDICT_BROKEN;
}

static void find_scales(haft_findings *out, const haft_evidence *e) {
    double patch = fmin(e->c->mesh.l_meso, e->c->beam.width), ratio = patch / e->correlation;
    haft_findings_add(
        out,
        &(haft_finding){.subject = "patches are larger than the roughness",
                        .assumption = true,
                        .verdict = judge(-ratio, -LENGTHS_A_PATCH, -1),
                        .value = ratio,
                        .limit = LENGTHS_A_PATCH},
        "One force law stands for each patch, so a patch should hold many independent bits of "
        "surface. Its shorter side, %.3g µm, is %.2g correlation lengths of the roughness (%.3g "
        "µm, "
        "where the autocorrelation stays below 1 %%); %.0f or more count as apart.",
        patch * 1e6, ratio, e->correlation * 1e6, LENGTHS_A_PATCH);
}

/* The largest change of a gap along a patch in reach after unloading, over the range of its law;
 * and that change. NaN if no patch is in reach. */
static haft_status find_slope(haft_findings *out, const haft_evidence *e, haft_error *error) {
    const haft_model_data *model = haft_model_get(e->model);
    if (e->path->points == 0 || e->path->outcome != HAFT_OUTCOME_STUCK) {
        return HAFT_OK;
    }
    double *gap = haft_memory_alloc(model->sites, sizeof *gap, error);
    if (gap == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    const double *u = e->path->final_state;
    haft_model_gaps(e->model, u, gap);
    double worst = 0, change = 0;
    for (size_t r = model->inert; r < model->sites; r++) {
        const haft_law *law = &e->sites->law[r];
        double w, slope, range = haft_law_range(law);
        if (!(gap[r] <= haft_law_reach(law, e->c->programme.crack_threshold)) || !(range > 0)) {
            continue;
        }
        haft_model_shape(e->model, u, model->site[r].x, &w, &slope);
        double here = fabs(slope) * e->c->mesh.l_meso;
        if (here / range > worst) {
            worst = here / range;
            change = here;
        }
    }
    haft_memory_free(gap);
    haft_findings_add(
        out,
        &(haft_finding){.subject = "patches are shorter than the beam's slope allows",
                        .assumption = true,
                        .verdict = judge(worst, 1, 4),
                        .value = worst,
                        .limit = 1},
        "A patch has one gap, but the beam slopes. At the crack's tip of the beam shown the gap "
        "changes along a patch by %.3g nm, which is %.2g times the distance over which its law "
        "changes; below 1 a shorter patch would change little. The budget's l_meso term measures "
        "it.",
        change * 1e9, worst);
    return HAFT_OK;
}

/* ---- the asperities ---- */

static void find_plasticity(haft_findings *out, const haft_evidence *e) {
    const haft_case *c = e->c;
    const haft_laws *laws = e->laws;
    double nu = c->contact.poisson_ratio, young = c->contact.young_modulus, sum = 0;
    double modulus = haft_contact_modulus(young, nu, young, nu);
    double rough = 0.5 * modulus * sqrt(2 * haft_case_moments(c).m2);
    haft_capillary capillary = {0};
    size_t n = 0;
    haft_physics physics = haft_case_physics(c);
    bool wet = physics.capillary && !physics.vdw && /* else more pulls than the menisci */
               haft_capillary_from_spec(&capillary, &c->contact.capillary, NULL) == HAFT_OK;
    for (size_t k = 0; wet && k < laws->m; k++) {
        if (laws->contact_area[k] > 0 && laws->wet_area[k] > laws->contact_area[k]) {
            sum += -capillary.pressure * (laws->wet_area[k] / laws->contact_area[k] - 1);
            n++;
        }
    }
    double pressure = n > 0 ? sum / (double)n : rough, hardness = c->contact.hardness;
    double share = hardness > 0 ? fmax(pressure, rough) / hardness : NAN;
    char judged[200];
    if (hardness > 0) {
        snprintf(
            judged, sizeof judged,
            "The greater is %.2g times the hardness of %.3g GPa; yield begins near %.1f, so %s.",
            share, hardness * 1e-9, YIELD_SHARE,
            share <= YIELD_SHARE ? "they stay elastic"
                                 : "the highest are flattened for good, and lie closer");
    } else {
        snprintf(
            judged, sizeof judged,
            "The case gives no contact.hardness to hold that against (polycrystalline silicon: "
            "about 11 GPa, gold: about 1 GPa); yield begins near %.1f of it.",
            YIELD_SHARE);
    }
    haft_findings_add(out,
                      &(haft_finding){.subject = "asperities stay elastic",
                                      .assumption = true,
                                      .verdict = hardness > 0 ? judge(share, YIELD_SHARE, 1)
                                                              : HAFT_VERDICT_UNKNOWN,
                                      .value = fmax(pressure, rough),
                                      .limit = hardness > 0 ? YIELD_SHARE * hardness : NAN},
                      "Mean pressure in the asperities' contacts: %.2g GPa %s, %.2g GPa by the "
                      "slopes of the roughness (E* times rms slope / 2). %s",
                      pressure * 1e-9,
                      n > 0 ? "where push and pull of a patch balance" : "estimated", rough * 1e-9,
                      judged);
}

static void find_menisci(haft_findings *out, const haft_evidence *e) {
    const haft_laws *laws = e->laws;
    double wet = 0, most = 0;
    size_t n = 0;
    haft_physics physics = haft_case_physics(e->c);
    if (!physics.capillary) {
        return;
    }
    for (size_t k = 0; k < laws->m; k++) {
        if (isfinite(laws->wet_area[k]) && isfinite(laws->zero_distance[k])) {
            wet += laws->wet_area[k];
            most = fmax(most, laws->wet_area[k]);
            n++;
        }
    }
    double humidity = e->c->contact.capillary.humidity;
    wet = n > 0 ? wet / (double)n : NAN;
    if (n > 0) {
        haft_findings_add(
            out,
            &(haft_finding){.subject = "menisci stay separate",
                            .assumption = true,
                            .verdict = judge(wet, WET_BOUND, 0.9),
                            .value = wet,
                            .limit = WET_BOUND},
            "Where a patch's push and pull balance, water fills %.3g %% of its area (%.3g %% at "
            "most). Beyond about %.0f %% the menisci merge into a film, which takes much time and "
            "water to form, and the pull no longer depends on the roughness as modelled.",
            100 * wet, 100 * most, 100 * WET_BOUND);
    }
    if (physics.vdw) {
        return; /* both are counted */
    }
    haft_findings_add(out,
                      &(haft_finding){.subject = "menisci alone hold the beam",
                                      .assumption = true,
                                      .verdict = humidity >= HAFT_VDW_HUMIDITY
                                                     ? HAFT_VERDICT_HOLDS
                                                     : HAFT_VERDICT_DOUBTFUL,
                                      .value = humidity,
                                      .limit = HAFT_VDW_HUMIDITY},
                      "At %.3g %% relative humidity the pull of the menisci is taken alone; below "
                      "%.0f %% van der Waals forces are no longer small beside it (contact.vdw "
                      "counts them).",
                      100 * humidity, 100 * HAFT_VDW_HUMIDITY);
}

/* ---- the laws ---- */

static void find_curves(haft_findings *out, const haft_evidence *e) {
    size_t count[HAFT_LAW_FAULTS];
    haft_study_count_faults(e->laws, count);
    size_t cut = count[HAFT_LAW_RANGE_LEFT] + count[HAFT_LAW_RANGE_RIGHT];
    size_t unfit = e->laws->m - count[HAFT_LAW_SOUND];
    bool tables = e->c->law.kind == HAFT_LAW_TABLE;
    haft_findings_add(
        out,
        &(haft_finding){
            .subject = "the laws have the assumed form",
            .assumption = true,
            .verdict = cut > 0 ? HAFT_VERDICT_DOUBTFUL
                               : judge(tables ? 0 : (double)unfit / (double)e->laws->m, 0.01, 1),
            .value = (double)unfit,
            .limit = NAN},
        "Of %zu patches' force curves %zu have no Morse law (%zu of them leave the computed range "
        "of %.3g to %.3g nm). %s",
        e->laws->m, unfit, cut, e->c->contact.distance_from * 1e9, e->c->contact.distance_to * 1e9,
        unfit == 0 ? ""
        : tables   ? "All curves are used as they are."
        : e->laws->chaos != NULL
            ? "Those were left out of the stochastic model."
            : "Those are used as they are, the others through their Morse laws.");
}

/* How far the beam is pressed beyond the computed part of its laws. */
static haft_status find_walls(haft_findings *out, const haft_evidence *e, haft_error *error) {
    const haft_model_data *model = haft_model_get(e->model);
    double *gap = haft_memory_alloc(model->sites, sizeof *gap, error);
    if (gap == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    size_t beyond = 0;
    double greatest = 0, ratio = 0;
    for (size_t i = 0; i < e->path->points; i++) {
        haft_model_gaps(e->model, e->path->state + i * model->dofs, gap);
        bool any = false;
        for (size_t r = model->inert; r < model->sites; r++) {
            const haft_law *law = &e->sites->law[r];
            if (gap[r] < law->wall_distance) {
                any = true;
                double push = haft_law_evaluate(law, gap[r]).force;
                greatest = fmax(greatest, push);
                ratio = fmax(ratio, push / haft_law_limit(e->laws->f_limit, law->f_max));
            }
        }
        beyond += any;
    }
    haft_memory_free(gap);
    haft_finding facts = {.subject = "laws are used where they were computed",
                          .assumption = true,
                          .verdict = beyond == 0 ? HAFT_VERDICT_HOLDS : judge(ratio, 0, 10),
                          .value = ratio,
                          .limit = 1};
    if (beyond == 0) {
        haft_findings_add(out, &facts,
                          "In none of the %zu states of the beam shown is a patch pressed harder "
                          "than its law was computed for.",
                          e->path->points);
    } else {
        haft_findings_add(
            out, &facts,
            "In %zu of %zu states of the beam shown some patch is pressed harder than "
            "its law was computed for; there the push goes on along a straight line, "
            "up to %.3g MPa, at most %.2g times the push that its law was fitted to.",
            beyond, e->path->points, greatest * 1e-6, ratio);
    }
    return HAFT_OK;
}

static void find_correlation(haft_findings *out, const haft_evidence *e) {
    bool seamless = e->c->law.sampler == HAFT_SAMPLER_EXPLICIT;
    haft_findings_add(
        out,
        &(haft_finding){
            .subject = "neighbouring patches",
            .assumption = true,
            .verdict = seamless ? HAFT_VERDICT_HOLDS
                                : judge(-e->c->mesh.l_meso / e->correlation, -LENGTHS_A_PATCH, -1),
            .value = e->c->mesh.l_meso / e->correlation,
            .limit = LENGTHS_A_PATCH},
        "%s",
        seamless ? "Patches are cut from one seamless surface: what neighbours have in common is "
                   "kept."
                 : "Patches are taken as independent of their neighbours, although a wave of the "
                   "roughness may reach over their border; a patch of several correlation lengths "
                   "makes that a small error. The budget's spatial correlation term measures it.");
}

haft_status haft_findings_of_model(haft_findings *out, const haft_evidence *e, haft_error *error) {
    find_scales(out, e);
    haft_status status = find_slope(out, e, error);
    find_correlation(out, e);
    find_plasticity(out, e);
    find_menisci(out, e);
    find_curves(out, e);
    return status == HAFT_OK ? find_walls(out, e, error) : status;
}

void haft_findings_add(haft_findings *out, const haft_finding *facts, const char *format, ...) {
    if (out->count < HAFT_FINDINGS_MAX) {
        haft_finding *f = &out->finding[out->count++];
        *f = *facts;
        va_list args;
        va_start(args, format);
        vsnprintf(f->text, sizeof f->text, format, args);
        va_end(args);
    }
}
