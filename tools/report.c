/* SPDX-License-Identifier: GPL-3.0-or-later */
/* haft report: reports a finished run to a reader who does not know the method. */
#include "report.h"

#include "draw.h"
#include "page.h"

#include "haft/study_report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* All data of the page. */
typedef struct source {
    const haft_case *c;
    const char *folder;
    haft_laws *laws;
    haft_results_view *view;
    haft_statistics statistics;
    haft_findings findings;
    haft_budget budget;
    bool has_budget, drawn;
    const char *no_budget; /* why there is no budget */
    size_t realization;
    char laws_digest[HAFT_DIGEST_CAPACITY], results[PATH_CAPACITY];
} source;

/* ---- question and answer ---- */

static void write_question(page *p, const source *s) {
    const haft_case *c = s->c;
    page_element(p, "h2", NULL, "What was asked");
    page_markup(p, "<p>");
    page_text(p,
              "A cantilever beam, clamped %.4g µm above its substrate, is %.4g µm thick, %.4g µm "
              "wide and %.4g µm long as modelled. It is pressed down %.4g µm from its clamp until "
              "its free part is only %.4g µm long, and let go. How much of it stays stuck, and how "
              "much does that differ from beam to beam?",
              c->beam.gap * 1e6, c->beam.thickness * 1e6, c->beam.width * 1e6, c->beam.length * 1e6,
              c->mesh.load_position * 1e6, c->programme.crack_length * 1e6);
    page_markup(p, "</p>\n<p>");
    haft_physics physics = haft_case_physics(c);
    page_text(p, "The surfaces are rough (%.3g nm rms). ", sqrt(haft_case_moments(c).m0) * 1e9);
    if (physics.capillary) {
        page_text(p,
                  "At %.4g %% relative humidity water condenses between their highest points and "
                  "pulls them together. ",
                  100 * c->contact.capillary.humidity);
    }
    if (physics.vdw) {
        page_text(p, "Van der Waals forces between them %s. ",
                  physics.capillary ? "pull too" : "pull them together");
    }
    page_text(p,
              "As no two surfaces are the same, %zu beams were followed, each over surfaces of its "
              "own; what differs between them is the roughness alone.",
              s->statistics.run);
    page_markup(p, "</p>\n<p class=\"soft\">");
    page_text(
        p, "Words: the crack length is the free length between the clamp and the point where "
           "the beam lies on its substrate (the shorter it is, the stronger the beam sticks); the "
           "effective energy Γ is the adhesion energy of smooth surfaces that "
           "would hold the beam at that length; a beam is free if it touches nowhere once "
           "the load is gone.");
    page_markup(p, "</p>\n");
}

static void write_card(page *p, const char *label, const char *value, const char *range) {
    page_markup(p, "<div class=\"card\">");
    page_element(p, "span", NULL, "%s", label);
    page_element(p, "b", NULL, "%s", value);
    page_element(p, "span", "soft", "%s", range);
    page_markup(p, "</div>\n");
}

