/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The folder of parts and its locks (flock) on files in it. The kernel releases a lock when its
 * process ends, so a killed run blocks nobody. A run locks the folder exclusively; shards share its
 * lock, and each has an exclusive lock of its own as well. */
#include "parts_folder.h"
#include "store.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { TRIES = 100, NAP = 5000000 /* [ns] */ };

void haft_parts_prefix(char prefix[HAFT_PART_NAME_CAPACITY], size_t shard, size_t shards) {
    if (shards == 0) {
        snprintf(prefix, HAFT_PART_NAME_CAPACITY, HAFT_PART_PREFIX);
    } else {
        snprintf(prefix, HAFT_PART_NAME_CAPACITY, HAFT_PART_PREFIX "%zuof%zu-", shard, shards);
    }
}

/* ---- names ---- */

/* Reads a number in exactly the form that printf() writes. */
static bool take_number(const char **at, size_t *value) {
    size_t digits = strspn(*at, "0123456789");
    bool plain = digits > 0 && digits < 19 && !(digits > 1 && **at == '0');
    *value = plain ? strtoull(*at, NULL, 10) : 0;
    *at += digits;
    return plain;
}

static bool take_text(const char **at, const char *text) {
    size_t n = strlen(text);
    bool same = strncmp(*at, text, n) == 0;
    *at += same ? n : 0;
    return same;
}

static bool take_shard(const char **at, size_t *count) {
    size_t index = 0;
    return take_number(at, &index) && take_text(at, "of") && take_number(at, count) && index > 0 &&
           index <= *count;
}

/* Whether this is the name of a part. *count is the number of shards of its run, 0 without shards.
 * Files of other names are not Haft's and are left alone. */
static bool is_part_name(const char *name, size_t *count) {
    const char *at = name;
    size_t rank = 0, number = 0;
    *count = 0;
    if (!take_text(&at, HAFT_PART_PREFIX)) {
        return false;
    }
    const char *rest = at;
    if (!(take_shard(&at, count) && take_text(&at, "-"))) {
        *count = 0;
        at = rest;
    }
    return take_number(&at, &rank) && take_text(&at, "-") && take_number(&at, &number) &&
           *at == '\0';
}

static bool is_lock_name(const char *name) {
    const char *at = name;
    size_t count = 0;
    return take_text(&at, HAFT_PARTS_LOCK) &&
           (*at == '\0' || (take_text(&at, "-") && take_shard(&at, &count) && *at == '\0'));
}

static size_t split_of(const char *name) {
    size_t count = 0;
    (void)is_part_name(name, &count);
    return count;
}

char *haft_parts_join(const haft_parts *parts, const char *name, haft_error *error) {
    size_t capacity = strlen(parts->folder) + strlen(name) + 2;
    char *path = haft_memory_alloc(capacity, 1, error);
    if (path != NULL) {
        snprintf(path, capacity, "%s/%s", parts->folder, name);
    }
    return path;
}

/* Whether the locked file is still the one of that name. Another process may have removed it before
 * it was locked. */
static bool still_there(int descriptor, const char *path) {
    struct stat held, named;
    return fstat(descriptor, &held) == 0 && stat(path, &named) == 0 &&
           held.st_ino == named.st_ino && held.st_dev == named.st_dev;
}

/* Makes and locks a file. If it is removed meanwhile (ENOENT), makes it again. If it is locked and
 * `waits` is set, tries again for a short time, since a shard that ends locks the folder
 * exclusively while it checks whether it is the last. @return 0 or an errno */
static int lock_file(int *out, const char *folder, const char *path, int operation, bool waits) {
    int reason = ENOENT;
    for (int i = 0; i < TRIES && (reason == ENOENT || (waits && reason == EWOULDBLOCK)); i++) {
        if (reason == EWOULDBLOCK) {
            nanosleep(&(struct timespec){.tv_nsec = NAP}, NULL);
        }
        if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
            return errno;
        }
        int descriptor = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOCTTY, 0666);
        if (descriptor < 0) {
            reason = errno; /* ENOENT: the folder was removed between the two calls */
            continue;
        }
        reason = flock(descriptor, operation | LOCK_NB) == 0 ? 0 : errno;
        if (reason == 0 && still_there(descriptor, path)) {
            *out = descriptor;
            return 0;
        }
        reason = reason == 0 ? ENOENT : reason;
        close(descriptor);
    }
    return reason;
}

