/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the text of the case that haft init makes, and its folder. Before that, the case is
 * written to an unnamed temporary file and read back. A folder that cannot be completed is removed
 * again. */
#include "init.h"
#include "inspect_print.h"

#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { COPY_CAPACITY = 300 };

/* ---- names ---- */

/* The name of a map's copy: the map's own name. It gets a number if two maps have the same name, or
 * if the name has a meaning in a case folder. */
static void name_copy(char name[COPY_CAPACITY], const init_words *w, size_t k) {
    const char *path = k < w->maps ? w->map[k] : w->opposite_map[k - w->maps];
    const char *slash = strrchr(path, '/'), *base = slash != NULL ? slash + 1 : path;
    bool taken = strcmp(base, "case.yaml") == 0 || strcmp(base, "out") == 0;
    for (size_t other = 0; other < k && !taken; other++) {
        const char *before = other < w->maps ? w->map[other] : w->opposite_map[other - w->maps];
        const char *cut = strrchr(before, '/');
        taken = strcmp(base, cut != NULL ? cut + 1 : before) == 0;
    }
    char number[32] = "";
    if (taken) {
        snprintf(number, sizeof number, "map%zu-", k + 1);
    }
    snprintf(name, COPY_CAPACITY, "%s%.255s", number, base);
}

/* The name of the case: that of the folder, with '-' for each character that a name cannot have. */
static void name_case(char name[HAFT_NAME_CAPACITY], const char *folder) {
    char *whole = realpath(folder, NULL);
    const char *path = whole != NULL ? whole : folder;
    size_t end = strlen(path), n = 0;
    while (end > 0 && path[end - 1] == '/') {
        end--;
    }
    size_t start = end;
    while (start > 0 && path[start - 1] != '/') {
        start--;
    }
    for (size_t i = start; i < end && n + 1 < HAFT_NAME_CAPACITY; i++) {
        bool plain = isalnum((unsigned char)path[i]) || strchr("._-", path[i]) != NULL;
        name[n++] = plain ? path[i] : '-';
    }
    name[n] = '\0';
    if (n == 0) {
        snprintf(name, HAFT_NAME_CAPACITY, "case");
    }
    free(whole);
}

/* ---- text ---- */

/* Makes the paths to write: absolute ones, or those of the copies. Free them with free_paths(). */
static haft_status make_paths(char **path, const init_words *w, bool absolute, haft_error *error) {
    for (size_t k = 0; k < w->maps + w->opposite_maps; k++) {
        const char *given = k < w->maps ? w->map[k] : w->opposite_map[k - w->maps];
        path[k] = absolute ? realpath(given, NULL) : malloc(COPY_CAPACITY);
        if (path[k] == NULL) {
            return errno == ENOMEM || !absolute
                       ? haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for a path")
                       : haft_error_set(error, HAFT_ERROR_IO, "%s: %s", given, strerror(errno));
        }
        if (!absolute) {
            name_copy(path[k], w, k);
        }
    }
    return HAFT_OK;
}

static void free_paths(char **path, const init_words *w) {
    for (size_t k = 0; k < w->maps + w->opposite_maps; k++) {
        free(path[k]);
    }
}

/* Writes "  key: value          # comment". */
static void write_line(FILE *stream, const char *comment, const char *format, ...)
    HAFT_PRINTF(3, 4);

static void write_line(FILE *stream, const char *comment, const char *format, ...) {
    char text[200];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    fprintf(stream, comment[0] != '\0' ? "%-*s # %s\n" : "%*s\n", comment[0] != '\0' ? 30 : 0, text,
            comment);
}

static haft_status write_maps(FILE *stream, const init_plan *p, bool absolute, haft_error *error) {
    const init_words *w = p->words;
    char *path[2 * HAFT_FILES_MAX] = {NULL};
    haft_status status = make_paths(path, w, absolute, error);
    surface_block b = {.files = w->maps,
                       .opposite_files = w->opposite_maps,
                       .file = (const char *const *)path,
                       .opposite = (const char *const *)path + w->maps,
                       .wishes = &p->wishes,
                       .channel = w->read.channel != NULL ? w->read.channel : "",
                       .grid_step = p->grid_step,
                       .kernel_tolerance = p->kernel_tolerance};
    HAFT_THEN(status, inspect_print_block(stream, &b, error));
    free_paths(path, w);
    write_line(stream, "heights as normal; heights: as the map's", "  marginal: gaussian");
    return status;
}

