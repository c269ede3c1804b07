/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of files that are not complete yet, and which of them were left by processes that no longer
 * run. */
#include "store.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void haft_store_name(char *name, size_t capacity, const char *path, int number) {
    snprintf(name, capacity, number == 0 ? "%s.tmp.%ld" : "%s.tmp.%ld.%d", path, (long)getpid(),
             number);
}

/* Whether a process that no longer runs has left this file of `prefix`. After the prefix come its
 * PID and possibly another number (haft_store_name); files of any other name are not Haft's. */
bool haft_store_is_stale(const char *name, const char *prefix) {
    static const char digits[] = "0123456789";
    size_t n = strlen(prefix), maker = strncmp(name, prefix, n) == 0 ? strspn(name + n, digits) : 0;
    if (maker == 0 || maker > 9 || name[n] == '0') {
        return false;
    }
    const char *rest = name + n + maker;
    size_t second = *rest == '.' ? strspn(rest + 1, digits) : 0;
    if (*rest != '\0' && (second == 0 || rest[1 + second] != '\0')) {
        return false;
    }
    pid_t process = (pid_t)strtol(name + n, NULL, 10);
    return process != getpid() && kill(process, 0) != 0 && errno == ESRCH;
}