static haft_status take_lock(haft_parts *parts, int *lock, const char *name, int operation,
                             haft_error *error) {
    char *path = haft_parts_join(parts, name, error);
    if (path == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    int reason = lock_file(lock, parts->folder, path, operation, operation == LOCK_SH);
    haft_memory_free(path);
    if (reason == 0) {
        return HAFT_OK;
    }
    if (reason != EWOULDBLOCK) {
        return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot make this folder and lock it: %s",
                              parts->folder, strerror(reason));
    }
    if (lock == &parts->shard_lock) {
        return haft_error_set(error, HAFT_ERROR_EXISTS,
                              "%s: shard %zu/%zu is at work already; wait for its end or stop it",
                              parts->folder, parts->shard, parts->shards);
    }
    return haft_error_set(error, HAFT_ERROR_EXISTS,
                          "%s: a run of this case is there already, at work; wait for its end or "
                          "stop it",
                          parts->folder);
}

static void name_shard_lock(char name[HAFT_PART_NAME_CAPACITY], size_t shard, size_t shards) {
    snprintf(name, HAFT_PART_NAME_CAPACITY, HAFT_PARTS_LOCK "-%zuof%zu", shard, shards);
}

static haft_status read_names(haft_parts *parts, const char *prefix, haft_error *error);

/* Rejects parts of a run with another number of shards: together they would compute beams twice. */
static haft_status refuse_other_split(haft_parts *parts, haft_error *error) {
    haft_status status = read_names(parts, HAFT_PART_PREFIX, error);
    for (size_t i = 0; i < parts->files && status == HAFT_OK; i++) {
        size_t count = split_of(parts->file[i]);
        if (count == 0) {
            status = haft_error_set(error, HAFT_ERROR_EXISTS,
                                    "%s/%s: an unfinished run without shards is there already; go "
                                    "on with it by `haft resume`, or move its parts away",
                                    parts->folder, parts->file[i]);
        } else if (count != parts->shards) {
            status = haft_error_set(error, HAFT_ERROR_EXISTS,
                                    "%s/%s: the run is split into %zu shards, not into %zu; go on "
                                    "with those, or move their parts away",
                                    parts->folder, parts->file[i], count, parts->shards);
        }
    }
    haft_parts_forget(parts);
    return status;
}

static haft_status lock_all(haft_parts *parts, haft_error *error) {
    if (parts->shards == 0) {
        return take_lock(parts, &parts->lock, HAFT_PARTS_LOCK, LOCK_EX, error);
    }
    char name[HAFT_PART_NAME_CAPACITY];
    name_shard_lock(name, parts->shard, parts->shards);
    haft_status status = take_lock(parts, &parts->lock, HAFT_PARTS_LOCK, LOCK_SH, error);
    HAFT_THEN(status, take_lock(parts, &parts->shard_lock, name, LOCK_EX, error));
    return status == HAFT_OK ? refuse_other_split(parts, error) : status;
}