static void write_roughness(FILE *stream, const init_plan *p) {
    const haft_roughness *r = &p->roughness;
    write_line(stream, "", "surface:");
    write_line(stream, "", "  rms: %.12g nm", r->rms * 1e9);
    write_line(stream, "the autocorrelation falls to 1/e", "  correlation_length: %.12g nm",
               r->correlation_length * 1e9);
    write_line(stream, "", "  hurst: %.12g", r->hurst);
    write_line(stream, "shortest wave", "  zeta_max: %.12g rad/um", r->zeta_max * 1e-6);
    write_line(stream, "", "  grid_step: %.10g nm", p->grid_step * 1e9);
    if (p->kernel_tolerance > 0) {
        write_line(stream, "", "  kernel_tolerance: %.6g", p->kernel_tolerance);
    }
}

static void write_contact(FILE *stream, const init_plan *p) {
    write_line(stream, "", "\ncontact:");
    write_line(stream, "islands, fitted_islands or summits", "  asperities: islands");
    write_line(stream, "polycrystalline silicon", "  young_modulus: 163 GPa");
    write_line(stream, "", "  poisson_ratio: 0.22");
    write_line(stream, "van der Waals below 55 % humidity, menisci above 0 %", "  forces: auto");
    write_line(stream, "Hamaker constants of silicon through air and water", "  vdw: {}");
    write_line(stream, "", "  capillary:");
    write_line(stream, "", "    humidity: %.10g %%", p->humidity * 100);
    write_line(stream, "", "    contact_angles: [0 deg, 0 deg]");
    write_line(stream, "where trial patches push and pull",
               "  distance: {from: %.10g nm, to: %.10g nm, step: %.10g nm}", p->from * 1e9,
               p->to * 1e9, p->step * 1e9);
    write_line(stream, "", "\nlaw:");
    write_line(stream, "each patch's own curve", "  kind: table");
    write_line(stream, "", "  f_limit_share: 100 %%");
    write_line(stream, "beams draw from so many patches", "  sampler: bootstrap");
    write_line(stream, "", "  chaos: {vectors: %zu}", p->vectors);
}

static void write_beam(FILE *stream, const init_plan *p) {
    write_line(stream, "clamped at one end; the whole of it", "\nbeam:");
    write_line(stream, "", "  length: %.10g um", p->length * 1e6);
    write_line(stream, "", "  width: %.10g um", p->width * 1e6);
    write_line(stream, "", "  thickness: %.10g um", p->thickness * 1e6);
    write_line(stream, "", "  gap: %.10g um", p->gap * 1e6);
    write_line(stream, "", "  young_modulus: 163 GPa");
    write_line(stream, "a patch's length along the beam", "  l_meso: %.15g um", p->l_meso * 1e6);
    write_line(stream, "", "  mesh: active");
    write_line(stream, "pressed down, then let go", "\nload:");
    write_line(stream, "", "  position: %.10g um", p->position * 1e6);
    write_line(stream, "load until the crack is this short", "  crack_length: %.10g um",
               p->crack_length * 1e6);
    write_line(stream, "", "\nstudy:");
    write_line(stream, "beams", "  realizations: %zu", p->beams);
}

haft_status init_write_case(FILE *stream, const init_plan *p, bool absolute, haft_error *error) {
    char name[HAFT_NAME_CAPACITY];
    haft_status status = HAFT_OK;
    name_case(name, p->folder);
    fprintf(stream,
            "# Made by haft init; what was not given is assumed. Change it as you like.\n"
            "name: \"%s\"\ntitle: A beam over a surface of %.3g nm rms, RH %.4g %%\nseed: 1\n\n",
            name, p->rms * 1e9, p->humidity * 100);
    if (p->roughness.rms > 0) {
        write_roughness(stream, p);
    } else {
        status = write_maps(stream, p, absolute, error);
    }
    write_contact(stream, p);
    write_beam(stream, p);
    return status;
}

/* Makes the text in memory. Free it with free(). */
static haft_status make_text(char **text, size_t *size, const init_plan *p, bool absolute,
                             haft_error *error) {
    *text = NULL;
    FILE *stream = open_memstream(text, size);
    if (stream == NULL) {
        return haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for a case's text");
    }
    haft_status status = init_write_case(stream, p, absolute, error);
    if (fclose(stream) != 0 || *text == NULL) {
        status = haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for a case's text");
    }
    if (status != HAFT_OK) {
        free(*text);
        *text = NULL;
    }
    return status;
}

/* Replaces the name of the temporary file in a message by what the message is about. */
static haft_status tell_refusal(haft_status status, const haft_error *own, const char *path,
                                haft_error *error) {
    const char *text = own->message;
    if (strncmp(text, path, strlen(path)) == 0) {
        text += strlen(path);
        text += strspn(text, ":0123456789 ");
    }
    return haft_error_set(error, status, "no case can be made of this: %s", text);
}

