/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A temporary file in the same folder, flushed to the disk, then renamed to its target: a reader
 * sees the old file or the new one, and a failure leaves the old one. Until it is complete, the
 * temporary file has no name, so that a killed process leaves nothing. Some file systems have no
 * unnamed files: there it is named PATH.tmp.PID from the start, and a killed process leaves it. */
#include "store.h"
#include "haft/io.h"
#include "parts_folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { TRIES = 100, FOLDER_CAPACITY = 4096, NAME_SPARE = 64 };

static void release(haft_store *store) {
    haft_memory_free(store->path);
    haft_memory_free(store->temporary);
    *store = (haft_store){.descriptor = -1};
}

void haft_store_abandon(haft_store *store) {
    if (store->descriptor >= 0) {
        close(store->descriptor);
    }
    if (store->named) {
        unlink(store->temporary);
    }
    release(store);
}

static haft_status already_there(const char *path, haft_error *error) {
    return haft_error_set(error, HAFT_ERROR_EXISTS,
                          "%s: is there already; give --force to overwrite it, or move it away",
                          path);
}

static haft_status check_goal(const haft_store *store, haft_error *error) {
    struct stat facts;
    if (lstat(store->path, &facts) != 0) {
        return HAFT_OK;
    }
    if (S_ISDIR(facts.st_mode)) {
        return haft_error_set(error, HAFT_ERROR_IO, "%s: is a directory; give a file's name",
                              store->path);
    }
    if (stat(store->path, &facts) == 0 && !S_ISREG(facts.st_mode)) { /* such as /dev/null */
        return haft_error_set(error, HAFT_ERROR_IO,
                              "%s: is no regular file and is not replaced; give another name",
                              store->path);
    }
    return store->overwrite ? HAFT_OK : already_there(store->path, error);
}

/* The folder of a path; false if its name is too long. */
static bool folder_of(char folder[FOLDER_CAPACITY], const char *path) {
    const char *slash = strrchr(path, '/');
    int n = slash == NULL ? 1 : slash == path ? 1 : (int)(slash - path);
    return snprintf(folder, FOLDER_CAPACITY, "%.*s", n, slash == NULL ? "." : path) <
           FOLDER_CAPACITY;
}

/* The path by which an open file can be given a name. */
static void path_of_descriptor(char name[64], int descriptor) {
    snprintf(name, 64, "/proc/self/fd/%d", descriptor);
}

/* Opens a file without a name in the folder of `path`; -1 if the file system has none. */
static int open_unnamed(const char *path) {
    char folder[FOLDER_CAPACITY], own[64];
    int descriptor =
        folder_of(folder, path) ? open(folder, O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666) : -1;
    path_of_descriptor(own, descriptor);
    if (descriptor >= 0 && access(own, F_OK) != 0) { /* it could not be named later */
        close(descriptor);
        descriptor = -1;
    }
    return descriptor;
}

/* Makes a temporary name, for a new file or for the one without a name. @return 0 or an errno */
static int take_name(haft_store *store, char *temporary, size_t capacity) {
    char own[64];
    path_of_descriptor(own, store->descriptor);
    bool named = false;
    for (int i = 0; i < TRIES && !named; i++) {
        haft_store_name(temporary, capacity, store->path, i);
        if (store->descriptor >= 0) {
            named = linkat(AT_FDCWD, own, AT_FDCWD, temporary, AT_SYMLINK_FOLLOW) == 0;
        } else {
            int descriptor = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            named = descriptor >= 0;
            store->descriptor = descriptor;
        }
        if (!named && errno != EEXIST) {
            break;
        }
    }
    store->named = named;
    return named ? 0 : errno;
}

haft_status haft_store_open(haft_store *store, const char *path, bool overwrite,
                            haft_error *error) {
    *store = (haft_store){.descriptor = -1, .overwrite = overwrite};
    size_t length = strlen(path);
    store->path = haft_memory_alloc(length + 1, 1, error);
    store->temporary = haft_memory_alloc(length + NAME_SPARE, 1, error);
    if (store->path == NULL || store->temporary == NULL) {
        release(store);
        return HAFT_ERROR_MEMORY;
    }
    memcpy(store->path, path, length + 1);
    haft_status status = check_goal(store, error);
    if (status == HAFT_OK && (store->descriptor = open_unnamed(path)) < 0) {
        int reason = take_name(store, store->temporary, length + NAME_SPARE);
        if (reason != 0) {
            status = haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be created: %s",
                                    store->temporary, strerror(reason));
        }
    }
    if (status != HAFT_OK) {
        release(store);
    }
    return status;
}

