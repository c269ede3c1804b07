/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The error budget of a mean crack length. Each approximation is refined alone, on the same
 * beams, and then all together. A shift is measured, not extrapolated: if an error is
 * proportional to a step, halving the step shows half of it. Terms whose two sides cannot have
 * the same beams (another source of laws) are differences of independent means, and need many
 * beams. If all terms are paired, so is their interaction: the change of each beam by all
 * refinements together minus the sum of the single changes. */
#include "budget.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A term: the changes on either side, and whether beam k is the same beam on both. */
typedef struct plan {
    const char *name;
    unsigned from, to;
    bool refinement, paired;
    char change[128]; /* what is changed, or why nothing is */
    bool skip;
} plan;

static const char *nano(double length, char text[40]) {
    bool micro = length >= 0.9999e-6;
    snprintf(text, 40, "%.4g %s", length * (micro ? 1e6 : 1e9), micro ? "um" : "nm");
    return text;
}

static void halve(plan *p, double length) {
    char a[40], b[40];
    snprintf(p->change, sizeof p->change, "%s to %s", nano(length, a), nano(0.5 * length, b));
}

static void skip(plan *p, const char *why) {
    p->skip = true;
    snprintf(p->change, sizeof p->change, "%s", why);
}

/* Terms that only some cases have: source of the laws, mesh. */
static void plan_laws(plan *morse, plan *expansion, plan *density, plan *neighbours, plan *patch,
                      const haft_case *c) {
    bool stochastic = haft_sampler_is_stochastic(c->law.sampler);
    bool seamless = c->law.sampler == HAFT_SAMPLER_EXPLICIT;
    unsigned direct = stochastic ? HAFT_CHANGE_PATCHES : 0;
    *morse = (plan){"Morse fit", direct, direct | HAFT_CHANGE_TABLE, true, true, "", false};
    snprintf(morse->change, sizeof morse->change, "Morse laws to the curves themselves");
    if (c->law.kind == HAFT_LAW_TABLE) {
        skip(morse, "none: the curves are used as they are");
    }
    *expansion = (plan){"gPCE", 0, HAFT_CHANGE_EXACT, true, true, "", false};
    snprintf(expansion->change, sizeof expansion->change, "the expansion to the exact map");
    if (c->law.sampler != HAFT_SAMPLER_GPCE) {
        skip(expansion, "none: laws are drawn from no expansion");
    }
    bool reaches = c->law.sampler == HAFT_SAMPLER_GPCE || c->law.sampler == HAFT_SAMPLER_EXACT;
    *density =
        (plan){"law density", reaches ? HAFT_CHANGE_EXACT : 0, HAFT_CHANGE_PATCHES, true, false, "",
               false};
    snprintf(density->change, sizeof density->change, "laws from the model to laws of patches");
    if (!stochastic) {
        skip(density, "none: every law is that of a patch");
    }
    *neighbours =
        (plan){"spatial correlation", direct, HAFT_CHANGE_SEAMLESS, true, false, "", false};
    snprintf(neighbours->change, sizeof neighbours->change,
             "independent patches to one seamless surface");
    if (seamless) {
        skip(neighbours, "none: the surface is seamless");
    }
    unsigned base = seamless ? 0 : HAFT_CHANGE_SEAMLESS;
    *patch = (plan){"l_meso", base, base | HAFT_CHANGE_PATCH, true, true, "", false};
    halve(patch, c->mesh.l_meso);
}

static void plan_beam(plan *mesh, plan *length, plan *steps, const haft_case *c) {
    char a[40];
    *mesh = (plan){"l_e", 0, HAFT_CHANGE_MESH, true, true, "", false};
    if (c->mesh.kind == HAFT_MESH_UNIFORM) {
        snprintf(mesh->change, sizeof mesh->change, "elements of %s to a node at every patch",
                 nano(c->mesh.element_length, a));
    } else {
        snprintf(mesh->change, sizeof mesh->change, "one element before the contact to many");
    }
    if (c->mesh.kind == HAFT_MESH_EXACT) {
        skip(mesh, "none: there is a node at every patch");
    }
    *length = (plan){"beam length", 0, HAFT_CHANGE_LENGTH, true, true, "", false};
    snprintf(length->change, sizeof length->change, "%s to a quarter more",
             nano(c->beam.length, a));
    *steps = (plan){"step tolerance", 0, HAFT_CHANGE_STEPS, true, true, "", false};
    snprintf(steps->change, sizeof steps->change, "steps of %.3g ranges of a law to %.3g",
             c->path.gap_step, 0.5 * c->path.gap_step);
}

