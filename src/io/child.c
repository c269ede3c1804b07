/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A child process returns its bytes through a pipe: first a record of fixed size with the status,
 * the message and the number of bytes, then the bytes. If the child dies before the record is
 * complete, its input is at fault. Limits on CPU time and memory stop a child that would not end by
 * itself. The memory limit is added to what the process has mapped already, since a sanitizer maps
 * terabytes. */
#include "child.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/* Memory for any input, and further memory per byte of it. */
static const size_t SPARE_BYTES = (size_t)1 << 30, BYTES_A_BYTE = 4;
/* A larger size can come only from a child whose memory was overwritten. */
static const size_t REPLY_MOST = (size_t)1 << 39;
static const size_t SPARE_SECONDS = 20, BYTES_A_SECOND = (size_t)1 << 25;

typedef struct report {
    haft_status status;
    size_t size;
    haft_error error;
} report;

/* ---- in the child ---- */

static bool send_bytes(int pipe_end, const void *data, size_t size) {
    const char *bytes = data;
    while (size > 0) {
        ssize_t n = write(pipe_end, bytes, size);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n <= 0) {
            return false;
        }
        bytes += n;
        size -= (size_t)n;
    }
    return true;
}

static void raise_limit(int resource, rlim_t base, size_t more) {
    struct rlimit limit;
    rlim_t wanted = base + (rlim_t)more;
    if (base != RLIM_INFINITY && wanted >= base && getrlimit(resource, &limit) == 0) {
        limit.rlim_cur =
            limit.rlim_max == RLIM_INFINITY || wanted < limit.rlim_max ? wanted : limit.rlim_max;
        (void)setrlimit(resource, &limit);
    }
}

/* Bytes that the process has mapped; RLIM_INFINITY if unknown. */
static rlim_t mapped_bytes(void) {
    char text[64] = "";
    int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    ssize_t n = file < 0 ? -1 : read(file, text, sizeof text - 1);
    if (file >= 0) {
        close(file);
    }
    unsigned long long pages = n <= 0 ? 0 : strtoull(text, NULL, 10);
    return pages == 0 ? RLIM_INFINITY : (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE);
}

static rlim_t seconds_used(void) {
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0
               ? (rlim_t)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec)
               : RLIM_INFINITY;
}

void haft_child_allow(size_t bytes) {
    size_t room = bytes > SIZE_MAX / 2 - SPARE_BYTES ? SIZE_MAX / 2 : bytes + SPARE_BYTES;
    raise_limit(RLIMIT_AS, mapped_bytes(), room);
    raise_limit(RLIMIT_CPU, seconds_used(), SPARE_SECONDS + bytes / BYTES_A_SECOND);
}

/* Resets the parent's handlers; signals that the user's shell had set to be ignored stay ignored.
 */
static void reset_signals(void) {
    static const int user[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};
    static const int crash[] = {SIGSEGV, SIGBUS,  SIGABRT, SIGFPE,  SIGILL,  SIGTRAP,
                                SIGALRM, SIGXCPU, SIGPIPE, SIGUSR1, SIGUSR2, SIGXFSZ};
    struct sigaction action;
    for (size_t i = 0; i < sizeof user / sizeof *user; i++) {
        if (sigaction(user[i], NULL, &action) == 0 && action.sa_handler != SIG_IGN) {
            signal(user[i], SIG_DFL);
        }
    }
    for (size_t i = 0; i < sizeof crash / sizeof *crash; i++) {
        signal(crash[i], SIG_DFL);
    }
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
}

/* The child must end with its parent, and crash without output or a core file. */
static void prepare(pid_t parent, int pipe_end, size_t input_bytes) {
    reset_signals();
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) {
        _exit(1);
    }
    struct rlimit no_core = {0, 0};
    (void)setrlimit(RLIMIT_CORE, &no_core);
    int nowhere = open("/dev/null", O_RDWR);
    for (int i = STDOUT_FILENO; nowhere >= 0 && i <= STDERR_FILENO; i++) {
        if (i != pipe_end) { /* the C library reports a corrupted heap on standard error */
            (void)dup2(nowhere, i);
        }
    }
    haft_child_allow(input_bytes > SIZE_MAX / BYTES_A_BYTE ? SIZE_MAX : BYTES_A_BYTE * input_bytes);
}

