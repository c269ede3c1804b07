/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drawing a finished run: its data as CSV by the library, its figures by gnuplot. */
#include "draw.h"

#include "against.h"

#include <errno.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* The plot scripts lie beside an installed program, or in the source it was built from. */
static void find_scripts(char path[PATH_CAPACITY]) {
    char program[PATH_CAPACITY];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = '\0';
    char *slash = strrchr(program, '/');
    if (slash != NULL) {
        *slash = '\0';
        int n = snprintf(path, PATH_CAPACITY, "%s/../share/haft/plot", program);
        if (n > 0 && n < PATH_CAPACITY && access(path, R_OK) == 0) {
            return;
        }
    }
    const char *const places[] = {HAFT_PLOT_DIR_INSTALLED, HAFT_PLOT_DIR_SOURCE};
    snprintf(path, PATH_CAPACITY, "%s", places[access(places[0], R_OK) == 0 ? 0 : 1]);
}

/* Runs gnuplot on one script inside the folder of the figures. */
static haft_status draw(const char *scripts, const char *name, const char *folder,
                        const char *definitions, haft_error *error) {
    char script[PATH_CAPACITY + 64];
    snprintf(script, sizeof script, "%s/%s.gp", scripts, name);
    /* -d: the user's own ~/.gnuplot must not change the figures */
    char *const command[] = {(char[]){"gnuplot"}, (char[]){"-d"}, (char[]){"-e"},
                             strdup(definitions), script,         NULL};
    extern char **environ;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addchdir_np(&actions, folder);
    pid_t child;
    int why = posix_spawnp(&child, "gnuplot", &actions, NULL, command, environ);
    posix_spawn_file_actions_destroy(&actions);
    free(command[3]);
    if (why != 0) {
        return haft_error_set(error, HAFT_ERROR_IO,
                              "gnuplot cannot be run: %s; install it (Debian: gnuplot-nox). The "
                              "data are in %s as CSV",
                              strerror(why), folder);
    }
    int state = 0;
    while (waitpid(child, &state, 0) < 0 && errno == EINTR) {
    }
    if (!WIFEXITED(state) || WEXITSTATUS(state) != 0) {
        return haft_error_set(error, HAFT_ERROR_LIBRARY, "gnuplot failed on %s", script);
    }
    return HAFT_OK;
}

static void set_environment(const char *title, const char *scripts) {
    setenv("HAFT_TITLE", title, 1);
    setenv("GNUPLOT_LIB", scripts, 1); /* where they find style.gp */
    setenv("LC_ALL", "C.UTF-8", 1);    /* the same figures whatever the locale */
}

typedef struct pen {
    const haft_case *c;
    const char *folder;
    char scripts[PATH_CAPACITY], definitions[512];
} pen;

static haft_status draw_each(const pen *p, const char *const *figures, size_t count,
                             haft_error *error) {
    haft_status status = HAFT_OK;
    for (size_t i = 0; status == HAFT_OK && i < count; i++) {
        status = draw(p->scripts, figures[i], p->folder, p->definitions, error);
    }
    return status;
}

static void take_pen(pen *p, const haft_case *c, const char *folder) {
    p->c = c;
    p->folder = folder;
    find_scripts(p->scripts);
    snprintf(p->definitions, sizeof p->definitions,
             "paper=%.9g; measured=%.9g; beam_length=%.9g; gap=%.9g; load_position=%.9g; "
             "confidence=%.9g; order=%zu; germ=%d",
             isfinite(c->reference.paper_crack_length) ? c->reference.paper_crack_length * 1e6 : -1,
             isfinite(c->reference.measured_crack_length) ? c->reference.measured_crack_length * 1e6
                                                          : -1,
             c->beam.length * 1e6, c->beam.gap * 1e6, c->mesh.load_position * 1e6,
             c->stop.confidence, c->law.chaos.spec.order, (int)c->law.chaos.spec.germ);
    set_environment(c->title, p->scripts);
}

static haft_status draw_path(const pen *p, haft_error *error) {
    static const char *const figures[] = {"surface", "laws",     "shapes",     "energy",
                                          "cracks",  "overview", "convergence"};
    size_t count = sizeof figures / sizeof *figures;
    count -= p->c->realizations < 3; /* fewer beams converge to nothing */
    return draw_each(p, figures, count, error);
}

/* How the laws hang together along a seamless surface. */
static haft_status draw_correlation(const pen *p, const haft_laws *laws, haft_error *error) {
    static const char *const figure[] = {"correlation"};
    if (p->c->law.sampler != HAFT_SAMPLER_EXPLICIT || laws->sites < 2 || laws->m <= laws->sites) {
        return HAFT_OK;
    }
    haft_status status = haft_study_write_correlation(p->c, laws, p->folder, error);
    return status == HAFT_OK ? draw_each(p, figure, 1, error) : status;
}

static haft_status draw_model(const pen *p, const haft_laws *laws, haft_error *error) {
    static const char *const figures[] = {"generated", "reduction", "components",
                                          "marginals", "vectors",   "orders"};
    if (laws->chaos == NULL) {
        return HAFT_OK;
    }
    haft_status status = haft_study_write_model_figures(p->c, laws, p->folder, error);
    return status == HAFT_OK ? draw_each(p, figures, sizeof figures / sizeof *figures, error)
                             : status;
}

static haft_status draw_against(const pen *p, const char *reference, haft_error *error) {
    static const char *const figure[] = {"against"};
    char title[HAFT_TEXT_CAPACITY] = "";
    if (reference == NULL) {
        return HAFT_OK;
    }
    haft_status status = write_against(title, reference, p->folder, error);
    setenv("HAFT_REFERENCE", title, 1);
    return status == HAFT_OK ? draw_each(p, figure, 1, error) : status;
}