enum { TERMS = 10 };

static void make_plans(plan p[TERMS], const haft_case *c) {
    p[0] = (plan){"grid step", 0, HAFT_CHANGE_GRID, true, true, "", false};
    halve(&p[0], c->surface.grid_step);
    p[1] = (plan){"asperity model", 0, HAFT_CHANGE_ASPERITIES, false, true, "", false};
    static const char *const others[] = {
        [HAFT_ASPERITY_SUMMITS] = "summits to islands",
        [HAFT_ASPERITY_ISLANDS] = "islands to summits",
        [HAFT_ASPERITY_FITTED] = "fitted islands to islands",
    };
    snprintf(p[1].change, sizeof p[1].change, "%s", others[c->contact.asperities]);
    plan_laws(&p[2], &p[3], &p[4], &p[5], &p[6], c);
    plan_beam(&p[7], &p[8], &p[9], c);
}

/* ---- measuring ---- */

/* The first line of a message, for a table. */
static void take_reason(haft_budget_term *term, const haft_error *error) {
    const char *text = strstr(error->message, ".yaml:");
    text = text != NULL ? strchr(text, ' ') : error->message;
    text = text != NULL ? text + strspn(text, " ") : error->message;
    snprintf(term->change, sizeof term->change, "not possible: %.*s",
             (int)(sizeof term->change - 16), text);
    term->change[strcspn(term->change, "\n")] = '\0';
}

static haft_status measure(haft_budget_term *term, haft_changed_set *set, const plan *p,
                           haft_error *error) {
    *term = (haft_budget_term){.refinement = p->refinement,
                               .paired = p->paired,
                               .from = NAN,
                               .to = NAN,
                               .shift = NAN,
                               .half_width = NAN,
                               .cost = NAN};
    snprintf(term->name, sizeof term->name, "%s", p->name);
    memcpy(term->change, p->change, sizeof term->change);
    if (p->skip) {
        return HAFT_OK;
    }
    const haft_changed *side[2] = {NULL, NULL};
    haft_error own = {0};
    haft_status status = haft_changed_get(&side[0], set, p->from, &own);
    HAFT_THEN(status, haft_changed_get(&side[1], set, p->to, &own));
    if (status == HAFT_ERROR_INPUT) { /* a refinement that this case cannot have */
        take_reason(term, &own);
        return HAFT_OK;
    }
    haft_difference both;
    HAFT_THEN(status, haft_study_differ(&both, side[0]->c, side[0]->beam, set->beams, side[1]->c,
                                        side[1]->beam, set->beams, &own));
    if (status != HAFT_OK) {
        return haft_error_set(error, status, "%s", own.message);
    }
    haft_statistics s[2];
    for (int i = 0; i < 2; i++) {
        s[i] = haft_study_statistics(side[i]->c, side[i]->beam, set->beams);
    }
    haft_interval bounds = p->paired ? both.pair_interval : both.difference_interval;
    term->measured = true;
    term->beams = p->paired ? both.pairs : s[0].stuck < s[1].stuck ? s[0].stuck : s[1].stuck;
    term->switched = p->paired ? both.switched : 0;
    term->from = s[0].mean;
    term->to = s[1].mean;
    term->shift = p->paired ? both.pair_difference : both.difference;
    term->half_width = 0.5 * (bounds.high - bounds.low);
    term->cost = side[1]->seconds / side[0]->seconds;
    return HAFT_OK;
}

static bool is_stuck(const haft_changed *side, size_t k) {
    return side->beam[k].outcome == HAFT_OUTCOME_STUCK;
}

/* The change by all refinements together minus the sum of the single changes: the mean over the
 * beams that stuck in all variants. */
static haft_status measure_interaction(haft_budget *out, haft_changed_set *set, const plan p[TERMS],
                                       unsigned all, haft_error *error) {
    const haft_changed *side[2 * (TERMS + 1)];
    double sign[2 * (TERMS + 1)], mean = 0, squares = 0;
    size_t sides = 0, n = 0;
    for (size_t i = 0; i <= TERMS; i++) {
        bool together = i == TERMS;
        if (!together && !(out->term[i].measured && p[i].refinement)) {
            continue;
        }
        for (int j = 0; j < 2; j++) {
            unsigned changes = together ? (j == 0 ? 0 : all) : j == 0 ? p[i].from : p[i].to;
            HAFT_TRY(haft_changed_get(&side[sides], set, changes, error));
            sign[sides++] = (j == 1) == together ? 1 : -1;
        }
    }
    for (size_t k = 0; k < set->beams; k++) {
        double value = 0;
        bool stuck = true;
        for (size_t i = 0; i < sides; i++) {
            stuck = stuck && is_stuck(side[i], k);
            value += sign[i] * side[i]->beam[k].crack_length;
        }
        if (stuck) {
            double off = value - mean;
            mean += off / (double)++n;
            squares += off * (value - mean);
        }
    }
    haft_interval bounds =
        haft_study_mean_interval(mean, sqrt(squares / (double)(n - 1)), n, out->confidence);
    out->interaction.measured = n > 0;
    out->interaction.beams = n;
    out->interaction.shift = n > 0 ? mean : NAN;
    out->interaction.half_width = 0.5 * (bounds.high - bounds.low);
    return HAFT_OK;
}

