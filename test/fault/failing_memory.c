/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A library to be loaded before a program (LD_PRELOAD) that lets its n-th allocation fail.
 *
 * An allocation is Haft's own where the innermost frame outside the C library belongs to the
 * program or to libhaft; otherwise it is foreign. What a program does is told in the file
 * HAFT_FAIL_LOG:
 *
 *     failed own|foreign           with the stack of the allocation that was refused
 *     crash SIGNAL own|foreign     with the stack; foreign: inside the same call of a foreign
 *                                  library in which the allocation failed, in the freeing of a
 *                                  unit after that, or inside HDF5, whose handles are numbers: no
 *                                  caller can hand it a null pointer
 *     exit foreign                 a foreign library ended the program
 *     count OWN ALL                at a plain end
 *
 * HAFT_FAIL_AT=n   which allocation fails, from 1; 0: none, they are only counted
 * HAFT_FAIL_ALL    set: allocations of all libraries count, else Haft's own alone
 * HAFT_FAIL_LASTS  set: all that come after the n-th and count fail too
 *
 * One thread allocates at a time in what this is for (--threads=1). */
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <link.h>
#include <malloc.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *memory, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

enum { RANGES = 256, DEPTH = 64, OWN = 0, LIBC = 1, FOREIGN = 2, HDF5 = 3 };

static struct {
    uintptr_t low, high;
    int kind;
} range[RANGES];
static size_t ranges;

static bool ready, all, lasts, busy, failed, freeing;
static unsigned long at, own_count, all_count;
static int log_file = -1;
static uintptr_t failed_site; /* Haft's innermost frame of the last allocation that failed */

static int add_ranges(struct dl_phdr_info *info, size_t size, void *user) {
    (void)size;
    (void)user;
    const char *name = strrchr(info->dlpi_name, '/');
    name = name == NULL ? info->dlpi_name : name + 1;
    int kind = FOREIGN;
    if (info->dlpi_name[0] == '\0' || strncmp(name, "libhaft.so", 10) == 0) {
        kind = OWN;
    } else if (strncmp(name, "libc.so", 7) == 0 || strncmp(name, "ld-linux", 8) == 0 ||
               strstr(name, "failing-memory") != NULL || strncmp(name, "linux-vdso", 10) == 0) {
        kind = LIBC;
    } else if (strncmp(name, "libhdf5", 7) == 0) {
        kind = HDF5;
    }
    for (int i = 0; i < info->dlpi_phnum && ranges < RANGES; i++) {
        const ElfW(Phdr) *part = &info->dlpi_phdr[i];
        if (part->p_type == PT_LOAD && (part->p_flags & PF_X) != 0) {
            range[ranges].low = info->dlpi_addr + part->p_vaddr;
            range[ranges].high = range[ranges].low + part->p_memsz;
            range[ranges++].kind = kind;
        }
    }
    return 0;
}

static int kind_of(const void *address) {
    for (size_t i = 0; i < ranges; i++) {
        if ((uintptr_t)address >= range[i].low && (uintptr_t)address < range[i].high) {
            return range[i].kind;
        }
    }
    return FOREIGN;
}

/* Whose frame is the innermost outside the C library, and where Haft's innermost is. */
static int innermost(void *const *frame, int depth, uintptr_t *site) {
    int kind = LIBC;
    *site = 0;
    for (int i = 0; i < depth && *site == 0; i++) {
        int here = kind_of(frame[i]);
        kind = kind == LIBC ? here : kind;
        *site = here == OWN ? (uintptr_t)frame[i] : 0;
    }
    return kind == LIBC ? FOREIGN : kind;
}

static void tell(const char *format, ...) __attribute__((format(printf, 1, 2)));
static void tell(const char *format, ...) {
    char text[200];
    va_list list;
    va_start(list, format);
    int n = vsnprintf(text, sizeof text, format, list);
    va_end(list);
    if (log_file >= 0 && n > 0) {
        (void)!write(log_file, text, (size_t)n);
    }
}

static void tell_stack(void *const *frame, int depth) {
    if (log_file >= 0) {
        backtrace_symbols_fd(frame, depth, log_file);
    }
}

