/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs gnuplot on the scripts of tools/plot. Figures are drawn in a folder of their own, checked,
 * and then moved into place, so a figure is either the complete new one or the old one. */
#include "gnuplot.h"

#include <dirent.h>
#include <errno.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* Finds the plot scripts: beside the installed program, or in the source it was built from. */
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

/* ---- checking and moving figures ---- */

/* gnuplot reports no failed writes, as on a full disk, so the files themselves are checked. A
 * complete PNG is its signature and chunks up to IEND; a complete SVG ends with its closing tag. */
static bool is_whole_png(const unsigned char *data, size_t size) {
    size_t at = 8;
    if (size < at || memcmp(data, "\x89PNG\r\n\x1a\n", at) != 0) {
        return false;
    }
    while (size - at >= 12) {
        size_t length = (size_t)data[at] << 24 | (size_t)data[at + 1] << 16 |
                        (size_t)data[at + 2] << 8 | data[at + 3];
        if (length > size - at - 12) {
            return false;
        }
        bool last = memcmp(data + at + 4, "IEND", 4) == 0;
        at += length + 12;
        if (last) {
            return at == size;
        }
    }
    return false;
}

static bool is_whole_svg(const unsigned char *data, size_t size) {
    static const char end[] = "</svg>";
    size_t n = strlen(end);
    while (size > 0 && strchr(" \r\n", data[size - 1]) != NULL) {
        size--;
    }
    return size >= n && memcmp(data + size - n, end, n) == 0 && memchr(data, '\0', size) == NULL;
}

static haft_status check_figure(const char *path, haft_error *error) {
    enum { FIGURE_MOST = 1 << 28 };
    const char *dot = strrchr(path, '.');
    char *data = NULL;
    size_t size = 0;
    haft_status status = haft_file_read(&data, &size, path, FIGURE_MOST, error);
    if (status == HAFT_OK) {
        bool png = strcmp(dot, ".png") == 0;
        const unsigned char *bytes = (const unsigned char *)data;
        if (!(png ? is_whole_png(bytes, size) : is_whole_svg(bytes, size))) {
            status =
                haft_error_set(error, HAFT_ERROR_IO,
                               "%s: gnuplot could not write it whole; is the disk full?", path);
        }
    }
    haft_memory_free(data);
    return status;
}

static int is_figure(const struct dirent *entry) {
    const char *dot = strrchr(entry->d_name, '.');
    return dot != NULL && (strcmp(dot, ".png") == 0 || strcmp(dot, ".svg") == 0);
}

/* What to do with each figure of the draft: check it, move it into place, or remove it. */
typedef enum deed { CHECK, PLACE, REMOVE } deed;

static haft_status treat_figure(deed what, const char *draft, const char *folder, const char *name,
                                haft_error *error) {
    char from[PATH_CAPACITY + 300], to[PATH_CAPACITY + 300];
    HAFT_TRY(haft_path_join(from, sizeof from, draft, name, error));
    HAFT_TRY(haft_path_join(to, sizeof to, folder, name, error));
    if (what == CHECK) {
        return check_figure(from, error);
    }
    if (what == REMOVE) {
        (void)unlink(from);
        return HAFT_OK;
    }
    return rename(from, to) == 0 ? HAFT_OK
                                 : haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be written: %s",
                                                  to, strerror(errno));
}

static haft_status treat_figures(deed what, const char *draft, const char *folder,
                                 haft_error *error) {
    struct dirent **entry = NULL;
    int n = scandir(draft, &entry, is_figure, alphasort);
    haft_status status = HAFT_OK;
    if (n < 0) {
        status =
            haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be read: %s", draft, strerror(errno));
    } else if (n == 0 && what == CHECK) {
        status =
            haft_error_set(error, HAFT_ERROR_IO,
                           "%s: gnuplot ended well but drew no figure; is the disk full?", folder);
    }
    for (int i = 0; i < n; i++) {
        HAFT_THEN(status, treat_figure(what, draft, folder, entry[i]->d_name, error));
        free(entry[i]);
    }
    free(entry);
    return status;
}

/* ---- gnuplot ---- */