static void write_headline(page *p, const source *s) {
    const haft_statistics *t = &s->statistics;
    const haft_beam_spec *beam = &s->c->beam;
    char value[64], range[128];
    double confidence = 100 * t->confidence;
    page_element(p, "h2", NULL, "The answer");
    page_markup(p, "<div class=\"cards\">\n");
    if (t->stuck > 0) {
        bool known = t->stuck > 1;
        snprintf(value, sizeof value, "%.1f µm", t->mean * 1e6);
        snprintf(range, sizeof range,
                 known ? "%.4g %% interval %.1f to %.1f µm" : "one beam: no interval", confidence,
                 t->mean_interval.low * 1e6, t->mean_interval.high * 1e6);
        write_card(p, "Mean crack length", value, range);
        snprintf(value, sizeof value, "%.3g mJ/m²", t->gamma * 1e3);
        snprintf(range, sizeof range,
                 known ? "%.4g %% interval %.3g to %.3g mJ/m²" : "one beam: no interval",
                 confidence, haft_beam_effective_energy(beam, t->mean_interval.high) * 1e3,
                 haft_beam_effective_energy(beam, t->mean_interval.low) * 1e3);
        write_card(p, "Effective energy Γ of the mean", value, range);
    } else {
        write_card(p, "Mean crack length", "none", "no beam stuck");
    }
    if (t->stuck + t->free > 0) {
        snprintf(value, sizeof value, "%.4g %%", 100 * t->stuck_share);
        snprintf(range, sizeof range, "%.4g %% interval %.3g to %.3g %%; %zu of %zu beams",
                 confidence, 100 * t->stuck_interval.low, 100 * t->stuck_interval.high, t->stuck,
                 t->stuck + t->free);
        write_card(p, "Probability to stay stuck", value, range);
    }
    page_markup(p, "</div>\n");
    if (t->stuck > 1) {
        page_element(p, "p", NULL,
                     "From beam to beam the crack length scatters by %.2g µm (standard deviation), "
                     "from %.1f to %.1f µm. An interval says how well these beams tell the mean of "
                     "all beams; it holds no error of the model, for which see the budget.",
                     t->deviation * 1e6, t->least * 1e6, t->greatest * 1e6);
    }
}

/* ---- findings ---- */

static void write_finding(page *p, const haft_finding *f) {
    static const char *const kind[] = {"check holds", "check untold", "check doubtful",
                                       "check broken"};
    static const char *const word[] = {"holds", "cannot be told", "doubtful", "broken"};
    page_markup(p, "<div class=\"");
    page_markup(p, kind[f->verdict]);
    page_markup(p, "\"><strong>");
    page_text(p, "%c%s: ", f->subject[0] - 'a' + 'A', f->subject + 1);
    page_element(p, "em", NULL, "%s", word[f->verdict]);
    page_markup(p, "</strong>");
    page_text(p, "%s", f->text);
    page_markup(p, "</div>\n");
}

static void write_findings(page *p, const source *s) {
    size_t open = 0;
    for (size_t i = 0; i < s->findings.count; i++) {
        open += s->findings.finding[i].verdict != HAFT_VERDICT_HOLDS;
    }
    page_element(p, "h2", NULL, "Warnings");
    if (open == 0) {
        page_element(p, "p", NULL, "None: all that is checked below holds.");
    }
    for (size_t i = 0; i < s->findings.count; i++) {
        if (s->findings.finding[i].verdict != HAFT_VERDICT_HOLDS) {
            write_finding(p, &s->findings.finding[i]);
        }
    }
    for (int assumption = 0; assumption < 2; assumption++) {
        page_element(p, "h2", NULL,
                     assumption ? "Assumptions that hold" : "Checks of the computation that hold");
        for (size_t i = 0; i < s->findings.count; i++) {
            const haft_finding *f = &s->findings.finding[i];
            if (f->verdict == HAFT_VERDICT_HOLDS && f->assumption == assumption) {
                write_finding(p, f);
            }
        }
    }
}

/* ---- numbers ---- */

static void write_cell_um(page *p, double value) {
    if (isfinite(value)) {
        page_element(p, "td", NULL, "%.1f", value * 1e6);
    } else {
        page_element(p, "td", NULL, "-");
    }
}

static void write_row(page *p, const char *label, double value, const haft_interval *interval) {
    page_markup(p, "<tr>");
    page_element(p, "td", "say", "%s", label);
    write_cell_um(p, value);
    write_cell_um(p, interval != NULL ? interval->low : NAN);
    write_cell_um(p, interval != NULL ? interval->high : NAN);
    page_markup(p, "</tr>\n");
}