/* All refinements that could be measured, at once. */
static haft_status measure_together(haft_budget *out, haft_changed_set *set, const plan p[TERMS],
                                    haft_error *error) {
    plan all = {"all refinements at once", 0, 0, true, true, "", false};
    for (size_t i = 0; i < TERMS; i++) {
        if (out->term[i].measured && p[i].refinement) {
            all.to |= p[i].to;
        }
    }
    if (all.to & HAFT_CHANGE_SEAMLESS) { /* the last of the sources of laws */
        all.to &= ~(unsigned)(HAFT_CHANGE_PATCHES | HAFT_CHANGE_EXACT);
        all.paired = false;
    } else if (all.to & HAFT_CHANGE_PATCHES) {
        all.to &= ~(unsigned)HAFT_CHANGE_EXACT;
        all.paired = false;
    }
    snprintf(all.change, sizeof all.change, "every refinement above together");
    out->interaction = (haft_budget_term){.name = "interaction",
                                          .change = "not in the sum: what refinements do to each "
                                                    "other",
                                          .refinement = true,
                                          .paired = true,
                                          .from = NAN,
                                          .to = NAN,
                                          .shift = NAN,
                                          .half_width = NAN,
                                          .cost = NAN};
    haft_status status = measure(&out->together, set, &all, error);
    if (status != HAFT_OK || !all.paired || !out->together.measured) {
        snprintf(out->interaction.change, sizeof out->interaction.change,
                 "none: not all terms have the same beams");
        return status;
    }
    return measure_interaction(out, set, p, all.to, error);
}

static void sum_up(haft_budget *out) {
    double squares = 0;
    for (size_t i = 0; i < out->count; i++) {
        const haft_budget_term *t = &out->term[i];
        if (t->measured && isfinite(t->shift)) {
            *(t->refinement ? &out->total : &out->models) += fabs(t->shift);
            squares += t->refinement && isfinite(t->half_width) ? t->half_width * t->half_width : 0;
        }
    }
    out->total_half_width = sqrt(squares);
}

static void tell(const haft_changed_set *set, size_t done) {
    const haft_progress *p = set->progress;
    if (p != NULL && p->advance != NULL) {
        p->advance(p->user, "budget", done, TERMS + 2);
    }
}

haft_status haft_study_budget(haft_budget *out, const haft_case *c, size_t beams,
                              const haft_statistics *headline, const char *directory,
                              const haft_progress *progress, haft_error *error) {
    _Static_assert((int)TERMS <= (int)HAFT_BUDGET_TERMS_MAX, "there is room for all terms");
    *out = (haft_budget){.beams = beams};
    if (beams < 2) {
        return haft_error_set(error, HAFT_ERROR_ARGUMENT, "a budget needs 2 beams at least");
    }
    haft_changed_set set = {.c = c, .beams = beams, .directory = directory, .progress = progress};
    plan p[TERMS];
    make_plans(p, c);
    const haft_changed *base = NULL;
    haft_status status = haft_changed_get(&base, &set, 0, error);
    if (status == HAFT_OK) {
        haft_statistics own = haft_study_statistics(base->c, base->beam, beams);
        const haft_statistics *s = headline != NULL ? headline : &own;
        out->confidence = own.confidence;
        out->mean = own.mean;
        out->sampling = 0.5 * (s->mean_interval.high - s->mean_interval.low);
        out->sampled = s->stuck;
        tell(&set, 1);
    }
    for (size_t i = 0; i < TERMS && status == HAFT_OK; i++) {
        status = measure(&out->term[i], &set, &p[i], error);
        out->count = i + 1;
        tell(&set, i + 2);
    }
    if (status == HAFT_OK) {
        status = measure_together(out, &set, p, error);
        tell(&set, TERMS + 2);
    }
    haft_changed_close(&set);
    sum_up(out);
    return status;
}
