/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Running gnuplot on the scripts of tools/plot. */
#include "gnuplot.h"

#include <errno.h>
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

void give_text(const char *variable, const char *text) {
    char safe[HAFT_SPELLED_CAPACITY * HAFT_TEXT_CAPACITY];
    (void)haft_text_quote(safe, sizeof safe, text, strlen(text));
    setenv(variable, safe, 1);
}

static void set_environment(const char *title, const char *scripts) {
    give_text("HAFT_TITLE", title);
    setenv("GNUPLOT_LIB", scripts, 1); /* where they find style.gp */
    setenv("LC_ALL", "C.UTF-8", 1);    /* the same figures whatever the locale */
}

haft_status draw_script(const char *name, const char *folder, const char *title,
                        const char *definitions, haft_error *error) {
    char scripts[PATH_CAPACITY];
    find_scripts(scripts);
    set_environment(title, scripts);
    return draw(scripts, name, folder, definitions, error);
}