static void write_numbers(page *p, const source *s) {
    const haft_statistics *t = &s->statistics;
    static const char *const quantile[HAFT_STUDY_QUANTILES] = {"5 % quantile", "median",
                                                               "95 % quantile"};
    page_element(p, "h2", NULL, "The numbers");
    page_markup(
        p, "<div class=\"wide\"><table>\n<thead><tr><th class=\"say\">crack length at rest</th>"
           "<th>[µm]</th>");
    page_element(p, "th", NULL, "%.4g %% from", 100 * t->confidence);
    page_markup(p, "<th>to</th></tr></thead>\n");
    write_row(p, "mean", t->mean, &t->mean_interval);
    write_row(p, "standard deviation", t->deviation, &t->deviation_interval);
    for (size_t i = 0; i < HAFT_STUDY_QUANTILES; i++) {
        write_row(p, quantile[i], t->quantile[i], &t->quantile_interval[i]);
    }
    write_row(p, "least", t->least, NULL);
    write_row(p, "greatest", t->greatest, NULL);
    if (isfinite(s->c->reference.paper_crack_length)) {
        write_row(p, "published computation (of the case)", s->c->reference.paper_crack_length,
                  NULL);
    }
    if (isfinite(s->c->reference.measured_crack_length)) {
        write_row(p, "measured (of the case)", s->c->reference.measured_crack_length, NULL);
    }
    page_markup(p, "</table></div>\n");
    page_element(
        p, "p", "soft",
        "A \"-\" is a bound that so few beams cannot give. Intervals: mean by Student's t, "
        "deviation by chi-square, quantiles by order statistics, probability by Clopper "
        "and Pearson.");
}

/* ---- the budget ---- */

static void write_term(page *p, const haft_budget_term *t, const char *row) {
    page_markup(p, row);
    page_element(p, "td", NULL, "%s", t->name);
    if (t->measured) {
        page_element(p, "td", NULL, "%+.2f", t->shift * 1e6);
        page_element(p, "td", NULL, "%.2f", t->half_width * 1e6);
        page_element(p, "td", NULL, "%zu", t->beams);
        if (isfinite(t->cost)) {
            page_element(p, "td", NULL, "%.2f", t->cost);
        } else {
            page_markup(p, "<td></td>");
        }
    } else {
        page_markup(p, "<td>-</td><td>-</td><td>-</td><td>-</td>");
    }
    page_element(p, "td", "say", "%s%s%s", t->change,
                 t->measured && !t->paired ? " (independent beams)" : "",
                 t->measured && !t->refinement ? " (another model)" : "");
    page_markup(p, "</tr>\n");
}

static void write_budget(page *p, const source *s) {
    const haft_budget *b = &s->budget;
    page_element(p, "h2", NULL, "Error budget");
    if (!s->has_budget) {
        page_element(p, "p", NULL, "%s", s->no_budget);
        return;
    }
    page_element(p, "p", NULL,
                 "What each approximation contributes to the mean crack length: it is refined "
                 "alone, on the same %zu beams, and the mean change is the term. Where an error "
                 "falls in proportion to a step, as much again is left after halving it.",
                 b->beams);
    page_markup(p, "<div class=\"wide\"><table>\n<thead><tr><th>term</th><th>shift [µm]</th>"
                   "<th>± [µm]</th><th>beams</th><th>cost, times</th><th class=\"say\">changed"
                   "</th></tr></thead>\n");
    for (size_t i = 0; i < b->count; i++) {
        write_term(p, &b->term[i], "<tr>");
    }
    page_markup(p, "<tr>");
    page_element(p, "td", NULL, "sample count");
    page_element(p, "td", NULL, "0");
    page_element(p, "td", NULL, "%.2f", b->sampling * 1e6);
    page_element(p, "td", NULL, "%zu", b->sampled);
    page_element(p, "td", NULL, "4.00");
    page_element(p, "td", "say", "four times as many beams halve it");
    page_markup(p, "</tr>\n<tr class=\"sum\"><td>sum of refinements</td>");
    page_element(p, "td", NULL, "%.2f", b->total * 1e6);
    page_element(p, "td", NULL, "%.2f", b->total_half_width * 1e6);
    page_markup(p, "<td></td><td></td>");
    page_element(p, "td", "say", "sizes added, other models left out");
    page_markup(p, "</tr>\n");
    write_term(p, &b->together, "<tr class=\"sum\">");
    write_term(p, &b->interaction, "<tr>");
    page_markup(p, "</table></div>\n");
    page_element(p, "p", "soft",
                 "± is the half width of a %.4g %% interval of the shift; a shift smaller than it "
                 "is not told from zero. Cost: time of a beam, its laws included, with the change "
                 "over that without.",
                 100 * b->confidence);
}