haft_status haft_store_write(haft_store *store, const void *data, size_t size, haft_error *error) {
    const char *bytes = data;
    while (size > 0) {
        ssize_t n = write(store->descriptor, bytes, size);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n <= 0) {
            return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be written: %s", store->path,
                                  n < 0 ? strerror(errno) : "no byte was taken");
        }
        bytes += n;
        size -= (size_t)n;
    }
    return HAFT_OK;
}

/* Flushes the new name to the disk. Some file systems cannot; the data are safe even so. */
static void flush_folder(const char *path) {
    char folder[FOLDER_CAPACITY];
    int descriptor =
        folder_of(folder, path) ? open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
    if (descriptor >= 0) {
        (void)fsync(descriptor);
        close(descriptor);
    }
}

/* Renames the file. Another process may have made the target meanwhile: without `overwrite` the
 * kernel rejects this if it can. */
static int move(const haft_store *store) {
    if (!store->overwrite) {
        if (renameat2(AT_FDCWD, store->temporary, AT_FDCWD, store->path, RENAME_NOREPLACE) == 0) {
            return 0;
        }
        if (errno != EINVAL && errno != ENOSYS) {
            return -1;
        }
    }
    return rename(store->temporary, store->path);
}

haft_status haft_store_commit(haft_store *store, haft_error *error) {
    haft_status status = HAFT_OK;
    bool failed = fsync(store->descriptor) != 0 && errno != EINVAL && errno != ENOTSUP;
    int reason = failed ? errno : 0;
    if (!failed && !store->named) {
        reason = take_name(store, store->temporary, strlen(store->path) + NAME_SPARE);
        failed = reason != 0;
    }
    if (close(store->descriptor) != 0 && !failed) {
        failed = true;
        reason = errno;
    }
    store->descriptor = -1;
    if (!failed && move(store) != 0) {
        failed = true;
        reason = errno;
    }
    if (failed) {
        status = !store->overwrite && reason == EEXIST
                     ? already_there(store->path, error)
                     : haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be written: %s",
                                      store->path, strerror(reason));
        haft_store_abandon(store);
        return status;
    }
    flush_folder(store->path);
    release(store);
    return HAFT_OK;
}

void haft_io_drop_stale(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash == NULL ? path : slash + 1;
    char folder[4096], stale[4096 + 256], prefix[300];
    snprintf(folder, sizeof folder, "%.*s", slash == NULL ? 1 : (int)(slash - path + 1),
             slash == NULL ? "." : path);
    snprintf(prefix, sizeof prefix, "%s.tmp.", name);
    DIR *entries = opendir(folder);
    if (entries == NULL) {
        return;
    }
    for (struct dirent *e = readdir(entries); e != NULL; e = readdir(entries)) {
        if (haft_store_is_stale(e->d_name, prefix)) {
            snprintf(stale, sizeof stale, "%s/%s", folder, e->d_name);
            if (unlink(stale) != 0) {
                haft_parts_discard(stale);
            }
        }
    }
    closedir(entries);
}

static haft_status put(const char *path, const void *data, size_t size, bool overwrite,
                       haft_error *error) {
    haft_store store;
    HAFT_TRY(haft_store_open(&store, path, overwrite, error));
    haft_status status = haft_store_write(&store, data, size, error);
    if (status == HAFT_OK) {
        return haft_store_commit(&store, error);
    }
    haft_store_abandon(&store);
    return status;
}

haft_status haft_store_put(const char *path, const void *data, size_t size, haft_error *error) {
    return put(path, data, size, true, error);
}

haft_status haft_io_write(const char *path, const void *data, size_t size, haft_error *error) {
    return put(path, data, size, false, error);
}
