/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages are small and of fixed size, so each is sent at once. A failing MPI call ends the
 * job, which is MPI's default. Waiting polls and sleeps, because MPI's own waiting spins. */
#include "ranks.h"

#include <time.h>

#ifdef HAFT_MPI
#include <mpi.h>

static bool is_running(void) {
    int begun = 0, ended = 0;
    MPI_Initialized(&begun);
    MPI_Finalized(&ended);
    return begun && !ended;
}

void haft_study_ranks_begin(void) {
    int begun = 0, given = 0;
    MPI_Initialized(&begun);
    if (!begun) {
        MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &given);
    }
}

void haft_study_ranks_end(void) {
    if (is_running()) {
        MPI_Finalize();
    }
}

int haft_study_rank(void) {
    int rank = 0;
    if (is_running()) {
        MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    }
    return rank;
}

int haft_study_ranks(void) {
    int count = 1;
    if (is_running()) {
        MPI_Comm_size(MPI_COMM_WORLD, &count);
    }
    return count;
}

bool haft_study_ranks_agree(bool ready) {
    int own = ready, all = ready;
    if (is_running()) {
        MPI_Allreduce(&own, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    }
    return all != 0;
}

bool haft_ranks_probe(int *from, haft_ranks_tag *tag) {
    int there = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (there) {
        *from = status.MPI_SOURCE;
        *tag = (haft_ranks_tag)status.MPI_TAG;
    }
    return there != 0;
}

void haft_ranks_receive(int from, haft_ranks_tag tag, void *data, size_t size) {
    MPI_Recv(data, (int)size, MPI_BYTE, from, (int)tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

void haft_ranks_send(int to, haft_ranks_tag tag, const void *data, size_t size) {
    MPI_Send(data, (int)size, MPI_BYTE, to, (int)tag, MPI_COMM_WORLD);
}

#else

void haft_study_ranks_begin(void) {
}

void haft_study_ranks_end(void) {
}

int haft_study_rank(void) {
    return 0;
}

int haft_study_ranks(void) {
    return 1;
}

bool haft_study_ranks_agree(bool ready) {
    return ready;
}

bool haft_ranks_probe(int *from, haft_ranks_tag *tag) {
    (void)from;
    (void)tag;
    return false;
}

void haft_ranks_receive(int from, haft_ranks_tag tag, void *data, size_t size) {
    (void)from;
    (void)tag;
    (void)data;
    (void)size;
}

void haft_ranks_send(int to, haft_ranks_tag tag, const void *data, size_t size) {
    (void)to;
    (void)tag;
    (void)data;
    (void)size;
}

#endif

void haft_ranks_rest(void) {
    nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
}