/* ---- figures, cost, provenance ---- */

static void write_figures(page *p, const source *s) {
    enum { ALWAYS, MANY, SEAMLESS, MODEL }; /* when the figure is drawn */
    static const struct {
        const char *file, *caption;
        int when;
    } figures[] = {
        {"cracks.svg", "Crack lengths of all beams at rest.", ALWAYS},
        {"convergence.svg",
         "Mean and standard deviation over the first beams, with intervals: level curves mean "
         "enough beams.",
         MANY},
        {"shapes.svg", "The beam shown, pressed down and let go: its shapes, heights stretched.",
         ALWAYS},
        {"energy.svg",
         "Its strain energy against its crack length; jumps are sudden changes at constant load, "
         "each of which loses energy.",
         ALWAYS},
        {"laws.svg",
         "Force laws of some patches: pressure against the distance of the mean planes; below zero "
         "the surfaces pull.",
         ALWAYS},
        {"surface.png", "A piece of the rough surface.", ALWAYS},
        {"psd.svg",
         "How rough it is at each wave number: the PSD asked for, and that of a piece of surface.",
         ALWAYS},
        {"correlation.svg", "What the laws of patches at a distance have in common.", SEAMLESS},
        {"marginals.svg",
         "The numbers of the laws: those drawn from the model against those of the "
         "patches.",
         MODEL},
        {"vectors.svg", "How the model settles with the number of patches it is built from.",
         MODEL},
        {"orders.svg", "The error of the model's expansion against its order.", MODEL},
    };
    const bool has[] = {true, s->c->realizations >= 3, s->c->law.sampler == HAFT_SAMPLER_EXPLICIT,
                        s->laws->chaos != NULL};
    page_element(p, "h2", NULL, "Figures");
    if (!s->drawn) {
        page_element(p, "p", NULL,
                     "They could not be drawn: gnuplot is needed (Debian: gnuplot-nox).");
        return;
    }
    page_element(p, "p", "soft", "The beam shown is number %zu, counted from 0.", s->realization);
    for (size_t i = 0; i < sizeof figures / sizeof *figures; i++) {
        char path[PATH_CAPACITY], name[64];
        snprintf(name, sizeof name, "plots/%s", figures[i].file);
        if (has[figures[i].when] && case_out_path(path, s->folder, name, NULL) == HAFT_OK) {
            page_figure(p, path, figures[i].caption);
        }
    }
}

static void write_fact(page *p, const char *name, const char *value) {
    page_markup(p, "<tr>");
    page_element(p, "td", NULL, "%s", name);
    page_element(p, "td", "say", "%s", value);
    page_markup(p, "</tr>\n");
}

