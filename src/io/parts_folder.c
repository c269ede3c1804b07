/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The folder of parts and who may work in it: a lock (flock) on a file in it, which the kernel
 * gives up with the process, so that a killed run bars nobody. */
#include "parts_folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { TRIES = 100 };

char *haft_parts_join(const haft_parts *parts, const char *name, haft_error *error) {
    size_t capacity = strlen(parts->folder) + strlen(name) + 2;
    char *path = haft_memory_alloc(capacity, 1, error);
    if (path != NULL) {
        snprintf(path, capacity, "%s/%s", parts->folder, name);
    }
    return path;
}

/* Is the file locked still the one of that name? Another process may have taken it away first. */
static bool still_there(int descriptor, const char *path) {
    struct stat held, named;
    return fstat(descriptor, &held) == 0 && stat(path, &named) == 0 &&
           held.st_ino == named.st_ino && held.st_dev == named.st_dev;
}

static haft_status lock_folder(haft_parts *parts, const char *path, haft_error *error) {
    int reason = ENOENT;
    for (int i = 0; i < TRIES && reason == ENOENT; i++) {
        if (mkdir(parts->folder, 0777) != 0 && errno != EEXIST) {
            reason = errno;
            break;
        }
        int descriptor = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (descriptor < 0) {
            reason = errno; /* ENOENT: the folder went away between the two */
            continue;
        }
        reason = flock(descriptor, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
        if (reason == 0 && still_there(descriptor, path)) {
            parts->lock = descriptor;
            return HAFT_OK;
        }
        reason = reason == 0 ? ENOENT : reason;
        close(descriptor);
    }
    if (reason == EWOULDBLOCK) {
        return haft_error_set(error, HAFT_ERROR_EXISTS,
                              "%s: a run of this case is there already, at work; wait for its end "
                              "or stop it",
                              parts->folder);
    }
    return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot make this folder and lock it: %s",
                          parts->folder, strerror(reason));
}

haft_status haft_parts_hold(haft_parts **out, const char *folder, haft_error *error) {
    *out = NULL;
    haft_parts *parts = haft_memory_alloc(1, sizeof *parts, error);
    if (parts == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    parts->lock = -1;
    size_t length = strlen(folder);
    parts->folder = haft_memory_alloc(length + 1, 1, error);
    char *path = NULL;
    if (parts->folder != NULL) {
        memcpy(parts->folder, folder, length + 1);
        path = haft_parts_join(parts, HAFT_PARTS_LOCK, error);
    }
    haft_status status = path == NULL ? HAFT_ERROR_MEMORY : lock_folder(parts, path, error);
    haft_memory_free(path);
    if (status != HAFT_OK) {
        haft_parts_release(&parts);
        return status;
    }
    *out = parts;
    return HAFT_OK;
}

void haft_parts_forget(haft_parts *parts) {
    for (size_t i = 0; i < parts->files; i++) {
        free(parts->file[i]);
    }
    free(parts->file);
    haft_memory_free(parts->entry);
    parts->file = NULL;
    parts->entry = NULL;
    parts->files = parts->found = parts->realizations = 0;
}

void haft_parts_release(haft_parts **parts) {
    if (parts == NULL || *parts == NULL) {
        return;
    }
    haft_parts *p = *parts;
    haft_parts_forget(p);
    if (p->lock >= 0) {
        char *path = haft_parts_join(p, HAFT_PARTS_LOCK, NULL);
        if (path != NULL) {
            unlink(path);
            rmdir(p->folder); /* fails where a part is left, as it should */
        }
        haft_memory_free(path);
        close(p->lock);
    }
    haft_memory_free(p->folder);
    haft_memory_free(p);
    *parts = NULL;
}

/* ---- the files ---- */

static int is_part(const struct dirent *entry) {
    return strncmp(entry->d_name, HAFT_PART_PREFIX, strlen(HAFT_PART_PREFIX)) == 0;
}

haft_status haft_parts_list(haft_parts *parts, haft_error *error) {
    haft_parts_forget(parts);
    struct dirent **entry = NULL;
    int n = scandir(parts->folder, &entry, is_part, alphasort);
    if (n < 0) {
        return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be read: %s", parts->folder,
                              strerror(errno));
    }
    parts->file = calloc((size_t)n + 1, sizeof *parts->file);
    haft_status status = HAFT_OK;
    for (int i = 0; i < n; i++) {
        char *name = parts->file == NULL ? NULL : strdup(entry[i]->d_name);
        if (name != NULL) {
            parts->file[parts->files++] = name;
        } else {
            status = haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for a list of parts");
        }
        free(entry[i]);
    }
    free(entry);
    return status;
}

haft_status haft_parts_clear(haft_parts *parts, haft_error *error) {
    haft_status status = haft_parts_list(parts, error);
    for (size_t i = 0; status == HAFT_OK && i < parts->files; i++) {
        char *path = haft_parts_join(parts, parts->file[i], error);
        if (path == NULL) {
            status = HAFT_ERROR_MEMORY;
        } else if (unlink(path) != 0) {
            status = haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be removed: %s", path,
                                    strerror(errno));
        }
        haft_memory_free(path);
    }
    haft_parts_forget(parts);
    return status;
}

size_t haft_parts_files(const haft_parts *parts) {
    return parts->files;
}

size_t haft_parts_found(const haft_parts *parts) {
    return parts->found;
}

bool haft_parts_has(const haft_parts *parts, size_t realization) {
    return realization < parts->realizations && parts->entry[realization].size > 0;
}