haft_status haft_parts_hold(haft_parts **out, const char *folder, size_t shard, size_t shards,
                            haft_error *error) {
    *out = NULL;
    haft_parts *parts = haft_memory_alloc(1, sizeof *parts, error);
    if (parts == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    *parts = (haft_parts){.shard = shard, .shards = shards, .lock = -1, .shard_lock = -1};
    size_t length = strlen(folder);
    parts->folder = haft_memory_alloc(length + 1, 1, error);
    haft_status status = HAFT_ERROR_MEMORY;
    if (parts->folder != NULL) {
        memcpy(parts->folder, folder, length + 1);
        status = lock_all(parts, error);
    }
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
    parts->files = parts->found = parts->repeated = parts->realizations = 0;
}

static int is_lock(const struct dirent *entry) {
    return is_lock_name(entry->d_name);
}

static int is_part(const struct dirent *entry) {
    size_t count = 0;
    return is_part_name(entry->d_name, &count);
}

/* Whether an entry is neither a part nor a lock, nor "." or "..". */
static int is_foreign(const struct dirent *entry) {
    return !is_lock(entry) && !is_part(entry) && strcmp(entry->d_name, ".") != 0 &&
           strcmp(entry->d_name, "..") != 0;
}

/* Removes the files of a folder that `which` selects, then the folder if it is empty. */
static void sweep_out(const char *folder, int (*which)(const struct dirent *entry)) {
    struct dirent **entry = NULL;
    int n = scandir(folder, &entry, which, NULL);
    int descriptor = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    for (int i = 0; i < n; i++) {
        (void)unlinkat(descriptor, entry[i]->d_name, 0);
        free(entry[i]);
    }
    free(entry);
    if (descriptor >= 0) {
        close(descriptor);
    }
    rmdir(folder); /* fails if anything is left, as intended */
}

static int is_own(const struct dirent *entry) {
    return is_lock(entry) || is_part(entry);
}

void haft_parts_discard(const char *folder) {
    sweep_out(folder, is_own);
}

static void remove_lock(const haft_parts *parts, const char *name) {
    char *path = haft_parts_join(parts, name, NULL);
    if (path != NULL) {
        unlink(path);
    }
    haft_memory_free(path);
}

void haft_parts_release(haft_parts **parts) {
    if (parts == NULL || *parts == NULL) {
        return;
    }
    haft_parts *p = *parts;
    haft_parts_forget(p);
    if (p->shard_lock >= 0) {
        char name[HAFT_PART_NAME_CAPACITY];
        name_shard_lock(name, p->shard, p->shards);
        remove_lock(p, name);
        close(p->shard_lock);
    }
    if (p->lock >= 0) {
        /* The last shard to end can lock the folder exclusively, as a run always does. It removes
         * all lock files, including those of killed shards. */
        if (p->shards == 0 || flock(p->lock, LOCK_EX | LOCK_NB) == 0) {
            sweep_out(p->folder, is_lock);
        }
        close(p->lock);
    }
    haft_memory_free(p->folder);
    haft_memory_free(p);
    *parts = NULL;
}

/* ---- the files ---- */

static haft_status read_names(haft_parts *parts, const char *prefix, haft_error *error) {
    haft_parts_forget(parts);
    struct dirent **entry = NULL;
    int n = scandir(parts->folder, &entry, is_part, alphasort);
    if (n < 0) {
        return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be read: %s", parts->folder,
                              strerror(errno));
    }
    parts->file = calloc((size_t)n + 1, sizeof *parts->file);
    haft_status status = parts->file != NULL ? HAFT_OK
                                             : haft_error_set(error, HAFT_ERROR_MEMORY,
                                                              "out of memory for a list of parts");
    for (int i = 0; i < n; i++) {
        bool ours = strncmp(entry[i]->d_name, prefix, strlen(prefix)) == 0;
        char *name = ours && parts->file != NULL ? strdup(entry[i]->d_name) : NULL;
        if (name != NULL) {
            parts->file[parts->files++] = name;
        } else if (ours) {
            status = haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for a list of parts");
        }
        free(entry[i]);
    }
    free(entry);
    return status;
}

/* The number of files of a folder that `which` selects; -1 if it cannot be read. */
static int count(const char *folder, int (*which)(const struct dirent *entry)) {
    struct dirent **entry = NULL;
    int n = scandir(folder, &entry, which, NULL);
    for (int i = 0; i < n; i++) {
        free(entry[i]);
    }
    free(entry);
    return n;
}

bool haft_parts_are_in(const char *folder) {
    return count(folder, is_part) > 0;
}

haft_status haft_parts_list(haft_parts *parts, haft_error *error) {
    char prefix[HAFT_PART_NAME_CAPACITY];
    haft_parts_prefix(prefix, parts->shard, parts->shards);
    return read_names(parts, prefix, error);
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

haft_status haft_parts_retire(haft_parts *parts, haft_error *error) {
    if (count(parts->folder, is_foreign) != 0) { /* other files stay, and so the folder */
        return haft_parts_clear(parts, error);
    }
    size_t capacity = strlen(parts->folder) + 64;
    char *aside = haft_memory_alloc(capacity, 1, error);
    if (aside == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    int reason = EEXIST; /* the name may exist: left by a killed process with the same PID */
    for (int i = 0; i < TRIES && (reason == EEXIST || reason == ENOTEMPTY); i++) {
        haft_store_name(aside, capacity, parts->folder, i);
        reason = rename(parts->folder, aside) == 0 ? 0 : errno;
    }
    if (reason != 0) {
        haft_memory_free(aside);
        return haft_error_set(error, HAFT_ERROR_IO, "%s: cannot be renamed: %s", parts->folder,
                              strerror(reason));
    }
    haft_memory_free(parts->folder);
    parts->folder = aside;
    return haft_parts_clear(parts, error);
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

size_t haft_parts_repeated(const haft_parts *parts) {
    return parts->repeated;
}

size_t haft_parts_split(const haft_parts *parts) {
    size_t count = parts->files == 0 ? 0 : split_of(parts->file[0]);
    for (size_t i = 1; i < parts->files; i++) {
        count = split_of(parts->file[i]) == count ? count : 0;
    }
    return count;
}