static void on_crash(int number) {
    void *frame[DEPTH];
    busy = true;
    int depth = backtrace(frame, DEPTH);
    uintptr_t site;
    /* the frames of this handler and of the signal lie before the one that crashed */
    int kind = innermost(frame, depth, &site);
    bool foreign = kind == HDF5 || (kind != OWN && (site == failed_site || freeing));
    tell("crash %d %s\n", number, foreign ? "foreign" : "own");
    tell_stack(frame, depth);
    signal(number, SIG_DFL);
    raise(number);
}

/* UDUNITS-2 may return a unit whose parts it could not allocate, and then cannot free it. */
void ut_free(void *unit);
void ut_free(void *unit) {
    void (*original)(void *) = NULL;
    *(void **)&original = dlsym(RTLD_NEXT, "ut_free");
    freeing = failed && unit != NULL;
    original(unit);
    freeing = false;
}

void exit(int code) {
    void (*original)(int) = NULL;
    *(void **)&original = dlsym(RTLD_NEXT, "exit");
    if (kind_of(__builtin_return_address(0)) >= FOREIGN) {
        tell("exit foreign\n");
    }
    original(code);
    abort(); /* never comes here; the compiler does not know */
}

__attribute__((constructor)) static void begin(void) {
    const char *text = getenv("HAFT_FAIL_AT"), *path = getenv("HAFT_FAIL_LOG");
    if (text == NULL) {
        return;
    }
    busy = true;
    at = strtoul(text, NULL, 10);
    all = getenv("HAFT_FAIL_ALL") != NULL;
    lasts = getenv("HAFT_FAIL_LASTS") != NULL;
    log_file = path == NULL ? -1 : open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    dl_iterate_phdr(add_ranges, NULL);
    void *frame[4];
    backtrace(frame, 4); /* loads what it needs, once */
    static const int fatal[] = {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL};
    for (size_t i = 0; i < sizeof fatal / sizeof *fatal; i++) {
        signal(fatal[i], on_crash);
    }
    unsetenv("LD_PRELOAD"); /* what the program starts is left alone */
    unsetenv("HAFT_FAIL_AT");
    ready = true;
    busy = false;
}

__attribute__((destructor)) static void end(void) {
    if (ready) {
        busy = true;
        tell("count %lu %lu\n", own_count, all_count);
    }
}

/* Whether this allocation, called from `caller`, is to fail. */
static bool refuses(const void *caller) {
    if (!ready || busy || (failed && !lasts)) {
        return false;
    }
    busy = true;
    void *frame[DEPTH];
    int depth = 0, kind = kind_of(caller);
    if (kind == LIBC) {
        uintptr_t site;
        depth = backtrace(frame, DEPTH);
        kind = innermost(frame, depth, &site);
    }
    all_count++;
    own_count += kind == OWN;
    bool counts = all || kind == OWN;
    unsigned long number = all ? all_count : own_count;
    bool refused = counts && at > 0 && number >= at && (number == at || lasts);
    if (refused) {
        depth = depth > 0 ? depth : backtrace(frame, DEPTH);
        innermost(frame, depth, &failed_site);
    }
    if (refused && !failed) {
        failed = true;
        tell("failed %s\n", kind == OWN ? "own" : "foreign");
        tell_stack(frame, depth);
    }
    busy = false;
    return refused;
}

void *malloc(size_t size) {
    if (refuses(__builtin_return_address(0))) {
        errno = ENOMEM;
        return NULL;
    }
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
    if (refuses(__builtin_return_address(0))) {
        errno = ENOMEM;
        return NULL;
    }
    return __libc_calloc(count, size);
}

void *realloc(void *memory, size_t size) {
    if (refuses(__builtin_return_address(0))) {
        errno = ENOMEM;
        return NULL;
    }
    return __libc_realloc(memory, size);
}

void *memalign(size_t alignment, size_t size) {
    if (refuses(__builtin_return_address(0))) {
        errno = ENOMEM;
        return NULL;
    }
    return __libc_memalign(alignment, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
    if (refuses(__builtin_return_address(0))) {
        errno = ENOMEM;
        return NULL;
    }
    return __libc_memalign(alignment, size);
}

int posix_memalign(void **memory, size_t alignment, size_t size) {
    if (refuses(__builtin_return_address(0))) {
        return ENOMEM;
    }
    void *made = __libc_memalign(alignment, size);
    *memory = made != NULL ? made : *memory;
    return made != NULL ? 0 : ENOMEM;
}
