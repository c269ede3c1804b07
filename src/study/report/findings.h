/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The data that findings are judged from. Private to this room. */
#ifndef HAFT_STUDY_FINDINGS_H
#define HAFT_STUDY_FINDINGS_H

#include "haft/study_report.h"

/* A case, its run, and one of its beams, followed again with all states. */
typedef struct haft_evidence {
    const haft_case *c;
    const haft_laws *laws;
    const char *results_path;
    const haft_summary *summary;
    haft_statistics statistics;
    haft_model *model;
    haft_site_laws *sites;
    haft_path *path;
    double correlation; /* [m] */
} haft_evidence;

/* Enters a finding; the text is a format. */
void haft_findings_add(haft_findings *out, const haft_finding *facts, const char *format, ...)
    HAFT_PRINTF(3, 4);

/* The model's assumptions. */
haft_status haft_findings_of_model(haft_findings *out, const haft_evidence *e,
                                   haft_error *error) HAFT_MUST_CHECK;

#endif