static haft_status wait_for(pid_t child, const char *script, haft_error *error) {
    int state = 0;
    while (waitpid(child, &state, 0) < 0 && errno == EINTR) {
    }
    if (!WIFEXITED(state) || WEXITSTATUS(state) != 0) {
        return haft_error_set(error, HAFT_ERROR_LIBRARY, "gnuplot failed on %s", script);
    }
    return HAFT_OK;
}

/* Runs gnuplot on one script in the folder of the figures. */
static haft_status run(const char *script, const char *folder, char *definitions,
                       haft_error *error) {
    char path[PATH_CAPACITY + 64];
    snprintf(path, sizeof path, "%s", script);
    /* -d: the user's own ~/.gnuplot must not change the figures */
    char *const command[] = {(char[]){"gnuplot"}, (char[]){"-d"}, (char[]){"-e"},
                             definitions,         path,           NULL};
    extern char **environ;
    posix_spawn_file_actions_t actions;
    pid_t child = 0;
    int why = posix_spawn_file_actions_init(&actions);
    if (why == 0) {
        why = posix_spawn_file_actions_addchdir_np(&actions, folder);
        why = why != 0 ? why : posix_spawnp(&child, "gnuplot", &actions, NULL, command, environ);
        posix_spawn_file_actions_destroy(&actions);
    }
    if (why == ENOMEM) {
        return haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for gnuplot");
    }
    if (why != 0) {
        return haft_error_set(error, HAFT_ERROR_IO,
                              "gnuplot cannot be run: %s; install it (Debian: gnuplot-nox). The "
                              "data are in %s as CSV",
                              strerror(why), folder);
    }
    return wait_for(child, script, error);
}

/* Draws into the folder `draft` inside `folder`, and moves complete figures out of it. */
static haft_status draw(const char *script, const char *folder, const char *draft,
                        const char *definitions, haft_error *error) {
    const char *leaf = draft + strlen(folder) + 1;
    size_t capacity = strlen(definitions) + strlen(leaf) + 32;
    char *all = haft_memory_alloc(capacity, 1, error);
    if (all == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    snprintf(all, capacity, "draft='%s/'; %s", leaf, definitions);
    if (mkdir(draft, 0777) != 0 && errno != EEXIST) {
        haft_memory_free(all);
        return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be made: %s", draft,
                              strerror(errno));
    }
    haft_status status = run(script, folder, all, error);
    HAFT_THEN(status, treat_figures(CHECK, draft, folder, error));
    HAFT_THEN(status, treat_figures(PLACE, draft, folder, error));
    if (status != HAFT_OK) {
        (void)treat_figures(REMOVE, draft, folder, NULL);
    }
    rmdir(draft);
    haft_memory_free(all);
    return status;
}

haft_status give_text(const char *variable, const char *text, haft_error *error) {
    char safe[HAFT_SPELLED_CAPACITY * HAFT_TEXT_CAPACITY];
    (void)haft_text_quote(safe, sizeof safe, text, strlen(text));
    return setenv(variable, safe, 1) == 0
               ? HAFT_OK
               : haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for gnuplot");
}

static haft_status set_environment(const char *title, const char *scripts, haft_error *error) {
    bool good = setenv("GNUPLOT_LIB", scripts, 1) == 0 && /* where scripts find style.gp */
                setenv("LC_ALL", "C.UTF-8", 1) == 0;      /* same figures in any locale */
    return good ? give_text("HAFT_TITLE", title, error)
                : haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for gnuplot");
}

haft_status draw_script(const char *name, const char *folder, const char *title,
                        const char *definitions, haft_error *error) {
    char scripts[PATH_CAPACITY], script[PATH_CAPACITY + 64], place[PATH_CAPACITY + 16];
    char draft[PATH_CAPACITY + 48];
    find_scripts(scripts);
    snprintf(script, sizeof script, "%s/%s.gp", scripts, name);
    snprintf(place, sizeof place, "%s/figures", folder);
    snprintf(draft, sizeof draft, "%s.tmp.%ld", place, (long)getpid());
    haft_io_drop_stale(place);
    haft_status status = set_environment(title, scripts, error);
    return status == HAFT_OK ? draw(script, folder, draft, definitions, error) : status;
}
