/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A thread that asks for work posts the result of its last realization and waits. The
 * communicating thread of its process sends both to rank 0 and returns the answer. It sleeps
 * when there is nothing to send: an answer takes a few milliseconds, a realization tens to
 * thousands. */
#include "remote.h"

#include <string.h>

enum { MESSAGE = 1024 };

typedef struct letter {
    uint64_t realization;
    int status; /* a haft_status; HAFT_OK: done */
    haft_summary summary;
    char message[MESSAGE];
} letter;

static const uint64_t NO_REALIZATION = UINT64_MAX;

typedef enum slot_state { WORKING, POSTED, ASKED, GIVEN, ENDED } slot_state;

struct haft_remote_slot {
    slot_state state;
    bool has_letter;
    letter letter;
    uint64_t given;
};

haft_status haft_remote_open(haft_remote *remote, size_t threads, haft_error *error) {
    *remote = (haft_remote){.slots = threads};
    remote->slot = haft_memory_alloc(threads, sizeof *remote->slot, error);
    if (remote->slot == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    omp_init_lock(&remote->lock);
    return HAFT_OK;
}

void haft_remote_close(haft_remote *remote) {
    if (remote->slot != NULL) {
        omp_destroy_lock(&remote->lock);
    }
    haft_memory_free(remote->slot);
    *remote = (haft_remote){0};
}

bool haft_remote_next(haft_remote *remote, size_t slot, size_t *realization) {
    haft_remote_slot *own = &remote->slot[slot];
    omp_set_lock(&remote->lock);
    own->state = POSTED;
    slot_state state = POSTED;
    while (state != GIVEN && state != ENDED) {
        omp_unset_lock(&remote->lock);
        haft_ranks_rest();
        omp_set_lock(&remote->lock);
        state = own->state;
    }
    own->state = WORKING;
    *realization = (size_t)own->given;
    omp_unset_lock(&remote->lock);
    return state == GIVEN;
}

static void post(haft_remote *remote, size_t slot, const letter *said) {
    omp_set_lock(&remote->lock);
    remote->slot[slot].letter = *said;
    remote->slot[slot].has_letter = true;
    omp_unset_lock(&remote->lock);
}

void haft_remote_enter(haft_remote *remote, size_t slot, size_t realization,
                       const haft_summary *summary) {
    letter said = {.realization = realization, .status = HAFT_OK, .summary = *summary};
    post(remote, slot, &said);
}

void haft_remote_fail(haft_remote *remote, size_t slot, size_t realization, haft_status status,
                      const char *message) {
    letter said = {.realization = realization, .status = (int)status};
    strncpy(said.message, message, MESSAGE - 1);
    post(remote, slot, &said);
}

/* ---- on the other ranks ---- */

static void carry(haft_remote *remote) {
    for (size_t i = 0; i < remote->slots; i++) {
        haft_remote_slot *slot = &remote->slot[i];
        omp_set_lock(&remote->lock);
        bool posted = slot->state == POSTED, has_letter = posted && slot->has_letter;
        letter said = slot->letter;
        if (posted) {
            slot->has_letter = false;
            slot->state = ASKED;
        }
        omp_unset_lock(&remote->lock);
        if (has_letter) {
            haft_ranks_send(0, said.status == HAFT_OK ? HAFT_RANKS_DONE : HAFT_RANKS_FAIL, &said,
                            sizeof said);
        }
        if (posted) {
            haft_ranks_send(0, HAFT_RANKS_ASK, NULL, 0);
        }
    }
}

/* Gives an answer to the first thread that waits for one. */
static void hand_on(haft_remote *remote, slot_state state, uint64_t given) {
    omp_set_lock(&remote->lock);
    for (size_t i = 0; i < remote->slots; i++) {
        if (remote->slot[i].state == ASKED) {
            remote->slot[i].state = state;
            remote->slot[i].given = given;
            break;
        }
    }
    omp_unset_lock(&remote->lock);
}

void haft_remote_speak(haft_remote *remote, const size_t *left, size_t threads) {
    for (size_t gone = 0; gone < threads;) {
        carry(remote);
        int from = 0;
        haft_ranks_tag tag = HAFT_RANKS_END;
        while (haft_ranks_probe(&from, &tag)) {
            uint64_t given = NO_REALIZATION;
            if (tag == HAFT_RANKS_GIVE) {
                haft_ranks_receive(from, tag, &given, sizeof given);
                hand_on(remote, GIVEN, given);
            } else {
                haft_ranks_receive(from, tag, NULL, 0);
                hand_on(remote, ENDED, given);
            }
        }
        haft_ranks_rest();
#pragma omp atomic read
        gone = *left;
    }
}

bool haft_remote_await_start(void) {
    int from = 0, go = 0;
    haft_ranks_tag tag = HAFT_RANKS_START;
    while (!haft_ranks_probe(&from, &tag)) {
        haft_ranks_rest();
    }
    haft_ranks_receive(from, tag, &go, sizeof go);
    return go != 0;
}

void haft_remote_leave(haft_status status, const char *message) {
    if (status != HAFT_OK) {
        letter said = {.realization = NO_REALIZATION, .status = (int)status};
        strncpy(said.message, message, MESSAGE - 1);
        haft_ranks_send(0, HAFT_RANKS_FAIL, &said, sizeof said);
    }
    haft_ranks_send(0, HAFT_RANKS_GONE, NULL, 0);
}

/* ---- on rank 0 ---- */

void haft_remote_start(bool go) {
    int word = go;
    for (int rank = 1; rank < haft_study_ranks(); rank++) {
        haft_ranks_send(rank, HAFT_RANKS_START, &word, sizeof word);
    }
}

/* Answers one message. @return whether its sender has left */
static bool answer(haft_scheduler *scheduler, int from, haft_ranks_tag tag) {
    if (tag == HAFT_RANKS_DONE || tag == HAFT_RANKS_FAIL) {
        letter said;
        haft_ranks_receive(from, tag, &said, sizeof said);
        if (said.status == HAFT_OK) {
            haft_scheduler_enter(scheduler, (size_t)said.realization, &said.summary);
        } else if (said.realization == NO_REALIZATION) {
            haft_scheduler_abort(scheduler, (haft_status)said.status, said.message);
        } else {
            haft_scheduler_fail(scheduler, (size_t)said.realization, (haft_status)said.status,
                                said.message);
        }
        return false;
    }
    haft_ranks_receive(from, tag, NULL, 0);
    if (tag == HAFT_RANKS_ASK) {
        size_t k = 0;
        bool more = haft_scheduler_next(scheduler, &k);
        uint64_t given = k;
        haft_ranks_send(from, more ? HAFT_RANKS_GIVE : HAFT_RANKS_END, &given,
                        more ? sizeof given : 0);
    }
    return tag == HAFT_RANKS_GONE;
}

void haft_remote_serve(haft_scheduler *scheduler) {
    for (int here = haft_study_ranks() - 1; here > 0;) {
        int from = 0;
        haft_ranks_tag tag = HAFT_RANKS_GONE;
        while (haft_ranks_probe(&from, &tag)) {
            here -= answer(scheduler, from, tag);
        }
        haft_ranks_rest();
    }
}