static _Noreturn void work_and_exit(int pipe_end, haft_child_work *work, const void *context) {
    void *bytes = NULL;
    report r = {.size = 0};
    r.status = work(context, &bytes, &r.size, &r.error);
    r.size = r.status == HAFT_OK ? r.size : 0;
    bool sent = send_bytes(pipe_end, &r, sizeof r) && send_bytes(pipe_end, bytes, r.size);
    _exit(sent ? 0 : 1); /* without exit handlers: they belong to the parent */
}

/* ---- in the parent ---- */

static bool take_bytes(int pipe_end, void *data, size_t size) {
    char *bytes = data;
    while (size > 0) {
        ssize_t n = read(pipe_end, bytes, size);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n <= 0) {
            return false;
        }
        bytes += n;
        size -= (size_t)n;
    }
    return true;
}

static haft_status tell_death(int state, const haft_child_input *input, haft_error *error) {
    int number = WIFSIGNALED(state) ? WTERMSIG(state) : 0;
    char what[80] = "the process that read it ended without a result";
    switch (number) {
    case SIGINT:
    case SIGTERM:
    case SIGHUP:
    case SIGQUIT:
        return haft_error_set(error, HAFT_ERROR_INTERRUPTED,
                              "%s: reading it was interrupted by signal %d", input->path, number);
    case SIGXCPU:
        snprintf(what, sizeof what, "reading it does not end");
        break;
    case SIGKILL:
        snprintf(what, sizeof what, "the system killed the process that read it");
        break;
    case 0:
        break;
    default:
        snprintf(what, sizeof what, "the process that read it crashed (signal %d)", number);
        break;
    }
    return haft_error_set(error, HAFT_ERROR_INPUT, "%s: is damaged: %s; %s", input->path, what,
                          input->remedy);
}

/* Reads the report and the bytes; false if the child died before it sent all of them. */
static bool take_report(int pipe_end, report *r, void **bytes, haft_error *error) {
    if (!take_bytes(pipe_end, r, sizeof *r)) {
        return false;
    }
    r->error.message[HAFT_ERROR_CAPACITY - 1] = '\0';
    if (r->status != HAFT_OK) {
        haft_error_set(error, r->status, "%s", r->error.message);
        return true;
    }
    if (r->size > REPLY_MOST) {
        return false;
    }
    *bytes = haft_memory_alloc(r->size, 1, error);
    if (*bytes == NULL) {
        r->status = HAFT_ERROR_MEMORY;
        return true;
    }
    return take_bytes(pipe_end, *bytes, r->size);
}

static haft_status no_child(const haft_child_input *input, haft_error *error) {
    return haft_error_set(error, HAFT_ERROR_IO, "%s: no process can be started to read it: %s",
                          input->path, strerror(errno));
}

haft_status haft_child_run(void **bytes, size_t *size, haft_child_work *work,
                           const haft_child_input *input, haft_error *error) {
    *bytes = NULL;
    *size = 0;
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) {
        return no_child(input, error);
    }
    pid_t parent = getpid(), child = fork();
    if (child < 0) {
        haft_status status = no_child(input, error);
        close(ends[0]);
        close(ends[1]);
        return status;
    }
    if (child == 0) {
        prepare(parent, ends[1], input->bytes);
        work_and_exit(ends[1], work, input->context);
    }
    close(ends[1]);
    report r = {.size = 0};
    bool whole = take_report(ends[0], &r, bytes, error);
    close(ends[0]); /* ends a child that still writes */
    int state = 0;
    while (waitpid(child, &state, 0) < 0 && errno == EINTR) {
    }
    if (!whole) {
        r.status = tell_death(state, input, error);
    }
    if (r.status != HAFT_OK) {
        haft_memory_free(*bytes);
        *bytes = NULL;
        return r.status;
    }
    *size = r.size;
    return HAFT_OK;
}