static void write_provenance(page *p, const source *s) {
    const haft_statistics *t = &s->statistics;
    char text[200], digest[HAFT_DIGEST_CAPACITY];
    page_element(p, "h2", NULL, "Cost");
    page_element(p, "p", NULL,
                 "%.3g s a beam once its laws are there, %.3g s for all %zu on one thread; %.3g "
                 "jumps a beam.",
                 t->seconds, t->seconds * (double)t->run, t->run, t->jumps);
    page_element(p, "h2", NULL, "Where it comes from");
    page_markup(p, "<table class=\"facts\">\n");
    write_fact(p, "case", s->c->name);
    snprintf(text, sizeof text, "%llu", (unsigned long long)s->c->seed);
    write_fact(p, "seed", text);
    snprintf(text, sizeof text, "Haft %s%s%s", haft_version(),
             haft_revision()[0] ? ", revision " : "", haft_revision());
    write_fact(p, "page written by", text);
    write_fact(p, "inputs of the laws (digest)", s->laws_digest);
    haft_digest_memory(s->view->resolved_case, strlen(s->view->resolved_case), digest);
    write_fact(p, "resolved case (digest)", digest);
    page_markup(p, "</table>\n");
    page_element(p, "p", "soft",
                 "The same case and seed give the same numbers to the bit. results.h5 beside this "
                 "page names the build that made them.");
    page_element(p, "h2", NULL, "The resolved case");
    page_element(p, "p", NULL,
                 "All inputs, defaults filled in, in SI units; saved as case.yaml it "
                 "reruns to the same bits.");
    page_element(p, "pre", NULL, "%s", s->view->resolved_case);
}

/* ---- page ---- */

static haft_status read_source(source *s, long asked, haft_error *error) {
    char path[PATH_CAPACITY];
    HAFT_TRY(choose_realization(s->c, asked, &s->realization, error));
    HAFT_TRY(case_out_path(s->results, s->folder, "results.h5", error));
    HAFT_TRY(read_own_results(&s->view, s->c, s->results, error));
    HAFT_TRY(case_out_path(path, s->folder, "laws.h5", error));
    HAFT_TRY(read_matching_laws(&s->laws, s->laws_digest, s->c, path, error));
    s->statistics = haft_study_statistics(s->c, s->view->summary, s->view->realizations);
    return haft_study_find(&s->findings, s->c, s->laws, s->results, s->view->summary,
                           s->realization, error);
}

/* Reads the budget, or sets the reason why there is none. */
static haft_status read_budget(source *s, haft_error *error) {
    char path[PATH_CAPACITY];
    haft_error own = {0};
    HAFT_TRY(case_out_path(path, s->folder, "budget.csv", error));
    haft_status status = haft_study_read_budget(&s->budget, s->c, path, &own);
    s->has_budget = status == HAFT_OK;
    s->no_budget = status == HAFT_ERROR_INPUT
                       ? "There is one, but of another case, or damaged: measure it anew with "
                         "`haft budget`, then report again."
                       : "Not measured yet: `haft budget` measures it, then report again.";
    return HAFT_OK;
}

static haft_status write_page(const source *s, const char *path, haft_error *error) {
    page p;
    HAFT_TRY(page_open(&p, s->c->title[0] != '\0' ? s->c->title : s->c->name, error));
    write_question(&p, s);
    write_headline(&p, s);
    write_findings(&p, s);
    write_figures(&p, s);
    write_budget(&p, s);
    write_numbers(&p, s);
    write_provenance(&p, s);
    return page_store(&p, path, error);
}

int report_case(const haft_case *c, const char *folder, long asked, terminal *t) {
    haft_error error = {0};
    source s = {.c = c, .folder = folder};
    char path[PATH_CAPACITY];
    haft_status status = read_source(&s, asked, &error);
    HAFT_THEN(status, read_budget(&s, &error));
    HAFT_THEN(status, case_out_path(path, folder, "report.html", &error));
    if (status == HAFT_OK) {
        terminal silent = *t;
        silent.quiet = true;
        s.drawn = draw_case(c, folder, asked, NULL, &silent) == EXIT_OK; /* else it prints why */
        status = write_page(&s, path, &error);
    }
    haft_laws_destroy(&s.laws);
    haft_results_view_destroy(&s.view);
    if (status != HAFT_OK) {
        return terminal_fail(t, status, &error);
    }
    if (!t->quiet) {
        terminal_print(stdout, "report in %s", path);
    }
    return EXIT_OK;
}
