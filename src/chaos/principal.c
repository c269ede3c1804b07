/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Principal components of q by Jacobi rotations, which give small eigenvalues of a 4 x 4 matrix
 * full relative accuracy, and the same bits on every machine. The sign of an eigenvector makes
 * its largest component positive (the first one, of those equal to a millionth). */
#include <math.h>
#include <string.h>

#include "chaos/model.h"

enum { N = HAFT_CHAOS_DIMENSION, SWEEPS = 60 };

/* An eigenvalue below this share of the greatest is rounding. */
#define RANK_SHARE 1e-12

static void rotate(double c[N][N], double v[N][N], int p, int q) {
    double theta = (c[q][q] - c[p][p]) / (2 * c[p][q]);
    double t = copysign(1, theta) / (fabs(theta) + sqrt(1 + theta * theta));
    double cosine = 1 / sqrt(1 + t * t), sine = t * cosine;
    for (int k = 0; k < N; k++) {
        double a = c[k][p], b = c[k][q];
        c[k][p] = cosine * a - sine * b;
        c[k][q] = sine * a + cosine * b;
    }
    for (int k = 0; k < N; k++) {
        double a = c[p][k], b = c[q][k];
        c[p][k] = cosine * a - sine * b;
        c[q][k] = sine * a + cosine * b;
    }
    c[p][q] = c[q][p] = 0;
    for (int k = 0; k < N; k++) {
        double a = v[k][p], b = v[k][q];
        v[k][p] = cosine * a - sine * b;
        v[k][q] = sine * a + cosine * b;
    }
}

static void diagonalise(double c[N][N], double v[N][N]) {
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            v[i][j] = i == j;
        }
    }
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        bool done = true;
        for (int p = 0; p < N; p++) {
            for (int q = p + 1; q < N; q++) {
                if (fabs(c[p][q]) > 1e-17 * sqrt(fabs(c[p][p] * c[q][q])) && c[p][q] != 0) {
                    rotate(c, v, p, q);
                    done = false;
                }
            }
        }
        if (done) {
            break;
        }
    }
}

/* Takes the column of `from` with the greatest eigenvalue that is not taken yet, and sets its
 * sign. */
static void take_greatest(double c[N][N], double v[N][N], bool taken[N], haft_chaos_parts *parts,
                          int to) {
    int best = -1;
    for (int j = 0; j < N; j++) {
        if (!taken[j] && (best < 0 || c[j][j] > c[best][best])) {
            best = j;
        }
    }
    taken[best] = true;
    double greatest = 0;
    for (int i = 0; i < N; i++) {
        if (fabs(v[i][best]) > fabs(greatest) * (1 + 1e-6)) {
            greatest = v[i][best];
        }
    }
    parts->eigenvalue[to] = fmax(0, c[best][best]);
    for (int i = 0; i < N; i++) {
        parts->eigenvector[i][to] = greatest < 0 ? -v[i][best] : v[i][best];
    }
}

void haft_chaos_principal(size_t m, const double *q, haft_chaos_parts *parts) {
    double c[N][N] = {{0}}, v[N][N];
    bool taken[N] = {false};
    for (int i = 0; i < N; i++) {
        double sum = 0;
        for (size_t k = 0; k < m; k++) {
            sum += q[N * k + (size_t)i];
        }
        parts->mean[i] = sum / (double)m;
    }
    for (size_t k = 0; k < m; k++) {
        double d[N];
        for (int i = 0; i < N; i++) {
            d[i] = q[N * k + (size_t)i] - parts->mean[i];
        }
        for (int i = 0; i < N; i++) {
            for (int j = 0; j <= i; j++) {
                c[i][j] += d[i] * d[j];
            }
        }
    }
    for (int i = 0; i < N; i++) {
        for (int j = 0; j <= i; j++) {
            c[i][j] /= (double)(m - 1);
            c[j][i] = c[i][j];
        }
    }
    diagonalise(c, v);
    for (int j = 0; j < N; j++) {
        take_greatest(c, v, taken, parts, j);
    }
}

size_t haft_chaos_rank(const haft_chaos_parts *parts) {
    size_t rank = 0;
    while (rank < N && parts->eigenvalue[rank] > RANK_SHARE * parts->eigenvalue[0]) {
        rank++;
    }
    return rank;
}
