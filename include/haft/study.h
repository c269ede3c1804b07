/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file study.h
 *  What the programs do: build the laws of a case, run its realizations, gather their statistics,
 *  write the data of its figures, and report on finished runs. */
#ifndef HAFT_STUDY_H
#define HAFT_STUDY_H

#include "haft/study_campaign.h"
#include "haft/study_figures.h"
#include "haft/study_laws.h"
#include "haft/study_report.h"
#include "haft/study_statistics.h"

#endif