static haft_status draw_all(const haft_case *c, const haft_laws *laws, const char *folder,
                            const char *reference, haft_error *error) {
    pen p;
    take_pen(&p, c, folder);
    haft_status status = draw_path(&p, error);
    if (status == HAFT_OK) {
        status = draw_correlation(&p, laws, error);
    }
    if (status == HAFT_OK) {
        status = draw_model(&p, laws, error);
    }
    return status == HAFT_OK ? draw_against(&p, reference, error) : status;
}

/* What the swept values are multiplied by on the axis, and the unit they are then in. */
static const char *axis_unit(const char *unit, double greatest, double *factor) {
    bool length = strcmp(unit, "m") == 0, micro = greatest >= 0.9999e-6;
    *factor = !length ? 1 : micro ? 1e6 : 1e9;
    return !length ? (strcmp(unit, "1") == 0 ? "" : unit) : micro ? "µm" : "nm";
}

int draw_sweep(const haft_case *c, double greatest, const char *case_folder, terminal *t) {
    haft_error error = {0};
    char folder[PATH_CAPACITY], scripts[PATH_CAPACITY], definitions[512];
    haft_status status = make_out_folder(case_folder, "plots", &error);
    if (status == HAFT_OK) {
        status = case_out_path(folder, case_folder, "plots", &error);
    }
    if (status == HAFT_OK) {
        double factor;
        const char *unit = axis_unit(c->sweep.unit[0], greatest, &factor);
        find_scripts(scripts);
        snprintf(
            definitions, sizeof definitions,
            "swept='%s'; swept_unit='%s'; swept_factor=%g; keys=%zu; paper=%.9g; "
            "measured=%.9g; confidence=%.9g",
            haft_sweep_leaf(&c->sweep, 0), unit, factor, c->sweep.keys,
            isfinite(c->reference.paper_crack_length) ? c->reference.paper_crack_length * 1e6 : -1,
            isfinite(c->reference.measured_crack_length) ? c->reference.measured_crack_length * 1e6
                                                         : -1,
            c->stop.confidence);
        set_environment(c->title, scripts);
        status = draw(scripts, "sweep", folder, definitions, &error);
    }
    if (status != HAFT_OK) {
        return terminal_fail(t, status, &error);
    }
    if (!t->quiet) {
        printf("figures in %s\n", folder);
    }
    return EXIT_OK;
}

haft_status draw_comparison(const char *labels, size_t n, double confidence, const char *directory,
                            haft_error *error) {
    char scripts[PATH_CAPACITY], definitions[128];
    find_scripts(scripts);
    set_environment("Crack lengths compared", scripts);
    setenv("HAFT_LABELS", labels, 1);
    snprintf(definitions, sizeof definitions, "cases=%zu; confidence=%.9g", n, confidence);
    return draw(scripts, "compare", directory, definitions, error);
}

haft_status choose_realization(const haft_case *c, long asked, size_t *chosen, haft_error *error) {
    *chosen = asked >= 0 ? (size_t)asked : c->evidence.count > 0 ? c->evidence.realization[0] : 0;
    if (*chosen >= c->realizations) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "there is no realization %ld; the case has 0 to %zu", asked,
                              c->realizations - 1);
    }
    return HAFT_OK;
}

haft_status read_matching_laws(haft_laws **laws, char built[HAFT_DIGEST_CAPACITY],
                               const haft_case *c, const char *path, haft_error *error) {
    char wanted[HAFT_DIGEST_CAPACITY];
    haft_status status = haft_laws_read(laws, built, path, error);
    if (status == HAFT_OK) {
        status = haft_laws_identify(wanted, c, (*laws)->origin, error);
    }
    if (status == HAFT_OK && strcmp(built, wanted) != 0) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s was built from other inputs than the case has now; run the "
                                "case again with --force",
                                path);
    }
    return status;
}

int draw_case(const haft_case *c, const char *case_folder, long asked, const char *reference,
              terminal *t) {
    haft_error error = {0};
    char results[PATH_CAPACITY], laws_path[PATH_CAPACITY], folder[PATH_CAPACITY];
    char digest[HAFT_DIGEST_CAPACITY];
    haft_laws *laws = NULL;
    haft_results_view *view = NULL;
    size_t realization = 0;
    haft_status status = choose_realization(c, asked, &realization, &error);
    if (status == HAFT_OK) {
        status = case_out_path(results, case_folder, "results.h5", &error);
    }
    if (status == HAFT_OK) {
        status = case_out_path(laws_path, case_folder, "laws.h5", &error);
    }
    if (status == HAFT_OK) {
        status = case_out_path(folder, case_folder, "plots", &error);
    }
    if (status == HAFT_OK) {
        status = read_matching_laws(&laws, digest, c, laws_path, &error);
    }
    if (status == HAFT_OK) {
        status = read_results(&view, c, results, &error);
        haft_results_view_destroy(&view);
    }
    if (status == HAFT_OK) {
        status = make_out_folder(case_folder, "plots", &error);
    }
    if (status == HAFT_OK) {
        status = haft_study_write_figures(c, laws, results, realization, folder, &error);
    }
    if (status == HAFT_OK) {
        status = draw_all(c, laws, folder, reference, &error);
    }
    haft_laws_destroy(&laws);
    if (status != HAFT_OK) {
        return terminal_fail(t, status, &error);
    }
    if (!t->quiet) {
        printf("figures in %s\n", folder);
    }
    return EXIT_OK;
}