haft_status init_try(haft_case **c, const init_plan *p, haft_error *error) {
    char *text = NULL, path[64];
    size_t size = 0;
    haft_error own = {0};
    *c = NULL;
    haft_status status = make_text(&text, &size, p, true, error);
    if (status != HAFT_OK) {
        return status;
    }
    FILE *file = tmpfile();
    bool written = file != NULL && fwrite(text, 1, size, file) == size && fflush(file) == 0;
    if (written) {
        snprintf(path, sizeof path, "/proc/self/fd/%d", fileno(file));
        status = haft_case_read(c, path, &own);
        status = status == HAFT_OK ? HAFT_OK : tell_refusal(status, &own, path, error);
    } else {
        status = haft_error_set(error, HAFT_ERROR_IO, "a temporary file cannot be written: %s",
                                strerror(errno));
    }
    if (file != NULL) {
        fclose(file);
    }
    free(text);
    return status;
}

/* ---- folder ---- */

haft_status init_find_room(const char *folder, haft_error *error) {
    char path[PATH_CAPACITY];
    struct stat found;
    haft_status status = case_path(path, folder, "case.yaml", error);
    if (status == HAFT_OK && lstat(path, &found) == 0) {
        return haft_error_set(error, HAFT_ERROR_EXISTS,
                              "%s is there already and is not replaced; give another folder", path);
    }
    if (status == HAFT_OK && stat(folder, &found) == 0 && !S_ISDIR(found.st_mode)) {
        return haft_error_set(error, HAFT_ERROR_EXISTS, "%s is no folder; give another name",
                              folder);
    }
    return status;
}

/* Copies map k. An existing file with the same bytes is kept. */
static haft_status copy_map(bool *made, const init_plan *p, size_t k, haft_error *error) {
    const init_words *w = p->words;
    const char *from = k < w->maps ? w->map[k] : w->opposite_map[k - w->maps];
    char name[COPY_CAPACITY], to[PATH_CAPACITY], *bytes = NULL, *there = NULL;
    size_t size = 0, other = 0;
    name_copy(name, w, k);
    *made = false;
    haft_status status = case_path(to, p->folder, name, error);
    HAFT_THEN(status, haft_file_read(&bytes, &size, from, SIZE_MAX / 2, error));
    if (status == HAFT_OK) {
        bool same = haft_file_read(&there, &other, to, SIZE_MAX / 2, NULL) == HAFT_OK &&
                    other == size && memcmp(there, bytes, size) == 0;
        if (!same && (there != NULL || access(to, F_OK) == 0)) {
            status = haft_error_set(error, HAFT_ERROR_EXISTS,
                                    "%s is there already, is another file than %s and is not "
                                    "replaced; give another folder",
                                    to, from);
        }
        status = same || status != HAFT_OK ? status : haft_io_write(to, bytes, size, error);
        *made = status == HAFT_OK && !same;
    }
    haft_memory_free(bytes);
    haft_memory_free(there);
    return status;
}

static void remove_copy(const init_plan *p, size_t k) {
    char name[COPY_CAPACITY], path[PATH_CAPACITY];
    name_copy(name, p->words, k);
    if (case_path(path, p->folder, name, NULL) == HAFT_OK) {
        unlink(path);
    }
}

/* Writes case.yaml last, and reads it back, so that its existence means that the case can be
 * used. */
static haft_status put_case(const init_plan *p, haft_error *error) {
    char *text = NULL, path[PATH_CAPACITY];
    size_t size = 0;
    haft_case *c = NULL;
    haft_status status = make_text(&text, &size, p, false, error);
    HAFT_THEN(status, case_path(path, p->folder, "case.yaml", error));
    HAFT_THEN(status, haft_io_write(path, text, size, error));
    free(text);
    if (status == HAFT_OK) {
        status = haft_case_read(&c, path, error);
        if (status != HAFT_OK) {
            unlink(path);
        }
    }
    haft_case_destroy(&c);
    return status;
}

haft_status init_save(const init_plan *p, haft_error *error) {
    size_t n = p->words->maps + p->words->opposite_maps, done = 0;
    bool made[2 * HAFT_FILES_MAX] = {false}, folder = mkdir(p->folder, 0777) == 0;
    if (!folder && errno != EEXIST) {
        return haft_error_set(error, HAFT_ERROR_IO, "%s: this folder cannot be made: %s", p->folder,
                              strerror(errno));
    }
    haft_status status = HAFT_OK;
    for (; done < n && status == HAFT_OK; done++) {
        status = copy_map(&made[done], p, done, error);
    }
    HAFT_THEN(status, put_case(p, error));
    for (size_t k = 0; k < done && status != HAFT_OK; k++) {
        if (made[k]) {
            remove_copy(p, k);
        }
    }
    if (status != HAFT_OK && folder) {
        rmdir(p->folder);
    }
    return status;
}
